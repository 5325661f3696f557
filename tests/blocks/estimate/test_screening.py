"""Screening of grouped measurements: which group is rejected, repeated codes, refusals."""

from typing import Any

import numpy as np
import pytest

from synth.block import Block
from synth.blocks.estimate import glsdc_search
from synth.blocks.guard import safety
from synth.composition import compose
from synth.execute.host import compile_block
from synth.signals import Signal
from synth.statespace import Array
from synth.timing import Discrete

TIME, REPEATS, N = Discrete(1e-3), 4, 60
CHANNELS = [Signal(f"v_{name}", "V", -5.0, 5.0) for name in ("ax", "ay", "bx", "by", "c")]
GROUPS = [["v_ax", "v_ay"], ["v_by", "v_bx"], ["v_c"]]


def screen(repeats: int = REPEATS) -> Block:
    guard = safety.guard(TIME, [safety.GuardedInput(s, 0.0, True) for s in CHANNELS], 5)
    parts = [guard, glsdc_search.screen(TIME, CHANNELS, GROUPS, repeats)]
    return compose("screened", parts, inputs=[s.name for s in CHANNELS], outputs=["rejected", "screened"])


def outputs(of: Block, y: Array) -> Any:
    return compile_block(of).replay({s.name: y[:, i] for i, s in enumerate(CHANNELS)}).outputs


def noise() -> Array:
    return np.random.default_rng(0).standard_normal((N, len(CHANNELS)))


@pytest.mark.parametrize(("channel", "group"), [(0, 1), (1, 1), (2, 2), (3, 2), (4, 3)])
def test_a_refused_channel_rejects_its_group(channel: int, group: int) -> None:
    y = noise()
    y[20, channel], y[30, channel] = np.nan, 7.0
    out = outputs(screen(), y)
    assert out["screened"].all()
    assert set(np.flatnonzero(out["rejected"])) == {20, 30} and (out["rejected"][[20, 30]] == group).all()


@pytest.mark.parametrize(("channel", "group"), [(0, 1), (3, 2), (4, 3)])
def test_a_frozen_converter_is_rejected_after_its_repeats_until_it_moves(channel: int, group: int) -> None:
    y = noise()
    y[20:40, channel] = y[20, channel]
    out = outputs(screen(), y)
    assert (out["rejected"][20 + REPEATS : 40] == group).all()
    assert not out["rejected"][: 20 + REPEATS].any() and not out["rejected"][40:].any() and out["screened"].all()


def test_fewer_repeats_are_no_fault() -> None:
    y = noise()
    y[20 : 20 + REPEATS, 0] = y[20, 0]
    out = outputs(screen(), y)
    assert not out["rejected"].any()
    assert outputs(screen(REPEATS - 1), y)["rejected"].any()


def test_two_faulty_groups_are_not_screened() -> None:
    y = noise()
    y[20, [0, 1]] = np.nan
    y[30, [0, 2]] = np.nan
    out = outputs(screen(), y)
    assert out["rejected"][20] == 1 and out["screened"][20]
    assert out["rejected"][30] == 0 and not out["screened"][30] and out["screened"].sum() == N - 1


def test_channels_of_a_group_that_repeat_in_turn_count_together() -> None:
    y = noise()
    for first, channel in ((20, 0), (21, 1), (22, 0), (23, 1)):
        y[first + 1, channel] = y[first, channel]  # the last repetition is in sample 24
    rejected = outputs(screen(), y)["rejected"]
    assert set(np.flatnonzero(rejected)) == {24} and rejected[24] == 1
