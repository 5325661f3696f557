"""Repeated codes: found in the promised time in every channel, and neither by noise nor by bad readings."""

from collections.abc import Mapping

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, Exprs, Step, build
from synth.blocks.estimate.dead_reckoning import MEASURED
from synth.blocks.faults import innovation_monitor
from synth.reference import repeated_codes as reference
from synth.signals import Signal
from synth.statespace import Array
from synth.timing import Discrete

N, RANGE = 6, 5.0
NAMES = ("a", "b", "c", "d")
CHANNELS = [Signal(name, "V", -RANGE, RANGE) for name in NAMES]
KNOWN_AFTER = innovation_monitor.longest(len(NAMES), N)


def watch(repeats: int = N, watched: int = N) -> Block:
    """Return a Block that watches in measured samples; `watched` is the number it counts to, `repeats` the declared."""

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        after = innovation_monitor.watch(x, [u[name] for name in NAMES], watched, u["goes_on"], ca.SX(0))
        next = {name: ca.if_else(u[MEASURED.name], value, x[name]) for name, value in after.next.items()}
        return Step({"flag": after.flag}, next)

    states = innovation_monitor.states(CHANNELS, repeats)
    flag, goes_on = (Signal(name, "1", 0, 1) for name in ("flag", "goes_on"))
    return build("w", Discrete(1e-3), law, inputs=[*CHANNELS, MEASURED, goes_on], outputs=[flag], states=states)


def run(
    block: Block, codes: Mapping[str, Array], measured: Array | None = None, goes_on: Array | None = None
) -> list[dict[str, float]]:
    """Return the states after each sample; by default each is measured, and the watch goes on from the first on."""
    n = len(next(iter(codes.values())))
    step, x, after = block.function(), block.initial, []
    for k in range(n):
        flags = [1.0 if flag is None else float(flag[k]) for flag in (measured, goes_on)]
        u = [*(codes[name][k] for name in NAMES), *flags]
        x = np.asarray(step(x, u)[0]).ravel()
        after.append(dict(zip((s.name for s in block.states), x, strict=True)))
    return after


def noisy(n: int, seed: int = 0) -> dict[str, Array]:
    """Return codes (n,) that never repeat."""
    return {name: np.random.default_rng([seed, i]).permutation(n) * 1e-3 for i, name in enumerate(NAMES)}


@pytest.mark.parametrize("onset", range(20, 32))
def test_a_frozen_channel_is_found_in_the_promised_time(onset: int) -> None:
    for number, name in enumerate(NAMES, 1):
        codes = noisy(60)
        codes[name][onset:] = codes[name][onset]
        frozen = [state["frozen"] for state in run(watch(), codes)]
        assert frozen[-1] == number and max(frozen[: onset + N - 1]) == 0
        assert int(np.argmax(np.array(frozen) > 0)) - onset <= KNOWN_AFTER


def test_what_repeats_less_often_is_not_frozen_and_one_that_counts_less_finds_it() -> None:
    """The planted defect: a watch that counts to one code fewer."""
    codes, gaps = noisy(900), np.random.default_rng(1).integers(N, N + 4, 90)
    for k in np.cumsum(gaps):  # at random, so that a watch begins at each place of a row
        codes["b"][k : k + N - 1] = codes["b"][k]
    assert run(watch(), codes)[-1]["frozen"] == 0
    assert run(watch(watched=N - 1), codes)[-1]["frozen"] == 2


def test_samples_that_are_not_measured_do_not_count() -> None:
    codes = noisy(80)
    codes["c"][:] = 1.0
    assert run(watch(), codes, np.zeros(80))[-1]["frozen"] == 0
    assert run(watch(), codes, np.arange(80) % 2)[-1]["frozen"] == 3


def test_it_waits_until_it_goes_on() -> None:
    codes = {name: np.ones(60) for name in NAMES}
    left = [state["watch_left"] for state in run(watch(), codes, goes_on=np.arange(60) >= 30)]
    assert set(left[:30]) == {N + 1} and left[30] == N


def test_a_code_that_a_sound_channel_repeats_takes_one_sample_more() -> None:
    """The watch of b begins in the sample before the one in which it repeats its code."""
    codes = noisy(60)
    states = run(watch(), codes)
    begins = next(k for k in range(20, 60) if states[k]["watch_channel"] == 1 and states[k]["watch_left"] == N - 1)
    codes["a"][begins:] = codes["a"][begins]
    known = [int(np.argmax([state["frozen"] > 0 for state in run(watch(), codes)]))]
    codes["b"][begins + 1] = codes["b"][begins]
    known.append(int(np.argmax([state["frozen"] > 0 for state in run(watch(), codes)])))
    assert known[1] == known[0] + 1


def test_it_agrees_with_the_reference() -> None:
    rng = np.random.default_rng(2)
    codes = {name: np.round(rng.normal(0, 0.7, 3000)) for name in NAMES}
    measured, goes_on = rng.uniform(size=3000) < 0.8, rng.uniform(size=3000) < 0.9
    state = reference.initial_state("w", N)
    for k, after in enumerate(run(watch(), codes, measured, goes_on)):
        read = {name: codes[name][k] for name in NAMES}
        next, between, is_frozen = reference.next_state("w", state, read, NAMES, measured[k], goes_on[k], N)
        assert {name: next[f"w_{name}"] for name in after} == after
        assert between == (measured[k] and state["w_watch_left"] == N + 1) and not (is_frozen and between)
        state = next
    assert state["w_frozen"] > 0
