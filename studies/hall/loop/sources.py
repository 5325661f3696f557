"""Comparison of position sources under the regulators of planar_6dof_lqg: its sections, and the GLSDC estimate.

The experiments are a slow path through a pitch in the true field, and a standstill. The sources are the sections of the
stage's three sensors, the estimate from the same sensors, and the estimate from an optimised layout; both estimates are
calibrated. The estimate halves the sections' path errors and takes six times as many instructions.
"""

from collections.abc import Mapping
from functools import cache

import numpy as np

from designs.planar_6dof.experiments import common_checks
from models import planar_stage
from studies.hall.hall_bench import Bench
from studies.hall.loop import calibration, stage_loop
from studies.hall.loop.stage_loop import TIME, Loop
from synth.check import Check
from synth.simulate.experiments import Experiment
from synth.simulate.scenario import Trajectory, sample_times
from synth.statespace import Array
from synth.verify import meter, steps

UNITS = {"x": "um", "y": "um", "phi": "urad"}
MICRO = 1e6
SLOW = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (3.0, -0.024, 0.005), (13.0, 0.024, 0.005), (13.5, 0.024, 0.005))  # s, m, m
SECTIONS, STAGE_SENSORS, OPTIMISED = "sections", "estimate, the stage's sensors", "estimate, sensors placed for it"
REST = 5.0  # s
COUNTED, BUILD = 150, "gcc, newlib"  # steps whose instructions are counted
ABOUT = "1 mV of noise, 200 Hz, 16 bits over +-5 V, one sample of delay"


@cache
def others(libm: bool = False) -> Mapping[str, Loop]:
    """Return the loops on the stage's own sensors: with sections, and with the calibrated estimate."""
    places = planar_stage.hall_places(planar_stage.plant())
    estimated = stage_loop.of_source(calibration.calibrated_source(places), Bench(places), libm=libm)
    return {SECTIONS: stage_loop.of_sections(libm=libm), STAGE_SENSORS: estimated}


def noise(run: Trajectory, since: float) -> dict[str, float]:
    """Return the rms about the mean of true and estimated positions, um and urad, from a time in s on."""
    first, figures = round(since / TIME.period_s), {}
    for axis, unit in UNITS.items():
        figures[f"{axis}, {unit} rms"] = MICRO * float(np.std(run[axis][first:]))
        figures[f"{axis} as estimated, {unit} rms"] = MICRO * float(np.std(run[f"{axis}_raw"][first:]))
    return figures


def experiment(by_name: Mapping[str, Loop]) -> Experiment:
    """Return the slow path with each source; OPTIMISED is shown and checked against SECTIONS."""
    runs = {name: loop.run(SLOW[-1][0], set_points()) for name, loop in by_name.items()}
    errors = {name: _path_errors(run) for name, run in runs.items()}
    figures: dict[str, float] = {}
    for name, loop in by_name.items():
        rest = noise(loop.run(REST, {}), 1.0)
        measured = {f"noise of {what}": rms for what, rms in rest.items() if "estimated" not in what}
        measured |= {f"{axis} off its path, {UNITS[axis]} at most": error for axis, error in errors[name].items()}
        measured |= {f"instructions, {BUILD}": float(n) for n in instructions(loop, runs[name])}
        figures |= {f"{name}: {what}": value for what, value in measured.items()}
    about = "at most, calibrated; half of the sections'"
    checks = [
        Check(f"{axis} off its path", errors[OPTIMISED][axis], errors[SECTIONS][axis] / 2, unit, about)
        for axis, unit in UNITS.items()
    ]
    checks += [check for run in runs.values() for check in common_checks(run)]
    title, about = "A slow path through a pitch, by each source", f"4.8 mm/s, {ABOUT}"
    return Experiment("sources", title, about, runs[OPTIMISED], tuple(UNITS), set_points(), figures, tuple(checks))


def set_points() -> dict[str, Array]:
    """Return x and y (N,) of the path, m."""
    time, (at, x, y) = sample_times(SLOW[-1][0], TIME.period_s), np.array(SLOW).T
    return {"x": np.interp(time, at, x), "y": np.interp(time, at, y)}


def _path_errors(run: Trajectory) -> dict[str, float]:
    """Return the largest path errors of x, y and phi within the pitch, um and urad."""
    window = (run.time > SLOW[2][0] + 0.5) & (run.time < SLOW[3][0])
    path = {"phi": np.zeros_like(run.time)} | set_points()
    return {axis: MICRO * float(np.abs(run[axis] - path[axis])[window].max()) for axis in UNITS}


def instructions(loop: Loop, run: Trajectory) -> list[int]:
    """Return the largest instruction count of a controller step on a Cortex-M4F; empty without the compiler."""
    path = steps.thinned(steps.record(loop.rig.controller, "path", run.measured, closed_loop=True), COUNTED)
    builds = [b for b in meter.builds() if b.name == BUILD]
    return [int(meter.run(meter.emitted_source(loop.emitted), path, b).cost.instructions.max()) for b in builds]
