"""The paper's loop in continuous time with ideal sensing, free of sampling, filters and encoders.

    axis s:    w_s = K_s (e_s, de_s, xi_s),   dxi_s = Phi xi_s + N e_s                   (14)-(16), Gamma xi within K
    law:       v = D^-1 (w_y - a1, w_phi - b1, w_theta - c1),   u_x = w_x/h_x, u_z = w_z/h_z,   i_d of (8)     (12)
    plant:     (6), (7) with every quadratic term

The linear loop is the double integrator e'' = w of (13) instead of law and plant. Currents are not limited: in the runs
of the audit none reaches 7 A peak.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from designs.maglev_5dof import control
from models import maglev_stage, pmlsm
from synth.plant import Plant
from synth.simulate import metrics
from synth.simulate.scenario import sample_times
from synth.synthesise import feedback_linearisation

Array = NDArray[np.float64]
SAMPLE = 1e-3  # s, at which the continuous responses are judged
RELATIVE, ABSOLUTE = 1e-8, 1e-11  # of the integration


@dataclass(frozen=True)
class Reference:
    """mean + amplitude sin(omega0 t + phase), m or rad; constant for the amplitude 0."""

    mean: float = 0.0
    amplitude: float = 0.0
    phase: float = 0.0

    def at(self, time: Array) -> Array:
        """Return the values at the times (N,) in s."""
        return self.mean + self.amplitude * np.sin(control.OMEGA0 * time + self.phase)


@dataclass(frozen=True, eq=False)
class Motion:
    """Errors in m and rad by axis at the times (N,); `left_at` is when the gap left its range, s, or infinity."""

    time: Array
    error: Mapping[str, Array]
    left_at: float

    def mean_error(self, axis: str, start: float) -> float:
        """Return the mean |e| of an axis from `start` s on; NaN when the gap left its range."""
        return metrics.mean_absolute(self.time, self.error[axis], start) if np.isinf(self.left_at) else np.nan


def axis(name: str) -> control.Axis:
    """Return the controlled axis called `name`."""
    return next(a for a in control.AXES if a.name == name)


def closed_loop(name: str) -> Array:
    """Return A + B K (5, 5) of the linear loop of an axis."""
    plant = control.axis_plant(axis(name))
    return np.asarray(plant.A + plant.B @ control.gain(axis(name)).K)


def linear_step(name: str, step: float, band: float, resolution: float) -> metrics.StepResponse:
    """Return the metrics over 10 s of a step in m or rad on the linear loop, from rest with xi = 0, de = 0."""
    time = sample_times(10.0, SAMPLE)
    transition = expm(closed_loop(name) * SAMPLE)
    state, error = np.array([-step, 0.0, 0.0, 0.0, 0.0]), np.zeros(len(time))
    for k in range(len(time)):
        error[k] = state[0]
        state = transition @ state
    return metrics.step_response(time, error + step, 0.0, step, band, resolution)


def run(
    plant: Plant,
    known: Plant,
    references: Mapping[str, Reference],
    start: Mapping[str, float],
    duration_s: float,
    lv3: str = "csch2",
) -> Motion:
    """Integrate the axes named in `references` from rest at `start` (m, rad); the others rest at 0.

    `known` holds the parameters that (12) knows; `lv3` is the reading of L_v3 in plant and law. Without phi and theta
    among the axes v_phi = v_theta = 0.
    """
    names = tuple(references)
    t, x = ca.SX.sym("t"), ca.SX.sym("x", 5 * len(names))
    waves = np.array([[w.mean, w.amplitude, w.phase] for w in references.values()])
    symbolic = _derivative(tuple(axis(n) for n in names), lv3)
    derivative = ca.Function("derivative", [t, x], [symbolic(t, x, plant.values, known.values, waves)], {"cse": True})
    state = np.zeros(5 * len(names))
    state[: 2 * len(names) : 2] = [start.get(n, 0.0) for n in names]
    low, high = control.GAP

    def leaves(t: float, x: Array) -> float:
        return float((x[0] - low) * (high - x[0]))

    leaves.terminal = True  # type: ignore[attr-defined]
    time = sample_times(duration_s, SAMPLE)
    found = solve_ivp(
        lambda t, x: np.asarray(derivative(t, x)).ravel(),
        (0.0, time[-1]),
        state,
        method="LSODA",
        t_eval=time,
        events=leaves,
        rtol=RELATIVE,
        atol=ABSOLUTE,
    )
    error = {n: found.y[2 * k] - references[n].at(found.t) for k, n in enumerate(names)}
    left = float(found.t_events[0][0]) if len(found.t_events[0]) else np.inf
    return Motion(found.t, error, left)


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
    inputs = law(known, lv3, position, w)
    pose = {n: position.get(n, ca.SX(0)) for n in ("y", "phi", "theta")}
    reading = pmlsm.Reading("coth2" if lv3 == "coth2" else "csch2")
    second = maglev_stage.accelerations(pose, inputs, true, reading)
    slopes = [slope for a in axes for slope in (speed[a.name], second[a.name])]
    arguments = [t, state, ca.vcat(list(true.values())), ca.vcat(list(known.values())), waves]
    return ca.Function("derivative", arguments, [ca.vcat([*slopes, *d_xi])], {"cse": True})


def law(
    known: Mapping[str, ca.SX], lv3: str, position: Mapping[str, ca.SX], w: Mapping[str, ca.SX]
) -> dict[str, ca.SX]:
    """Return i_d1..i_d4, u_x, u_z in A from positions and demanded accelerations. Source: (8), (12).

    `known` holds the parameters by name. Without theta among the positions v_phi = v_theta = 0, and (12) is its first
    row.
    """
    model = maglev_stage.simplified(maglev_stage.input_polynomial(known, lv3))
    found = inverse(model, w)
    if "theta" not in position:
        c = model.coefficients
        alone = ca.substitute((w["y"] - c["a1"]) / c["a3"], ca.vcat(list(model.u.values())), _listed(found, model.u))
        found |= {"v_y": alone, "v_phi": ca.SX(0), "v_theta": ca.SX(0)}
    inputs = maglev_stage.input_transformation(found) | {n: found[n] for n in model.u}
    pose = ca.vcat([position.get(n, ca.SX(0)) for n in model.x])
    at_pose = ca.substitute(ca.vcat(list(inputs.values())), ca.vcat(list(model.x.values())), pose)
    return dict(zip(inputs, ca.vertsplit(at_pose), strict=True))


def inverse(model: maglev_stage.InputPolynomial, w: Mapping[str, ca.SX]) -> dict[str, ca.SX]:
    """Return v_y, v_phi, v_theta, u_x, u_z in A from the demanded accelerations, in the symbols of `model`.

    Source: (12).
    """
    second, names = model.accelerations(), ("y", "phi", "theta")
    law = feedback_linearisation.linearise([second[n] for n in names], model.v, [w[n] for n in names])
    u = {f"u_{n}": w[n] / model.coefficients[f"h_{n}"] for n in ("x", "z")}
    old, new = ca.vcat(list(model.u.values())), ca.vcat([u[n] for n in model.u])
    return u | {n: ca.substitute(e, old, new) for n, e in law.inputs.items()}


def _listed(found: Mapping[str, ca.SX], wanted: Iterable[str]) -> ca.SX:
    return ca.vcat([found[n] for n in wanted])
