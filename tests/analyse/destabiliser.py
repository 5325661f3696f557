"""The worst factors of a disk margin as a model: they put a pole of the closed loop on the stability boundary."""

import numpy as np

from synth.analyse.loops.disk import DiskMargin
from synth.statespace import StateSpace
from synth.timing import Continuous


def destabiliser(margin: DiskMargin) -> StateSpace:
    """Return diag(f) as a model with real coefficients: each delta_i is an all-pass with the required phase."""
    w, time = margin.frequency, margin.time
    if not isinstance(time, Continuous):
        w = float(np.tan(w * time.period_s / 2))
    parts = [_first_order(delta, w, margin.skew) for delta in margin.delta.tolist()]
    A, B, C, D = (np.diag([part[k] for part in parts]) for k in range(4))
    if not isinstance(time, Continuous):
        one, root = np.eye(len(A)), np.sqrt(2)
        inverse = np.linalg.inv(one - A)
        A, B, C, D = inverse @ (A + one), root * inverse @ B, root * C @ inverse, D + C @ inverse @ B
    states, outputs = (tuple(f"{name}_{kind}" for name in margin.channels) for kind in ("allpass", "perturbed"))
    return StateSpace(A, B, C, D, states, margin.channels, outputs, time)


def _first_order(delta: complex, w: float, skew: float) -> tuple[float, float, float, float]:
    """Return a, b, c, d of f(s) with delta(s) = k (s - z)/(s + z), z > 0 and delta(i w) = delta; k if delta is real."""
    half, other = (1 - skew) / 2, (1 + skew) / 2
    turn = float(np.angle(delta)) % np.pi
    real = min(turn, np.pi - turn) < 1e-9
    k = delta.real if real else float(abs(delta) * np.sign(delta.imag))
    d = (1 + half * k) / (1 - other * k)
    if real:
        return -1.0, 0.0, 0.0, d
    # f = ((1 + half k) s + (1 - half k) z) / ((1 - other k) s + (1 + other k) z)
    z = w * np.tan(turn / 2)
    pole = (1 + other * k) / (1 - other * k) * z
    return -pole, 1.0, (1 - half * k) / (1 - other * k) * z - d * pole, d
