"""The socket serves its owner, answers every line with one, refuses by name, and survives whatever is sent."""

import contextlib
import os
import random
import socket
import stat
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests import tools
from tests.export import harness

pytestmark = pytest.mark.slow

PLANT = ("--stall", "5000")
REFUSED = {
    "fly z_ref 1": "there is no command 'fly'",
    "": "there is no command ''",
    "move": "'move' has too few words",
    "move z_ref": "'z_ref' needs a finite number",
    "move z_ref x": "'z_ref' needs a finite number",
    "move z_ref nan": "'z_ref' needs a finite number",
    "move z_ref 1e999": "'z_ref' needs a finite number",
    "move z_ref 1e-4 x_ref": "'x_ref' needs a finite number",
    "move y_ref 0": "there is no set-point 'y_ref'",
    "move z_ref 6e-4": "the value of z_ref would be 0.0006",
    "move z_ref -6e-4": "the value of z_ref would be -0.0006 m, at least -0.0005 is possible: make it larger",
    "move z_ref 1e300": "the value of z_ref would be 1e+300",
    "move z_ref 5.1e-4": "m, at most 0.0005 is possible: make it smaller",
    "step z_ref 6e-4": "the value of z_ref would be 0.0006 m, at most 0.0005 is possible",
    "ramp z_ref 4e-4 1e-4": "the speed of z_ref would be",
    "sine z_ref 4e-4 100 5": "the acceleration of z_ref would be",
    "sine z_ref 6e-4 1 5": "the value of z_ref would be",
    "sine z_ref 1e-4 0 5": "'0' is not a positive number",
    "sine z_ref 1e-4 1e-9 5": "the motion would take 5e+09 s, at most 3600 s are checked",
    "sine z_ref 1 2000 1000000": "the value of z_ref would be 1 m",
    "sine z_ref 1e-12 2000 1000000": "the frequency would be 2000 Hz, at most 100 Hz is possible",
    "sine z_ref 1e-12 1.7e308 1.7e308": "the frequency would be 1.7e+308 Hz",
    "circle z_ref x_ref 1e-12 101 1": "the frequency would be 101 Hz",
    "sine z_ref 1e-12 1 1.7e308": "the motion would take 1.7e+308 s, at most 3600 s are checked",
    "zigzag z_ref 3e-4 30 5": "the acceleration of z_ref would be",
    "circle z_ref z_ref 1e-4 1 1": "a circle needs two set-points",
    "circle z_ref x_ref 6e-4 1 5": "is possible",
    "ellipse z_ref 1e-4 z_ref 1e-4 1 1": "an ellipse needs two set-points",
    "record": "`record` needs one word",
    "record a b": "`record` needs one word",
    "record nowhere/run.csv": "'nowhere/run.csv' cannot be recorded to: No such file or directory",
    "record channels.toml": "cannot be recorded to: File exists",
    "names 1": "`names` stands alone: leave out '1'",
    "stop now": "`stop` stands alone: leave out 'now'",
    "start": "a start needs a disabled machine at rest",
    "move " + "z_ref 0 " * 40: "more than 63 words",
    "status" + " " * 600: "a line is longer than 511 bytes",
    "move z_ref \x01": "bytes that are not printable",
    "st\x00atus": "bytes that are not printable",
}


@pytest.fixture
def running(loop: Path) -> Iterator[harness.Loop]:
    with harness.running(loop, *PLANT) as running:
        running.wait("phase=running moving=0")
        yield running


def test_what_cannot_be_done_is_refused_by_name(running: harness.Loop) -> None:
    with running.connect() as connection:
        answers = {line: harness.ask(connection, line) for line in REFUSED}
    assert {line: a for line, a in answers.items() if not a.startswith("error: ") or REFUSED[line] not in a} == {}
    assert "phase=running moving=0" in running.ask("status")


def test_every_motion_runs_from_where_the_last_one_ended(running: harness.Loop) -> None:
    for line in (
        "move z_ref 1e-4 x_ref -1e-4",
        "step x_ref 1e-4",
        "ramp z_ref 0 0.1",
        "sine z_ref 1e-4 20 2",
        "zigzag x_ref 1e-4 5 2",
        "ellipse z_ref 1e-4 x_ref 2e-4 10 2",
        "circle z_ref x_ref 1e-4 10 2",
    ):
        assert running.ask(line) == "ok", line
        running.wait("phase=running moving=0")
    assert "z_ref=0 x_ref=0.0001" in running.ask("position")
    assert "faults=0x00000000 (-)" in running.ask("status")


def test_the_answers_have_names_and_units(running: harness.Loop) -> None:
    assert running.ask("names") == "ok z_ref[m]=-0.0005..0.0005 x_ref[m]=-0.0008..0.0008"
    assert [w.split("=")[0] for w in running.ask("position").split()[1:]] == ["z", "x", "z_ref", "x_ref", "i1", "i2"]
    assert running.ask("help").startswith("ok status | position")
    assert running.ask("record run.csv") == "ok"
    assert "recording=1" in running.ask("status")
    assert running.ask("record other.csv") == "error: a record is running: `record stop` first"
    for name in ("b.csv", "c.csv", "d.csv"):
        assert running.ask("record stop") == "ok"
        assert running.ask(f"record {name}") == "ok", "at once"
    assert running.ask("record stop") == "ok"
    assert "recording=0" in running.ask("status")
    assert (running.folder / "run.csv").read_text().startswith("t [s],z [m],x [m],z_ref [m]")


def test_a_record_is_a_new_file_even_where_a_link_leads_nowhere(running: harness.Loop) -> None:
    (running.folder / "link.csv").symlink_to("elsewhere.csv")
    assert running.ask("record link.csv").startswith("error: 'link.csv' cannot be recorded to")
    assert not (running.folder / "elsewhere.csv").exists()


def test_the_socket_is_its_owners_alone(running: harness.Loop) -> None:
    mode = (running.folder / "levitator_2dof.sock").stat().st_mode
    assert stat.S_ISSOCK(mode) and stat.S_IMODE(mode) == 0o600


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can become another user: would show that one is turned away")
def test_another_user_is_turned_away_even_where_the_file_lets_it_in(running: harness.Loop) -> None:
    running.folder.joinpath("levitator_2dof.sock").chmod(0o666)
    running.folder.chmod(0o755)
    connection = socket.socket(socket.AF_UNIX)
    with contextlib.chdir(running.folder):
        os.seteuid(65534)
        try:
            connection.connect("levitator_2dof.sock")
        finally:
            os.seteuid(0)
    connection.settimeout(30)
    assert connection.recv(200) == b"error: the socket serves its owner alone: connect as the user of the loop\n"
    assert connection.recv(200) == b""
    assert "phase=running" in running.ask("status")


def test_a_client_that_does_not_read_stops_nobody(running: harness.Loop) -> None:
    mute = running.connect()
    mute.settimeout(1)
    with pytest.raises(OSError):
        for _ in range(100_000):
            mute.sendall(b"help\n" * 50)
    assert "phase=running" in running.ask("status")


def test_more_clients_than_places_are_turned_away(running: harness.Loop) -> None:
    clients = [running.connect() for _ in range(8)]
    assert all(harness.ask(client, "status").startswith("ok") for client in clients)
    ask = [str(running.folder / "client"), "levitator_2dof.sock", "status"]
    ninth = subprocess.run(ask, cwd=running.folder, capture_output=True, text=True)
    assert ninth.returncode == 1 and ninth.stdout.startswith("error: as many clients are connected as there are places")
    for client in clients:
        client.close()
    assert "phase=running" in running.wait("phase=running")


def test_a_client_without_an_answer_says_so(loop: Path) -> None:
    """Of a loop that ends: here a socket that takes a client and closes."""
    with socket.socket(socket.AF_UNIX) as other:
        with contextlib.chdir(loop):
            other.bind("levitator_2dof.sock")
        other.listen()
        ask = [str(loop / "client"), "levitator_2dof.sock", "status"]
        client = subprocess.Popen(ask, cwd=loop, stderr=subprocess.PIPE, text=True)
        other.accept()[0].close()
        assert client.stderr and "no answer came: look whether the loop still runs" in client.stderr.read()
    assert client.wait() == 2


WORDS = (
    *("move", "step", "ramp", "sine", "zigzag", "circle", "ellipse", "hold", "names", "status", "position", "help"),
    *("tune", "parameters"),
    *("z_ref", "x_ref", "z_ref", "x_ref", "y_ref", "1e-4", "-1e-4", "0", "1", "10", "nan", "1e300", "-inf", "0x1p-9"),
)


def fuzzed(generator: random.Random) -> bytes:
    """Return a line: words of the protocol in any order, sometimes with bytes replaced, sometimes bytes alone."""
    line = " ".join(generator.choice(WORDS) for _ in range(generator.randrange(9))).encode()
    kind = generator.random()
    if kind < 0.2:
        line = generator.randbytes(generator.randrange(700)).replace(b"\n", b" ")
    elif kind < 0.4 and line:
        k = generator.randrange(len(line))
        line = line[:k] + generator.randbytes(1).replace(b"\n", b" ") + line[k + 1 :]
    return line + b"\n"


def fuzz(running: harness.Loop, messages: int) -> None:
    """Send lines in blocks; each has one answer."""
    generator, connection = random.Random(1), running.connect()
    for _ in range(messages // 20):
        block = [fuzzed(generator) for _ in range(20)]
        connection.sendall(b"".join(block))
        answers = b""
        while answers.count(b"\n") < 20:
            more = connection.recv(1 << 16)
            assert more, running.log
            answers += more
        assert all(a.startswith((b"ok", b"error: ")) for a in answers.splitlines()), answers
    connection.close()
    assert "latched_by=0x00000000" in running.ask("status")


def test_fuzzed_messages_are_answered(running: harness.Loop) -> None:
    fuzz(running, 20_000)


@pytest.mark.whole
@tools.needs("gcc", shows="that no message touches memory outside or overflows")
def test_a_million_fuzzed_messages_under_sanitizers(tmp_path: Path) -> None:
    folder = harness.export("levitator_2dof", tmp_path)
    checks = "-fsanitize=address,undefined -fno-sanitize-recover=all"
    harness.build(folder, cc="gcc", flags=f"-O1 -g {checks}", link=checks)
    with harness.running(folder, "--stall", "60000") as running:
        running.wait("phase=running moving=0")
        fuzz(running, 1_000_000)
        running.process.terminate()
        assert running.end() == 0
    assert "ERROR" not in running.log and "runtime error" not in running.log


PLAIN = "__atomic_store_n(&ring->head, __atomic_load_n(&ring->head, __ATOMIC_RELAXED) + 1u, __ATOMIC_RELEASE)"


@pytest.mark.whole
@pytest.mark.parametrize("planted", [False, True])
@tools.needs("clang", shows="that loop, server and recorder share nothing without order")
def test_the_threads_do_not_race(planted: bool, tmp_path: Path) -> None:
    """And a ring whose writer publishes without order is seen."""
    folder = harness.export("levitator_2dof", tmp_path)
    ring = folder / "src" / "ring.h"
    text = ring.read_text()
    assert PLAIN in text
    ring.write_text(text.replace(PLAIN, "ring->head += 1u") if planted else text)
    harness.build(folder, cc="clang", flags="-O1 -g -fsanitize=thread", link="-fsanitize=thread")
    with harness.running(folder, "--stall", "60000") as running:
        running.wait("phase=running moving=0")
        for k in range(1 if planted else 20):
            assert running.ask(f"record {k}.csv") == "ok"
            fuzz(running, 2_000)
            running.ask("record stop")
            running.wait("recording=0")
        running.process.terminate()
        assert planted or running.end() == 0
    assert ("WARNING: ThreadSanitizer: data race" in running.log) == planted
