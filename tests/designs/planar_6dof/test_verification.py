"""What is replayed holds what it is said to hold, and single precision that is wrong does not pass for right."""

from dataclasses import replace

import numpy as np
import pytest

from designs.planar_6dof import interface, random_steps, verification
from designs.planar_6dof import loop as loops
from designs.planar_6dof.random_steps import Subject
from designs.planar_6dof_leadlag import design as leadlag
from designs.planar_6dof_lqg import design as lqg
from models import planar_stage
from synth.blocks.guard import safety
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory
from synth.timing import Discrete
from synth.verify import agree, standard, suite
from tests.designs.planar_6dof import planted

DESIGNS = {"leadlag": leadlag.DESIGN, "lqg": lqg.DESIGN}
SUBJECTS = {"leadlag": leadlag.subject(), "lqg": lqg.subject()}
PITCH = planar_stage.plant().parameter("l").value
WHOLE = 5.0  # s of the tour


def loop_of(subject: Subject) -> Rig:
    return loops.of(subject.block)


@pytest.fixture(scope="module", params=SUBJECTS)
def runs(request: pytest.FixtureRequest) -> dict[str, Trajectory]:
    subject = SUBJECTS[request.param]
    recorded = verification.record_runs(loop_of(subject), subject.step, WHOLE)
    assert recorded["replay of a saturated step"]["x"].max() > 0.95 * subject.step
    return recorded


def test_the_tour_crosses_pitches_and_sections_both_ways(runs: dict[str, Trajectory]) -> None:
    run = runs[f"replay of {WHOLE:g} s"]
    for axis in "xy":
        for width, least in ((PITCH, 1), (PITCH / 4, 5)):  # borders at odd halves of a pitch, at odd eighths
            border = np.diff(np.floor(run[axis] / width + 0.5))
            assert np.count_nonzero(border > 0) >= least and np.count_nonzero(border < 0) >= least
    assert all(np.ptp(run[axis]) > high for axis, high in verification.TILTS.items())
    assert not run.faults.any()


def test_the_step_is_beyond_the_motors(runs: dict[str, Trajectory]) -> None:
    run = runs["replay of a saturated step"]
    # The LQG law limits its error, so that the motors push at their limit for 10 ms.
    assert np.count_nonzero(random_steps.is_saturated(run.commands)) > 5
    assert not run.faults.any()


def test_bad_samples_alone_do_not_latch_and_in_the_end_do(runs: dict[str, Trajectory]) -> None:
    run = runs["replay of faults"]
    latched = run.faults >> safety.LATCH_BIT > 0
    first = int(latched.argmax())
    assert latched.any() and run.time[first] > 0.8 and latched[first:].all()
    alone = {tuple(np.flatnonzero(run.faults[:first] >> k & 1)) for k in range(safety.BRAKING_BIT)} - {()}
    assert {max(np.diff(k), default=100) for k in alone} & {1, 120, 150} and len(alone) == 4


def test_it_brakes_from_too_many_bad_samples_on(runs: dict[str, Trajectory]) -> None:
    """The bit stays set after the latch."""
    faults = runs["replay of faults"].faults
    first, braking = int((faults >> safety.LATCH_BIT > 0).argmax()), np.flatnonzero(faults >> safety.BRAKING_BIT & 1)
    assert braking.tolist() == list(range(first - interface.BRAKING, len(faults))) and faults[first - 1] > 0


def test_a_sensor_that_sticks_is_suspected_and_latches(runs: dict[str, Trajectory]) -> None:
    run = runs["replay of a sensor that sticks"]
    assert (run.faults >> safety.LATCH_BIT > 0).any()
    inputs = len(SUBJECTS["lqg"].block.inputs)
    assert (run.faults >> inputs & 0b111111).any()  # the bits of suspects follow those of the inputs


def test_too_many_steps_at_limits_do_not_pass() -> None:
    subject = replace(SUBJECTS["leadlag"], size=3.0)
    states, inputs = random_steps.operating_steps(subject, planar_stage.plant(), 1000)
    checks = verification.share_checks(states, agree.casadi(subject.block)(states, inputs))
    assert [c.name for c in checks if not c.passed] == ["share of random steps at a limit"]
    idle = replace(subject, size=1e-3)
    states, inputs = random_steps.operating_steps(idle, planar_stage.plant(), 1000)
    checks = verification.share_checks(states, agree.casadi(subject.block)(states, inputs))
    assert [c.name for c in checks if not c.passed] == ["share of random steps within all limits"]


def test_single_precision_that_is_wrong_does_not_pass(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(verification, "LONG", 3.0)
    subject = SUBJECTS["leadlag"]
    sound = loop_of(subject)
    assert all(c.passed for c in verification.single_against_double(sound, sound))
    name = "loop_y_gain"
    off = tuple(replace(c, value=1.001 * c.value) if c.name == name else c for c in subject.block.constants)
    wrong = replace(sound, controller=loops.compile_block(replace(subject.block, constants=off)))
    failed = [c.name for c in verification.single_against_double(sound, wrong) if not c.passed]
    assert "single less double, y" in failed


def test_decisions_of_single_precision_are_counted() -> None:
    subject = SUBJECTS["lqg"]
    by = suite.witnesses(subject.block, subject.reference, interface.SURROGATE_ERROR)
    drawn = random_steps.operating_steps(subject, planar_stage.plant(), 2000)
    a, checks = standard.compare_precisions(by, *drawn, verification.FLOOR, verification.COUNTS)
    assert a.faults_differ == 0 and 0 < a.worst < 1e-3 and all(c.passed for c in checks)
    first = subject.block.inputs[0].name
    spoilt = drawn[1] | {first: np.where(np.arange(2000) < 10, 5 + 1e-7, drawn[1][first])}
    wide = replace(by, c64=loops.compile_block(replace(subject.block, faults=()), np.float64))
    failed = standard.compare_precisions(wide, drawn[0], spoilt, verification.FLOOR, verification.COUNTS)[1][1]
    assert failed.value >= 10 / 2000


def test_the_tour_starts_at_rest() -> None:
    references = verification.tour(1.0, Discrete(1e-3))
    assert all(abs(values[0]) < 1e-12 and abs(values[1]) < 1e-4 for values in references.values())


@pytest.mark.parametrize(("name", "second"), [("leadlag", 1000), ("lqg", 800)])
def test_every_check_passes(name: str, second: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """In 2 s of replay and fewer random steps; `synth verify` replays 60 s, and draws 100,000."""
    monkeypatch.setattr(standard, "RANDOM_STEPS", 40_000)
    monkeypatch.setattr(verification, "QUICK_REPLAY", 2.0)
    messages: list[str] = []
    evidence = standard.verify(DESIGNS[name], messages.append, False)
    assert [c for c in evidence.checks if not c.passed] == []
    assert evidence.design == SUBJECTS[name].block.name and messages
    planted.require_witnesses(evidence, {"replay of 2 s": 2 * second, "random steps": 40_000})
