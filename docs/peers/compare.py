#!/usr/bin/env python3
"""Compares the model with other programs that make reduced-order models, on the same samples.

  python3 docs/peers/compare.py [--json FILE] [--only NAME NAME ...]

Every program is fitted to the surfaces of the samples at t = 8, with each of its settings, and asked at the
configurations of the test set. Run it in the root of the repository, with the command `capsule-rom` on the path and
the packages of docs/peers/requirements.txt. It keeps the data that it made in target/peers.
"""
import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "RAYON_NUM_THREADS"):
    os.environ[variable] = "1"

import argparse
import contextlib
import importlib.metadata
import io
import itertools
import json
import logging
import subprocess
import time
import warnings
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

import capsule_rom

T = 8.0
WORK = Path("target/peers")
# Where the initial shape changes from a sphere to an ellipsoid, a kink of the solution.
SPLIT = 0.9
# Above this Ca all rears are dented, so that no program interpolates across the jump.
AWAY = 0.02
PACKAGES = ["ezyrb", "pymor", "smt", "scikit-learn", "scipy", "numpy"]
COORDINATES = ["Ca", "sqrt(Ca)", "ln(Ca)", "sqrt(Ca)/limit^(1/8)"]
# Modes of the POD where each one costs a fit. What they leave out is below 0.012 % of a at every configuration.
MODES = 40


def coordinate(name, parameters, limit):
    """The parameters of all queries with a function of Ca in its place."""
    ca, confinement = np.atleast_2d(parameters).T
    first = {"Ca": lambda: ca, "ln(Ca)": lambda: np.log(ca)}.get(name, lambda: np.sqrt(ca))()
    if name == COORDINATES[3]:
        first = first / limit(confinement) ** 0.125
    return np.stack([first, confinement], axis=1)


def scaled(points):
    """A function that takes the ranges of the points to [0, 1], as all programs ask for."""
    least, greatest = points.min(0), points.max(0)
    return lambda x: (np.atleast_2d(x) - least) / (greatest - least)


# A program is fit(points (N, 2), surfaces (N, 3 N_x), kernel) -> answer(point (1, 2)) -> (3 N_x,).


def ezyrb(points, surfaces, approximation, rank):
    from ezyrb import POD, Database, ReducedOrderModel

    model = ReducedOrderModel(Database(points, surfaces), POD(rank=rank), approximation)
    model.fit()
    return lambda point: np.asarray(model.predict(point))


def radial(points, surfaces, kernel):
    from ezyrb import RBF

    approximation = RBF(kernel=kernel, degree=2) if kernel == "quintic" else RBF(kernel=kernel)
    return ezyrb(points, surfaces, approximation, -1)


def gaussian_process(points, surfaces, kernel):
    from ezyrb import GPR

    # One kernel for all modes: with modes of equal size, as the normaliser makes them, the least of them decide on it.
    own = covariance(kernel)
    return ezyrb(points, surfaces, GPR(kern=own, normalizer=own is None, optimization_restart=0), MODES)


def covariance(kernel):
    """A kernel of scikit-learn: none for that of the program, or with a length of its own along each coordinate."""
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, Matern

    bounds = {"length_scale": [1.0, 1.0], "length_scale_bounds": (5e-2, 50.0)}
    shapes = {"Gauss": lambda: RBF(**bounds), "Matern 5/2": lambda: Matern(nu=2.5, **bounds)}
    return ConstantKernel(1.0, (1e-3, 1e5)) * shapes[kernel]() if kernel in shapes else None


def pymor(points, surfaces, kernel):
    from pymor.algorithms.ml.vkoga import VKOGARegressor
    from pymor.algorithms.pod import pod
    from pymor.vectorarrays.numpy import NumpyVectorSpace
    from sklearn.gaussian_process.kernels import Matern

    vectors = NumpyVectorSpace.from_numpy(surfaces.T)
    modes = pod(vectors, rtol=1e-7)[0].to_numpy().T
    coefficients = surfaces @ modes.T
    largest = np.abs(coefficients).max()
    if kernel == "defaults":
        regressor = VKOGARegressor()
    else:
        length = float(kernel.split()[-1])
        regressor = VKOGARegressor(Matern(length, nu=2.5), max_centers=len(points), tol=1e-12, reg=1e-12)
    regressor.fit(points, coefficients / largest)
    return lambda point: largest * regressor.predict(point) @ modes


def smt(points, surfaces, kernel):
    from smt.surrogate_models import KRG

    left, values, modes = np.linalg.svd(surfaces, full_matrices=False)
    coefficients, modes = (left * values)[:, :MODES], modes[:MODES]
    models = []
    for column in coefficients.T:
        model = KRG(corr=kernel, poly="linear", theta0=[1e-1] * 2, n_start=1, print_global=False)
        model.set_training_values(points, column)
        model.train()
        models.append(model)
    return lambda point: np.array([model.predict_values(point)[0, 0] for model in models]) @ modes


# For each program its fit, kernels, coordinates, and whether the domain is split. Kriging takes minutes for a setting.
PROGRAMS = {
    "EZyRB, POD + RBF": (radial, ["thin_plate_spline", "cubic", "quintic"], COORDINATES, [False, True]),
    "EZyRB, POD + GPR": (gaussian_process, ["defaults", "Gauss", "Matern 5/2"], COORDINATES, [False, True]),
    "pyMOR, POD + VKOGA": (pymor, ["defaults", "Matern 5/2 1", "Matern 5/2 4"], COORDINATES, [False, True]),
    "SMT, POD + kriging": (smt, ["squar_exp"], COORDINATES[3:], [True]),
}


class Parts:
    """A program fitted to all samples, or to each side of the split by itself."""

    def __init__(self, fit, parameters, surfaces, kernel, name, split, limit):
        self.transform = lambda query: coordinate(name, query, limit)
        self.split = split
        sides = [parameters[:, 1] <= SPLIT + 1e-6, parameters[:, 1] >= SPLIT - 1e-6]
        self.parts = []
        for side in sides if split else [np.full(len(parameters), True)]:
            points, mean = self.transform(parameters[side]), surfaces[side].mean(0)
            scale = scaled(points)
            self.parts.append((scale, fit(scale(points), surfaces[side] - mean, kernel), mean))

    def __call__(self, query):
        scale, answer, mean = self.parts[int(self.split and query[1] > SPLIT)]
        return answer(scale(self.transform(query))).ravel() + mean


def distance(found, expected):
    """The modified Hausdorff distance of two surfaces (N_x, 3)."""
    one, other = cKDTree(expected).query(found)[0], cKDTree(found).query(expected)[0]
    return max(one.mean(), other.mean())


def numbers(queries, errors):
    """Mean and greatest of errors, of all and away from the jump."""
    away = np.array(errors)[queries[:, 0] > AWAY]
    found = {"mean": np.mean(errors), "max": np.max(errors), "away_mean": away.mean(), "away_max": away.max()}
    return {f"{name}_percent": short(value) for name, value in found.items()}


def short(value):
    """Four digits."""
    return float(f"{value:.4g}")


class Task:
    """What every program is asked: configurations of the test set and their surfaces."""

    def __init__(self, queries, surfaces):
        self.queries, self.surfaces = queries, surfaces

    def judge(self, answer):
        """Mean and greatest error in per cent of a, both also away from the jump, and the median time of an answer."""
        answer(self.queries[0])
        errors, times = [], []
        for query, expected in zip(self.queries, self.surfaces):
            start = time.perf_counter()
            found = answer(query)
            times.append(time.perf_counter() - start)
            errors.append(100 * distance(np.reshape(found, expected.shape), expected) / query[1])
        return {**numbers(self.queries, errors), "query_us": short(1e6 * np.median(times))}


def run(*words):
    return subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True).stdout


def exported(folder):
    """Parameters and surfaces at t = 8 of a database."""
    file = WORK / f"{Path(folder).name}.npz"
    if not file.exists():
        run("capsule-rom", "database", "export", folder, "--t", f"0,{T:g}", "--npz", str(file), "--quiet")
    with np.load(file) as data:
        return data["parameters"], data["positions"][:, -1]


def rows_of(parameters, samples):
    """The rows of a model's samples, which it has in single precision, in those of the database."""
    gaps, rows = cKDTree(parameters).query(samples)
    assert gaps.max() < 1e-6, "a sample of the model is not in the database"
    return rows


def ours(model, task, path):
    """The model by each of its methods."""
    rows = []
    for method in ("direct", "paper"):
        row = task.judge(lambda query: model.predict(*query, method=method).positions(T))
        rows.append({"program": "capsule-rom" if method == "direct" else "the paper's method", **row})
    command = ["capsule-rom", "study", "test-set", "--t", f"{T:g}", "--json", "--quiet", "--model", str(path)]
    measured = json.loads(run(*command))["methods"]["direct"][0]
    # The command has another implementation of the distance.
    assert abs(measured["lab_mean_percent"] - rows[0]["mean_percent"]) < 1e-3
    return rows


def compare(program, parameters, surfaces, task, limit):
    """All settings of a program."""
    fit, *settings = PROGRAMS[program]
    rows = []
    for kernel, name, split in itertools.product(*settings):
        start = time.perf_counter()
        with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
            warnings.simplefilter("ignore")
            parts = Parts(fit, parameters, surfaces.reshape(len(surfaces), -1), kernel, name, split, limit)
            row = task.judge(parts)
        seconds = time.perf_counter() - start
        given = {"program": program, "kernel": kernel, "coordinate": name, "models": 1 + split}
        rows.append({**given, **row})
        print(f"  {rows[-1]}  {seconds:.0f} s", flush=True)
    return rows


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--json", type=Path, help="write the results")
    alone = "these programs alone; the file keeps the results of the others"
    arguments.add_argument("--only", nargs="+", choices=PROGRAMS, default=list(PROGRAMS), help=alone)
    options = arguments.parse_args()
    logging.disable(logging.WARNING)
    WORK.mkdir(parents=True, exist_ok=True)
    shipped, grid = Path("models/capsule.crom"), WORK / "grid.crom"
    if not grid.exists():
        run("capsule-rom", "offline", "build", "--design", "paper", "--out", str(grid), "--quiet")
    parameters, surfaces = exported("models/database")
    queries, expected = exported("models/test-set")
    models = {"paper": capsule_rom.load(grid), "shipped": capsule_rom.load(shipped)}
    limit = models["shipped"].steady_limit
    inside = models["shipped"].predict(*queries.T, invalid="nan").domain == "inside"
    task = Task(queries[inside], expected[inside])
    versions = {package: importlib.metadata.version(package) for package in PACKAGES}
    results = {"t": T, "queries": len(task.queries), "away_from_ca": AWAY, "versions": versions, "designs": {}}
    kept = json.loads(options.json.read_text())["designs"] if options.json and options.json.exists() else {}
    for design, path in ("paper", grid), ("shipped", shipped):
        rows = rows_of(parameters, models[design].samples)
        print(f"{design}: {len(rows)} samples")
        found = {"samples": len(rows), "ours": ours(models[design], task, path)}
        print("\n".join(f"  {row}" for row in found["ours"]))
        settings = kept.get(design, {}).get("settings", [])
        settings = [row for row in settings if row["program"] not in options.only]
        results["designs"][design] = found
        for name in options.only:
            print(name)
            settings += compare(name, parameters[rows], surfaces[rows], task, limit)
        tried = [[row for row in settings if row["program"] == name] for name in PROGRAMS]
        found["best"] = [min(rows, key=lambda row: row["mean_percent"]) for rows in tried if rows]
        found["settings"] = settings
    if options.json:
        options.json.write_text(json.dumps(results, indent=1) + "\n")


if __name__ == "__main__":
    main()
