"""Every Block that the toolkit makes, from the arguments of the hostile calls.

Its states keep their bounds, the emitted C answers as CasADi does, and under other names it does the same.
"""

import typing

import numpy as np
import pytest

from synth.block import Block, unranged
from synth.blocks.estimate import advance, dead_reckoning, glsdc_estimator, glsdc_search, unwrap
from synth.blocks.faults import innovation_monitor, landing, probe, redundancy, start
from synth.blocks.guard import following, missed_calls, safe_output, safety
from synth.blocks.laws import (
    biquad,
    derivative_filter,
    jerk_limited,
    lead_lag,
    linear_block,
    predictive_servo,
    regulator,
)
from synth.errors import EmitError
from synth.execute import host
from synth.verify import agree, sampling
from tests.hostile import search

FAMILIES = (
    *(advance, dead_reckoning, glsdc_estimator, glsdc_search, unwrap),
    *(innovation_monitor, landing, probe, redundancy, start),
    *(following, missed_calls, safe_output, safety),
    *(biquad, derivative_filter, jerk_limited, lead_lag, linear_block, predictive_servo, regulator),
)
STEPS = 400
DIFFERENCE = {np.float64: 1e-12, np.float32: 1e-4}  # of the witnesses, relative to the largest value of a signal
Steps = tuple[sampling.Columns, sampling.Columns]


def makes_a_block(name: str) -> bool:
    function = search.library()[name]
    return ".blocks." in function.__module__ and typing.get_type_hints(function).get("return") is Block


NAMES = [name for name in search.library() if makes_a_block(name)]
NOT_ALONE = ("probe.block",)  # counts with a flag of another Block, which is a whole number there


@pytest.fixture(params=NAMES)
def block(request: pytest.FixtureRequest) -> Block:
    return make(request.param)


def make(name: str) -> Block:
    function = search.library()[name]
    made = search.call(function, search.example(name, function))
    assert isinstance(made, Block)
    return made


def steps_of(block: Block) -> Steps:
    """Draw states and inputs anywhere in their ranges, a third of the inputs at an end."""
    rng = np.random.default_rng(7)
    states, inputs = sampling.anywhere(block, rng, STEPS)
    for s in block.inputs:
        if (s.unit, s.low, s.high) == ("1", 0, 1):  # a flag
            inputs[s.name] = np.round(inputs[s.name])
        ends = rng.choice([s.low, s.high], STEPS)
        inputs[s.name] = np.where(rng.random(STEPS) < 1 / 3, ends, inputs[s.name])
    return states, inputs


def test_the_families_are_all_there() -> None:
    assert {name.split(".")[0] for name in NAMES} >= {family.__name__.rpartition(".")[2] for family in FAMILIES}


def test_states_keep_their_bounds(block: Block) -> None:
    after = agree.casadi(block)(*steps_of(block)).states
    for s in block.states:
        assert s.signal.low <= after[s.name].min() and after[s.name].max() <= s.signal.high, s.name
        if s.integer:
            assert (after[s.name] == np.round(after[s.name])).all(), s.name


@pytest.mark.slow
@pytest.mark.parametrize("scalar", [np.float64, np.float32])
@pytest.mark.parametrize("name", [name for name in NAMES if name not in NOT_ALONE])
def test_the_emitted_c_answers_as_casadi_does(name: str, scalar: type[np.floating]) -> None:
    """An output that leaves its range is refused by name, or kept inside; without ranges all of them are compared."""
    block = make(name)
    states, inputs = steps_of(block)
    expected = agree.casadi(block)(states, inputs)
    leaves = [s.name for s in block.outputs if np.abs(expected.outputs[s.name]).max() > 1.001 * max(-s.low, s.high)]
    try:
        controller = host.compile_block(block, scalar)
    except EmitError as refusal:
        assert any(f"'{s.name}'" in str(refusal) for s in (*block.outputs, *(s.signal for s in block.states)))
        controller = host.compile_block(unranged(block), scalar)
    else:
        assert not leaves
    gap = agree.compare("", ("casadi", expected), ("c", agree.emitted_c(controller)(states, inputs)), None, block)
    assert max(gap.worst, gap.state_worst) < DIFFERENCE[scalar]
    assert gap.faults_differ <= (0 if scalar is np.float64 else STEPS // 100)


def test_under_other_names_it_does_the_same(block: Block) -> None:
    names = {s.name: f"{s.name}_2" for s in (*block.inputs, *block.outputs)}
    renamed, (states, inputs) = block.renamed(names), steps_of(block)
    expected = agree.casadi(block)(states, inputs)
    after = agree.casadi(renamed)(states, {names[n]: v for n, v in inputs.items()})
    np.testing.assert_equal(after.states, expected.states)
    np.testing.assert_equal({names[n]: v for n, v in expected.outputs.items()}, after.outputs)
    np.testing.assert_array_equal(after.faults, expected.faults)
