"""Names as presentation MathML: a letter with the remaining characters as its subscript.

k_s_phi, i_d1, wphi and Kv1 have subscripts; names of Greek letters become Greek letters, longer words are upright.
A name of two letters is Greek only alone or before a number: pi and mu1, but pid and mute are words.
"""

import re
import unicodedata

from markupsafe import Markup, escape

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
