"""A law that Python cannot evaluate on symbols is refused with the Block's name and CasADi's function to use."""

import math
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth import block, plant
from synth.block import Block, Step
from synth.errors import SignalError
from synth.signals import Signal
from synth.timing import Discrete

U, Y = Signal("u", "1", -1.0, 1.0), Signal("y", "1", -1.0, 1.0)


def made(law: Any) -> Block:
    return block.build("limiter", Discrete(1e-3), law, inputs=[U], outputs=[Y])


def if_else(u: Any) -> Any:
    if u > 0:
        return u
    return 0


DECISIONS = {
    "max": lambda u: max(u, 0),
    "min": lambda u: min(u, 0),
    "if": if_else,
    "and": lambda u: u > 0 and u,
    "not": lambda u: not u,
    "between": lambda u: 0 < u < 1,
    "conditional": lambda u: u if u > 0 else 0,
    "bits": lambda u: (u > 0) & (u < 1),
    "inverse": lambda u: ~(u > 0),
}


@pytest.mark.parametrize("name", DECISIONS)
def test_a_decision_of_python_is_refused_by_the_blocks_name(name: str) -> None:
    law = DECISIONS[name]
    with pytest.raises(SignalError, match=r"the law of block 'limiter' needs .* in line \d+, .*ca\.if_else.*ca\.fmax"):
        made(lambda u, x, k: Step({"y": law(u["u"])}))


@pytest.mark.parametrize("law", [lambda u: [1.0, 2.0][u], lambda u: int(u), lambda u: len(range(u))])
def test_an_index_or_a_count_that_is_a_symbol_is_refused(law: Any) -> None:
    with pytest.raises(SignalError, match=r"the law of block 'limiter' .*block\.table"):
        made(lambda u, x, k: Step({"y": law(u["u"])}))


@pytest.mark.parametrize("law", [math.sin, math.sqrt, lambda u: u + math.exp(u), lambda u: u * float(u)])
def test_what_pythons_math_makes_of_a_symbol_is_refused(law: Any) -> None:
    with pytest.raises(SignalError, match=r"block 'limiter' computes 'y' with NaN.* ca\.sin\(u\) for math\.sin\(u\)"):
        made(lambda u, x, k: Step({"y": law(u["u"])}))


@pytest.mark.parametrize("law", [abs, ca.sin, np.sin, lambda u: ca.fmax(u, 0), lambda u: ca.if_else(u > 0, u, np.nan)])
def test_what_casadi_can_express_is_a_block(law: Any) -> None:
    assert made(lambda u, x, k: Step({"y": law(u["u"])})).outputs == (Y,)


def test_a_name_that_is_none_of_its_signals_and_what_is_no_step_are_refused() -> None:
    with pytest.raises(SignalError, match="among its inputs block 'limiter' has no 'v': it has u"):
        made(lambda u, x, k: Step({"y": u["v"]}))
    with pytest.raises(SignalError, match="the law of block 'limiter' returns None: return a Step"):
        made(lambda u, x, k: None)


def test_a_mistake_in_the_law_itself_stays_raw() -> None:
    with pytest.raises(TypeError, match="NoneType"):
        made(lambda u, x, k: Step({"y": None + 1}))  # type: ignore[operator]


@pytest.mark.parametrize(
    ("physics", "message"),
    [
        (lambda x, u, p: ({"y": max(x["y"], 0)}, {"y": x["y"]}), r"the physics of plant 'tank' needs .*ca\.fmax"),
        (lambda x, u, p: ({"y": math.sqrt(x["y"])}, {"y": x["y"]}), r"plant 'tank' computes 'y' with NaN"),
        (lambda x, u, p: ({"y": x["z"]}, {"y": x["y"]}), "among its states plant 'tank' has no 'z': it has y"),
        (lambda x, u, p: {"y": x["y"]}, "the physics of plant 'tank' returns .*: return two mappings"),
    ],
)
def test_physics_are_checked_as_laws_are(physics: Any, message: str) -> None:
    with pytest.raises(SignalError, match=message):
        plant.build("tank", [Y], [U], [Y], [], physics)
