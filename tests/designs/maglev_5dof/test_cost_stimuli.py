"""The stimuli reach what they are there for: every decision of the machine code, the latch, limits and bounds."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from designs.maglev import platen
from designs.maglev_5dof import control
from designs.maglev_5dof.design import DESIGN
from synth.app import standard_tasks
from synth.check import Check
from synth.emit.write import EmittedCode
from synth.execute import host
from synth.verify import meter, replays, steps, stimuli
from synth.verify.cost import Cost
from synth.verify.steps import Steps
from tests import tools

FOLDER = Path(__file__).parents[3] / "generated_c" / control.NAME
EMITTED = EmittedCode(
    {path.name: path.read_text() for path in FOLDER.glob("*.[ch]")}, json.loads((FOLDER / "manifest.json").read_text())
)
ZIG = meter.BUILDS[-1]


@pytest.fixture(scope="module")
def controller() -> host.Controller:
    return host.load(EMITTED.files, EMITTED.manifest)


@pytest.fixture(scope="module")
def inputs(controller: host.Controller) -> dict[str, Any]:
    return dict(standard_tasks.replay_inputs(DESIGN, controller))


@pytest.fixture(scope="module")
def sequences(controller: host.Controller) -> dict[str, Steps]:
    return {s.name: s for s in standard_tasks.cost_sequences(DESIGN, controller, lambda _: None)}


def test_the_replay_has_faults_and_latches_at_its_end(controller: host.Controller, inputs: dict[str, Any]) -> None:
    replay = controller.replay(inputs)
    first = int(np.argmax(replay.faults >> 31))
    assert len(replay.faults) == stimuli.REPLAY_STEPS
    assert 9750 <= first <= 9760 and np.all(replay.faults[first:] >> 31 == 1)
    seen = np.bitwise_or.reduce(replay.faults[:first])
    assert seen & 0x3F == 0x3F and seen & 0x40  # every encoder, and a set-point
    at_rest = {f"i_{axis}{j}": 2.5 if axis == "d" else 0.0 for axis in "dq" for j in range(1, 5)}
    assert all(abs(replay.outputs[n][-1] - value) < 1e-6 for n, value in at_rest.items())


def test_the_sequences_reach_what_they_are_there_for(controller: host.Controller, sequences: dict[str, Steps]) -> None:
    loops = [s for s in sequences.values() if s.closed_loop]
    assert len(loops) >= 30 and all(len(s) <= stimuli.LOOP_STEPS for s in loops)
    assert {"tracking", "windup_with", "set_down_18.1", "faults", "latches"} <= set(sequences)
    taken = {name: steps.evaluate(controller, s) for name, s in sequences.items()}
    windup = taken["windup_with"].outputs
    assert float(np.hypot(windup["i_d2"], windup["i_q2"]).max()) > 0.999 * platen.CURRENT  # a motor at its limit
    assert (taken["set_down_25"].faults >> 31).any() and not taken["tracking"].faults.any()
    bounds = {f["name"]: f["high"] for f in EMITTED.manifest["structs"]["state"]["fields"]}
    drawn = sequences["random states and inputs"].states
    for axis in ("y", "x", "phi"):
        assert np.abs(drawn[f"regulator_{axis}_sum"]).max() == bounds[f"regulator_{axis}_sum"]


REPEATED = "if (waiting"  # tested again where it has just been seen to be so: the other side cannot be reached
# gcc copies a decision into each path that leads to it, where part of it is decided; without that each is there once.
GCC = meter.Build("gcc, no copies", "gcc", ("-Os", "-fno-thread-jumps"))


@pytest.mark.parametrize("build", [ZIG, pytest.param(GCC, marks=tools.needs_arm_gcc)])
def test_every_decision_is_seen_both_ways(build: meter.Build, sequences: dict[str, Steps]) -> None:
    candidate = meter.emitted_source(EMITTED)
    short = [steps.thinned(s, 50 if s.closed_loop else 10000) for s in sequences.values()]
    coverage = meter.coverage(candidate, meter.run(candidate, steps.concatenate("all", short), build), build)
    missing = [line for line in coverage.missing if REPEATED not in line]
    assert coverage.decisions > 40 and not missing, missing


def test_the_replay_is_the_hosts_to_the_bit(inputs: dict[str, Any]) -> None:
    short = {name: column[-2000:] for name, column in inputs.items()}
    checks: tuple[Check, ...] = replays.verify(EMITTED, short, "cortex-m4f", lambda _: None)
    assert checks and all(c.passed for c in checks), checks


def test_the_law_alone_is_measured_without_the_count_of_missed_calls(
    controller: host.Controller, inputs: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """By one build, without the texts of CasADi, which are not compared here and take most of the time."""
    law = standard_tasks.law_alone(DESIGN)
    assert law is not None and "missed_calls" in inputs
    monkeypatch.setattr(meter, "builds", lambda: (ZIG,))
    loop = steps.thinned(steps.record(controller, "closed loop", inputs, closed_loop=True), meter.BRIEF_STEPS)
    shared = steps.thinned(steps.without_faults(controller, loop), meter.BRIEF_COMMON)
    mine = meter.step_cost(meter.emitted_source(EMITTED), shared, ZIG, controller)
    whole = Cost(control.NAME, meter.CORE, 1e-3, (mine,), (), (), {}, ())
    first, alone = meter.with_law_alone(whole, law, inputs).compared
    assert first is mine and alone.build == mine.build and alone.steps == mine.steps == meter.BRIEF_COMMON
    assert alone.executed.mean < 0.7 * mine.executed.mean
