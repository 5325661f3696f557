"""Sampled linear models as Blocks against their recursion in NumPy, as CasADi evaluates them and as compiled C."""

import casadi as ca
import numpy as np
import pytest

from synth.analyse.loops import loop
from synth.block import Block
from synth.blocks.laws import linear_block
from synth.emit import write
from synth.execute import host
from synth.signals import Signal
from synth.statespace import StateSpace
from synth.timing import Discrete
from tests import tolerances
from tests.c_code import without_comments

pytestmark = pytest.mark.slow

TIME = Discrete(1e-3)
DOUBLE = tolerances.of("double")
INPUTS = [Signal("u", "N", -1, 1), Signal("v", "N m/rad", -1, 1)]
OUTPUTS = [Signal("p", "m", -50, 50), Signal("w", "rad", -200, 200)]
STATES = [Signal("p", "m", -50, 50), Signal("q", "m/s", -50, 50)]
MODEL = StateSpace(
    [[0.5, 1], [0, -0.25]], [[1, 0], [0.3, -1]], [[1, 0], [-2, 0.7]], [[0, 0], [1, -1]],
    ("p", "q"), ("u", "v"), ("p", "w"), TIME,
)  # fmt: skip


def make_block(model: StateSpace = MODEL, **changes: list[Signal]) -> Block:
    signals = {"inputs": INPUTS, "outputs": OUTPUTS, "states": STATES} | changes
    return linear_block.block("linear", model, tag="(1)", **signals)


def recursion(model: StateSpace, u: np.ndarray) -> np.ndarray:
    """Return the outputs (N, p) from rest."""
    x, y = np.zeros(len(model.A)), []
    for now in u:
        y.append(model.C @ x + model.D @ now)
        x = model.A @ x + model.B @ now
    return np.array(y)


def by_casadi(block: Block, u: np.ndarray) -> np.ndarray:
    f, x, y = block.function(), block.initial, []
    for now in u:
        x, out = f(x, now)
        y.append(ca.DM(out).full().ravel())
    return np.array(y)


def by_c(block: Block, u: np.ndarray) -> np.ndarray:
    emitted = write.emit(block, np.float64)
    columns = {s.name: u[:, i] for i, s in enumerate(block.inputs)}
    out = host.load(emitted.files, emitted.manifest).replay(columns).outputs
    return np.stack([out[s.name] for s in block.outputs], axis=1)


def test_the_block_steps_the_model() -> None:
    u = np.random.default_rng(0).uniform(-1, 1, (200, 2))
    expected = recursion(MODEL, u)
    for outputs in (by_casadi(make_block(), u), by_c(make_block(), u)):
        np.testing.assert_allclose(outputs, expected, rtol=DOUBLE, atol=DOUBLE)


def test_random_models() -> None:
    rng = np.random.default_rng(1)
    for n, m, p in ((1, 1, 1), (3, 2, 2), (5, 1, 3), (0, 3, 2)):
        A = rng.choice([-1, 0, 1, 0.3], (n, n)) * 0.4
        parts = A, *(rng.choice([-1.0, 0, 1, 0.7], s) for s in ((n, m), (p, n), (p, m)))
        names = (tuple(f"{letter}{i}" for i in range(k)) for letter, k in (("s", n), ("a", m), ("b", p)))
        model = StateSpace(*parts, *names, TIME)
        states, inputs, outputs = (
            [Signal(name, "1", -1e9, 1e9) for name in group] for group in (model.states, model.inputs, model.outputs)
        )
        block = linear_block.block("linear", model, inputs=inputs, outputs=outputs, states=states, tag="(1)")
        u = rng.uniform(-1, 1, (20, m))
        np.testing.assert_allclose(by_casadi(block, u), recursion(model, u), rtol=DOUBLE, atol=DOUBLE)


def test_only_entries_that_multiply_are_constants() -> None:
    block = make_block()
    expected = {
        "next_p_from_p": (0.5, "m/m"),
        "next_q_from_q": (-0.25, "m/s/m s"),
        "next_q_from_u": (0.3, "m/s/N"),
        "w_from_p": (-2.0, "rad/m"),
        "w_from_q": (0.7, "rad/m s"),
    }
    assert {c.name: (c.value, c.unit) for c in block.constants} == expected
    code = without_comments(write.emit(block, np.float32).files["linear.c"])
    assert code.count(" * ") == len(expected)


def test_the_linearisation_returns_the_model() -> None:
    linear = loop.linearise_block(make_block(), {}, {"u": 0.0, "v": 0.0})
    for letter in "ABCD":
        np.testing.assert_array_equal(getattr(linear, letter), getattr(MODEL, letter))
