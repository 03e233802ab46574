#!/usr/bin/env python3
"""Draws the figures of the book from the stored results: python3 docs/pictures/draw.py"""
import csv
import json
import math
from pathlib import Path

HERE = Path(__file__).parent
RESULTS = HERE.parent / "results"
STYLE = (
    "<style>text{font:13px sans-serif;fill:#1c2733}.s{font-size:11px;fill:#52606d}"
    ".b{fill:#eef4fa;stroke:#2f6f9f}.g{stroke:#d5dde5}.a{stroke:#2f6f9f;fill:none;marker-end:url(#m)}</style>"
    '<defs><marker id="m" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="8" markerHeight="8" orient="auto">'
    '<path d="M0 0 8 4 0 8z" fill="#2f6f9f"/></marker></defs>'
)


def write(name, width, height, title, body):
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img" aria-label="{title}">'
    background = f'<rect width="{width}" height="{height}" fill="#fff"/>'
    (HERE / name).write_text("\n".join([head, STYLE, background, *body, "</svg>", ""]))


def box(x, y, w, title, *lines):
    h = 30 + 16 * len(lines)
    yield f'<rect class="b" x="{x}" y="{y}" width="{w}" height="{h}" rx="5"/>'
    yield f'<text x="{x + 10}" y="{y + 20}" font-weight="bold">{title}</text>'
    for i, line in enumerate(lines):
        yield f'<text class="s" x="{x + 10}" y="{y + 37 + 16 * i}">{line}</text>'


def data_flow():
    body = [
        *box(20, 20, 170, "Configurations", "(Ca, a/l), a design"),
        *box(240, 20, 190, "Full-order model", "boundary integrals, membrane", "RKC2 in time"),
        *box(480, 20, 200, "Snapshots", "positions and velocities", "of all nodes, N_t instants"),
        *box(480, 140, 200, "Compression", "modes Phi (from T)", "cubic B-splines in time",
             "parameter modes Psi (from S)", "quantisation"),
        *box(240, 140, 190, "Model file", "Phi, core, Psi, knots", "leave-one-out errors", "steady limit, jump curve"),
        *box(20, 140, 170, "Query", "(Ca, a/l), t", "nodes of the scene"),
        *box(20, 268, 170, "Weights", "L_j of the samples"),
        *box(240, 268, 190, "Controls", "psi = Psi^T L", "G_b psi for 4 splines"),
        *box(480, 268, 200, "Answer", "sum of B_b(t) Phi G_b psi", "expected error, bound"),
        '<path class="a" d="M190 43H240"/><path class="a" d="M430 51H480"/><path class="a" d="M580 82V140"/>',
        '<path class="a" d="M480 187H430"/><path class="a" d="M105 202V268"/><path class="a" d="M335 218V268"/>',
        '<path class="a" d="M190 291H240"/><path class="a" d="M430 299H480"/>',
        '<path class="a" d="M290 218 160 268"/>',
        '<text class="s" x="20" y="112">once, on a host: full-order model and offline stage</text>',
        '<text class="s" x="20" y="352">for each query, on any device: online stage</text>',
    ]
    write("data-flow.svg", 700, 365, "From configurations to an answer", body)


def run_time():
    with open(RESULTS / "speed.csv") as file:
        seconds = {row["method"]: float(row["us"]) * 1e-6 for row in csv.DictReader(file)}
    with open(RESULTS / "convergence.csv") as file:
        meshes = [row for row in csv.DictReader(file) if (row["Ca"], row["a/l"]) == ("0.1", "0.9")]
    meshes = {row["cause"] + ", " + row["value"]: row for row in meshes if row["profile_percent"]}
    # The runs of that study have other settings and a busier machine: their ratios count.
    unit = seconds["full-order"] / float(meshes["mesh, harmonics, 13"]["wall_time_s"])
    points = []
    for name in ["harmonics, 8", "harmonics, 10", "harmonics, 13", "elements, 13"]:
        row = meshes["mesh, " + name]
        error, time = float(row["profile_percent"]), float(row["wall_time_s"]) * unit
        points.append((name.replace(", ", ", mesh "), error, time, "#b3541e"))
    errors = json.loads((RESULTS / "test-set.json").read_text())["methods"]
    for method, label in [("direct", "direct evaluation"), ("paper", "the paper's method")]:
        at_8 = next(instant for instant in errors[method] if instant["t"] == 8)
        points.append((f"{label}, mean", at_8["lab_mean_percent"], seconds[method], "#2f6f9f"))
        points.append((f"{label}, maximum", at_8["lab_max_percent"], seconds[method], "#8fb8d6"))
    x0, x1, y0, y1, width, height = -2, 0.3, -4, 1, 700, 400
    px = lambda e: 70 + (math.log10(e) - x0) / (x1 - x0) * 600
    py = lambda s: 340 - (math.log10(s) - y0) / (y1 - y0) * 310
    body = []
    for e in [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2]:
        body.append(f'<path class="g" d="M{px(e):.0f} 30V340"/>'
                    f'<text class="s" x="{px(e) - 10:.0f}" y="356">{e:g}</text>')
    for k in range(y0, y1 + 1):
        label = {-4: "100 us", -3: "1 ms", -2: "10 ms", -1: "100 ms", 0: "1 s", 1: "10 s"}[k]
        y = py(10.0**k)
        body.append(f'<path class="g" d="M70 {y:.0f}H670"/><text class="s" x="15" y="{y + 4:.0f}">{label}</text>')
    body.append('<text x="250" y="382">error at t = 8, per cent of a</text>')
    body.append('<text x="15" y="18">time of one trajectory</text>')
    for label, error, time, colour in points:
        x, y = px(error), py(time)
        body.append(f'<circle cx="{x:.0f}" cy="{y:.0f}" r="5" fill="{colour}"/>')
        body.append(f'<text class="s" text-anchor="middle" x="{x:.0f}" y="{y - 10:.0f}">{label}</text>')
    body.append('<text x="250" y="130" fill="#b3541e">full-order model</text>')
    body.append('<text x="250" y="225" fill="#2f6f9f">reduced-order model</text>')
    write("run-time-against-error.svg", width, height, "Run time against error", body)


data_flow()
run_time()
