"""Stability margins of random loops compared with brute force: no margin may be reported too large.

    L = k prod (s - z) / prod (s - p),   1 to 12 poles, integrators and unstable poles among them

as transfer function, as state space, sampled (periods down to 1e-5 of the fastest time constant) as either, or with an
exact delay and hold. The true margins follow from values of L alone, on a grid that is dense at all poles and zeros
and refined by bisection. L is evaluated from the factors, for a sampled state-space model from its matrices, and for a
sampled transfer function, whose poles are ill-conditioned, from the coefficients in 60 digits.
"""

import argparse
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from time import process_time

import numpy as np

from benchmarks.margins_cases import KINDS, Case, Complex, case
from synth.analyse.loops import stability_margins
from synth.errors import SynthError
from synth.statespace import Array

TOLERANCE = 1e-4  # relative: by how much a reported margin may exceed the truth
LIMIT_S = 2.0  # of processor time, which does not depend on other load
POINTS = 3000
CAP = 1e6  # gain margins beyond it, or below its inverse, count as infinite


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
    """The result of the library for a case: the largest excess of a margin over the truth, or its error."""

    case: Case
    excess: float
    worst: str
    refused: str
    seconds: float


def truth(case: Case) -> Truth:
    """Return the margins of a case by brute force."""
    w = _grid(case)
    value = case.value(w)
    unit = _sign_changes(lambda v: np.log(np.abs(case.value(v))), w, np.log(np.abs(value)))
    real = _sign_changes(lambda v: np.imag(case.value(v)) / np.abs(case.value(v)), w, value.imag / np.abs(value))
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
        float(_modulus_margin(case, w, value)),
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


def _sign_changes(f: Callable[[Array], Array], w: Array, value: Array) -> Array:
    """Return the sign changes of f, by bisection of all brackets at once."""
    k = np.flatnonzero(np.sign(value[:-1]) * np.sign(value[1:]) < 0)
    a, b, rising = w[k], w[k + 1], value[k] < 0
    for _ in range(45):
        middle = (a + b) / 2
        below = (f(middle) < 0) == rising if len(k) else np.zeros(0, dtype=bool)
        a, b = np.where(below, middle, a), np.where(below, b, middle)
    return (a + b) / 2


def _modulus_margin(case: Case, w: Array, value: Complex) -> float:
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


def compare_with_truth(case: Case) -> Outcome:
    """Return the library's margins of a case compared with the truth."""
    start = process_time()
    try:
        reported = stability_margins.of_loop(case.loop)
    except SynthError as error:
        return Outcome(case, 0.0, "", str(error), process_time() - start)
    seconds, excesses = process_time() - start, _excesses(reported, truth(case))
    if max(excesses.values()) > TOLERANCE and case.exact:
        excesses = _excesses(reported, truth(replace(case, value=case.exact)))
    worst = max(excesses, key=lambda name: excesses[name])
    return Outcome(case, excesses[worst], worst, "", seconds)


def _excesses(reported: stability_margins.Margins, true: Truth) -> dict[str, float]:
    return {
        "gain": _excess(min(reported.gain_margin, CAP), min(true.gain, CAP)),
        "reduction": _excess(1 / max(reported.gain_reduction_margin, 1 / CAP), 1 / max(true.reduction, 1 / CAP)),
        "phase": _excess(min(reported.phase_margin, 180.0), min(true.phase, 180.0)),
        "delay": _excess(min(reported.delay_margin, CAP), min(true.delay, CAP)),
        "modulus": _excess(reported.modulus_margin, true.modulus),
    }


def _excess(reported: float, true: float) -> float:
    return reported / true - 1 if true > 0 else 0.0


def search(count: int, seed: int) -> Iterator[Outcome]:
    """Yield the outcomes of random cases, all kinds in turn."""
    for k in range(count):
        yield compare_with_truth(case(KINDS[k % len(KINDS)], np.random.default_rng((seed, k))))


def main() -> int:
    """Print how many loops were answered, refused, optimistic or slow; return 1 when one was optimistic or slow."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--loops", type=int, default=5000)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    tally: Counter[tuple[str, str]] = Counter()
    for k, outcome in enumerate(search(options.loops, options.seed)):
        verdict = "refused" if outcome.refused else "optimistic" if outcome.excess > TOLERANCE else "right"
        tally[outcome.case.kind, verdict] += 1
        tally[outcome.case.kind, "slow"] += outcome.seconds > LIMIT_S
        if verdict == "optimistic" or outcome.seconds > LIMIT_S:
            line = f"loop {k}, {outcome.case.kind}, order {outcome.case.order}: "
            line += f"{outcome.worst} larger by {outcome.excess:.2e}"
            sys.stdout.write(f"{line}, {outcome.seconds:.2f} s\n")
    verdicts = ("right", "refused", "optimistic", "slow")
    for kind in KINDS:
        sys.stdout.write(f"{kind:28}" + "".join(f"  {v} {tally[kind, v]}" for v in verdicts) + "\n")
    return int(any(tally[kind, v] for kind in KINDS for v in ("optimistic", "slow")))


if __name__ == "__main__":
    sys.exit(main())
