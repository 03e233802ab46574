"""Identification against the command line, and against capsules that are known."""

import numpy as np
import pytest
from test_predict import command

import capsule_rom

HALF_WIDTH_UM = 25.0
SETUP = {"half_width_um": HALF_WIDTH_UM, "viscosity_pa_s": 0.8, "velocity_mm_s": 5.0}
OPTIONS = ["--half-width-um", "25", "--viscosity-pa-s", "0.8", "--velocity-mm-s", "5"]


@pytest.fixture(scope="module")
def model():
    return capsule_rom.load()


def closed(half):
    """A contour in um from half an outline in l."""
    half = HALF_WIDTH_UM * np.asarray(half, dtype=np.float64)
    return np.concatenate([half, half[-2:0:-1] * [1, -1]])


@pytest.mark.parametrize("observable", ["midplane", "silhouette"])
def test_a_contour_gives_the_numbers_of_the_command(model, tmp_path, observable):
    answer = model.predict(0.06, 0.85)
    half = answer.outline("midplane", 20.0) if observable == "midplane" else answer.silhouette(20.0)
    contour = closed(half)
    found = model.identify(contour, observable=observable, flow="right", **SETUP)
    file = tmp_path / "contour.csv"
    np.savetxt(file, contour, delimiter=",", header="x_um,y_um", comments="", fmt="%.17g")
    options = [*OPTIONS, "--observable", observable, "--flow", "right"]
    expected = command("identify", str(file), *options)
    for key in ["verdict", "ca", "ca_68", "ca_95", "radius_um", "radius_um_95", "gs_n_per_m", "gs_n_per_m_95"]:
        assert found.details[key] == expected[key], key
    assert model.identify(file, observable=observable, flow="right", **SETUP).ca == found.ca
    # The capsule that was drawn: G_s = mu V / Ca.
    assert found.identified
    assert found.ca.value == pytest.approx(0.06, rel=0.01)
    assert found.radius_um.value == pytest.approx(0.85 * HALF_WIDTH_UM, rel=0.001)
    assert found.gs_n_per_m.value == pytest.approx(0.8 * 5e-3 / 0.06, rel=0.01)
    low, high = found.ca.interval_95
    assert low <= found.ca.value <= high
    # Every point of the contour lies beside the outline of the fit.
    gaps = np.linalg.norm(contour[:, None] - found.fit_um[None], axis=2).min(axis=1)
    assert gaps.max() < 0.1


def test_a_dent_line_gives_the_numbers_of_the_command(model, tmp_path):
    answer = model.predict(0.06, 0.95)
    random = np.random.default_rng(3)
    section = answer.outline("midplane", 20.0)
    behind = section[section[:, 0].argmin() :]
    contour, line = (
        points + 0.08 * random.normal(size=points.shape) for points in (closed(answer.silhouette(20.0)), closed(behind))
    )
    files = [tmp_path / "contour.csv", tmp_path / "line.csv"]
    for file, points in zip(files, (contour, line)):
        np.savetxt(file, points, delimiter=",", header="x_um,y_um", comments="", fmt="%.17g")
    setup = {"observable": "silhouette", "flow": "right", **SETUP}
    found = model.identify(contour, dent_line=line, **setup)
    options = [*OPTIONS, "--observable", "silhouette", "--flow", "right", "--dent-line", str(files[1])]
    expected = command("identify", str(files[0]), *options)
    for key in ["verdict", "ca", "ca_95", "radius_um_95", "dent_line_residual_um"]:
        assert found.details[key] == expected[key], key
    assert model.identify(files[0], dent_line=files[1], **setup).ca == found.ca
    alone = model.identify(contour, **setup)
    assert np.ptp(found.ca.interval_95) < 0.8 * np.ptp(alone.ca.interval_95)
    with pytest.raises(capsule_rom.MeasurementError, match="contour"):
        model.identify(dent_line=line, axial_length_um=(49.2, 0.2), width_um=(41.6, 0.2), **setup)


def test_pixels_and_lengths(model):
    contour = closed(model.predict(0.06, 0.85).outline("midplane", 20.0))
    in_um = model.identify(contour, observable="midplane", flow="right", pixel_um=0.25, unit="um", **SETUP)
    in_px = model.identify(contour / 0.25, observable="midplane", flow="right", pixel_um=0.25, **SETUP)
    assert in_px.ca.value == pytest.approx(in_um.ca.value, rel=1e-9)
    lengths = {"axial_length_um": (49.2, 0.2), "width_um": (41.6, 0.2), "rear_depth_um": (8.5, 0.3)}
    found = model.identify(observable="midplane", **lengths, **SETUP)
    options = [f"--{name.replace('_', '-')}={value},{deviation}" for name, (value, deviation) in lengths.items()]
    expected = command("identify", *options, *OPTIONS, "--observable", "midplane")
    assert found.details["ca_95"] == expected["ca_95"]


def test_what_cannot_be_is_refused(model):
    contour = closed(model.predict(0.06, 0.85).outline("midplane", 20.0))

    def identify(points, **changes):
        return model.identify(points, **{"observable": "midplane", **SETUP, **changes})

    for points, words in [(contour[:8], "12"), (contour[:, :1], "(points, 2)"), (2 * contour, "wide")]:
        with pytest.raises(capsule_rom.MeasurementError) as error:
            identify(points)
        assert words in str(error.value)
    with pytest.raises(capsule_rom.MeasurementError, match="pixel_um"):
        identify(contour, unit="px")
    with pytest.raises(ValueError, match="observable"):
        identify(contour, observable="side")
    with pytest.raises(TypeError, match="velocity_mm_s"):
        identify(contour, flow_rate_ul_min=0.75)


def test_the_silhouette_holds_the_projected_nodes(model):
    answer = model.predict(0.05, 0.9)
    positions = answer.positions(8.0).astype(float)
    for angle in [0.0, 0.4]:
        half = answer.silhouette(8.0, angle=angle, points=801).astype(float)
        width = positions[:, 1] * np.cos(angle) + positions[:, 2] * np.sin(angle)
        assert half[:, 1].max() == pytest.approx(width.max(), abs=2e-3)
        assert half[0, 0] == pytest.approx(positions[:, 0].max(), abs=2e-3)
    assert answer.silhouette([1.0, 2.0], points=65).shape == (2, 65, 2)
    with pytest.raises(ValueError, match="at least 3"):
        answer.silhouette(1.0, points=2)
