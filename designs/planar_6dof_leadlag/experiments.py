"""The lead-lag controller's experiments, Y section 5.2: steps (Fig. 8), the large circle (Fig. 9), and failures.

The circle begins in the middle of the travel; its radius grows during GROWTH. At the borders of the eight sections of a
pitch the sensor that is read changes. There the error of the raw position may jump by at most three times the rms
change from sample to sample elsewhere, so the borders do not exceed the noise.
"""

from dataclasses import replace
from math import pi

import numpy as np
from numpy.typing import NDArray

from designs.planar_6dof import experiments as shared
from designs.planar_6dof import failures, finite, loads, voltages
from designs.planar_6dof.finite import Motion
from designs.planar_6dof.loop import Array, growing_circle, measured_positions, simulate
from designs.planar_6dof.paper.records import FIGURE_8
from synth.check import Check
from synth.declare.experiments import Run
from synth.simulate.experiments import Experiment
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory, sample_times

TITLES = {"x": "x by 20 um", "y": "y by 100 um", "phi": "phi by 0.01 degrees"}
# Y-9 does not print its settling band; into 2 % the step needs 0.33 s. The overshoot "around 20 %" of Y-9b has a
# tolerance of a quarter.
LIMITS = shared.Limits(rise=0.025, overshoot=0.25, settling=0.220, voltage=voltages.RATED_VOLTAGE)
RADIUS, RATE, GROWTH = 0.1, 0.2094, 5.0  # m, rad/s, s
REVOLUTION = 2 * pi / RATE
PAIRS = {"x": ("V_ax", "V_bx"), "y": ("V_ay", "V_cy")}  # s and -c of an axis
JUMP = 3.0


def circle(loop: Rig) -> Motion:
    """Run one revolution after the radius has grown to RADIUS."""
    time = sample_times(GROWTH + REVOLUTION, loop.period_s)
    references = growing_circle(time, RADIUS, RATE, GROWTH)
    return Motion(simulate(loop, GROWTH + REVOLUTION, references, {}), references, time >= GROWTH)


def is_switching_sample(run: Trajectory, axis: str) -> NDArray[np.bool_]:
    """Return for each sample (N,) whether the sensor that is read differs from that of the sample before."""
    s, c = (np.abs(run.measured[name]) for name in PAIRS[axis])
    first = s <= c
    return np.asarray(np.diff(first, prepend=first[0]))


def jumps(loop: Rig, run: Trajectory, axis: str) -> tuple[Array, Array]:
    """Return the changes of the raw position's error at switching samples, and at the others, m."""
    error = measured_positions(loop, run)[f"{axis}_raw"] - run[axis]
    change, switching = np.diff(error, prepend=error[0]), is_switching_sample(run, axis)
    return change[switching], change[~switching]


def circle_experiment(loop: Rig, name: str) -> Experiment:
    """Return the circle of Fig. 9."""
    return _circle_experiment(loop, name, circle(loop), circle(loop.ideal))


def _circle_experiment(loop: Rig, name: str, noisy: Motion, ideal: Motion) -> Experiment:
    """Return a circle with its run without noise as an experiment."""
    pitch = loop.plant.parameter("l").value
    figures, checks = voltages.voltage_figures(loop.plant, noisy.run, ideal.run), []
    for axis in "xy":
        switching, elsewhere = jumps(loop, noisy.run, axis)
        rms = float(np.sqrt(np.mean(elsewhere**2)))
        worst = float(np.abs(switching).max())
        smooth = jumps(loop, ideal.run, axis)[0]
        figures |= {
            f"pitches crossed, {axis}": float(np.ptp(noisy.run[axis])) / pitch,
            f"switching samples, {axis}": float(len(switching)),
            f"largest jump at one, {axis}, um": 1e6 * worst,
            f"rms elsewhere, {axis}, um": 1e6 * rms,
            f"largest jump at one without noise, {axis}, um": 1e6 * float(np.abs(smooth).max()),
            f"error of {axis}, um rms": 1e6 * float(np.sqrt(np.mean(noisy.error(axis) ** 2))),
            f"error of {axis} without noise, um rms": 1e6 * float(np.sqrt(np.mean(ideal.error(axis) ** 2))),
        }
        checks.append(Check(f"jump of {axis} at a switching sample", worst / rms, JUMP, "1", "times the rms elsewhere"))
        largest = float(np.abs(noisy.error(axis)).max())
        checks.append(Check(f"greatest error of {axis}", largest, pitch / 16, "m", "half a section: no count is lost"))
    voltage = figures["largest voltage without noise, V"]
    checks.append(Check("largest voltage without noise", voltage, voltages.RATED_VOLTAGE, "V", "Table 1"))
    figures["greatest yaw, urad"] = 1e6 * float(np.abs(noisy.run["phi"]).max())
    title = "Circle of 200 mm diameter at 0.2094 rad/s (Fig. 9)"
    about = f"a revolution of {REVOLUTION:.4g} s after {GROWTH:g} s in which the radius grows"
    return Experiment(
        name,
        title,
        about,
        noisy.run,
        ("x", "y"),
        noisy.references,
        figures,
        (*checks, *shared.common_checks(noisy.run)),
    )


def finite_circle(loop: Rig, name: str) -> Experiment:
    """Return the circle over the finite matrix, with the deviations of its motors."""
    finite_loop, ideal = finite.with_finite_matrix(loop), finite.with_finite_matrix(loop, as_built=False)
    loops = {finite.CLOSED: loop, finite.AS_BUILT: finite_loop, finite.IDEAL: ideal}
    twins = {name: circle(each.ideal) for name, each in loops.items()}
    experiment = _circle_experiment(finite_loop, name, circle(finite_loop), twins[finite.AS_BUILT])
    described = finite.motion_experiment(loop, experiment, twins)
    return replace(described, figures={**described.figures, **finite.motor_deviations(RADIUS)})


ALL = (
    *shared.steps(FIGURE_8, {axis: f"{size} (Fig. 8)" for axis, size in TITLES.items()}, LIMITS),
    Run("circle", circle_experiment),
    *shared.STANDSTILLS,
    *failures.ALL,
    *loads.experiments(force_y=24.0),
    *shared.steps(FIGURE_8, TITLES, LIMITS, finite.step, "_finite"),
    Run("circle_finite", finite_circle),
    finite.STANDSTILL,
)
