"""Stimuli are effective: the latch is reached far from the safe outputs, and a wrong slew rate is detected."""

from dataclasses import replace

import numpy as np
import pytest

from synth.app import standard_tasks
from synth.execute import host
from synth.simulate import experiments
from synth.verify import steps, stimuli
from tests import levitator

PID = levitator.design()
STAGE = PID.DESIGN


@pytest.fixture(scope="module")
def controller() -> host.Controller:
    return standard_tasks.compiled_controller(STAGE, np.float32)


@pytest.fixture(scope="module")
def doubled() -> host.Controller:
    """Planted defect: the outputs slew to their safe values twice as fast as declared."""
    faster = tuple(replace(a, slew_per_s=2 * a.slew_per_s) for a in PID.INTERFACE.actuators)
    laws = [law for made in STAGE.controller.laws for law in made.blocks]
    made = PID.stage.controller("levitator_pid", PID.TIME, replace(PID.INTERFACE, actuators=faster), laws)
    return host.compile_block(made.block, np.float32)


def _differs(one: host.Controller, other: host.Controller, among: steps.Steps) -> bool:
    first, second = (steps.evaluate(c, among).outputs for c in (one, other))
    return any(not np.array_equal(first[name], second[name]) for name in first)


def test_a_doubled_slew_is_found(controller: host.Controller, doubled: host.Controller) -> None:
    (latches,) = stimuli.latches(controller, stimuli.SEED)
    assert _differs(controller, doubled, latches) and not _differs(controller, controller, latches)


def test_a_doubled_slew_is_found_by_the_replay_too(controller: host.Controller, doubled: host.Controller) -> None:
    inputs = stimuli.closed_loop(standard_tasks.rig(STAGE, np.float32), stimuli.REPLAY_STEPS).measured
    outputs = [c.replay(inputs).outputs for c in (controller, doubled)]
    assert any(not np.array_equal(outputs[0][name], outputs[1][name]) for name in outputs[0])


def test_latches_end_at_rest(controller: host.Controller) -> None:
    (latches,) = stimuli.latches(controller, stimuli.SEED)
    taken = steps.evaluate(controller, latches)
    assert (taken.faults >> 31).mean() > 0.5 and np.abs(taken.outputs["i1"]).max() > 2.9
    assert taken.outputs["i1"][-1] == taken.outputs["i2"][-1] == 0


def test_the_replay_has_bad_samples_of_every_input_and_latches_in_the_end(controller: host.Controller) -> None:
    rig = standard_tasks.rig(STAGE, np.float32)
    replay = controller.replay(stimuli.closed_loop(rig, stimuli.REPLAY_STEPS).measured)
    first = int(np.argmax(replay.faults >> 31))
    assert 9500 <= first <= 9505 and (replay.faults[first:] >> 31).all()
    seen = np.bitwise_or.reduce(replay.faults[:first])
    assert seen & 0b111 == 0b111  # both sensors and a set-point


def test_every_sequence_is_there_and_closed_loops_come_first(controller: host.Controller) -> None:
    rig = standard_tasks.rig(STAGE, np.float32)
    sequences = stimuli.sequences(rig, [experiments.result(e, rig) for e in STAGE.experiments], lambda _: None)
    assert [s.name for s in sequences if s.closed_loop] == ["step_z", "step_x", "faults in motion"]
    assert all(s.closed_loop for s in sequences[:3]) and {"latches", "faults", "edges"} <= {s.name for s in sequences}
    assert all(len(s) <= stimuli.LOOP_STEPS for s in sequences[:3])
