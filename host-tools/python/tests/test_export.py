"""Exports of snapshots and surfaces, read by the libraries that they are meant for: h5py, meshio and PyVista, where
these are installed, and NumPy."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

CLI = os.environ.get("CAPSULE_ROM_COMMAND")
TEST_SET = Path(__file__).parents[3] / "models/test-set"
TIMES = [0, 0.4, 8, 20]


def command(*arguments):
    if CLI is None:
        pytest.skip("CAPSULE_ROM_COMMAND names the command to test")
    done = subprocess.run([CLI, *map(str, arguments), "--json"], check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def export(database, option, path):
    return command("database", "export", database, "--t", ",".join(map(str, TIMES)), option, path)


@pytest.fixture(scope="module")
def database(tmp_path_factory):
    """The first two configurations of the test set."""
    folder = tmp_path_factory.mktemp("database")
    for name in ["database.json", "mesh.npz", *sorted(path.name for path in TEST_SET.glob("ca*.npz"))[:2]]:
        shutil.copy(TEST_SET / name, folder / name)
    return folder


@pytest.fixture(scope="module")
def arrays(database):
    path = database / "arrays.npz"
    report = export(database, "--npz", path)
    assert (report["configurations"], report["instants"], report["left_out"]) == (2, len(TIMES), [])
    with np.load(path) as file:
        arrays = dict(file)
    path.unlink()
    return arrays


def decoded(file, mesh):
    """Positions and velocities at all nodes, as host-tools/database/src/compact.rs describes the files."""

    def integers(name, columns):
        unsigned = sum(plane.astype(np.int64) << 8 * k for k, plane in enumerate(file[name]))
        rows = (unsigned >> 1) ^ -(unsigned & 1)
        for i, row in enumerate(file[name + "_predictor"].astype(np.int64)):
            rows[i] += rows[i - 1] if i else 0
            rows[i] += (sum(a * b for a, b in zip(row, columns(rows, i))) + (1 << 23)) >> 24
        return rows

    axial = np.array([1 << 14, 0, 0])

    def past(rows, i, count):
        return [rows[i - j] - rows[i - j - 1] for j in range(1, count + 1) if i > j]

    velocities = integers("velocities", lambda rows, i: [axial] * (i > 0) + past(rows, i, 6))

    def around(i):
        steps = [j for j in (i - 1, i, i + 1) if 0 < i and 0 < j < len(velocities)]
        return [velocities[i]] * (i > 0) + [velocities[j] - velocities[j - 1] for j in steps]

    positions = integers("positions", lambda rows, i: [axial] * (i > 0) + around(i) + past(rows, i, 2))
    operations = mesh["operations"][mesh["operation"]]
    full = lambda sector: np.einsum("nij,tnj->tni", operations, sector[:, mesh["representative"]])
    return full(positions * 2.0**-21), full(velocities * 2.0**-20)


def test_numpy_reads_what_the_database_holds(database, arrays):
    mesh = np.load(database / "mesh.npz")
    assert arrays["parameter_names"].tolist() == ["capillary_number", "confinement"]
    assert (arrays["length_unit"].item(), arrays["time_unit"].item()) == ("l", "l/V")
    assert arrays["times"].tolist() == TIMES
    assert (arrays["elements"] == mesh["elements"]).all()
    files = sorted(database.glob("ca*.npz"), key=lambda path: np.load(path)["parameters"].tolist())
    for row, path in enumerate(files):
        file = np.load(path)
        assert (arrays["parameters"][row] == file["parameters"]).all()
        positions, velocities = decoded(file, mesh)
        for index, time in enumerate(TIMES):
            stored = np.flatnonzero(abs(file["times"] - time) < 1e-9)
            if len(stored):
                assert (arrays["positions"][row, index] == positions[stored[0]]).all()
                assert (arrays["velocities"][row, index] == velocities[stored[0]]).all()
            else:
                # A rigid translation from the last snapshot.
                shift = arrays["positions"][row, index] - positions[-1]
                speed = arrays["velocities"][row, index]
                expected = speed * (time - file["times"][-1])
                assert time > file["times"][-1] and (speed == speed[0]).all() and (speed[:, 1:] == 0).all()
                assert abs(speed[0, 0] - velocities[-1, :, 0].mean()) < 1e-3
                np.testing.assert_allclose(shift, expected, atol=1e-12)
    ends = [np.load(path)["times"][-1] for path in files]
    assert min(ends) < TIMES[-1], "no configuration was extended"


def test_h5py_reads_the_same_arrays(database, arrays, tmp_path):
    h5py = pytest.importorskip("h5py")
    export(database, "--hdf5", tmp_path / "arrays.h5")
    with h5py.File(tmp_path / "arrays.h5") as file:
        assert sorted(file) == sorted(arrays)
        for name, expected in arrays.items():
            found = file[name].asstr()[()] if expected.dtype.kind == "U" else file[name][()]
            assert found.shape == expected.shape and (found == expected).all(), name


def test_paraview_reads_the_series(database, arrays, tmp_path):
    meshio, pyvista = pytest.importorskip("meshio"), pytest.importorskip("pyvista")
    export(database, "--vtu", tmp_path / "series")
    heading, *rows = (tmp_path / "series/parameters.csv").read_text().splitlines()
    assert heading == "series,capillary_number,confinement" and len(rows) == 2
    for row, line in enumerate(rows):
        name, *parameters = line.split(",")
        assert [float(value) for value in parameters] == arrays["parameters"][row].tolist()
        reader = pyvista.get_reader(str(tmp_path / "series" / name))
        assert reader.time_values == TIMES
        for index, time in enumerate(TIMES):
            reader.set_active_time_value(time)
            grid = reader.read()[0]
            mesh = meshio.read((tmp_path / "series" / name).with_name(f"capsule_{index:04}.vtu"))
            assert [cells.type for cells in mesh.cells] == ["triangle6"]
            assert (mesh.cells[0].data == arrays["elements"]).all()
            for points, velocities in [
                (grid.points, grid.point_data["velocity"]),
                (mesh.points, mesh.point_data["velocity"]),
            ]:
                assert (points == arrays["positions"][row, index]).all()
                assert (velocities == arrays["velocities"][row, index]).all()


def test_the_stl_file_is_a_closed_surface(tmp_path):
    pyvista = pytest.importorskip("pyvista")
    path = tmp_path / "capsule.stl"
    answer = command("predict", "--ca", 0.1, "--confinement", 0.9, "--t", 8, "--stl", path)["instants"][0]
    surface = pyvista.read(path)
    assert (surface.n_cells, surface.n_points, surface.n_open_edges) == (5408, 2706, 0)
    # The triangles lie within the curved surface, where that is convex.
    assert 0.99 * answer["volume"] < surface.volume < answer["volume"]
    length = surface.bounds[1] - surface.bounds[0]
    assert abs(length - answer["axial_length"]) < 1e-3
