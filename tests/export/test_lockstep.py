"""In lock step an exported loop computes what `synth simulate` does, bit for bit: the same C, plant, sensors, noise.

Both compile the same functions with one compiler; only the loop around them differs.
"""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from synth.app import tasks
from synth.base.progress import silent
from synth.execute import host
from synth.export import project, records
from synth.simulate import rig
from synth.simulate.scenario import Trajectory
from tests.export import harness

pytestmark = pytest.mark.slow

MOTIONS = {
    "levitator_2dof": ["sine z_ref 2e-4 10 3", "circle z_ref x_ref 1e-4 5 2", "step x_ref 1e-4"],
    "maglev_5dof": ["move y_ref 0.024 x_ref 1e-3", "zigzag z_ref 1e-4 2 2"],
    "maglev_5dof_precise": ["ramp y_ref 0.026 0.3", "ellipse x_ref 1e-3 z_ref 2e-3 2 2"],
    "planar_6dof_leadlag": ["move x_ref 1e-3 phi_ref 1e-4", "sine y_ref 1e-4 5 2"],
    "planar_6dof_lqg": ["move x_ref 1e-3", "circle x_ref y_ref 1e-4 2 2"],
    "hall_position": [],
}
SAMPLES = 3000
PLANTED = "levitator_2dof"
REGULAR = ("levitator_2dof", "maglev_5dof")  # of `make test`: with and without a drive


@pytest.mark.parametrize("name", [n if n in REGULAR else pytest.param(n, marks=pytest.mark.whole) for n in MOTIONS])
def test_a_loop_in_lock_step_equals_the_simulation(name: str, tmp_path: Path) -> None:
    folder = harness.export(name, tmp_path)
    harness.build(folder)
    assert harness.call(folder, "--replay", "vectors", name=name).returncode == 0
    words = [word for motion in MOTIONS[name] for word in ("--motion", motion)]
    done = harness.call(folder, "--lockstep", str(SAMPLES), "--record", "run.csv", *words, name=name)
    assert done.returncode == 0, done.stderr
    log = records.read(folder / "run.csv")
    assert len(log) == SAMPLES
    run = simulated(name, log.samples)
    moved = [p for p in run.measured if p.endswith("_ref") and np.ptp(run.measured[p]) > 0]
    assert len(moved) >= len(MOTIONS[name]) - 1
    for group in (run.measured, run.driven or run.commands):
        for column in group:
            if column != "missed_calls":
                np.testing.assert_array_equal(log.samples[column].astype(np.float32), group[column], column)
    np.testing.assert_array_equal(log.samples["faults"].astype(np.uint32), run.faults | run.status)


@pytest.mark.parametrize(
    ("file", "before", "after"),
    [
        ("src/plant.c", "20.0,", "20.000000001,"),
        ("src/io_plant.c", "rint(seen", "floor(seen"),
        ("src/stage.h", "#define STAGE_DELAY 1", "#define STAGE_DELAY 2"),
    ],
)
def test_another_loop_differs(file: str, before: str, after: str, tmp_path: Path) -> None:
    """A force factor, the rounding of a sensor or the delay of another machine."""
    folder = harness.export(PLANTED, tmp_path)
    text = (folder / file).read_text()
    assert before in text
    (folder / file).write_text(text.replace(before, after))
    harness.build(folder, flags="-O1")
    assert harness.call(folder, "--lockstep", str(SAMPLES), "--record", "run.csv", name=PLANTED).returncode == 0
    log = records.read(folder / "run.csv")
    run = simulated(PLANTED, log.samples)
    assert not np.array_equal(log.samples["i1"].astype(np.float32), run.commands["i1"])


@pytest.mark.whole
def test_a_loop_in_double_precision_equals_the_simulation(tmp_path: Path) -> None:
    stage = harness.stage(PLANTED)
    emitted = tasks.emission(stage, np.float64).result(silent)
    project.project(stage, emitted, "linux").save(tmp_path)
    harness.build(tmp_path)
    assert "0 of 1000 samples differ" in harness.call(tmp_path, "--replay", "vectors").stdout
    words = [word for motion in MOTIONS[PLANTED] for word in ("--motion", motion)]
    assert harness.call(tmp_path, "--lockstep", str(SAMPLES), "--record", "run.csv", *words).returncode == 0
    log = records.read(tmp_path / "run.csv")
    simulator = rig.of_stage(stage, host.load(emitted[PLANTED].files, emitted[PLANTED].manifest))
    set_points = {p.name: log.samples[p.name] for p in stage.interface.set_points}
    run = simulator.run(SAMPLES * simulator.period_s, references=set_points)
    for column in run.commands:
        np.testing.assert_array_equal(log.samples[column], run.commands[column], column)


def test_a_sensor_that_wraps_does_so_in_both_loops(tmp_path: Path) -> None:
    """The law knows nothing of it, and loses z at the first turn: both loops do so alike."""
    folder = harness.export(PLANTED, tmp_path)
    text = (folder / "src/plant.c").read_text()
    row = "    { 0, 1e-07, 0.0, 0.0, -0.0007 },\n"
    assert row in text
    (folder / "src/plant.c").write_text(text.replace(row, "    { 0, 1e-07, 0.0, 2e-4, -1e-4 },\n"))
    harness.build(folder, flags="-O1")
    words = ["--motion", "sine z_ref 3e-4 10 3"]
    assert harness.call(folder, "--lockstep", str(SAMPLES), "--record", "run.csv", *words, name=PLANTED).returncode == 0
    log = records.read(folder / "run.csv")
    z, x = harness.stage(PLANTED).interface.sensors
    run = simulated(PLANTED, log.samples, sensors=(replace(z, wraps=2e-4, low=-1e-4), x))
    assert np.ptp(run.outputs["z"]) > 2.5e-4 and np.ptp(run.measured["z"]) <= 2.001e-4
    for name, column in (run.measured | run.commands).items():
        if name != "missed_calls":
            np.testing.assert_array_equal(log.samples[name].astype(np.float32), column, name)


def simulated(name: str, recorded: dict[str, np.ndarray], **interface: Any) -> Trajectory:
    """Return the run of `synth simulate`'s rig under the set-points and the noise of a recorded loop.

    `interface` has fields that differ from the declared ones.
    """
    stage = harness.stage(name)
    code = harness.emitted(name)[name]
    simulator = rig.of_stage(stage, host.load(code.files, code.manifest)).with_interface(**interface)
    noisy = [s for s in stage.interface.sensors if s.noise]
    normal = harness.normals(1, SAMPLES * len(noisy)).reshape(SAMPLES, len(noisy)).T
    noise = {s.name: s.noise * row for s, row in zip(noisy, normal, strict=True)}
    set_points = {p.name: recorded[p.name] for p in stage.interface.set_points}
    options = {"noise": noise} if noise else {}
    return simulator.run(SAMPLES * simulator.period_s, references=set_points, **options)
