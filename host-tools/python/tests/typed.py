"""Every part of the interface once, for `mypy --strict`: it is checked and not run."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import capsule_rom


def predict(path: Path) -> NDArray[np.float32]:
    model = capsule_rom.load(path)
    answer = model.predict([0.05, 0.1], 0.9, method="direct", invalid="nan")
    out = np.empty((2, 3, model.node_count, 3), dtype=np.float32)
    positions: NDArray[np.float32] = answer.positions([0.0, 1.0, 2.0], nodes=None, frame="centroid", out=out)
    lengths: NDArray[np.float32] = answer.observables(3.0).axial_length
    tensions = answer.fields(3.0).tension_1 + answer.totals(3.0).energy + answer.bound(3.0)
    low: float = model.parameters[0].min
    sum_of_all: NDArray[np.float32] = positions[0, 0] + lengths + tensions + answer.outline("midplane", low)
    return sum_of_all


def identify(model: capsule_rom.Model, contour: NDArray[np.float64]) -> float:
    found = model.identify(
        contour, observable="silhouette", half_width_um=25, viscosity_pa_s=0.8, velocity_mm_s=5, radius_um=(20.0, 0.5)
    )
    low, high = found.gs_n_per_m.interval_95
    return found.ca.value if low is None or high is None else high - low


def build(path: Path) -> capsule_rom.Model:
    runs = [capsule_rom.fom.run(ca, 0.9, mesh=3, end_time=1) for ca in (0.05, 0.06, 0.07, 0.08)]
    model = capsule_rom.build(
        [[run.ca] for run in runs],
        runs[0].times,
        [run.positions for run in runs],
        runs[0].elements,
        parameter_names=["Ca"],
        split=("Ca", 0.06),
    )
    model.save(path)
    return model
