"""Typography of numbers, quantities with units, and equations for the report."""

import math
import re
from collections.abc import Iterable

from markupsafe import Markup, escape

PREFIXED = {"m": ("mm", "µm", "nm"), "rad": ("mrad", "µrad", "nrad"), "s": ("ms", "µs", "ns")}
UPRIGHT = frozenset(
    f"{inverse}{name}{h}" for inverse in ("", "a") for name in ("sin", "cos", "tan", "cot", "csc") for h in ("", "h")
) | {"exp", "log", "sqrt", "min", "max", "sign", "round", "abs", "det", "mod", "hypot"}
_SIGNS = str.maketrans("-*'", "−·′")
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_TOKEN = re.compile(
    r"(?P<name>[A-Za-zΑ-Ωα-ω]+)"
    r"|(?P<shift>[_^])(?:\{(?P<group>[^{}]*)\}|(?P<one>-?[A-Za-z0-9Α-Ωα-ω*]+))"
)


def number(value: float | str, digits: int = 4) -> str:
    """Return a number to `digits` significant digits in typographic form; text is unchanged."""
    if isinstance(value, str):
        return value
    if not math.isfinite(value):
        return "no number" if math.isnan(value) else "∞" if value > 0 else "−∞"
    if (value == int(value) and abs(value) < 1e6) or isinstance(value, int):
        text = f"{int(value):,}"
    elif 10.0**digits <= abs(value) < 1e6:
        text = f"{value:,.0f}"
    else:
        text = f"{value:.{digits}g}"
    mantissa, _, exponent = text.partition("e")
    power = f"·10{str(int(exponent)).translate(_SUPERSCRIPT)}" if exponent else ""
    return mantissa.replace("-", "−").replace(",", "\u202f") + power


def readable(text: str) -> str:
    """Return a unit in typographic form: m/s², µm; empty for the unit 1."""
    raised = re.sub(r"\^(-?\d+)", lambda m: m[1].translate(_SUPERSCRIPT), text)
    return "" if text == "1" else re.sub(r"\bu(?=(?:m|rad)\b)", "µ", raised)


def quantities(values: Iterable[float], unit: str) -> tuple[str, ...]:
    """Return values in SI `unit` as texts, all with the prefix that suits the largest: 12.3 µm, not 1.23e-05 m.

    Different values get enough digits, up to nine, to differ as text.
    """
    values = tuple(values)
    greatest = max((abs(v) for v in values if math.isfinite(v)), default=0.0)
    shown, factor = readable(unit), 1.0
    for k, finer in enumerate(PREFIXED.get(unit, ()), 1):
        if 0 < greatest < 0.9999 * 1000.0 ** (1 - k):
            shown, factor = finer, 1000.0**k
    scaled = [v if isinstance(v, int) and factor == 1 else factor * v for v in values]
    for digits in (4, 6, 9):
        texts = [number(v, digits) for v in scaled]
        if len(set(texts)) >= len(set(values)):
            break
    return tuple(f"{t} {shown}".rstrip() for t in texts)


def equation(text: str) -> Markup:
    """Return an equation as HTML: F_V, Kv_{1}, csch^2, e^{-k g}; names are italic, _ lowers and ^ raises."""
    pieces, at = [], 0
    for match in _TOKEN.finditer(text):
        pieces.append(_between(text[at : match.start()]))
        pieces.append(_token(match))
        at = match.end()
    return Markup("").join([*pieces, _between(text[at:])])


def _between(text: str) -> Markup:
    return escape(text.translate(_SIGNS))


def _token(match: re.Match[str]) -> Markup:
    if name := match["name"]:
        return escape(name) if name in UPRIGHT else Markup("<i>{}</i>").format(name)
    inner = match["group"] if match["group"] is not None else match["one"]
    return Markup("<sub>{}</sub>" if match["shift"] == "_" else "<sup>{}</sup>").format(equation(inner))
