"""Leaky counter of bad samples: a bad one takes away as much as several good ones give back.

    n' = n - c after a bad sample, min(n + 1, N c) after a good one;   it is due in the bad sample in which n <= c

With N bad samples in a row it is due in the last of them, and sooner or later wherever more than one sample of c + 1 is
bad. Without leak, c = 1, and one good sample restores all.
"""

import casadi as ca

from synth.block import Constant, State
from synth.errors import SignalError
from synth.signals import Signal


def full(samples: int, good_samples: int) -> int:
    """Return N c, the count after init: of `samples` in a row, where `good_samples` make up for one of them."""
    return samples * max(good_samples, 1)


def is_due(left: ca.SX, good_samples: int) -> ca.SX:
    """Return whether a bad sample is the last one."""
    return left <= max(good_samples, 1)


def next_count(good: ca.SX, left: ca.SX, samples: int, good_samples: int) -> ca.SX:
    """Return the count one sample later; the last bad sample leaves it as it is."""
    cost, most = max(good_samples, 1), full(samples, good_samples)
    restored = ca.if_else(left >= most, left, left + 1) if good_samples else most
    return ca.if_else(good, restored, ca.if_else(is_due(left, good_samples), left, left - cost))


def state(samples: int, good_samples: int, about: str) -> State:
    """Return the state of the counter."""
    most = full(samples, good_samples)
    unit = f", in 1/{good_samples} of a sample" if good_samples else ""
    return State(Signal("left", "1", 1, max(most, 2), f"{about}{unit}"), most, True)


def numbers(name: str, samples: int, good_samples: int, about: str) -> list[Constant]:
    """Return the numbers of the counter that the C names."""
    if not good_samples:
        return [Constant(name, samples, "1", about, ("left",))]
    return [
        Constant(name, full(samples, good_samples), "1", f"{about}, times {good_samples}", ("left",)),
        Constant("good_per_bad", good_samples, "1", "good samples that make up for a bad one", ("left",)),
    ]


def rule(samples: int, good_samples: int) -> str:
    """Return when the counter is due, as text."""
    return f"{samples} samples in a row" + (f", or more than 1 in {good_samples + 1} for long" if good_samples else "")


def check(good_samples: int, braking: int = 0) -> None:
    """Raise SignalError for a negative number, and for one of a guard that brakes: it counts samples in a row."""
    if good_samples < 0 or (good_samples and braking):
        raise SignalError(
            f"{good_samples} good samples make up for a bad one, with {braking} samples of braking: give 0, where one "
            "good sample restores all, or more without braking"
        )
