"""Imports follow the flow of data: synth <- models <- designs <- studies; a stratum of synth sees only those before it.

Models see the strata of synth up to its Blocks: they are expressions, and neither emitted nor run.

An import from stratum a to stratum b is allowed when rank(b) <= rank(a). Among the folders of designs/, those with a
design.py are designs, the others are shared packages: no folder imports a design that it does not belong to, and no
imports lead around a cycle of folders.
"""

import ast
import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
STRATA = (  # of synth, the lowest first; each imports only itself and those before it
    "base", "declare", "analyse", "synthesise", "blocks", "stage", "emit", "execute", "simulate", "verify", "report",
    "export", "app", "testing",
)  # fmt: skip
VOCABULARY = (  # modules at the top of synth, below all strata but `base`, which needs their errors alone
    "errors", "kinds", "arguments", "numeric", "check", "show", "signals", "timing", "law", "plant",
    "resolvent", "statespace", "fault", "block", "composition",
)  # fmt: skip
RANK = {("synth", "errors"): -1, ("synth", "base"): -1}
RANK |= {("synth", name): 0 for name in (*VOCABULARY[1:], "reference")}
RANK |= {("synth", name): rank for rank, name in enumerate(STRATA[1:], 1)}
RANK |= {(name,): len(STRATA) + rank for rank, name in enumerate(("models", "designs", "studies"), 1)}
PHYSICS = RANK["synth", "blocks"]  # of synth, models see only what makes expressions and Blocks, no emission or runs
ASSEMBLED = ("design.py", "__main__.py")
LONGEST = 500  # lines of a module: a file is a subject
NOT_IN_A_REFERENCE = {"casadi", "synth", "models", "designs", "studies", "importlib"}
REFERENCES = ("synth", "reference")  # of the toolkit's Blocks: NumPy and mpmath alone


@cache
def imports(path: Path, text: str) -> tuple[tuple[str, ...], ...]:
    """Return every module that a file may load, as its dotted parts; `from a import b` may load a.b."""
    return tuple(_imports(path.parent.parts, text))


def _imports(package: tuple[str, ...], text: str) -> Iterator[tuple[str, ...]]:
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from (tuple(alias.name.split(".")) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else ()
            module = (*base, *(node.module or "").split(".")) if node.module else base
            yield from ((*module, alias.name) for alias in node.names)


def rank(module: tuple[str, ...]) -> int | None:
    """Return a module's place in the order, None outside the four packages; a name of synth itself ranks 0."""
    return RANK.get(module[:2], 0) if module[0] == "synth" else RANK.get(module[:1])


def violations(path: Path, text: str) -> list[str]:
    name = path.with_suffix("").parts
    if name[0] == "synth" and name[1] != "__init__" and name[:2] not in RANK:
        return [f"{path} has no place in the order; add {name[1]} to VOCABULARY or STRATA"]
    importer = rank(name)
    reference = (path.name.startswith("reference") and "designs" in path.parts[:2]) or name[:2] == REFERENCES
    messages = []
    for module in imports(path, text):
        other = rank(module)
        independent = module[:1] == ("designs",) and any(part.startswith("reference") for part in module[2:])
        independent = independent or module[:2] == REFERENCES
        if name[0] == "models" and module[0] == "synth" and (other or 0) > PHYSICS:
            messages.append(f"{path} imports {'.'.join(module)}, which is no physics")
        if not reference and module[:2] == REFERENCES:
            messages.append(f"{path} imports {'.'.join(module)}, which judges it")
        if (reference and module[0] in NOT_IN_A_REFERENCE and not independent) or (
            importer is not None and other is not None and other > importer
        ):
            messages.append(f"{path} imports {'.'.join(module)}")
    return messages


def folder(module: tuple[str, ...], folders: Iterable[tuple[str, ...]]) -> tuple[str, ...]:
    """Return the deepest of some folders that a module lies in, () for none."""
    return max((f for f in folders if module[: len(f)] == f), key=len, default=())


def place(path: Path) -> tuple[str, ...]:
    """Return the folder that a file belongs to; what puts the folders of a design together stands by itself."""
    return path.with_suffix("").parts if path.name in ASSEMBLED else path.parent.parts


def folder_imports(texts: Mapping[Path, str]) -> dict[tuple[str, ...], set[tuple[str, ...]]]:
    """Return which other folders of designs/ each folder imports, from the text of every file."""
    files = {path: text for path, text in texts.items() if path.parts[0] == "designs"}
    targets: dict[tuple[str, ...], set[tuple[str, ...]]] = {place(path): set() for path in files}
    for path, text in files.items():
        targets[place(path)] |= {folder(module, targets) for module in imports(path, text)} - {place(path), ()}
    return targets


def folder_violations(texts: Mapping[Path, str]) -> list[str]:
    """Return what is wrong with the imports among the folders of designs/: one of a design, or a cycle."""
    by_folder = folder_imports(texts)
    designs = {path.parent.parts for path in texts if path.name == "design.py"}
    messages = [
        f"{'/'.join(one[:2])} imports the design {'/'.join(other[:2])}"
        for one, others in by_folder.items()
        for other in others
        if other[:2] in designs and one[:2] != other[:2]
    ]
    try:
        TopologicalSorter(by_folder).prepare()
    except CycleError as error:
        messages.append(f"a cycle of folders: {' -> '.join('/'.join(each) for each in error.args[1])}")
    return messages


def sources() -> list[Path]:
    files = [file for top in ("synth", "models", "designs", "studies") for file in sorted((ROOT / top).rglob("*.py"))]
    return [*files, *sorted((ROOT / "tests" / "designs").rglob("reference*.py"))]


def too_long(files: Iterable[Path]) -> list[str]:
    """Return the modules above the number of lines that a reader takes in at once."""
    lengths = {file: len(file.read_text(encoding="utf-8").splitlines()) for file in files}
    return [f"{file} has {n} lines: split it at {LONGEST}" for file, n in lengths.items() if n > LONGEST]


def test_no_module_is_too_long(tmp_path: Path) -> None:
    assert not too_long(sources())
    planted = tmp_path / "planted.py"
    planted.write_text("x = 1\n" * (LONGEST + 1))
    assert too_long([planted])


def test_imports_follow_the_flow_of_data() -> None:
    assert sources()
    messages = {file: violations(file.relative_to(ROOT), file.read_text(encoding="utf-8")) for file in sources()}
    assert not {file: what for file, what in messages.items() if what}


@pytest.mark.parametrize(
    ("path", "text"),
    [
        ("synth/helpers/text.py", ""),
        ("synth/signals.py", "import models.pmlsm"),
        ("synth/signals.py", "from synth import analyse"),
        ("synth/signals.py", "from . import verify"),
        ("synth/analyse/operating_points.py", "def f():\n    from synth.emit.program import lower"),
        ("synth/emit/pipeline.py", "from ..execute import host"),
        ("models/pmlsm.py", "from designs.maglev_5dof import design"),
        ("synth/report/page.py", "import studies.hall"),
        ("models/hall_stage.py", "from studies.hall import hall_bench"),
        ("models/planar_stage.py", "from synth.simulate.scenario import Trajectory"),
        ("designs/hall_position/page.py", "def f():\n    from studies.hall.pages import six"),
        ("designs/maglev_5dof/reference.py", "import casadi as ca"),
        ("designs/maglev_5dof/reference.py", "from synth.riccati import solve"),
        ("designs/maglev_5dof/reference.py", "from .design import PLANT"),
        ("designs/maglev_5dof/reference.py", "from importlib import import_module"),
        ("designs/planar_6dof/reference_sensing.py", "from designs.planar_6dof import sensing"),
        ("designs/planar_6dof/reference_sensing.py", "import designs.planar_6dof"),
        ("tests/designs/hall_position/reference_six.py", "from synth import numeric"),
        ("synth/reference/guard.py", "from synth.blocks.guard import safety"),
        ("synth/reference/gains.py", "import casadi"),
        ("synth/blocks/guard/safety.py", "from synth.reference import guard"),
        ("designs/maglev_5dof/control.py", "from synth.reference import gains"),
    ],
)
def test_a_planted_violation_is_found(path: str, text: str) -> None:
    assert violations(Path(path), text)


@pytest.mark.parametrize(
    ("path", "text"),
    [
        (
            "synth/emit/program/lower.py",
            "from ..analyse import trim\nfrom synth.emit import proof\nimport casadi, synth",
        ),
        ("models/pmlsm.py", "from synth.plant import Plant\nfrom . import windings"),
        (
            "designs/maglev_5dof/design.py",
            "from synth.app.cli import main\nfrom models import pmlsm\nfrom . import audit",
        ),
        (
            "studies/hall/costs.py",
            "from synth.app.cli import main\nfrom designs.hall_position import config",
        ),
        ("designs/maglev_5dof/reference.py", "import numpy as np\nfrom scipy import linalg"),
        ("designs/planar_6dof_lqg/reference.py", "from designs.planar_6dof import reference_sensing"),
        ("designs/planar_6dof_lqg/reference.py", "from synth.reference import gains"),
        ("synth/reference/servo.py", "from synth.reference.guard import rows"),
    ],
)
def test_an_import_along_the_flow_is_allowed(path: str, text: str) -> None:
    assert not violations(Path(path), text)


def test_folders_of_designs_import_no_design_and_none_in_a_cycle() -> None:
    texts = {file.relative_to(ROOT): file.read_text(encoding="utf-8") for file in sources()}
    assert {("designs", "maglev_5dof"), ("designs", "planar_6dof", "paper")} <= set(folder_imports(texts))
    assert not folder_violations(texts)


DESIGNS = {
    "designs/stage/law.py": "from models import motor\nimport designs.stage",
    "designs/stage/paper/rows.py": "from designs.stage import law\nfrom designs.sensing.maps import VOLTS",
    "designs/sensing/maps.py": "from . import fit",
    "designs/one/design.py": "from designs.stage.paper import rows\nfrom designs.one import page",
    "designs/one/page.py": "from designs.one import loops\nfrom designs.stage import law",
    "designs/one/__main__.py": "from designs.one.design import DESIGN",
}


def test_shared_packages_may_be_imported_and_files_of_a_folder_each_other() -> None:
    assert not folder_violations({Path(name): text for name, text in DESIGNS.items()})


@pytest.mark.parametrize(
    ("path", "text", "message"),
    [
        ("designs/two/design.py", "from designs.one import page", "designs/two imports the design designs/one"),
        ("designs/two/design.py", "def f():\n    import designs.one", "designs/two imports the design designs/one"),
        ("designs/stage/loop.py", "from designs.one.page import TEXT", "designs/stage imports the design designs/one"),
        ("designs/stage/loop.py", "from ..one import page", "designs/stage imports the design designs/one"),
        ("designs/stage/loop.py", "from designs.stage.paper import rows", "a cycle of folders"),
        ("designs/sensing/loop.py", "from designs.stage.paper.rows import Y", "a cycle of folders"),
        ("designs/one/paper/rows.py", "from designs.one import page", None),
        ("designs/one/design.py", "from designs.one.paper import rows\nfrom designs.one import page", None),
        ("designs/one/page.py", "from designs.one.design import DESIGN", "a cycle of folders"),
        ("designs/stage/paper/rows.py", "from designs.one.paper import rows", "imports the design designs/one"),
    ],
)
def test_a_planted_import_among_designs_is_found(path: str, text: str, message: str | None) -> None:
    messages = folder_violations({Path(name): each for name, each in (DESIGNS | {path: text}).items()})
    assert (message is None and not messages) or (message is not None and any(message in each for each in messages))


RUNS = ("emit", "execute", "simulate", "verify", "report", "app")
MOST_MODULES = 135  # of ours that an import of a design loads


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(path.parent.name for path in (ROOT / "designs").glob("*/design.py")))
def test_a_declaration_loads_nothing_that_emits_runs_or_reports(name: str) -> None:
    script = (
        f"import sys, designs.{name}.design\n"
        "print(*(m for m in sys.modules if m.split('.')[0] in ('synth', 'models', 'designs')))"
    )
    loaded = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True)
    modules = loaded.stdout.split()
    assert not [m for m in modules if m.startswith(tuple(f"synth.{stratum}." for stratum in RUNS))]
    assert len(modules) <= MOST_MODULES, len(modules)
