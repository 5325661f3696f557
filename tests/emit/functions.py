"""Functions of one variable, in ball arithmetic and in mpmath, and their polynomials (cached fits)."""

from collections.abc import Callable
from functools import cache
from types import SimpleNamespace
from typing import Any

import flint
import mpmath
import numpy as np

from models import pmlsm
from synth.analyse.numerics.precise import precision
from synth.emit.approx import certificate, enclosure, surrogate
from synth.emit.approx.polynomial import Polynomial

P = {p.name: p.value for p in pmlsm.PARAMETERS}
J = flint.acb(0, 1)


def log(w: flint.acb) -> flint.acb:
    return w.log(analytic=True)


BALLS = SimpleNamespace(
    pi=flint.acb.pi,
    sin=flint.acb.sin,
    cos=flint.acb.cos,
    sinh=flint.acb.sinh,
    tanh=flint.acb.tanh,
    exp=flint.acb.exp,
    log=log,
    sqrt=lambda w: w.sqrt(analytic=True),
    atan=lambda w: (log(1 + J * w) - log(1 - J * w)) / (2 * J),
    asin=lambda w: -J * log(J * w + (1 - w * w).sqrt(analytic=True)),
)
POINTS = SimpleNamespace(**{name: getattr(mpmath, name) for name in vars(BALLS)})


def coefficients(g: Any, m: Any) -> dict[str, Any]:
    """Return L_h, L_v1, L_v2, L_v3 of models/pmlsm.py at the gap `g` in m, with the functions of `m`."""
    pi = m.pi()
    k = pi / P["tau"]
    height, half = k * (g + P["h_m"]), P["b0"] / (2 * g)
    permeance = 1 - P["b0"] ** 2 / (g + P["b0"] / 2 + P["h_m"] / P["mu_rec"]) / (4 * P["t1"])
    gamma = (half * m.atan(half) - m.log(1 + half * half) / 2) * 4 / pi
    carter = P["t1"] / (P["t1"] - g * gamma)
    field = 4 / pi * P["mu0"] * P["H_c"] * m.sin(k * P["tau_p"] / 2) * m.sinh(k * P["h_m"]) / m.sinh(height)
    return {
        "L_h": permeance / (carter * m.sinh(height)),
        "L_v1": permeance * field * field,
        "L_v2": permeance * field / (m.tanh(height) * carter),
        "L_v3": permeance / (m.sinh(height) * carter) ** 2,
    }


FUNCTIONS: dict[str, Callable[[Any, Any], Any]] = {
    **{name: lambda x, m, name=name: coefficients(x, m)[name] for name in ("L_h", "L_v1", "L_v2", "L_v3")},
    "exp": lambda x, m: m.exp(x),
    "steep": lambda x, m: m.exp(x * 10**7),
    "csch": lambda x, m: 1 / m.sinh(55 * (x + 0.005)),
    "sin": lambda x, m: m.sin(x),
    "cos": lambda x, m: m.cos(x),
    "asin": lambda x, m: m.asin(x),
    "expm1": lambda x, m: m.exp(x) - 1,
}

WIDE, NARROW, TILT, PHASE, STEEP = (0.0124, 0.0366), (0.0168, 0.0322), (-0.0194, 0.0194), (-0.014, 0.014), (6e-8, 1e-7)


def on_balls(name: str) -> enclosure.Analytic:
    return lambda x: FUNCTIONS[name](x, BALLS)


@cache
def fit_function(name: str, ends: tuple[float, float], scalar: type[np.floating], eps: float) -> Polynomial:
    low, high = (float(scalar(v)) for v in ends)
    return surrogate.fit(on_balls(name), low, high, scalar, eps, name)


@cache
def enclose_function(name: str, ends: tuple[float, float]) -> enclosure.Enclosure:
    with precision(enclosure.BITS):
        return enclosure.enclose(on_balls(name), *(float(np.float32(v)) for v in ends), name)


def certify(p: Polynomial, g: enclosure.Enclosure, allowed: float) -> certificate.Certificate:
    with precision(enclosure.BITS):
        return certificate.certify(p, g, allowed)
