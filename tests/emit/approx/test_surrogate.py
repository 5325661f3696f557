"""Polynomials in place of functions, against mpmath and the model of the motor."""

from typing import Any

import casadi as ca
import flint
import mpmath
import numpy as np
import pytest

from models import pmlsm
from synth.emit.approx import enclosure, surrogate
from synth.emit.approx.polynomial import Polynomial
from synth.errors import EmitError
from tests.emit.functions import (
    BALLS,
    FUNCTIONS,
    NARROW,
    PHASE,
    POINTS,
    STEEP,
    TILT,
    WIDE,
    P,
    coefficients,
    fit_function,
    on_balls,
)

pytestmark = pytest.mark.slow

# name, range, float32: eps and degree, float64: degree
CASES = [
    ("L_h", WIDE, 2e-7, 10, 22),
    ("L_v1", WIDE, 3e-7, 13, 23),
    ("L_v2", WIDE, 2e-7, 11, 23),
    ("L_v3", WIDE, 2e-7, 13, 23),
    ("L_h", NARROW, 2e-7, 7, 16),
    ("L_v1", NARROW, 2e-7, 9, 18),
    ("L_v2", NARROW, 2e-7, 8, 16),
    ("L_v3", NARROW, 2e-7, 8, 18),
    ("csch", NARROW, 2e-7, 8, 16),
    ("exp", (-3.0, -1.0), 2e-7, 8, 13),
    ("exp", (-0.25, 0.5), 2e-7, 6, 10),
    ("exp", (-0.5, 0.0), 2e-7, 5, 9),
    ("sin", PHASE, 2e-7, 3, 5),
    ("asin", TILT, 2e-7, 3, 7),
    ("cos", PHASE, 2e-7, 2, 4),
    ("expm1", (0.0, 0.5), 2e-7, 6, 9),
    ("steep", STEEP, 2e-7, 5, 8),
]
SINGLE = [(name, ends, np.float32, eps, degree) for name, ends, eps, degree, _ in CASES]
DOUBLE = [(name, ends, np.float64, 1e-14, degree) for name, ends, _, _, degree in CASES]


def random_arguments(p: Polynomial, count: int) -> Any:
    """Return numbers of the type in the range except 0, half of them with |x| spread over many binades."""
    rng = np.random.default_rng(7)
    x = rng.uniform(p.low, p.high, count)
    x[::2] *= 2.0 ** -rng.integers(0, 40, len(x[::2])) if p.low <= 0 <= p.high else 1.0
    x = np.clip(x.astype(p.scalar), p.low, p.high)
    return x[x != 0]


def relative_errors(p: Polynomial, name: str, x: Any) -> Any:
    with mpmath.workdps(40):
        truth = [FUNCTIONS[name](mpmath.mpf(float(v)), POINTS) for v in x]
        return np.array([float(abs(float(v) / w - 1)) for v, w in zip(p.evaluate(x), truth, strict=True)])


def test_the_force_coefficients_of_these_tests_are_those_of_the_model() -> None:
    gap = ca.SX.sym("g")
    model = pmlsm.coefficients(gap, {name: ca.SX(value) for name, value in P.items()})
    for g in (0.0124, 0.0245, 0.0366):
        for name, value in coefficients(mpmath.mpf(g), POINTS).items():
            coefficient = float(ca.Function("f", [gap], [getattr(model, name)])(g))
            assert coefficient == pytest.approx(
                float(value), rel=1e-14
            )  # some 30 operations in double, none cancels much


@pytest.mark.parametrize(("name", "ends", "scalar", "eps", "degree"), SINGLE + DOUBLE)
def test_the_error_of_every_value_is_within_the_certificate(
    name: str, ends: tuple[float, float], scalar: type[np.floating], eps: float, degree: int
) -> None:
    p = fit_function(name, ends, scalar, eps)
    assert p.degree == degree
    assert p.max_relative_error <= eps
    errors = relative_errors(p, name, random_arguments(p, 100))
    assert errors.max() <= p.max_relative_error
    # The certificate is no wild overestimate: random rounding comes within a factor of the worst.
    assert errors.max() >= p.max_relative_error / (3 if scalar is np.float32 else 12)


@pytest.mark.parametrize(("scalar", "bits"), [(np.float32, 24), (np.float64, 53)])
@pytest.mark.parametrize(
    ("name", "ends"), [("L_h", WIDE), ("sin", PHASE), ("cos", PHASE), ("expm1", (0.0, 0.5)), ("steep", STEEP)]
)
def test_a_polynomial_is_evaluated_in_its_scalar_type(
    name: str, ends: tuple[float, float], scalar: type[np.floating], bits: int
) -> None:
    p = fit_function(name, ends, scalar, 2e-7 if scalar is np.float32 else 1e-14)
    x = random_arguments(p, 100)
    with mpmath.workprec(bits):
        for v, evaluated in zip(x, p.evaluate(x), strict=True):
            t = (mpmath.mpf(float(v)) - p.centre) * p.scale
            variable = t if p.parity == "none" else t * t
            q = mpmath.mpf(p.coefficients[-1])
            for c in p.coefficients[-2::-1]:
                q = c + variable * q
            assert float(q * t if p.parity == "odd" else q) == float(evaluated)


def test_odd_and_even_functions_keep_their_symmetry() -> None:
    x = np.geomspace(1e-30, 0.0139, 50).astype(np.float32)
    sine, cosine = (fit_function(name, PHASE, np.float32, 2e-7) for name in ("sin", "cos"))
    assert (sine.parity, cosine.parity) == ("odd", "even")
    assert np.array_equal(sine.evaluate(-x), -sine.evaluate(x))
    assert np.array_equal(cosine.evaluate(-x), cosine.evaluate(x))
    assert sine.evaluate(np.float32(0.0)) == 0
    assert fit_function("expm1", (0.0, 0.5), np.float32, 2e-7).coefficients[0] == 0


def test_coefficients_that_would_leave_float32_are_scaled() -> None:
    p = fit_function("steep", STEEP, np.float32, 2e-7)
    assert p.scale == 2.0**25
    assert max(map(abs, p.coefficients)) < 10
    assert fit_function("steep", STEEP, np.float64, 1e-14).scale == 1


def test_the_coefficients_do_not_depend_on_the_precision(monkeypatch: pytest.MonkeyPatch) -> None:
    single, double = (
        fit_function("csch", NARROW, np.float32, 2e-7),
        fit_function("exp", (-3.0, -1.0), np.float64, 1e-14),
    )
    assert (single.centre, double.centre) == (0.025634765625, -2.5)
    assert single.coefficients[:3] == (0.3841340243816376, -22.63251495361328, 752.4581909179688)
    assert double.coefficients[:3] == (0.08208499862389891, 0.08208499862389936, 0.04104249931193416)
    # They do not hang on the last bits of the arithmetic: with more of them all stays the same.
    monkeypatch.setattr(enclosure, "BITS", 500)
    for name, p, eps in (("csch", single, 2e-7), ("exp", double, 1e-14)):
        assert surrogate.fit(on_balls(name), p.low, p.high, p.scalar, eps) == p


def test_an_enclosure_contains_the_computed_values_and_is_tight() -> None:
    for name, ends in (("L_h", WIDE), ("sin", PHASE), ("cos", PHASE)):
        p = fit_function(name, ends, np.float32, 2e-7)
        for middle in np.linspace(0.2 * ends[0] + 0.8 * ends[1], ends[1], 5)[:-1]:
            ball = flint.arb(float(middle), 1e-5)
            x = np.linspace(middle - 9e-6, middle + 9e-6, 200).astype(np.float32)
            values, enclosure = p.evaluate(x), p.enclose(ball)
            assert all(enclosure.contains(flint.arb(float(v))) for v in values)
            spread = float(values.max() - values.min())
            assert float(enclosure.rad()) < spread + 2e-6 * abs(
                float(values[0])
            )  # interval Horner in a ball this small


@pytest.mark.parametrize(
    ("f", "ends", "message"),
    [
        (lambda x: 1 / x, (-1.0, 2.0), "not analytic in the range"),
        (lambda x: 1 / (x - 1.5), (1.0, 2.0), "not analytic in the range"),
        (lambda x: 1 / (x * x + 2.0**-10), (-1.0, 1.0), "singularity close by"),
        (BALLS.sqrt, (0.0, 1.0), "not analytic in the range"),
        (BALLS.log, (-2.0, -1.0), "not finite"),
        (lambda x: x - 1.25, (1.0, 2.0), "is 0, or too close to it, near 1.25"),
        (lambda x: x.cos(), (1.0, 2.0), "is 0, or too close to it, near 1.57"),
        (lambda x: x * (x - 1.25), (-1.0, 2.0), "near 1.25, and not just in a simple zero at 0"),
        (lambda x: x * x, (-1.0, 1.0), "no relative error can be held"),
        (lambda x: x * 0, (1.0, 2.0), "is 0"),
        (lambda x: x + flint.acb(flint.arb(1, 1e-9)), (1.0, 2.0), "give its constants exactly"),
        (lambda x: (x * 100).exp(), (-1.0, 1.0), "varies too much"),
        (lambda x: (x * 16).exp(), (-1.0, 1.0), "degree up to 24 come within"),
        (lambda x: (x * 10).cosh() * 1e30, (1.0, 2.0), "coefficients leave the type"),
    ],
)
def test_functions_that_no_polynomial_approximates_are_refused(
    f: enclosure.Analytic, ends: tuple[float, float], message: str
) -> None:
    with pytest.raises(EmitError, match=message):
        surrogate.fit(f, *ends, np.float32)


@pytest.mark.parametrize(
    ("low", "high", "scalar", "eps", "message"),
    [
        (0.1, 0.5, np.float32, None, "two rising ends that are exact in float32"),
        (0.5, 0.5, np.float64, None, "two rising ends"),
        (0.0, np.inf, np.float64, None, "two rising ends"),
        (0.0, np.nan, np.float64, None, "two rising ends"),
        (0.0, 1.0, np.float64, 0.0, "need one above 0"),
        (0.0, 1.0, np.float16, 1e-3, "need float32 or float64"),
        (0.5, 1.0, np.float32, 5e-8, "with rounding within .* need 5e-08"),
    ],
)
def test_invalid_arguments_are_refused(
    low: float, high: float, scalar: type[np.floating], eps: float | None, message: str
) -> None:
    with pytest.raises(EmitError, match=message):
        surrogate.fit(on_balls("exp"), low, high, scalar, eps, "exp")


def test_a_function_that_leaves_the_doubles_is_refused_by_name() -> None:
    with pytest.raises(EmitError, match="coefficients leave the type"):
        surrogate.fit(on_balls("exp"), 1000.0, 1001.0, np.float64)
    with pytest.raises(EmitError, match="need float32 or float64"):
        surrogate.least_degree(on_balls("exp"), 0.0, 1.0, np.float16)
