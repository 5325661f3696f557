"""The same step from several code generators, each made ready to be called on an emulated core.

    synth             faults = step(state, in, out), the emitted C; the state is advanced in place
    casadi            (x, u) -> (x', y) by CasADi's CodeGenerator with casadi_real=float, after ca.cse, as emitted
    casadi, float     that text with a float shim: sin becomes sinf, .., every double literal a float one

CasADi's `casadi_real=float` declares floats, but its text still calls the double functions of libm and holds double
literals. The shim works on the text, so that it serves every compiler (-fsingle-precision-constant is gcc's alone):
literals get the suffix f, and macros behind `#include <math.h>` rename the functions. fmin and fmax become
comparisons, as CasADi itself prints them for compilers before C99, since a call of fminf would cost more.
CasADi's function knows no fault word, and it may not work in place: its state counts twice, x and x'.
"""

import importlib.util
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from synth.block import Block
from synth.emit.write import Emitted
from synth.errors import EmitError
from synth.execute import host
from synth.execute.image import Image
from synth.verify.cost import SYNTH
from synth.verify.steps import Steps

AS_EMITTED, SHIMMED = "casadi", "casadi, float"
# Generators that were compared once and are not among the pinned packages; nothing here drives them.
OTHERS = ("symforce", "archimedes")
_LITERAL = re.compile(r"(?<![\w.])(\d+\.\d*(?:[eE][+-]?\d+)?|\d+[eE][+-]?\d+)(?![\w.])")
_WORK = re.compile(r"if \(sz_w\) \*sz_w = (\d+);")  # floats that the caller lends besides
_FUNCTIONS = (
    *("sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh"),
    *("exp", "log", "expm1", "log1p", "pow", "sqrt", "hypot", "floor", "ceil", "fmod", "copysign", "erf"),
)
_SHIM = """#include <math.h>
static inline float synth_fmin(float x, float y) { return x < y ? x : y; }
static inline float synth_fmax(float x, float y) { return x > y ? x : y; }
#define fmin synth_fmin
#define fmax synth_fmax
#define fabs fabsf
"""
_SHIM += "".join(f"#define {name} {name}f\n" for name in _FUNCTIONS)


class CallLayout(NamedTuple):
    """N calls laid out in a core's memory: their arguments (N, n), and what reads the outputs (N,) after them."""

    arguments: NDArray[np.int64]
    outputs: Callable[[], host.Columns]


@dataclass(frozen=True, eq=False)
class Candidate:
    """One generator's text of a step: `entry` is called with what `placed(image, steps)` lays out.

    `state` and `signals` are the bytes that a caller keeps for the state, and for inputs and outputs.
    """

    name: str
    files: Mapping[str, str]
    entry: str
    state: int
    signals: int
    placed: Callable[[Image, Steps], CallLayout]


def emitted(code: Emitted) -> Candidate:
    """Return the emitted C itself."""
    manifest = code.manifest
    output_struct = host.dtype("output", manifest)
    state_size, input_size, output_size = (manifest["structs"][role]["size"] for role in ("state", "input", "output"))

    def placed(image: Image, steps: Steps) -> CallLayout:
        n = len(steps)
        at = image.reserve(n * output_struct.itemsize)
        columns = (image.place(steps.states), state_size), (image.place(steps.inputs), input_size), (at, output_size)
        return CallLayout(_rows(n, *columns), lambda: host.columns(_read_array(image, at, n, output_struct)))

    return Candidate(
        SYNTH, host.code(code.files), manifest["functions"]["step"], state_size, input_size + output_size, placed
    )


def casadi(block: Block, shimmed: bool) -> Candidate:
    """Return CasADi's C of a Block with casadi_real=float, as emitted or with the float shim.

    Raises EmitError when the shim finds no place in the text.
    """
    # As shipped: constants rounded once, so that all generators compute with the same numbers.
    f = _function(block.rounded(np.float32))
    generator = ca.CodeGenerator(f.name(), {"with_header": False, "casadi_real": "float"})
    generator.add(f)
    text = generator.dump()
    n_x, n_u, n_y = (len(signals) for signals in (block.states, block.inputs, block.outputs))
    work = sum(map(int, _WORK.findall(text)))
    return Candidate(
        SHIMMED if shimmed else AS_EMITTED,
        {f"{f.name()}.c": in_single_precision(text) if shimmed else text},
        f.name(),
        4 * (2 * n_x + work),
        4 * (n_u + n_y),
        lambda image, steps: _lay_out_casadi(block, f, image, steps),
    )


def in_single_precision(text: str) -> str:
    """Return CasADi's text with float literals and libm's float functions.

    Raises EmitError when it includes no <math.h>, behind which the macros go.
    """
    if "#include <math.h>\n" not in text:
        raise EmitError(
            "CasADi's C: found no `#include <math.h>`, need it to put the float shim behind: adapt the shim"
        )
    return _LITERAL.sub(r"\1f", text).replace("#include <math.h>\n", _SHIM, 1)


def not_measured() -> tuple[str, ...]:
    """Say of the other generators that are known why they are not measured."""
    installed = {name: importlib.util.find_spec(name) is not None for name in OTHERS}
    reasons = {True: "installed, but nothing here drives it", False: "not installed"}
    return tuple(f"{name}: {reasons[is_installed]}; not measured" for name, is_installed in installed.items())


def _function(block: Block) -> ca.Function:
    f = block.function()
    x, u = f.sx_in()
    results = ca.cse([ca.densify(e) for e in f.call([x, u])])
    return ca.Function(f"{block.name}_casadi", [x, u], results, ["x", "u"], ["x_next", "y"])


def _lay_out_casadi(block: Block, f: ca.Function, image: Image, steps: Steps) -> CallLayout:
    """Lay out `int f(const float **arg, float **res, casadi_int *iw, float *w, int mem)`."""
    n = len(steps)
    n_x, n_y = len(block.states), len(block.outputs)
    x = image.place(_vectors(steps.states, [s.name for s in block.states]))
    u = image.place(_vectors(steps.inputs, [s.name for s in block.inputs]))
    after, y = image.reserve(4 * n * n_x), image.reserve(4 * n * n_y)
    arg = _pointers(image, n, f.sz_arg(), (x, 4 * n_x), (u, 4 * len(block.inputs)))
    res = _pointers(image, n, f.sz_res(), (after, 4 * n_x), (y, 4 * n_y))
    scratch = (image.reserve(8 * f.sz_iw()), 0), (image.reserve(4 * f.sz_w()), 0), (0, 0)

    def outputs() -> host.Columns:
        values = _read_array(image, y, n * n_y, np.dtype(np.float32)).reshape(n, n_y)
        return {s.name: values[:, k] for k, s in enumerate(block.outputs)}

    return CallLayout(_rows(n, arg, res, *scratch), outputs)


def _vectors(records: host.Records, names: list[str]) -> NDArray[np.float32]:
    return np.stack([records[name].astype(np.float32) for name in names], axis=1)


def _pointers(image: Image, n: int, size: int, *arrays: tuple[int, int]) -> tuple[int, int]:
    """Place n tables of pointers, `size` each, to the k-th rows of arrays (address, bytes a row)."""
    table = np.zeros((n, size), np.uint32)
    for column, (address, stride) in enumerate(arrays):
        table[:, column] = address + stride * np.arange(n)
    return image.place(table), 4 * size


def _rows(n: int, *columns: tuple[int, int]) -> NDArray[np.int64]:
    """Return arguments (n, .): for each column the address of its first element and the bytes to the next."""
    k = np.arange(n, dtype=np.int64)
    return np.stack([address + stride * k for address, stride in columns], axis=1)


def _read_array(image: Image, address: int, n: int, dtype: np.dtype[Any]) -> NDArray[Any]:
    return np.frombuffer(image.read(address, n * dtype.itemsize), dtype)
