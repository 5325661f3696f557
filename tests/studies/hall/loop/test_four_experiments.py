"""The loop closed by four sensors keeps its bars in a field it does not know; each planted defect fails a check."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from models import planar_stage
from studies.hall.built_matrix import Mounting
from studies.hall.loop import experiments, four_experiments, four_sensors, stage_loop
from studies.hall.loop.stage_loop import Loop
from synth.check import Check
from synth.execute import host
from synth.simulate.experiment import Experiment

pytestmark = pytest.mark.whole

TURNED = np.radians(2)


@cache
def results() -> dict[str, Experiment]:
    return {e.name: e for e in four_experiments.run(lambda part: None)}


def failed_names(checks: tuple[Check, ...]) -> set[str]:
    return {check.name for check in checks if not check.passed}


def mounted(loop: Loop, change: Callable[[Mounting], Mounting], sensor: int = 0) -> Loop:
    """Return the loop with one sensor mounted in another way, which its calibration does not know."""
    mountings = [change(m) if k == sensor else m for k, m in enumerate(loop.bench.mountings)]
    bench = replace(loop.bench, mountings=tuple(mountings))
    plant = stage_loop._true_plant(bench, loop.gain_ratio)
    return replace(loop, bench=bench, rig=replace(loop.rig, plant=plant))


def with_defect(loop: Loop, old: str, new: str) -> Loop:
    """Return the loop with `old` in its C being `new`."""
    name = f"{loop.rig.stage.controller.name}.c"
    text = loop.emitted.files[name]
    assert text.count(old) == 1
    wrong = host.load({**loop.emitted.files, name: text.replace(old, new)}, loop.emitted.manifest)
    return replace(loop, rig=replace(loop.rig, controller=wrong))


def test_figures_10_to_12_and_failures_keep_their_bars() -> None:
    assert {name: failed_names(e.checks) for name, e in results().items()} == {name: set() for name in results()}
    names = ("rest", "step_plain", "step_calibrated", "zigzag_plain", "zigzag_calibrated", "staircase", "loss")
    assert set(results()) == {f"{name}_four" for name in (*names, "failures")}


def test_each_experiment_in_which_the_estimate_is_trusted_says_so() -> None:
    trusted = {"not valid", "misleading", "beyond 4 sigma", "valid and wrong", "first valid sample"}
    for name, e in results().items():
        names = {check.name for check in e.checks}
        assert trusted <= names or name in ("failures_four", "loss_four")
        assert ("estimate differs from the shipped C" in names) == ("plain" in name)


def staircase(loop: Loop) -> Experiment:
    e = experiments.staircase(loop)
    return replace(e, checks=(*e.checks, *four_experiments.trusted_checks(e.trajectory)))


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("calibrated", lambda m: replace(m, angle=m.angle + TURNED)),
        ("plain", lambda m: replace(m, gains=(-m.gains[0], -m.gains[1]))),
    ],
    ids=["turned by two degrees after the calibration", "of the other sign"],
)
def test_a_sensor_that_is_not_as_calibrated_is_detected(name: str, change: Callable[[Mounting], Mounting]) -> None:
    """The planted defects: the estimate is not valid, and no current flows."""
    e = staircase(mounted(four_sensors.loops()[name], change))
    assert "not valid" in failed_names(e.checks) and not e.trajectory["valid"].any()
    assert not any(e.trajectory.commands[s.name].any() for s in planar_stage.INPUTS)


def test_a_position_of_the_wrong_sign_is_detected() -> None:
    """The planted defect: in the C of the loop, not in the estimator that the checks read."""
    loop = with_defect(
        four_sensors.loops()["plain"], "X = (length_per_phase * phase_x)", "X = -(length_per_phase * phase_x)"
    )
    assert "a step truly" in failed_names(staircase(loop).checks)


def test_an_estimate_that_is_used_while_it_is_not_valid_is_detected() -> None:
    """The planted defect: the loop follows whatever the estimator says, from its search on."""
    loop = with_defect(
        four_sensors.loops()["calibrated"], "const bool valid = phases_valid", "const bool valid = true || phases_valid"
    )
    assert failed_names(four_experiments.failures(loop).checks) == {"latched"}


def test_sensors_at_other_places_are_detected() -> None:
    """The planted defect: 0.3 mm along X, to alternating sides."""
    loop = four_sensors.loops()["calibrated"]
    places = tuple((x + 3e-4 * (-1) ** k, y) for k, (x, y) in enumerate(loop.bench.places))
    bench = replace(loop.bench, places=places)
    rig = replace(loop.rig, plant=stage_loop._true_plant(bench, loop.gain_ratio))
    assert failed_names(staircase(replace(loop, bench=bench, rig=rig)).checks)


def test_an_estimate_that_is_not_that_of_the_shipped_c_is_detected() -> None:
    plain = four_sensors.loops()["plain"]
    run = results()["step_plain_four"].trajectory
    assert four_experiments.shipped_check(run, plain).passed
    other = replace(plain, rig=replace(plain.rig, controller=four_sensors.loops()["calibrated"].rig.controller))
    assert not four_experiments.shipped_check(run, other).passed
    shifted = replace(run, outputs=dict(run.outputs) | {"X": np.nextafter(np.float32(run["X"]), np.float32(1))})
    assert not four_experiments.shipped_check(shifted, plain).passed
