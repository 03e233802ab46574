"""Runs of the full-order model against the command line, and their manners."""

import signal
import threading
import time

import numpy as np
import pytest
from test_predict import command

import capsule_rom


def test_a_run_has_the_bits_of_the_command_line(tmp_path):
    ticks = []
    done = threading.Event()

    def count():
        while not done.wait(1e-4):
            ticks.append(time.monotonic())

    thread = threading.Thread(target=count)
    thread.start()
    before = len(ticks)
    run = capsule_rom.fom.run(0.1, 0.8, mesh=4, end_time=0.25, snapshot_interval=0.1)
    counted = len(ticks) - before
    done.set()
    thread.join()
    # Another thread ran meanwhile: the interpreter was free.
    assert counted > 10
    file = tmp_path / "run.npz"
    options = ["--mesh", "4", "--end-time", "0.25", "--snapshot-interval", "0.1"]
    options += ["--fields", "stretch", "--npz", str(file), "--quiet"]
    expected = command("fom", "run", "--ca", "0.1", "--confinement", "0.8", *options)
    stored = np.load(file)
    np.testing.assert_array_equal(run.times, expected["t"])
    np.testing.assert_array_equal(run.positions, stored["positions"])
    np.testing.assert_array_equal(run.velocities, stored["velocity"])
    np.testing.assert_array_equal(run.elements, stored["elements"])
    for name in ["axial_length", "half_width", "half_diagonal", "rear_depth", "pressure_drop"]:
        np.testing.assert_array_equal(getattr(run, name), expected[name], err_msg=name)
    np.testing.assert_array_equal(run.velocity, expected["centroid_velocity"])
    assert (run.status, run.steady_time) == (expected["status"], expected["steady_time"])
    assert (run.volume_drift, run.velocity_evaluations) == (expected["volume_drift"], expected["velocity_evaluations"])


def test_settings_are_those_of_the_command():
    with pytest.warns(RuntimeWarning, match="a film of 0.100 l"):
        run = capsule_rom.fom.run(0.1, 0.9, mesh=3, membrane="p2", integrator="ralston", step=1e-3, end_time=0.02)
    options = "--mesh 3 --membrane p2 --integrator ralston --step 1e-3 --end-time 0.02".split()
    expected = command("fom", "run", "--ca", "0.1", "--confinement", "0.9", "--quiet", *options)
    np.testing.assert_array_equal(run.axial_length, expected["axial_length"])
    assert run.velocity_evaluations == expected["velocity_evaluations"]


def test_a_signal_ends_a_run():
    calls = []

    def handler(*_):
        calls.append(None)
        # A run that never looks for signals would meet them all at once, after its end.
        if len(calls) == 3:
            raise KeyboardInterrupt

    previous = signal.signal(signal.SIGALRM, handler)
    signal.setitimer(signal.ITIMER_REAL, 0.05, 0.05)
    try:
        with pytest.raises(KeyboardInterrupt):
            capsule_rom.fom.run(0.1, 0.9)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, previous)


def test_what_cannot_run_is_refused():
    for arguments, words in [
        ({"ca": -0.1}, "capillary number Ca is -0.1"),
        ({"confinement": 3.0}, "does not fit in the duct"),
        ({"mesh": 0}, "mesh frequency 0 is out of range"),
        ({"tolerance": 0.0}, "tolerance of the time integrator is 0"),
        ({"snapshot_interval": 1e-9}, "too many"),
    ]:
        with pytest.raises(capsule_rom.SolverError) as error:
            capsule_rom.fom.run(**{"ca": 0.1, "confinement": 0.9, "mesh": 3, **arguments})
        assert words in str(error.value)
    with pytest.raises(ValueError, match="integrator \"heun\" is unknown"):
        capsule_rom.fom.run(0.1, 0.9, integrator="heun")
