"""Progress: bars at a terminal, lines elsewhere, and an interrupt that leaves nothing half-written."""

import os
import pty
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import pytest

from synth.base import progress, store
from synth.base.jobs import Job, run
from synth.base.progress import Bars, Counted, Lines, Progress

ROOT = Path(__file__).parents[2]
DESIGN = '''"""A design whose experiments report three parts; they do not end while the file `wait` is there."""

import subprocess
from dataclasses import replace
from pathlib import Path

from synth.base import progress
from synth.app import standard_tasks
from synth.verify.suite import Evidence
from tests import levitator


def simulate(of, report):
    for _ in progress.each(["first", "second", "third"], report, str):
        while Path("wait").exists():
            Path("started").touch()
            subprocess.run(["sleep", "0.05"], check=True)
    return []


standard_tasks.simulate = simulate
PID = levitator.design().DESIGN
DESIGN = replace(
    PID, controller=replace(PID.controller, name="stage"), operating_points={}, require={},
    verify=lambda of, report, whole: Evidence("stage", (), ()),
)
'''
SCRIPT = "from synth.app.cli import main; main()"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A workspace of one design."""
    (tmp_path / "designs/stage").mkdir(parents=True)
    (tmp_path / "designs/stage/design.py").write_text(DESIGN)
    return tmp_path


def environment(folder: Path) -> dict[str, str]:
    path = os.pathsep.join([str(ROOT), str(folder)])
    shown = {"TERM": "xterm", "COLUMNS": "120", "LINES": "30"}
    return {**os.environ, **shown, "PYTHONPATH": path, "SYNTH_CACHE": str(folder / "cache")}


def at_a_terminal(folder: Path, *arguments: str) -> tuple[int, int]:
    """Start the command line with a pseudo-terminal; return its process and the terminal's other end."""
    process, end = pty.fork()
    if process == 0:
        os.chdir(folder)
        os.execve(sys.executable, [sys.executable, "-c", SCRIPT, *arguments], environment(folder))
    return process, end


def finish(process: int, end: int) -> tuple[int, str]:
    """Return the exit status and all that was written to the terminal."""
    written = b""
    while True:
        try:
            part = os.read(end, 4096)
        except OSError:  # Linux reports the end of a terminal so
            break
        if not part:
            break
        written += part
    _, status = os.waitpid(process, 0)
    os.close(end)
    return os.waitstatus_to_exitcode(status), written.decode(errors="replace")


@pytest.mark.slow
def test_a_terminal_shows_what_is_done_how_much_of_it_and_for_how_long(folder: Path) -> None:
    status, text = finish(*at_a_terminal(folder, "simulate", "--fresh"))
    assert status == 0, text
    for shown in ("stage: first", "0/3", "stage: third", "2/3", "0:00:0", "━"):
        assert shown in text, (shown, text)
    assert text.endswith("\x1b[?25h") or "\x1b[?25h" in text, "the cursor is shown again"


@pytest.mark.slow
@pytest.mark.parametrize("options", [(), ("--json",)])
def test_without_a_terminal_there_are_lines_alone(folder: Path, options: Sequence[str]) -> None:
    command = [sys.executable, "-c", SCRIPT, "simulate", *options]
    ended = subprocess.run(
        command,
        cwd=folder,
        env=environment(folder),
        capture_output=True,
        text=True,
        check=True,
        stdin=subprocess.DEVNULL,
    )
    lines = ended.stderr if options else ended.stdout
    assert "\x1b" not in ended.stdout + ended.stderr and "━" not in ended.stdout + ended.stderr
    assert "stage: first\nstage: second\nstage: third\n" in lines
    assert options or not ended.stderr


@pytest.mark.slow
@pytest.mark.parametrize("command", ["simulate", "simulate --json"])
def test_ctrl_c_ends_with_130_and_one_line(folder: Path, command: str) -> None:
    (folder / "wait").touch()
    process, end = at_a_terminal(folder, *command.split())
    while not (folder / "started").exists():
        assert os.waitpid(process, os.WNOHANG) == (0, 0), finish(process, end)
        time.sleep(0.01)
    os.write(end, b"\x03")
    status, text = finish(process, end)
    assert status == 130
    assert "Traceback" not in text and "error:" not in text, text
    (last,) = [line for line in text.splitlines() if "interrupted" in line]
    assert last.endswith(
        "interrupted: finished results are kept and no file is half-written; run the same command again to continue"
    )
    assert not list(folder.rglob(".writing-*"))


@pytest.mark.slow
def test_a_request_to_terminate_ends_the_jobs_too(folder: Path) -> None:
    (folder / "wait").touch()
    command = [sys.executable, "-c", SCRIPT, "simulate"]
    process = subprocess.Popen(
        command, cwd=folder, env=environment(folder), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    while not (folder / "started").exists():
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(signal.SIGTERM)
    _, errors = process.communicate()  # returns once the jobs have closed their ends of the pipes, too
    assert process.returncode == 143 and errors.startswith("interrupted: ") and errors.count("\n") == 1


def test_a_file_has_the_old_text_or_the_new_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "stage.c"
    store.replace_text(path, "old")
    mode = path.stat().st_mode

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(os, "replace", interrupt)
        with pytest.raises(KeyboardInterrupt):
            store.replace_text(path, "new")
    assert path.read_text() == "old" and list(tmp_path.iterdir()) == [path]
    store.replace_text(path, "new")
    (tmp_path / "plain").touch()
    assert path.read_text() == "new" and mode == path.stat().st_mode == (tmp_path / "plain").stat().st_mode


def test_lines_keep_their_counts_through_a_pipe() -> None:
    received: list[str] = []

    class Recorder(Lines):
        def report(self, job: str, about: str, line: str) -> None:
            received.append(line)

    def work(report: Progress) -> int:
        return sum(progress.each([1, 2], report, str))

    outcomes = run([Job("sum", "sum", work)], Recorder(lambda about, line: None))
    assert outcomes["sum"].value == 3 and received == ["1", "2"]
    assert [(line.done, line.total) for line in received if isinstance(line, Counted)] == [(0, 2), (1, 2)]


def test_numbered_lines_never_exceed_the_total() -> None:
    lines: list[str] = []
    report = progress.numbered(lines.append, 2)
    for line in "abc":
        report(line)
    assert [(str(x), x.done, x.total) for x in lines if isinstance(x, Counted)] == [
        ("a", 0, 2),
        ("b", 1, 2),
        ("c", 2, 2),
    ]


def test_a_notebook_call_is_silent_where_nothing_can_show_it(capsys: pytest.CaptureFixture[str]) -> None:
    with progress.bar("experiments") as report:
        report(Counted("step", 1, 2))
    assert capsys.readouterr() == ("", "")


def test_a_bar_counts_the_jobs_that_have_ended(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setenv("FORCE_COLOR", "1")
    with Bars(2) as bars:
        bars.begin("verify [stage]", "stage")
        bars.report("verify [stage]", "stage", Counted("loops [a]", 3, 7))
        bars.end("verify [stage]")
        bars.end("not begun")
        bars.tick()
    text = capsys.readouterr().err
    assert "verify [stage]: loops [a]" in text and "3/7" in text and "0/2" in text and "2/2" in text
