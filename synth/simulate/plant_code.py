"""Code generation for the plant: its functions by CasADi's code generator, compiled with closed_loop.c."""

import ctypes
import os
from collections.abc import Callable, Sequence
from functools import lru_cache
from importlib import resources

import casadi as ca

from synth.base import store
from synth.emit.c import c_text
from synth.errors import WiringError
from synth.execute import compile as host_compiler
from synth.plant import Plant

# Read with this module: the members of `loop_t` are those that `closed_loop` knows, whatever is edited during a run.
_LOOP_C = resources.files("synth.simulate").joinpath("closed_loop.c").read_text(encoding="utf-8")
HEADER = """#define N_X {x}
#define N_U {u}
#define N_Y {y}
#define SIZE_ARG {arg}
#define SIZE_RES {res}
#define SIZE_IW {iw}
#define SIZE_W {w}
#define HAS_DISTURBANCE {disturbed}
{prototypes}
"""


def compile_loop(plant: Plant, disturbance: ca.Function | None, flags: Sequence[str]) -> Callable[..., None]:
    """Compile closed_loop.c with the plant and return `synth_closed_loop`, which takes a pointer to a `loop_t`.

    The result is kept for further runs of the same functions, since a campaign runs one plant a thousand times.
    """
    return _compile(plant.f, plant.h, disturbance, tuple(flags), _surroundings())


def _surroundings() -> tuple[str, ...]:
    """Return what else decides which library is loaded: the compiler, the cache, and the name of a fresh run."""
    return os.environ.get("CC", ""), str(store.folder()), store.run_name()


@lru_cache(maxsize=16)
def _compile(
    f: ca.Function, h: ca.Function, disturbance: ca.Function | None, flags: tuple[str, ...], _: tuple[str, ...]
) -> Callable[..., None]:
    functions = [_with_dense_results(f, "synth_plant_f"), _with_dense_results(h, "synth_plant_h")]
    if disturbance is not None:
        n = f.size1_in(0)
        shapes = [*map(disturbance.size_in, range(disturbance.n_in())), disturbance.size_out(0)]
        if shapes != [(n, 1), (1, 1), (n, 1)]:
            raise WiringError(f"disturbance has arguments and result of {shapes}: need (x, t) of {(n, 1)}, (1, 1)")
        functions.append(_with_dense_results(disturbance, "synth_plant_disturbance"))
    sources = {"closed_loop.c": _LOOP_C, "plant.h": _header(functions), **c_text.functions(functions, "plant")}
    library = ctypes.CDLL(str(host_compiler.shared_library(sources, flags)))
    return ctypes.CFUNCTYPE(None, ctypes.c_void_p)(("synth_closed_loop", library))


def _with_dense_results(f: ca.Function, name: str) -> ca.Function:
    """Return the function under another name with dense results: structural zeros are stored too."""
    arguments = f.sx_in()
    return ca.Function(name, arguments, ca.cse([ca.densify(result) for result in f.call(arguments)]))


def _header(functions: Sequence[ca.Function]) -> str:
    signature = "(const double **arg, double **res, long long *iw, double *w, int mem);"
    return HEADER.format(
        x=functions[0].size1_in(0),
        u=functions[0].size1_in(1),
        y=functions[1].size1_out(0),
        arg=max(3, *(f.sz_arg() for f in functions)),
        res=max(f.sz_res() for f in functions),
        iw=max(1, *(f.sz_iw() for f in functions)),
        w=max(1, *(f.sz_w() for f in functions)),
        disturbed=int(len(functions) == 3),
        prototypes="\n".join(f"int {f.name()}{signature}" for f in functions),
    )
