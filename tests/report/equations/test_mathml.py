"""Displayed formulas, read back as Python expressions of the visible signs, evaluate to the expression."""

from xml.etree import ElementTree

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.report.equations import mathml, proof
from synth.report.equations.symbolic import opaque, symbol

NAMES = ("x", "g1", "k_s_phi")
X = [symbol(name) for name in NAMES]
VALUES = {n: np.array(v) for n, v in zip(NAMES, ([0.3, -1.7], [2.1, 0.4], [-0.9, 1.1]), strict=True)}
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
SIGNS = {"−": "-", "=": "==", "≠": "!=", "≤": "<=", "\u2062": "*", "·": "*", "\u2061": "", "∧": " and ", "∨": " or "}
SIGNS |= {"¬": " not ", "[": "flag(", "]": ")", "π": "pi", "{": ""}
GAP = '<mspace width="0.2em"></mspace>'
FENCES = {"|": "abs", "⌊": "floor"}
FORMS = {"mfrac": "(({0})/({1}))", "msqrt": "sqrt({0})", "msup": "{0}**({1})", "mroot": "({0})**(1/({1}))"}
FORMS |= {"msubsup": "between({1},{2})"}
FUNCTIONS = {n: getattr(np, n) for n in ("sin", "tanh", "arctan", "exp", "sqrt", "floor")}
FUNCTIONS |= {
    "min": np.fmin,
    "flag": lambda truth: float(truth != 0),
    "between": lambda low, high: lambda v: np.fmax(np.fmin(v, high), low),
    "power": lambda function, exponent: lambda v: function(v) ** exponent,
}


def visible_text(markup: str) -> str:
    return "".join(ElementTree.fromstring(markup).itertext())


def visible(element: ElementTree.Element) -> str:
    """Return the visible signs of an element in Python; invisible groups add no parentheses."""
    parts = [visible(child) for child in element]
    if element.tag == "msub":
        return next(n for n in NAMES if visible_text(mathml.markup(n)) == "".join(element.itertext()))
    if element.tag == "mn":
        return element.get("data-value") or (element.text or "").replace("−", "-")
    if element.get("class") == "cases":
        rows = [[visible(cell) for cell in row] for row in element]
        return "(" + "".join(f"({v}) if {c} else " for v, c in rows[:-1]) + f"({rows[-1][0]}))"
    if element.tag in ("mo", "mi"):
        return SIGNS.get(element.text or "", element.text or "")
    if element.tag == "mrow" and len(parts) > 2 and parts[0] in FENCES:
        return f"{FENCES[parts[0]]}({''.join(parts[1:-1])})"
    if element.tag == "msup" and parts[0] in FUNCTIONS:
        return f"power({parts[0]},{parts[1]})"
    return FORMS[element.tag].format(*parts) if element.tag in FORMS else "".join(parts)


def shown(markup: str) -> list[float]:
    """Return the value of a displayed formula at each point."""
    code = visible(ElementTree.fromstring(f"<mrow>{markup}</mrow>"))
    return [float(eval(code, {**FUNCTIONS, "pi": np.pi, **{n: v[k] for n, v in VALUES.items()}})) for k in range(2)]


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
        value = proof.value(expr, VALUES, proof.FUNCTIONS)
        assert np.allclose(shown(mathml.expression(expr)), value, rtol=1e-9, atol=1e-12, equal_nan=True)


def test_missing_parentheses_change_the_value() -> None:
    markup = mathml.expression(sp.Mul(X[0], X[1] + X[2], evaluate=False))
    bare = markup.replace('<mo fence="true" stretchy="false">(</mo>', "").replace(
        '<mo fence="true" stretchy="false">)</mo>', ""
    )
    x, g, k = VALUES.values()
    assert np.allclose(shown(markup), x * (g + k)) and bare != markup
    assert not np.allclose(shown(bare), x * (g + k))


def test_numbers_are_truncated_only_with_an_ellipsis() -> None:
    assert mathml.expression(sp.Float(0.0127)) == "<mn>0.0127</mn>"
    assert mathml.expression(sp.Float(1.2594458438287153)) == '<mn data-value="1.2594458438287153">1.25944…</mn>'
    assert "0.0123456…" in mathml.expression(sp.Float(0.01234567891))
    assert "<mn>−7</mn>" in mathml.expression(sp.Float(1.5e-7))


@pytest.mark.parametrize(
    ("name", "markup"),
    [
        ("g1", "<msub><mi>g</mi><mrow><mn>1</mn></mrow></msub>"),
        ("k_s_phi", f"<msub><mi>k</mi><mrow><mi>s</mi>{GAP}<mi>φ</mi></mrow></msub>"),
        ("wphi", "<msub><mi>w</mi><mrow><mi>φ</mi></mrow></msub>"),
        ("Kv1", "<msub><mi>K</mi><mrow><mi>v</mi><mn>1</mn></mrow></msub>"),
        ("i_d1", "<msub><mi>i</mi><mrow><mi>d</mi><mn>1</mn></mrow></msub>"),
        ("x_held", "<msub><mi>x</mi><mrow><mi>held</mi></mrow></msub>"),
        ("speed", "<mi>speed</mi>"),
    ],
)
def test_names_have_their_subscripts(name: str, markup: str) -> None:
    assert mathml.markup(name) == markup


def test_greek_letters_are_written_as_such() -> None:
    assert "φ" in mathml.markup("phi") and "θ" in mathml.markup("wtheta") and "Γ" in mathml.markup("Gamma")
    assert "π" not in mathml.markup("pid_integral") and "<mi>pid</mi>" in mathml.markup("pid_integral")
    assert "π" in mathml.markup("pi") and "μ" in mathml.markup("mu1")
    assert mathml.markup("sum") == "<mi>sum</mi>" and mathml.markup("=g1") == "<mi>g1</mi>"


def test_a_long_sum_goes_on_in_further_lines_and_keeps_its_value() -> None:
    terms = [sp.Integer(k + 1) * X[k % 3] ** (k + 1) for k in range(40)]
    markup = mathml.expression(sp.Add(*terms))
    assert 'class="continued"' in markup
    assert np.allclose(shown(markup), sum((k + 1) * [*VALUES.values()][k % 3] ** (k + 1) for k in range(40)))
