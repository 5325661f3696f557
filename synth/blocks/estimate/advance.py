"""Advance: the position at the time at which a current acts, from a sampled position (linear extrapolation).

A current that is computed from sample k acts from (k + d) T to (k + d + 1) T, with the delay of d samples and the hold.
Its middle comes a = d + 1/2 samples after the measurement. With the position p_k and its stride s_k = p_k - p_{k-1}

    acting_k = p_k + a s_k,    error (a + 1)/2 a T^2 |acceleration|, and (2 a + 1)/2 resolutions of the encoder

A commutation at p_k lags by a speed T: the direct current then makes thrust, and the thrust current levitation.

The position follows the measurement by at most `speed` T in a sample, so a wrong sample moves it by this distance and
`acting` by (1 + a) times as much; the next good sample takes it back. A refused sample is held. While the position is
unknown, before the first good sample and after `bad_samples` refused ones in a row, it is `lost`; the next good sample
is then taken as it is. An encoder that is stuck inside its range gives strides of 0, which this Block cannot tell from
standstill.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import casadi as ca

from synth import arguments
from synth.block import Block, Constant, Exprs, State, Step, build
from synth.errors import SignalError
from synth.law import label
from synth.signals import Signal, per_second
from synth.timing import Discrete

NAME = "advance"
ROUNDING = 1e-6  # of the range of `acting` beyond that of the position


@arguments.checked
@dataclass(frozen=True)
class Position:
    """A guarded position along a motor with its largest speed in its unit/s."""

    signal: Signal
    speed: float


@arguments.checked
def acting(position: Signal, samples: float) -> Signal:
    """Return ``<name>_acting``, which may lie beyond the range of the position by `samples` of its width."""
    beyond = samples * (position.high - position.low) * (1 + ROUNDING)
    low, high, about = position.low - beyond, position.high + beyond, f"{position.name} when the current acts"
    return replace(position, name=f"{position.name}_acting", low=low, high=high, about=about)


@arguments.checked
def lost(position: Signal) -> Signal:
    """Return ``lost_<name>``, the flag of a position that is unknown."""
    return Signal(f"lost_{position.name}", "1", 0, 1, f"{position.name} is unknown")


@arguments.checked
def block(time: Discrete, positions: Sequence[Position], samples: float, bad_samples: int) -> Block:
    """Return the Block from ``<name>_held`` and ``fault_<name>`` of a guard to `acting` and `lost` of each position.

    `samples` is the advance a, d + 1/2 for a delay of d samples; 0 gives the position itself.

    Raises SignalError for a negative advance, a speed that is not positive, and fewer than one bad sample.
    """
    if samples < 0 or bad_samples < 1 or not all(p.speed > 0 for p in positions):
        speeds = ", ".join(f"{p.speed:g}" for p in positions)
        raise SignalError(
            f"advance of {samples:g} samples, {bad_samples} bad samples, speeds {speeds}: give an advance of 0 or "
            "more, at least one bad sample, and positive speeds"
        )

    T = time.period_s
    numbers = [Constant("advance_patience", bad_samples, "1", "bad samples until a position is lost", ("left",))]
    for p in positions:
        speed, unit = f"{p.speed:g} {per_second(p.signal.unit)}", p.signal.unit
        numbers.append(
            Constant(f"largest_move_{p.signal.name}", p.speed * T, unit, f"{speed} times {T:g} s", is_limit=True)
        )
    if samples:
        numbers.append(Constant("samples_ahead", samples, "1", "from the measurement until the current acts"))

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        output, next = {}, {}
        for p in positions:
            name, most = p.signal.name, p.speed * T
            measured, left, refused = u[f"{name}_held"], x[f"left_{name}"], u[f"fault_{name}"]
            known = left >= 1
            last = ca.if_else(known, x[f"last_{name}"], measured)
            position = ca.fmax(ca.fmin(measured, last + most), last - most)
            output[acting(p.signal, samples).name] = position + samples * (position - last)
            output[lost(p.signal).name] = ca.if_else(refused, left <= 1, 0)
            next[f"last_{name}"] = position
            next[f"left_{name}"] = ca.if_else(refused, ca.if_else(known, left - 1, 0), bad_samples)
            label(name, last=last, position=position)
        return Step(output, next, numbers=numbers)

    signals = [p.signal for p in positions]
    nearest = {s.name: min(max(0.0, s.low), s.high) for s in signals}
    states = [State(replace(s, name=f"last_{s.name}", about="one sample ago"), nearest[s.name]) for s in signals]
    about = "samples with a bad measurement until the position is lost; 0: lost"
    states += [State(Signal(f"left_{s.name}", "1", 0, bad_samples, about), 0, True) for s in signals]
    inputs = [i for s in signals for i in (replace(s, name=f"{s.name}_held"), Signal(f"fault_{s.name}", "1", 0, 1))]
    outputs = [o for s in signals for o in (acting(s, samples), lost(s))]
    tag = f"positions {samples:g} samples later, when the currents act" if samples else "measured positions"
    return build(NAME, time, law, inputs=inputs, outputs=outputs, states=states, tag=tag)
