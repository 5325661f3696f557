"""How many poles of a delayed closed loop lie to the right of the imaginary axis, by the argument principle.

With the poles p of the rational factor of L (`transfer`), a factor k and any a > 0,

    g(s) = (1 + k L(s)) prod (s - p) / (s + a)

has no pole at or right of the axis, so that it has -(turn of g along the axis, from below to above) / (2 pi) zeros to
the right. The poles are counted exactly, those on the axis and those that L does not show, too. For w < 0, g is the
conjugate of what it is at -w for the conjugate of k.
"""

from dataclasses import replace

import numpy as np

from synth.analyse import transfer
from synth.analyse.transfer import Delayed, Response
from synth.errors import ModelError
from synth.statespace import StateSpace

RESOLVED = 1e-8  # where |1 + L| is less, rounding error decides on which side of -1 the loop passes


def count_unstable(loop: Delayed, factor: complex = 1.0, high: float | None = None, L: Response | None = None) -> float:
    """Return how many poles of the loop closed on `factor` L lie to the right, by the argument principle.

    With a delay, |D| >= 1 and no hold, infinitely many lie there or come as near to the axis as one likes: inf. The
    loop is followed up to `high` rad/s, left out as by `trace`; `L` is its response, where that is known already.

    Raises ModelError where rounding hides the answer.
    """
    size, model = abs(factor), loop.model
    if loop.delay_s and not loop.hold_s and size * abs(float(model.D[0, 0])) >= 1:
        return np.inf
    scaled = replace(loop, model=replace(model, C=size * model.C, D=size * model.D))
    value = L or transfer.response(loop)
    curve = transfer.trace(scaled, None, high, lambda w: size * value(w))
    halves = [_followed(model, curve, turn) for turn in (factor / size, np.conj(factor) / size)]
    (_, first, _), (_, second, _) = halves
    turn = sum(inside + after for inside, _, after in halves) + float(np.angle(np.exp(1j * (first + second))))
    count = -turn / (2 * np.pi)
    if abs(count - round(count)) > 0.1:
        raise ModelError(
            f"the delayed loop turns {-count:.3g} times around -1, no whole number: give a lower `low` and a higher "
            "`high`"
        )
    return round(count)


def _followed(model: StateSpace, curve: transfer.Curve, factor: complex) -> tuple[float, float, float]:
    """Return the turn of g over the curve, its angle where the curve starts, and its turn from the end to infinity.

    The half for w < 0 is the conjugate of that for the conjugate factor, and both meet at w = 0.
    """
    w, value = transfer.refined(lambda v: factor * curve.L(v), curve.w)
    least = int(np.abs(1 + value).argmin())
    if abs(1 + value[least]) < RESOLVED:
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
