"""An output is proved to stay in its declared range, or refused by name with the remedy."""

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, Exprs, Step, build, clip
from synth.blocks.guard.safety import GuardedInput, guard
from synth.composition import compose
from synth.emit.proof import safe
from synth.emit.write import emit
from synth.errors import EmitError
from synth.signals import Signal
from synth.timing import Discrete

TIME = Discrete(1e-3)
A, Y = Signal("a", "m", -1, 1), Signal("y", "m", -1, 1)
HELD = Signal("a_held", "m", -1, 1)


def make_block(law: Callable[[ca.SX], Any], guarded: bool = False) -> Block:
    seen = HELD if guarded else A

    def step(u: Exprs, x: Exprs, k: Exprs) -> Step:
        return Step({"y": law(u[seen.name])})

    block = build("made", TIME, step, inputs=[seen], outputs=[Y])
    parts = [guard(TIME, [GuardedInput(A, 0.0, False)], 3), block]
    return compose("whole", parts, inputs=["a"], outputs=["y"]) if guarded else block


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
@pytest.mark.parametrize("guarded", [False, True])
def test_an_output_that_leaves_its_range_is_refused_by_name(guarded: bool, scalar: type[np.floating]) -> None:
    with pytest.raises(EmitError) as caught:
        emit(make_block(lambda a: 3 * a, guarded), scalar)
    text = str(caught.value)
    for words in ("output 'y' = `(3 * ", "its declared range -1 .. 1 m; violated: it is -3 at ", "limit it in the law"):
        assert words in text


@pytest.mark.parametrize(
    "law", [lambda a: clip(3 * a, Y), lambda a: a, lambda a: a - a**3, lambda a: a * a, lambda a: 0.5 + a / 2]
)
def test_limited_or_proved_outputs_are_emitted(law: Callable[[ca.SX], Any]) -> None:
    """a - a^3 needs bisection, because its separate terms add up to -2 .. 2."""
    assert emit(make_block(law), np.float64).manifest["structs"]["output"]["fields"][0]["high"] == 1.0


def test_an_unproved_output_is_refused() -> None:
    with pytest.raises(EmitError, match=r"output 'y' .* not proved in .* cells: it is .* at the worst point"):
        emit(make_block(lambda a: ca.sin(3 * a)), np.float32)


def test_without_the_proof_the_manifest_would_claim_what_the_c_does_not_keep(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(safe, "require_output_ranges", lambda *_: None)
    assert emit(make_block(lambda a: 3 * a), np.float64).manifest["structs"]["output"]["fields"][0]["high"] == 1.0
