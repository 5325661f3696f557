"""Evaluator of presentation MathML: a recursive-descent parser of the visible formula.

    condition  = conjunct {∨ conjunct};    conjunct = negation {∧ negation};    negation = [¬] relation
    relation   = sum [(< | ≤ | = | ≠) sum];    sum = [−] term {(+ | −) term};    term = factor {[·] factor}

Invisible groups (mrow, the lines of a continued sum) are flattened first: parentheses that are missing on the page are
thus missing here too. A truncated number must be the beginning of its full value, which is then used.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

from synth.errors import DesignError
from synth.statespace import Array

Element = ElementTree.Element
FUNCTIONS: Mapping[str, Callable[..., Array]] = {
    **{n: getattr(np, n) for n in ("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "hypot", "log1p", "expm1")},
    **dict(zip(("arsinh", "arcosh", "artanh"), (np.arcsinh, np.arccosh, np.arctanh), strict=True)),
    **dict(zip(("arcsin", "arccos", "arctan", "atan2"), (np.arcsin, np.arccos, np.arctan, np.arctan2), strict=True)),
    **dict(
        zip(("min", "max", "mod", "ln", "sgn", "erf"), (np.fmin, np.fmax, np.fmod, np.log, np.sign, erf), strict=True)
    ),
}
_FENCES: Mapping[str, tuple[str, Callable[[Array], Array]]] = {
    "(": (")", np.asarray),
    "[": ("]", lambda truth: _as_number(truth != 0)),
    "|": ("|", np.abs),
    "⌊": ("⌋", np.floor),
    "⌈": ("⌉", np.ceil),
}
_RELATIONS = {"<": np.less, "≤": np.less_equal, "=": np.equal, "≠": np.not_equal}
_TIMES, _APPLY = "\u2062", "\u2061"
_INVISIBLE = ("mrow", "mspace", "math")


def key(markup: str) -> str:
    """Return a key that identifies a displayed name: its markup without space."""
    return _key(ElementTree.fromstring(markup))


def value(
    markup: str,
    names: Mapping[str, Array],
    limits: tuple[float, float] | None = None,
    tables: Mapping[str, Callable[..., Array]] | None = None,
) -> Array:
    """Return the value of the markup of an expression for values (N,) of the names, by `key`.

    `limits` are the bounds of a saturation displayed without bounds; `tables` are further functions by name.

    Raises DesignError for an ambiguous or invalid formula.
    """
    tokens = _flat(ElementTree.fromstring(f"<mrow>{markup}</mrow>"))
    reader = _Reader(tokens, names, limits, {**FUNCTIONS, **(tables or {})})
    amount = reader.condition()
    if reader.next is not None:
        raise DesignError(f"the formula continues after its end with '{_key(reader.next)}': show it as one expression")
    return amount


def _flat(element: Element) -> list[Element]:
    """Return the visible elements as a flat list."""
    if element.tag == "mspace":
        return []
    if element.tag == "mtable" and element.get("class") == "continued":
        return [piece for row in element for cell in row for child in cell for piece in _flat(child)]
    if element.tag in _INVISIBLE:
        return [piece for child in element for piece in _flat(child)]
    return [element]


def _key(element: Element) -> str:
    pieces = (_key(child) for child in element if child.tag != "mspace")
    inner = (element.text or "").strip() + " ".join(pieces)
    return inner if element.tag in _INVISIBLE else f"{element.tag}({inner})"


@dataclass
class _Reader:
    """Recursive-descent parser over visible elements."""

    tokens: list[Element]
    values: Mapping[str, Array]
    limits: tuple[float, float] | None
    functions: Mapping[str, Callable[..., Array]]
    at: int = 0

    @property
    def next(self) -> Element | None:
        return self.tokens[self.at] if self.at < len(self.tokens) else None

    def sign(self, *signs: str) -> str:
        """Consume and return the next sign if it is one of `signs`, else return an empty text."""
        piece = self.next
        if piece is None or piece.tag != "mo" or piece.text not in signs:
            return ""
        self.at += 1
        return str(piece.text)

    def evaluate_element(self, element: Element) -> Array:
        """Return the value of an element as a separate expression."""
        return self.evaluate(_flat(element) if element.tag in _INVISIBLE else [element])

    def evaluate(self, tokens: list[Element]) -> Array:
        reader = _Reader(tokens, self.values, self.limits, self.functions)
        amount = reader.condition()
        if reader.next is not None:
            raise DesignError(f"a part of the formula continues with '{_key(reader.next)}': show it as one expression")
        return amount

    def chain(self, left: Array, operand: Callable[[], Array], operators: Mapping[str, Callable[..., Any]]) -> Array:
        """Evaluate a left-associative chain of operands and operators that starts with the value `left`."""
        while sign := self.sign(*operators):
            left = np.asarray(operators[sign](left, operand()), dtype=np.float64)
        return left

    def condition(self) -> Array:
        return self.chain(self.conjunct(), self.conjunct, {"∨": np.logical_or})

    def conjunct(self) -> Array:
        return self.chain(self.negation(), self.negation, {"∧": np.logical_and})

    def negation(self) -> Array:
        return _as_number(self.negation() == 0) if self.sign("¬") else self.relation()

    def relation(self) -> Array:
        left = self.sum()
        if sign := self.sign(*_RELATIONS):
            return _as_number(_RELATIONS[sign](left, self.sum()))
        return left

    def sum(self) -> Array:
        first = -self.term() if self.sign("−") else self.term()
        return self.chain(first, self.term, {"+": np.add, "−": np.subtract})

    def term(self) -> Array:
        return self.chain(self.factor(), self.factor, {"·": np.multiply, _TIMES: np.multiply})

    def factor(self) -> Array:
        if self.sign("{"):
            return self.cases(self.take())
        if left := self.sign(*_FENCES):
            right, function = _FENCES[left]
            inner = self.condition()
            if not self.sign(right):
                raise DesignError(f"a formula opens '{left}' and does not close it: close it")
            return function(inner)
        piece = self.take()
        if (following := self.next) is not None and following.tag == "mo" and following.text == _APPLY:
            return self.function_call(piece)
        return self.atom(piece)

    def take(self) -> Element:
        piece = self.next
        if piece is None:
            raise DesignError("a formula ends where a value is needed: show the whole expression")
        self.at += 1
        return piece

    def cases(self, table: Element) -> Array:
        """Return the value in the first row whose condition is true."""
        conditions, values = [], []
        for row in table:
            value, condition = row
            words = [*condition]
            values.append(self.evaluate([p for child in value for p in _flat(child)]))
            rest = [p for child in words[1:] for p in _flat(child)]
            conditions.append(self.evaluate(rest) != 0 if rest else np.array(True))
        return np.select(np.broadcast_arrays(*conditions), np.broadcast_arrays(*values))

    def function_call(self, head: Element) -> Array:
        """Return the value of a function of the arguments in parentheses after it."""
        self.at += 2
        args = [self.condition()]
        while self.sign(","):
            args.append(self.condition())
        if not self.sign(")"):
            raise DesignError("a formula does not close the arguments of a function: close them")
        if head.tag == "msubsup":
            return np.fmax(np.fmin(args[0], self.evaluate_element(head[2])), self.evaluate_element(head[1]))
        if head.tag == "mi" and head.text == "sat" and self.limits:
            return np.fmax(np.fmin(args[0], self.limits[1]), self.limits[0])
        name = head[0] if head.tag == "msup" else head
        if name.text not in self.functions:
            raise DesignError(f"a formula applies '{name.text}', which is not a known function: write it out")
        function_value = self.functions[str(name.text)](*args)
        return np.asarray(function_value ** self.evaluate_element(head[1]) if head.tag == "msup" else function_value)

    def atom(self, piece: Element) -> Array:
        if piece.tag == "mn":
            return np.array(_number(piece))
        if piece.tag == "mi" and piece.text == "π" and piece.get("mathvariant") == "normal":
            return np.array(np.pi)
        if piece.tag == "mfrac":
            return self.evaluate_element(piece[0]) / self.evaluate_element(piece[1])
        if piece.tag == "msqrt":
            return np.asarray(self.evaluate([p for child in piece for p in _flat(child)]) ** 0.5)
        if piece.tag == "mroot":
            return np.asarray(self.evaluate_element(piece[0]) ** (1 / self.evaluate_element(piece[1])))
        if piece.tag == "msup":
            return np.asarray(self.base(piece[0]) ** self.evaluate_element(piece[1]))
        if _key(piece) in self.values:
            return self.values[_key(piece)]
        raise DesignError(f"a formula shows '{_key(piece)}', which has no value: name what it stands for")

    def base(self, element: Element) -> Array:
        """Return the base of a power: one element, or one pair of parentheses."""
        tokens = _flat(element)
        reader = _Reader(tokens, self.values, self.limits, self.functions)
        amount = reader.factor()
        if reader.next is not None:
            raise DesignError("a formula raises several pieces to a power: put them in parentheses")
        return amount


def _number(piece: Element) -> float:
    """Return a number, with its full value if it is displayed truncated."""
    shown, whole = str(piece.text).replace("−", "-"), piece.get("data-value")
    if shown == "∞":
        return float("inf")
    if whole is None:
        return float(shown)
    if not shown.endswith("…") or not whole.startswith(shown[:-1]):
        raise DesignError(f"a formula shows {shown} for {whole}: truncate the number, with an ellipsis")
    return float(whole)


def _as_number(truth: NDArray[np.bool_]) -> Array:
    return np.asarray(truth, dtype=np.float64)
