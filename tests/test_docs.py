"""What the documentation shows runs as it stands, and prints what it shows."""

import importlib
import os
import re
import subprocess
import sys
from pathlib import Path

import control
import pytest

from docs import pages
from synth import analyse, synthesise
from synth.app import commands
from tests.export import harness

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
WITH_EXAMPLES = sorted(
    str(page.relative_to(DOCS)) for page in DOCS.rglob("*.md") if pages.EXAMPLE.search(page.read_text("utf-8"))
)


def read(page: str) -> str:
    return (DOCS / page).read_text(encoding="utf-8")


def synth(folder: Path, *words: str) -> str:
    """Run a command in a workspace as a user does, and return what it prints."""
    path = os.pathsep.join([str(ROOT), str(folder)])
    done = subprocess.run(
        [sys.executable, *words], cwd=folder, env={**os.environ, "PYTHONPATH": path}, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    return done.stdout


COMMAND = ("-c", "from synth.app.cli import main; main()")


@pytest.mark.whole
@pytest.mark.parametrize("page", WITH_EXAMPLES)
def test_the_examples_of_a_page_run_and_print_what_it_shows(
    page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`python -m docs.pages PAGE` rewrites the output of the examples of a page."""
    monkeypatch.setenv("MPLBACKEND", "svg")
    _, pairs = pages.run(read(page), tmp_path)
    for shown, printed in pairs:
        assert printed == (shown or ""), f"run `python -m docs.pages docs/{page}` and read what has changed"


def test_each_page_is_in_a_table_of_contents() -> None:
    """A page that nothing leads to fails the build of the site, too."""
    contents = "\n".join(re.findall(r"```{toctree}.*?```", "\n".join(map(read, ("index.md",))), re.DOTALL))
    listed = {page.split("/")[0] for page in re.findall(r"^[\w/*-]+$", contents, re.MULTILINE)}
    assert {path.stem for path in DOCS.glob("*.md")} - {"index"} <= listed
    assert {"howto", "explanation", "reference", "gallery", "decisions"} <= listed


def test_the_links_of_the_readme_lead_somewhere() -> None:
    links = re.findall(r"\]\(([^)#]+)\)", (ROOT / "README.md").read_text(encoding="utf-8"))
    assert links and [link for link in links if not (ROOT / link).exists()] == []


def test_the_readme_quotes_the_declaration() -> None:
    """What it leaves out stands as `# ...`."""
    (quoted,) = re.findall(r"^```python\n(.*?)^```$", (ROOT / "README.md").read_text(encoding="utf-8"), re.M | re.S)
    declaration = (ROOT / "designs" / "levitator_2dof" / "design.py").read_text(encoding="utf-8")
    pieces = re.split(r"^ *# \.\.\.\n", quoted, flags=re.MULTILINE)
    assert len(pieces) > 1 and [piece for piece in pieces if piece.strip("\n") not in declaration] == []


def test_the_names_beside_matlabs_are_there() -> None:
    pages_of_names = read("coming-from.md") + read("library.md")
    for module, function in re.findall(r"`((?:analyse|synthesise)[a-z_.]*)\.([a-z_0-9]+)`", pages_of_names):
        assert callable(getattr(importlib.import_module(f"synth.{module}"), function)), (module, function)


def test_every_exported_function_stands_beside_its_counterparts() -> None:
    exported = {f"{p.__name__.split('.')[1]}.{name}" for p in (analyse, synthesise) for name in p.__all__}
    assert set(re.findall(r"^\| `((?:analyse|synthesise)\.\w+)` \|", read("library.md"), re.MULTILINE)) == exported


def test_the_names_of_python_control_are_there() -> None:
    names = set()
    for page, column in (("coming-from.md", 2), ("library.md", 3)):
        rows = [row.split("|") for row in read(page).splitlines() if row.startswith("| ")]
        names |= {name for row in rows for name in re.findall(r"`(\w+)", row[column])}
    assert names and [name for name in sorted(names - {"flatsys"}) if not hasattr(control, name)] == []


@pytest.mark.whole
def test_the_tutorial_leads_to_a_verified_bearing(tmp_path: Path) -> None:
    """Its files replace those of a new stage; that it shows all of them is what lets a reader follow it."""
    folder, written = commands.create(tmp_path, "bearing")
    text = read("tutorial.md")
    shown = {Path(path) for path, _ in pages.blocks(text)}
    assert shown == {p for p in written if p.parts[0] in ("models", "designs")}
    pages.apply(text, folder)
    synth(folder, *COMMAND, "build")
    synth(folder, "-m", "pytest", "-q", "-p", "no:cacheprovider")
    exporting, rehearsing = re.findall(r"^(synth export .*)\n(make .*)$", text, re.MULTILINE)[0]
    synth(folder, *COMMAND, *exporting.split()[1:])
    printed = harness.make(folder, *rehearsing.split()[1:], f"CC={harness.compiler()}")
    assert "0 of 1000 samples differ" in printed and "bearing: disabled: the run is over" in printed


@pytest.mark.whole
@pytest.mark.parametrize(
    ("page", "name"),
    [
        ("your-own-stage", "flexure"),
        ("add-a-force-law", "my_stage"),
        ("add-a-sensor", "my_stage"),
        ("add-a-regulator", "my_stage"),
    ],
)
def test_a_change_of_a_new_stage_builds_with_every_check_passed(page: str, name: str, tmp_path: Path) -> None:
    folder, _ = commands.create(tmp_path, name)
    pages.apply(read(f"howto/{page}.md"), folder)
    synth(folder, *COMMAND, "build")


@pytest.mark.whole
def test_the_limits_of_faults_on_the_page_hold_on_a_new_stage(tmp_path: Path) -> None:
    folder, _ = commands.create(tmp_path, "my_stage")
    pages.apply(read("howto/judge-faults-on-the-machine.md"), folder)
    printed = synth(folder, *COMMAND, "faults", "my_stage", "--sweep")
    assert "z frozen" in printed and "limits of faults" in printed and "FAILED" not in printed
    assert "ms, too late" in printed and "z + i lost and dead" in printed
    synth(folder, *COMMAND, "faults", "my_stage", "--write", "--plants", "2")
    synth(folder, *COMMAND, "emit", "my_stage", "--out", "firmware")
    datasheet = (folder / "firmware" / "my_stage" / "my_stage.md").read_text(encoding="utf-8")
    assert "measured on 2 plants with each sensor lost in turn" in datasheet


@pytest.mark.whole
def test_the_commands_of_a_study_on_the_page_run_on_a_new_stage(tmp_path: Path) -> None:
    folder, _ = commands.create(tmp_path, "my_stage")
    page = read("howto/study-tolerances.md")
    assert "synth study my_stage --experiments 'step_*'" in page and "--row 17" in page
    chosen = ("study", "my_stage", "--plants", "24", "--experiments", "step_*")
    printed = synth(folder, *COMMAND, *chosen, "--sampling", "corners", "--csv", "study.csv")
    assert "24 of 24 machines keep every limit: yield 100.00%" in printed
    rows = (folder / "study.csv").read_text().splitlines()
    assert len(rows) == 25
    alone = synth(folder, *COMMAND, *chosen, "--sampling", "corners", "--row", "17")
    assert "my_stage: machine 17" in alone and "deviations in tolerances: M " in alone


def test_a_broken_example_is_noticed(tmp_path: Path) -> None:
    with pytest.raises(NameError):
        pages.run("text\n\n```python\nx = missing\n```\n", tmp_path)


def test_a_change_that_fits_nowhere_is_noticed(tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text("x = 1\n")
    with pytest.raises(AssertionError, match="found 0 places"):
        pages.apply("```{code-block} diff\n:caption: a.py\n\n-y = 1\n+y = 2\n```\n", tmp_path)


def test_the_output_of_an_example_is_read_with_it(tmp_path: Path) -> None:
    _, pairs = pages.run("```python\nprint(1 + 1)\n```\n\n```text\n3\n```\n", tmp_path)
    assert pairs == [("3\n", "2\n")]
