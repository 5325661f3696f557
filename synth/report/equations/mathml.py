"""Presentation MathML of SymPy expressions for browsers without scripts.

SymPy's own printer of presentation MathML shows -(a + b) as -a + b; this one brackets by precedence throughout, has
conditions, choices and saturations, and continues long sums on further lines.
A number with more than DIGITS digits is truncated and ends with an ellipsis; ``data-value`` has the full number.

Names as presentation MathML: a letter with the remaining characters as its subscript.

k_s_phi, i_d1, wphi and Kv1 have subscripts; names of Greek letters become Greek letters, longer words are upright.
A name of two letters is Greek only alone or before a number: pi and mu1, but pid and mute are words.
"""

import re
import unicodedata
from collections.abc import Sequence
from itertools import pairwise

import sympy as sp
from markupsafe import Markup, escape

from synth.report.equations.symbolic import opaque

GREEK = {unicodedata.name(c).rpartition(" ")[2].lower(): c for c in "αβγδεζηθικμνξπρστυφχψω"} | {"lambda": "λ"}
GREEK |= {name.capitalize(): letter.upper() for name, letter in GREEK.items()}
_HEADS = [name if len(name) > 2 else f"{name}(?![a-z])" for name in sorted(GREEK, key=len, reverse=True)]
_SPLIT = re.compile(
    rf"(?P<head>{'|'.join(_HEADS)}"
    rf"|[vwiu](?=[a-z](?:\d|$)|{'|'.join(GREEK)})|[A-Z](?=[a-z]{{1,2}}\d*$)|[A-Za-z](?=\d))(?P<tail>.*)"
)


def symbol(name: str) -> Markup:
    """Return a name as a separate formula."""
    return Markup(f'<math display="inline"><mrow>{markup(name)}</mrow></math>')


def markup(text: str) -> str:
    """Return the markup of a name; one that begins with '=' is written literally."""
    if text.startswith("="):
        return f"<mi>{escape(text[1:])}</mi>"
    head, *tail = text.split("_")
    if (match := _SPLIT.fullmatch(head)) and (match["tail"] or head in GREEK):
        head, tail = match["head"], [match["tail"], *tail] if match["tail"] else tail
    base = f"<mi>{GREEK.get(head, head)}</mi>"
    below = [markup for part in tail if part for markup in _subscript(part)]
    if not below:
        return base
    gap = '<mspace width="0.2em"></mspace>'
    return f"<msub>{base}<mrow>{gap.join(below)}</mrow></msub>"


def _subscript(part: str) -> list[str]:
    """Return the markup of one part of a subscript: i_d1 has d1, and phi3 a letter and a number."""
    match = re.fullmatch(r"([A-Za-z]*)(\d*)", part)
    word, digits = match.groups() if match else (part, "")
    letters = f"<mi>{escape(GREEK.get(word, word))}</mi>" if word else ""
    return [letters + (f"<mn>{digits}</mn>" if digits else "")]


DIGITS = 6
WIDTH = 64  # characters of a sum on one line
WORDS = {"asin": "arcsin", "acos": "arccos", "atan": "arctan", "asinh": "arsinh", "acosh": "arcosh", "atanh": "artanh"}
WORDS |= {"log": "ln", "sign": "sgn", "atan2": "atan2"}
RELATIONS = {"lt": "&lt;", "le": "≤", "eq": "=", "ne": "≠"}
LOGIC = {"and": "∧", "or": "∨"}
SUM, PRODUCT, POWER, ATOM = 1, 2, 3, 4  # operator precedence of a piece
RELATION, CONJUNCTION = 0, -1
TIMES, APPLY = '<mo>&#x2062;</mo><mspace width="0.15em"></mspace>', "<mo>&#x2061;</mo>"
Piece = tuple[str, int]


def expression(expr: sp.Expr) -> str:
    """Return the markup of an expression; long sums use several lines."""
    return cases(expr) if type(expr).__name__ == "choose" else _piece(expr)[0]


def display(*rows: str) -> str:
    """Return one formula."""
    return f'<math display="inline" displaystyle="true"><mrow>{"".join(rows)}</mrow></math>'


def _lines(terms: Sequence[str]) -> str:
    lines, width = [[terms[0]]], _width(terms[0])
    for term in terms[1:]:
        width += _width(term)
        if width > WIDTH:
            lines.append([])
            width = _width(term)
        lines[-1].append(term)
    if len(lines) == 1:
        return f"<mrow>{''.join(lines[0])}</mrow>"
    rows = "".join(f'<mtr><mtd class="left"><mrow>{"".join(line)}</mrow></mtd></mtr>' for line in lines)
    return f'<mtable class="continued">{rows}</mtable>'


def _width(markup: str) -> int:
    """Return the approximate width of a piece in characters; a fraction counts two thirds."""
    halves = re.sub(r"<mfrac>|</mfrac>", "", markup)
    shown = len(re.sub(r"<[^>]*>|&[^;]*;", "", halves))
    return shown * 2 // 3 if halves != markup else shown


def _piece(expr: sp.Expr) -> Piece:
    if isinstance(expr, sp.Symbol):
        return markup(expr.name), ATOM
    if expr is sp.pi:
        return '<mi mathvariant="normal">π</mi>', ATOM
    if expr is sp.oo:
        return "<mn>∞</mn>", ATOM
    if isinstance(expr, sp.Add):
        return _lines(_terms(expr)), SUM
    if (isinstance(expr, sp.Number) and expr < 0) or (isinstance(expr, sp.Mul) and _negative(expr)):
        return f"<mrow><mo>−</mo>{_parenthesised(-expr, PRODUCT)}</mrow>", SUM
    if isinstance(expr, sp.Mul) or (isinstance(expr, sp.Rational) and expr.q != 1):
        return _product(expr)
    if isinstance(expr, sp.Number):
        return _number(expr)
    if isinstance(expr, sp.Pow):
        return _power(expr)
    return _function(type(expr).__name__, [*expr.args])


def _parenthesised(expr: sp.Expr, least: int) -> str:
    """Return the markup of an expression, in parentheses if its precedence is below `least`."""
    markup, strength = _piece(expr)
    return markup if strength >= least else _bracketed("(", markup, ")")


def _bracketed(left: str, markup: str, right: str) -> str:
    tall = "true" if re.search("<m(frac|table|sqrt|root)", markup) else "false"
    fence = f'<mo fence="true" stretchy="{tall}">'
    return f"<mrow>{fence}{left}</mo>{markup}{fence}{right}</mo></mrow>"


def _negative(expr: sp.Expr) -> bool:
    return bool(expr.as_coeff_Mul()[0] < 0)


def _terms(expr: sp.Add) -> list[str]:
    """Return the terms with their signs, positive terms first."""
    ordered = sorted(expr.as_ordered_terms(), key=_negative)
    marked = []
    for k, term in enumerate(ordered):
        form = ' form="infix"' if k else ""
        sign = f"<mo{form}>−</mo>" if _negative(term) else f"<mo{form}>+</mo>" if k else ""
        marked.append(sign + _parenthesised(-term if _negative(term) else term, PRODUCT))
    return marked


def _product(expr: sp.Expr) -> Piece:
    coefficient, factors = expr.as_coeff_mul()
    above: list[sp.Expr] = []
    below: list[sp.Expr] = []
    for factor in factors:
        power = factor.as_base_exp()[1] if isinstance(factor, sp.Pow) else sp.Integer(1)
        (below if power.is_number and power < 0 else above).append(factor)
    whole = coefficient if not isinstance(coefficient, sp.Rational) else sp.Integer(coefficient.p)
    under = sp.Integer(coefficient.q) if isinstance(coefficient, sp.Rational) else sp.Integer(1)
    above = [whole, *above] if whole != 1 or not above else above
    below = [*([under] if under != 1 else []), *(1 / f for f in below)]
    if not below:
        return _factors(above), PRODUCT
    parts = (_piece(each[0])[0] if len(each) == 1 else _factors(each) for each in (above, below))
    return f"<mfrac>{''.join(f'<mrow>{part}</mrow>' for part in parts)}</mfrac>", ATOM


def _factors(factors: Sequence[sp.Expr]) -> str:
    pieces = [_parenthesised(factors[0], PRODUCT)]
    for before, factor in pairwise(factors):
        numbers = isinstance(factor, sp.Number) or (isinstance(before, sp.Number) and isinstance(factor, sp.Pow))
        pieces += ["<mo>·</mo>" if numbers else TIMES, _parenthesised(factor, PRODUCT)]
    return f"<mrow>{''.join(pieces)}</mrow>"


def _power(expr: sp.Pow) -> Piece:
    base, exponent = expr.as_base_exp()
    if exponent.is_number and exponent < 0:
        return f"<mfrac><mn>1</mn><mrow>{_piece(1 / expr)[0]}</mrow></mfrac>", ATOM
    if exponent == sp.Rational(1, 2):
        return f"<msqrt>{_piece(base)[0]}</msqrt>", ATOM
    if isinstance(exponent, sp.Rational) and exponent.p == 1:
        return f"<mroot><mrow>{_piece(base)[0]}</mrow><mn>{exponent.q}</mn></mroot>", ATOM
    above = _piece(exponent)[0]
    if isinstance(base, sp.Function) and exponent.is_Integer and type(base).__name__ in _PLAIN:
        return _application(f"<msup>{_word(type(base).__name__)}{above}</msup>", base.args), PRODUCT
    return f"<msup>{_parenthesised(base, ATOM)}<mrow>{above}</mrow></msup>", POWER


def _number(value: sp.Number) -> Piece:
    text = str(value) if isinstance(value, sp.Integer) else repr(float(value))
    mantissa, _, exponent = text.removesuffix(".0").partition("e")
    shown = _truncated(mantissa)
    whole = f' data-value="{mantissa}"' if shown != mantissa else ""
    written = f"<mn{whole}>{shown}</mn>"
    if not exponent:
        return written, ATOM
    power = f"<msup><mn>10</mn><mn>{str(int(exponent)).replace('-', '−')}</mn></msup>"
    return (power if mantissa == "1" else f"<mrow>{written}<mo>·</mo>{power}</mrow>"), PRODUCT


def _truncated(mantissa: str) -> str:
    """Return a mantissa truncated to DIGITS significant digits, with an ellipsis for the omitted ones."""
    whole, _, part = mantissa.partition(".")
    leading = len(part) - len(part.lstrip("0")) if not whole.strip("0") else 0
    keep = max(DIGITS - len(whole.lstrip("0")) + leading, 1)
    return f"{whole}.{part[:keep]}…" if len(part) > keep + 1 else mantissa


_PLAIN = frozenset({*WORDS, "sin", "cos", "tan", "sinh", "cosh", "tanh"})


def _function(kind: str, args: Sequence[sp.Expr]) -> Piece:
    if kind in RELATIONS or kind in LOGIC or kind == "not":
        return _bracketed("[", _condition(opaque(kind)(*args))[0], "]"), ATOM
    if kind == "choose":
        return _bracketed("(", cases(opaque(kind)(*args)), ")"), ATOM
    if kind == "Abs":
        return _bracketed("|", _piece(args[0])[0], "|"), ATOM
    if kind in ("floor", "ceil"):
        left, right = "⌊⌋" if kind == "floor" else "⌈⌉"
        return _bracketed(left, _piece(args[0])[0], right), ATOM
    if kind == "sat" and len(args) == 3:
        low, high = (f"<mrow>{_piece(a)[0]}</mrow>" for a in args[1:])
        return _application(f"<msubsup><mi>sat</mi>{low}{high}</msubsup>", args[:1]), ATOM
    return _application(_word(kind), args), ATOM


def _word(kind: str) -> str:
    return f"<mi>{escape(WORDS.get(kind, kind))}</mi>"


def _application(head: str, args: Sequence[sp.Expr]) -> str:
    whole = len(args) == 1 and type(args[0]).__name__ == "choose"  # one pair of parentheses is enough
    inner = cases(args[0]) if whole else "<mo>,</mo>".join(_piece(a)[0] for a in args)
    return f"<mrow>{head}{APPLY}{_bracketed('(', inner, ')')}</mrow>"


def cases(expr: sp.Expr) -> str:
    """Return the markup of a choice, one condition per row."""
    rows = []
    while type(expr).__name__ == "choose":
        condition, value, expr = expr.args
        rows.append((_piece(value)[0], f"<mtext>if&#xa0;</mtext>{_condition(condition)[0]}"))
    rows.append((_piece(expr)[0], "<mtext>otherwise</mtext>"))
    cells = "".join(f'<mtr><mtd class="left">{v}</mtd><mtd class="left">{c}</mtd></mtr>' for v, c in rows)
    return f'<mrow><mo fence="true">{{</mo><mtable class="cases">{cells}</mtable></mrow>'


def _condition(expr: sp.Expr) -> Piece:
    """Return the markup of a condition; a number means that it is not 0."""
    kind = type(expr).__name__
    if kind in RELATIONS:
        first, second = (_parenthesised(a, SUM) for a in expr.args)
        return f"<mrow>{first}<mo>{RELATIONS[kind]}</mo>{second}</mrow>", RELATION
    if kind in LOGIC:
        inside = (_condition(a) for a in _operands(kind, expr))
        parts = [m if s >= RELATION else _bracketed("(", m, ")") for m, s in inside]
        return f"<mrow>{f'<mo>{LOGIC[kind]}</mo>'.join(parts)}</mrow>", CONJUNCTION
    if kind == "not":
        markup, strength = _condition(expr.args[0])
        return f"<mrow><mo>¬</mo>{markup if strength >= ATOM else _bracketed('(', markup, ')')}</mrow>", ATOM
    return _piece(expr)


def _operands(kind: str, expr: sp.Expr) -> list[sp.Expr]:
    if type(expr).__name__ != kind:
        return [expr]
    return [operand for a in expr.args for operand in _operands(kind, a)]
