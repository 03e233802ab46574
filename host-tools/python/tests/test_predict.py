"""The package against the command line, and its contract of shapes, errors and arrays."""

import json
import os
import subprocess

import numpy as np
import pytest

import capsule_rom

CLI = os.environ.get("CAPSULE_ROM_COMMAND")


@pytest.fixture(scope="module")
def model():
    return capsule_rom.load()


def command(*arguments):
    if CLI is None:
        pytest.skip("CAPSULE_ROM_COMMAND names the command to compare with")
    return json.loads(subprocess.run([CLI, *arguments, "--json"], check=True, capture_output=True, text=True).stdout)


@pytest.mark.parametrize("method", ["direct", "paper"])
def test_numbers_have_the_bits_of_the_command_line(model, method):
    answer = model.predict(0.06, 0.97, method=method)
    times = [0.4, 3.0, 8.0]
    expected = command("predict", "--ca", "0.06", "--confinement", "0.97", "--t", "0.4,3,8", "--method", method)
    observables = answer.observables(times)
    assert model.digest == expected["model_digest"]
    for index, row in enumerate(expected["instants"]):
        for name in ["axial_length", "half_width", "half_diagonal", "rear_depth", "velocity"]:
            assert getattr(observables, name)[index] == np.float32(row[name]), name
        assert answer.volume(times)[index] == np.float32(row["volume"])
        assert answer.expected_error(times)[index] == np.float32(row["expected_error"])
        assert answer.bound(times)[index] == np.float32(row["error_bound"])


def test_fields_and_totals_have_the_bits_of_the_command_line(model, tmp_path):
    file = tmp_path / "fields.npz"
    arguments = ["predict", "--ca", "0.05", "--confinement", "0.9", "--t", "5", "--fields", "all"]
    row = command(*arguments, "--npz", str(file))["instants"][0]
    answer = model.predict(0.05, 0.9)
    totals = answer.totals(5.0)
    for name in ["area", "energy", "pressure_drop"]:
        assert getattr(totals, name) == np.float32(row[name]), name
    stored, fields = np.load(file), answer.fields(5.0)
    for name in fields._fields:
        np.testing.assert_array_equal(getattr(fields, name), stored[name][0].astype(np.float32), err_msg=name)
    np.testing.assert_array_equal(answer.positions(5.0), stored["positions"][0].astype(np.float32))
    np.testing.assert_array_equal(answer.velocities(5.0), stored["velocity"][0].astype(np.float32))


def test_arrays_broadcast(model):
    answer = model.predict([[0.03], [0.06], [0.1]], [0.85, 0.95])
    assert answer.shape == (3, 2)
    times = np.linspace(0.0, 8.0, 5)
    lengths = answer.observables(times).axial_length
    assert lengths.shape == (3, 2, 5) and lengths.dtype == np.float32
    single = model.predict(0.06, 0.95)
    np.testing.assert_array_equal(lengths[1, 1], single.observables(times).axial_length)
    outline = answer.outline("midplane", 8.0)
    assert outline.shape == (3, 2, len(model.node_set("midplane")), 2)
    np.testing.assert_array_equal(outline[1, 1], single.outline("midplane", 8.0))
    # A point of the outline z = 0 is a node.
    nodes = single.positions(8.0, model.node_set("midplane"))
    np.testing.assert_allclose(outline[1, 1, :, 0], nodes[:, 0], rtol=1e-6)
    assert model.predict(np.empty(0), 0.9).observables(1.0).velocity.shape == (0,)


def test_an_array_is_filled_in_place(model):
    out = np.zeros((2, model.node_count, 3), dtype=np.float32)
    assert model.predict(0.1, 0.9).positions([0.0, 1.0], out=out) is out
    # At t = 0 the capsule is a sphere of radius a/l.
    np.testing.assert_allclose(np.linalg.norm(out[0], axis=-1), 0.9, rtol=2e-3)
    for wrong in [np.zeros((2, 3, 3), np.float32), np.zeros(out.shape), np.asfortranarray(out)]:
        with pytest.raises(ValueError, match="float32"):
            model.predict(0.1, 0.9).positions([0.0, 1.0], out=wrong)


def test_refused_queries_say_why(model):
    with pytest.raises(capsule_rom.QueryError, match="no steady state"):
        model.predict(0.15, 1.1).volume(1.0)
    with pytest.raises(capsule_rom.QueryError, match="query 1: .*sampled range"):
        model.predict([0.05, 0.05], [0.9, 3.0]).volume(1.0)
    with pytest.raises(capsule_rom.QueryError, match="the model has 2 parameters, the query 1"):
        model.predict(0.1)
    with pytest.raises(capsule_rom.QueryError, match="instant"):
        model.predict(0.1, 0.9, invalid="nan").volume(1e6)
    with pytest.raises(ValueError, match="method"):
        model.predict(0.1, 0.9, method="fast")
    with pytest.raises(ValueError, match="frame"):
        model.predict(0.1, 0.9).positions(1.0, frame="moving")
    with pytest.raises(IndexError):
        model.predict(0.1, 0.9).positions(1.0, nodes=[-1])
    with pytest.raises(KeyError):
        model.node_set("equator")


def test_a_map_may_reach_beyond_the_domain(model):
    ca = np.linspace(0.01, 0.6, 8)
    answer = model.predict(ca, 0.9, invalid="nan")
    inside = answer.domain == "inside"
    lengths = answer.observables(8.0).axial_length
    assert inside.any() and not inside.all()
    np.testing.assert_array_equal(np.isnan(lengths), ~inside)
    assert model.steady_limit(0.9) is not None
    np.testing.assert_array_equal(inside, ca <= model.steady_limit(np.full(8, 0.9)))


def test_an_extrapolated_answer_has_no_bound(model):
    answer = model.predict(0.21, 0.8, extrapolate=True)
    assert answer.domain != "inside" and np.isnan(answer.bound(0.4)) and answer.expected_error(0.4) > 0


def test_model_files(model, tmp_path):
    assert model.method == "direct" and model.bending_stiffness == pytest.approx(1e-4)
    assert "neo-Hookean" in model.errors_against and model.end_time >= 8
    assert model.elements.shape[1] == 6 and model.elements.max() == model.node_count - 1
    assert [parameter.min > 0 for parameter in model.parameters] == [True, True]
    assert model.samples.shape[1] == 2 and len(np.unique(model.samples, axis=0)) == len(model.samples)
    bad = tmp_path / "bad.crom"
    bad.write_bytes(b"not a model")
    with pytest.raises(capsule_rom.ModelFileError, match="CROM|truncated"):
        capsule_rom.load(bad)
    with pytest.raises(OSError):
        capsule_rom.load(tmp_path / "missing.crom")


def test_the_enclosed_volume_is_the_sphere_s(model):
    confinement = np.array([0.8, 0.9, 1.0])
    volumes = model.predict(0.05, confinement).volume([0.0, 4.0, 8.0])
    np.testing.assert_allclose(volumes, (4 / 3 * np.pi * confinement**3)[:, None] * np.ones(3), rtol=2e-3)
