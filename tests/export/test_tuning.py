"""Parameters on an exported loop: set, moved to, logged, saved, restored; what is refused leaves the law as it is."""

import os
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from synth.app import bench
from synth.declare.tuning import Tried
from synth.execute import host
from synth.export import records
from tests.export import harness

pytestmark = pytest.mark.slow

NAME, SAMPLES = "levitator_2dof", 3000
MOTION = ("--motion", "sine z_ref 2e-4 10 3")
GAIN = "servo_z_w_z_command_from_sum"


@cache
def set_text(damping_z: float) -> str:
    tried = Tried({"damping_z": damping_z}, {"phase_margin": 40.0}, ())
    return bench.set_file(harness.stage(NAME), tried, harness.emitted(NAME)[NAME].manifest)


def values(text: str) -> dict[str, float]:
    pairs = [line.split(" = ") for line in text.splitlines() if not line.startswith("#")]
    return {name: float(value) for name, value in pairs[:-1]}


def check(text: str) -> int:
    return int(text.split("check = ")[1], 16)


def lockstep(folder: Path, record: str, *words: str) -> dict[str, np.ndarray]:
    done = harness.call(folder, "--lockstep", str(SAMPLES), "--record", record, *MOTION, *words)
    assert done.returncode == 0, done.stderr
    return {**records.read(folder / record).samples}


@cache
def controller() -> host.Controller:
    code = harness.emitted(NAME)[NAME]
    return host.load(code.files, code.manifest)


def test_without_a_set_the_loop_has_the_declared_law_to_the_last_bit(loop: Path) -> None:
    """A set with the declared values has its bits, too, and no report says that others ran."""
    tuning = harness.stage(NAME).tuning
    assert tuning is not None
    (loop / "same.txt").write_text(set_text(next(f.value for f in tuning.free if f.name == "damping_z")))
    plain, same = lockstep(loop, "plain.csv"), lockstep(loop, "same.csv", "--parameters", "same.txt")
    for name, column in plain.items():
        np.testing.assert_array_equal(same[name], column, name)
    done = harness.call(loop, "--lockstep", "10", "--parameters", "same.txt")
    assert "OTHER" not in done.stderr and "the declared parameters" in done.stderr


def test_a_restored_set_runs_from_the_first_step_on(loop: Path) -> None:
    """The record replays on the controller with these parameters bit for bit, and not on the declared one."""
    text = set_text(1500.0)
    (loop / "set.txt").write_text(text)
    log = lockstep(loop, "run.csv", "--parameters", "set.txt")
    assert (log["parameters_check"] == check(text)).all() and not log["parameters_left"].any()
    declared = lockstep(loop, "declared.csv")
    assert not np.array_equal(log["i1"], declared["i1"])
    names = [f["name"] for f in controller().manifest["structs"]["input"]["fields"]]
    inputs = {n: np.asarray(log[n] if n in log else np.zeros(SAMPLES), np.float32) for n in names}
    state = controller().init()
    assert controller().tune(state, values(text)) == 0
    outputs = controller().replay(inputs, state).outputs
    np.testing.assert_array_equal(outputs["i1"], log["i1"].astype(np.float32))
    done = harness.call(loop, "--lockstep", "10", "--parameters", "set.txt")
    assert done.stderr.splitlines()[0] == f"{NAME}: OTHER than the declared parameters"
    assert done.stderr.index("OTHER PARAMETERS than the declared design") < done.stderr.index(" samples, ")


def test_a_set_is_taken_moved_to_logged_and_saved(loop: Path) -> None:
    text = set_text(1500.0)
    (loop / "set.txt").write_text(text)
    with harness.running(loop, "--stall", "5000") as running:
        running.wait("phase=running moving=0")
        before = running.ask("parameters")
        assert running.ask("record run.csv") == "ok"
        running.wait("recording=1")
        assert running.ask("tune set.txt") == "ok"
        status = running.wait("parameters_left=0")
        assert f"parameters=0x{check(text):08x}" in status
        answer = running.ask("parameters")
        assert before != answer and answer.startswith(f"ok check=0x{check(text):08x} ")
        shown = dict(word.split("=") for word in answer.split()[2:])
        assert {n: float(v) for n, v in shown.items()} == values(text)
        assert running.ask("save saved.txt") == "ok"
        assert running.ask("save saved.txt").startswith("error: 'saved.txt' cannot be written: File exists")
        assert running.ask("record stop") == "ok"
        assert running.ask("tune saved.txt") == "ok"
        running.process.terminate()
        assert running.end() == 0
        log = running.log
    saved = (loop / "saved.txt").read_text()
    assert values(saved) == values(text) and check(saved) == check(text)
    lines = log.splitlines()
    assert lines[0] == f"{NAME}: the declared parameters" and lines[1].startswith("  check=0x")
    assert any("the controller moves to OTHER parameters" in line for line in lines)
    assert log.index("OTHER PARAMETERS than the declared design") < log.index(" samples, ")
    table = records.read(loop / "run.csv").samples
    left = table["parameters_left"][table["parameters_check"] == check(text)]
    calls = controller().manifest["tuning"]["calls"]
    moves = np.flatnonzero(np.diff(left))
    assert left[0] == calls - 1 and left[-1] == 0 and (np.diff(left)[: len(moves)] == -1).all()
    assert not (table["faults"].astype(np.uint32) & 0x80000000).any()


def test_a_start_after_a_stop_keeps_the_set(loop: Path) -> None:
    text = set_text(1500.0)
    (loop / "set.txt").write_text(text)
    with harness.running(loop, "--stall", "5000") as running:
        running.wait("phase=running moving=0")
        assert running.ask("tune set.txt") == "ok"
        running.ask("stop")
        running.wait("phase=disabled")
        while running.ask("start") != "ok":
            pass
        running.wait("phase=running moving=0")
        assert f"parameters=0x{check(text):08x} parameters_left=0" in running.ask("status")


def changed(text: str, name: str, value: str) -> str:
    return "".join(
        f"{name} = {value}\n" if line.startswith(f"{name} = ") else line for line in text.splitlines(keepends=True)
    )


def checked(text: str, of: Mapping[str, float]) -> str:
    """Return the text with other values and the check that belongs to them."""
    for name, value in of.items():
        text = changed(text, name, repr(value))
    return changed(text, "check", f"0x{controller().parameters(values(text))['check'].item():08x}")


def refused() -> dict[str, tuple[str, str]]:
    new, old = set_text(1500.0), set_text(700.0)
    lines, others = new.splitlines(keepends=True), old.splitlines(keepends=True)
    half = len(lines) // 2
    check_bit, range_bit = "the check does not fit the values", "a value is not finite, or outside its range"
    return {
        "no check": ("".join(lines[:-1]), "has no 'check': half of a file"),
        "cut": ("".join(lines[:half]), "half of a file, or one of another design"),
        "cut in the check": (new[:-4], "is not a check: need 0x and 8 digits"),
        "cut in a value": (changed(new, GAIN, f"{values(new)[GAIN]}"[:-2]), check_bit),
        "two halves": ("".join([*lines[:half], *others[half:]]), check_bit),
        "NaN": (checked(new, {GAIN: float("nan")}), range_bit),
        "infinite": (checked(new, {GAIN: float("inf")}), range_bit),
        "out of range": (checked(new, {GAIN: -2000.0}), range_bit),
        "NaN without its check": (changed(new, GAIN, "nan"), check_bit),
        "another design": (new.replace("servo_z", "servo_y"), "is not a parameter of levitator_2dof"),
        "other C": (changed(new, "check", f"0x{check(new) ^ 1:08x}"), "or parameters of other C"),
        "twice": (new.replace("check", f"{lines[2]}check"), "is there twice, or after the check"),
        "not a number": (changed(new, GAIN, "fast"), "is not a number"),
        "no line": (new.replace(" = ", " "), "need `name = value`"),
        "a zero byte": (new.replace("#", "\0"), "cannot be read: Invalid argument"),
        "too long": (new + "#" * 70000, "cannot be read: File too large"),
        "empty": ("", "half of a file, or one of another design"),
    }


def test_what_is_no_whole_set_is_refused_and_changes_nothing(loop: Path) -> None:
    cases = refused()
    with harness.running(loop, "--stall", "5000") as running:
        running.wait("phase=running moving=0")
        before = running.ask("parameters")
        for k, (text, _) in enumerate(cases.values()):
            (loop / f"{k}.txt").write_text(text)
        os.mkfifo(loop / "pipe.txt")
        answers = {case: running.ask(f"tune {k}.txt") for k, case in enumerate(cases)}
        for line, said in (
            ("tune nowhere.txt", "cannot be read: No such file"),
            ("tune pipe.txt", "cannot be read: Invalid argument"),
            ("tune", "`tune` needs one word: a file"),
            ("save", "`save` needs one word: a file"),
            ("parameters 1", "`parameters` stands alone"),
        ):
            assert said in running.ask(line), line
        assert running.ask("parameters") == before and "parameters_left=0" in running.ask("status")
    wrong = {c: a for c, a in answers.items() if not a.startswith("error: ") or cases[c][1] not in a}
    assert wrong == {}


def test_a_refused_set_at_the_start_starts_nothing(loop: Path) -> None:
    (loop / "bad.txt").write_text(refused()["two halves"][0])
    done = harness.call(loop, "--lockstep", "10", "--parameters", "bad.txt")
    assert done.returncode == 2 and "--parameters: 'bad.txt' is refused; the check does not fit" in done.stderr


def test_a_law_without_a_bench_exports_nothing_of_it(tmp_path: Path) -> None:
    folder = harness.export("maglev_5dof", tmp_path)
    words = ("tuning", "_tune", "parameters_t", "COMMAND_TUNE", "--parameters")
    files = {p.name: p.read_text() for p in (*folder.glob("src/*.[ch]"), folder / "README.md")}
    assert [name for name, text in files.items() if any(word in text for word in words)] == []
