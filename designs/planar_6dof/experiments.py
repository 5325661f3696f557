"""Experiments common to both planar controllers: steps, standstill, and the phase voltages that they need.

A step comes SETTLE after the start from rest. Rise, overshoot and settling are those of the measured position in a twin
run without noise. The calibration error of the field, 0.8 % in scale at the place of the step, is not visible in the
measured position, as it was not in the paper's; it is reported as the true error. All other figures are those of the
run with noise, whose trajectory is shown. The motors see the harmonics of the field, and every current has one sample
of delay.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from designs.planar_6dof import voltages
from designs.planar_6dof.interface import NOISE_PRINTED
from designs.planar_6dof.loop import Array, measured_positions, position_noise, simulate, with_noise
from models import planar_stage
from synth.check import Check
from synth.declare.experiments import Run
from synth.simulate import metrics
from synth.simulate.experiments import Experiment
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory, sample_times

SETTLE, AFTER = 0.5, 2.0  # s before a step, and after it
REST, SHORT = 10.0, 5.0  # s of standstill, whose first second is left out; s of standstill behind amplifiers
SUPPLIES, FINE = (voltages.RATED_VOLTAGE, 24.0), 8  # V; substeps of a sample, for an amplifier's lag of 0.25 ms
MICRO_UNITS = {"x": "um", "y": "um", "phi": "urad", "z": "um", "theta": "urad", "psi": "urad"}  # 1e-6 m, 1e-6 rad
HORIZONTAL = planar_stage.AXES[:3]


@dataclass(frozen=True, eq=False)
class StepRun:
    """A step of an axis by `height` (m, rad) at time[sample], with noise and without.

    `measured` and `measured_ideal` are the measured raw positions (N,).
    """

    axis: str
    height: float
    sample: int
    noisy: Trajectory
    ideal: Trajectory
    measured: Array
    measured_ideal: Array
    reference: Array

    @property
    def time(self) -> Array:
        """The times from the step on, s."""
        return self.noisy.time[self.sample :]

    @property
    def response(self) -> Array:
        """The measured position of the run without noise, from the step on."""
        return self.measured_ideal[self.sample :]


@dataclass(frozen=True)
class Limits:
    """Limits: rise time in s, overshoot, settling time in s into 5 % of the step, and voltage in V."""

    rise: float
    overshoot: float
    settling: float
    voltage: float


def _make_step(loop: Rig, name: str, axis: str, height: float, title: str, limits: Limits | None) -> Experiment:
    return step_experiment(loop, step(loop, axis, height), name, title, limits)


def steps(
    heights: Mapping[str, float],
    titles: Mapping[str, str],
    limits: Limits | None,
    make: Callable[..., Experiment] = _make_step,
    suffix: str = "",
) -> tuple[Run, ...]:
    """Return a step experiment of each axis by its height in m or rad, made by `make`; names end with a suffix."""
    return tuple(
        Run(f"step_{axis}{suffix}", partial(make, axis=axis, height=height, title=titles[axis], limits=limits))
        for axis, height in heights.items()
    )


def step(loop: Rig, axis: str, height: float, after: float = AFTER) -> StepRun:
    """Run a step from the middle of the travel, with and without noise, followed for `after` seconds."""
    time = sample_times(SETTLE + after, loop.period_s)
    reference = np.where(time < SETTLE, 0.0, height)
    noisy, ideal = (simulate(each, SETTLE + after, {axis: reference}, {}) for each in (loop, loop.ideal))
    measured, measured_ideal = (measured_positions(loop, run)[f"{axis}_raw"] for run in (noisy, ideal))
    return StepRun(axis, height, int(np.argmax(time >= SETTLE)), noisy, ideal, measured, measured_ideal, reference)


def step_experiment(loop: Rig, run: StepRun, name: str, title: str, limits: Limits | None) -> Experiment:
    """Return a step as an experiment; without `limits` its metrics are not checked."""
    measured, small = step_metrics(run), MICRO_UNITS[run.axis]
    measured_error, true_error = run.measured_ideal[-1] / run.height - 1, run.ideal[run.axis][-1] / run.height - 1
    last = run.noisy[run.axis][-round(1.0 / loop.period_s) :]
    figures = measured | {
        "error at the end as shown, without noise, of the step": measured_error,
        "true error at the end, without noise, of the step": true_error,
        f"noise of the true {run.axis} in the last second, {small} rms": float(np.std(last)) / 1e-6,
    }
    for other in (a for a in HORIZONTAL if a != run.axis):
        figures[f"{other} moves without noise by, {MICRO_UNITS[other]}"] = np.abs(run.ideal[other]).max() / 1e-6
    figures |= voltages.voltage_figures(loop.plant, run.noisy, run.ideal)
    checks = [Check("error at the end as shown, without noise", abs(measured_error), 1e-3, "1", "of the step")]
    if limits:
        about, settling = "of the twin without noise, as its sensors show it", measured["settling into 5 %, s"]
        checks += [
            Check("rise", measured["rise, s"], limits.rise, "s", about),
            Check("overshoot", measured["overshoot"], limits.overshoot, "1", about),
            Check("settling", settling, limits.settling, "s", f"into 5 %, {about}"),
            Check("largest voltage", float(figures["largest voltage, V"]), limits.voltage, "V", "Table 1; with noise"),
        ]
    about = f"{run.axis} by {run.height / 1e-6:.4g} {small}, {_about(loop)}"
    figures = {key: float(value) for key, value in figures.items()}
    references = {run.axis: run.reference}
    return Experiment(
        name, title, about, run.noisy, (run.axis,), references, figures, (*checks, *common_checks(run.noisy))
    )


def step_metrics(run: StepRun) -> dict[str, float]:
    """Return rise, overshoot and settling into 2 and 5 % of the run without noise."""
    error, band = run.response - run.height, abs(run.height)
    return {
        "rise, s": metrics.rise_time(run.time, run.response, 0.0, run.height),
        "overshoot": metrics.overshoot(run.response, 0.0, run.height),
        "settling into 2 %, s": metrics.settling_time(run.time, error, 0.02 * band),
        "settling into 5 %, s": metrics.settling_time(run.time, error, 0.05 * band),
    }


def after_settling(loop: Rig, values: Array) -> Array:
    """Return a record without its first second."""
    return values[round(1.0 / loop.period_s) :]


def _standstill(loop: Rig, name: str, noise: float | None = None) -> Experiment:
    """Return the standstill with the noise of Fig. 5, or with another position noise in m."""
    case = loop if noise is None else with_noise(loop, noise)
    run = simulate(case, REST, {}, {})
    figures = rest_figures(case, run) | voltages.voltage_figures(case.plant, run, None)
    return _at_rest(case, name, f"At rest, noise of {1e6 * position_noise(case):g} um rms", run, figures)


def _with_amplifiers(loop: Rig, name: str, volts: float) -> Experiment:
    """Return the standstill with amplifiers of a supply voltage in V."""
    case = replace(loop, plant=voltages.plant_with_amplifiers(volts))
    run = simulate(case, SHORT, {}, {}, substeps=FINE)
    return _at_rest(case, name, f"At rest, amplifiers of {volts:g} V", run, rest_figures(case, run))


def _at_rest(loop: Rig, name: str, title: str, run: Trajectory, figures: Mapping[str, float]) -> Experiment:
    about = f"{len(run.time) * loop.period_s:g} s, {_about(loop)}"
    return Experiment(name, title, about, run, HORIZONTAL, {}, figures, common_checks(run))


STANDSTILLS = (
    Run("standstill", _standstill),
    Run("standstill_printed_noise", partial(_standstill, noise=NOISE_PRINTED)),
    *(Run(f"standstill_{volts:g}_V", partial(_with_amplifiers, volts=volts)) for volts in SUPPLIES),
)


def rest_figures(loop: Rig, run: Trajectory) -> dict[str, float]:
    """Return the noise of the six axes at rest, and that of x, y and phi as measured and as filtered."""
    measured, figures = measured_positions(loop, run), {}
    for axis in HORIZONTAL:
        for what, values in (("true", run[axis]), ("filtered", measured[axis]), ("raw", measured[f"{axis}_raw"])):
            figures[f"{what} {axis}, {MICRO_UNITS[axis]} rms"] = float(np.std(after_settling(loop, values))) / 1e-6
    upright = planar_stage.AXES[3:]
    return figures | {
        f"true {a}, {MICRO_UNITS[a]} rms": 1e6 * float(np.std(after_settling(loop, run[a]))) for a in upright
    }


def common_checks(run: Trajectory) -> tuple[Check, ...]:
    """Return the checks of every run without a failure: no fault, and no current above the limit of Table 1."""
    return (
        Check("samples with a fault", float(np.count_nonzero(run.faults)), 0.0, "1"),
        Check("largest phase current", voltages.largest_current(run), planar_stage.LIMIT, "A", "Table 1"),
    )


def _about(loop: Rig) -> str:
    """Return a phrase that describes the sensors."""
    return f"noise of {1e6 * position_noise(loop):g} um rms in a Hall sensor's position, 16 bits, one sample of delay"
