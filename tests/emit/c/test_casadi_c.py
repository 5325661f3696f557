"""CasADi's C, compiled here, must compute what CasADi computes, and behind the header what the emitted C does."""

import ctypes
import importlib
from functools import cache
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.block import Block
from synth.emit import write
from synth.emit.c import c_text, manifest
from synth.emit.write import EmittedCode
from synth.errors import CompileError, EmitError
from synth.execute import compile as host_compiler
from synth.execute import host

pytestmark = pytest.mark.slow

x = ca.SX.sym("x", 2)
TURN = ca.Function("turn", [x], [ca.vertcat(ca.sin(x[0]) * x[1], ca.exp(-x[0]))])
STRETCH = ca.Function("stretch", [x], [3 * x])


def call(files: dict[str, str], name: str, values: list[float]) -> list[float]:
    double_p = ctypes.POINTER(ctypes.c_double)
    inputs, result = (ctypes.c_double * 2)(*values), (ctypes.c_double * 2)()
    function = getattr(ctypes.CDLL(str(host_compiler.shared_library(files))), name)
    status = function(
        (double_p * 1)(ctypes.cast(inputs, double_p)),
        (double_p * 1)(ctypes.cast(result, double_p)),
        (ctypes.c_longlong * 1)(),
        (ctypes.c_double * 8)(),
        0,
    )
    assert status == 0
    return list(result)


@pytest.mark.parametrize("f", [TURN, STRETCH])
def test_compiled_functions_compute_what_casadi_does(f: ca.Function) -> None:
    files = c_text.functions([TURN, STRETCH], "pair")
    assert list(files) == ["pair.c"]
    assert call(files, f.name(), [0.3, -2.0]) == pytest.approx(np.array(f([0.3, -2.0])).ravel().tolist(), rel=1e-15)


def test_a_planted_sign_error_is_detected() -> None:
    text = c_text.functions([TURN], "pair")["pair.c"].replace("(-a", "(a")
    assert call({"pair.c": text}, "turn", [0.3, -2.0])[1] != pytest.approx(np.exp(-0.3), rel=0.1)


def test_the_text_is_the_same_every_time() -> None:
    assert c_text.functions([TURN, STRETCH], "pair") == c_text.functions([TURN, STRETCH], "pair")


@pytest.mark.parametrize(
    ("functions", "name", "says"),
    [
        ([], "pair", "at least one"),
        ([TURN, TURN], "pair", "no name twice"),
        ([TURN], "my pair", "identifier"),
        ([TURN], "1st", "identifier"),
    ],
)
def test_names_that_are_not_c_identifiers_are_refused(functions: list[ca.Function], name: str, says: str) -> None:
    with pytest.raises(EmitError, match=says):
        c_text.functions(functions, name)


# Of an output's range over 1,000 steps: rounding in double; rounding and polynomials in single precision.
LIMITS = {np.float64: 1e-13, np.float32: 1e-5}


@cache
def both(name: str, scalar: type[np.floating]) -> tuple[Block, EmittedCode, EmittedCode]:
    """Return the Block of a design, its emitted C and that of CasADi."""
    stage = importlib.import_module(f"designs.{name}.design").DESIGN
    block, error = stage.controller.block, stage.surrogate_error.get(scalar)
    emitted = write.emit(block, scalar, error=error)
    return block, emitted, write.with_casadi_c(emitted, block, error)


def largest_difference(block: Block, first: EmittedCode, second: EmittedCode) -> float:
    """Return the largest difference of an output over the test vectors, of its range; infinite for other faults."""
    vectors = manifest.inputs((Path("generated_c") / block.name / "vectors.json").read_text())
    one, two = (host.load(code.files, code.manifest).replay(vectors) for code in (first, second))
    if (one.faults != two.faults).any() or not one.faults.any():
        return np.inf
    ranges = {s.name: s.high - s.low for s in block.outputs}
    return max(float(np.max(np.abs(one.outputs[n].astype(float) - two.outputs[n]))) / ranges[n] for n in ranges)


@pytest.mark.parametrize("scalar", [np.float64, np.float32])
@pytest.mark.parametrize("name", ["levitator_2dof", "maglev_5dof", "planar_6dof_leadlag", "hall_position"])
def test_casadis_c_behind_the_header_repeats_the_test_vectors(name: str, scalar: Any) -> None:
    block, emitted, by_casadi = both(name, scalar)
    assert by_casadi.files[f"{name}.h"] == emitted.files[f"{name}.h"]
    assert largest_difference(block, emitted, by_casadi) <= LIMITS[scalar]


@pytest.mark.parametrize(
    ("old", "new"),
    [("out->i1 = y[0]", "out->i1 = y[1]"), ("0x00000001u", "0x00000002u"), ("state->servo_z.q1 = next", "next")],
)
def test_a_defect_planted_in_it_is_seen(old: str, new: str) -> None:
    block, emitted, by_casadi = both("levitator_2dof", np.float64)
    assert by_casadi.files["levitator_2dof.c"].count(old) == 1
    if new == "next":  # a state that is not stored
        old = next(row for row in by_casadi.files["levitator_2dof.c"].splitlines() if old in row)
        new = ""
    text = by_casadi.files["levitator_2dof.c"].replace(old, new)
    wrong = EmittedCode({**by_casadi.files, "levitator_2dof.c": text}, by_casadi.manifest)
    assert largest_difference(block, emitted, wrong) > LIMITS[np.float32]


def test_options_that_it_has_not_are_refused_by_the_compiler() -> None:
    _, _, by_casadi = both("levitator_2dof", np.float64)
    with pytest.raises(CompileError, match="has no diagnostics"):
        host_compiler.shared_library(by_casadi.files, ["-DLEVITATOR_2DOF_DIAGNOSTICS"])
    with pytest.raises(CompileError, match="remove the tests for NaN"):
        host_compiler.shared_library(by_casadi.files, ["-ffast-math"])
    assert by_casadi.manifest["surrogates"] == [] and by_casadi.manifest["trace"] == {}
