"""The full-order model: boundary integrals for the flow, a neo-Hookean membrane.

>>> from capsule_rom import fom
>>> run = fom.run(0.05, 0.8, mesh=3, end_time=0.1)
>>> run.positions.shape == (len(run.times), 146, 3)
True
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from typing import Literal, Optional

import numpy as np
from numpy.typing import NDArray

from . import _core

Doubles = NDArray[np.float64]


@dataclass(frozen=True)
class Run:
    """The snapshots of one configuration: N_t instants, N_x nodes, N_e elements. Made by `run`."""

    ca: float
    """Capillary number mu V / G_s."""
    confinement: float
    """a/l."""
    status: Literal["steady", "unsteady", "stopped"]
    """"stopped" if the solver could not continue: a warning says why."""
    steady_time: Optional[float]
    """From when the shape is steady, in l/V; None if it is not."""
    times: Doubles = field(repr=False)
    """Instants of the snapshots `(N_t,)`, in l/V."""
    positions: Doubles = field(repr=False)
    """Nodes in the laboratory frame `(N_t, N_x, 3)`, in l."""
    velocities: Doubles = field(repr=False)
    """Velocities of the nodes `(N_t, N_x, 3)`, in V."""
    elements: NDArray[np.uint32] = field(repr=False)
    """Nodes of the quadratic triangles `(N_e, 6)`, as `capsule_rom.build` takes them."""
    centroid: Doubles = field(repr=False)
    """Axial position of the volume centroid `(N_t,)`, in l."""
    velocity: Doubles = field(repr=False)
    """Velocity of the volume centroid `(N_t,)`, in V."""
    axial_length: Doubles = field(repr=False)
    """Extent along the channel `(N_t,)`, in l."""
    half_width: Doubles = field(repr=False)
    """Greatest distance from the axis in the plane z = 0 `(N_t,)`, in l."""
    half_diagonal: Doubles = field(repr=False)
    """Greatest distance from the axis in the plane y = z `(N_t,)`, in l."""
    rear_depth: Doubles = field(repr=False)
    """Depth of the rear cavity `(N_t,)`, in l."""
    pressure_drop: Doubles = field(repr=False)
    """Additional pressure drop that the capsule causes `(N_t,)`, in mu V / l."""
    volume_drift: float
    """Greatest relative change of the enclosed volume."""
    velocity_evaluations: int
    """Evaluations of the velocities: the measure of the work."""


def run(
    ca: float,
    confinement: float,
    *,
    mesh: int = 8,
    membrane: Literal["harmonics", "p2"] = "harmonics",
    degree: Optional[int] = None,
    bending: float = 1e-4,
    integrator: Literal["rkc2", "euler", "ralston"] = "rkc2",
    step: float = 5e-4,
    tolerance: float = 1e-5,
    end_time: float = 20.0,
    snapshot_interval: float = 0.2,
    unreduced: bool = False,
) -> Run:
    """Runs a capsule from rest to its steady state or to `end_time`, as `capsule-rom fom run`, with the same numbers.

    - `mesh`: frequency n, for 8 n^2 elements and 16 n^2 + 2 nodes
    - `membrane`: spherical harmonics up to `degree` (3 n), with the bending stiffness `bending`, in G_s a^2; or the
      paper's six-node elements, "p2"
    - `integrator`: "rkc2" allows an error of the positions of `tolerance` a step, in l; the others have the fixed
      `step`, in l/V
    - `end_time`, `snapshot_interval`: in l/V; near the start there are more snapshots
    - `unreduced`: all nodes are computed, not an eighth of them

    It runs on all cores without the global interpreter lock. Ctrl-C ends it, with nothing returned. What could not be
    resolved gives a `RuntimeWarning`. Raises `SolverError` for settings and configurations that are refused.
    """
    found = _core.run(
        ca,
        confinement,
        mesh,
        membrane,
        degree,
        bending,
        integrator,
        step,
        tolerance,
        end_time,
        snapshot_interval,
        unreduced,
    )
    for warning in found.warnings:
        warnings.warn(warning, RuntimeWarning, stacklevel=2)
    times, (centroid, velocity, axial_length, half_width, half_diagonal, rear_depth, pressure_drop) = found.history()
    return Run(
        ca=ca,
        confinement=confinement,
        status=found.status,
        steady_time=found.steady_time,
        times=times,
        positions=found.positions(),
        velocities=found.velocities(),
        elements=found.elements(),
        centroid=centroid,
        velocity=velocity,
        axial_length=axial_length,
        half_width=half_width,
        half_diagonal=half_diagonal,
        rear_depth=rear_depth,
        pressure_drop=pressure_drop,
        volume_drift=found.volume_drift,
        velocity_evaluations=found.velocity_evaluations,
    )
