"""Margins of random loops beside the truth, found by brute force: is a margin ever reported larger than it is?

    L = k prod (s - z) / prod (s - p),   1 to 12 poles, integrators and unstable poles among them

as transfer function, as state space, sampled (periods down to 1e-5 of the fastest time constant) as either, or with an
exact delay and hold. The truth comes from values of L alone, on a grid dense at all poles and zeros and refined by
bisection: from the factors, for a sampled state-space model from its matrices, and for a sampled transfer function,
whose coefficients hardly tell its poles, from the coefficients in 60 digits.
"""

import argparse
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from time import process_time

import control
import mpmath  # type: ignore[import-untyped]
import numpy as np
from numpy.typing import NDArray

from synth.analyse import loop as opened
from synth.analyse import margins, transfer
from synth.errors import SynthError
from synth.statespace import Array, StateSpace, of

Complex = NDArray[np.complex128]
Value = Callable[[Array], Complex]

KINDS = ("transfer function", "state space", "sampled transfer function", "sampled state space", "delayed")
DIGITS = 60
TOLERANCE = 1e-4  # relative: by how much a reported margin may exceed the truth
LIMIT_S = 2.0  # of processor time, so that a busy machine judges nothing
POINTS = 3000
CAP = 1e6  # factors on the gain beyond it, or below its inverse, count as none


@dataclass(frozen=True, eq=False)
class Case:
    """A loop as it is given to the library, its value at frequencies, where it is intricate, and the last frequency.

    `exact` gives the same value from high precision, where `value` may be rounding error.
    """

    kind: str
    order: int
    loop: object
    value: Value
    features: Complex
    low: float
    top: float
    exact: Value | None = None


@dataclass(frozen=True)
class Truth:
    """Margins found by brute force: factors, degrees, s and |1 + L|."""

    gain: float
    reduction: float
    phase: float
    delay: float
    modulus: float


@dataclass(frozen=True)
class Outcome:
    """What the library returned for a case: margins with their excess over the truth, or why it refused."""

    case: Case
    excess: float
    worst: str
    refused: str
    seconds: float


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
        taken = _taken(left, len(group))
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


def _taken(left: list[complex], count: int) -> list[complex]:
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
        model = transfer.delayed(chain(zeros, poles, gain), late, hold)

        def delayed(w: Array) -> Complex:
            held = np.sinc(w * hold / (2 * np.pi)) * np.exp(-1j * w * hold / 2)
            return np.asarray(bare(w) * np.exp(-1j * w * late) * held)

        return Case(kind, len(poles), model, delayed, features, low, 300 * max(fast, 1 / late))
    T = 10 ** rng.uniform(-5, -0.5) / fast
    if kind == "sampled state space":
        plant = opened.sampled(chain(zeros, poles, gain), T, float(rng.choice([0.0, T, 0.4 * T, 2 * T])))
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
            # Bisection came upon a pole to the last digit. Beside it the response is as large.
            return value(np.nextafter(w, np.inf))
        return np.asarray((model.C @ states)[:, 0, 0] + model.D[0, 0])

    return value


def _determinants(model: StateSpace, T: float) -> Value:
    """Return the response from characteristic polynomials in 4 DIGITS digits, found when it is first asked for."""

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


def truth(case: Case) -> Truth:
    """Return the margins of a case by brute force."""
    w = _grid(case)
    value = case.value(w)
    unit = _refined(lambda v: np.log(np.abs(case.value(v))), w, np.log(np.abs(value)))
    real = _refined(lambda v: np.imag(case.value(v)) / np.abs(case.value(v)), w, value.imag / np.abs(value))
    at = case.value(real)
    at = at[(np.abs(at.imag) < 1e-6 * np.abs(at)) & (at.real < 0)]
    beside = case.value(np.array([w[0] / 3, w[-1] / 3 if "sampled" not in case.kind else w[-1] * (1 - 1e-9)]))
    ends = [v for v, u in zip(value[[0, -1]], beside, strict=True) if abs(v - u) < 1e-3 * abs(v) and v.real < 0]
    gains = -1 / np.concatenate([at.real, np.array([v.real for v in ends])])
    gains = gains[(gains < CAP) & (gains > 1 / CAP)]
    angle = np.angle(-case.value(unit))
    return Truth(
        float(gains[gains > 1].min(initial=np.inf)),
        float(gains[gains <= 1].max(initial=0.0)),
        float(np.degrees(np.abs(angle).min(initial=np.inf))),
        float((angle % (2 * np.pi) / unit).min(initial=np.inf)),
        float(_least(case, w, value)),
    )


def _grid(case: Case) -> Array:
    points = POINTS if "sampled t" not in case.kind else POINTS // 4
    parts = [np.geomspace(case.low, case.top, points)]
    if case.kind == "delayed":
        parts.append(np.linspace(case.low, case.top / 30, 4 * points))
    for r in case.features[case.features.imag > 0]:
        away = np.geomspace(abs(r.real) / 8, max(abs(r.imag), 2 * abs(r.real)) / 2, 25)
        parts += [r.imag - away, r.imag + away]
    w = np.unique(np.concatenate(parts))
    return w[(w >= case.low) & (w <= case.top)]


def _refined(f: Callable[[Array], Array], w: Array, value: Array) -> Array:
    """Return where f changes sign, by bisection of all brackets at once."""
    k = np.flatnonzero(np.sign(value[:-1]) * np.sign(value[1:]) < 0)
    a, b, rising = w[k], w[k + 1], value[k] < 0
    for _ in range(45):
        middle = (a + b) / 2
        below = (f(middle) < 0) == rising if len(k) else np.zeros(0, dtype=bool)
        a, b = np.where(below, middle, a), np.where(below, b, middle)
    return (a + b) / 2


def _least(case: Case, w: Array, value: Complex) -> float:
    least = np.abs(1 + value)
    for k in np.argsort(least)[:3]:
        a, b = w[max(k - 1, 0)], w[min(k + 1, len(w) - 1)]
        for _ in range(4):
            v = np.linspace(a, b, 21)
            d = np.abs(1 + case.value(v))
            i = int(d.argmin())
            a, b = v[max(i - 1, 0)], v[min(i + 1, 20)]
            least = np.append(least, d[i])
    return float(least.min())


def judged(case: Case) -> Outcome:
    """Return what the library says of a case beside the truth."""
    start = process_time()
    try:
        found = margins.of_loop(case.loop)
    except SynthError as error:
        return Outcome(case, 0.0, "", str(error), process_time() - start)
    seconds, excesses = process_time() - start, _excesses(found, truth(case))
    if max(excesses.values()) > TOLERANCE and case.exact:
        excesses = _excesses(found, truth(replace(case, value=case.exact)))
    worst = max(excesses, key=lambda name: excesses[name])
    return Outcome(case, excesses[worst], worst, "", seconds)


def _excesses(found: margins.Margins, true: Truth) -> dict[str, float]:
    return {
        "gain": _excess(min(found.gain_margin, CAP), min(true.gain, CAP)),
        "reduction": _excess(1 / max(found.gain_reduction_margin, 1 / CAP), 1 / max(true.reduction, 1 / CAP)),
        "phase": _excess(min(found.phase_margin, 180.0), min(true.phase, 180.0)),
        "delay": _excess(min(found.delay_margin, CAP), min(true.delay, CAP)),
        "modulus": _excess(found.modulus_margin, true.modulus),
    }


def _excess(found: float, true: float) -> float:
    return found / true - 1 if true > 0 else 0.0


def search(count: int, seed: int) -> Iterator[Outcome]:
    """Yield the outcomes of random cases, all kinds in turn."""
    for k in range(count):
        yield judged(case(KINDS[k % len(KINDS)], np.random.default_rng((seed, k))))


def main() -> int:
    """Print how many loops were answered, refused, optimistic or slow; return 1 when one was optimistic or slow."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--loops", type=int, default=5000)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    tally: Counter[tuple[str, str]] = Counter()
    for k, found in enumerate(search(given.loops, given.seed)):
        verdict = "refused" if found.refused else "optimistic" if found.excess > TOLERANCE else "right"
        tally[found.case.kind, verdict] += 1
        tally[found.case.kind, "slow"] += found.seconds > LIMIT_S
        if verdict == "optimistic" or found.seconds > LIMIT_S:
            line = f"loop {k}, {found.case.kind}, order {found.case.order}: {found.worst} larger by {found.excess:.2e}"
            sys.stdout.write(f"{line}, {found.seconds:.2f} s\n")
    verdicts = ("right", "refused", "optimistic", "slow")
    for kind in KINDS:
        sys.stdout.write(f"{kind:28}" + "".join(f"  {v} {tally[kind, v]}" for v in verdicts) + "\n")
    return int(any(tally[kind, v] for kind in KINDS for v in ("optimistic", "slow")))


if __name__ == "__main__":
    sys.exit(main())
