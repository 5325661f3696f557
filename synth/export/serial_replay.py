"""The vectors over a serial line: a board computes each sample, and what it answers is compared bit for bit.

The frames are those of `serial.h` in a project for a microcontroller. A line is a path of Linux or macOS, a terminal at
8 bits without parity or a pseudo-terminal.
"""

import os
import select
import struct
import time
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from synth.base.progress import Progress
from synth.check import Check
from synth.errors import SignalError, SynthError
from synth.execute import host

SYNC = b"\x5a\xc3"
VERSION = 1
HELLO = 16  # bytes of the answer to it before the name
REASONS = {1: "a wrong checksum", 2: "a wrong length", 3: "an unknown kind", 4: "a step that it does not have"}
REBUILD = "build the image from a new `synth export NAME --target mcu`"


class Hello(NamedTuple):
    """What a board says of itself: its stage, the checksum of its flash, and whether its self-test failed."""

    name: str
    flash: int
    failed: bool
    period_ns: int
    instructions: int
    steps: int


@dataclass(frozen=True)
class Line:
    """An open serial line that never blocks; a frame and its answer take at most `timeout_s`, seconds, together."""

    path: str
    fd: int
    timeout_s: float

    def ask(self, kind: bytes, content: bytes = b"") -> bytes:
        """Send a frame and return the content of the answer to it.

        Raises SynthError where none comes, where it is damaged, and where the board refuses the frame.
        """
        end = time.monotonic() + self.timeout_s
        self._write(frame(kind, content), end)
        head = self._read(5, end)
        if head[:2] != SYNC:
            raise SynthError(f"{self.path}: found {head.hex(' ')}, a frame begins with {SYNC.hex(' ')}: {self._mend}")
        answer, size = head[2:3], int.from_bytes(head[3:], "little")
        rest = self._read(size + 4, end)
        checksum, needed = zlib.crc32(head[2:] + rest[:-4]), int.from_bytes(rest[-4:], "little")
        if checksum != needed:
            raise SynthError(
                f"{self.path}: found a frame with checksum {checksum:#010x}, needs {needed:#010x}: {self._mend}"
            )
        if answer == b"E":
            reason = REASONS.get(rest[0] if size else 0, f"reason '{rest[:-4].hex(' ')}'")
            raise SynthError(f"{self.path}: the board found {reason} in frame {kind!r}: {self._mend}, or {REBUILD}")
        if answer != kind:
            raise SynthError(f"{self.path}: found an answer {answer!r} to {kind!r}, need the same: {REBUILD}")
        return rest[:-4]

    @property
    def _mend(self) -> str:
        return "look at the rate (--baud), the wiring and the ground"

    def _read(self, size: int, end: float) -> bytes:
        content = b""
        while len(content) < size:
            if not select.select([self.fd], [], [], max(0.0, end - time.monotonic()))[0]:
                raise SynthError(
                    f"{self.path}: found {len(content)} bytes in {self.timeout_s:g} s, need {size}: no board answers; "
                    "see that it runs serial_receive, and look at the port, the rate (--baud) and the wiring"
                )
            content += self._receive(size - len(content))
        return content

    def _receive(self, size: int) -> bytes:
        """Return bytes that are there: a line that is readable and has none was unplugged."""
        with suppress(OSError):
            if content := os.read(self.fd, size):
                return content
        raise self._end_of_line()

    def _write(self, content: bytes, end: float) -> None:
        while content:
            if not select.select([], [self.fd], [], max(0.0, end - time.monotonic()))[1]:
                raise SynthError(
                    f"{self.path}: found no room for {len(content)} bytes in {self.timeout_s:g} s, need it: "
                    "look at the port, and turn its flow control off"
                )
            try:
                content = content[os.write(self.fd, content) :]
            except OSError as error:
                raise self._end_of_line() from error

    def _end_of_line(self) -> SynthError:
        return SynthError(f"{self.path}: found the end of the line, need an answer: plug the board in, and try again")

    def drain(self) -> None:
        """End a frame that the board may be in the middle of, and drop what it answers.

        Raises SynthError for a line that does not fall silent.
        """
        end = time.monotonic() + self.timeout_s
        self._write(bytes(1024), end)
        while select.select([self.fd], [], [], 0.1)[0]:
            self._receive(4096)
            if time.monotonic() > end:
                raise SynthError(
                    f"{self.path}: found bytes without an end for {self.timeout_s:g} s, need a board that speaks when "
                    "it is asked: see that it runs serial_receive and prints nothing, and look at the rate (--baud)"
                )


def frame(kind: bytes, content: bytes = b"") -> bytes:
    """Return a frame: sync, kind (1 byte), length (2 bytes), content, CRC-32 (4 bytes)."""
    body = kind + struct.pack("<H", len(content)) + content
    return SYNC + body + struct.pack("<I", zlib.crc32(body))


@contextmanager
def connect(path: str, baud: int = 115200, timeout_s: float = 2.0) -> Iterator[Line]:
    """Open a serial line raw at a rate in bits per second. Raises SynthError for a path or a rate that is none."""
    try:
        import termios
        import tty
    except ImportError as error:
        raise SynthError(
            f"{path}: this system has no termios, which a serial line needs: use Linux or macOS"
        ) from error
    rate = getattr(termios, f"B{baud}", None)
    if rate is None:
        raise SynthError(f"{path}: found the rate {baud}, need one of the system's, such as 115200: give --baud")
    try:
        fd = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    except OSError as error:
        raise SynthError(
            f"{path}: {error.strerror}, need a serial line: give its path, and the right to use it"
        ) from error
    try:
        if not os.isatty(fd):
            raise SynthError(f"{path}: found no terminal, need a serial line: give its path, such as /dev/ttyACM0")
        try:
            tty.setraw(fd)
            settings = termios.tcgetattr(fd)
            settings[4:6] = [rate, rate]
            termios.tcsetattr(fd, termios.TCSANOW, settings)
        except termios.error as error:
            raise SynthError(
                f"{path}: {error.args[-1]}, need a line that takes {baud} bits per second: give --baud, or plug it in"
            ) from error
        line = Line(path, fd, timeout_s)
        line.drain()
        yield line
    finally:
        os.close(fd)


def hello(line: Line) -> Hello:
    """Return what the board says of itself; raise SynthError for an echo and for another version of the frames."""
    content = line.ask(b"H")
    if len(content) <= HELLO:
        raise SynthError(
            f"{line.path}: found a hello of {len(content)} bytes, need {HELLO} and a name: see that the line does not "
            f"echo, and {REBUILD}"
        )
    if content[0] != VERSION:
        raise SynthError(f"{line.path}: found frames of version {content[0]}, need {VERSION}: {REBUILD}")
    flash, period_ns, instructions = struct.unpack("<III", content[4:HELLO])
    return Hello(
        content[HELLO:].decode(errors="backslashreplace"), flash, content[2] != 0, period_ns, instructions, content[1]
    )


def replay(line: Line, name: str, vectors: Mapping[str, host.Records], say: Progress) -> tuple[list[Check], str]:
    """Replay the vectors of a stage's steps, in the order of a sample; return the checks and a note on the cycles.

    Raises SignalError for the board of another stage, SynthError as `Line.ask`.
    """
    board = hello(line)
    if board.name != name or board.steps != len(vectors):
        raise SignalError(
            f"{line.path}: found '{board.name}' with {board.steps} steps, need '{name}' with {len(vectors)}: {REBUILD}"
        )
    checks = [Check("self-test at boot", float(board.failed), 0, "failed", f"flash {board.flash:#010x}")]
    most = 0
    for k, (step, rows) in enumerate(vectors.items()):
        say(f"{step}: {len(rows)} samples over {line.path}")
        answers = _answers(line, k, rows)
        most += int(answers["cycles"].max(initial=0))
        checks += _compare(step, rows, answers)
    counted = f"up to {most} cycles by DWT" if most else "the core counts no cycles"
    return checks, f"{counted}; up to {board.instructions} instructions, which are no cycles, in the simulation"


def _answers(line: Line, k: int, rows: host.Records) -> host.Records:
    """Return what the board makes of inputs, (N,) records of `faults`, `cycles`, `out`."""
    answer = np.dtype([("faults", "<u4"), ("cycles", "<u4"), ("out", rows.dtype["out"])])
    line.ask(b"I", bytes([k]))
    parts = [line.ask(b"S", bytes([k, 0, 0, 0]) + row["in"].tobytes()) for row in rows]
    if wrong := {len(part) for part in parts} - {answer.itemsize}:
        raise SynthError(f"{line.path}: found answers of {wrong.pop()} bytes, need {answer.itemsize}: {REBUILD}")
    return np.frombuffer(b"".join(parts), answer)


def _compare(step: str, rows: host.Records, answers: host.Records) -> list[Check]:
    """Return the checks that fault words and outputs are those of the vectors, bit for bit."""
    word = f"<u{rows.dtype['out'][0].itemsize}"
    names = rows.dtype["out"].names or ()
    first, differing = "", 0
    for name in names:
        answered, needed = (np.ascontiguousarray(r["out"][name]) for r in (answers, rows))
        at = np.flatnonzero(answered.view(word) != needed.view(word))
        differing += len(at)
        if len(at) and not first:
            first = f"{name} in sample {at[0]}: found {answered[at[0]]!s}, needs {needed[at[0]]!s}"
    faults = np.flatnonzero(answers["faults"] != rows["faults"])
    about = f"sample {faults[0]}" if len(faults) else f"{len(rows)} samples"
    return [
        Check(f"{step}: outputs that differ", differing, 0, "values", first or f"{len(rows)} samples"),
        Check(f"{step}: fault words that differ", len(faults), 0, "samples", about),
    ]
