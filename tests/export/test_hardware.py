"""The user's I/O through channels.toml, and Comedi against a stand-in for its library: scaling, limits, messages."""

import ctypes
import mmap
import os
import re
import resource
import shutil
import struct
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import pytest

from synth.execute import compile as host_compiler
from synth.export import records
from tests.export import harness

pytestmark = pytest.mark.slow

CHANNELS = """device = "present"  # a comment
[enable]
channel = 3
[sensor.z]
channel = 1
scale = 1e-4
offset = -2e-4
sign = 1
[sensor.x]
channel = 0
scale = 1e-4
sign = -1
[actuator.i1]
channel = 1
scale = 0.1
offset = 0.05
[actuator.i2]
channel = 0
scale = 1e-3
sign = -1
low = -1
high = 1
"""
RAW = """#include <stdio.h>
#include "channels.h"
static int k;
int user_open(const channels_t *channels) { (void)channels; return 0; }
int user_read(const channels_t *channels, double raw[])
{
    (void)channels;
    raw[0] = (double)((k++ * 100) % 65536);
    raw[1] = 0.0;
    return 0;
}
int user_write(const channels_t *channels, const double raw[], int enabled)
{
    (void)channels;
    (void)enabled;
    return printf("%.9g %.9g\\n", raw[0], raw[1]) > 0 ? 0 : -1;
}
void user_close(void) { }
"""


@pytest.fixture
def comedi(loop: Path) -> Path:
    """A folder with the stand-in and its channels."""
    source = Path(__file__).with_name("comedi.c").read_text()
    (loop / "comedi.so").symlink_to(host_compiler.shared_library({"comedi.c": source}, ["-D_DEFAULT_SOURCE"]))
    (loop / "channels.toml").unlink()
    (loop / "channels.toml").write_text(CHANNELS)
    return loop


COMEDI = ("--io", "comedi", "--comedi", "./comedi.so", "--seconds", "1", "--stall", "5000", "--record", "run.csv")


def test_comedi_reads_and_writes_volts_through_the_channels(comedi: Path) -> None:
    done = harness.call(comedi, *COMEDI)
    assert done.returncode == 0, done.stderr
    log = records.read(comedi / "run.csv")
    count = 20 / 65535  # V
    np.testing.assert_allclose(log.samples["z"], 1e-4 * 2.0 - 2e-4, atol=1e-4 * count)
    np.testing.assert_allclose(log.samples["x"], -1e-4 * 1.0, atol=1e-4 * count)
    lines = (comedi / "comedi.log").read_text().splitlines()
    volts = [float(line.split()[3]) for line in lines if line.startswith("write 2 1 ")]
    np.testing.assert_allclose(volts, (log.samples["i1"] - 0.05) / 0.1, atol=count)
    assert "line 4 3 1" in lines and lines[2] == lines[-1] == "line 4 3 0", (
        "not enabled before the start and at the end"
    )
    limited = [float(line.split()[3]) for line in lines if line.startswith("write 2 0 ")]
    assert log.samples["i2"].max() > 1e-3 and np.min(limited) == pytest.approx(-1.0, abs=count), "its raw range"


@pytest.mark.parametrize(
    ("change", "words", "environment", "message"),
    [
        (("", ""), ("--comedi", "./absent.so"), {}, "install libcomedi, or give its path with --comedi"),
        (('"present"', '"/dev/comedi9"'), (), {}, "the device '/dev/comedi9' cannot be opened: name it in channels"),
        (("channel = 0", "channel = 9"), (), {}, "'x' of present: the board has no channel 9: correct channels.toml"),
        (("", ""), (), {"NO_OUTPUTS": "1"}, "lacks analogue inputs, analogue outputs or the line that enables"),
        (("[sensor.x]", "[sensor.y]"), (), {}, "channels.toml, line 9: sensor.y: is no sensor or actuator"),
        (("scale = 1e-4\nsign", "scale = 0\nsign"), (), {}, "line 11: scale = 0: need a number that is not 0"),
        (("sign = -1\n[act", "sign = -2\n[act"), (), {}, "line 12: sign = -2: need a sign of 1 or -1"),
        (("scale = 1e-4\noffset", "scale = nan\noffset"), (), {}, "line 6: nan: is not a finite number"),
        (("scale = 1e-4\noffset", "scale 1e-4\noffset"), (), {}, "line 6: scale 1e-4: write `key = number`"),
        (("scale = 1e-4\noffset", "size = 1e-4\noffset"), (), {}, "line 6: size: is no key: see the comment on top"),
        (("[enable]", ""), (), {}, "line 3: channel: stands before the first [section]"),
        (
            ("[actuator.i1]", "# " + 253 * "x" + "sign = -1\n[actuator.i1]"),
            (),
            {},
            "line 13: found more than 254 bytes",
        ),
        (("scale = 1e-4\noffset = -2e-4\n", ""), (), {}, "low -10, high 10, rollover 0: need a scale, in units"),
        (
            ("channel = 1\n", ""),
            (),
            {},
            "line 4: 'z' has channel -1, low -10, high 10, rollover 0: need a channel from 0",
        ),
        (("offset = -2e-4", "scale = 1e-4"), (), {}, "line 7: scale = 0.0001: is the second value of this key"),
        (("[sensor.x]", "[sensor.z]"), (), {}, "line 9: sensor.z: is here for the second time"),
        (("[enable]", 'device = "b"\n[enable]'), (), {}, "is the second device: keep one"),
        (
            ("channel = 0", "channel = 1"),
            (),
            {},
            "line 9: 'x' has channel 1, low -10, high 10, rollover 0: need a channel that no other",
        ),
        (("channel = 1", "channel = 1.5"), (), {}, "line 5: channel = 1.5: need a whole number"),
        (("offset = -2e-4", "rollover = -5"), (), {}, "line 7: rollover = -5: need a positive number"),
        (
            ("offset = -2e-4", "rollover = 65536"),
            (),
            {},
            "high 10, rollover 65536: need the first and the last raw value before",
        ),
        (("offset = -2e-4", "low = 10"), (), {}, "low 10, high 10, rollover 0: need a low below the high"),
        (("[sensor.z]", "[sensor.z"), (), {}, "line 4: [sensor.z: write `key = number`"),
        (("[sensor.x]\nchannel = 0\nscale = 1e-4\nsign = -1\n", ""), (), {}, ": x: has no section: add it"),
    ],
)
def test_what_is_missing_is_said(
    change: tuple[str, str], words: tuple[str, ...], environment: dict[str, str], message: str, comedi: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    text = (comedi / "channels.toml").read_text()
    (comedi / "channels.toml").write_text(text.replace(*change, 1))
    done = harness.call(comedi, *COMEDI, *words)
    assert done.returncode == 2 and message in done.stderr
    assert len(re.findall(r"\n", done.stderr)) == 1, "one message"


def test_dead_inputs_stop_the_machine(comedi: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DEAD_INPUTS", "1")
    done = harness.call(comedi, *COMEDI)
    assert "disabled: the hardware could not be read or written" in done.stderr


def test_a_counter_that_rolls_over_goes_on(built: Path, loop: Path) -> None:
    """The user's own I/O, built into a copy of the project."""
    folder = harness.export("levitator_2dof", loop / "own")
    (folder / "io_user.c").write_text(RAW)
    text = (folder / "channels.toml").read_text()
    z = text.index("[sensor.z]")
    cut = text.index("[sensor.x]")
    mine = "[sensor.z]\nchannel = 0\nscale = 1e-9\nlow = 0\nhigh = 65535\nrollover = 65536\n"
    (folder / "channels.toml").write_text(text[:z] + mine + text[cut:])
    assert harness.project.project(harness.stage("levitator_2dof"), harness.emitted("levitator_2dof"), "linux").save(
        folder
    ) == ["io_user.c", "channels.toml"]
    assert (folder / "io_user.c").read_text() == RAW
    harness.build(folder)
    done = harness.call(folder, "--io", "user", "--seconds", "1", "--stall", "5000", "--record", "run.csv")
    z_read = records.read(folder / "run.csv").samples["z"]
    assert len(z_read) > 656, "it rolled over"
    np.testing.assert_allclose(z_read, 1e-9 * 100 * np.arange(len(z_read)), atol=1e-10)
    assert len(done.stdout.splitlines()) == len(z_read)


def test_an_io_user_that_is_not_filled_in_says_so(loop: Path) -> None:
    done = harness.call(loop, "--io", "user")
    assert done.returncode == 2 and "fill in its four functions, and build again" in done.stderr


@pytest.mark.parametrize("content", [b"a stage." * 10, b"precious\n", bytes(8 * 10)], ids=["size", "short", "zeros"])
def test_memory_of_another_stage_is_refused_and_left_as_it_is(content: bytes, loop: Path) -> None:
    (loop / "io").write_bytes(content)
    done = harness.call(loop, "--io", "shm", "--memory", "io")
    assert done.returncode == 2 and "'io' is of another stage or of another program" in done.stderr
    assert (loop / "io").read_bytes() == content
    assert "give a file with --memory" in harness.call(loop, "--io", "shm").stderr


BEATS = """#include "io.h"
#include "stage.h"
int open_it(const char *path);
int open_it(const char *path) { return IO_SHM.open(&(io_options_t){.memory = path}); }
int read_it(double *sensors);
int read_it(double *sensors) { return IO_SHM.read(sensors); }
"""


def test_sensors_are_bad_after_ten_samples_without_a_heartbeat(built: Path, tmp_path: Path) -> None:
    """5 ms at 2 kHz; in a new file, and in one that an earlier run left, until the first heartbeat."""
    names = ("io_shm.c", "io.h", "stage.h", "levitator_2dof.h")
    files = {p.name: p.read_text() for folder in ("src", "controller") for p in (built / folder).iterdir()}
    sources = {name: files[name] for name in names} | {"beats.c": BEATS}
    backend = ctypes.CDLL(str(host_compiler.shared_library(sources, ["-D_GNU_SOURCE"])))
    sensors = (ctypes.c_double * 2)()

    def good() -> bool:
        backend.read_it(sensors)
        return list(sensors) == [1e-4, 0.0]

    for _ in range(2):
        assert backend.open_it(str(tmp_path / "new").encode()) == 0
        with (tmp_path / "new").open("r+b") as file, mmap.mmap(file.fileno(), 0) as words:
            assert not good(), "whatever it holds"
            (beats,) = struct.unpack_from("Q", words, 8 * 5)
            struct.pack_into("Q2d", words, 8 * 5, beats + 1, 1e-4, 0.0)
            assert [good() for _ in range(12)] == [True] * 10 + [False] * 2
            struct.pack_into("Q", words, 8 * 5, beats + 2)
            assert good()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--io", "labjack"), "'--io labjack' is no option with its value"),
        (("--late", "safe:0"), "'--late safe:0' is no option with its value"),
        (("--cpu", "-1"), "'--cpu -1' is no option with its value"),
        (("--lockstep", "many"), "'--lockstep many' is no option with its value"),
        (("go",), "'go ' is no option with its value"),
        (("--motion", "move z_ref 1"), "--motion 'move z_ref 1': the value of z_ref would be"),
        (("--record", "nowhere/run.csv"), "--record nowhere/run.csv: No such file or directory"),
    ],
)
def test_options_are_refused_by_name(words: tuple[str, ...], message: str, loop: Path) -> None:
    done = harness.call(loop, *words)
    assert done.returncode == 2 and message in done.stderr


def test_without_the_right_to_real_time_it_says_so_and_runs(loop: Path) -> None:
    """As an ordinary user, which root becomes, in a folder that such a user can reach."""

    def no_rights() -> None:
        resource.setrlimit(resource.RLIMIT_RTPRIO, (0, 0))
        resource.setrlimit(resource.RLIMIT_MEMLOCK, (65536, 65536))
        if os.geteuid() == 0:
            os.setgroups([])
            os.setgid(65534)
            os.setuid(65534)

    with tempfile.TemporaryDirectory() as parent:
        folder = Path(shutil.copytree(loop, Path(parent) / "loop"))
        for path in (Path(parent), folder):
            path.chmod(0o777)
        command = ["./levitator_2dof", "--run", ".", "--seconds", "0.5", "--stall", "5000"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, preexec_fn=no_rights)
    assert "SCHED_FIFO: Operation not permitted" in done.stderr and done.returncode == 0, done.stderr
