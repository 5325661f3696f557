"""What the tests of exported projects share: a project of each design, its build, its processes and its commands."""

import json
import os
import shlex
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from synth.app import workspace
from synth.base import store
from synth.declare.stage import Stage
from synth.emit.write import EmittedCode
from synth.execute import compile as host_compiler
from synth.export import project

ROOT = Path(__file__).parents[2]
PATIENT = "-O2 -DSILENCE_S=2.0"  # a partner in shared memory that is a thread of Python, on a busy machine


@cache
def stage(name: str) -> Stage:
    return workspace.designs(ROOT, [name])[0]


@cache
def emitted(name: str) -> Mapping[str, EmittedCode]:
    """Return the committed C of a design by folder, which other tests hold against its emission."""
    folders = {name, *(block.name for block in (stage(name).drive.blocks if stage(name).drive else ()))}
    codes = {}
    for folder in folders:
        files = {p.name: p.read_text(encoding="utf-8") for p in (ROOT / "generated_c" / folder).iterdir()}
        codes[folder] = EmittedCode(files, json.loads(files["manifest.json"]))
    return codes


def export(name: str, folder: Path) -> Path:
    project.project(stage(name), emitted(name), "linux").save(folder)
    return folder


def compiler(name: str = "") -> str:
    """Return the command of a compiler for make: the host's own, or one by name."""
    chosen = host_compiler.find_compiler() if not name else host_compiler.zig_compiler() if name == "zig" else None
    return shlex.join([*chosen.command, *chosen.machine_flags]) if chosen else name


def build(folder: Path, cc: str = "", flags: str = PATIENT, link: str = "") -> str:
    """Build a project; return what make prints."""
    if sys.platform != "linux":
        pytest.skip("the project is for Linux: would show that its loop runs")
    return make(folder, f"CC={cc or compiler()}", f"CFLAGS={flags}", f"LDFLAGS={link}")


def make(folder: Path, *words: str) -> str:
    """Run make in a project, as a user does: nothing of a make that runs the tests; return what it prints."""
    environment = {**outside_make(), "ZIG_GLOBAL_CACHE_DIR": zig()}
    done = subprocess.run(["make", *words], cwd=folder, capture_output=True, text=True, env=environment, timeout=1800)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-4000:]
    return done.stdout + done.stderr


def outside_make() -> dict[str, str]:
    """Return the environment without that of a make that runs the tests, which warns within it."""
    return {k: v for k, v in os.environ.items() if k not in ("MAKEFLAGS", "MAKELEVEL", "MFLAGS")}


def zig() -> str:
    return os.environ.get("ZIG_GLOBAL_CACHE_DIR") or str(store.folder() / "zig")


def call(folder: Path, *words: str, name: str = "levitator_2dof") -> subprocess.CompletedProcess[str]:
    """Run the loop of a project to its end."""
    command = [f"./{name}", "--run", ".", *words]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300)


@contextmanager
def running(folder: Path, *words: str, name: str = "levitator_2dof", output: int | None = None) -> Iterator["Loop"]:
    """Start the loop of a project in a folder and a group of processes; end it afterwards."""
    log = (folder / "log.txt").open("w+")
    out = log if output is None else output
    command = [f"./{name}", "--run", ".", *words]
    process = subprocess.Popen(command, cwd=folder, stderr=out, stdout=out, process_group=0)
    loop = Loop(process, folder, name)
    try:
        yield loop
    finally:
        for number in (signal.SIGTERM, signal.SIGKILL):
            with suppress(subprocess.TimeoutExpired, ProcessLookupError):
                process.send_signal(number)
                process.wait(10)
                break
        log.close()


class Loop:
    """A running loop: its processes, its log and its socket."""

    def __init__(self, process: subprocess.Popen[bytes], folder: Path, name: str) -> None:
        self.process, self.folder, self.name = process, folder, name

    @property
    def log(self) -> str:
        return (self.folder / "log.txt").read_text()

    @property
    def child(self) -> int:
        """The process of the loop, whose parent is the watchdog."""
        return int(Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children").read_text().split()[0])

    def connect(self) -> socket.socket:
        """Return a connection; paths of sockets are short, so it is named from its folder."""
        connection = socket.socket(socket.AF_UNIX)
        fd = os.open(self.folder, os.O_PATH)
        try:
            connection.connect(f"/proc/self/fd/{fd}/{self.name}.sock")
        finally:
            os.close(fd)
        connection.settimeout(30)
        return connection

    def ask(self, line: str) -> str:
        with self.connect() as connection:
            return ask(connection, line)

    def wait(self, fragment: str, command: str = "status", seconds: float = 60) -> str:
        """Ask until the answer has a fragment."""
        end, answer = time.monotonic() + seconds, ""
        while time.monotonic() < end:
            with suppress(OSError):
                answer = self.ask(command)
                if fragment in answer:
                    return answer
            assert self.process.poll() is None, self.log
            time.sleep(0.02)
        raise AssertionError(f"no {fragment} in {answer}; {self.log}")

    def end(self, seconds: float = 60) -> int:
        return self.process.wait(seconds)


def ask(connection: socket.socket, line: str) -> str:
    connection.sendall(line.encode() + b"\n")
    answer = b""
    while not answer.endswith(b"\n"):
        more = connection.recv(65536)
        assert more, f"no answer to {line}"
        answer += more
    return answer.decode().rstrip("\n")


def normals(seed: int, n: int) -> np.ndarray:
    """Return n numbers of the generator of io_plant.c, (n,)."""
    with np.errstate(over="ignore"):
        steps = np.arange(1, 3 * n + 1, dtype=np.uint64)
        z = np.uint64(seed) + steps * np.uint64(0x9E3779B97F4A7C15)
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        z ^= z >> np.uint64(31)
    words = sum((z >> np.uint64(16 * k)) & np.uint64(0xFFFF) for k in range(4))
    return np.asarray(words, dtype=np.float64).reshape(n, 3).sum(axis=1) / 65536.0 - 6.0
