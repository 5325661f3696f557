"""Dot products of a law: one order of rounding in evaluation, proofs and C; rows of constants become a matrix."""

from functools import cache
from typing import Any

import casadi as ca
import numpy as np
import pytest

from benchmarks import chain
from synth.block import Block, Constant, State, Step, build, clip, dot
from synth.blocks.guard import safe_output, safety
from synth.blocks.laws import linear_block
from synth.composition import compose
from synth.emit import pipeline
from synth.emit.passes import matrices
from synth.emit.program import lower
from synth.emit.proof import ranges, word_length
from synth.emit.write import EmittedCode, emit
from synth.errors import EmitError, SignalError
from synth.execute import host
from synth.signals import Signal
from synth.statespace import StateSpace
from synth.timing import Discrete
from synth.verify.proofs import eva
from tests import tolerances, tools

TIME = Discrete(1e-3)
DOUBLE = tolerances.of("double")
ROWS, COLUMNS, N = 5, 7, 500
INPUTS = [Signal(f"u{j}", "m", -1, 1) for j in range(COLUMNS)]
OUTPUTS = [Signal(f"y{i}", "m", -99, 99) for i in range(ROWS)]
RNG = np.random.default_rng(0)
M = RNG.normal(size=(ROWS, COLUMNS)) * 10.0 ** RNG.integers(-2, 2, (ROWS, COLUMNS))


def product(high: float = 99.0) -> Block:
    """Return y = M u as dot products; M[2, 3] = 0 is a number, the others are constants."""

    def law(u: Any, x: Any, k: Any) -> Step:
        values = [u[s.name] for s in INPUTS]
        rows = [[k[f"m{i}{j}"] if (i, j) != (2, 3) else ca.SX(0) for j in range(COLUMNS)] for i in range(ROWS)]
        return Step({s.name: dot(row, values) for s, row in zip(OUTPUTS, rows, strict=True)})

    constants = [Constant(f"m{i}{j}", M[i, j], "1", "test") for i in range(ROWS) for j in range(COLUMNS)]
    outputs = [Signal(s.name, "m", -high, high) for s in OUTPUTS]
    return build("made", TIME, law, inputs=INPUTS, outputs=outputs, constants=constants)


def inputs() -> np.ndarray:
    return np.random.default_rng(1).uniform(-1, 1, (N, COLUMNS)) * 10.0 ** -np.arange(COLUMNS)


def by_c(made: EmittedCode, u: np.ndarray) -> np.ndarray:
    out = host.load(made.files, made.manifest).replay({s.name: u[:, j] for j, s in enumerate(INPUTS)}).outputs
    return np.stack([out[s.name] for s in OUTPUTS], axis=1)


def from_left(u: np.ndarray, scalar: type[np.floating]) -> np.ndarray:
    """Return M u (N, m), each row added from left to right in a scalar type."""
    products = np.where(np.arange(ROWS * COLUMNS).reshape(M.shape) == 2 * COLUMNS + 3, 0, M).astype(scalar)[None]
    return np.add.accumulate(products * u.astype(scalar)[:, None, :], axis=2)[:, :, -1]


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_the_c_adds_each_row_from_left_to_right(scalar: type[np.floating]) -> None:
    made, u = emit(product(), scalar), inputs()
    assert "static const " in made.files["made.c"] and "made_times(matrix, 5u, 7u, x, y);" in made.files["made.c"]
    np.testing.assert_array_equal(by_c(made, u), from_left(u, scalar))
    from_right = np.add.accumulate((M * u[:, None, :])[:, :, ::-1], axis=2)[:, :, -1].astype(scalar)
    assert (by_c(made, u) != from_right).any()


def test_casadi_adds_in_the_same_order() -> None:
    f, u = product().function(), inputs()
    computed = np.array([ca.DM(f([], row)[1]).full().ravel() for row in u])
    np.testing.assert_allclose(computed, from_left(u, np.float64), rtol=0, atol=DOUBLE)


def test_the_range_of_a_row_contains_its_values_and_is_no_wider_than_the_sum_of_terms() -> None:
    block = product().rounded(np.float32)
    program = matrices.with_matrices(lower.program(block), "made", {c.name: c.value for c in block.constants})
    computed, u = ranges.analyse(program, ranges.bounds(block, np.float32), np.float32), inputs() * 1e6
    values = from_left(np.clip(u, -1, 1), np.float32)
    corners = from_left(np.sign(M[:, None] * np.ones((1, 1, COLUMNS)))[:, 0], np.float32).diagonal()
    for i, s in enumerate(OUTPUTS):
        r = computed[program.outputs[s.name]]
        assert r.low <= values[:, i].min() and values[:, i].max() <= r.high
        assert corners[i] <= r.high <= corners[i] * (1 + 1e-6)


def test_an_output_that_a_row_may_exceed_is_not_emitted() -> None:
    largest = float(np.abs(M).sum(axis=1).max())
    emit(product(1.01 * largest), np.float32)
    with pytest.raises(EmitError, match="must stay in its declared range"):
        emit(product(0.99 * largest), np.float32)


def test_a_dot_product_with_a_state_as_coefficient_becomes_products_and_sums() -> None:
    gain = Signal("gain", "1", -3, 3)

    def law(u: Any, x: Any, k: Any) -> Step:
        return Step({"y0": dot([x["gain"], k["k"]], [u["u0"], u["u1"]])}, {"gain": x["gain"] + u["u0"]})

    block = build(
        "made", TIME, law, inputs=INPUTS[:2], outputs=OUTPUTS[:1], states=[State(gain, 0)],
        constants=[Constant("k", 0.3, "1", "test")],
    )  # fmt: skip
    program = matrices.with_matrices(lower.program(block), "made", {"k": 0.3})
    assert not program.matrices and {n.op for n in program.nodes} >= {"mul", "add"}
    assert "dot" not in {n.op for n in program.nodes}
    assert "_matrix" not in emit(block, np.float32).files["made.c"]


@pytest.mark.parametrize(("k", "x"), [(1, 1), (2, 3), (0, 0)])
def test_a_dot_product_of_other_than_several_pairs_is_refused(k: int, x: int) -> None:
    with pytest.raises(SignalError, match=f"{k} coefficients and {x} values: give two or more of each"):
        dot([ca.SX(1)] * k, [ca.SX(1)] * x)


def test_zeros_and_rows_of_few_entries_are_not_multiplied() -> None:
    """An integral of a measurement has two entries of 24, and stays beside the tables."""
    program = pipeline.reduce(chain.block(8).rounded(np.float32), np.float32).program
    assert {m.rows[0]: (len(m.rows), len(m.columns)) for m in program.matrices.values()} == {
        "f1": (8, 32),
        "q1_predicted": (16, 32),
    }
    zeros = sum(v == 0 for m in program.matrices.values() for row in m.values for v in row)
    assert zeros <= (1 - linear_block.FILLED) * 24 * 32


@cache
def unrolled() -> Block:
    few, linear_block.FEWEST = linear_block.FEWEST, 10**9
    try:
        return chain.block(8)
    finally:
        linear_block.FEWEST = few


def test_tables_have_the_bits_of_the_unrolled_sums_and_the_same_word_length() -> None:
    rng, parts, results = np.random.default_rng(2), [], []
    u = {s.name: rng.uniform(s.low, s.high, 300) for s in chain.block(8).inputs}
    for block in (chain.block(8), unrolled()):
        made = emit(block, np.float32)
        results.append(host.load(made.files, made.manifest).replay(u).outputs)
        parts.append(word_length.summary(made.parts, "float32"))
    assert parts[0] == parts[1] and parts[0]
    for name, values in results[0].items():
        np.testing.assert_array_equal(values, results[1][name])


def returned(D: Any = ((0.0, 0.0),) * 3, n: int = 20) -> Block:
    """Return a dense law of which the first of three outputs comes back limited, as in an anti-windup."""
    rng = np.random.default_rng(4)
    A, B, C = 0.02 * rng.normal(size=(n, n)), rng.normal(size=(n, 2)), rng.normal(size=(3, n))
    states = [Signal(f"x{k}", "m", -9, 9) for k in range(n)]
    error, limited = Signal("e", "m", -1, 1), Signal("f0_limited", "N", -2, 2)
    forces = [Signal(f"f{k}", "N", -999, 999) for k in range(3)]
    model = StateSpace(A, B, C, D, tuple(s.name for s in states), ("e", "f0_limited"), ("f0", "f1", "f2"), TIME)
    law = linear_block.block("law", model, inputs=[error, limited], outputs=forces, states=states, tag="law")

    def limit(u: Any, x: Any, k: Any) -> Step:
        return Step({"f0_limited": clip(u["f0"], limited)})

    last = build("limit", TIME, limit, inputs=forces[:1], outputs=[limited], tag="limit")
    return compose("whole", [law, last], inputs=["e"], outputs=["f0_limited", "f1", "f2"])


def test_a_limited_output_that_comes_back_leaves_each_matrix_in_one_function(monkeypatch: pytest.MonkeyPatch) -> None:
    """The outputs are a function before the limit, the next states one behind it."""
    monkeypatch.setattr(linear_block, "FEWEST", 50)
    block = returned()
    text = emit(block, np.float32).files["whole.c"]
    output, update = (text.index(f" whole_law_{phase}(") for phase in ("output", "update"))
    first, second = (text.index(f"whole_law_{kind}_matrix_times(columns") for kind in ("output", "state"))
    assert output < first < update < second and text.count("const float columns[") == 2
    assert chain.disagreement(block, emit(block, np.float64)) < DOUBLE


def test_a_coefficient_of_0_closes_no_algebraic_loop(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first output does not depend on its own limit, but the others do."""
    monkeypatch.setattr(linear_block, "FEWEST", 50)
    block = returned(np.array([[1.0, 0.0], [2.0, 1.0], [-1.0, 0.5]]))
    made = emit(block, np.float64)
    assert "whole_law_output_matrix_times(columns" in made.files["whole.c"]
    assert chain.disagreement(block, made) < DOUBLE


def test_an_output_that_is_also_read_once_latched_keeps_its_matrix_in_one_function() -> None:
    """Of eight rows one is an output of the step on both sides of the latch, and the others are on one side of it."""
    law = chain.block(8, "_held", "_computed")
    positions = [Signal(s.name.removesuffix("_held"), s.unit, s.low, s.high) for s in law.inputs]
    force = Signal("f1", "N", -20, 20)
    parts = [
        safety.guard(TIME, [safety.GuardedInput(s, 0.0, True) for s in positions], 5),
        law,
        safe_output.block(TIME, [force], safety.Safety(5, {"f1": 0.0}, {"f1": 1e3}, "an example")),
    ]
    whole = compose("whole", parts, inputs=[s.name for s in positions], outputs=["f1", "f8_computed"])
    block = safety.frozen(whole)
    assert emit(block, np.float32).files["whole.c"].count("_output_matrix_times(columns, ") == 1
    assert chain.disagreement(block, emit(block, np.float64)) < DOUBLE


@tools.needs("frama-c", shows="that the loops over a matrix stay inside it, and that a longer one does not")
def test_the_loops_are_proved_and_a_longer_one_is_not() -> None:
    made = emit(chain.guarded(8), np.float32)
    proof = eva.prove(made.files, made.manifest)
    assert (proof.alarms, proof.unproved, proof.proved) == ((), (), proof.claims)
    text = made.files["guarded_8.c"]
    longer = text.replace("times(matrix, 8u, 32u, x, y)", "times(matrix, 9u, 32u, x, y)")
    assert longer != text
    assert eva.prove({**made.files, "guarded_8.c": longer}, made.manifest).alarms
