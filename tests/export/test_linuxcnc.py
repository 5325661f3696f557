"""An exported project for LinuxCNC: the vectors through HAL bit for bit, the rehearsal, and the safe outputs.

HAL runs in namespaces of its own: modules are installed into a copy of LinuxCNC's folder, and nothing outlasts a run.
"""

import ctypes
import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from synth.declare.stage import Stage
from synth.errors import DesignError
from synth.execute import compile as host_compiler
from synth.execute import host
from synth.export import linuxcnc, project, templates
from tests import tools
from tests.export import harness, test_page
from tests.export.test_mcu import NAMES, plant_wrong_step

pytestmark = pytest.mark.slow

REGULAR = ("levitator_2dof", "maglev_5dof")
needs_hal = tools.needs(
    "halcompile", "halrun", "unshare", shows="that the exported components run in LinuxCNC's HAL, bit for bit"
)
IN_HAL = """
folder=$(make -s --eval 'where: ; @echo $(RTLIBDIR)' -f "$(halcompile --print-modinc)" where)
cp -r "$folder" modules
mount --bind modules "$folder"
exec "$@"
"""
Values = Mapping[str, Mapping[str, str]]


def export(name: str, folder: Path) -> Path:
    project.project(harness.stage(name), harness.emitted(name), "linuxcnc").save(folder)
    return folder


@pytest.fixture
def fifo() -> Iterator[Path]:
    """A folder for the fifo of LinuxCNC's realtime process, which does not run as root."""
    folder = Path(tempfile.mkdtemp(prefix="hal", dir="/tmp"))
    folder.chmod(0o777)
    yield folder / "fifo"
    shutil.rmtree(folder)


def in_hal(folder: Path, fifo: Path, *command: str, **more: str) -> subprocess.CompletedProcess[str]:
    """Run a command in a project, with its own folder of modules, its own shared memory and its own processes."""
    private = ["unshare", "--mount", "--ipc", "--pid", "--fork", "--kill-child", "--mount-proc"]
    if subprocess.run([*private, "true"], capture_output=True).returncode:
        pytest.skip("no namespaces without root: would show that the exported components run in LinuxCNC's HAL")
    environ = {**os.environ, "RTAPI_UID": "65534", "RTAPI_FIFO_PATH": str(fifo), **more}
    words = [*private, "sh", "-ec", IN_HAL, "sh", *command]
    done = subprocess.run(words, cwd=folder, env=environ, capture_output=True, text=True, timeout=300)
    shutil.rmtree(folder / "modules")
    return done


def installed(folder: Path, fifo: Path, target: str) -> subprocess.CompletedProcess[str]:
    return in_hal(folder, fifo, "sh", "-c", f"make -s install && make -s {target}")


def shown(printed: str) -> Values:
    """Return what a run has shown: under each title, the values of the pins."""
    parts = re.split(r"^\w+: (.+)$", printed, flags=re.M)[1:]
    rows = [re.findall(r"(?:IN|OUT) +(\S+) (\S+)", text) for text in parts[1::2]]
    return {title: {pin: value for value, pin in row} for title, row in zip(parts[::2], rows, strict=True)}


def built(name: str, folder: Path) -> Path:
    assert "warning" not in harness.make(export(name, folder))
    return folder


@needs_hal
@pytest.mark.parametrize("name", [n if n in REGULAR else pytest.param(n, marks=pytest.mark.whole) for n in NAMES])
def test_the_vectors_replay_through_hal_and_the_rehearsal_follows(name: str, tmp_path: Path, fifo: Path) -> None:
    folder = built(name, tmp_path)
    done = installed(folder, fifo, "replay")
    assert done.stdout == f"{name}: 0 of 1000 samples differ from the vectors, the first is -1\n", done.stderr
    done = installed(folder, fifo, "rehearsal")
    pins, of = shown(done.stdout), linuxcnc.hal_name(name)
    assert done.returncode == 0 and list(pins) == ["at rest", "enabled", "moved", "disabled"]
    assert [p[f"{of}.running"] for p in pins.values()] == ["FALSE", "TRUE", "TRUE", "FALSE"]
    stage = harness.stage(name)
    read = {s.of: linuxcnc.hal_name(s.name) for s in stage.interface.sensors}
    for p in stage.interface.set_points:
        targets = {title: float(v[f"{of}.{linuxcnc.hal_name(p.name)}-used"]) for title, v in pins.items()}
        assert targets["enabled"] == pytest.approx(stage.start.get(p.of, targets["enabled"]))
        assert abs(targets["moved"] - targets["enabled"]) > 1e-3 * (p.high - p.low)
        for title in ("enabled", "moved") if p.of in read else ():
            reached = float(pins[title][f"{of}-plant.{read[p.of]}"])
            assert reached == pytest.approx(targets[title], abs=1e-3 * (p.high - p.low))
    if name == "levitator_2dof":
        heights = [float(p[f"{of}-plant.z"]) for p in pins.values()]
        assert heights == pytest.approx([-6e-4, 0, 3e-5, -6e-4], abs=1e-6), "it lies, floats, follows, and lies again"


def wrong_vector(folder: Path) -> None:
    """Flip the last bit of the first output in sample 123."""
    path = folder / "src" / "vectors.c"
    rows = path.read_text().splitlines(keepends=True)
    first = next(k for k, row in enumerate(rows) if row.startswith("    {"))
    words = rows[first + 123].split(", ")
    words[4] = f"{int(words[4].removesuffix('u'), 16) ^ 1:#x}u"
    path.write_text("".join([*rows[: first + 123], ", ".join(words), *rows[first + 124 :]]))


def wrong_wire(folder: Path) -> None:
    """Give the first set-point to the second."""
    exchange(folder / "levitator_2dof.comp", "{ *hal->z_ref, *hal->x_ref, }", "{ *hal->z_ref, *hal->z_ref, }")


def exchange(path: Path, right: str, wrong: str) -> None:
    text = path.read_text()
    assert text.count(right) == 1
    path.write_text(text.replace(right, wrong))


@needs_hal
@pytest.mark.parametrize(
    ("defect", "message"),
    [
        (plant_wrong_step, r"302 of 1000 samples differ from the vectors, the first is 698"),  # two calls before
        (wrong_vector, r"1 of 1000 samples differ from the vectors, the first is 123"),
        (wrong_wire, r"[1-9]\d* of 1000 samples differ"),
    ],
)
def test_a_wrong_bit_is_found(defect: Callable[[Path], None], message: str, tmp_path: Path, fifo: Path) -> None:
    defect(export("levitator_2dof", tmp_path))
    harness.make(tmp_path)
    done = installed(tmp_path, fifo, "replay")
    assert done.returncode and re.search(message, done.stdout), done.stdout + done.stderr


@needs_hal
def test_what_is_not_installed_as_built_is_refused(tmp_path: Path, fifo: Path) -> None:
    done = in_hal(built("levitator_2dof", tmp_path), fifo, "make", "-s", "rehearsal")
    assert done.returncode and "levitator_2dof.so: install it first: sudo make install" in done.stdout


SCENARIO = """
loadrt ddt names=rate
loadrt minmax names=slew
addf rate stage
addf slew stage
net i1 rate.in
net rate rate.out slew.in
sets enable true
{show running}
unlinkp levitator-2dof.z
setp levitator-2dof.z 1
{show latched}
sets enable false
loadusr -w sleep 1
net z levitator-2dof.z
setp levitator-2dof.rest-time 1000
sets enable true
{show unsettled}
sets enable false
setp levitator-2dof.rest-time 0.25
sets enable true
{show again}
unlinkp levitator-2dof.z
setp levitator-2dof.z -1e-4
loadusr -w sleep 1
setp slew.reset 1
{show wound}
setp slew.reset 0
sets enable false
{show disabled}
"""


def scenario(folder: Path, fifo: Path) -> Values:
    """Return the pins in a run that latches, is disabled, starts again, and is disabled with its largest current."""
    title = r"loadusr -w sleep 1\nloadusr -w echo levitator_2dof: \1\nshow pin levitator-2dof slew"
    head = (folder / "rehearsal.hal").read_text().split("loadusr")[0]
    (folder / "scenario.hal").write_text(head + re.sub(r"\{show (\w+)\}", title, SCENARIO))
    harness.make(folder)
    done = in_hal(folder, fifo, "sh", "-c", "make -s install && halrun -s -f scenario.hal")
    assert done.returncode == 0, done.stderr
    return {k: {n.removeprefix("levitator-2dof."): v for n, v in p.items()} for k, p in shown(done.stdout).items()}


def require_safety(pins: Values) -> None:
    """Assert that the step is called, and the outputs are safe, when the header of the step asks for it."""
    bits = ("running", "amplifiers", "latched", "fault-z")
    assert {
        k: [*(n for n in bits if p[n] == "TRUE"), "safe" * (p["i1"] == p["i2"] == "0")] for k, p in pins.items()
    } == {
        "running": ["running", "amplifiers", ""],
        "latched": [*bits, "safe"],
        "unsettled": ["amplifiers", "safe"],
        "again": ["running", "amplifiers", ""],
        "wound": ["running", "amplifiers", ""],
        "disabled": ["safe"],
    }
    assert int(pins["latched"]["fault-word"]) == 1 << 31 | 1
    assert float(pins["again"]["z-ref-used"]) == 0
    assert float(pins["wound"]["i1"]) == 3 and float(pins["disabled"]["slew.min"]) == pytest.approx(-100, rel=1e-3)


@needs_hal
def test_disabled_means_safe_outputs_and_enable_starts_again(tmp_path: Path, fifo: Path) -> None:
    require_safety(scenario(export("levitator_2dof", tmp_path), fifo))


@needs_hal
@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("running = enable && (running || starts)", "running = running || starts"),
        ("if (starts || (!running && safe && rest.good > 0u)) stage_init", "if (0) stage_init"),
        ("safe && (rests || hal->replay)", "safe"),
        ("safe = stage_safe_step(&stage, outputs)", "safe = 1"),
    ],
)
@pytest.mark.whole
def test_a_component_that_does_not_keep_the_contract_is_found(
    right: str, wrong: str, tmp_path: Path, fifo: Path
) -> None:
    exchange(export("levitator_2dof", tmp_path) / "levitator_2dof.comp", right, wrong)
    pins = scenario(tmp_path, fifo)
    with pytest.raises(AssertionError):
        require_safety(pins)


UNWIRED = """
source levitator_2dof.hal
setp levitator-2dof.rest-time {rest}
start
sets enable true
loadusr -w sleep 1
loadusr -w echo levitator_2dof: signals
show pin levitator-2dof
unlinkp levitator-2dof.z
unlinkp levitator-2dof.x
sets enable false
loadusr -w sleep 1
sets enable true
loadusr -w sleep 1
loadusr -w echo levitator_2dof: pins
show pin levitator-2dof
"""


@needs_hal
def test_nothing_starts_without_sensors(tmp_path: Path, fifo: Path) -> None:
    """A signal that nothing writes is no sensor, and neither is a pin alone, whatever the time of rest."""
    folder = built("levitator_2dof", tmp_path)
    for rest in ("0.25", "0", "-1"):
        (folder / "unwired.hal").write_text(UNWIRED.format(rest=rest))
        done = in_hal(folder, fifo, "sh", "-c", "make -s install && halrun -s -f unwired.hal")
        pins = shown(done.stdout)
        assert list(pins) == ["signals", "pins"], done.stderr
        for values in pins.values():
            assert values["levitator-2dof.z"] == "nan"
            assert values["levitator-2dof.running"] == values["levitator-2dof.amplifiers"] == "FALSE"


@needs_hal
def test_a_thread_of_another_period_does_not_start_the_step(tmp_path: Path, fifo: Path) -> None:
    folder = export("levitator_2dof", tmp_path)
    exchange(folder / "levitator_2dof.hal", "period1=500000", "period1=1000000")
    pins = scenario(folder, fifo)
    assert {p["wrong-period"] for p in pins.values()} == {"TRUE"} and {p["running"] for p in pins.values()} == {"FALSE"}


# What follows needs no LinuxCNC.


@pytest.mark.parametrize("name", REGULAR)
def test_the_component_has_a_pin_for_each_signal_and_fault(name: str, tmp_path: Path) -> None:
    folder, code = export(name, tmp_path), harness.emitted(name)[name]
    text = (folder / f"{name}.comp").read_text()
    require_pins(text, code.manifest)
    for lost in ("pin in float z_ref", "pin out bit latched"):
        with pytest.raises(AssertionError):
            require_pins(text.replace(lost, f"// {lost}"), code.manifest)
    assert f"period1={round(1e9 * code.manifest['period_s'])}\n" in (folder / f"{name}.hal").read_text()
    for file, content in host.code(code.files).items():
        assert (folder / "controller" / file).read_text() == content


def require_pins(text: str, manifest: Mapping[str, Any]) -> None:
    pins = set(re.findall(r'^pin (\w+) float (\w+)(?: = NAN)? "[^"]+";$', text, re.M))
    for role, direction in (("input", "in"), ("output", "out")):
        assert pins >= {(direction, f["name"]) for f in manifest["structs"][role]["fields"]}
    bits = re.findall(r'^pin out bit \w+ "bit (\d+) of fault-word', text, re.M)
    assert sorted(map(int, bits)) == sorted(f["bit"] for f in manifest["faults"])


@pytest.mark.parametrize(("delay", "order"), [(1, "write read step"), (0, "read step write")])
def test_the_order_of_functions_is_the_delay_of_the_declaration(delay: int, order: str) -> None:
    files = project.project(with_delay(delay), harness.emitted("levitator_2dof"), "linuxcnc").files
    thread: list[str] = []
    for text in ("levitator_2dof.hal", "rehearsal.hal"):
        for function, place in re.findall(r"^addf (\S+) stage ?(\d*)$", str(files[text]), re.M):
            thread.insert(int(place) - 1 if place else len(thread), function)
    short = {"levitator-2dof": "step", "levitator-2dof-plant.write-outputs": "write"}
    assert " ".join(short.get(f, "read") for f in thread) == order


def test_a_longer_delay_is_refused() -> None:
    with pytest.raises(DesignError, match="found a delay of 2 samples, HAL gives 0 or 1 by the order of functions"):
        project.project(with_delay(2), harness.emitted("levitator_2dof"), "linuxcnc")


def with_delay(delay: int) -> Stage:
    stage = harness.stage("levitator_2dof")
    interface = replace(stage.interface, delay=delay)
    return replace(stage, controller=replace(stage.controller, interface=interface))


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (("z", "enable", "enable"), "found two pins 'enable', need different names: rename that signal"),
        (("z_", "z"), "found two pins 'z', need"),
        (("a" * 35,), "found names of up to 48 characters, such as 'stage-replay.a+', HAL takes 47: shorten"),
    ],
)
def test_names_that_hal_does_not_take_are_refused(names: tuple[str, ...], message: str) -> None:
    linuxcnc.require_names("stage", ["z", "z_ref", "a" * 34])
    with pytest.raises(DesignError, match=message):
        linuxcnc.require_names("stage", names)


STAGE_H = """
#define STAGE_PERIOD_S 0.001
typedef struct { double speed, acceleration; } limits_t;
typedef struct { double low, high; } signal_t;
"""
FOLLOW_C = """#include "follow.h"
void run(int n, const double *targets, double *at);
void run(int n, const double *targets, double *at)
{
    const limits_t limits = {0.5, 20.0};
    const signal_t range = {-0.5, 0.5};
    path_t path = {0.0, 0.0, follow_goal(targets[0], 0.0, &range)};
    for (int k = 0; k < n; k++) at[k] = follow(&path, follow_goal(targets[k], path.target, &range), &limits);
}
"""


def set_points(targets: np.ndarray, defect: tuple[str, str] = ("", "")) -> np.ndarray:
    """Return the set-points, (N,), on the way to targets, (N,), from 0, at 1 kHz, with 0.5 /s and 20 /s^2."""
    header = templates.render("linuxcnc", {}, ("follow.h",))["follow.h"]
    files = {"follow.h": header.replace(*defect), "stage.h": STAGE_H, "follow.c": FOLLOW_C}
    run = ctypes.CDLL(str(host_compiler.shared_library(files, ()))).run
    targets, at = np.ascontiguousarray(targets, dtype=np.float64), np.empty(len(targets))
    run(len(targets), ctypes.c_void_p(targets.ctypes.data), ctypes.c_void_p(at.ctypes.data))
    return at


def require_limits(at: np.ndarray, last: float) -> None:
    """Assert that a path from 0 keeps its limits, never passes its only target, and stays there."""
    v = np.diff(at, prepend=[0.0, 0.0]) / 1e-3
    assert np.abs(v).max() <= 0.5 * (1 + 1e-9) and np.abs(np.diff(v)).max() <= 20e-3 * (1 + 1e-6)
    assert np.abs(at).max() <= abs(last) and (at[-10:] == last).all()


@pytest.mark.parametrize("last", [1e-6, 1.99e-5, 2e-5, -3.1e-4, 0.0123, -0.4])
def test_a_set_point_follows_within_its_limits(last: float) -> None:
    n = 2000
    require_limits(set_points(np.full(n, last)), last)
    assert np.flatnonzero(set_points(np.full(n, last)) == last)[0] <= 1000 * (abs(last) / 0.5 + 0.5 / 20) + 60


@pytest.mark.parametrize(
    "defect",
    [
        ("(1.0 + 8.0", "(1.0 + 9.0"),
        ("-change), change)", "-1e9), 1e9)"),
        ("-limits->speed), limits->speed", "-9.0), 9.0"),
    ],
)
def test_a_follower_that_breaks_its_limits_is_found(defect: tuple[str, str]) -> None:
    with pytest.raises(AssertionError):
        require_limits(set_points(np.full(3000, -0.4), defect), -0.4)


def test_a_motion_within_the_limits_is_followed_without_a_lag() -> None:
    t = np.arange(1000) * 1e-3
    motion = 0.01 * (1 - np.cos(40 * t))  # 0.4 /s, 16 /s^2
    np.testing.assert_array_equal(set_points(motion), motion)
    assert (set_points(motion, ("fabs(far) <= limits->speed * h", "0")) != motion).any()
    moved = motion + np.where(t > 0.1, 0.003, 0.0)
    assert (set_points(moved)[:100] == motion[:100]).all() and (set_points(moved)[-500:] == moved[-500:]).all()


def test_a_target_that_is_not_finite_holds_the_last_one() -> None:
    for bad in (np.nan, np.inf):
        targets = np.full(200, 1e-3)
        targets[5:100] = bad
        np.testing.assert_array_equal(set_points(targets), set_points(np.full(200, 1e-3)))


def test_a_target_beyond_the_range_leads_to_its_end_and_comes_back_at_once() -> None:
    targets = np.where(np.arange(6000) < 3000, 10.0, 0.0)
    at = set_points(targets)
    assert at.max() == at[2999] == 0.5
    assert np.flatnonzero(at[3000:] == 0)[0] < 1000 * (0.5 / 0.5 + 0.5 / 20) + 60, "as from the end of the range"
    assert set_points(targets, ("fmin(fmax(pin, range->low), range->high)", "pin")).max() > 1


PAGE = (harness.ROOT / "docs" / "howto" / "export-linuxcnc.md").read_text(encoding="utf-8")


@needs_hal
@pytest.mark.whole
def test_the_commands_of_the_page_lead_to_a_moving_stage(tmp_path: Path, fifo: Path) -> None:
    environ = test_page.environment(tmp_path)
    (tmp_path / "bin" / "sudo").write_text('#!/bin/sh\nexec "$@"\n')
    (tmp_path / "bin" / "sudo").chmod(0o755)
    script, expected = (PAGE.split(f"```{kind}\n")[1].split("```", 1)[0] for kind in ("sh", "text"))
    done = in_hal(tmp_path, fifo, "bash", "-e", "-c", script, **environ)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    assert script.startswith("synth new my_stage\n")
    assert [line for line in expected.splitlines() if line not in done.stdout.splitlines()] == []
