"""Workspaces: a folder with models/ and designs/<name>/design.py, whose `DESIGN` holds the tasks of a design.

The folder goes first on the path of this process. A process serves one workspace only.
"""

import importlib
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.base.progress import Progress
from synth.block import Block
from synth.declare.stage import Stage
from synth.emit.write import EmittedCode
from synth.errors import DesignError, SynthError, design_lines
from synth.execute import host
from synth.report.audit import Row
from synth.simulate.experiment import Experiment
from synth.verify import agree
from synth.verify.evidence import Evidence
from synth.verify.steps import Steps

# Of files, evidence, experiments, audit, cost (or None) and, as `parts`, the results of the design's report parts.
Report = Callable[..., str]


@dataclass(frozen=True)
class CostStimuli:
    """The stimuli with which the machine code of a design is measured.

    `block` is what is emitted under the design's name. `replay` returns inputs (N,) of a closed loop with faults, and
    `sequences` the steps that look for the costliest one and reach every decision; both take the compiled C. Below
    `floor`, one number or one for each output by name, a difference of outputs is absolute; see `agree.floors`.
    `law_alone` emits the law without its fault handling, whose cost is shown beside.
    """

    block: Callable[[], Block]
    replay: Callable[[host.Controller], Mapping[str, NDArray[np.floating]]]
    sequences: Callable[[host.Controller, Progress], Sequence[Steps]]
    floor: agree.Floor = None
    law_alone: Callable[[], EmittedCode] | None = None


def _no_rows() -> Iterator[Row]:
    return iter(())


@dataclass(frozen=True)
class Design:
    """A design and its tasks, which report their progress.

    `emit(scalar)` returns the files of generated_c/<name>/, by folder. `verify` returns evidence, each part of
    `simulate` some of the experiments, `audit` the recomputed published values, if there are any, and `report` the page
    of all these and of the cost, which is None where it could not be measured. What takes long of that page alone is
    computed by `report_parts`. `stage` is the declaration, where there is one.
    """

    name: str
    scalar: type[np.floating]
    emit: Callable[[type[np.floating]], Mapping[str, EmittedCode]]
    verify: Callable[[Progress, bool], Evidence]
    simulate: Mapping[str, Callable[[Progress], Sequence[Experiment]]]
    cost_stimuli: CostStimuli
    report: Report
    audit: Callable[[], Iterator[Row]] = _no_rows
    report_parts: Mapping[str, Callable[[Progress], Any]] = field(default_factory=dict)
    stage: Stage | None = None


def designs(root: Path, selected: Sequence[str] = ()) -> list[Design]:
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


def emitted_files(design: Design, scalar: type[np.floating]) -> Mapping[str, EmittedCode]:
    """Return the emitted files by folder; raise DesignError when no folder has the name of the design."""
    folders = design.emit(scalar)
    if design.name not in folders:
        raise DesignError(
            f"design '{design.name}' emits {', '.join(folders) or 'nothing'}, but not '{design.name}': give DESIGN the "
            "name of the Block that it emits"
        )
    return folders


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


def _load(name: str) -> Design:
    module = _import(name)
    design = getattr(module, "DESIGN", None)
    if not isinstance(design, Design):
        raise DesignError(f"designs/{name}/design.py defines no DESIGN: end it with DESIGN = workspace.Design(...)")
    if design.name != name:
        raise DesignError(
            f"DESIGN of designs/{name}/design.py has the name '{design.name}': give it the name of its folder, '{name}'"
        )
    return design
