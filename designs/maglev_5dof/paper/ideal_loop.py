"""Simulation of the levitated platen under its ideal loops: continuous time, ideal sensing, unlimited currents.

    axis s:    w_s = K_s (e_s, de_s, xi_s),   dxi_s = Phi xi_s + N e_s                   (14)-(16), Gamma xi within K
    law:       v = D^-1 (w_y - a1, w_phi - b1, w_theta - c1),   u_x = w_x/h_x, u_z = w_z/h_z,   i_d of (8)     (12)
    plant:     (6), (7) with every quadratic term

Source: Fulford, Maggiore, Apkarian, "Control of a 5DOF Magnetically Levitated Positioning Stage", (6)-(16).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np
from scipy.integrate import solve_ivp

from designs.maglev_5dof.paper import polynomial
from models import maglev_stage
from synth.declare.experiments import Sine
from synth.plant import Plant
from synth.simulate.scenario import sample_times
from synth.statespace import Array

RELATIVE, ABSOLUTE = 1e-8, 1e-11  # of the integration


@dataclass(frozen=True, eq=False)
class Regulator:
    """The regulator of an axis: K (1, 5), and A (5, 5) of (e, de, xi) without it, whose last rows are (N, 0, Phi)."""

    axis: str
    K: Array
    A: Array


@dataclass(frozen=True, eq=False)
class Motion:
    """Errors in m and rad by axis at the times (N,); `exit_time` is when the gap left its range, s, or infinity."""

    time: Array
    error: Mapping[str, Array]
    exit_time: float


def run(
    plant: Plant,
    known: Plant,
    regulators: Sequence[Regulator],
    courses: Mapping[str, Sine],
    start: Mapping[str, float],
    time: tuple[float, float],
    lv3: str = "csch2",
) -> Motion:
    """Integrate the axes of some regulators along their reference courses from rest at `start` (m, rad).

    The other axes rest at 0. `known` holds the parameters that (12) uses, `time` the duration and the sample period in
    s, and `lv3` names the factor in L_v3 of plant and law. All courses have one frequency. Without phi and theta among
    the axes, v_phi = v_theta = 0.
    """
    names, n = [r.axis for r in regulators], len(regulators)
    t, x = ca.SX.sym("t"), ca.SX.sym("x", 5 * n)
    waves = np.array([[courses[s].offset, courses[s].amplitude, courses[s].phase] for s in names])
    symbolic = _derivative(tuple(regulators), courses[names[0]].frequency, lv3)
    derivative = ca.Function("derivative", [t, x], [symbolic(t, x, plant.values, known.values, waves)], {"cse": True})
    state = np.zeros(5 * n)
    state[: 2 * n : 2] = [start.get(name, 0.0) for name in names]
    gap = next(s for s in plant.states if s.name == "y")

    def leaves(t: float, x: Array) -> float:
        return float((x[0] - gap.low) * (gap.high - x[0]))

    def slope(t: float, x: Array) -> Array:
        return np.asarray(derivative(t, x)).ravel()

    leaves.terminal = True  # type: ignore[attr-defined]
    times, accuracy = sample_times(*time), {"rtol": RELATIVE, "atol": ABSOLUTE}
    path = solve_ivp(slope, (0.0, times[-1]), state, method="LSODA", t_eval=times, events=leaves, **accuracy)
    error = {name: path.y[2 * k] - courses[name](path.t) for k, name in enumerate(names)}
    return Motion(path.t, error, float(path.t_events[0][0]) if len(path.t_events[0]) else np.inf)


@lru_cache(maxsize=8)
def _derivative(regulators: tuple[Regulator, ...], frequency: float, lv3: str) -> ca.Function:
    """Return d/dt of (q, v of each axis, then xi of each) for (t, state, parameters, parameters in (12), waves)."""
    count = len(regulators)
    t, state, waves = ca.SX.sym("t"), ca.SX.sym("state", 5 * count), ca.SX.sym("waves", count, 3)
    true, known = maglev_stage.parameter_symbols(), maglev_stage.parameter_symbols()
    position = {r.axis: state[2 * k] for k, r in enumerate(regulators)}
    speed = {r.axis: state[2 * k + 1] for k, r in enumerate(regulators)}
    w, d_xi = dict.fromkeys(maglev_stage.RATE, ca.SX(0)), []
    for k, r in enumerate(regulators):
        reference = waves[k, 0] + waves[k, 1] * ca.sin(frequency * t + waves[k, 2])
        xi = state[2 * count + 3 * k : 2 * count + 3 * k + 3]
        z = ca.vertcat(position[r.axis] - reference, speed[r.axis] - ca.jacobian(reference, t), xi)
        w[r.axis] = ca.mtimes(ca.DM(np.asarray(r.K)), z)
        d_xi.append(ca.mtimes(ca.DM(np.asarray(r.A)), z)[2:])
    inputs = polynomial.law(known, lv3, position, w)
    pose = {n: position.get(n, ca.SX(0)) for n in ("y", "phi", "theta")}
    second = maglev_stage.accelerations(pose, inputs, true, maglev_stage.force_variant(lv3))
    slopes = [slope for s in position for slope in (speed[s], second[s])]
    arguments = [t, state, ca.vcat(list(true.values())), ca.vcat(list(known.values())), waves]
    return ca.Function("derivative", arguments, [ca.vcat([*slopes, *d_xi])], {"cse": True})
