"""Project template (`synth new`): a one-axis levitator with law, reference and experiments, as a start for a stage.

Outside a workspace it makes one, with README, .gitignore, settings of pytest and continuous integration. In the root
of a workspace it adds the stage to those present.
"""

import keyword
from collections.abc import Mapping
from pathlib import Path

import jinja2

from synth import signals
from synth.base import store
from synth.errors import DesignError

STAGE = {
    "model.py.j2": "models/{name}.py",
    "control.py.j2": "designs/{name}/control.py",
    "reference.py.j2": "designs/{name}/reference.py",
    "design.py.j2": "designs/{name}/design.py",
    "test_design.py.j2": "tests/test_{name}.py",
}
WORKSPACE = {
    "README.md.j2": "README.md",
    "gitignore.j2": ".gitignore",
    "pytest.ini.j2": "pytest.ini",
    "ci.yml.j2": ".github/workflows/ci.yml",
}
RESERVED = ("designs", "models", "synth", "test", "tests")  # a model of that name would hide the module


def create(root: Path, name: str) -> tuple[Path, tuple[Path, ...]]:
    """Write the files of a new stage; return the root of its workspace and the files, relative to it.

    Raises SignalError for a name that C does not allow, and DesignError for one that Python does not allow or where a
    file exists already; then nothing is written.
    """
    _check_name(name)
    in_workspace = (root / "designs").is_dir()
    folder, sources = (root, STAGE) if in_workspace else (root / name, WORKSPACE | STAGE)
    files = _render(sources, name)
    if present := [path for path in files if (folder / path).exists()]:
        raise DesignError(f"{folder / present[0]} exists already, and nothing was written: choose another name")
    try:
        for path, text in files.items():
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            store.replace_text(folder / path, text)
    except BaseException:
        for path in files:
            (folder / path).unlink(missing_ok=True)
        raise
    return folder, tuple(files)


def _check_name(name: str) -> None:
    signals.identifier("stage", name)
    if name != name.lower() or keyword.iskeyword(name) or name in RESERVED:
        raise DesignError(
            f"stage '{name}' cannot be the name of a module: use small letters, and none of Python's words or of "
            f"{', '.join(RESERVED)}, such as my_stage"
        )


def _render(sources: Mapping[str, str], name: str) -> dict[Path, str]:
    loader = jinja2.PackageLoader("synth.app", "new_stage")
    environment = jinja2.Environment(loader=loader, undefined=jinja2.StrictUndefined, keep_trailing_newline=True)
    return {Path(path.format(name=name)): environment.get_template(t).render(name=name) for t, path in sources.items()}
