"""The sequences of both designs reach what they are there for: sections, pitches, limits, failures, every decision."""

import json
import re
from collections import Counter
from dataclasses import replace
from functools import cache
from itertools import combinations
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from designs.planar_6dof import allocation, cost_stimuli, interface
from designs.planar_6dof import loop as loops
from designs.planar_6dof_leadlag import design as leadlag
from designs.planar_6dof_lqg import design as lqg_design
from models import planar_stage
from synth.app import standard_tasks
from synth.blocks.guard import safety
from synth.emit.write import EmittedCode
from synth.execute import host
from synth.verify import meter, replays, standard, steps, stimuli
from synth.verify.steps import Steps
from tests import ceilings, tools

GENERATED = Path(__file__).parents[3] / "generated_c"
RECORDED = {
    "planar, recorded": ("travel", "saturated"),
    "planar, failures": ("failures", "failures again", "failures named", "braking"),
}
# gcc copies a decision into each path that leads to it, where part of it is decided: as shipped, copies of the
# diagnosis' flags go one way only. Without that each decision of the text is there once; clang copies none.
GCC = meter.Build("gcc, no copies", "gcc", ("-Os", "-fno-thread-jumps"))
ZIG = ceilings.BUILDS["zig, musl"]
THIN = 700  # steps of a sequence that is drawn at random
COSTLY = 500  # steps of each of those where the costliest steps are
# What nothing takes both ways: how many decisions of a line, and why.
UNREACHABLE = (
    (r"if \(\w+ && !(\w+|\(sensing_contradiction_left != 0u\))\) \{", 1, "one of them is known from above"),
    (
        r"if \((sensing_)?contradiction_confirmed != 0u\)",
        1,
        "tested in the function and for the fault word: once known",
    ),
    (
        r"if \((!measured|accepted_x_raw)\) \{",
        1,
        "gcc, no copies: tested again behind the branch that has just accepted",
    ),
)
LATCH = 1 << safety.LATCH_BIT


def emitted_code(name: str) -> EmittedCode:
    folder = GENERATED / name
    files = {path.name: path.read_text() for path in folder.glob("*.[ch]")}
    return EmittedCode(files, json.loads((folder / "manifest.json").read_text()))


class Subject(NamedTuple):
    """A design's shipped C, compiled, and the sequences that need no closed loop but the recording with faults."""

    emitted: EmittedCode
    controller: host.Controller
    sequences: dict[str, Steps]

    @property
    def every(self) -> Steps:
        """All sequences, those thinned that are drawn at random."""
        parts = [s if s.name.startswith("rare") else steps.thinned(s, THIN) for s in self.sequences.values()]
        return steps.concatenate("all", parts)


@cache
def subject(name: str) -> Subject:
    emitted = emitted_code(name)
    controller = host.load(emitted.files, emitted.manifest)
    at_rest = loops.of(BLOCKS[name], controller).at_rest()
    excursions = stimuli.excursions(controller, at_rest, [], cost_stimuli.stimuli(controller))
    return Subject(emitted, controller, {s.name: s for s in excursions})


NAMES = ("planar_6dof_leadlag", "planar_6dof_lqg")
DESIGNS = {d.DESIGN.name: d.DESIGN for d in (leadlag, lqg_design)}
BLOCKS = {d.DESIGN.name: d.subject().block for d in (leadlag, lqg_design)}


@cache
def recorded_inputs(name: str) -> dict[str, Any]:
    return dict(standard_tasks.replay_inputs(DESIGNS[name], subject(name).controller))


@pytest.fixture(params=NAMES)
def design(request: pytest.FixtureRequest) -> Subject:
    return subject(request.param)


def sizes(outputs: dict[str, Any]) -> np.ndarray:
    """Return the amplitude of each motor's current (3, N), A."""
    phases = [[np.asarray(outputs[f"i_{m}{p}"], dtype=float) for p in "ABC"] for m in planar_stage.MOTORS]
    return np.sqrt(2 / 3 * (np.array(phases) ** 2).sum(axis=1))


def test_the_replay_has_faults_and_latches_in_the_end(design: Subject) -> None:
    replay = design.controller.replay(recorded_inputs(design.emitted.manifest["design"]))
    words, latched = replay.faults & ~design.controller.status_mask, (replay.faults & LATCH) != 0
    first, braking = int(np.argmax(latched)), design.emitted.manifest["safety"].get("braking", 0)
    assert len(words) == stimuli.REPLAY_STEPS and 9500 <= first - braking < 9510 and latched[first:].all()
    for bit, name in enumerate(g.signal.name for g in interface.INPUTS):
        refused = name == "x_ref" or not name.endswith("_ref")
        assert (np.count_nonzero(words[:9500] >> bit & 1) >= 3) == refused, name
    assert np.count_nonzero(words[:9500]) < 150
    assert all(replay.outputs[s.name][-1] == 0 for s in interface.OUTPUTS)


def test_the_replay_is_the_hosts_to_the_bit() -> None:
    lqg = subject("planar_6dof_lqg")
    short = {name: column[-700:] for name, column in recorded_inputs("planar_6dof_lqg").items()}  # with the latch
    checks = replays.verify(lqg.emitted, short, "cortex-m4f", lambda _: None)
    assert checks and all(c.passed for c in checks), checks


def test_the_travel_goes_through_all_pairs_of_sections_both_ways_and_to_both_yaws() -> None:
    pose, pitch = cost_stimuli.poses(np.random.default_rng(0)), planar_stage.plant().parameter("l").value
    x, y = (np.floor(8 * pose[axis] / pitch) % 8 for axis in "xy")
    assert set(zip(x.tolist(), y.tolist(), strict=True)) == {(i, j) for i in range(8) for j in range(8)}
    for axis in "xy":
        count = np.round(pose[axis] / pitch)
        assert set(count) == {-2, -1, 0, 1, 2} and set(np.diff(count)) == {-1, 0, 1}
    high = allocation.BOX["phi"].high
    assert all(np.count_nonzero(pose["phi"] == end) > 500 for end in (-high, high))


def test_the_controller_follows_the_travel_in_all_pitches(design: Subject) -> None:
    """Some state holds x and some y, or two of them together, to within what they move in a few samples."""
    way, pose = design.sequences["travel"], cost_stimuli.poses(np.random.default_rng(cost_stimuli.SEED))
    at = np.linspace(0, cost_stimuli.TRAVEL - 1, len(way)).round().astype(int)
    held = [np.zeros(len(way)), *(way.states[name].astype(float) for name in way.states.dtype.names or ())]
    for axis in "xy":
        off = [np.abs(one + other - pose[axis][at])[10:].max() for one, other in combinations(held, 2)]
        assert min(off) < 3e-3


def test_every_motor_stands_at_its_limit_and_none_goes_beyond(design: Subject) -> None:
    (far,) = (s for s in cost_stimuli.stimuli(design.controller) if s.name == "saturated")
    outputs = steps.evaluate(design.controller, far).outputs
    amplitudes = sizes(outputs)
    # Both currents of a motor have limits of their own: only where both stand there its size is LIMIT.
    assert np.any(amplitudes > 0.999 * allocation.LIMIT, axis=1).all()
    assert amplitudes.max() < allocation.LIMIT * (1 + 3e-5)  # the polynomials change a current's size by 2e-5
    for s in interface.OUTPUTS:  # C seldom has all of its current, as the yaw is demanded too
        near = 0.5 if s.name.startswith("i_C") else 0.02
        assert all(np.count_nonzero(np.abs(outputs[s.name] - end) < near) > 5 for end in (s.low, s.high))


def test_every_input_fails_and_each_hall_channel_is_suspected(design: Subject) -> None:
    controller, sequences = design.controller, design.sequences
    words = steps.evaluate(controller, sequences["faults"]).faults
    for bit in range(len(interface.INPUTS)):
        assert {0, 1} == set((words[words & LATCH == 0] >> bit & 1).tolist())
    flags = [f["name"] for f in controller.manifest["structs"]["state"]["fields"] if f["ctype"] == "uint32_t"]
    named = set()
    for sequence in (sequences["failures"], sequences["failures again"]):
        after = steps.evaluate(controller, sequence).states
        named |= {flag for flag in flags if np.any(after[flag] > sequence.states[flag])}
    assert {"sensing_contradiction_left", "sensing_contradiction_confirmed"} <= named
    faults = steps.evaluate(controller, sequences["failures named"]).faults
    bits = [1 << f["bit"] for f in controller.manifest["faults"] if f.get("suspect")]
    assert len(bits) == len(planar_stage.HALL) and all({0, bit} == set((faults & bit).tolist()) for bit in bits)


def unexplained_decisions(missing: tuple[str, ...]) -> list[str]:
    """Return decisions that were not seen both ways and for which UNREACHABLE has no reason."""
    lines, left = Counter(text.split("; ")[-1] for text in missing), []
    for text in missing:
        line = text.split("; ", 1)[-1]
        if not any(re.search(pattern, line) and lines[line] <= most for pattern, most, _ in UNREACHABLE):
            left.append(text)
    return left


@pytest.mark.parametrize(
    ("name", "build"),
    [
        ("planar_6dof_lqg", ZIG),
        *(pytest.param(name, GCC, marks=tools.needs_arm_gcc) for name in NAMES),
    ],
)
def test_every_decision_is_seen_both_ways(name: str, build: meter.Build) -> None:
    """One compiler for the lead-lag, whose text differs from LQG's in filters and loops alone."""
    candidate = meter.emitted_source(subject(name).emitted)
    coverage = meter.coverage(candidate, meter.run(candidate, subject(name).every, build), build)
    assert coverage.decisions > 60 and len(coverage.missing) < 20
    assert not unexplained_decisions(coverage.missing), "\n".join(unexplained_decisions(coverage.missing))


@pytest.mark.parametrize(("name", "build"), ceilings.builds(*NAMES))
def test_the_costliest_step_keeps_below_its_ceiling(name: str, build: meter.Build) -> None:
    ceiling = ceilings.of(name, build)
    costly = [s for s in subject(name).sequences.values() if s.name.endswith(("resampled", "again"))]
    stimulus = steps.concatenate("costly", [steps.thinned(s, COSTLY) for s in costly])
    most = meter.run(meter.emitted_source(subject(name).emitted), stimulus, build).cost.instructions.max()
    assert 0.95 * ceiling < most <= ceiling


@pytest.mark.parametrize(("sequences", "build"), ceilings.builds(*RECORDED))
def test_recorded_steps_and_failures_keep_below_their_ceilings(
    sequences: str, build: meter.Build, design: Subject
) -> None:
    ceiling, recorded = ceilings.of(sequences, build), [design.sequences[s] for s in RECORDED[sequences]]
    run = meter.run(meter.emitted_source(design.emitted), steps.concatenate("recorded", recorded), build)
    assert 0.95 * ceiling < run.cost.instructions.max() <= ceiling


@pytest.mark.parametrize("name", NAMES)
def test_a_design_measures_its_own_steps_beside_the_standard_ones(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    measured_steps: list[Any] = []
    controller = subject(name).controller
    monkeypatch.setattr(stimuli, "sequences", lambda *arguments: measured_steps.append(arguments) or [])
    standard_tasks.cost_sequences(replace(DESIGNS[name], experiments=()), controller, lambda _: None)
    further = {each.name for each in cost_stimuli.stimuli(controller)}
    assert measured_steps[0][0].controller is controller and {each.name for each in measured_steps[0][3]} == further
    assert standard.stimuli_of(DESIGNS[name]).floor == cost_stimuli.FLOOR
