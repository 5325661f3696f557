"""Biquad: notch, skewed notch or low-pass by the frequency and damping of zeros and poles, as a Block.

    K(s) = gain (1 + 2 D_z s / w_z + s^2 / w_z^2) / (1 + 2 D_p s / w_p + s^2 / w_p^2)        numerator 1 without zeros

is sampled by the trapezoidal rule and prewarped at w_z, without zeros at w_p (MATLAB `c2d` with `PrewarpFrequency`): a
notch has its depth at its frequency. From the differences d_k = u_k - u_{k-1}, with the poles a +- j b in z,

    x_k = a x_{k-1} - b v_{k-1} + d_k,    v_k = b x_{k-1} + a v_{k-1},        y_k = gain u_k + c_x x_k + c_v v_k

This coupled form keeps the poles where a direct form in single precision loses them (Gold and Rader 1967). Both states
decay to 0 while u is constant, so that the DC gain is `gain` itself, however slow the filter is. Real poles have

    x_k = p x_{k-1} + d_k,    v_k = p_v v_{k-1} + (1 - p_v) x_{k-1}
"""

from collections.abc import Sequence
from dataclasses import replace

import casadi as ca
import flint
import numpy as np

from synth import arguments
from synth.analyse.loops import peak_bounds
from synth.analyse.numerics import precise
from synth.block import Block, Constant, Exprs, State, Step, build
from synth.errors import SignalError
from synth.law import label
from synth.signals import Signal
from synth.timing import Discrete

SLACK = 1e-3  # relative margin of a state's bound for rounding in single precision


@arguments.checked
def block(
    name: str,
    time: Discrete,
    signal: Signal,
    filtered: str,
    *,
    poles: Sequence[float],
    zeros: Sequence[float] = (),
    gain: float = 1.0,
) -> Block:
    """Return the filter from `signal` to the output called `filtered`, in the same unit.

    `poles` and `zeros` are each (frequency in rad/s, damping); without zeros it is a low-pass. The range of the output
    follows from that of the signal, over which the states have bounds, too. Until the input ``ready`` is 1 the output
    is `gain` times the signal, so that the filter starts without a jump.

    Raises SignalError for anything but two numbers, a frequency that is not between 0 and Nyquist, poles whose damping
    is not positive, or zeros whose damping is negative; ModelError for poles that are too slow for `state_bounds`.
    """
    for what, pair in (("poles", poles), ("zeros", zeros)):
        _check_pair(what, pair, np.pi / time.period_s)
    if not np.isfinite(gain):
        raise SignalError(f"the gain of the biquad is {gain}: give a finite number")
    A, c, source = *_coefficients(time, poles, zeros, gain), _source(poles, zeros)
    values = {"a": A[0, 0], "b": A[1, 0], "a_v": A[1, 1], "c_x": c[0], "c_v": c[1], "gain": gain}
    is_complex = A[0, 1] != 0
    constants = [
        Constant(n, float(v), "1", source) for n, v in values.items() if not (is_complex and n == "a_v") and v != 1
    ]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        q, a, b = u[signal.name], k["a"], k["b"]
        in_phase = a * x["in_phase"] + ca.if_else(u["ready"], q - x["previous"], 0)
        if is_complex:
            in_phase, quadrature = in_phase - b * x["quadrature"], b * x["in_phase"] + a * x["quadrature"]
        else:
            quadrature = b * x["in_phase"] + k["a_v"] * x["quadrature"]
        total = k.get("gain", 1) * q + k["c_x"] * in_phase + k["c_v"] * quadrature
        label(filtered=total)
        return Step({filtered: total}, {"previous": q, "in_phase": in_phase, "quadrature": quadrature})

    # Constant inputs leave no state, so the middle of the range is as good an origin as any.
    from_input = np.block([[np.zeros((1, 3))], [np.array([[-1.0], [0.0]]), A]]), [[1.0], [1.0], [0.0]]
    model = (*from_input, np.eye(3), np.zeros((3, 1)), time)
    high = (1 + SLACK) * peak_bounds.state_bounds(model, [(signal.high - signal.low) / 2])[1:]
    first = min(max(0.0, signal.low), signal.high)
    states = [State(replace(signal, name="previous", about="signal one sample ago"), first)]
    states += [
        State(Signal(n, signal.unit, -float(h), float(h), f"{n.replace('_', ' ')} part of what changes"), 0)
        for n, h in zip(("in_phase", "quadrature"), high, strict=True)
    ]
    most = (1 + SLACK) * float(np.abs(c) @ high)
    low_end, high_end = sorted((gain * signal.low, gain * signal.high))
    output = Signal(filtered, signal.unit, low_end - most, high_end + most, f"{signal.name}, filtered")
    inputs = [signal, Signal("ready", "1", 0, 1, "every measurement was good at once")]
    return build(name, time, law, inputs=inputs, outputs=[output], states=states, constants=constants, tag=source)


def _check_pair(what: str, pair: Sequence[float], nyquist: float) -> None:
    """Raise SignalError unless a pair is a frequency and a damping; zeros may be missing."""
    if not len(pair) and what == "zeros":
        return
    if len(pair) != 2 or not np.isfinite(pair).all() or not 0 < pair[0] < nyquist:
        raise SignalError(
            f"the {what} of the biquad are {tuple(pair)}: give their frequency, between 0 and {nyquist:.6g} rad/s, and "
            "their damping"
        )
    if not (pair[1] > 0 or (pair[1] == 0 and what == "zeros")):
        raise SignalError(f"the damping of the {what} of the biquad is {pair[1]:g}: give one above 0")


def _source(poles: Sequence[float], zeros: Sequence[float]) -> str:
    kind = f"zeros at {zeros[0]:g} rad/s, damping {zeros[1]:g}, " if zeros else ""
    return f"biquad, {kind}poles at {poles[0]:g} rad/s, damping {poles[1]:g}"


def _coefficients(
    time: Discrete, poles: Sequence[float], zeros: Sequence[float], gain: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return A (2, 2) of both states, and c_x and c_v (2,)."""
    with precise.precision():
        w = flint.arb(float((zeros or poles)[0]))
        h = (w * flint.arb(time.period_s) / 2).tan() / w
        (p_2, p_1, p_0), (z_2, z_1, z_0) = _polynomial(poles, h), _polynomial(zeros, h) if zeros else (1, 2, 1)
        # K = gain (z_2 z^2 + z_1 z + z_0) / (p_2 z^2 + p_1 z + p_0), of which gain is left at z = 1
        scale = (p_2 + p_1 + p_0) / (z_2 + z_1 + z_0) * flint.arb(gain) / p_2
        middle, product = -p_1 / p_2 / 2, p_0 / p_2
        c_x = scale * z_2 - flint.arb(gain)
        remainder = flint.arb(gain) * product - scale * z_0  # K - gain = (z - 1) (c_x z + remainder) / denominator
        if poles[1] < 1:
            b = (product - middle * middle).sqrt()
            entries = [middle, -b, b, middle, c_x, (remainder + c_x * middle) / b]
        else:
            w, D = (flint.arb(float(v)) for v in poles)
            rates = (w * (D + r) for r in ((D * D - 1).sqrt(), -(D * D - 1).sqrt()))
            p, p_v = ((1 - h * v) / (1 + h * v) for v in rates)
            entries = [p, flint.arb(0), 1 - p_v, p_v, c_x, (remainder + c_x * p_v) / (1 - p_v)]
        values = np.array([float(v.mid()) for v in entries])
    return values[:4].reshape(2, 2), values[4:]


def _polynomial(pair: Sequence[float], h: flint.arb) -> tuple[flint.arb, flint.arb, flint.arb]:
    """Return (1 + 2 D s / w + s^2 / w^2) h^2 (z + 1)^2 w^2 in powers of z, for s = (z - 1) / (h (z + 1))."""
    w, D = (flint.arb(float(v)) for v in pair)
    square, damped = (h * w) ** 2, 2 * D * h * w
    return square + damped + 1, 2 * (square - 1), square - damped + 1
