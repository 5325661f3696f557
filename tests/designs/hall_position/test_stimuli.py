"""The sequences reach every decision of the machine code, the latch, the search and the costliest steps.

What is measured is the committed C.
"""

import json
import re
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from designs.hall_position import config, random_steps, stimuli
from synth.blocks.guard import safety
from synth.emit.write import EmittedCode
from synth.execute import host
from synth.verify import meter, steps
from synth.verify.meter import Build
from synth.verify.steps import Steps
from tests import ceilings, tools

GENERATED = Path(__file__).parents[3] / "generated_c"
LIMIT = 1.2 * 2295  # instructions of two sensors: at most a fifth more than with its normal equations written out
# The least pivot of the yaw is the weight of its prior; the data add squares to it, so that nothing is below it.
# Each of the three solutions has it once; its line is that of the function `max`.
LEAST_PIVOT = re.compile(r"estimator(_iteration)?\b.* return \(a > b\) \? a : b;")
SOLUTIONS = 3
# gcc copies a decision into each path that leads to it, where part of it is decided, and a limit into each place that
# has one, where only rounding comes beyond it. Without copies each decision of the text is there once.
ONCE = Build("gcc, no copies", "gcc", ("-Os", "-fno-thread-jumps"))
THIN = 400  # steps of a sequence in which decisions are looked for
COSTLY = "random", "states resampled", "random states and inputs", "rare among states resampled"
COSTLY_STEPS = 200  # steps of each sequence that is costly
LATCH = 1 << safety.LATCH_BIT


class Subject(NamedTuple):
    """A shipped C, compiled, and its sequences."""

    emitted: EmittedCode
    controller: host.Controller
    sequences: dict[str, Steps]

    def every(self, most: int) -> Steps:
        return steps.concatenate("all", [steps.thinned(s, most) for s in self.sequences.values()])


@cache
def subject(name: str) -> Subject:
    folder = GENERATED / name
    files = {path.name: path.read_text() for path in folder.glob("*.[ch]")}
    emitted = EmittedCode(files, json.loads((folder / "manifest.json").read_text()))
    controller = host.load(emitted.files, emitted.manifest)
    return Subject(emitted, controller, {s.name: s for s in stimuli.sequences(controller, lambda _: None)})


def test_the_replay_has_faults_and_in_the_end_latches() -> None:
    controller = subject(config.NAME).controller
    replay = controller.replay(stimuli.replay(controller))
    latched = (replay.faults & LATCH) != 0
    assert len(latched) == stimuli.REPLAY_STEPS and int(np.argmax(latched)) == 9505 and latched[9505:].all()
    seen = [k for k in range(4) if (replay.faults[:9500] >> k & 1).any()]
    assert seen == [1, 2, 3] and np.count_nonzero(replay.faults[:9500]) < 100
    assert 0.1 < np.mean(replay.outputs["valid"]) < 1


def test_the_sequences_search_restart_and_converge() -> None:
    pair = subject(config.NAME)
    motions = pair.sequences["motions"]
    assert [s.name for s in pair.sequences.values() if s.closed_loop] == ["motions", "turns", "yaws left"]
    out = steps.evaluate(pair.controller, motions).outputs
    assert np.mean(out["valid"]) > 0.3 and np.mean(out["converged"]) > 0.9
    lost = steps.evaluate(pair.controller, pair.sequences["lost"])
    assert lost.outputs["lock_lost"].any() and (lost.states["estimator_searching"] > 0).any()
    words = steps.evaluate(pair.controller, pair.sequences["faults"]).faults
    assert all({0, 1} == set((words[words & LATCH == 0] >> bit & 1).tolist()) for bit in range(4))
    assert (words & LATCH).any()


@tools.needs_arm_gcc
def test_every_decision_is_seen_both_ways() -> None:
    candidate = meter.emitted_source(subject(config.NAME).emitted)
    coverage = meter.coverage(candidate, meter.run(candidate, subject(config.NAME).every(THIN), ONCE), ONCE)
    assert coverage.decisions > 50 and len(coverage.missing) <= SOLUTIONS
    assert [line for line in coverage.missing if not LEAST_PIVOT.search(line)] == []


@pytest.mark.parametrize(("name", "build"), ceilings.builds(config.NAME))
def test_the_costliest_step_keeps_below_its_ceiling(name: str, build: Build) -> None:
    ceiling = ceilings.of(name, build)
    costly = steps.concatenate("costly", [steps.thinned(subject(name).sequences[s], COSTLY_STEPS) for s in COSTLY])
    most = meter.run(meter.emitted_source(subject(name).emitted), costly, build).cost.instructions.max()
    assert 0.93 * ceiling < most <= ceiling
    assert ceiling <= LIMIT


@tools.needs_arm_gcc
def test_casadis_own_c_takes_twice_as_many() -> None:
    pair, build = subject(config.NAME), ceilings.BUILDS["gcc, newlib"]
    few = steps.thinned(pair.sequences["motions"], 20)
    baseline = meter.run(meter.casadi(config.block(), shimmed=True), few, build).cost.instructions
    emitted_cost = meter.run(meter.emitted_source(pair.emitted), few, build).cost.instructions
    assert baseline.min() > 1.8 * emitted_cost.max()


def test_random_steps_are_those_of_verification() -> None:
    states, _ = random_steps.operating_steps(random_steps.subject(), stimuli.RANDOM_STEPS)
    sequence = subject(config.NAME).sequences["random"]
    assert len(sequence) == stimuli.RANDOM_STEPS
    np.testing.assert_array_equal(sequence.states["estimator_yaw"], states["estimator_yaw"].astype(np.float32))
