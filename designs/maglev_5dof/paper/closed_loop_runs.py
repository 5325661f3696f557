"""Computations of the audit: parameters by group, and cached runs of the closed loop, ideal or with encoders.

Ideal loops are those of `ideal_loop`, without sampling, filters and encoders. Their currents are not limited, but stay
below 7 A peak. In the linear loop, e'' = w of (13) replaces both the law and the plant.

"Encoders" is the compiled controller at 1 kHz with encoders of 10 um, its filters and one sample of delay. Its law is
(12) as printed, or with `corrected` the shipped law, which includes the squares of i_d that (11) neglects and partly
compensates the guide springs. Both laws use the squared currents of the previous sample, and the gap of each motor.

Tracking errors are means of |e|. Runs with encoders take 60 s, and the mean is over the last 50 s. Ideal runs take
20 s. They are periodic after 12 s, and the mean is over the remaining six periods. Shorter runs keep these proportions.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Literal, NamedTuple

import numpy as np
from scipy.linalg import expm

from designs.maglev import motions, platen
from designs.maglev_5dof import control
from designs.maglev_5dof.paper import ideal_loop
from designs.maglev_5dof.paper.ideal_loop import Motion, Regulator
from models import maglev_stage
from synth.base import cache
from synth.declare.experiments import Sine
from synth.declare.stage import Stage
from synth.emit import write
from synth.execute import host
from synth.plant import Plant
from synth.report.audit import Formula, is_close
from synth.simulate import metrics
from synth.simulate.rig import Rig
from synth.simulate.scenario import sample_times
from synth.statespace import Array
from synth.synthesise.feedback import inverse_lqr

SpringModel = Literal["known", "unknown", "absent"]

GROUPS: dict[str, tuple[str, ...]] = {
    "field": ("b0", "t1", "h_m", "L_A", "p_m", "tau", "tau_p", "H_c", "mu_rec", "W", "p")
}
GROUPS["magnets"] = (*GROUPS["field"][:-2], "mu0")
GROUPS["forces"] = (*GROUPS["magnets"], "W", "w_c", "p", "z1")
GROUPS["level"] = (*GROUPS["forces"], "M_x", "M_z", "M_y", "G")  # parameters without rotation
GROUPS["turning"] = (*GROUPS["level"], "r", "I_z", "k_s_theta")  # parameters with a rotation theta
BY_GROUP = {name: Formula(f"dict({', '.join(f'{n}={n}' for n in group)})") for name, group in GROUPS.items()}
SPRING_STIFFNESSES = ("k_s_phi", "k_s_theta")
FRICTION = {"x": 1.8, "z": 1.3}  # N, guide friction by axis, fitted to the two printed errors of the ellipse
CACHED_RUNS = 32  # most results in each cache; rows of the audit share them
SAMPLE = 1e-3  # s, sample period of the continuous responses


class Poles(NamedTuple):
    """Closed-loop poles of an axis in 1/s: the real one, and of each conjugate pair the one with Im > 0."""

    fast: float
    first: complex
    second: complex


@dataclass(frozen=True, eq=False)
class AuditSetup:
    """The stage and the plant under audit, and the duration of a tracking run with encoders in s.

    `cells` is the resolution of the slotted field. Guide springs are "known" (in plant and law (12)), "unknown" (in the
    plant alone) or "absent" (in neither).
    """

    stage: Stage
    plant: Plant
    duration_s: float = motions.TRACK_TO
    cells: int = 12

    @cached_property
    def without_springs(self) -> Plant:
        """The plant without guide springs."""
        return self.plant.with_parameters(**dict.fromkeys(SPRING_STIFFNESSES, 0.0))

    def pair(self, springs: SpringModel) -> tuple[Plant, Plant]:
        """Return the true plant, and the plant for which the law (12) is computed."""
        plant = self.without_springs if springs == "absent" else self.plant
        return plant, self.plant if springs == "known" else self.without_springs


@lru_cache(maxsize=CACHED_RUNS)
def ideal(setup: AuditSetup, four: bool, springs: SpringModel, lv3: str = "csch2") -> Motion:
    """Return an ideal run under (12): 4-DOF tracking if `four`, otherwise the 3-DOF ellipse.

    `lv3` names the factor in L_v3, of both plant and law.
    """
    courses = {axis: platen.COURSES[axis] for axis in ("y", "x", "z")}
    if four:
        courses |= {"phi": Sine(0.0, platen.OMEGA0), "theta": platen.COURSES["theta"]}
    return run(setup.pair(springs), courses, {"y": 0.020, "x": -0.03}, setup.duration_s / 3, lv3)


def run(
    plants: tuple[Plant, Plant],
    courses: Mapping[str, Sine],
    start: Mapping[str, float],
    duration_s: float,
    lv3: str = "csch2",
) -> Motion:
    """Return the motion of the first plant under the law (12) for the second; `courses` gives the controlled axes."""
    regulators = [regulator(axis(name)) for name in courses]
    return ideal_loop.run(*plants, regulators, courses, start, (duration_s, SAMPLE), lv3)


def ideal_errors(setup: AuditSetup, four: bool, springs: SpringModel, lv3: str = "csch2") -> dict[str, float]:
    """Return the mean |e| of an ideal run by axis, um or urad; NaN if the gap leaves its range."""
    motion, start = ideal(setup, four, springs, lv3), setup.duration_s / 5
    if np.isfinite(motion.exit_time):
        return dict.fromkeys(motion.error, np.nan)
    return {axis: 1e6 * metrics.mean_absolute(motion.time, e, start) for axis, e in motion.error.items()}


def meets(errors: Mapping[str, float], printed: Mapping[str, float]) -> bool:
    """Return whether tracking errors agree with the printed ones within a tenth of the printed values."""
    return all(is_close(errors[name], 0.1, value) for name, value in printed.items())


@lru_cache(maxsize=CACHED_RUNS)
def encoder_errors(
    setup: AuditSetup, four: bool, corrected: bool, springs: SpringModel = "known", guided: bool = False
) -> dict[str, float]:
    """Return the mean |e| by axis of the loop with encoders, um or urad.

    `guided` adds the friction of the guides and the cogging of the slots. `four` is as for `ideal`.
    """
    plant, assumed = setup.pair(springs)
    disturbance = maglev_stage.guide_disturbance(setup.plant, FRICTION, setup.cells) if guided else None
    rig = Rig(setup.stage, plant, _controller(assumed, corrected), disturbance=disturbance)
    trajectory, courses = motions.tracking(rig, four, setup.duration_s)
    return {a: 1e6 * e for a, e in motions.mean_errors(trajectory, courses, setup.duration_s / 6).items()}


@lru_cache(maxsize=CACHED_RUNS)
def _controller(assumed: Plant, corrected: bool) -> host.Controller:
    emitted = _emit(tuple((p.name, p.value) for p in assumed.parameters), corrected)
    return host.load(emitted.files, emitted.manifest)


@cache.cached
def _emit(parameters: tuple[tuple[str, float], ...], corrected: bool) -> write.EmittedCode:
    """Return the C of the controller for these parameters of the plant.

    The C calls sin, exp and so on of the C library; polynomials for them are fitted for the shipped parameters only.
    """
    assumed = maglev_stage.plant().with_parameters(**dict(parameters))
    emitted = write.emit(control.controller(assumed, corrected).block, np.float64, libm=True)
    return replace(emitted, program=None)


def axis(name: str) -> control.Axis:
    """Return the controlled axis called `name`."""
    return next(a for a in control.AXES if a.name == name)


@lru_cache(maxsize=CACHED_RUNS)
def regulator(axis: control.Axis) -> Regulator:
    """Return the state feedback of an axis, with A of its design plant."""
    return Regulator(axis.name, control.gain(axis).K, control.axis_plant(axis).A)


def closed_loop(name: str) -> Array:
    """Return A + B K (5, 5) of the linear loop of an axis."""
    plant = control.axis_plant(axis(name))
    return np.asarray(plant.A + plant.B @ control.gain(axis(name)).K)


def remaining(name: str, harmonic: int) -> float:
    """Return the amplitude of e per unit acceleration at the input, in s^2: linear loop, `harmonic` times omega0."""
    A, B = closed_loop(name), np.array(control.axis_plant(axis(name)).B)
    return float(abs(np.linalg.solve(1j * harmonic * platen.OMEGA0 * np.eye(len(A)) - A, B)[0, 0]))


def poles(name: str) -> Poles:
    """Return the closed-loop poles of an axis that follow from its LQR weights."""
    eigenvalues = np.linalg.eigvals(closed_loop(name))
    first, second = sorted(eigenvalues[eigenvalues.imag > 1e-9], key=lambda pole: -pole.imag)
    return Poles(float(eigenvalues[np.abs(eigenvalues.imag) < 1e-9].real[0]), first, second)


def weights_of(name: str, fast: float, *pairs: complex) -> inverse_lqr.DiagonalWeights:
    """Return the diagonal weights for which the LQR of an axis has a real pole `fast` and conjugate `pairs`, in 1/s."""
    conjugated = [s for pair in pairs for s in (pair, pair.conjugate())]
    return inverse_lqr.diagonal_weights(control.axis_plant(axis(name)), [complex(fast), *conjugated])


def linear_step(name: str, step: float) -> metrics.StepResponse:
    """Return the metrics over 10 s of a step in m or rad of the linear loop, from rest, with all but e zero."""
    time = sample_times(10.0, SAMPLE)
    transition = expm(closed_loop(name) * SAMPLE)
    state, error = np.array([-step, 0.0, 0.0, 0.0, 0.0]), np.zeros(len(time))
    for k in range(len(time)):
        error[k] = state[0]
        state = transition @ state
    return metrics.step_response(time, error + step, 0.0, step, motions.BAND, motions.COUNTS[name])


def gap_step(plant: Plant, low: float, size: float) -> metrics.StepResponse:
    """Return the metrics over 6 s of a gap step from `low` by `size` in m, for the nonlinear plant under (12)."""
    high = low + size
    motion = run((plant, plant), {"y": Sine(0.0, platen.OMEGA0, 0.0, high)}, {"y": low}, 6.0)
    gap = motion.error["y"] + low + size
    return metrics.step_response(motion.time, gap, low, high, motions.BAND, platen.RESOLUTION)
