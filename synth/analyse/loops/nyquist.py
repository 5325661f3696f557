"""Nyquist stability criterion: the number of unstable closed-loop poles of a delayed loop.

With the poles p of the rational factor of L (`transfer`), a factor k and any a > 0,

    g(s) = (1 + k L(s)) prod (s - p) / (s + a)

has no pole in the closed right half-plane. By the argument principle, its number of zeros there is -1 / (2 pi) times
the phase of g accumulated along the axis from -i inf to i inf. The open-loop poles p are all included, also those on
the axis and those that cancel in L. For w < 0, g(i w) is the conjugate of g(-i w) with the conjugate of k.
"""

from dataclasses import replace

import numpy as np

from synth.analyse.loops import transfer
from synth.analyse.loops.transfer import Delayed, Response
from synth.analyse.numerics import refinement
from synth.errors import ModelError
from synth.statespace import StateSpace

MIN_RETURN_DIFFERENCE = 1e-8  # of |1 + L|: below it rounding hides on which side of -1 the loop passes


def count_unstable(loop: Delayed, factor: complex = 1.0, high: float | None = None, L: Response | None = None) -> float:
    """Return the number of unstable poles of the loop closed on `factor` L.

    With a delay, |D| >= 1 and no hold the number is inf: infinitely many poles are unstable or approach the axis. The
    loop is traced up to `high` rad/s, with the default of `trace`; `L` is its response, if already available.

    Raises ModelError if rounding hides the number.
    """
    size, model = abs(factor), loop.model
    if loop.delay_s and not loop.hold_s and size * abs(float(model.D[0, 0])) >= 1:
        return np.inf
    scaled = replace(loop, model=replace(model, C=size * model.C, D=size * model.D))
    value = L or transfer.response(loop)
    curve = transfer.trace(scaled, None, high, lambda w: size * value(w))
    above = _phase_change(model, curve, factor / size)
    below = above if np.isreal(factor) else _phase_change(model, curve, np.conj(factor) / size)
    (_, first, _), (_, second, _) = above, below
    phase = sum(inside + after for inside, _, after in (above, below)) + float(np.angle(np.exp(1j * (first + second))))
    count = -phase / (2 * np.pi)
    if abs(count - round(count)) > 0.1:
        raise ModelError(
            f"the delayed loop turns {-count:.3g} times around -1, not a whole number: give a lower `low` and a higher "
            "`high`"
        )
    return round(count)


def _phase_change(model: StateSpace, curve: transfer.Curve, factor: complex) -> tuple[float, float, float]:
    """Return the phase of g accumulated over the curve, its angle at the start, and its phase from the end to infinity.

    The half for w < 0 is the conjugate of that for the conjugate factor, and both meet at w = 0.
    """
    w, value = refinement.refine(lambda v: factor * curve.L(v), curve.w, factor * curve.value)
    least = int(np.abs(1 + value).argmin())
    if abs(1 + value[least]) < MIN_RETURN_DIFFERENCE:
        raise ModelError(
            f"|1 + L| is {abs(1 + value[least]):.0e} at {w[least]:.6g} rad/s: rounding hides whether the "
            "delayed loop is stable; change its gain or its delay a little"
        )
    s, poles = 1j * w, model.poles
    scale = float(np.exp(np.log(w[[0, -1]]).mean()))
    factors = [(s - p) / (s + (abs(p) if abs(p) > w[0] else scale)) for p in poles]
    g = (1 + value) * np.prod([np.ones(len(s)), *factors], axis=0)
    steps = np.diff(np.angle(g))
    inside = float(((steps + np.pi) % (2 * np.pi) - np.pi).sum())
    after = -float(np.angle(1 + value[-1]) + sum(np.angle(f[-1]) for f in factors))  # all tend to 1
    return inside, float(np.angle(g[0])), after
