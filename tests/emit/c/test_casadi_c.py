"""CasADi's C, compiled here, must compute what CasADi computes."""

import ctypes

import casadi as ca
import numpy as np
import pytest

from synth.emit.c import c_text
from synth.errors import EmitError
from synth.execute import compile as host_compiler

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
