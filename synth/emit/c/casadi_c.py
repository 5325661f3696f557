"""CasADi's C code generator (`CodeGenerator`), in double: an oracle for the emitted C, and plant code in simulations.

Each function becomes `int name(const double **arg, double **res, long long *iw, double *w, int mem)`. Arguments and
results hold the nonzeros of CasADi's sparse matrices, column by column.
"""

import re
from collections.abc import Sequence

import casadi as ca

from synth.errors import EmitError


def functions(functions: Sequence[ca.Function], name: str) -> dict[str, str]:
    """Return `{name.c: text}` that exports every function under its own name.

    Raises EmitError when there is no function, when two share a name, or when `name` is not an identifier of C.
    """
    names = [f.name() for f in functions]
    if not re.fullmatch(r"[A-Za-z]\w*", name):
        raise EmitError(f"C file: found the name {name!r}, need an identifier; use letters, digits and underscores")
    if not names or len(set(names)) < len(names):
        raise EmitError(
            f"CasADi functions of '{name}': found {names}, need at least one and no name twice; rename them"
        )
    generator = ca.CodeGenerator(name, {"with_header": False})
    for f in functions:
        generator.add(f)
    return {f"{name}.c": generator.dump()}
