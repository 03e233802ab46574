#!/usr/bin/env python3
"""Compares the model with other tools on the same snapshots; docs/reports/peers.md describes it.

    python3 -m venv peers && . peers/bin/activate
    pip install -r docs/peers/requirements.txt ./host-tools/python
    python docs/peers/compare.py

Writes docs/results/peers.json. It takes 3 GB of memory and some minutes of one core.
"""
import os

# One thread, for training and for queries.
for pool in ("OMP", "OPENBLAS", "MKL", "RAYON"):
    os.environ[f"{pool}_NUM_THREADS"] = "1"

import argparse
import importlib.metadata
import itertools
import json
import shutil
import subprocess
import tempfile
import time
import warnings
from pathlib import Path

import h5py
import numpy as np
from scipy.spatial import KDTree

ROOT = Path(__file__).resolve().parents[2]
END, STEP = 20, 2
ERROR_TIMES = (8.0, 20.0)
# Where the initial shape, and with it the solution, has a kink.
KINK = 0.9
CAPILLARY_NUMBERS = {"Ca": lambda ca: ca, "sqrt Ca": np.sqrt, "log Ca": np.log}
REPETITIONS = 10
TIMED_EVERY = 7
# More modes than there are.
ALL = 10**6


class Arrays:
    """An export: displacements from the mean over all configurations are what peers learn."""

    def __init__(self, path):
        with h5py.File(path) as file:
            self.parameters, self.times = file["parameters"][()], file["times"][()]
            self.positions = file["positions"][()]

    def at(self, time):
        return int(np.argmin(abs(self.times - time)))


def ezyrb(approximation, rank):
    """EZyRB: POD of whole trajectories, and an approximation of its coefficients."""

    def train(x, y):
        from ezyrb import POD, Database, ReducedOrderModel

        rom = ReducedOrderModel(Database(x, y), POD("svd", rank=min(rank, len(y))), approximation()).fit()
        return lambda q: rom.predict(q[None])[0]

    return train


def ezyrb_rbf(kernel, rank):
    from ezyrb import RBF

    return ezyrb(lambda: RBF(kernel=kernel), rank)


def ezyrb_gpr(smoothness, rank):
    from ezyrb import GPR
    from sklearn.gaussian_process.kernels import ConstantKernel, Matern

    kernel = ConstantKernel(1.0, (1e-3, 1e6)) * Matern([1.0, 1.0], (5e-2, 50.0), nu=smoothness)
    return ezyrb(lambda: GPR(kern=kernel, optimization_restart=0), rank)


def pymor_vkoga(length, rank):
    """pyMOR: POD of whole trajectories, and a greedy kernel interpolation of its coefficients."""

    def train(x, y):
        from pymor.algorithms.ml.vkoga import GaussianKernel, VKOGARegressor
        from pymor.algorithms.pod import pod
        from pymor.core.logger import set_log_levels
        from pymor.vectorarrays.numpy import NumpyVectorSpace

        set_log_levels({"pymor": "ERROR"})
        snapshots = NumpyVectorSpace.from_numpy(y.T)
        modes, _ = pod(snapshots, modes=min(rank, len(y)), rtol=1e-9)
        coefficients = snapshots.inner(modes)
        scale = np.abs(coefficients).max()
        regressor = VKOGARegressor(GaussianKernel(length), max_centers=len(x), tol=1e-12, reg=1e-10)
        regressor.fit(x, coefficients / scale)
        return lambda q: modes.lincomb(regressor.predict(q[None]).T * scale).to_numpy()[:, 0]

    return train


def smt_kriging(correlation, rank):
    """SMT: POD of whole trajectories, and a kriging of each coefficient."""

    def train(x, y):
        from smt.applications import PODI

        model = PODI()
        model.compute_pod(y.T, pod_type="global", n_modes=min(rank, len(y) - 1), seed=0)
        options = dict(corr=correlation, poly="linear", theta0=[0.1], n_start=1, print_global=False)
        model.set_interp_options("KRG", [options])
        model.set_training_values(x)
        model.train()
        return lambda q: model.predict_values(q[None])[:, 0]

    return train


# For each peer its maker, and the settings that `--tune` found: see SEARCH.
PEERS = {
    "EZyRB, POD + RBF": (ezyrb_rbf, ("sqrt Ca", True, "cubic", 30)),
    "EZyRB, POD + GPR": (ezyrb_gpr, ("sqrt Ca", False, 1.5, 15)),
    "pyMOR, POD + VKOGA": (pymor_vkoga, ("sqrt Ca", True, 0.5, ALL)),
    "SMT, POD + kriging": (smt_kriging, ("sqrt Ca", True, "matern52", 12)),
}
# Kernels and numbers of modes that `--tune` tries, each with all capillary numbers, with the split and without.
SEARCH = {
    "EZyRB, POD + RBF": (["thin_plate_spline", "cubic", "quintic"], [30, ALL]),
    "EZyRB, POD + GPR": ([1.5, 2.5], [8, 15, 30]),
    "pyMOR, POD + VKOGA": ([0.35, 0.5, 0.7, 1.0], [ALL]),
    "SMT, POD + kriging": (["matern52"], [12]),
}


class Peer:
    """A peer with its settings, the capillary number transformed, one model or one on each side of the kink."""

    def __init__(self, train, transform, split, parameters, y):
        self.split, self.transform = split, CAPILLARY_NUMBERS[transform]
        confinement = parameters[:, 1]
        sides = [confinement < KINK + 1e-9, confinement > KINK - 1e-9] if split else [confinement > 0]
        self.sides, self.counts = [], [int(side.sum()) for side in sides]
        for side in sides:
            x = self.inputs(parameters[side])
            low, size = x.min(0), np.ptp(x, axis=0)
            self.sides.append((low, size, train((x - low) / size, y[side])))

    def inputs(self, parameters):
        parameters = np.asarray(parameters, float)
        return np.stack([self.transform(parameters[..., 0]), parameters[..., 1]], axis=-1)

    def __call__(self, query):
        low, size, predict = self.sides[int(self.split and query[1] > KINK)]
        return predict((self.inputs(query) - low) / size)


def hausdorff(a, b):
    """The modified Hausdorff distance."""
    return max(KDTree(b).query(a)[0].mean(), KDTree(a).query(b)[0].mean())


def statistics(errors):
    return {"mean_percent": 100 * float(np.mean(errors)), "max_percent": 100 * float(np.max(errors))}


def measure(answer, tests, indices):
    """Errors over a, and the processor time of a query; `answer` gives all nodes at all instants."""
    instants = [{"t": instant, "hausdorff": [], "nodes": []} for instant in ERROR_TIMES]
    for index in indices:
        positions = answer(tests.parameters[index])
        confinement = tests.parameters[index, 1]
        for errors in instants:
            found, true = positions[tests.at(errors["t"])], tests.positions[index, tests.at(errors["t"])]
            errors["hausdorff"].append(hausdorff(found, true) / confinement)
            errors["nodes"].append(np.linalg.norm(found - true, axis=1).mean() / confinement)
    for errors in instants:
        errors |= {kind: statistics(errors[kind]) for kind in ("hausdorff", "nodes")}
    return {"instants": instants, "query_ms": 1e3 * duration(answer, tests.parameters[indices[::TIMED_EVERY]])}


def duration(answer, queries):
    """The processor time of a query, median: of each the least of some repetitions, since other programs disturb."""
    seconds = []
    for query in queries:
        times = []
        for _ in range(REPETITIONS):
            start = time.process_time()
            answer(query)
            times.append(time.process_time() - start)
        seconds.append(min(times))
    return float(np.median(seconds))


def tune(samples, tests):
    """Prints the mean distances of the nodes at t = 8, at every third query, of all settings."""
    y, mean, _ = displacements(samples)
    # In an orthonormal basis of the snapshots all is as in the full space, and short.
    basis, coefficients = np.linalg.qr(y.T)
    size = 3 * samples.positions.shape[2]
    at_8 = slice(samples.at(8.0) * size, (samples.at(8.0) + 1) * size)
    basis, mean = basis[at_8], mean[at_8]
    for name, (kernels, ranks) in SEARCH.items():
        for transform, split, kernel, rank in itertools.product(CAPILLARY_NUMBERS, [False, True], kernels, ranks):
            peer = Peer(PEERS[name][0](kernel, rank), transform, split, samples.parameters, coefficients.T)
            errors = []
            for index in range(0, len(tests.parameters), 3):
                found = (basis @ peer(tests.parameters[index]) + mean).reshape(-1, 3)
                true = tests.positions[index, tests.at(8.0)]
                errors.append(np.linalg.norm(found - true, axis=1).mean() / tests.parameters[index, 1])
            print(name, transform, "split" if split else "", kernel, rank, statistics(errors), sep="; ", flush=True)


def displacements(samples):
    """A row for each configuration, relative to the mean; the mean; the shape of a trajectory."""
    y = samples.positions.reshape(len(samples.positions), -1)
    mean = y.mean(0)
    return y - mean, mean, samples.positions.shape[1:]


def compare(samples, model, tests, indices):
    """All tools on the snapshots of one design; the results, after each tool."""
    results = {"samples": len(samples.parameters), "queries": len(indices), "tools": []}
    for method in ("direct", "paper"):
        answer = lambda query: model.predict(*query, method=method).positions(tests.times).astype(float)
        results["tools"].append({"tool": f"capsule-rom, {method}"} | measure(answer, tests, indices))
    y, mean, shape = displacements(samples)
    for name, (maker, (transform, split, kernel, rank)) in PEERS.items():
        start = time.process_time()
        peer = Peer(maker(kernel, rank), transform, split, samples.parameters, y)
        trained = time.process_time()
        measured = measure(lambda query: (peer(query) + mean).reshape(shape), tests, indices)
        modes = [min(rank, count) for count in peer.counts]
        entry = {"tool": name, "capillary_number": transform, "split": split, "kernel": kernel, "modes": modes}
        entry |= {"training_s": trained - start, "basis_mb": 8e-6 * sum(modes) * y.shape[1]}
        results["tools"].append(entry | measured)
        yield results


def inside(model, tests):
    """Whether the model answers for the configurations of the test set."""
    return model.predict(*tests.parameters.T, invalid="nan").domain == "inside"


def exported(command, database, path):
    if not path.exists():
        run(command, "database", "export", database, "--t", f"0:{END}:{STEP}", "--hdf5", path, "--quiet")
    return path


def run(command, *arguments):
    subprocess.run([command, *map(str, arguments)], check=True, cwd=ROOT)


def paper_design(folder):
    """A database of the paper's 122 configurations alone."""
    folder.mkdir(parents=True, exist_ok=True)
    source = ROOT / "models/database"
    names = ["database.json", "mesh.npz"]
    capillary_numbers = [0.005] + [0.01 * k for k in range(1, 21)]
    for ca, confinement in itertools.product(capillary_numbers, [0.75 + 0.05 * k for k in range(10)]):
        name = f"ca{ca:.4f}_al{confinement:.4f}.npz"
        if (source / name).exists() and b'"steady"' in np.load(source / name)["status"].tobytes():
            names.append(name)
    for name in names:
        shutil.copy(source / name, folder / name)
    return folder


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--command", default=str(ROOT / "target/release/capsule-rom"), help="the capsule-rom command")
    parser.add_argument("--out", type=Path, default=ROOT / "docs/results/peers.json")
    parser.add_argument("--folder", type=Path, help="where exports stay, and are taken from if they are there")
    parser.add_argument("--tune", action="store_true", help="only print the errors of other settings of the peers")
    options = parser.parse_args()
    import capsule_rom

    warnings.filterwarnings("ignore", module="sklearn|pymor|ezyrb|smt")
    packages = ["ezyrb", "pymor", "smt", "scikit-learn", "scipy", "numpy"]
    results = {"versions": {name: importlib.metadata.version(name) for name in packages}, "instants": 0, "designs": {}}
    with tempfile.TemporaryDirectory() as scratch:
        folder, command = (options.folder or Path(scratch)).resolve(), options.command
        tests = Arrays(exported(command, "models/test-set", folder / "test-set.h5"))
        results["instants"] = len(tests.times)
        small = paper_design(folder / "paper")
        if not (folder / "paper.crom").exists():
            run(command, "offline", "build", "--database", small, "--out", folder / "paper.crom", "--quiet")
        if options.tune:
            return tune(Arrays(exported(command, small, folder / "paper.h5")), tests)
        models = [capsule_rom.load(path) for path in (folder / "paper.crom", ROOT / "models/capsule.crom")]
        indices = [int(i) for i in np.flatnonzero(inside(models[0], tests) & inside(models[1], tests))]
        for design, database, model in zip(["paper", "shipped"], [small, "models/database"], models):
            samples = Arrays(exported(command, database, folder / f"{design}.h5"))
            for results["designs"][design] in compare(samples, model, tests, indices):
                options.out.write_text(json.dumps(results, indent=1) + "\n")


if __name__ == "__main__":
    main()
