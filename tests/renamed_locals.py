"""Emission of a design whose laws have other local variables: writes the C of each of its Blocks as JSON.

    python -m tests.renamed_locals DESIGN

Each function of toolkit, models and designs is compiled with `_renamed` behind the name of each local. Names of
arguments, which are part of a call, remain.
"""

import json
import sys
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType

ROOT = Path(__file__).parents[1]
LAWS = tuple(f"{ROOT / folder}/" for folder in ("synth/blocks", "synth/synthesise", "models", "designs"))


def renamed(code: CodeType) -> CodeType:
    """Return the code with other names of its locals, and of those of the functions in it."""
    arguments = code.co_varnames[: code.co_argcount + code.co_kwonlyargcount + (code.co_flags & 4 > 0)]
    arguments += code.co_varnames[len(arguments) :][: code.co_flags & 8 > 0]
    kept = {*arguments, "__class__"}
    varnames, cells, free = (
        tuple(n if n in kept or n.startswith(".") else f"{n}_renamed" for n in names)
        for names in (code.co_varnames, code.co_cellvars, code.co_freevars)
    )
    constants = tuple(renamed(c) if isinstance(c, CodeType) else c for c in code.co_consts)
    return code.replace(co_varnames=varnames, co_cellvars=cells, co_freevars=free, co_consts=constants)


def emit(name: str) -> dict[str, str]:
    """Return the C of the controller and the companions of a design, by name."""
    get_code = SourceFileLoader.get_code

    def get_renamed(loader: SourceFileLoader, fullname: str) -> CodeType | None:
        if not loader.path.startswith(LAWS):
            return get_code(loader, fullname)
        return renamed(compile(Path(loader.path).read_bytes(), loader.path, "exec", dont_inherit=True))

    SourceFileLoader.get_code = get_renamed  # type: ignore[method-assign]
    import numpy as np

    from synth.app import standard_tasks, workspace

    design = next(d for d in workspace.designs(ROOT) if d.name == name)
    return {n: code.files[f"{n}.c"] for n, code in standard_tasks.emit(design, np.float32).items()}


if __name__ == "__main__":
    sys.stdout.write(json.dumps(emit(sys.argv[1])))
