"""The loops under audit, made once for a plant: ideal ones in continuous time, and compiled ones on encoders.

Ideal, with ideal sensing, free of sampling, filters and encoders; currents are not limited, and none reaches 7 A peak:

    axis s:    w_s = K_s (e_s, de_s, xi_s),   dxi_s = Phi xi_s + N e_s                   (14)-(16), Gamma xi within K
    law:       v = D^-1 (w_y - a1, w_phi - b1, w_theta - c1),   u_x = w_x/h_x, u_z = w_z/h_z,   i_d of (8)     (12)
    plant:     (6), (7) with every quadratic term; the linear loop is e'' = w of (13) instead of law and plant

"Encoders" is the compiled controller at 1 kHz on encoders of 10 um with its filters and one sample of delay: with the
printed law (12), or `restored`, with the shipped law, which puts back the squares of i_d that (11) drops and cancels
the guide springs in part. Both laws take squares of currents one sample late, and each motor at its own measured gap.

Tracking errors are means of |e|, with encoders from 10 to 60 s. Ideal runs are periodic by 12 s, and the mean is over
the six whole periods up to 20 s. Shorter runs keep these proportions.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from typing import Literal

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from designs.maglev_5dof import control, experiments
from models import maglev_polynomial, maglev_stage
from synth.declaration import Stage
from synth.execute import build, host
from synth.plant import Plant
from synth.simulate import metrics
from synth.simulate.conditions import Sine
from synth.simulate.rig import Rig
from synth.simulate.scenario import sample_times

Array = NDArray[np.float64]
Springs = Literal["known", "unknown", "absent"]

MAGNETS = ("b0", "t1", "h_m", "L_A", "p_m", "tau", "tau_p", "H_c", "mu_rec", "mu0")
FORCES = (*MAGNETS, "W", "w_c", "p", "z1")
FIELD = (*(name for name in MAGNETS if name != "mu0"), "W", "p")
MM = 1e-3
SPRINGS = ("k_s_phi", "k_s_theta")
FRICTION = {"x": 1.8, "z": 1.3}  # N of guide friction, fitted to the two printed errors of the ellipse
KEPT = 32  # runs that the rows share
SAMPLE = 1e-3  # s, at which the continuous responses are judged
RELATIVE, ABSOLUTE = 1e-8, 1e-11  # of the integration


@dataclass(frozen=True, eq=False)
class Bench:
    """The stage and the plant under audit, and the length of the tracking runs in s.

    `cells` is the fineness of the slotted field. Of the guide springs, "known" means in plant and (12), "unknown" in
    the plant alone, "absent" in neither.
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
        """Return the plant, and the one that (12) takes it for."""
        plant = self.without_springs if springs == "absent" else self.plant
        return plant, self.plant if springs == "known" else self.without_springs


@dataclass(frozen=True, eq=False)
class Motion:
    """Errors in m and rad by axis at the times (N,); `left_at` is when the gap left its range, s, or infinity."""

    time: Array
    error: Mapping[str, Array]
    left_at: float


@lru_cache(maxsize=KEPT)
def ideal(bench: Bench, four: bool, springs: Springs, lv3: str = "csch2") -> Motion:
    """Return the ideal 4-DOF tracking or ellipse under (12), with this reading of L_v3 in plant and law."""
    courses = {axis: experiments.COURSES[axis] for axis in ("y", "x", "z")}
    if four:
        courses |= {"phi": Sine(0.0, control.OMEGA0), "theta": experiments.COURSES["theta"]}
    return run(*bench.pair(springs), courses, {"y": 0.020, "x": -0.03}, bench.duration_s / 3, lv3)


def ideal_errors(bench: Bench, four: bool, springs: Springs, lv3: str = "csch2") -> dict[str, float]:
    """Return the mean |e| of an ideal run by axis, um or urad; NaN when the gap left its range."""
    motion, start = ideal(bench, four, springs, lv3), bench.duration_s / 5
    if np.isfinite(motion.left_at):
        return dict.fromkeys(motion.error, np.nan)
    return {axis: 1e6 * metrics.mean_absolute(motion.time, e, start) for axis, e in motion.error.items()}


@lru_cache(maxsize=KEPT)
def encoder_errors(
    bench: Bench, four: bool, restored: bool, springs: Springs = "known", guided: bool = False
) -> dict[str, float]:
    """Return the mean |e| by axis of the compiled loop, um or urad; `guided` adds friction and cogging."""
    plant, known = bench.pair(springs)
    added = maglev_stage.guides(bench.plant, FRICTION, bench.cells) if guided else None
    rig = Rig(bench.stage, plant, _controller(known, restored), disturbance=added)
    trajectory, courses = experiments.tracking(rig, four, bench.duration_s)
    return {a: 1e6 * e for a, e in experiments.mean_errors(trajectory, courses, bench.duration_s / 6).items()}


@lru_cache(maxsize=KEPT)
def _controller(known: Plant, restored: bool) -> host.Controller:
    # The library computes the functions, which for new parameters none has fitted.
    return build.compiled(control.controller(known, restored).block, np.float64, libm=True)


def axis(name: str) -> control.Axis:
    """Return the controlled axis called `name`."""
    return next(a for a in control.AXES if a.name == name)


def closed_loop(name: str) -> Array:
    """Return A + B K (5, 5) of the linear loop of an axis."""
    plant = control.axis_plant(axis(name))
    return np.asarray(plant.A + plant.B @ control.gain(axis(name)).K)


def linear_step(name: str, step: float) -> metrics.StepResponse:
    """Return the metrics over 10 s of a step in m or rad on the linear loop, from rest with xi = 0, de = 0."""
    time = sample_times(10.0, SAMPLE)
    transition = expm(closed_loop(name) * SAMPLE)
    state, error = np.array([-step, 0.0, 0.0, 0.0, 0.0]), np.zeros(len(time))
    for k in range(len(time)):
        error[k] = state[0]
        state = transition @ state
    return metrics.step_response(time, error + step, 0.0, step, experiments.BAND, experiments.COUNTS[name])


def run(
    plant: Plant,
    known: Plant,
    courses: Mapping[str, Sine],
    start: Mapping[str, float],
    duration_s: float,
    lv3: str = "csch2",
) -> Motion:
    """Integrate the axes named in `courses` from rest at `start` (m, rad); the others rest at 0.

    `known` holds the parameters that (12) knows; `lv3` is the reading of L_v3 in plant and law. Without phi and theta
    among the axes v_phi = v_theta = 0.
    """
    names, n = tuple(courses), len(courses)
    t, x = ca.SX.sym("t"), ca.SX.sym("x", 5 * n)
    waves = np.array([[w.offset, w.amplitude, w.phase] for w in courses.values()])
    symbolic = _derivative(tuple(axis(n) for n in names), lv3)
    derivative = ca.Function("derivative", [t, x], [symbolic(t, x, plant.values, known.values, waves)], {"cse": True})
    state = np.zeros(5 * n)
    state[: 2 * n : 2] = [start.get(name, 0.0) for name in names]
    low, high = control.GAP

    def leaves(t: float, x: Array) -> float:
        return float((x[0] - low) * (high - x[0]))

    def slope(t: float, x: Array) -> Array:
        return np.asarray(derivative(t, x)).ravel()

    leaves.terminal = True  # type: ignore[attr-defined]
    time = sample_times(duration_s, SAMPLE)
    accuracy = {"rtol": RELATIVE, "atol": ABSOLUTE}
    path = solve_ivp(slope, (0.0, time[-1]), state, method="LSODA", t_eval=time, events=leaves, **accuracy)
    error = {name: path.y[2 * k] - courses[name](path.t) for k, name in enumerate(names)}
    return Motion(path.t, error, float(path.t_events[0][0]) if len(path.t_events[0]) else np.inf)


@cache
def _derivative(axes: tuple[control.Axis, ...], lv3: str) -> ca.Function:
    """Return d/dt of (q, v of each axis, then xi of each) for (t, state, parameters, those known to (12), waves)."""
    count = len(axes)
    t, state, waves = ca.SX.sym("t"), ca.SX.sym("state", 5 * count), ca.SX.sym("waves", count, 3)
    true, known = maglev_stage.parameter_symbols(), maglev_stage.parameter_symbols()
    position = {a.name: state[2 * k] for k, a in enumerate(axes)}
    speed = {a.name: state[2 * k + 1] for k, a in enumerate(axes)}
    w, d_xi = dict.fromkeys(maglev_stage.RATE, ca.SX(0)), []
    for k, a in enumerate(axes):
        reference = waves[k, 0] + waves[k, 1] * ca.sin(control.OMEGA0 * t + waves[k, 2])
        xi = state[2 * count + 3 * k : 2 * count + 3 * k + 3]
        z = ca.vertcat(position[a.name] - reference, speed[a.name] - ca.jacobian(reference, t), xi)
        w[a.name] = ca.mtimes(ca.DM(np.asarray(control.gain(a).K)), z)
        d_xi.append(ca.mtimes(ca.DM(np.asarray(control.axis_plant(a).A)), z)[2:])
    inputs = maglev_polynomial.law(known, lv3, position, w)
    pose = {n: position.get(n, ca.SX(0)) for n in ("y", "phi", "theta")}
    second = maglev_stage.accelerations(pose, inputs, true, maglev_stage.named_reading(lv3))
    slopes = [slope for a in axes for slope in (speed[a.name], second[a.name])]
    arguments = [t, state, ca.vcat(list(true.values())), ca.vcat(list(known.values())), waves]
    return ca.Function("derivative", arguments, [ca.vcat([*slopes, *d_xi])], {"cse": True})
