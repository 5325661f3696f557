"""Displayed formulas evaluate to the expression; misleading markup is detected."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.errors import DesignError
from synth.report.equations import glyphs, mathml, mathml_value
from synth.report.equations.symbolic import opaque, symbol

NAMES = ("x", "g1", "k_s_phi")
X = [symbol(name) for name in NAMES]
VALUES = {
    mathml_value.key(glyphs.markup(n)): v for n, v in zip(NAMES, ([0.3, -1.7], [2.1, 0.4], [-0.9, 1.1]), strict=True)
}
VALUES = {key: np.array(v) for key, v in VALUES.items()}
NUMBERS = st.sampled_from(
    [sp.Integer(3), sp.Rational(-1, 2), sp.Float(1.23456789e-7), sp.Float(-12.5), sp.pi, sp.sqrt(2)]
)
UNARY = (
    sp.sin,
    sp.tanh,
    sp.atan,
    sp.exp,
    sp.Abs,
    lambda a: -a,
    lambda a: a**2,
    lambda a: 1 / (2 + a**2),
    opaque("floor"),
)
BINARY = (lambda a, b: a + b, lambda a, b: a - b, lambda a, b: a * b, lambda a, b: a / (1 + b**2), opaque("min"))
FLAGS = (opaque("lt"), opaque("le"), opaque("and"), opaque("or"), opaque("ne"))
FUNCTIONS: dict[str, Callable[..., Any]] = {
    "Add": lambda *a: sum(a),
    "Mul": lambda *a: math.prod(a),
    "Pow": lambda a, b: a**b,
    "Abs": np.abs,
    "atan": np.arctan,
    "min": np.fmin,
    "choose": lambda c, a, b: np.where(c != 0, a, b),
    "sat": lambda v, low, high: np.fmax(np.fmin(v, high), low),
    "lt": lambda a, b: (a < b) * 1.0,
    "le": lambda a, b: (a <= b) * 1.0,
    "ne": lambda a, b: (a != b) * 1.0,
    "and": lambda a, b: ((a != 0) & (b != 0)) * 1.0,
    "or": lambda a, b: ((a != 0) | (b != 0)) * 1.0,
    "not": lambda a: (a == 0) * 1.0,
}


def true_value(expr: sp.Expr) -> Any:
    """Return the value by SymPy's own tree."""
    if isinstance(expr, sp.Symbol):
        return VALUES[mathml_value.key(glyphs.markup(expr.name))]
    if not expr.args:
        return np.array(float(expr))
    kind = type(expr).__name__
    return (FUNCTIONS.get(kind) or getattr(np, kind))(*(true_value(a) for a in expr.args))


def deeper(inner: st.SearchStrategy[sp.Expr]) -> st.SearchStrategy[sp.Expr]:
    pairs = st.tuples(inner, inner)
    flags = st.tuples(st.sampled_from(FLAGS), pairs).map(lambda t: t[0](*t[1]))
    return st.one_of(
        st.tuples(st.sampled_from(UNARY), inner).map(lambda t: t[0](t[1])),
        st.tuples(st.sampled_from(BINARY), pairs).map(lambda t: t[0](*t[1])),
        flags,
        flags.map(opaque("not")),
        st.tuples(flags, pairs).map(lambda t: opaque("choose")(t[0], *t[1])),
        inner.map(lambda a: opaque("sat")(a, sp.Float(-0.75), sp.Integer(1))),
    )


@settings(max_examples=300, deadline=None, derandomize=True)
@given(st.recursive(st.one_of(st.sampled_from(X), NUMBERS), deeper, max_leaves=12))
def test_markup_evaluates_to_the_expression(expr: sp.Expr) -> None:
    with np.errstate(all="ignore"):
        shown = mathml_value.value(mathml.expression(expr), VALUES)
        true = true_value(expr)
    assert np.allclose(shown, true, rtol=1e-9, atol=1e-12, equal_nan=True)


def shown(markup: str) -> np.ndarray:
    return mathml_value.value(markup, VALUES)


def test_missing_parentheses_change_the_value() -> None:
    markup = mathml.expression(sp.Mul(X[0], X[1] + X[2], evaluate=False))
    bare = markup.replace('<mo fence="true" stretchy="false">(</mo>', "").replace(
        '<mo fence="true" stretchy="false">)</mo>', ""
    )
    x, g, k = VALUES.values()
    assert np.allclose(shown(markup), x * (g + k)) and bare != markup
    assert not np.allclose(shown(bare), x * (g + k))


@pytest.mark.parametrize(
    ("markup", "message"),
    [
        ("<mi>q</mi>", "which has no value"),
        ("<mi>x</mi><mi>x</mi>", "continues after its end"),
        ("<mi>x</mi><mo>+</mo>", "ends where a value is needed"),
        ("<mo>(</mo><mi>x</mi>", "does not close it"),
        ("<msup><mrow><mi>x</mi><mo>+</mo><mn>1</mn></mrow><mn>2</mn></msup>", "raises several pieces"),
        ('<mn data-value="1.2346">1.2345…</mn>', "truncate the number"),
        ("<mi>sine</mi><mo>\u2061</mo><mo>(</mo><mi>x</mi><mo>)</mo>", "is not a known function"),
    ],
)
def test_invalid_markup_is_refused(markup: str, message: str) -> None:
    with pytest.raises(DesignError, match=message):
        shown(markup)


def test_numbers_are_truncated_only_with_an_ellipsis() -> None:
    assert mathml.expression(sp.Float(0.0127)) == "<mn>0.0127</mn>"
    assert mathml.expression(sp.Float(1.2594458438287153)) == '<mn data-value="1.2594458438287153">1.25944…</mn>'
    assert "0.0123456…" in mathml.expression(sp.Float(0.01234567891))
    assert "<mn>−7</mn>" in mathml.expression(sp.Float(1.5e-7))


@pytest.mark.parametrize(
    ("name", "key"),
    [
        ("g1", "msub(mi(g)mn(1))"),
        ("k_s_phi", "msub(mi(k)mi(s) mi(φ))"),
        ("wphi", "msub(mi(w)mi(φ))"),
        ("Kv1", "msub(mi(K)mi(v)mn(1))"),
        ("i_d1", "msub(mi(i)mi(d)mn(1))"),
        ("x_held", "msub(mi(x)mi(held))"),
        ("speed", "mi(speed)"),
    ],
)
def test_names_have_their_subscripts(name: str, key: str) -> None:
    assert mathml_value.key(glyphs.markup(name)).replace(" ", "") == key.replace(" ", "")


def test_greek_letters_are_written_as_such() -> None:
    assert "φ" in glyphs.markup("phi") and "θ" in glyphs.markup("wtheta") and "Γ" in glyphs.markup("Gamma")
    assert "π" not in glyphs.markup("pid_integral") and "<mi>pid</mi>" in glyphs.markup("pid_integral")
    assert "π" in glyphs.markup("pi") and "μ" in glyphs.markup("mu1")
    assert glyphs.markup("sum") == "<mi>sum</mi>" and glyphs.markup("=g1") == "<mi>g1</mi>"


def test_a_long_sum_goes_on_in_further_lines_and_keeps_its_value() -> None:
    terms = [sp.Integer(k + 1) * X[k % 3] ** (k + 1) for k in range(40)]
    markup = mathml.expression(sp.Add(*terms))
    assert 'class="continued"' in markup
    assert np.allclose(shown(markup), sum((k + 1) * [*VALUES.values()][k % 3] ** (k + 1) for k in range(40)))
