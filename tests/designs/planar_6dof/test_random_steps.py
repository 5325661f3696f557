"""Random steps are what they are said to be: near operation and mostly within limits, or at every edge."""

import numpy as np
import pytest

from designs.planar_6dof import random_steps
from designs.planar_6dof.random_steps import Subject
from designs.planar_6dof_leadlag import design as leadlag
from designs.planar_6dof_lqg import design as lqg
from models import planar_stage
from synth.errors import SignalError
from synth.verify import agree

PLANT = planar_stage.plant()
SUBJECTS = {"leadlag": leadlag.subject(), "lqg": lqg.subject()}


@pytest.mark.parametrize("subject", SUBJECTS.values(), ids=SUBJECTS)
def test_steps_in_operation_are_near_it(subject: Subject) -> None:
    states, inputs = random_steps.operating_steps(subject, PLANT, 5000)
    assert set(states) == {s.name for s in subject.block.states}
    assert set(inputs) == {s.name for s in subject.block.inputs}
    for s in (*subject.block.inputs, *(s.signal for s in subject.block.states)):
        values = (inputs | states)[s.name].astype(np.float32)
        assert (s.low <= values).all() and (values <= s.high).all(), s.name
    stepped = agree.casadi(subject.block)(states, inputs)
    assert 0.02 < np.mean(random_steps.is_saturated(stepped.outputs)) < 0.5
    assert np.mean(stepped.faults == 0) > 0.95
    offsets = [np.unique(states[f"sensing_offset_{axis}"]) for axis in "xy"]
    assert [len(stepped) for stepped in offsets] == [5, 5]  # all pitches of the travel
    moved = [n for n in random_steps.law_states(subject.block) if np.std(stepped.states[n] - states[n]) > 0]
    assert moved == random_steps.law_states(subject.block) and len(moved) >= 12


def test_a_state_of_another_name_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(random_steps, "UNCONSTRAINED", ("sensing_first_",))
    with pytest.raises(SignalError, match="has the states sensing_contradiction_left, sensing_watch_channel"):
        random_steps.operating_steps(SUBJECTS["lqg"], PLANT, 10)


@pytest.mark.parametrize("subject", SUBJECTS.values(), ids=SUBJECTS)
def test_edge_steps_hold_what_is_no_number_and_every_end(subject: Subject) -> None:
    states, inputs = random_steps.edge_steps(subject.block, 4000)
    for s in subject.block.inputs:
        drawn = inputs[s.name]
        assert np.isnan(drawn).any() and np.isposinf(drawn).any() and (np.abs(drawn) == 5e-324).any()
        assert {s.low, s.high, np.nextafter(s.low, -np.inf), np.nextafter(s.high, np.inf)} <= set(drawn.tolist())
    for state in subject.block.states:
        low, high = state.signal.low, state.signal.high
        assert low <= states[state.name].min() and states[state.name].max() <= high
        assert np.ptp(states[state.name]) > 0.99 * (high - low)
    hall = np.array([inputs[n] for n in planar_stage.HALL])
    assert (hall == 0).all(axis=0).sum() > 5  # a supply that is lost
    assert not ((np.abs(hall[[0, 1, 2]]) < 1e-100).all(axis=0) & (hall[[0, 1, 2]] != 0).any(axis=0)).any()
