"""MISRA C:2012, rules 10.8 and 12.1: composite expressions that are cast, and bare arms of choices, are locals."""

import re
from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.block import State, Step, build, clip, table
from synth.emit.c.expressions import Text
from synth.emit.passes import schedule
from synth.emit.write import emit
from synth.signals import Signal
from synth.verify.proofs import prove
from tests import tools
from tests.emit import one_step
from tests.emit.dyadic import TIME

pytestmark = pytest.mark.slow

U, N, Y = Signal("u", "1", 0, 8), State(Signal("n", "1", 0, 7), 0, True), Signal("y", "1", -100, 100)
TABLE = table("numbers", (1.0, 2.0, 4.0))
COMPOSITE = re.compile(r"\((?:float|uint32_t)\)\((?!uint32_t\))")  # none of these laws casts a choice
Law = Callable[[ca.SX, ca.SX], tuple[ca.SX, ca.SX]]


def whole_part(u: ca.SX, n: ca.SX) -> tuple[ca.SX, ca.SX]:
    return ca.floor(2 * u + 0.5) - u, n


def index(u: ca.SX, n: ca.SX) -> tuple[ca.SX, ca.SX]:
    return TABLE(clip(u / 4 + 0.5, Signal("index", "1", 0, 2)) / 2 + 0.5), n


def count(u: ca.SX, n: ca.SX) -> tuple[ca.SX, ca.SX]:
    return u * (n + 1), n


def stored_as_a_count(u: ca.SX, n: ca.SX) -> tuple[ca.SX, ca.SX]:
    return u, ca.if_else(u < 4, ca.floor(u) + 1, 5)


LAWS = [whole_part, index, count, stored_as_a_count]


def code(law: Law) -> dict[str, str]:
    def step(u: Any, x: Any, k: Any) -> Step:
        y, n = law(u["u"], x["n"])
        return Step({"y": y}, {"n": n})

    block = build("casts", TIME, step, inputs=[U], outputs=[Y], states=[N])
    assert not one_step.differing_from_casadi([block], np.float32)
    return {name: text for name, text in emit(block, np.float32).files.items() if name.endswith((".c", ".h"))}


@pytest.mark.parametrize("law", LAWS)
def test_no_cast_of_a_composite_expression(law: Law, monkeypatch: pytest.MonkeyPatch) -> None:
    text = code(law)["casts.c"]
    assert re.search(r"\((?:float|uint32_t)\)\w", text) and not COMPOSITE.search(text)
    monkeypatch.setattr(Text, "is_composite", False)
    assert COMPOSITE.search(code(law)["casts.c"])


@tools.needs("cppcheck", shows="that the rule finds the planted text, and none in what is emitted")
def test_cppcheck_finds_a_cast_of_a_sum_and_none_in_what_is_emitted(monkeypatch: pytest.MonkeyPatch) -> None:
    assert not prove.inspect(code(whole_part)).findings
    monkeypatch.setattr(Text, "is_composite", False)
    assert {f.rule for f in prove.inspect(code(whole_part)).findings} == {"misra-c2012-10.8"}


def bare_arm(u: ca.SX, n: ca.SX) -> tuple[ca.SX, ca.SX]:
    return u + ca.if_else(n > 3, 3 * u, 0) + n, n


@tools.needs("cppcheck", shows="that the rule finds the planted text, and none in what is emitted")
def test_cppcheck_finds_a_bare_first_arm_and_none_in_what_is_emitted(monkeypatch: pytest.MonkeyPatch) -> None:
    """A choice inside a sum whose first arm is a product: that arm is a local where no `if` is printed."""
    monkeypatch.setattr(schedule, "_COMPOSED", frozenset())
    assert "? (3.0f * " not in code(bare_arm)["casts.c"] and not prove.inspect(code(bare_arm)).findings
    monkeypatch.setattr(Text, "is_bare", False)
    assert "? (3.0f * " in code(bare_arm)["casts.c"]
    assert {f.rule for f in prove.inspect(code(bare_arm)).findings} == {"misra-c2012-12.1"}
