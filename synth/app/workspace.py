"""Workspaces: a folder with models/ and designs/<name>/design.py, whose `DESIGN` is the declared stage.

The folder goes first on the path of this process. A process serves one workspace only.
"""

import importlib
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

from synth.declare.stage import Stage
from synth.errors import DesignError, SynthError, design_lines


def designs(root: Path, selected: Sequence[str] = ()) -> list[Stage]:
    """Load the `selected` designs of the workspace at `root`, all of them when no name is selected.

    Raises DesignError as `design_names`, and when a design stops at an error, or has no `DESIGN`.
    """
    listed = design_names(root, selected)
    if str(root) not in sys.path:
        sys.path.insert(0, str(root))
    return [_load(name) for name in listed]


def design_names(root: Path, selected: Sequence[str] = ()) -> list[str]:
    """Return the names of the `selected` designs of the workspace at `root`, of all when none is selected.

    Raises DesignError when the folder is not a workspace, or a design is missing.
    """
    folder = root / "designs"
    if not folder.is_dir():
        above = next((str(path) for path in root.parents if (path / "designs").is_dir()), "WORKSPACE")
        raise DesignError(
            f"{root} is not a workspace, it has no folder designs/: run `cd {above}`, or make a workspace here with "
            "`synth new NAME`"
        )
    present = sorted(path.parent.name for path in folder.glob("*/design.py"))
    if not present:
        raise DesignError(
            f"the workspace {root} has no design yet, no designs/NAME/design.py: add one with `synth new NAME`"
        )
    for name in selected:
        if name not in present:
            raise DesignError(f"design '{name}' is not in this workspace: it has {', '.join(present)}")
    return list(selected or present)


def _import(name: str) -> ModuleType:
    """Import the module of a design; raise DesignError, with its line, for what goes wrong in the design's code."""
    try:
        return importlib.import_module(f"designs.{name}.design")
    except SynthError:
        raise
    except Exception as error:
        lines = design_lines(error)
        if isinstance(error, SyntaxError):
            lines.append(f"{error.filename}:{error.lineno}")
        if not lines or not lines[-1]:  # it went wrong in this package
            raise
        raise DesignError(
            f"design '{name}' stops at {lines[-1]}: {type(error).__name__}: {error}; for the traceback run "
            f"`python -m designs.{name}.design`"
        ) from error


def _load(name: str) -> Stage:
    module = _import(name)
    stage = getattr(module, "DESIGN", None)
    if not isinstance(stage, Stage):
        raise DesignError(f"designs/{name}/design.py defines no DESIGN: end it with DESIGN = stage.design(...)")
    if stage.name != name:
        raise DesignError(
            f"DESIGN of designs/{name}/design.py has the name '{stage.name}': give it the name of its folder, '{name}'"
        )
    return stage
