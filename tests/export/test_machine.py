"""The state machine in real time: start, stop, and every way to lose the loop, its sensors, its disk or its client."""

import contextlib
import mmap
import os
import platform
import re
import resource
import signal
import socket
import struct
import subprocess
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from synth.execute import compile as host_compiler
from synth.export import records
from tests import tools
from tests.export import harness

pytestmark = pytest.mark.slow

STALL = ("--stall", "5000")  # ms: a busy machine stands still for some hundred
MAGIC, HEADER = 0x53544732, 6  # of shared memory: its first word, and the words before the sensors
PLANT = ("--io", "plant", *STALL)


class Memory:
    """The partner behind `--io shm`: sensors at rest, what the loop gives, and a heartbeat until it dies."""

    def __init__(self, path: Path, sensors: int = 2, outputs: int = 2) -> None:
        self.sensors, self.count = sensors, outputs
        path.write_bytes(struct.pack("3Q", MAGIC, sensors, outputs) + bytes(8 * (HEADER - 3 + sensors + outputs)))
        self.file = path.open("r+b")
        self.words = mmap.mmap(self.file.fileno(), 0)
        self.dead = threading.Event()
        self.thread = threading.Thread(target=self.live, daemon=True)
        self.thread.start()

    def live(self) -> None:
        beats = 0
        while not self.dead.wait(0.005):
            beats += 1
            struct.pack_into("Q", self.words, 8 * 5, beats)

    def die(self) -> None:
        self.dead.set()
        self.thread.join()

    def sense(self, *values: float) -> None:
        struct.pack_into(f"{self.sensors}d", self.words, 8 * HEADER, *values)

    @property
    def outputs(self) -> tuple[float, ...]:
        return struct.unpack_from(f"{self.count}d", self.words, 8 * (HEADER + self.sensors))

    @property
    def enabled(self) -> int:
        return int(struct.unpack_from("Q", self.words, 8 * 3)[0])

    def wait_safe(self) -> None:
        end = time.monotonic() + 20
        while (self.enabled or self.outputs != (0.0, 0.0)) and time.monotonic() < end:
            time.sleep(0.01)
        assert not self.enabled and self.outputs == (0.0, 0.0)


@pytest.fixture
def memory(loop: Path) -> Iterator[Memory]:
    memory = Memory(loop / "io")
    yield memory
    memory.die()


SHM = ("--io", "shm", "--memory", "io", *STALL)


def test_a_rehearsal_lifts_off_moves_and_sets_down(loop: Path) -> None:
    done = harness.call(loop, *PLANT, "--seconds", "2", "--motion", "sine z_ref 1e-4 10 3", "--record", "run.csv")
    assert done.returncode == 0, done.stderr
    for phase in ("enabling", "starting", "running", "disabled: the run is over"):
        assert f"levitator_2dof: {phase}\n" in done.stderr
    log = records.read(loop / "run.csv")
    z, phase = log.samples["z"], log.samples["phase"]
    assert z[0] < -5.9e-4 and abs(z[phase == 3][-1]) < 1e-6, "from its stop to the middle"
    assert z[phase == 3].max() > 0.9e-4, "the sine"
    assert log.samples["i1"][-1] == 0.0 and phase[-1] == 7.0
    assert records.units(loop / "run.csv")["i1"] == "A"


def test_missed_periods_are_counted_and_the_rest_is_in_the_histogram(loop: Path) -> None:
    done = harness.call(loop, *PLANT, "--seconds", "1")
    samples = int(done.stderr.rsplit("levitator_2dof: ", 1)[1].split()[0])
    missed = int(done.stderr.split(" samples, ")[1].split()[0])
    bins = sum(int(line.rsplit(": ", 1)[1]) for line in done.stderr.splitlines() if line.startswith("  late by"))
    assert bins == samples and samples + missed >= 2000


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGQUIT, signal.SIGTSTP])
def test_a_signal_makes_the_outputs_safe_and_ends(number: int, loop: Path, memory: Memory) -> None:
    with harness.running(loop, *SHM) as running:
        running.wait("phase=running")
        assert memory.enabled
        os.killpg(running.process.pid, number)  # as a terminal does
        assert running.end() == 0
    memory.wait_safe()
    assert "disabled: the process was asked to end" in running.log


def test_a_killed_loop_is_made_safe_by_the_watchdog(loop: Path, memory: Memory) -> None:
    with harness.running(loop, *SHM) as running:
        memory.sense(1e-4, 0.0)
        running.wait("phase=running")
        running.wait("i1=-", "position")
        assert memory.outputs[0] != 0.0
        if "SCHED_FIFO" not in running.log:
            watchdog, child = (os.sched_getparam(p).sched_priority for p in (running.process.pid, running.child))
            assert watchdog > child > 0, "a loop that never sleeps must not keep it from its processor"
        os.kill(running.child, signal.SIGKILL)
        assert running.end() == 3
    memory.wait_safe()
    assert "watchdog: the loop died of signal 9" in running.log and "the outputs are safe" in running.log


def test_a_log_whose_reader_is_gone_ends_nobody(loop: Path, memory: Memory) -> None:
    reader, writer = os.pipe()
    with harness.running(loop, *SHM, output=writer) as running:
        os.close(writer)
        running.wait("phase=running")
        os.close(reader)
        assert running.ask("stop") == "ok"
        running.wait("phase=disabled")
        running.process.terminate()
        assert running.end() == 0
    memory.wait_safe()


@pytest.mark.parametrize("kind", ["pipe", "socket"])
def test_a_log_that_nobody_reads_does_not_delay_the_safe_outputs(kind: str, loop: Path, memory: Memory) -> None:
    """What it does not take is lost. Where it blocks all the same, the watchdog's words come last."""
    reader, writer = [s.detach() for s in socket.socketpair()] if kind == "socket" else os.pipe()
    os.set_blocking(writer, False)
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(writer, bytes(100))
    os.set_blocking(writer, True)
    memory.sense(1e-4, 0.0)
    with harness.running(loop, *SHM, output=writer) as running:
        running.wait("phase=running")
        assert memory.enabled and memory.outputs[0] != 0.0
        os.set_blocking(writer, True)
        os.kill(running.child, signal.SIGKILL)
        memory.wait_safe()
        if kind == "socket":
            running.process.kill()
        assert running.end() == (-9 if kind == "socket" else 3)
    os.close(reader)
    os.close(writer)


USER = """#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "channels.h"
static int file, reads;
int user_open(const channels_t *channels)
{
    (void)channels;
    file = open("outputs", O_RDWR | O_CREAT, 0600);
    return 0;
}
int user_read(const channels_t *channels, double raw[])
{
    (void)channels;
    raw[0] = 1.5; /* V, 0.1 mm */
    raw[1] = 0.0;
    if (++reads == 2000 && getenv("LEAVE")) exit(1);
    return 0;
}
int user_write(const channels_t *channels, const double raw[], int enabled)
{
    const double words[3] = {raw[0], raw[1], enabled};
    (void)channels;
    if (reads > 2000 && getenv("FAIL_WRITES")) return -1;
    return pwrite(file, words, sizeof words, 0) > 0 ? 0 : -1;
}
void user_close(void) { }
"""


def test_hardware_that_ends_the_process_or_takes_no_outputs_is_not_trusted(
    loop: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = harness.export("levitator_2dof", loop / "own")
    (folder / "io_user.c").write_text(USER)
    harness.build(folder)
    words = ("--io", "user", *STALL, "--seconds", "3")
    monkeypatch.setenv("LEAVE", "1")
    left = harness.call(folder, *words)
    assert left.returncode == 3 and "watchdog: the loop left its run with exit status 1" in left.stderr
    assert "watchdog: the outputs are safe" in left.stderr
    assert struct.unpack("3d", (folder / "outputs").read_bytes()) == (0.0, 0.0, 0.0)
    monkeypatch.delenv("LEAVE")
    monkeypatch.setenv("FAIL_WRITES", "1")
    failed = harness.call(folder, *words)
    assert failed.returncode == 1
    assert "the last outputs could not be written: the outputs are NOT SAFE: cut the power" in failed.stderr
    assert "disabled: the hardware could not be written: the outputs may be NOT SAFE" in failed.stderr
    assert struct.unpack("3d", (folder / "outputs").read_bytes())[2] == 1.0, "as the message says"


def test_a_loop_that_stands_still_is_killed_and_made_safe(loop: Path, memory: Memory) -> None:
    with harness.running(loop, *SHM, "--stall", "1000") as running:
        running.wait("phase=running")
        child = running.child
        os.kill(child, signal.SIGSTOP)
        assert running.end() == 3
    memory.wait_safe()
    assert "has stood still for 1000 ms and is killed" in running.log
    assert not Path(f"/proc/{child}").exists()


def test_a_loop_without_its_watchdog_stops(loop: Path, memory: Memory) -> None:
    with harness.running(loop, *SHM) as running:
        running.wait("phase=running")
        child = running.child
        running.process.kill()
        memory.wait_safe()
        end = time.monotonic() + 20
        while Path(f"/proc/{child}").exists() and time.monotonic() < end:
            time.sleep(0.01)
    assert "the process was asked to end" in running.log


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), 1.0])
def test_bad_sensors_latch_and_only_a_start_at_rest_goes_on(bad: float, loop: Path, memory: Memory) -> None:
    with harness.running(loop, *SHM) as running:
        running.wait("phase=running")
        memory.sense(bad, 0.0)
        status = running.wait("phase=disabled")
        assert "latched_by=0x80000001 (z, latched)" in status and "reason=the controller latched" in status
        memory.wait_safe()
        assert "a start needs a disabled machine at rest" in running.ask("start")  # the sensor is still bad
        memory.sense(0.0, 0.0)
        time.sleep(0.5)
        assert running.ask("start") == "ok"
        running.wait("phase=running")


def test_it_waits_for_good_sensors(loop: Path, memory: Memory) -> None:
    memory.sense(float("nan"), 0.0)
    with harness.running(loop, *SHM) as running:
        running.wait("phase=waiting")
        time.sleep(0.5)
        assert "phase=waiting" in running.ask("status") and not memory.enabled
        memory.sense(0.0, 0.0)
        running.wait("phase=running")


def test_a_partner_that_dies_latches_and_one_that_never_lived_starts_nothing(loop: Path, memory: Memory) -> None:
    with harness.running(loop, *SHM) as running:
        running.wait("phase=running")
        memory.die()
        assert "latched_by=0x80000003 (z, x, latched)" in running.wait("phase=disabled")
        memory.wait_safe()
    for file in ("io", "new"):
        with harness.running(loop, "--io", "shm", "--memory", file, *STALL) as running:
            running.wait("phase=waiting")
            time.sleep(1)
            assert "phase=waiting" in running.ask("status") and "z=nan" in running.ask("position")


def test_the_set_points_start_at_the_measured_pose(loop: Path, memory: Memory) -> None:
    """And travel from there to where the machine works, which takes time."""
    memory.sense(-3e-4, 5e-4)
    done = harness.call(loop, *SHM, "--seconds", "1", "--record", "run.csv")
    rows = (loop / "run.csv").read_text().splitlines(keepends=True)
    (loop / "run.csv").write_text("".join(row for row in rows if "nan" not in row))  # before the first heartbeat
    log = records.read(loop / "run.csv")
    enabled = log.samples["phase"] == 1
    assert log.samples["z_ref"][enabled][-1] == pytest.approx(-3e-4) and done.returncode == 0
    assert log.samples["x_ref"][enabled][-1] == pytest.approx(5e-4)
    assert log.samples["z_ref"][log.samples["phase"] == 3][-1] == 0.0


def test_a_second_instance_is_refused(loop: Path) -> None:
    with harness.running(loop, *PLANT) as running:
        running.wait("phase=running")
        second = harness.call(loop, *PLANT)
        assert second.returncode == 2 and "another instance drives the machine: stop it first" in second.stderr
        assert "phase=running" in running.ask("status")


def test_a_full_disk_makes_the_outputs_safe(loop: Path, memory: Memory) -> None:
    with harness.running(loop, *SHM) as running:
        running.wait("phase=running")
        assert running.ask("record /dev/full") == "ok"
        assert running.end() == 1
    memory.wait_safe()
    assert "disabled: the recording could not be written" in running.log
    assert dropped(running.log) > 0


def dropped(log: str) -> int:
    match = re.search(r"(\d+) records dropped", log)
    assert match, log
    return int(match[1])


def test_a_lost_record_is_named_at_the_end(loop: Path) -> None:
    done = harness.call(loop, "--lockstep", "10", "--record", "/dev/full")
    assert done.returncode == 1
    assert "the recording could not be written: No space left on device: its end is lost" in done.stderr


def test_a_disk_that_fills_up_makes_the_outputs_safe(loop: Path) -> None:
    limit = resource.prlimit(0, resource.RLIMIT_FSIZE)
    with harness.running(loop, *PLANT) as running:
        running.wait("phase=running")
        resource.prlimit(running.child, resource.RLIMIT_FSIZE, (20_000, limit[1]))
        assert running.ask("record run.csv") == "ok"
        assert running.end() == 1
    assert dropped(running.log) > 0
    assert "the recording could not be written" in running.log


def test_a_disk_that_stops_drops_records_and_not_samples(loop: Path) -> None:
    """A pipe that nobody empties stands for it."""
    os.mkfifo(loop / "pipe")
    reader = os.open(loop / "pipe", os.O_RDONLY | os.O_NONBLOCK)
    with harness.running(loop, *PLANT) as running:
        running.wait("phase=running")
        assert running.ask("record pipe") == "ok"
        end = time.monotonic() + 60
        while "dropped=0 " in (status := running.ask("status")) and time.monotonic() < end:
            time.sleep(0.1)
        lost = int(status.split("dropped=")[1].split()[0])
        assert lost > 0 and "phase=running" in status
        assert running.ask("record stop") == "error: the disk does not answer: the record is not closed yet"
        running.process.terminate()
        assert running.end() == 0
    os.close(reader)
    assert dropped(running.log) > lost + 4000, "and what is left in the ring"
    assert "the disk does not answer: the end of the record is lost" in running.log
    assert "disabled: the process was asked to end" in running.log and "watchdog" not in running.log


def test_a_supervising_client_that_dies_stops_the_machine(loop: Path, memory: Memory) -> None:
    with harness.running(loop, *SHM) as running:
        running.wait("phase=running")
        other = running.connect()
        harness.ask(other, "status")
        other.close()
        time.sleep(0.2)
        assert "phase=running" in running.ask("status"), "any other client may leave"
        supervisor = running.connect()
        assert harness.ask(supervisor, "supervise") == "ok"
        supervisor.close()
        running.wait("reason=the supervising client is gone")
        memory.wait_safe()


def test_missed_periods_stop_the_machine_where_that_is_asked_for(loop: Path, memory: Memory) -> None:
    with harness.running(loop, *SHM, "--late", "safe:400") as running:
        running.wait("phase=running")
        os.kill(running.child, signal.SIGSTOP)
        time.sleep(0.5)
        os.kill(running.child, signal.SIGCONT)
        status = running.wait("phase=disabled")
        assert "reason=too many periods were missed in a row" in status
        assert int(status.split("missed=")[1].split()[0]) >= 400
        memory.wait_safe()


def test_a_client_program_prints_the_answer(loop: Path) -> None:
    with harness.running(loop, *PLANT) as running:
        running.wait("phase=running")
        ask = [str(loop / "client"), "levitator_2dof.sock"]
        done = subprocess.run([*ask, "status"], cwd=loop, capture_output=True, text=True)
        assert done.returncode == 0 and done.stdout.startswith("ok phase=running")
        refused = subprocess.run([*ask, "move", "z_ref", "1"], cwd=loop, capture_output=True, text=True)
        assert refused.returncode == 1 and "at most 0.0005 is possible: make it smaller" in refused.stdout
    assert subprocess.run([*ask, "status"], cwd=loop, capture_output=True).returncode == 2


@tools.needs("cc", shows="that the loop allocates nothing")
@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="needs glibc: would show that nothing allocates")
@pytest.mark.parametrize("planted", [False, True])
def test_nothing_is_allocated_once_the_loop_runs(planted: bool, built: Path, loop: Path) -> None:
    shim = host_compiler.shared_library({"malloc.c": Path(__file__).with_name("malloc.c").read_text()})
    folder = built
    if planted:
        folder = harness.export("levitator_2dof", loop / "planted")
        main = folder / "src" / "realtime.c"
        marked = "    int bin = 0;\n"
        text = main.read_text()
        assert marked in text
        main.write_text(text.replace(marked, marked + "    void *volatile p = strdup(STAGE_NAME);\n    (void)p;\n", 1))
        harness.build(folder)
    command = [str(folder / "levitator_2dof"), "--run", ".", *PLANT, "--seconds", "1", "--record", "run.csv"]
    environment = {**os.environ, "LD_PRELOAD": str(shim)}
    done = subprocess.run(command, cwd=loop, env=environment, capture_output=True, text=True)
    assert done.returncode == 0 and ("the loop allocates" in done.stderr) == planted, done.stderr[-500:]


def test_other_vectors_are_seen(loop: Path) -> None:
    data = bytearray((loop / "vectors" / "levitator_2dof.bin").read_bytes())
    data[17] ^= 1  # the last but two bits of an output
    (loop / "other").mkdir()
    (loop / "other" / "levitator_2dof.bin").write_bytes(data)
    done = harness.call(loop, "--replay", "other")
    assert done.returncode == 1 and "1 of 1000 samples differ" in done.stdout
    assert harness.call(loop, "--replay", "nowhere").returncode == 1


@pytest.mark.whole
def test_a_machine_in_flight_keeps_the_safe_output_that_lowers_it(tmp_path: Path) -> None:
    """Without current its magnets would pull it up; on its stop it needs none."""
    name, lying, flying = "maglev_5dof", (0.031,) * 4 + (0.0, 0.0), (0.025,) * 4 + (0.0, 0.0)
    harness.build(harness.export(name, tmp_path))
    memory = Memory(tmp_path / "io", 6, 12)
    memory.sense(*lying)
    with harness.running(tmp_path, *SHM, name=name) as running:
        running.wait("phase=starting")
        memory.sense(*(float("nan"),) * 3, *flying[3:])
        running.wait("phase=latched")
        time.sleep(3)
        assert "phase=latched" in running.ask("status") and memory.enabled
        amplitude = max(map(abs, memory.outputs))
        assert 0.8 * 2.5 * 2**0.5 < amplitude < 1.01 * 2.5 * 2**0.5, "2.5 A rms"
        memory.sense(*lying)
        running.wait("phase=disabled")
        assert not memory.enabled


@pytest.mark.whole
def test_a_process_that_ends_in_flight_leaves_the_safe_output_on(tmp_path: Path) -> None:
    name = "maglev_5dof"
    harness.build(harness.export(name, tmp_path))
    memory = Memory(tmp_path / "io", 6, 12)
    memory.sense(*(0.031,) * 4, 0.0, 0.0)
    with harness.running(tmp_path, *SHM, name=name) as running:
        running.wait("phase=starting")
        memory.sense(*(float("nan"),) * 3, 0.025, 0.0, 0.0)
        running.wait("phase=latched")
        running.process.terminate()
        assert running.end() == 1
    assert memory.enabled and max(map(abs, memory.outputs)) > 2.5
    assert "the amplifiers stay on, with the safe output" in running.log
