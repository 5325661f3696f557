"""Experiments in the true field and comparison of the sources; each planted defect fails a check.

The C calls libm's sines, which makes emission faster; other tests cover the polynomials.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from designs.hall_position.paper import layouts
from designs.planar_6dof import lqg
from designs.planar_6dof.sensing import sections as sensing
from models import planar_stage
from models.hall_stage import Stage
from studies.hall.loop import closed_loop, experiments, sources, stage_loop
from studies.hall.loop.stage_loop import Loop
from studies.hall.pages import loops as page_loops
from synth.analyse.loops.loop import sampled
from synth.fault import BRAKING_BIT
from synth.signals import signal_names
from synth.simulate.experiments import Experiment
from synth.simulate.scenario import Override
from tests import tools

pytestmark = pytest.mark.whole


@cache
def loops() -> dict[str, Loop]:
    return dict(experiments.loops(libm=True))


def failed_names(experiment: Experiment) -> set[str]:
    return {check.name for check in experiment.checks if not check.passed}


@pytest.mark.parametrize(
    "make", [experiments.standstill, experiments.staircase, experiments.dropouts, experiments.loss]
)
def test_the_calibrated_loop_keeps_its_bars(make: object) -> None:
    assert callable(make)
    assert failed_names(make(loops()["calibrated"])) == set()


@pytest.mark.parametrize("name", ["plain", "calibrated"])
def test_the_step_of_4_mm(name: str) -> None:
    experiment = experiments.step(loops()[name], name)
    assert failed_names(experiment) == set()
    assert experiment.figures["motion as estimated, mm"] == pytest.approx(4.0, abs=2e-3)


def test_the_step_without_calibration_would_not_pass_for_the_calibrated_one() -> None:
    assert failed_names(experiments.step(loops()["plain"], "calibrated")) == {"error of the motion"}


def test_the_zigzag() -> None:
    plain, calibrated = experiments.zigzags(loops())
    assert failed_names(plain) == failed_names(calibrated) == set()
    assert plain.figures["x and y, um rms"] > 60


def test_the_response_to_a_wrong_sample_is_that_of_the_linear_loop() -> None:
    source, plant = closed_loop.Source(Stage().array(layouts.LAYOUTS[5])), planar_stage.plant()
    block = closed_loop.controller(lqg.NAME, plant, lqg.TIME, lqg.law(plant), source).rounded(np.float32)
    parts = page_loops.open_loop(source, block, {})
    T = lqg.TIME.period_s
    stage, law = sampled(parts.plant, T, parts.delay * T), parts.controller
    x, state, distances = np.zeros(len(stage.states)), np.zeros(len(law.states)), []
    for k in range(200):
        seen = stage.C @ x + (k == 0) * (np.array(stage.outputs) == "x")
        x, state = stage.A @ x + stage.B @ (law.C @ state + law.D @ seen), law.A @ state + law.B @ seen
        distances.append(abs(x[stage.states.index("x")]))
    assert 0.94 * experiments.RESPONSE < max(distances) < experiments.RESPONSE


def test_no_current_flows_until_a_position_is_known() -> None:
    loop, samples = loops()["calibrated"], 400
    blind, rng = np.arange(samples) < 200, np.random.default_rng(4)
    nonsense = {n: Override(blind, rng.uniform(-4, 4, samples)) for n in planar_stage.HALL}
    run = loop.run(samples * stage_loop.TIME.period_s, {"x": 1e-3}, {"x": 5e-3}, overrides=nonsense)
    currents = np.abs([run.commands[s.name] for s in planar_stage.INPUTS])
    assert not currents[:, :200].any() and currents[:, 200:].any()
    assert np.abs(run["x_raw"] - run["x"])[run["valid"] > 0].max() < 3e-4  # whatever was searched, in its own pitch
    shorter = {n: replace(o, mask=np.arange(samples) < 3) for n, o in nonsense.items()}
    run = loop.run(samples * stage_loop.TIME.period_s, {"x": 1e-3}, {"x": 5e-3}, overrides=shorter)
    first = int(np.argmax(run["valid"] > 0))
    assert first >= 3 and not np.abs([run.commands[s.name][: first + 1] for s in planar_stage.INPUTS]).any()
    assert run["x"][-1] == pytest.approx(1e-3, abs=1e-4) and not run.faults.any()


@cache
def comparison() -> Experiment:
    by_name = {sources.SECTIONS: stage_loop.of_sections(libm=True), sources.OPTIMISED: loops()["calibrated"]}
    return sources.experiment(by_name)


def test_the_estimate_is_twice_as_near_to_its_path_as_the_sections() -> None:
    assert [check.name for check in comparison().checks if not check.passed] == []


@tools.needs_arm_gcc
def test_the_estimate_costs_some_times_as_much() -> None:
    by_sections, optimised = (
        comparison().figures[f"{name}: instructions, {sources.BUILD}"] for name in (sources.SECTIONS, sources.OPTIMISED)
    )
    assert 3 < optimised / by_sections < 12  # functions of libm among them


def test_both_controllers_have_the_same_wires() -> None:
    plant = planar_stage.plant()
    source = loops()["calibrated"].rig.stage.controller.block
    sections = lqg.controller(plant)
    assert signal_names(source.inputs) == signal_names(sections.inputs) and signal_names(
        source.outputs
    ) == signal_names(sections.outputs)
    # This loop neither brakes nor estimates the amplitude, and no bit says that a set-point is followed late.
    of_sections = (BRAKING_BIT, sensing.AMPLITUDE_BIT, *lqg.LATE.values())
    assert source.faults == tuple(f for f in sections.faults if f.bit not in of_sections)
    assert planar_stage.hall_places(plant)[1][0] == plant.parameter("spacing").value
