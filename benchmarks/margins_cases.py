"""Random loops with their frequency response: transfer functions, state space, sampled as either, delayed and held.

The response comes from the factors, for a sampled state-space model from its matrices, and for a sampled transfer
function, whose poles are ill-conditioned, from the coefficients in DIGITS digits.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache

import control
import mpmath  # type: ignore[import-untyped]
import numpy as np
from numpy.typing import NDArray

from synth.analyse.loops import loop as analysed_loop
from synth.analyse.loops import transfer
from synth.statespace import Array, StateSpace, of

Complex = NDArray[np.complex128]
Value = Callable[[Array], Complex]

KINDS = ("transfer function", "state space", "sampled transfer function", "sampled state space", "delayed")
DIGITS = 60


@dataclass(frozen=True, eq=False)
class Case:
    """A loop as given to the library, its frequency response, its poles and zeros (features), and frequency limits.

    `exact` is the response in high precision, where that of `value` may be rounding error.
    """

    kind: str
    order: int
    loop: object
    value: Value
    features: Complex
    low: float
    top: float
    exact: Value | None = None


def factors(rng: np.random.Generator) -> tuple[Complex, Complex, float]:
    """Return zeros, poles and gain of a loop with |L| = 1 near one of its rates."""
    order = int(rng.integers(1, 13))
    spread = rng.uniform(0.3, 3)
    poles = _roots(rng, order, spread, unstable=0.15, still=0.25)
    zeros = _roots(rng, int(rng.integers(0, order)), spread, unstable=0.1, still=0.0)
    at = 1j * 10 ** rng.uniform(-spread, spread)
    if rng.random() < 0.2:  # |L| = 1 at a pole's own frequency
        at = 1j * np.abs(poles[int(rng.integers(order))].imag) or at
    beside = 10 ** (rng.uniform(-1, 1) * (rng.random() < 0.8))
    gain = float(beside * np.abs(np.prod(at - poles)) / np.abs(np.prod(at - zeros)))
    return zeros, poles, gain * rng.choice([1.0, 1.0, 1.0, -1.0])


def _roots(rng: np.random.Generator, count: int, spread: float, unstable: float, still: float) -> Complex:
    roots: list[complex] = []
    while len(roots) < count:
        rate = 10 ** rng.uniform(-spread, spread)
        sign = 1 if rng.random() < unstable else -1
        if len(roots) + 1 < count and rng.random() < 0.4:
            zeta = 10 ** rng.uniform(-3, 0)
            root = rate * complex(sign * zeta, np.sqrt(max(1 - zeta * zeta, 0.0)))
            roots += [root, root.conjugate()]
        else:
            roots.append(0.0 if rng.random() < still and roots.count(0.0) < 2 else sign * rate)
    return np.array(roots, dtype=np.complex128)


def coefficients(roots: Complex, gain: float) -> list[mpmath.mpf]:
    """Return gain prod (s - r), highest powers first, in DIGITS digits."""
    with mpmath.workdps(DIGITS):
        product = [mpmath.mpf(gain)]
        left = list(roots)
        while left:
            root = left.pop()
            factor = [mpmath.mpf(1), -mpmath.mpf(root.real)]
            if root.imag:
                left.remove(root.conjugate())
                re, im = mpmath.mpf(root.real), mpmath.mpf(root.imag)
                factor = [mpmath.mpf(1), -2 * re, re * re + im * im]
            product = [
                mpmath.fsum(product[i] * factor[k - i] for i in range(len(product)) if 0 <= k - i < len(factor))
                for k in range(len(product) + len(factor) - 1)
            ]
        return product


def chain(zeros: Complex, poles: Complex, gain: float) -> StateSpace:
    """Return the loop as first- and second-order sections in series."""
    left, A, B, C, D = list(zeros), np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), np.array([[gain]])
    for group in _groups(poles):
        taken = _take_zeros(left, len(group))
        b, a = ([float(v) for v in coefficients(np.array(r, dtype=complex), 1.0)] for r in (taken, group))
        b = [0.0] * (len(a) - len(b)) + b
        n = len(a) - 1
        a2, b2 = np.eye(n, k=-1), np.eye(n, 1)
        a2[0] = -np.array(a[1:])
        c2, d2 = (np.array(b[1:]) - b[0] * np.array(a[1:]))[None], np.array([[b[0]]])
        A = np.block([[A, np.zeros((len(A), n))], [b2 @ C, a2]])
        B, C, D = np.vstack([B, b2 @ D]), np.hstack([d2 @ C, c2]), d2 @ D
    return of((A, B, C, D))


def _groups(roots: Complex) -> list[list[complex]]:
    real = [r for r in roots if not r.imag]
    return [*([r, r.conjugate()] for r in roots if r.imag > 0), *(real[k : k + 2] for k in range(0, len(real), 2))]


def _take_zeros(left: list[complex], count: int) -> list[complex]:
    """Take `count` zeros or fewer from the list, conjugate pairs together."""
    pair = next((r for r in left if r.imag > 0), None)
    taken = [pair, pair.conjugate()] if pair is not None and count == 2 else [r for r in left if not r.imag][:count]
    for r in taken:
        left.remove(r)
    return taken


def case(kind: str, rng: np.random.Generator) -> Case:
    """Return a random case of a kind."""
    zeros, poles, gain = factors(rng)
    rates = np.abs(poles[poles != 0])
    slow, fast = float(rates.min(initial=1.0)), float(rates.max(initial=1.0))
    low, features = 1e-4 * slow, np.concatenate([zeros, poles])

    def bare(w: Array) -> Complex:
        s = 1j * w[:, None]
        return np.asarray(gain * np.prod(s - zeros, axis=1) / np.prod(s - poles, axis=1))

    if kind == "transfer function":
        tf = control.tf(*(np.array([float(v) for v in coefficients(*f)]) for f in ((zeros, gain), (poles, 1.0))))
        return Case(kind, len(poles), tf, bare, features, low, 1e4 * fast)
    if kind == "state space":
        return Case(kind, len(poles), chain(zeros, poles, gain), bare, features, low, 1e4 * fast)
    if kind == "delayed":
        late, hold = 10 ** rng.uniform(-3, 0.5) / fast, rng.choice([0.0, 1.0]) * 10 ** rng.uniform(-2, 0) / fast
        model = transfer.with_delay_and_hold(chain(zeros, poles, gain), late, hold)

        def delayed_response(w: Array) -> Complex:
            held = np.sinc(w * hold / (2 * np.pi)) * np.exp(-1j * w * hold / 2)
            return np.asarray(bare(w) * np.exp(-1j * w * late) * held)

        return Case(kind, len(poles), model, delayed_response, features, low, 300 * max(fast, 1 / late))
    T = 10 ** rng.uniform(-5, -0.5) / fast
    if kind == "sampled state space":
        plant = analysed_loop.sampled(chain(zeros, poles, gain), T, float(rng.choice([0.0, T, 0.4 * T, 2 * T])))
        return Case(kind, len(plant.A), plant, _matrices(plant, T), features, low, np.pi / T, _determinants(plant, T))
    return _sampled_fraction(kind, zeros, poles, gain, T, low, rng)


def _matrices(model: StateSpace, T: float) -> Value:
    """Return the response from (z - 1) I - (A - I): near z = 1 the difference of z and A would be rounding error."""
    one = np.eye(len(model.A))

    def value(w: Array) -> Complex:
        shifted = np.expm1(1j * w * T)[:, None, None] * one - (model.A - one)
        try:
            states = np.linalg.solve(shifted, np.broadcast_to(model.B, (len(w), *model.B.shape)))
        except np.linalg.LinAlgError:
            # Bisection hit a pole exactly. Next to it the response is as large.
            return value(np.nextafter(w, np.inf))
        return np.asarray((model.C @ states)[:, 0, 0] + model.D[0, 0])

    return value


def _determinants(model: StateSpace, T: float) -> Value:
    """Return the response from characteristic polynomials in 4 DIGITS digits, computed on first use."""

    @cache
    def polynomials() -> tuple[list[mpmath.mpf], list[mpmath.mpf]]:
        a = _characteristic(model.A, None)
        fed = _characteristic(model.A, (model.B, model.C))
        d = mpmath.mpf(float(model.D[0, 0]))
        return [f + (d - 1) * p for f, p in zip(fed, a, strict=True)], a

    def value(w: Array) -> Complex:
        with mpmath.workdps(4 * DIGITS):
            b, a = polynomials()
            return np.array([complex(mpmath.polyval(b, z) / mpmath.polyval(a, z)) for z in _circle(w, T)])

    return value


def _characteristic(A: Array, fed: tuple[Array, Array] | None) -> list[mpmath.mpf]:
    """Return det(s I - A), or det(s I - A + B C), by the method of Faddeev and LeVerrier, highest powers first."""
    M = mpmath.matrix(A.tolist())
    if fed:
        M -= mpmath.matrix(fed[0].tolist()) * mpmath.matrix(fed[1].tolist())
    n, characteristic = len(A), [mpmath.mpf(1)]
    P = mpmath.eye(n)
    for k in range(1, n + 1):
        MP = M * P
        characteristic.append(-sum(MP[i, i] for i in range(n)) / k)
        P = MP + characteristic[-1] * mpmath.eye(n)
    return characteristic


def _sampled_fraction(
    kind: str, zeros: Complex, poles: Complex, gain: float, T: float, low: float, rng: np.random.Generator
) -> Case:
    features = np.concatenate([zeros, poles])
    sizes = np.abs(features[features != 0])
    at = 1j * 10 ** rng.uniform(*np.log10([sizes.min(initial=1.0), sizes.max(initial=1.0)]))
    z_poles, z_zeros = np.exp(poles * T), np.exp(zeros * T)
    scale = np.abs(np.prod(np.exp(at * T) - z_poles)) / np.abs(np.prod(np.exp(at * T) - z_zeros)) * np.sign(gain)
    b, a = (np.array([float(v) for v in coefficients(*f)]) for f in ((z_zeros, float(scale)), (z_poles, 1.0)))

    def value(w: Array) -> Complex:
        with mpmath.workdps(DIGITS):
            return np.array([complex(mpmath.polyval(list(b), z) / mpmath.polyval(list(a), z)) for z in _circle(w, T)])

    return Case(kind, len(poles), control.tf(b, a, T), value, features, low, np.pi / T)


def _circle(w: Array, T: float) -> Iterator[mpmath.mpc]:
    return (mpmath.expj(mpmath.mpf(float(v)) * mpmath.mpf(T)) for v in w)
