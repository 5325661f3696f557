"""`synth study`: the same table from one process, several, after a kill, and from a cluster that loses a worker."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from synth.app import study_command, study_jobs, workspace
from synth.app.study_jobs import Plan
from synth.base import jobs, store
from synth.base.progress import Lines, silent
from synth.declare.stage import Stage
from synth.errors import DesignError
from synth.simulate import study
from synth.simulate.sampling import Method, Sampling
from synth.simulate.study import StudyTable
from tests import levitator

pytestmark = pytest.mark.slow
NAME = "levitator_pid"
PLAN = Plan(Sampling(3 * study_jobs.CHUNK + 5, 2), ("z_*",))
SYNTH = (sys.executable, "-c", "from synth.app.cli import main; main()")


@pytest.fixture
def design(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Stage:
    monkeypatch.setenv("SYNTH_CACHE", str(tmp_path / "cache"))
    monkeypatch.delenv(store.FRESH, raising=False)
    monkeypatch.chdir(levitator.FOLDER)
    (loaded,) = workspace.designs(levitator.FOLDER, [NAME])
    return loaded


def whole(design: Stage, plan: Plan = PLAN, processes: int = 2) -> StudyTable:
    outcomes = jobs.run(study_jobs.jobs(design, plan), Lines(lambda about, line: None), processes)
    assert not any(o.error for o in outcomes.values()), outcomes
    return study_jobs.result(design, plan, outcomes)


def require_equal(first: StudyTable, second: StudyTable) -> None:
    assert np.array_equal(first.rows, second.rows) and len(set(first.rows.tolist())) == len(first.rows)
    assert first.z and first.checks
    for group in ("z", "checks", "figures"):
        columns, others = getattr(first, group), getattr(second, group)
        assert columns.keys() == others.keys()
        assert all(columns[name].tobytes() == others[name].tobytes() for name in columns)


def test_the_table_does_not_depend_on_processes_and_the_cache(design: Stage) -> None:
    table = whole(design, processes=1)
    assert table.rows.tolist() == list(range(PLAN.sampling.rows))
    with store.fresh_run():
        require_equal(table, whole(design, processes=3))
    require_equal(study_jobs.row(design, PLAN, 40, silent), one_row(table, 40))


def one_row(table: StudyTable, row: int) -> StudyTable:
    groups = {g: {n: c[row : row + 1] for n, c in getattr(table, g).items()} for g in ("z", "figures", "checks")}
    shared = {"limits": table.limits, "units": table.units, "integration": table.integration}
    return StudyTable(table.rows[row : row + 1], **shared, **groups)


def stored_chunks() -> set[Path]:
    """Return the stored chunks of a study: pickles of an object of its class, and no file that is being written."""
    results = (Path(os.environ["SYNTH_CACHE"]) / "results").glob("??/[!.]*")
    return {path for path in results if b"synth.simulate.study\x94\x8c\nStudyTable" in path.read_bytes()}


def test_a_killed_study_goes_on_where_it_was(design: Stage, tmp_path: Path) -> None:
    file = tmp_path / "table.csv"
    arguments = ("study", NAME, "--plants", str(PLAN.sampling.rows), "--seed", "2", "--experiments", "z_*")
    command = [*SYNTH, *arguments, "--csv", str(file)]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    killed = subprocess.Popen(command, env=environment, start_new_session=True, stdout=subprocess.PIPE)
    while not stored_chunks():
        assert killed.poll() is None, "the study ended before it was killed"
        time.sleep(0.02)
    os.killpg(killed.pid, signal.SIGKILL)
    killed.wait()
    kept = {path: path.stat().st_ino for path in stored_chunks()}
    assert 0 < len(kept) < len(PLAN.chunks) and not file.exists()
    subprocess.run(command, env=environment, stdout=subprocess.PIPE, check=False)
    assert len(stored_chunks()) == len(PLAN.chunks)
    assert all(path.stat().st_ino == inode for path, inode in kept.items()), "a stored chunk was computed again"
    with store.fresh_run():
        assert file.read_text() == study.csv_text(whole(design))


def test_the_document_and_the_file(design: Stage, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "table.csv"
    files = study_command.StudyFiles(csv=file)
    chosen = study_command.StudyChoice(9, ("z_*",), 1, "corners", None, files, None, None)
    status = study_command.study(NAME, True, False, chosen)
    document = json.loads(capsys.readouterr().out)
    assert document["rows"] == 9 and status == int(document["yield"]["share"] < 1)
    lines = file.read_text().splitlines()
    assert len(lines) == 10 and lines[0].startswith("row,z ") and lines[9].startswith("8,")


@pytest.mark.parametrize("name", [".", "nowhere/table.csv"])
def test_a_file_that_cannot_be_written_is_refused_before_the_study(design: Stage, tmp_path: Path, name: str) -> None:
    chosen = study_command.StudyChoice(
        9, (), 1, "corners", None, study_command.StudyFiles(csv=tmp_path / name), None, None
    )
    with pytest.raises(DesignError, match="cannot be written: give a name in a folder that exists"):
        study_command.study(NAME, True, False, chosen)


def test_rows_and_designs_that_do_not_exist_are_refused(design: Stage) -> None:
    with pytest.raises(DesignError, match="row 293 of a study of 293 rows: give 0 to 292"):
        study_jobs.row(design, PLAN, 293, silent)
    with pytest.raises(DesignError, match="no experiment is called 'stp'"):
        study_jobs.jobs(design, Plan(Sampling(3, 0, Method.LATIN), ("stp",)))


@pytest.fixture
def scheduler(tmp_path: Path) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """A dask scheduler with two workers, each started by its own command, with caches of their own."""
    pytest.importorskip("distributed")
    file = tmp_path / "scheduler.json"
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    dask = (sys.executable, "-m", "dask")
    options = ("--no-dashboard", "--scheduler-file", str(file))
    started = [subprocess.Popen([*dask, "scheduler", "--host", "127.0.0.1", "--port", "0", *options], env=environment)]
    while not (file.exists() and file.read_text()):
        assert started[0].poll() is None
        time.sleep(0.05)
    for k in range(2):
        work = {**environment, "SYNTH_CACHE": str(tmp_path / f"worker{k}")}
        local = ("--nthreads", "1", "--no-nanny", "--local-directory", str(tmp_path / f"local{k}"))
        started.append(subprocess.Popen([*dask, "worker", *options, *local], env=work))
    yield json.loads(file.read_text())["address"], started
    for process in reversed(started):
        process.kill()
        process.wait()


@pytest.mark.whole
def test_a_cluster_that_loses_a_worker_gives_the_same_rows(
    design: Stage, scheduler: tuple[str, list[subprocess.Popen[bytes]]]
) -> None:
    address, (_, first, _) = scheduler
    lines: list[str] = []

    def report(line: str) -> None:
        if not lines:
            first.kill()
        lines.append(line)

    table = study_jobs.on_cluster(design, PLAN, address, report)
    assert len(lines) == len(PLAN.chunks) and first.wait() == -signal.SIGKILL
    require_equal(table, whole(design))


def test_an_address_where_nothing_answers_is_refused(design: Stage) -> None:
    pytest.importorskip("distributed")
    with pytest.raises(DesignError, match=r"no dask scheduler answers at 'tcp://127\.0\.0\.1:9'"):
        study_jobs.on_cluster(design, PLAN, "tcp://127.0.0.1:9", silent)


def test_without_dask_the_error_says_how_to_install_it(design: Stage, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(DesignError, match=r"needs dask: run `pip install 'synth-stage\[cluster\]'`"):
        study_jobs.on_cluster(design, PLAN, "tcp://127.0.0.1:9", silent)
