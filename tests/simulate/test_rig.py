"""The rig: default set-points, noise that does not depend on the length of the run, and changed plants."""

from dataclasses import replace

import numpy as np
import pytest

from synth.app import standard_tasks
from synth.block import Step, build
from synth.errors import WiringError
from synth.execute.host import compile_block
from synth.signals import Signal
from synth.simulate.rig import Rig
from tests import levitator

PID = levitator.design()


@pytest.fixture(scope="module")
def rig() -> Rig:
    return standard_tasks.rig(PID.DESIGN, np.float64)


def test_a_set_point_that_is_not_given_stays_where_its_position_starts(rig: Rig) -> None:
    run = rig.run(0.2, {"z": 2e-4})
    assert (run.measured["z_ref"] == 2e-4).all() and (run.measured["x_ref"] == 0).all()
    assert abs(run["z"][-1] - 2e-4) < 1e-6


def test_a_set_point_that_is_not_given_stays_within_its_range_where_its_position_starts_on_a_stop(rig: Rig) -> None:
    points = tuple(replace(s, high=2e-4) if s.of == "z" else s for s in rig.stage.interface.set_points)
    run = rig.with_interface(set_points=points).run(0.01, {"z": 5e-4})
    assert run["z"][0] == 5e-4 and (run.measured["z_ref"] == 2e-4).all()


def test_a_set_point_that_names_its_sensor_starts_at_the_position_behind_it(rig: Rig) -> None:
    interface = rig.stage.interface
    sensors = tuple(replace(s, name="probe") if s.of == "x" else s for s in interface.sensors)
    points = tuple(replace(s, of="probe") if s.of == "x" else s for s in interface.set_points)
    read = rig.with_interface(sensors=sensors, set_points=points)
    assert read.set_points_at({"x": 2e-4}) == {"z_ref": 0.0, "x_ref": 2e-4}


def test_a_stage_may_start_elsewhere(rig: Rig) -> None:
    elsewhere = replace(rig, stage=replace(rig.stage, start={"x": 3e-4}))
    assert elsewhere.run(0.01)["x"][0] == 3e-4
    assert elsewhere.at_rest() == {"z": 0.0, "x": 3e-4, "z_ref": 0.0, "x_ref": 3e-4}


def test_sensors_show_counts_and_ideal_ones_do_not(rig: Rig) -> None:
    counts = rig.run(0.05, {"z": 1.23456789e-4}).measured["z"] / 1e-7
    np.testing.assert_allclose(counts, np.rint(counts), rtol=0, atol=1e-6)
    assert rig.ideal.run(0.05, {"z": 1.23456789e-4}).measured["z"][0] == 1.23456789e-4


def test_noise_of_a_short_run_begins_that_of_a_long_one(rig: Rig) -> None:
    sensors = rig.stage.interface.sensors
    loud = rig.with_interface(sensors=tuple(replace(s, noise=1e-7, resolution=0.0) for s in sensors))
    short, long = (loud.run(T).measured["x"] for T in (0.05, 0.1))
    np.testing.assert_array_equal(short, long[: len(short)])
    other = replace(loud, seed=1).run(0.05).measured["x"]
    assert not np.array_equal(short, other) and 5e-8 < np.std(short) < 2e-7
    assert 0 < np.abs(loud.ideal.run(0.05).measured["x"]).max() < 1e-10  # dithered


def test_the_plant_may_be_another_than_the_controller_knows(rig: Rig) -> None:
    heavy = replace(rig, plant=rig.plant.with_parameters(M=1.6))
    assert np.abs(heavy.run(0.05)["z"]).max() > 1.2 * np.abs(rig.run(0.05)["z"]).max()


def test_wires_may_mix_the_controllers_outputs(rig: Rig) -> None:
    halved = replace(rig, actuators={"i1": "i1", "i2": {"i2": 0.5}})
    run = halved.run(0.05, references={"x_ref": 1e-4})
    np.testing.assert_allclose(run.applied["i2"][1:], 0.5 * run.commands["i2"][:-1])


def test_a_drive_that_reads_what_nothing_gives_is_refused_by_name(rig: Rig) -> None:
    coil, bridge = Signal("i_1", "A", -3, 3), Signal("bridge", "A", -3, 3)
    block = build("bridges", PID.TIME, lambda u, x, k: Step({"bridge": u["i_1"]}), inputs=[coil], outputs=[bridge])
    with pytest.raises(WiringError, match="drive 'bridges': nothing gives its input 'i_1': call it like one of i1, i2"):
        replace(rig, drive=(compile_block(block, np.float64),)).run(0.01)
