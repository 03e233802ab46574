"""Ellipsoids of known motion over two parameters, as arrays of other people's data."""

import numpy as np

TIMES = np.linspace(0.0, 2.0, 9)
GRID = np.stack(np.meshgrid(np.linspace(0, 1, 5), np.linspace(0, 1, 5), indexing="ij"), axis=-1).reshape(-1, 2)


def sphere():
    """Nodes `(66, 3)` and triangles `(128, 3)`: an octahedron, its edges halved twice, blown up to the unit sphere."""
    nodes = [point for axis in np.eye(3) for point in (axis, -axis)]
    triangles = [(x, y, z) if (x + y + z) % 2 == 0 else (x, z, y) for x in (0, 1) for y in (2, 3) for z in (4, 5)]
    for _ in range(2):
        middles = {}

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(nodes)
                nodes.append(nodes[a] + nodes[b])
            return middles[key]

        halved = []
        for a, b, c in triangles:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            halved += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        triangles = halved
        nodes = [node / np.linalg.norm(node) for node in nodes]
    return np.array(nodes), np.array(triangles)


def motion(nodes, parameters, times):
    """Positions `(configurations, times, nodes, 3)`: stretched along x at constant volume, and carried along."""
    p, q = np.asarray(parameters, dtype=float).T[:, :, None]
    t = np.asarray(times, dtype=float)
    stretch = (1 + 0.2 * p * (1 - np.exp(-t)) + 0.1 * q * t / (1 + t))[:, :, None]
    centre = ((1.2 + 0.3 * p - 0.1 * p * q) * t)[:, :, None]
    x, y, z = nodes.T
    return np.stack([centre + stretch * x, y / np.sqrt(stretch), z / np.sqrt(stretch)], axis=-1)


def arrays():
    """Everything that a model is built from, by name."""
    nodes, elements = sphere()
    return {"parameters": GRID, "times": TIMES, "positions": motion(nodes, GRID, TIMES), "elements": elements}
