"""Code generation for the plant: its functions by CasADi's code generator, compiled with closed_loop.c."""

import ctypes
from collections.abc import Callable, Sequence
from importlib import resources

import casadi as ca

from synth.emit.c import casadi_c
from synth.errors import WiringError
from synth.execute import compile as host_compiler
from synth.plant import Plant

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
    """Compile closed_loop.c with the plant and return `synth_closed_loop`, which takes a pointer to a `loop_t`."""
    functions = [_with_dense_results(plant.f, "synth_plant_f"), _with_dense_results(plant.h, "synth_plant_h")]
    if disturbance is not None:
        n = len(plant.states)
        shapes = [*map(disturbance.size_in, range(disturbance.n_in())), disturbance.size_out(0)]
        if shapes != [(n, 1), (1, 1), (n, 1)]:
            raise WiringError(f"disturbance has arguments and result of {shapes}: need (x, t) of {(n, 1)}, (1, 1)")
        functions.append(_with_dense_results(disturbance, "synth_plant_disturbance"))
    loop_c = resources.files("synth.simulate").joinpath("closed_loop.c").read_text(encoding="utf-8")
    sources = {"closed_loop.c": loop_c, "plant.h": _header(plant, functions), **casadi_c.functions(functions, "plant")}
    library = ctypes.CDLL(str(host_compiler.shared_library(sources, flags)))
    return ctypes.CFUNCTYPE(None, ctypes.c_void_p)(("synth_closed_loop", library))


def _with_dense_results(f: ca.Function, name: str) -> ca.Function:
    """Return the function under another name with dense results: structural zeros are stored too."""
    arguments = f.sx_in()
    return ca.Function(name, arguments, ca.cse([ca.densify(result) for result in f.call(arguments)]))


def _header(plant: Plant, functions: Sequence[ca.Function]) -> str:
    signature = "(const double **arg, double **res, long long *iw, double *w, int mem);"
    return HEADER.format(
        x=len(plant.states),
        u=len(plant.inputs),
        y=len(plant.outputs),
        arg=max(3, *(f.sz_arg() for f in functions)),
        res=max(f.sz_res() for f in functions),
        iw=max(1, *(f.sz_iw() for f in functions)),
        w=max(1, *(f.sz_w() for f in functions)),
        disturbed=int(len(functions) == 3),
        prototypes="\n".join(f"int {f.name()}{signature}" for f in functions),
    )
