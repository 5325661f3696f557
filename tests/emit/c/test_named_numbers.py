"""Numbers of the packaged C: each has a name, but for factors of formulas, ranges of inputs and polynomials."""

import re
from collections.abc import Sequence
from pathlib import Path

import pytest

GENERATED = Path(__file__).parents[3] / "generated_c"

NAMES = sorted(path.name for path in GENERATED.iterdir())
NUMBER = re.compile(r"(?<![\w.])(\d+\.?\d*(?:e[+-]?\d+)?)f\b")
# A declaration, a struct of numbers, a call of the guard, the argument of a polynomial, and a count beside a number.
NAMED = re.compile(r"static const|\.\w+ = -?[\d.]|_(?:hold|replace)(?:_within)?\(|_argument = |missed_calls|\(float\)")
# Of a design in OF_PLANT alone: the range of a state, which the header has, and the plant's numbers in the inverse of a
# feedback linearisation: F0/M, g, M/K and K/M of models/levitator.py.
LIMIT = re.compile(r"(_limit\(.*), [\d.e+-]+f\)")
OF_PLANT = {"levitator_2dof": ("9.333333", "9.81", "0.075", "13.333333")}


def nameless(source: str, known: Sequence[str] = ()) -> list[str]:
    """Return the lines with a number, not `known`, that is no factor of a formula: a multiple of 1/32 of 16 at most."""
    code = re.sub(r"/\*.*?\*/", "", source, flags=re.DOTALL)
    code = re.sub(r"^static inline float \w+_polynomial\(.*?^}", "", code, flags=re.DOTALL | re.MULTILINE)
    statements = [" ".join(s.split()) for s in re.split(r"[;{}]", code)]
    plain = [s for s in statements if not NAMED.search(s)]
    return [
        s
        for s in plain
        if any(has_no_name(n) for n in NUMBER.findall(LIMIT.sub(r"\1)", s) if known else s) if n not in known)
    ]


def has_no_name(number: str) -> bool:
    return float(number) > 16 or float(number) * 32 % 1 != 0


@pytest.mark.parametrize("name", NAMES)
def test_each_number_has_a_name(name: str) -> None:
    assert not nameless((GENERATED / name / f"{name}.c").read_text(), OF_PLANT.get(name, ()))


@pytest.mark.parametrize(
    "planted",
    [
        "x = 0.7f * y;",
        "if (y <= 0.05500909f) { z = 1.0f; }",
        "x = step_min(y,\n    24.0f);",
        "x = step_limit(0.7f * y, 1.3f);",
    ],
)
def test_a_number_without_a_name_is_found(planted: str) -> None:
    assert len(nameless(f"void step(void) {{ {planted} }}")) == 1
