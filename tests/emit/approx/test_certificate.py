"""Certificates, enclosures and minimax polynomials: detection of planted defects, and closed forms."""

from dataclasses import replace

import flint
import mpmath
import numpy as np
import pytest

from synth.analyse.numerics.precise import precision
from synth.emit.approx import certificate, enclosure, polynomial, surrogate
from synth.errors import EmitError
from tests.emit.functions import NARROW, PHASE, certify, enclose_function, fit_function, on_balls

pytestmark = pytest.mark.slow


def test_the_error_of_a_minimax_polynomial_equioscillates() -> None:
    with precision(enclosure.BITS):
        y = [-(flint.arb(k) / 200).cos_pi().mid() for k in range(201)]
        g = [v.exp().mid() for v in y]
        assert polynomial.fit(y, g, 0).error == pytest.approx(np.tanh(1.0), rel=1e-12)  # (M - m) / (M + m), M m = 1
        best = polynomial.fit(y, g, 5)
        errors = np.array([float(best.series(a) / b - 1) for a, b in zip(y, g, strict=True)])
    turns = errors[np.flatnonzero(np.diff(np.sign(np.diff(errors)))) + 1]
    peaks = np.array([errors[0], *turns, errors[-1]])
    assert len(peaks) == 7
    assert np.all(peaks[1:] * peaks[:-1] < 0)
    assert np.abs(peaks) == pytest.approx(best.error, rel=0.03)  # the exchange ends at 2 %


def test_refitting_after_each_rounding_keeps_the_error_small() -> None:
    with precision(enclosure.BITS):
        y = [-(flint.arb(k) / 100).cos_pi().mid() for k in range(101)]
        v = [flint.arb(3) / 2 + a / 2 for a in y]
        g = [a.exp().mid() for a in v]
        c = polynomial.fit(y, g, 9).series(flint.arb_poly([-3, 2])).coeffs()
        apart = {}
        for way, rounded in (
            ("again", polynomial.round_coefficients(c, v, g, np.float32)),
            ("each", tuple(float(np.float32(float(a))) for a in c)),
        ):
            p = flint.arb_poly(list(rounded))
            apart[way] = max(abs(float(p(a) / b - 1)) for a, b in zip(v, g, strict=True))
    assert apart["again"] < apart["each"] / 5


def test_a_fused_multiply_add_rounds_once() -> None:
    rng = np.random.default_rng(3)
    a, b = (rng.uniform(-2, 2, 2000).astype(np.float32) for _ in range(2))
    c = np.float32(0.7)
    # a b + c is a tie between two floats but for 2^-60, which rounding to double loses.
    a[0], b[0] = 2.0**-12 * (1 + 2.0**-18), 2.0**-12 * (1 - 2.0**-18)
    with mpmath.workprec(24):
        for term in (c, np.float32(1 + 2.0**-23), np.float32(-1 - 2.0**-22)):
            fused = polynomial.fused_multiply_add(a, b, term)
            exact = [
                float(mpmath.fsum([mpmath.fmul(float(u), float(v), exact=True), float(term)]))
                for u, v in zip(a, b, strict=True)
            ]
            assert fused.tolist() == exact
    twice = (a.astype(np.float64) * b + 1 + 2.0**-23).astype(np.float32)
    assert twice[0] != polynomial.fused_multiply_add(a, b, np.float32(1 + 2.0**-23))[0]


def test_a_perturbed_coefficient_is_no_longer_certified() -> None:
    for name, ends, scalar, eps in (("L_h", NARROW, np.float32, 2e-7), ("sin", PHASE, np.float32, 2e-7)):
        p, g = fit_function(name, ends, scalar, eps), enclose_function(name, ends)
        for k, c in enumerate(p.coefficients[:2]):
            worse = list(p.coefficients)
            worse[k] = float(np.float32(c * (1 + [4e-7, 1e-2][k])))
            assert certify(replace(p, coefficients=tuple(worse)), g, eps).max_relative_error > eps
    p, g = fit_function("exp", (-3.0, -1.0), np.float64, 1e-14), enclose_function("exp", (-3.0, -1.0))
    for k in range(len(p.coefficients)):
        worse = list(p.coefficients)
        worse[k] += 2e-14 * float(np.exp(p.high))  # |t| is 1.5 at the high end
        assert certify(replace(p, coefficients=tuple(worse)), g, 1e-14).max_relative_error > 1e-14


@pytest.mark.parametrize("way", ["multiply_then_add", "fused_multiply_add"])
def test_one_wrong_value_in_millions_is_found(monkeypatch: pytest.MonkeyPatch, way: str) -> None:
    """In a piece that ball arithmetic does not settle; it knows only how C rounds."""
    monkeypatch.setattr(certificate, "_chunk_bound", lambda *_: np.inf)
    p, g = fit_function("L_h", NARROW, np.float32, 2e-7), enclose_function("L_h", NARROW)
    planted, right = np.float32(0.0222222), getattr(polynomial, way)
    t = planted - np.float32(p.centre)
    monkeypatch.setattr(
        polynomial, way, lambda a, b, c: np.where(a == t, np.float32(1 + 1e-6), np.float32(1)) * right(a, b, c)
    )
    assert certify(p, g, 2e-7).max_relative_error > 2e-7


def bounds_and_errors(name: str, ends: tuple[float, float]) -> tuple[list[float], list[float]]:
    """Return bounds in ball arithmetic and the largest errors of the values of every 16th chunk."""
    p, g = fit_function(name, ends, np.float32, 2e-7), enclose_function(name, ends)
    with precision(enclosure.BITS):
        ranges = certificate._magnitudes(0.0 if p.parity != "none" else float(g.low), float(g.high))
        pieces = certificate._chunks(ranges, certificate._threshold(ranges, len(p.coefficients)))
        chunks = [chunk for piece in pieces for chunk in piece.divide(certificate.CHUNK_SIZE)][::16]
        bounds = [certificate._chunk_bound(p, g, chunk) for chunk in chunks]
        return bounds, [certificate._chunk_error(p, g, chunk.x) for chunk in chunks]


PIECEWISE = [("L_v2", NARROW), ("sin", PHASE), ("expm1", (0.0, 0.5))]


@pytest.mark.parametrize(("name", "ends"), PIECEWISE)
def test_no_value_exceeds_the_bound_of_its_piece(name: str, ends: tuple[float, float]) -> None:
    bounds, errors = map(np.array, bounds_and_errors(name, ends))
    assert np.all(errors <= bounds * (1 + 1e-12)) and np.isfinite(bounds).all()
    assert np.median(bounds / errors) < 2


def test_a_bound_of_a_piece_without_rounding_is_exceeded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(polynomial, "rounding_bound", lambda *_: flint.arb(0))
    bounds, errors = map(np.array, bounds_and_errors("L_h", NARROW))
    assert np.all(errors > bounds)


@pytest.mark.parametrize(("name", "ends"), PIECEWISE)
def test_branch_and_bound_finds_the_largest_error_of_all_values(
    monkeypatch: pytest.MonkeyPatch, name: str, ends: tuple[float, float]
) -> None:
    p, g = fit_function(name, ends, np.float32, 2e-7), enclose_function(name, ends)
    largest = certify(p, g, 2e-7)
    monkeypatch.setattr(certificate, "_chunk_bound", lambda *_: np.inf)
    everywhere = certify(p, g, 2e-7)
    assert largest.max_relative_error == everywhere.max_relative_error
    assert largest.checked_values < 0.6 * everywhere.checked_values


def test_without_bounds_every_float_of_a_range_without_zero_is_checked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(certificate, "_chunk_bound", lambda *_: np.inf)
    low, high = (int(np.float32(v).view(np.int32)) for v in NARROW)
    p, g = fit_function("L_h", NARROW, np.float32, 2e-7), enclose_function("L_h", NARROW)
    assert certify(p, g, 2e-7).checked_values == high - low + 1


def test_a_wrong_rounding_near_zero_is_found() -> None:
    # c_1 one unit in the last place off, where no value is tried one by one.
    p = fit_function("expm1", (0.0, 0.5), np.float32, 2e-7)
    assert p.checked_values < int(np.float32(0.5).view(np.int32))
    g = enclose_function("expm1", (0.0, 0.5))
    worse = replace(p, coefficients=(0.0, float(np.float32(1 + 3e-7)), *p.coefficients[2:]))
    with precision(enclosure.BITS):
        assert certificate.relative_error_bound(p, g, flint.arb(0), flint.arb(2) ** -10) <= 2e-7
        assert certificate.relative_error_bound(worse, g, flint.arb(0), flint.arb(2) ** -10) > 2e-7


def test_the_uncertainty_of_the_reference_counts_as_error() -> None:
    p, g = fit_function("L_h", NARROW, np.float32, 2e-7), enclose_function("L_h", NARROW)
    sure, unsure = certify(p, g, 1.0), certify(p, replace(g, error=flint.arb(0.25) * 1e-6), 1.0)
    assert unsure.max_relative_error > sure.max_relative_error + 0.9e-6  # L_h is 0.25 at most


@pytest.mark.parametrize("defect", ["short", "sure", "wrong"])
def test_an_enclosure_with_too_small_a_bound_is_detected(defect: str) -> None:
    g = enclose_function("L_h", NARROW)
    with precision(enclosure.BITS):
        terms = g.series.coeffs()
        defects = {
            "short": replace(g, series=flint.arb_poly(terms[:-8])),
            "sure": replace(g, error=g.error * flint.arb(2) ** -60),
            "wrong": replace(g, series=flint.arb_poly([terms[0] * (1 + flint.arb(2) ** -60), *terms[1:]])),
        }[defect]
        enclosure.check_bound(g, on_balls("L_h"), "L_h")
        with pytest.raises(EmitError, match=r"enclosing polynomial is .* away"):
            enclosure.check_bound(defects, on_balls("L_h"), "L_h")


def test_a_function_that_hides_its_branch_cut_is_detected() -> None:
    with pytest.raises(EmitError, match="must return a ball that is not finite where it is not analytic"):
        surrogate.fit(lambda x: (x * x + 1).sqrt(), -2.0, 2.0, np.float64)
