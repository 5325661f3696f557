"""Baselines for the cost of a step: the same step from several C code generators, prepared for an emulated core.

    synth             faults = step(state, in, out), the C that synth emits; it updates the state in place
    casadi            (x, u) -> (x', y) by CasADi's CodeGenerator with casadi_real=float, after ca.cse, unchanged
    casadi, float     the same C with a float shim: sin becomes sinf, .., every double literal becomes a float literal

Time, stack and memory of each are measured over the same steps (`synth.verify.meter`).

With `casadi_real=float` CasADi declares floats, but its C still calls the double functions of libm and contains double
literals. The shim changes the C itself and therefore works with every compiler; -fsingle-precision-constant exists only
in gcc. Literals get the suffix f, and macros after `#include <math.h>` rename the functions. fmin and fmax become
comparisons, as CasADi prints them for compilers before C99, because a call of fminf would cost more.

CasADi's function has no fault word, and its results must not overlap its arguments. Its state memory therefore counts
twice, for x and x'.
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
from synth.emit.write import EmittedCode
from synth.errors import EmitError
from synth.execute import host
from synth.execute.image import Image
from synth.verify.cost import SYNTH
from synth.verify.steps import Steps

CASADI, CASADI_FLOAT = "casadi", "casadi, float"
# Generators of an earlier comparison; they are not among the pinned packages, and no code here runs them.
UNSUPPORTED = ("symforce", "archimedes")
_LITERAL = re.compile(r"(?<![\w.])(\d+\.\d*(?:[eE][+-]?\d+)?|\d+[eE][+-]?\d+)(?![\w.])")
_WORK_SIZE = re.compile(r"if \(sz_w\) \*sz_w = (\d+);")  # number of floats of work memory
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
    """The data of N calls in the memory of a core: the n arguments of each, (N, n), and a function that reads outputs.

    `outputs` returns a column (N,) for each output after the calls.
    """

    arguments: NDArray[np.int64]
    outputs: Callable[[], host.Columns]


@dataclass(frozen=True, eq=False)
class Candidate:
    """The C of one generator; `lay_out(image, steps)` prepares the arguments with which its function `entry` is called.

    A caller keeps `state_bytes` for the state and `signal_bytes` for inputs and outputs.
    """

    name: str
    files: Mapping[str, str]
    entry: str
    state_bytes: int
    signal_bytes: int
    lay_out: Callable[[Image, Steps], CallLayout]


def emitted_c(code: EmittedCode) -> Candidate:
    """Return the C that synth emits as a candidate."""
    manifest = code.manifest
    output_struct = host.dtype("output", manifest)
    state_size, input_size, output_size = (manifest["structs"][role]["size"] for role in ("state", "input", "output"))

    def lay_out(image: Image, steps: Steps) -> CallLayout:
        n = len(steps)
        states, inputs = image.place(steps.states), image.place(steps.inputs)
        outputs = image.reserve(n * output_struct.itemsize)
        pointers = _call_arguments(n, (states, state_size), (inputs, input_size), (outputs, output_size))
        return CallLayout(pointers, lambda: host.columns(_read_array(image, outputs, n, output_struct)))

    return Candidate(
        SYNTH, host.code(code.files), manifest["functions"]["step"], state_size, input_size + output_size, lay_out
    )


def casadi(block: Block, shimmed: bool) -> Candidate:
    """Return CasADi's C of a Block with casadi_real=float, unchanged or with the float shim.

    Raises EmitError when the shim cannot be inserted.
    """
    # Constants are rounded once, as in synth's C: all generators compute with the same numbers.
    f = _casadi_function(block.rounded(np.float32))
    generator = ca.CodeGenerator(f.name(), {"with_header": False, "casadi_real": "float"})
    generator.add(f)
    text = generator.dump()
    n_x, n_u, n_y = (len(signals) for signals in (block.states, block.inputs, block.outputs))
    work = sum(map(int, _WORK_SIZE.findall(text)))
    return Candidate(
        CASADI_FLOAT if shimmed else CASADI,
        {f"{f.name()}.c": with_float_shim(text) if shimmed else text},
        f.name(),
        4 * (2 * n_x + work),
        4 * (n_u + n_y),
        lambda image, steps: _lay_out_casadi(block, f, image, steps),
    )


def with_float_shim(text: str) -> str:
    """Return CasADi's C with float literals and with the float functions of libm.

    Raises EmitError when the C does not include <math.h>: the macros are inserted after that line.
    """
    if "#include <math.h>\n" not in text:
        raise EmitError(
            "CasADi's C: found no `#include <math.h>`, need it to insert the float shim after it: adapt the shim"
        )
    return _LITERAL.sub(r"\1f", text).replace("#include <math.h>\n", _SHIM, 1)


def unmeasured_generators() -> tuple[str, ...]:
    """Return one line for each unsupported generator: its name and why it is not measured."""
    installed = {name: importlib.util.find_spec(name) is not None for name in UNSUPPORTED}
    reasons = {True: "installed, but not supported here", False: "not installed"}
    return tuple(f"{name}: {reasons[is_installed]}; not measured" for name, is_installed in installed.items())


def _casadi_function(block: Block) -> ca.Function:
    f = block.function()
    x, u = f.sx_in()
    results = ca.cse([ca.densify(e) for e in f.call([x, u])])
    return ca.Function(f"{block.name}_casadi", [x, u], results, ["x", "u"], ["x_next", "y"])


def _lay_out_casadi(block: Block, f: ca.Function, image: Image, steps: Steps) -> CallLayout:
    """Prepare calls of `int f(const float **arg, float **res, casadi_int *iw, float *w, int mem)`."""
    n = len(steps)
    n_x, n_y = len(block.states), len(block.outputs)
    x = image.place(_matrix(steps.states, [s.name for s in block.states]))
    u = image.place(_matrix(steps.inputs, [s.name for s in block.inputs]))
    x_next, y = image.reserve(4 * n * n_x), image.reserve(4 * n * n_y)
    arg = _pointers(image, n, f.sz_arg(), (x, 4 * n_x), (u, 4 * len(block.inputs)))
    res = _pointers(image, n, f.sz_res(), (x_next, 4 * n_x), (y, 4 * n_y))
    iw, w, mem = (image.reserve(8 * f.sz_iw()), 0), (image.reserve(4 * f.sz_w()), 0), (0, 0)  # the same in all calls

    def outputs() -> host.Columns:
        values = _read_array(image, y, n * n_y, np.dtype(np.float32)).reshape(n, n_y)
        return {s.name: values[:, k] for k, s in enumerate(block.outputs)}

    return CallLayout(_call_arguments(n, arg, res, iw, w, mem), outputs)


def _matrix(records: host.Records, names: list[str]) -> NDArray[np.float32]:
    return np.stack([records[name].astype(np.float32) for name in names], axis=1)


def _pointers(image: Image, n: int, size: int, *arrays: tuple[int, int]) -> tuple[int, int]:
    """Write n tables of `size` pointers; those of the k-th table point to the k-th rows of arrays (address, row bytes).

    Returns the address of the first table and the bytes from one to the next.
    """
    table = np.zeros((n, size), np.uint32)
    for column, (address, stride) in enumerate(arrays):
        table[:, column] = address + stride * np.arange(n)
    return image.place(table), 4 * size


def _call_arguments(n: int, *arguments: tuple[int, int]) -> NDArray[np.int64]:
    """Return the arguments of n calls, (n, len(arguments)).

    Each argument is given by its value in the first call and its increase from call to call: for a pointer, an address
    and a stride in bytes.
    """
    k = np.arange(n, dtype=np.int64)
    return np.stack([first + increase * k for first, increase in arguments], axis=1)


def _read_array(image: Image, address: int, n: int, dtype: np.dtype[Any]) -> NDArray[Any]:
    return np.frombuffer(image.read(address, n * dtype.itemsize), dtype)
