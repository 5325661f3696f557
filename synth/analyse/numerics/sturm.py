"""Zeros of polynomials counted and isolated by the remainder sequence of Sturm, in ball arithmetic (Arb).

    p_0, p_1,  p_k+1 = -rem(p_k-1, p_k)             V(x): changes of sign in p_0(x), p_1(x), ..., without zeros

With p_1 = p_0', V(a) - V(b) is the number of zeros of p_0 in (a, b]. With P(i v) = p_0(v) + i p_1(v), P of degree n
with a real leading coefficient in v, V(-inf) - V(inf) is the number of zeros of P in the right half-plane less that in
the left one (Hurwitz; Gantmacher, The Theory of Matrices II, XV). Both cost n^2 operations, and the second needs
leading coefficients alone, as Routh's array.

Balls decide signs, so a count is proved. Without a count is a sequence whose degrees fall by more than 1, that ends
before a constant, as for a zero on the imaginary axis, or whose signs MAX_BITS do not decide.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import flint

from synth.analyse.numerics import precise

FIRST_BITS, MAX_BITS = 512, 1 << 14
NEAREST_BITS = 256  # of two zeros that are separated
GRID = 300  # intervals between the bounds of the zeros in which a change of sign is looked for
MOST_STEPS = 100  # of Newton's method, or of halving, to a zero


def count_right_half_plane(real: flint.fmpz_poly, imaginary: flint.fmpz_poly) -> int | None:
    """Return the number of zeros of real + i imaginary with Re s > 0, None if it is not decided."""
    n = max(real.degree(), imaginary.degree())
    p, q = _on_axis(real, imaginary)
    if n < 1:
        return 0 if n == 0 else None
    a, b = int(p[n]), int(q[n])
    chain = _decided_sequence(a * p + b * q, a * q - b * p)  # times the conjugate of the leading coefficient
    if chain is None:
        return None
    leading = [_sign(f[f.degree()]) for f in chain]
    above = _changes(leading)
    below = _changes([s * (-1) ** f.degree() for s, f in zip(leading, chain, strict=True)])
    return (n + below - above) // 2


def positive_zeros(P: flint.fmpz_poly, bits: int) -> list[flint.arb] | None:
    """Return balls of about `bits` around the distinct positive zeros of P in rising order, None if not separated."""
    while P.degree() > 0 and P[0] == 0:
        P = P.right_shift(1)
    if P.degree() < 1:
        return []
    P = P // P.gcd(P.derivative())
    chain = _decided_sequence(P, P.derivative())
    if chain is None:
        return None
    count = _changes([_sign(f[0]) for f in chain]) - _changes([_sign(f[f.degree()]) for f in chain])
    with precise.precision(max(FIRST_BITS, 4 * bits)):
        brackets = _brackets(chain, count, *_bounds(P)) if count else []
        if brackets is None:
            return None
        f, slope = flint.arb_poly(P), flint.arb_poly(P.derivative())
        zeros = [_zero_between(f, slope, *bracket, bits) for bracket in brackets]
    return None if None in zeros else zeros


def _bounds(P: flint.fmpz_poly) -> tuple[flint.arb, flint.arb]:
    """Return powers of 2 between which all positive zeros of P lie (Fujiwara)."""
    bits = [int(c).bit_length() for c in P.coeffs()]
    n = len(bits) - 1
    above = max(-((bits[n] - 1 - bits[n - k]) // k) for k in range(1, n + 1) if bits[n - k])
    below = max(-((bits[0] - 1 - bits[k]) // k) for k in range(1, n + 1) if bits[k])
    return flint.arb(2) ** -(below + 1), flint.arb(2) ** (above + 1)


def _brackets(
    chain: Sequence[flint.arb_poly], count: int, low: flint.arb, high: flint.arb
) -> list[tuple[flint.arb, flint.arb, int]] | None:
    """Return intervals with one zero of the first polynomial each, and its sign at the lower end of each."""
    f, ratio = chain[0], ((high / low).log() / GRID).exp()
    points = [low]
    for _ in range(GRID):
        points.append((points[-1] * ratio).mid())
    signs = [_sign(f(u)) for u in points]
    if 0 not in signs:
        changes = [k for k in range(GRID) if signs[k] != signs[k + 1]]
        if len(changes) == count:
            return [(points[k], points[k + 1], signs[k]) for k in changes]
    return _separate(chain, (low, _changes_at(chain, low)), (high, _changes_at(chain, high)))


def _separate(
    chain: Sequence[flint.arb_poly], low: tuple[Any, int | None], high: tuple[Any, int | None]
) -> list[tuple[flint.arb, flint.arb, int]] | None:
    """Return the brackets between two numbers, each with its changes of sign, by halving."""
    (a, before), (b, after) = low, high
    if before is None or after is None or b < a * (1 + flint.arb(2) ** -NEAREST_BITS):
        return None
    if before - after < 2:
        return [(a, b, _sign(chain[0](a)))] * (before - after)
    tried = ((a * b).sqrt().mid() * (1 + flint.arb(2) ** -k) for k in (NEAREST_BITS // 2, 20, 10))
    middle = next(((u, V) for u in tried if (V := _changes_at(chain, u)) is not None), (a, None))
    halves = _separate(chain, low, middle), _separate(chain, middle, high)
    return None if halves[0] is None or halves[1] is None else halves[0] + halves[1]


def _changes_at(chain: Sequence[flint.arb_poly], u: flint.arb) -> int | None:
    signs = [_sign(f(u)) for f in chain]
    return None if 0 in signs else _changes(signs)


def _zero_between(
    f: flint.arb_poly, slope: flint.arb_poly, low: flint.arb, high: flint.arb, sign: int, bits: int
) -> Any:
    """Return a ball around the only zero of f between two numbers, `sign` that of f at the first; None without it."""
    u = (low * high).sqrt().mid()
    for _ in range(MOST_STEPS):
        value = f(u)
        low, high = (u, high) if _sign(value) == sign else (low, u)
        following = (u - value / slope(u)).mid()
        close = flint.arb(2) ** -bits * u
        if abs(following - u) < close:
            ends = [following - close, following + close]
            return ends[0].union(ends[1]) if _sign(f(ends[0])) * _sign(f(ends[1])) < 0 else None
        u = following if low < following < high else (low * high).sqrt().mid()
    return None


def _on_axis(real: flint.fmpz_poly, imaginary: flint.fmpz_poly) -> tuple[flint.fmpz_poly, flint.fmpz_poly]:
    """Return the real and the imaginary part of real(i v) + i imaginary(i v) as polynomials in v."""
    turned = [[(a, b), (-b, a), (-a, -b), (b, -a)][k % 4] for k, (a, b) in enumerate(_pairs(real, imaginary))]
    return flint.fmpz_poly([a for a, _ in turned]), flint.fmpz_poly([b for _, b in turned])


def _pairs(p: flint.fmpz_poly, q: flint.fmpz_poly) -> list[tuple[Any, Any]]:
    return [(p[k], q[k]) for k in range(1 + max(p.degree(), q.degree()))]


def _decided_sequence(p: flint.fmpz_poly, q: flint.fmpz_poly) -> list[flint.arb_poly] | None:
    """Return the remainder sequence of p and q, the degree of q one less, in the least precision that decides it."""
    bits = FIRST_BITS
    while bits <= MAX_BITS:
        with precise.precision(bits):
            if (chain := _sequence(flint.arb_poly(p), flint.arb_poly(q))) is not None:
                return chain
        bits *= 4
    return None


def _sequence(p: flint.arb_poly, q: flint.arb_poly) -> list[flint.arb_poly] | None:
    """Return the remainder sequence, None where the sign of a leading or constant coefficient is not decided."""
    chain = [p]
    while True:
        n = p.degree()
        if q.degree() != n - 1 or not _sign(q[n - 1]):
            return None
        chain.append(q)
        if n == 1:
            return chain
        a = p[n] / q[n - 1]
        b = (p[n - 1] - a * q[n - 2]) / q[n - 1]
        rest = flint.arb_poly([b, a]) * q - p
        p, q = q, rest.truncate(n - 1)


def _sign(v: Any) -> int:
    """Return the sign of a ball, 0 where it is not decided."""
    return 1 if v > 0 else -1 if v < 0 else 0


def _changes(signs: Sequence[int]) -> int:
    nonzero = [s for s in signs if s]
    return sum(a != b for a, b in pairwise(nonzero))
