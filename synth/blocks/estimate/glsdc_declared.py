"""Conditions on the declaration of a measurement model: covariance, angles among the channels, pairs that turn."""

from collections.abc import Sequence
from math import inf, pi

import numpy as np

from synth import arguments
from synth.blocks.estimate.glsdc_model import RotatedMeasurement, Unknown
from synth.errors import ModelError, SignalError
from synth.signals import Signal, signal_names
from synth.statespace import Array

TURNS, ROUNDING = {"rad": 2 * pi, "deg": 360.0}, 1e-6  # width of one turn by unit, relative error of a range


def check(R: Array, channels: tuple[Signal, ...], unknowns: tuple[Unknown, ...]) -> None:
    """Raise ModelError for too few channels, and for an R (m, m) that is no covariance of theirs."""
    m, measured = len(channels), len(channels) + sum(u.prior < inf for u in unknowns)
    if not unknowns or measured < len(unknowns):
        raise ModelError(
            f"{m} channels and the priors are {measured} for {len(unknowns)} unknowns: give as many at least"
        )
    if R.shape != (m, m):
        raise ModelError(f"R has shape {R.shape}: give a covariance {(m, m)}, a row for each channel")
    if not np.isfinite(R).all():
        raise ModelError(f"R has {np.count_nonzero(~np.isfinite(R))} entries that are not finite: give a covariance")
    if not np.allclose(R, R.T, rtol=1e-12, atol=0):
        raise ModelError("R is not symmetric: give a covariance")
    spreads = np.sqrt(np.maximum(R.diagonal(), 0))
    if not spreads.all() or np.linalg.eigvalsh(R / np.outer(spreads, spreads)).min() < 1e-12:
        raise ModelError("R is not positive definite: each channel needs an error of its own")


def check_angles(angles: Sequence[str], channels: Sequence[Signal]) -> None:
    """Raise SignalError for an angle that is no channel, or whose range is not one turn."""
    if strangers := [n for n in angles if n not in signal_names(channels)]:
        raise SignalError(f"the angle '{strangers[0]}' is no channel: give some of {', '.join(signal_names(channels))}")
    for s in (s for s in channels if s.name in angles and s.unit in TURNS):
        if abs(s.high - s.low - TURNS[s.unit]) > ROUNDING * TURNS[s.unit]:
            raise SignalError(
                f"the angle '{s.name}' has the range {s.low:g} .. {s.high:g} {s.unit}: give one turn, "
                f"{TURNS[s.unit]:.9g} {s.unit} wide"
            )


def check_pairs(h: RotatedMeasurement, R: Array, channels: Sequence[Signal], unknowns: Sequence[Unknown]) -> None:
    """Raise SignalError for a turn by no angle and pairs that are not the channels, ModelError for another R."""
    angles, names = [u.name for u in unknowns if u.rate == 1], signal_names(channels)
    if not callable(h.fixed):
        raise SignalError(
            f"the fixed model is {arguments.describe(h.fixed)}: give a function of unknowns and constants"
        )
    if h.angle not in angles:
        known = f"one of {', '.join(angles)}" if angles else "an Unknown with angle=True"
        raise SignalError(f"the body turns by '{h.angle}', which is no unknown angle in rad: give {known}")
    are_pairs = isinstance(h.pairs, Sequence) and all(isinstance(p, Sequence) and len(p) == 2 for p in h.pairs)
    if not are_pairs or sorted(str(n) for pair in h.pairs for n in pair) != sorted(names):
        raise SignalError(f"the pairs {h.pairs!r} are not the channels: each stands in one pair")
    quarter = np.zeros_like(R)
    for a, b in h.pairs:
        quarter[names.index(a), names.index(b)], quarter[names.index(b), names.index(a)] = -1, 1
    if not np.allclose(quarter @ R, R @ quarter, rtol=1e-9, atol=0):
        raise ModelError("R changes when the pairs turn: give both channels of a pair one variance, and no correlation")
