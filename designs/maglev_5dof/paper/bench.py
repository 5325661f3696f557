"""Computations of the audit: parameters by group, and loops of a plant, ideal or with encoders, cached.

Ideal loops are those of `models.maglev_loop`, without sampling, filters and encoders. Their currents are not limited,
and none reaches 7 A peak. The linear loop has e'' = w of (13) instead of law and plant.

"Encoders" is the compiled controller at 1 kHz with encoders of 10 um, its filters and one sample of delay. Its law is
(12) as printed, or with `corrected` the shipped law, which includes the squares of i_d that (11) neglects and
compensates the guide springs in part. Both laws use squares of currents of the sample before, and each motor's own gap.

Tracking errors are means of |e|, with encoders from 10 to 60 s. Ideal runs are periodic by 12 s, and the mean is over
the six whole periods up to 20 s. Shorter runs keep these proportions.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Literal, NamedTuple

import numpy as np
from scipy.linalg import expm

from designs.maglev_5dof import control, experiments
from models import maglev_loop, maglev_stage
from models.maglev_loop import Motion, Regulator
from synth import cache
from synth.declaration import Stage
from synth.emit import write
from synth.execute import host
from synth.plant import Plant
from synth.report.formulas import Formula, is_close
from synth.simulate import metrics
from synth.simulate.conditions import Sine
from synth.simulate.rig import Rig
from synth.simulate.scenario import sample_times
from synth.statespace import Array
from synth.synthesise.feedback import inverse_lqr

Springs = Literal["known", "unknown", "absent"]

GROUPS: dict[str, tuple[str, ...]] = {
    "field": ("b0", "t1", "h_m", "L_A", "p_m", "tau", "tau_p", "H_c", "mu_rec", "W", "p")
}
GROUPS["magnets"] = (*GROUPS["field"][:-2], "mu0")
GROUPS["forces"] = (*GROUPS["magnets"], "W", "w_c", "p", "z1")
GROUPS["level"] = (*GROUPS["forces"], "M_x", "M_z", "M_y", "G")  # parameters while the platen does not turn
GROUPS["turning"] = (*GROUPS["level"], "r", "I_z", "k_s_theta")  # parameters while it turns by theta
BY_GROUP = {name: Formula(f"dict({', '.join(f'{n}={n}' for n in group)})") for name, group in GROUPS.items()}
SPRINGS = ("k_s_phi", "k_s_theta")
FRICTION = {"x": 1.8, "z": 1.3}  # N of guide friction, fitted to the two printed errors of the ellipse
CACHED_RUNS = 32  # size of the caches that the rows share
SAMPLE = 1e-3  # s, sample period of the continuous responses


class Poles(NamedTuple):
    """Closed-loop poles of an axis in 1/s: the real one, and one of each conjugate pair."""

    fast: float
    first: complex
    second: complex


@dataclass(frozen=True, eq=False)
class AuditSetup:
    """The stage and the plant under audit, and how long tracking runs, s.

    `cells` is the resolution of the slotted field. Guide springs are "known" (in plant and law (12)), "unknown" (in the
    plant alone) or "absent" (in neither).
    """

    stage: Stage
    plant: Plant
    duration_s: float = experiments.TRACK_TO
    cells: int = 12

    @cached_property
    def without_springs(self) -> Plant:
        """The plant without guide springs."""
        return self.plant.with_parameters(**dict.fromkeys(SPRINGS, 0.0))

    def pair(self, springs: Springs) -> tuple[Plant, Plant]:
        """Return the plant, and the plant that (12) assumes."""
        plant = self.without_springs if springs == "absent" else self.plant
        return plant, self.plant if springs == "known" else self.without_springs


@lru_cache(maxsize=CACHED_RUNS)
def ideal(bench: AuditSetup, four: bool, springs: Springs, lv3: str = "csch2") -> Motion:
    """Return the ideal 4-DOF tracking or ellipse under (12), with this factor in L_v3 in plant and law."""
    courses = {axis: experiments.COURSES[axis] for axis in ("y", "x", "z")}
    if four:
        courses |= {"phi": Sine(0.0, control.OMEGA0), "theta": experiments.COURSES["theta"]}
    return run(bench.pair(springs), courses, {"y": 0.020, "x": -0.03}, bench.duration_s / 3, lv3)


def run(
    plants: tuple[Plant, Plant],
    courses: Mapping[str, Sine],
    start: Mapping[str, float],
    duration_s: float,
    lv3: str = "csch2",
) -> Motion:
    """Return the motion of a plant under (12) for an assumed plant, in the ideal loops of the axes with courses."""
    regulators = [regulator(axis(name)) for name in courses]
    return maglev_loop.run(*plants, regulators, courses, start, (duration_s, SAMPLE), lv3)


def ideal_errors(bench: AuditSetup, four: bool, springs: Springs, lv3: str = "csch2") -> dict[str, float]:
    """Return the mean |e| of an ideal run by axis, um or urad; NaN when the gap left its range."""
    motion, start = ideal(bench, four, springs, lv3), bench.duration_s / 5
    if np.isfinite(motion.exit_time):
        return dict.fromkeys(motion.error, np.nan)
    return {axis: 1e6 * metrics.mean_absolute(motion.time, e, start) for axis, e in motion.error.items()}


def meets(errors: Mapping[str, float], printed: Mapping[str, float]) -> bool:
    """Return whether tracking errors agree with the printed ones within a tenth of these."""
    return all(is_close(errors[name], 0.1, value) for name, value in printed.items())


@lru_cache(maxsize=CACHED_RUNS)
def encoder_errors(
    bench: AuditSetup, four: bool, corrected: bool, springs: Springs = "known", guided: bool = False
) -> dict[str, float]:
    """Return the mean |e| by axis of the compiled loop, um or urad; `guided` adds friction and cogging."""
    plant, known = bench.pair(springs)
    added = maglev_stage.guide_disturbance(bench.plant, FRICTION, bench.cells) if guided else None
    rig = Rig(bench.stage, plant, _controller(known, corrected), disturbance=added)
    trajectory, courses = experiments.tracking(rig, four, bench.duration_s)
    return {a: 1e6 * e for a, e in experiments.mean_errors(trajectory, courses, bench.duration_s / 6).items()}


@lru_cache(maxsize=CACHED_RUNS)
def _controller(known: Plant, corrected: bool) -> host.Controller:
    emitted = _emit(tuple((p.name, p.value) for p in known.parameters), corrected)
    return host.load(emitted.files, emitted.manifest)


@cache.cached
def _emit(parameters: tuple[tuple[str, float], ...], corrected: bool) -> write.EmittedCode:
    """Return the C of the controller for these parameters of the plant.

    It calls the functions of the C library, because no polynomials are fitted for new parameters.
    """
    known = maglev_stage.plant().with_parameters(**dict(parameters))
    emitted = write.emit(control.controller(known, corrected).block, np.float64, libm=True)
    return replace(emitted, program=None)


def axis(name: str) -> control.Axis:
    """Return the controlled axis called `name`."""
    return next(a for a in control.AXES if a.name == name)


@lru_cache(maxsize=CACHED_RUNS)
def regulator(axis: control.Axis) -> Regulator:
    """Return the regulator of an axis."""
    return Regulator(axis.name, control.gain(axis).K, control.axis_plant(axis).A)


def closed_loop(name: str) -> Array:
    """Return A + B K (5, 5) of the linear loop of an axis."""
    plant = control.axis_plant(axis(name))
    return np.asarray(plant.A + plant.B @ control.gain(axis(name)).K)


def poles(name: str) -> Poles:
    """Return the closed-loop poles of an axis that follow from its LQR weights."""
    poles = np.linalg.eigvals(closed_loop(name))
    first, second = sorted(poles[poles.imag > 1e-9], key=lambda pole: -pole.imag)
    return Poles(float(poles[np.abs(poles.imag) < 1e-9].real[0]), first, second)


def weights_of(name: str, fast: float, *pairs: complex) -> inverse_lqr.DiagonalWeights:
    """Return the diagonal weights for which the LQR of an axis has a real pole and pairs of others, in 1/s."""
    conjugated = [s for pair in pairs for s in (pair, pair.conjugate())]
    return inverse_lqr.diagonal_weights(control.axis_plant(axis(name)), [complex(fast), *conjugated])


def linear_step(name: str, step: float) -> metrics.StepResponse:
    """Return the metrics over 10 s of a step in m or rad on the linear loop, from rest with xi = 0, de = 0."""
    time = sample_times(10.0, SAMPLE)
    transition = expm(closed_loop(name) * SAMPLE)
    state, error = np.array([-step, 0.0, 0.0, 0.0, 0.0]), np.zeros(len(time))
    for k in range(len(time)):
        error[k] = state[0]
        state = transition @ state
    return metrics.step_response(time, error + step, 0.0, step, experiments.BAND, experiments.COUNTS[name])


def gap_step(plant: Plant, low: float, size: float) -> metrics.StepResponse:
    """Return the metrics over 6 s of a step of the gap from `low` by `size` in m, on the nonlinear plant under (12)."""
    high = low + size
    motion = run((plant, plant), {"y": Sine(0.0, control.OMEGA0, 0.0, high)}, {"y": low}, 6.0)
    gap = motion.error["y"] + low + size
    return metrics.step_response(motion.time, gap, low, high, experiments.BAND, control.RESOLUTION)
