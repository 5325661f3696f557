"""Programs in lanes: the bits of the emitted C, for states and inputs of every kind."""

import ctypes
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

from benchmarks import chain
from designs.maglev_5dof import design as maglev
from designs.planar_6dof_leadlag import design as leadlag
from designs.planar_6dof_lqg import design as lqg
from synth.block import Block, Step, build
from synth.emit import pipeline
from synth.execute import compile as host_compiler
from synth.execute import host
from synth.signals import Signal, signal_names
from synth.simulate.lanes import lane_blocks, lane_code
from synth.simulate.lanes.lane_code import Rows
from synth.timing import Discrete
from tests import levitator

pytestmark = pytest.mark.slow

N, LANES = 4000, 8
SPECIAL = np.array([np.nan, np.inf, -np.inf, 0.0, -0.0, 1e30, -1e30, 1e-40])
RUN = """#include <math.h>
#include <stdint.h>
#define LANES 8
{functions}
void run(long n, {v} *x, {u} *counters, const {v} *in, const {number} *constants, {v} *out, {u} *faults) {{
    for (long k = 0; k < n; k++)
        step(x + k * {reals}, counters + k * {whole}, in + k * {inputs}, constants, out + k * {outputs}, faults + k);
}}
"""
LOOPS = {
    "maglev": maglev.DESIGN,
    "leadlag": leadlag.DESIGN,
    "lqg": lqg.DESIGN,
    "levitator": levitator.design().DESIGN,
}


def align(values: np.ndarray) -> np.ndarray:
    memory = np.zeros(values.nbytes + 64, np.uint8)
    start = -memory.ctypes.data % 64
    copy = memory[start : start + values.nbytes].view(values.dtype).reshape(values.shape)
    copy[...] = values
    return copy


def columns(block: Block, scalar: type, rng: np.random.Generator) -> tuple[dict, dict]:
    """Return inputs and states (N,) by name: inside their ranges, at their ends, and inputs that are no numbers."""

    def draw(low: float, high: float) -> np.ndarray:
        ends = rng.choice([low, high, min(max(0.0, low), high)], N)
        return np.where(rng.uniform(size=N) < 0.2, ends, rng.uniform(low, high, N))

    inputs = {s.name: draw(s.low, s.high) for s in block.inputs}
    for name, column in inputs.items():
        special = rng.uniform(size=N) < 0.03
        inputs[name] = np.where(special, rng.choice(SPECIAL, N), column).astype(scalar)
    states = {
        s.name: (np.rint(draw(s.signal.low, s.signal.high)) if s.integer else draw(s.signal.low, s.signal.high))
        for s in block.states
    }
    return inputs, states


def in_lanes(rows: list[np.ndarray], kind: type) -> np.ndarray:
    """Return rows (signals, N) as (N / LANES, signals, LANES)."""
    table = np.array(rows).reshape(-1, N).astype(kind)
    return align(np.ascontiguousarray(table.reshape(len(table), N // LANES, LANES).transpose(1, 0, 2)))


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
@pytest.mark.parametrize("name", LOOPS)
def test_bits_are_those_of_the_c(name: str, scalar: type) -> None:
    stage = LOOPS[name]
    block = stage.controller.block
    inputs, states = columns(block, scalar, np.random.default_rng(7))
    assert require_same_bits(block, scalar, stage.surrogate_error.get(scalar), inputs, states) > 3


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_functions_of_two_arguments_have_the_bits_of_the_c(scalar: type) -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        a, b = u["a"], u["b"]
        return Step({"y": ca.fmod(a, b) + ca.remainder(a, b) + ca.atan2(a, b) + ca.floor(a) + ca.expm1(a / (b + 9))})

    a, b = Signal("a", "1", -9, 9), Signal("b", "1", 0.5, 4)
    block = build("two", Discrete(1e-3), law, inputs=[a, b], outputs=[Signal("y", "1", -99, 99)])
    rng = np.random.default_rng(8)
    inputs = {s.name: rng.uniform(s.low, s.high, N).astype(scalar) for s in (a, b)}
    require_same_bits(block, scalar, None, inputs, {})


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_products_with_matrices_have_the_bits_of_the_c(scalar: type) -> None:
    inputs, states = columns(chain.guarded(8), scalar, np.random.default_rng(9))
    assert require_same_bits(chain.guarded(8), scalar, None, inputs, states) > 3


def require_same_bits(block: Block, scalar: type, error: float | None, inputs: dict, states: dict) -> int:
    """Compare lanes with the C from states and inputs (N,) by name; return the number of different fault words."""
    loaded = host.compile_block(block, scalar, error=error)
    records = np.repeat(loaded.init()[np.newaxis], N)
    for s, column in states.items():
        records[s] = column
    truth = loaded.batch(records, inputs)
    reduced = pipeline.reduce(block.rounded(scalar), scalar, error=error)
    reals, counters = ([s.name for s in block.states if s.integer == whole] for whole in (False, True))
    rows = Rows(signal_names(block.inputs), reals, counters, (), signal_names(block.outputs))
    v, u, _ = lane_code.TYPES[scalar]
    width = np.uint32 if scalar is np.float32 else np.uint64
    constants = {c.name: c.value for c in reduced.block.constants}
    rows = replace(rows, constants=tuple(constants))
    functions = [
        lane_code.SUPPORT,
        lane_code.mathematics([(reduced.program, scalar)]),
        lane_code.step("step", reduced.program, rows, scalar),
    ]
    sizes = {"reals": len(reals), "whole": len(counters), "inputs": len(rows.inputs), "outputs": len(rows.outputs)}
    text = RUN.format(functions="\n".join(functions), v=v, u=u, number=lane_code.NUMBERS[scalar], **sizes)
    library = ctypes.CDLL(str(host_compiler.shared_library({"run.c": text}, lane_blocks.FLAGS)))
    x = in_lanes([records[n] for n in reals], scalar)
    c = in_lanes([records[n] for n in counters], width)
    z = in_lanes([inputs[n] for n in rows.inputs], scalar)
    y = in_lanes([np.zeros(N)] * len(rows.outputs), scalar)
    faults = align(np.zeros((N // LANES, LANES), width))
    numbers = np.array(list(constants.values()), scalar)
    arguments = [array.ctypes.data_as(ctypes.c_void_p) for array in (x, c, z, numbers, y, faults)]
    library.run(ctypes.c_long(N // LANES), *arguments)

    def row(table: np.ndarray, k: int) -> np.ndarray:
        return np.ascontiguousarray(table[:, k, :]).ravel()

    assert np.array_equal(faults.ravel(), truth.faults)
    for k, output in enumerate(rows.outputs):
        assert row(y, k).tobytes() == truth.outputs[output].tobytes(), output
    for table, names in ((x, reals), (c, counters)):
        for k, state in enumerate(names):
            assert np.array_equal(row(table, k), truth.states[state], equal_nan=True), state
    return len(np.unique(truth.faults))
