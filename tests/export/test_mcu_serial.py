"""The vectors over a serial line: a board on QEMU equals them; wrong steps, damaged frames and silence are found."""

import json
import os
import pty
import re
import subprocess
import threading
import time
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from synth.app import cli
from synth.base.progress import silent
from synth.errors import SignalError, SynthError
from synth.export import project, serial_replay
from tests import tools
from tests.export import harness, test_mcu
from tests.export.test_mcu import needs_board

pytestmark = pytest.mark.slow

NAMES = ("levitator_2dof", pytest.param("maglev_5dof", marks=pytest.mark.whole))  # the latter has a drive


@contextmanager
def board(folder: Path) -> Iterator[str]:
    """Run the board of a project; yield the path of its serial line."""
    harness.make(folder, "-s", "build/cortex-m4/serial_board.elf")
    command = "qemu-system-arm -M mps2-an386 -nographic -monitor none -serial null -serial pty -kernel"
    words = [*command.split(), str(folder / "build/cortex-m4/serial_board.elf")]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        assert process.stdout
        line = process.stdout.readline()
        match = re.search(r"/dev/\S+", line)
        assert match, line
        yield match[0]
    finally:
        process.terminate()
        process.wait(30)


@contextmanager
def fake(answer: bytes) -> Iterator[str]:
    """A line whose other end answers a frame with these bytes, and zeros with nothing."""
    ours, theirs = pty.openpty()

    def run() -> None:
        received = b""
        while answer:
            try:
                received += os.read(ours, 4096)
            except OSError:
                return
            if serial_replay.SYNC in received:
                os.write(ours, answer)
                return

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    try:
        yield os.ttyname(theirs)
    finally:
        os.close(theirs)
        os.close(ours)


@needs_board
@pytest.mark.parametrize("name", NAMES)
def test_a_board_equals_the_vectors(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    vectors = project.replay_vectors(harness.stage(name), harness.emitted(name))
    with board(test_mcu.export(name, tmp_path)) as path:
        with serial_replay.connect(path, timeout_s=60) as line:
            checks, note = serial_replay.replay(line, name, vectors, silent)
        assert len(checks) == 1 + 2 * len(vectors) and all(c.passed for c in checks), checks
        assert note.startswith("the core counts no cycles; up to ") and "no cycles, in the simulation" in note
        if name == "levitator_2dof":
            monkeypatch.chdir(harness.ROOT)
            done = CliRunner().invoke(cli.app, ["verify", name, "--serial", path, "--json"])
            (document,) = json.loads(done.stdout)
            assert done.exit_code == 0 and all(c["passed"] for c in document["checks"])


@needs_board
def test_a_wrong_step_and_a_damaged_frame_are_found(tmp_path: Path) -> None:
    folder, name = test_mcu.export("levitator_2dof", tmp_path), "levitator_2dof"
    test_mcu.plant_wrong_step(folder)
    vectors = project.replay_vectors(harness.stage(name), harness.emitted(name))
    with board(folder) as path, serial_replay.connect(path, timeout_s=60) as line:
        frame = bytearray(serial_replay.frame(b"H", b"abc"))
        frame[6] ^= 1
        os.write(line.fd, frame)
        with pytest.raises(SynthError, match="the board found a wrong checksum in frame b'H': look at the rate"):
            line.ask(b"H")  # the board answers the damaged frame first
        line.drain()
        for kind, content, reason in (
            (b"X", b"", "an unknown kind"),
            (b"S", b"\0", "a wrong length"),
            (b"I", b"\7", "a step"),
        ):
            with pytest.raises(SynthError, match=f"the board found {reason}"):
                line.ask(kind, content)
        with pytest.raises(SignalError, match="found 'levitator_2dof' with 1 steps, need 'other' with 1: build"):
            serial_replay.replay(line, "other", vectors, silent)
        checks, _ = serial_replay.replay(line, name, vectors, silent)
    failed = [c for c in checks if not c.passed]
    assert [c.name for c in failed] == ["self-test at boot", "levitator_2dof: outputs that differ"]
    assert re.fullmatch(r"i1 in sample \d+: found \S+, needs \S+", failed[1].about)


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (b"", "found 0 bytes in 0.2 s, need 5: no board answers; see that it runs serial_receive"),
        (serial_replay.frame(b"H", b"\1")[:-1] + b"\0", "found a frame with checksum .*: look at the rate"),
        (b"hello", "found 68 65 6c 6c 6f, a frame begins with 5a c3: look at the rate"),
        (serial_replay.frame(b"S", b""), "found an answer b'S' to b'H', need the same"),
        (serial_replay.frame(b"H", b"\2" + bytes(20)), "found frames of version 2, need 1: build the image"),
        (serial_replay.frame(b"H", b"\1\1"), "found a hello of 2 bytes, need 16 and a name: see that .* not echo"),
        (serial_replay.frame(b"H"), "found a hello of 0 bytes, need 16 and a name"),
        (serial_replay.frame(b"E"), "the board found reason '' in frame b'H'"),
        (serial_replay.frame(b"E", b"\1"), "the board found a wrong checksum in frame b'H'"),
    ],
)
def test_what_is_no_answer_is_refused(answer: bytes, message: str) -> None:
    timeout_s = 20 if answer else 0.2
    with (
        fake(answer) as path,
        serial_replay.connect(path, timeout_s=timeout_s) as line,
        pytest.raises(SynthError, match=message),
    ):
        serial_replay.hello(line)


def test_a_name_that_is_no_text_is_shown() -> None:
    content = b"\1\1" + bytes(14) + b"\xff\xfe"
    message = r"found '\\xff\\xfe' with 1 steps, need 'stage'"
    with (
        fake(serial_replay.frame(b"H", content)) as path,
        serial_replay.connect(path, timeout_s=20) as line,
        pytest.raises(SignalError, match=message),
    ):
        serial_replay.replay(line, "stage", {"stage": np.zeros(1)}, silent)


Speak = Callable[[int, threading.Event], None]  # the other end of a line, until it is over


@contextmanager
def other_end(speak: Speak) -> Iterator[str]:
    """A line at whose other end this is called, in a thread of its own, with its file descriptor."""
    ours, theirs = pty.openpty()
    tty.setraw(theirs)
    over = threading.Event()
    thread = threading.Thread(target=speak, args=(ours, over))
    thread.start()
    try:
        yield os.ttyname(theirs)
    finally:
        over.set()
        thread.join()
        os.close(theirs)
        with suppress(OSError):
            os.close(ours)


def babble(fd: int, over: threading.Event) -> None:
    while not over.wait(0.01):
        os.write(fd, b"hello world\r\n")


def trickle(fd: int, over: threading.Event) -> None:
    """A frame of 65,535 bytes at ten a second: none is late, and the frame never comes."""
    while serial_replay.SYNC not in os.read(fd, 4096):
        pass
    os.write(fd, serial_replay.SYNC + b"H\xff\xff")
    while not over.wait(0.1):
        os.write(fd, b"x")


def unplug(fd: int, over: threading.Event) -> None:
    """In the middle of a frame."""
    while serial_replay.SYNC not in os.read(fd, 4096):
        pass
    os.write(fd, serial_replay.frame(b"H", bytes(20))[:12])
    over.wait(0.2)
    os.close(fd)


@pytest.mark.parametrize(
    ("speak", "message"),
    [
        (babble, "found bytes without an end for 1 s, need a board that speaks when it is asked"),
        (trickle, r"found \d+ bytes in 1 s, need 65539: no board answers"),
        (unplug, "found the end of the line, need an answer: plug the board in"),
    ],
)
def test_a_line_that_babbles_trickles_or_ends_is_left(speak: Speak, message: str) -> None:
    began = time.monotonic()
    with (
        other_end(speak) as path,
        pytest.raises(SynthError, match=message),
        serial_replay.connect(path, timeout_s=1) as line,
    ):
        serial_replay.hello(line)
    assert time.monotonic() - began < 10


def test_what_is_no_line_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for path, baud, message in (
        (tmp_path / "none", 115200, "No such file or directory, need a serial line: give its path"),
        (tmp_path / "file", 115200, "found no terminal, need a serial line"),
        (tmp_path / "file", 115201, "found the rate 115201, need one of the system's, such as 115200"),
    ):
        with pytest.raises(SynthError, match=message), serial_replay.connect(str(path), baud):
            pass


def test_a_differing_output_is_named() -> None:
    """A bit of one output in one sample, and a fault word in another."""
    rows = project.replay_vectors(harness.stage("levitator_2dof"), harness.emitted("levitator_2dof"))["levitator_2dof"]
    answers = rows.copy()
    answers["out"]["i2"][7] = np.nextafter(rows["out"]["i2"][7], np.float32(9))
    answers["faults"][9] ^= 1
    outputs, faults = serial_replay._compare("step", rows, answers)
    assert outputs.value == 1 and outputs.about.startswith("i2 in sample 7: found ")
    assert faults.value == 1 and faults.about == "sample 9"


def test_the_watchdog_moves_the_outputs_to_the_safe_ones(tmp_path: Path) -> None:
    """Once no sample has come since its last call, at the declared slew; three missed samples were counted before."""
    folder = test_mcu.export("levitator_2dof", tmp_path)
    (folder / "watch.c").write_text((Path(__file__).parent / "watch.c").read_text())
    command = [*harness.compiler().split(), "-std=c99", "-O1", "-ffp-contract=off", "-Isrc", "-Icontroller"]
    files = ["watch.c", "src/loop.c", "controller/levitator_2dof.c", "-lm", "-o", "watch"]
    subprocess.run([*command, *files], cwd=folder, check=True)
    lines = subprocess.run(["./watch"], cwd=folder, check=True, capture_output=True, text=True).stdout.splitlines()
    before, missed, current = lines[0].split()
    assert (before, missed) == ("0", "3") and abs(float(current)) > 1
    values = [float(current), *(float(line.split()[1]) for line in lines[1:9])]
    assert all(line.startswith("1 ") for line in lines[1:9]) and values[-1] == 0
    assert 0.49 < np.abs(np.diff(values)).max() <= 0.5 + 1e-6, "10 samples of 0.5 ms at 100 A/s"
    assert lines[9] == "0 latched", "a late sample writes nothing"


@tools.needs("gcc", shows="that noise on the line neither stops the handler nor leads it beyond its memory")
def test_the_handler_survives_noise(tmp_path: Path) -> None:
    folder = test_mcu.export("levitator_2dof", tmp_path)
    (folder / "noise.c").write_text((Path(__file__).parent / "noise.c").read_text())
    files = ["noise.c", *(f"src/{n}.c" for n in ("serial", "selftest", "vectors", "crc", "loop"))]
    command = [
        "gcc",
        "-std=c99",
        "-O1",
        "-fsanitize=address,undefined",
        "-fno-sanitize-recover",
        "-Isrc",
        "-Icontroller",
    ]
    subprocess.run([*command, *files, "controller/levitator_2dof.c", "-lm", "-o", "noise"], cwd=folder, check=True)
    done = subprocess.run(["./noise"], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.startswith("0 wrong of "), done.stdout + done.stderr[-2000:]
