"""Experiments over a finite magnet matrix, compared with the same ones on the closed force law.

The plant is that of `models.finite_stage` with blocks as built and end turns raised by the height of the winding. The
controllers are not changed: they allocate by the closed law, commutate by the measured position and are calibrated for
an infinite matrix. Each experiment is run on both plants with the same noise. Its limits:

    a step            the limits that the paper states, as on the closed law. The other axes of x, y and phi move by
                      less than their noise. z, theta and psi move by more than their noise but stay in their range
    standstill        the noise of x, y and phi is at most 15 % larger, because the forces and thus the loop gains are
                      7 % larger than in the allocation. theta and psi stay within a tenth of their range
    a motion          measured errors of x and y are at most the sensor noise of 13 um; true errors are at most the
                      1.4 mm that Kawato and Kim state for such sensors; the yaw stays within its range of 20 mrad

`motor_deviations` compares the motors with the closed law. Results: docs/decisions/planar_leadlag.md.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from designs.planar_6dof import experiments as shared
from designs.planar_6dof.allocation import HORIZONTAL
from designs.planar_6dof.experiments import MICRO_UNITS
from designs.planar_6dof.interface import NOISE
from designs.planar_6dof.loop import Array, measured_positions, simulate
from models import finite_stage, planar_stage
from synth.check import Check
from synth.declare.experiments import Run
from synth.simulate.experiments import Experiment
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory

AXES = planar_stage.AXES
UNITS = {axis: unit.removeprefix("u") for axis, unit in MICRO_UNITS.items()}
NOISE_RATIO_LIMIT = 1.15
RANGE = {s.name: s.high for s in planar_stage.STATES}
ACCURACY = 1.4e-3  # m
AS_BUILT, IDEAL, CLOSED = "blocks as made", "ideal blocks", "closed law"


def with_finite_matrix(loop: Rig, as_built: bool = True) -> Rig:
    """Return the loop over the finite matrix, with blocks as built or ideal."""
    return replace(loop, plant=finite_stage.plant(as_built))


def step(loop: Rig, name: str, axis: str, height: float, title: str, limits: shared.Limits | None) -> Experiment:
    """Return a step over the finite matrix, compared with that of `loop`."""
    finite, closed = with_finite_matrix(loop), shared.step(loop, axis, height)
    run = shared.step(finite, axis, height)
    experiment = shared.step_experiment(finite, run, name, f"{title}, finite matrix", limits)
    excursion, excursion_closed, noise = _excursions(run), _excursions(closed), _noise(finite, run.noisy, -1.0)
    deviation = np.abs(run.response - closed.response).max() / abs(height)
    figures = {**experiment.figures, "response departs from the closed law's by, of the step": float(deviation)}
    checks = list(experiment.checks)
    for other in (a for a in AXES if a != axis):
        figures[f"{other} moves from the step on, without noise, {MICRO_UNITS[other]}"] = 1e6 * excursion[other]
        figures[f"{other} does so on the closed law, {MICRO_UNITS[other]}"] = 1e6 * excursion_closed[other]
        limit, about = (noise[other], "its noise, rms") if other in HORIZONTAL else (RANGE[other], "its range")
        what = f"{other} moves from the step on"
        checks.append(Check(what, excursion[other], limit, UNITS[other], f"without noise; {about}"))
    return replace(experiment, figures=figures, checks=tuple(checks))


def _excursions(run: shared.StepRun) -> dict[str, float]:
    """Return the largest excursion of each axis from its position at the step, without noise, m and rad."""
    k = run.sample
    return {axis: float(np.abs(run.ideal[axis][k:] - run.ideal[axis][k]).max()) for axis in AXES}


def standstill(loop: Rig, name: str) -> Experiment:
    """Return the standstill over the finite matrix, compared with that of `loop`."""
    finite = with_finite_matrix(loop)
    run, still = (simulate(each, shared.REST, {}, {}) for each in (finite, finite.ideal))
    noise, closed = _noise(finite, run, 1.0), _noise(loop, simulate(loop, shared.REST, {}, {}), 1.0)
    figures = shared.rest_figures(finite, run)
    for axis, unit in MICRO_UNITS.items():
        figures[f"true {axis} on the closed law, {unit} rms"] = 1e6 * closed[axis]
        figures[f"{axis} wanders without noise by, {unit}"] = 1e6 * float(
            np.ptp(shared.after_settling(finite, still[axis]))
        )
    for axis in "xy":
        figures[f"{axis} settles without noise at, um"] = 1e6 * float(still[axis][-1])
    about = "times that on the closed law"
    checks = [Check(f"noise of {a}", noise[a] / closed[a], NOISE_RATIO_LIMIT, "1", about) for a in HORIZONTAL]
    checks += [Check(f"noise of {a}", noise[a], RANGE[a] / 10, "rad", "a tenth of its range") for a in ("theta", "psi")]
    title, shown = "At rest, finite matrix", ("x", "y", "psi")
    return Experiment(name, title, f"{shared.REST:g} s", run, shown, {}, figures, (*checks, *shared.common_checks(run)))


STANDSTILL = Run("standstill_finite", standstill)


def _noise(loop: Rig, run: Trajectory, since: float) -> dict[str, float]:
    """Return the rms of each axis about its mean, m and rad, from a time in s on; negative times count from the end."""
    first = round(since / loop.period_s)
    return {axis: float(np.std(run[axis][first:])) for axis in AXES}


@dataclass(frozen=True, eq=False)
class Motion:
    """A run along set-points x, y (N,) in m, evaluated over the samples `window` (N,)."""

    run: Trajectory
    references: Mapping[str, Array]
    window: NDArray[np.bool_]

    def error(self, axis: str, at: Array | None = None) -> Array:
        """Return the true error of x or y in the window, m, or the error of another position `at` (N,)."""
        return np.asarray(((self.run[axis] if at is None else at) - self.references[axis])[self.window])


def rms_errors(loop: Rig, motion: Motion) -> dict[str, float]:
    """Return the rms errors of x and y, measured and true, m."""
    measured, errors = measured_positions(loop, motion.run), {}
    for axis in "xy":
        for what, at in (("as shown", measured[f"{axis}_raw"]), ("truly", motion.run[axis])):
            errors[f"{axis} {what}"] = float(np.sqrt(np.mean(motion.error(axis, at) ** 2)))
    return errors


def motion_experiment(loop: Rig, experiment: Experiment, noiseless: Mapping[str, Motion]) -> Experiment:
    """Return an experiment of a motion over the finite matrix with its limits.

    `noiseless` are the runs without noise, by AS_BUILT and other names.
    """
    errors = {name: rms_errors(loop, each) for name, each in noiseless.items()}
    figures = {f"error of {a} ({name}), um rms": 1e6 * v for name, e in errors.items() for a, v in e.items()}
    as_built, twin = errors[AS_BUILT], noiseless[AS_BUILT]
    checks = [Check(f"error of {a} as shown", as_built[f"{a} as shown"], NOISE, "m", "rms without noise") for a in "xy"]
    for axis in "xy":
        largest = float(np.abs(twin.error(axis)).max())
        checks.append(Check(f"greatest true error of {axis}", largest, ACCURACY, "m", "without noise"))
    checks.append(
        Check("greatest yaw", float(np.abs(experiment.trajectory["phi"]).max()), RANGE["phi"], "rad", "its range")
    )
    for axis in AXES[3:]:
        figures[f"greatest {axis}, {MICRO_UNITS[axis]}"] = 1e6 * float(np.abs(experiment.trajectory[axis]).max())
    title, figures = f"{experiment.title}, finite matrix", {**experiment.figures, **figures}
    return replace(experiment, title=title, figures=figures, checks=(*experiment.checks, *checks))


@cache
def motor_deviations(radius: float) -> dict[str, float]:
    """Return how the motors deviate from the closed law, with the platen up to `radius` in m from the middle."""
    return {
        f"{what} ({name}){unit}": value
        for name, as_built in ((AS_BUILT, True), (IDEAL, False))
        for (what, unit), value in finite_stage.closed_law_deviations(as_built, radius).items()
    }
