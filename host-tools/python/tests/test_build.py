"""Models from arrays in memory, against the command line and against a known motion."""

import subprocess

import numpy as np
import pytest
from family import arrays, motion, sphere
from test_predict import CLI

import capsule_rom


@pytest.fixture(scope="module")
def model():
    return capsule_rom.build(**arrays(), parameter_names=["stretch", "pull"], length_unit="mm")


def assert_same_file(folder, monkeypatch, options, given, **keywords):
    """The command makes the same file of these arrays in an NPZ archive."""
    if CLI is None:
        pytest.skip("CAPSULE_ROM_COMMAND names the command to compare with")
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    data, expected, found = (folder / name for name in ["data.npz", "expected.crom", "found.crom"])
    np.savez(data, **given)
    command = [CLI, "offline", "build", "--quiet", "--from", data, "--out", expected, *options]
    subprocess.run(command, check=True, capture_output=True)
    capsule_rom.build(**given, **keywords).save(found)
    assert found.read_bytes() == expected.read_bytes()


def test_a_model_of_arrays_is_the_command_s(tmp_path, monkeypatch):
    assert_same_file(tmp_path, monkeypatch, [], arrays())


def test_a_model_of_arrays_of_all_kinds_with_options_is_the_command_s(tmp_path, monkeypatch):
    given, step = arrays(), 1e-6
    nodes, elements = sphere()
    ahead, behind = (motion(nodes, given["parameters"], given["times"] + sign * step) for sign in (1, -1))
    given |= {
        "velocities": ((ahead - behind) / (2 * step)).astype(np.float32),
        "elements": elements.astype(">u2"),
        "times": np.asfortranarray(given["times"], dtype=np.longdouble),
        "positions": np.asfortranarray(given["positions"]),
        "parameter_names": np.array(["Q, flow", "k/µN"]),
        "length_unit": np.array("µm".encode()),
    }
    options = ["--split", '"Q, flow"=0.5', "--tolerance", "1e-3"]
    assert_same_file(tmp_path, monkeypatch, options, given, split=("Q, flow", 0.5), tolerance=1e-3)


def test_what_no_snapshot_has_is_predicted_within_the_bound(model):
    assert [parameter.name for parameter in model.parameters] == ["stretch", "pull"]
    assert model.units[0] == "mm"
    nodes, _ = sphere()
    places, times = np.random.default_rng(7).uniform(0.1, 0.9, (40, 2)), [0.4, 1.1, 1.9]
    answer = model.predict(*places.T)
    errors = np.linalg.norm(answer.positions(times) - motion(nodes, places, times), axis=-1).mean(axis=-1)
    assert (errors < answer.bound(times)).mean() >= 0.95
    assert errors.max() < 2e-3


def test_a_failed_save_leaves_the_old_file(model, tmp_path):
    with pytest.raises(FileNotFoundError):
        model.save(tmp_path / "missing" / "model.crom")
    file = tmp_path / "model.crom"
    model.save(file)
    assert [path.name for path in tmp_path.iterdir()] == ["model.crom"]
    assert capsule_rom.load(str(file)).digest == model.digest


@pytest.mark.parametrize(
    "changes, words",
    [
        ({"parameters": np.zeros((25, 5))}, "array `parameters` has shape (25, 5), expected (N, 1 to 4)"),
        ({"times": np.linspace(0, 2, 8)}, "array `positions` has shape (25, 9, 66, 3), expected (25, 8, N, 3)"),
        ({"times": np.linspace(1, 2, 9)}, "`times` must rise from 0, but start at 1"),
        ({"positions": arrays()["positions"].T}, "transpose it by `.T`"),
        ({"elements": arrays()["elements"] + 1}, "`elements - 1` counts from 0"),
        ({"elements": arrays()["elements"][:, ::-1]}, "`elements[:, ::-1]`"),
        ({"velocities": arrays()["positions"] * 1j}, "array `velocities` holds complex numbers (`<c16`)"),
        ({"velocities": np.zeros((25, 9, 66, 3))}, "`velocities` are not the rates of `positions`"),
        ({"positions": np.where(np.arange(3) == 1, np.nan, arrays()["positions"])}, "`positions[0, 0, 0, 1]` is NaN"),
        ({"parameter_names": ["a"]}, "array `parameter_names` holds 1 texts, expected 2"),
        ({"parameter_names": [1, 2]}, "array `parameter_names` holds numbers (`<i8`), expected text"),
        ({"split": ("pull", 0.0)}, "`pull` runs from 0 to 1, and the split must lie between"),
        ({"split": ("push", 0.5)}, "there is no parameter `push`: the parameters are stretch, pull"),
        ({"tolerance": -1.0}, "setting `tolerance` is -1"),
    ],
)
def test_bad_arrays_are_named(changes, words):
    with pytest.raises(capsule_rom.DataError) as error:
        capsule_rom.build(**{**arrays(), "parameter_names": ["stretch", "pull"], **changes})
    assert words in str(error.value)
