"""The files of an export: every stage builds without a warning, refusals say what to do, the user's files stay."""

import os
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from synth import plant as plants
from synth import stage as stages
from synth.app import cli
from synth.errors import DesignError, SignalError, SynthError
from synth.export import limits, project, records, wiring
from synth.signals import Signal
from tests import tools
from tests.export import harness
from tests.export.test_lockstep import MOTIONS, REGULAR

pytestmark = pytest.mark.slow
STRICT = "-O2 -Wshadow -Wstrict-prototypes -Wundef -Wcast-qual -Werror"


@pytest.mark.whole
@pytest.mark.parametrize("name", MOTIONS)
@pytest.mark.parametrize(
    "compiler",
    ["zig", *(pytest.param(c, marks=tools.needs(c, shows="the same by this compiler")) for c in ("gcc", "clang"))],
)
def test_every_stage_builds_without_a_warning(compiler: str, name: str, tmp_path: Path) -> None:
    printed = harness.build(harness.export(name, tmp_path), harness.compiler(compiler), STRICT)
    assert "warning" not in printed


def test_the_host_compiler_warns_of_nothing(built: Path) -> None:
    assert "warning" not in harness.build(harness.export("levitator_2dof", built.parent / "strict"), flags=STRICT)


@tools.needs("cmake", shows="that the project builds by CMake as well")
def test_cmake_builds_the_same_program(built: Path, tmp_path: Path) -> None:
    subprocess.run(["cmake", "-S", str(built), "-B", str(tmp_path)], check=True, capture_output=True)
    done = subprocess.run(
        ["cmake", "--build", str(tmp_path)], check=True, capture_output=True, text=True, env=harness.outside_make()
    )
    assert "warning" not in done.stdout + done.stderr
    subprocess.run([tmp_path / "levitator_2dof", "--replay", built / "vectors"], check=True, capture_output=True)


def test_the_step_is_unchanged(built: Path) -> None:
    for name in ("levitator_2dof.c", "levitator_2dof.h"):
        committed = harness.ROOT / "generated_c" / "levitator_2dof" / name
        assert (built / "controller" / name).read_bytes() == committed.read_bytes()


def test_another_target_is_refused() -> None:
    with pytest.raises(DesignError, match="the target of the export is 'dsp': choose one of linux, mcu, linuxcnc"):
        project.project(harness.stage("levitator_2dof"), harness.emitted("levitator_2dof"), "dsp")


def test_a_drive_that_is_not_emitted_is_refused() -> None:
    code = harness.emitted("maglev_5dof")
    without = {name: files for name, files in code.items() if name == "maglev_5dof"}
    with pytest.raises(DesignError, match=r"its drive 'maglev_5dof_phase' is not among .*: declare it as a Companion"):
        project.project(harness.stage("maglev_5dof"), without, "linux")


@pytest.mark.parametrize("name", REGULAR)
def test_the_limits_are_what_the_actuators_give(name: str) -> None:
    """A levitator's magnet: K exp(0) (i_max - i_0) / M at z = 0, half of it for set-points."""
    stage = harness.stage(name)
    homes = {p.name: stage.start.get(p.of, 0.0) for p in stage.interface.set_points}
    bounds = limits.of_stage(stage, {p.name: p.of for p in stage.interface.set_points}, homes)
    assert all(value > 0 for each in bounds.values() for value in each)
    if name == "levitator_2dof":
        p = {each.name: each.value for each in stage.plant.parameters}
        held = (p["M"] * p["g"] - p["F0"]) / p["K"]
        assert bounds["z_ref"].acceleration == pytest.approx(0.5 * p["K"] * (3 - held) / p["M"])
        assert bounds["x_ref"].acceleration == pytest.approx(0.5 * p["k"] * 2 / p["m"])
        assert bounds["z_ref"].speed == 0.2 and bounds["x_ref"].speed == 0.5


def test_a_pull_that_grows_with_the_square_of_a_current_has_finite_limits() -> None:
    """Two coils of 0 to 4 A from either side, C i^2 / m each: at 2 A both, half of 2 C 2 A 2 A 2 / m."""
    C, m = 0.03, 0.5
    signals = [Signal("x", "m", -1e-3, 1e-3), Signal("v", "m/s", -0.2, 0.2)]
    plant = plants.build(
        "two coils",
        signals,
        [Signal("up", "A", 0.0, 4.0), Signal("down", "A", 0.0, 4.0)],
        signals[:1],
        [],
        lambda x, u, p: ({"x": x["v"], "v": C * (u["up"] ** 2 - u["down"] ** 2) / m}, {"x": x["x"]}),
    )
    of = harness.stage("levitator_2dof")
    interface = stages.interface(
        plant,
        sensors=[stages.Sensor("x")],
        set_points=[stages.SetPoint("x_ref", of="x", low=-1e-4, high=1e-4)],
        actuators=[stages.Actuator(n, 0.0, 100.0) for n in ("up", "down")],
    )
    two = replace(of, plant=plant, controller=replace(of.controller, interface=interface), start={}, experiments=())
    bounds = limits.of_stage(two, {"x_ref": "x"}, {"x_ref": 0.0})
    assert bounds["x_ref"].acceleration == pytest.approx(0.5 * 2 * C * 2 * 2 * 2 / m)


@pytest.mark.parametrize(("name", "shown"), [("planar_6dof_lqg", "z theta psi"), ("maglev_5dof", "y x z phi theta")])
def test_the_sensors_show_the_pose_at_the_start(name: str, shown: str) -> None:
    """Hall voltages show none of x, y and yaw by themselves."""
    stage = harness.stage(name)
    names = [s.name for s in stage.interface.sensors]
    sums = {p.of: wiring.pose(stage, p.of, names) for p in stage.interface.set_points}
    assert {of for of, text in sums.items() if text} == set(shown.split())
    states = {s.name: 1e-4 * (k + 1) for k, s in enumerate(stage.plant.states) if not s.name.startswith(("v", "w"))}
    outputs = stage.plant.output_values(states | stage.start)
    sensors = [float(outputs[s.of][0]) for s in stage.interface.sensors]
    for of in shown.split():
        assert eval(sums[of], {"sensors": sensors}) == pytest.approx((states | stage.start)[of], abs=1e-9)


def test_the_command_refuses_another_target(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(harness.ROOT)
    command = ["export", "levitator_2dof", "--target", "dsp", "--out", str(tmp_path / "loop")]
    result = CliRunner().invoke(cli.app, command)
    assert isinstance(result.exception, DesignError) and not (tmp_path / "loop").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        *((("--io", io, "--lockstep", "9"), "for --io plant alone, not for") for io in ("user", "comedi", "shm")),
        (("--cpu", "2000"), "'--cpu 2000' is no option with its value: give a number from 0 to 1023\n"),
        (("--help",), "usage: ./levitator_2dof [--io"),
        (("--motion", "move" + " z_ref 0" * 80), "is longer than 511 bytes or 63 words: give a shorter one"),
        (("--motion", "move" + " z_ref 0" * 32), "is longer than 511 bytes or 63 words: give a shorter one"),
        (("--motion", "move z_ref 0") * 17, ": at most 16 motions are possible"),
        (("--lockstep", "9", "--record", "channels.toml"), "File exists: give a new file in a folder that is there"),
    ],
)
def test_the_program_says_what_is_possible(words: tuple[str, ...], message: str, loop: Path) -> None:
    done = harness.call(loop, *words)
    assert done.returncode == 2 and message in done.stderr and "'--help" not in done.stderr


@pytest.mark.parametrize("value", ["", "sub"])
def test_a_folder_of_the_environment_that_is_no_absolute_path_is_none(value: str, loop: Path) -> None:
    (loop / "sub").mkdir()
    environment = {**os.environ, "XDG_RUNTIME_DIR": value}
    subprocess.run(["./levitator_2dof", "--lockstep", "9"], cwd=loop, env=environment, check=True, capture_output=True)
    assert (loop / "levitator_2dof.lock").exists() and not list((loop / "sub").iterdir())


def test_an_export_overwrites_nothing_but_one_of_its_own(tmp_path: Path) -> None:
    files = {"README.md": "generated", "src/loop.c": "generated"}
    linux, mcu = (project.Project({project.MARKER: f"stage for {t}\n", **files}) for t in ("linux", "mcu"))
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "README.md").write_text("mine")
    with pytest.raises(
        SynthError, match=r"mine: found 'README.md' and no synth-export.txt, need a new or empty folder"
    ):
        linux.save(mine)
    assert [path.name for path in mine.iterdir()] == ["README.md"] and (mine / "README.md").read_text() == "mine"
    (tmp_path / "loop").mkdir()
    for _ in range(2):
        assert linux.save(tmp_path / "loop") == []
    with pytest.raises(
        SynthError, match=r"found an export of 'stage for linux', need 'stage for mcu': give another --out"
    ):
        mcu.save(tmp_path / "loop")
    made = project.project(harness.stage("levitator_2dof"), harness.emitted("levitator_2dof"), "linuxcnc").files
    assert next(iter(made)) == project.MARKER and made[project.MARKER] == "levitator_2dof for linuxcnc\n"


def test_a_record_reads_back_as_a_log(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("t [s],z [m],i [A]\n0,1,2\n0.5,3,4\n")
    log = records.read(path, 0.5)
    assert {n: list(v) for n, v in log.samples.items()} == {"z": [1, 3], "i": [2, 4]} and log.period() == 0.5
    assert records.units(path) == {"t": "s", "z": "m", "i": "A"}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "line 1: found .*, need `t .s.` and names with units"),
        ("t,z\n0,1\n", "line 1: found .*, need `t .s.` and names with units"),
        ("t [s],z [m]\n0,1\n1\n", "line 3: .* need 2 numbers: cut it off"),
        ("t [s],z [m]\n0,nan\n", "row 0 of 'z' is nan"),
    ],
)
def test_what_is_no_record_is_refused(text: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text(text)
    with pytest.raises(SignalError, match=message):
        records.read(tmp_path / "run.csv")
