"""Experiments that both controllers of the planar positioner make: steps, standstill, the voltages that they need.

A step comes SETTLE after the start from rest. Its rise, overshoot and settling are those of a twin run whose sensors
are ideal, of the position as the sensors show it: what the calibration leaves of the field, 0.8 % in scale where the
step is, the paper could not see either, and stands beside as the true error. All else is of the run with noise, the
trajectory that is shown. The motors see the field's harmonics, and every current comes a sample late.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from designs.planar_6dof.interface import NOISE_PRINTED
from designs.planar_6dof.loop import Array, noise_of, seen, simulate, with_noise
from models import planar_stage, planar_voltages
from synth.check import Check
from synth.simulate import metrics
from synth.simulate.experiment import Experiment
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory, sample_times

SETTLE, AFTER = 0.5, 2.0  # s before a step, and after it
REST, SHORT = 10.0, 5.0  # s of standstill, of which the first is left out; behind amplifiers
SUPPLIES, FINE = (planar_voltages.STATED, 24.0), 8  # V; substeps of a sample, for an amplifier's lag of 0.25 ms
UNITS = {"x": ("m", "um", 1e-6), "y": ("m", "um", 1e-6), "phi": ("rad", "urad", 1e-6)}


@dataclass(frozen=True, eq=False)
class StepRun:
    """A step of an axis by `height` (m, rad) at time[sample]: with noise, and its twin without.

    `shown` and `shown_ideal` are the raw positions (N,), as the sensors show them.
    """

    axis: str
    height: float
    sample: int
    noisy: Trajectory
    ideal: Trajectory
    shown: Array
    shown_ideal: Array
    reference: Array

    @property
    def time(self) -> Array:
        """The times from the step on, s."""
        return self.noisy.time[self.sample :]

    @property
    def response(self) -> Array:
        """The twin's position from the step on, as its sensors show it."""
        return self.shown_ideal[self.sample :]


Parts = Mapping[str, Callable[[Rig], Sequence[Experiment]]]
"""What makes experiments, by what is said of it while it runs."""


@dataclass(frozen=True)
class Limits:
    """Rise in s, overshoot and settling in s, into `band` of the step, that a paper states, and voltage in V."""

    rise: float
    overshoot: float
    settling: float
    band: float
    voltage: float


def run(parts: Parts, loop: Rig, progress: Callable[[str], None]) -> list[Experiment]:
    """Run every experiment; `progress` hears what comes next."""
    found: list[Experiment] = []
    for name, part in parts.items():
        progress(name)
        found += part(loop)
    return found


def steps(
    loop: Rig, heights: Mapping[str, float], titles: Mapping[str, str], limits: Limits | None
) -> list[Experiment]:
    """Return a step of each axis by its height in m or rad."""
    return [step_experiment(loop, step(loop, a, h), f"step_{a}", titles[a], limits) for a, h in heights.items()]


def step(loop: Rig, axis: str, height: float, after: float = AFTER) -> StepRun:
    """Run a step from the middle of the travel, and its twin, followed for `after` seconds."""
    time = sample_times(SETTLE + after, loop.period_s)
    reference = np.where(time < SETTLE, 0.0, height)
    noisy, ideal = (simulate(each, SETTLE + after, {axis: reference}, {}) for each in (loop, loop.ideal))
    shown, shown_ideal = (seen(loop, run)[f"{axis}_raw"] for run in (noisy, ideal))
    k = int(np.argmax(time >= SETTLE))
    return StepRun(axis, height, k, noisy, ideal, shown, shown_ideal, reference)


def step_experiment(loop: Rig, run: StepRun, name: str, title: str, limits: Limits | None) -> Experiment:
    """Return a step as an experiment; without `limits` its metrics are figures alone."""
    found = step_metrics(run)
    _, small, scale = UNITS[run.axis]
    others = [a for a in planar_stage.AXES[:3] if a != run.axis]
    ending = run.shown_ideal[-1] / run.height - 1, run.ideal[run.axis][-1] / run.height - 1
    figures = found | {
        "error at the end as shown, without noise, of the step": ending[0],
        "true error at the end, without noise, of the step": ending[1],
        f"noise of the true {run.axis} in the last second, {small} rms": _last(loop, run.noisy[run.axis]) / scale,
        **{f"{a} moves without noise by, {UNITS[a][1]}": np.abs(run.ideal[a]).max() / UNITS[a][2] for a in others},
        **planar_voltages.figures(loop.plant, run.noisy, run.ideal),
    }
    checks = [Check("error at the end as shown, without noise", abs(ending[0]), 1e-3, "1", "of the step")]
    if limits:
        about = "of the twin without noise, as its sensors show it"
        settled = metrics.settling_time(run.time, run.response - run.height, limits.band * abs(run.height))
        checks += [
            Check("rise", found["rise, s"], limits.rise, "s", about),
            Check("overshoot", found["overshoot"], limits.overshoot, "1", about),
            Check("settling", settled, limits.settling, "s", f"into {100 * limits.band:g} %, {about}"),
            Check("largest voltage", float(figures["largest voltage, V"]), limits.voltage, "V", "Table 1; with noise"),
        ]
    about = f"{run.axis} by {run.height / scale:.4g} {small}, {_about(loop)}"
    return Experiment(
        name,
        title,
        about,
        run.noisy,
        (run.axis,),
        {run.axis: run.reference},
        {key: float(value) for key, value in figures.items()},
        (*checks, *usual(run.noisy)),
    )


def step_metrics(run: StepRun) -> dict[str, float]:
    """Return rise, overshoot and settling into 2 and 5 % of the twin without noise."""
    error = run.response - run.height
    return {
        "rise, s": metrics.rise_time(run.time, run.response, 0.0, run.height),
        "overshoot": metrics.overshoot(run.response, 0.0, run.height),
        "settling into 2 %, s": metrics.settling_time(run.time, error, 0.02 * abs(run.height)),
        "settling into 5 %, s": metrics.settling_time(run.time, error, 0.05 * abs(run.height)),
    }


def settled(loop: Rig, values: Array) -> Array:
    """Return a record of the standstill without its first second."""
    return values[round(1.0 / loop.period_s) :]


def filtered_at_rest(loop: Rig, duration_s: float) -> dict[str, Array]:
    """Return x and y (N,) in m at rest behind the filter (6)-(16): no better position was recorded."""
    shown = seen(loop, simulate(loop, duration_s, {}, {}))
    return {axis: settled(loop, shown[axis]) for axis in "xy"}


def standstills(loop: Rig) -> list[Experiment]:
    """Return the standstill with the noise of Fig. 5, that of section 3.2, and behind amplifiers of some supplies."""
    cases = {"standstill": loop, "standstill_printed_noise": with_noise(loop, NOISE_PRINTED)}
    found = []
    for name, case in cases.items():
        run, title = simulate(case, REST, {}, {}), f"At rest, noise of {1e6 * noise_of(case):g} um rms"
        figures = rest_figures(case, run) | planar_voltages.figures(case.plant, run, None)
        found.append(_standstill(case, name, title, run, figures))
    for volts in SUPPLIES:
        case = replace(loop, plant=planar_voltages.amplified(volts))
        run, title = simulate(case, SHORT, {}, {}, substeps=FINE), f"At rest, amplifiers of {volts:g} V"
        found.append(_standstill(case, f"standstill_{volts:g}_V", title, run, rest_figures(case, run)))
    return found


def _standstill(loop: Rig, name: str, title: str, run: Trajectory, figures: dict[str, float]) -> Experiment:
    about = f"{len(run.time) * loop.period_s:g} s, {_about(loop)}"
    return Experiment(name, title, about, run, ("x", "y", "phi"), {}, figures, usual(run))


def rest_figures(loop: Rig, run: Trajectory) -> dict[str, float]:
    """Return the noise of the six axes at rest, and that of x, y and phi as measured and as filtered."""
    shown, found = seen(loop, run), {}
    for axis, (_, small, scale) in UNITS.items():
        for what, values in (("true", run[axis]), ("filtered", shown[axis]), ("raw", shown[f"{axis}_raw"])):
            found[f"{what} {axis}, {small} rms"] = float(np.std(settled(loop, values))) / scale
    return found | {f"true {a}, {u} rms": 1e6 * float(np.std(settled(loop, run[a]))) for a, u in _UPRIGHT.items()}


_UPRIGHT = {"z": "um", "theta": "urad", "psi": "urad"}


def usual(run: Trajectory) -> tuple[Check, ...]:
    """Return what every run without a planted failure must keep: no fault, no more current than Table 1 allows."""
    return (
        Check("samples with a fault", float(np.count_nonzero(run.faults)), 0.0, "1"),
        Check("largest phase current", planar_voltages.largest_current(run), planar_stage.LIMIT, "A", "Table 1"),
    )


def _last(loop: Rig, values: Array) -> float:
    return float(np.std(values[-round(1.0 / loop.period_s) :]))


def _about(loop: Rig) -> str:
    """Return what the sensors are."""
    return f"noise of {1e6 * noise_of(loop):g} um rms in a Hall sensor's position, 16 bits, one sample of delay"
