"""The computed layout is that of NumPy's aligned records, without padding; a compiler's view is tested with the C."""

from itertools import product

import numpy as np
import pytest

from synth.block import Block, State, Step, build
from synth.emit.program.layout import Layout, Struct, layout
from synth.errors import EmitError
from synth.signals import Signal
from synth.timing import Discrete

TYPES = {"float": np.float32, "double": np.float64, "uint32_t": np.uint32}


def make(inputs: int, outputs: int, reals: int, integers: int, high: float = 0.1) -> Block:
    def signals(letter: str, count: int) -> list[Signal]:
        return [Signal(f"{letter}{i}", "m", 0, high, "a length") for i in range(count)]

    # Integers first, so that the layout has something to put in order.
    states = [State(s, 0, True) for s in signals("n", integers)] + [State(s, 0) for s in signals("r", reals)]
    return build(
        "box",
        Discrete(1e-3),
        lambda u, x, k: Step(dict.fromkeys((f"y{i}" for i in range(outputs)), 0), x),
        inputs=signals("u", inputs),
        outputs=signals("y", outputs),
        states=states,
    )


def aligned_dtype(struct: Struct) -> np.dtype:
    """Return NumPy's aligned record of the struct, which has the layout of a C compiler."""
    return np.dtype([(f.name, TYPES[f.ctype]) for f in struct.fields], align=True)


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
@pytest.mark.parametrize(("reals", "integers"), list(product([0, 1, 2], [0, 1, 2, 3])))
def test_members_lie_without_padding(scalar: type[np.floating], reals: int, integers: int) -> None:
    memory = layout(make(3, 1, reals, integers), scalar)
    for struct in memory.structs:
        dtype = aligned_dtype(struct)
        assert [f.offset for f in struct.fields] == [dtype.fields[f.name][1] for f in struct.fields]
        assert struct.size == dtype.itemsize == sum(np.dtype(TYPES[f.ctype]).itemsize for f in struct.fields)
    names = [f.name for f in memory.state.fields]
    expected = [f"r{i}" for i in range(reals)] + [f"n{i}" for i in range(integers)]
    assert names[: len(expected)] == expected if scalar is np.float64 else set(expected) <= set(names)
    filled = scalar is np.float64 and reals > 0 and integers % 2 == 1
    assert names[len(expected) :] == (["reserved"] if filled or not expected else [])


def test_the_oracle_detects_padding() -> None:
    padded = aligned_dtype(Struct("state", "t", 0, tuple(reversed(layout(make(1, 1, 1, 2), np.float64).state.fields))))
    assert aligned_dtype(layout(make(1, 1, 1, 2), np.float64).state).itemsize == padded.itemsize == 16
    odd = [("n", np.uint32), ("r", np.float64), ("m", np.uint32)]
    assert np.dtype(odd, align=True).itemsize == 24


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_bounds_are_rounded_to_the_scalar_type(scalar: type[np.floating]) -> None:
    memory: Layout = layout(make(1, 1, 1, 0), scalar)
    assert [s.fields[0].high for s in memory.structs] == [float(scalar(0.1))] * 3
    assert memory.input.fields[0].comment() == "m, 0 .. 0.1: a length"
    assert (memory.ctype, memory.input.type) == ("float" if scalar is np.float32 else "double", "box_input_t")


@pytest.mark.parametrize(
    ("block", "scalar", "text"),
    [
        (make(1, 1, 1, 0), np.float16, r"float16.* choose numpy\.float32 or numpy\.float64"),
        (make(0, 1, 1, 0), np.float32, "'box' has no input"),
        (make(1, 0, 1, 0), np.float32, "'box' has no output"),
        (make(1, 1, 1, 0, 1e39), np.float32, r"signal 'u0' has the bound 1e\+39, too large for float"),
    ],
)
def test_blocks_without_a_layout_are_refused(block: Block, scalar: type[np.floating], text: str) -> None:
    with pytest.raises(EmitError, match=text):
        layout(block, scalar)
