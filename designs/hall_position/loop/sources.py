"""The position sources of planar_6dof_lqg in the same experiment: its sections, and the estimate by GLSDC.

A slow path through a pitch over the truth field, and a standstill: the sections of the stage's own three sensors, the
estimate of the same sensors, and that of sensors placed for it, both calibrated. The regulators are the same. The
estimate follows its path within half of the sections' errors; it takes six times as many instructions.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from designs.hall_position.loop import calibration, closed_loop, stage_loop
from designs.hall_position.loop.stage_loop import TIME, Loop
from models import planar_stage, planar_voltages
from synth.check import Check
from synth.execute import cross
from synth.simulate.experiment import Experiment
from synth.simulate.scenario import Trajectory, sample_times
from synth.statespace import Array
from synth.verify import meter, rivals, steps

UNITS = {"x": "um", "y": "um", "phi": "urad"}
MICRO = 1e6
SLOW = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (3.0, -0.024, 0.005), (13.0, 0.024, 0.005), (13.5, 0.024, 0.005))  # s, m, m
SECTIONS, OWN, PLACED = "sections", "estimate, the stage's sensors", "estimate, sensors placed for it"
REST = 5.0  # s
COUNTED, BUILD = 150, "gcc, newlib"  # steps whose instructions are counted
ABOUT = "1 mV of noise, 200 Hz, 16 bits over +-5 V, one sample of delay"


@cache
def others(libm: bool = False) -> Mapping[str, Loop]:
    """Return the loops on the stage's own sensors: by sections, and by the estimate with its own calibration."""
    places = closed_loop.stage_places(planar_stage.plant())
    own = stage_loop.of_source(calibration.calibrated(places), libm=libm)
    return {SECTIONS: stage_loop.of_sections(libm=libm), OWN: own}


def usual(run: Trajectory) -> tuple[Check, ...]:
    """Return what every run without a planted failure must keep."""
    return (
        Check("samples with a fault", float(np.count_nonzero(run.faults)), 0.0, "1"),
        Check("largest phase current", planar_voltages.largest_current(run), planar_stage.LIMIT, "A", "Table 1"),
    )


def judged(
    name: str,
    title: str,
    run: Trajectory,
    shown: Sequence[str],
    references: Mapping[str, Array],
    figures: Mapping[str, float],
    checks: Sequence[Check],
    about: str = ABOUT,
) -> Experiment:
    """Return an experiment with what every run without a planted failure must keep."""
    return Experiment(name, title, about, run, tuple(shown), references, figures, (*checks, *usual(run)))


def noise(run: Trajectory, since: float) -> dict[str, float]:
    """Return the rms about the mean of what is true and as estimated, um and urad, from a time in s on."""
    first, found = round(since / TIME.period_s), {}
    for axis, unit in UNITS.items():
        found[f"{axis}, {unit} rms"] = MICRO * float(np.std(run[axis][first:]))
        found[f"{axis} as estimated, {unit} rms"] = MICRO * float(np.std(run[f"{axis}_raw"][first:]))
    return found


def experiment(by_name: Mapping[str, Loop]) -> Experiment:
    """Return the slow path by each source, PLACED being shown and judged against SECTIONS."""
    figures: dict[str, float] = {}
    runs: dict[str, Trajectory] = {}
    for name, loop in by_name.items():
        runs[name] = _path(loop)
        found = {f"noise of {k}": v for k, v in noise(loop.run(REST, {}, {}), 1.0).items() if "estimated" not in k}
        found |= {f"{a} off its path, {UNITS[a]} at most": v for a, v in _astray(runs[name]).items()}
        found |= {f"instructions, {BUILD}": float(n) for n in instructions(loop, runs[name])}
        figures |= {f"{name}: {what}": v for what, v in found.items()}
    least, most = _astray(runs[PLACED]), _astray(runs[SECTIONS])
    about = "at most, calibrated; half of the sections'"
    checks = [Check(f"{a} off its path", least[a], most[a] / 2, unit, about) for a, unit in UNITS.items()]
    references = dict(zip("xy", _set_points(), strict=True))
    title = "A slow path through a pitch, by each source"
    made = judged("sources", title, runs[PLACED], tuple(UNITS), references, figures, checks, f"4.8 mm/s, {ABOUT}")
    return replace(made, checks=(*checks, *(check for run in runs.values() for check in usual(run))))


def _set_points() -> list[Array]:
    """Return x and y (N,) of the path, m."""
    time, at = sample_times(SLOW[-1][0], TIME.period_s), np.array(SLOW).T
    return [np.interp(time, at[0], row) for row in at[1:]]


def _path(loop: Loop) -> Trajectory:
    return loop.run(SLOW[-1][0], dict(zip("xy", _set_points(), strict=True)), {})


def _astray(run: Trajectory) -> dict[str, float]:
    """Return how far x, y and phi are off the path at most while it goes through the pitch, um and urad."""
    window = (run.time > SLOW[2][0] + 0.5) & (run.time < SLOW[3][0])
    x, y = _set_points()
    off = {"x": run["x"] - x, "y": run["y"] - y, "phi": run["phi"]}
    return {axis: MICRO * float(np.abs(values[window]).max()) for axis, values in off.items()}


def instructions(loop: Loop, run: Trajectory) -> list[int]:
    """Return the instructions of a whole step on a Cortex-M4F, at most in some of a run; none without the compiler."""
    given = steps.thinned(steps.recorded(loop.controller, "path", run.measured, closed_loop=True), COUNTED)
    builds = [b for b in (meter.builds() if cross.available() else ()) if b.name == BUILD]
    return [int(meter.run(rivals.emitted(loop.emitted), given, b).cost.instructions.max()) for b in builds]
