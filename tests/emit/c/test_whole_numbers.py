"""Whole numbers in the C: one that a count is compared with or given has a name, unit and source."""

import re

import casadi as ca
import pytest

from synth.block import Constant, State, Step, build
from synth.composition import compose
from synth.emit.write import emit
from synth.errors import SignalError
from synth.signals import Signal
from synth.timing import Discrete
from tests.emit.c.test_header import NAMES, committed
from tests.emit.passes.test_guards import F32

# 0 and 1 say none and one; a bit of the fault word is a mask.
BARE = re.compile(r"(?<![\w.])(?:[2-9]|\d{2,})u\b")
DECLARATION = re.compile(r"static const uint32_t \w+ = \d+u; +/\* \S.*; .+ \*/|static const uint32_t \w+ = \d+u;$")
# `estimator_residual_faults`, which names no threshold
# of the last two, which sensor competes
KNOWN = {"hall_position": 1}
PATIENCE = Constant("patience", 3, "1", "samples until it gives up", ("left",))
X, Y = Signal("x", "m", -1, 1), Signal("y", "m", -1, 1)


def bare_numbers(text: str) -> list[str]:
    """Return the lines of a .c, without comments, with a whole number above 1 that has no name."""
    rows = re.sub(r"\*state = \(\w+\)\{.*?\};", "", text, count=1, flags=re.DOTALL).splitlines()
    rows = [row for row in rows if not DECLARATION.fullmatch(row.strip())]
    code = re.sub(r"/\*.*?\*/", "", "\n".join(rows), flags=re.DOTALL).splitlines()
    return [row.strip() for row in code if BARE.search(row)]


def counter(*numbers: Constant, most: int = 3) -> str:
    """Return the C of a Block that counts down from `most` while x is positive, and at 2 from there on."""

    def law(u: dict[str, ca.SX], x: dict[str, ca.SX], k: dict[str, ca.SX]) -> Step:
        late = x["left"] <= 2
        left = ca.if_else(u["x"] > 0, ca.if_else(x["left"] >= 1, x["left"] - 1, 0), most)
        return Step({"y": ca.if_else(late, u["x"], 0.25)}, {"left": left}, numbers=numbers)

    left = State(Signal("left", "1", 0, most, "samples"), most, True)
    block = build("count", Discrete(1e-3), law, inputs=[X], outputs=[Y], states=[left])  # type: ignore[arg-type]
    return emit(compose("step", [block], inputs=["x"], outputs=["y"]), F32).files["step.c"]


@pytest.mark.parametrize("name", NAMES)
def test_committed_c_compares_with_names(name: str) -> None:
    assert len(bare_numbers(committed(name)[f"{name}.c"])) == KNOWN.get(name, 0)


def test_a_planted_number_without_a_name_is_found() -> None:
    assert len(bare_numbers(counter())) == 2
    text = committed("maglev_5dof")["maglev_5dof.c"]
    for name, value in (("repeated_samples", "3u"), ("latch_samples", "5u"), ("pair_samples", "15u")):
        uses = len(re.findall(rf"\b{name}\b(?! =)(?!.*\*/)", text))
        planted = re.sub(rf"\b{name}\b(?! =)", value, text)
        assert uses and 0 < len(bare_numbers(planted)) <= uses


def test_a_whole_number_is_an_integer_with_unit_and_source() -> None:
    text = counter(PATIENCE, Constant("late", 2, "1", "samples left", ("left",)))
    assert re.search(r"static const uint32_t patience = 3u; +/\* 1; samples until it gives up \*/", text)
    assert "count_left <= late" in text and "count_left = patience;" in text.replace("? ", "")
    assert not bare_numbers(text)


@pytest.mark.parametrize("of", [("right",), ("lef",), ()])
def test_the_number_of_another_count_keeps_its_literal(of: tuple[str, ...]) -> None:
    assert "patience" not in counter(Constant("patience", 3, "1", "of another count", of))


def test_a_number_of_counts_is_whole() -> None:
    for value in (2.5, -1):
        with pytest.raises(SignalError, match="whole number"):
            Constant("patience", value, "1", "samples", ("left",))
