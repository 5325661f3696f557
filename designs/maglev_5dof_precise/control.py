"""Precise controller of the maglev stage as Blocks, from encoders to currents.

    encoders -> guard -> kinematics -> observers -> servos -> exact inversion and limits -> safe output

Every coordinate has an observer of position, rate and disturbance, which predicts the state at which the command acts,
and a servo with internal models at 0, 1, 2 and 3 times the frequency of the references. The inversion solves the whole
force law of each motor, one quadratic equation in its direct current, at the predicted gap.
"""

from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np

from designs.maglev_5dof import control as paper
from designs.maglev_5dof.control import (
    COMPENSATED, CURRENT, CURRENTS, DIRECT, HELD, INTERFACE, MOTORS, OMEGA0, OUTPUTS, TIME, Axis,
)
from models import maglev_stage, pmlsm
from synth import stage
from synth.block import Block, Constant, Exprs, Step, build, clip
from synth.blocks import predictive_servo, predictor
from synth.plant import Plant
from synth.signals import Signal, signal_names
from synth.synthesise.feedback import lqr
from synth.statespace import StateSpace, readonly
from synth.blocks import axis_regulator
from synth.synthesise.regulation import internal_model
from synth.timing import Continuous

NAME = "maglev_5dof_precise"
FREQUENCIES = (0.0, OMEGA0, 2 * OMEGA0, 3 * OMEGA0)  # rad/s: constants, the references and the harmonics of wrong models
CANCELLED = 0.8  # of the estimated disturbance


@dataclass(frozen=True)
class Loop:
    weights: tuple[float, float]
    speeds: tuple[float, ...]
    bandwidth: float
    rate: float
    disturbance: float
    limits: predictive_servo.Limits


L = predictive_servo.Limits
LOOPS = {
    "y": Loop((1e6, 1e4), (6, 4, 4, 4), 400.0, 4.0, 50.0, L(3e-4, 0.1, 10.0)),
    "x": Loop((1e5, 800), (5, 4, 4, 4), 400.0, 2.0, 20.0, L(1e-3, 0.3, 10.0)),
    "z": Loop((1e5, 800), (5, 4, 4, 4), 400.0, 2.0, 20.0, L(1e-3, 0.3, 10.0)),
    "phi": Loop((1e5, 5e3), (4, 2, 2, 2), 400.0, 4.0, 200.0, L(1e-4, 0.1, 10.0)),
    "theta": Loop((3e5, 5e3), (6, 4, 4, 4), 250.0, 4.0, 200.0, L(3e-4, 0.1, 10.0)),
}
AXES = paper.AXES


def axis_plant(axis: Axis) -> StateSpace:
    A, B, C, D = (readonly(m) for m in ([[0, 1], [0, 0]], [[0], [1]], [[1, 0]], [[0]]))
    integrator = StateSpace(A, B, C, D, ("e", "de"), (axis.demand.name,), ("e",), Continuous())
    return internal_model.augmented(integrator, FREQUENCIES)


@cache
def gain(axis: Axis) -> lqr.Gain:
    loop = LOOPS[axis.name]
    Q = np.zeros((9, 9))
    Q[0, 0], Q[1, 1] = loop.weights
    Q[2:, 2:] = axis_regulator.internal_weights(dict(zip(FREQUENCIES, loop.speeds, strict=True)), loop.weights[0])
    return lqr.lqr(axis_plant(axis), Q, np.eye(1), exact=True)


def acceleration(axis: Axis) -> Signal:
    about = f"acceleration by u_{axis.name}"
    return Signal(f"a_{axis.name}", "m/s^2", -1e3, 1e3, about) if axis.excess else axis.demand


def observer(axis: Axis) -> Block:
    from dataclasses import replace
    before = replace(acceleration(axis), name=f"{acceleration(axis).name}_before")
    loop = LOOPS[axis.name]
    return predictor.block(axis.name, TIME, axis.position, before, bandwidth=loop.bandwidth, rate=loop.rate,
                           disturbance=loop.disturbance, ahead=True)


def servo(axis: Axis) -> Block:
    loop = LOOPS[axis.name]
    return predictive_servo.block(axis.name, TIME, gain(axis), FREQUENCIES, measured=axis.position, reference=axis.reference,
                                  demand=axis.demand, cancelled=CANCELLED, limits=loop.limits, disturbance=loop.disturbance)


def inversion(plant: Plant) -> Block:
    """Return the Block from demanded accelerations to limited currents: the whole of F(2), (6) and (7) inverted."""
    lifting, values = Signal("i", "A", -DIRECT, DIRECT), maglev_stage.nominal(plant)
    thrusting = Signal("i", "A", -CURRENT, CURRENT)
    values |= {n: part * values[n] for n, part in COMPENSATED.items()}
    ahead = {a.name: Signal(f"{a.name}_ahead", a.position.unit, a.position.low, a.position.high) for a in AXES if a.name not in "xz"}

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        w = {a.name: u[a.demand.name] for a in AXES}
        y, phi, theta = (u[s.name] for s in ahead.values())
        r = values["r"]
        gaps = [ca.fmax(ca.fmin(g, s.high), s.low) for g, s in zip((y - r * phi, y + r * theta, y + r * phi, y - r * theta), HELD)]
        motors = [pmlsm.force_law(g, values) for g in gaps]
        demand = maglev_stage.thrust_currents(w, motors, values)
        i_q = [clip(demand[thrust], thrusting) for thrust in maglev_stage.QUADRATURE]
        i_d = {f"i_d{j}": clip(i, lifting) for j, i in enumerate(exact_currents(w, {"phi": phi, "theta": theta}, i_q, motors, values), 1)}
        pairs = {"u_x": (i_d["i_d2"], i_d["i_d4"]), "u_z": (i_d["i_d1"], i_d["i_d3"])}
        thrust = {n: paper._limit_thrust(demand[n], *pair) for n, pair in pairs.items()}
        a = maglev_stage.thrust_accelerations(thrust, motors, values)
        out = {f"{n}_computed": i for n, i in (i_d | thrust).items()} | {f"a_{n}": v for n, v in a.items()}
        return Step(out)

    inputs = [*ahead.values(), *(a.demand for a in AXES)]
    outputs = [*(INTERFACE.computed_output(s.name) for s in CURRENTS), *(acceleration(a) for a in AXES if a.excess)]
    return build("inversion", TIME, law, inputs=inputs, outputs=outputs, tag="exact inversion of F(2), (6), (7)")


def exact_currents(w, x, i_q, motors, p):
    """Halves of forces: half f_j = half (F_Vj + a_j + c_j i_q^2) = half b i - half c i^2."""
    load = [m.half_a + m.half_c * i**2 for m, i in zip(motors, i_q, strict=True)]
    s1, s2, s3, s4 = (1 / m.b**2 for m in motors)
    n = p["M_y"] / 2 * (w["y"] - p["G"]) + (load[0] + load[1] + load[2] + load[3])
    d = p["I_x"] / (2 * p["r"]) * (w["phi"] + p["k_s_phi"] * x["phi"]) + (load[2] - load[0])
    e = p["I_z"] / (2 * p["r"]) * (w["theta"] + p["k_s_theta"] * x["theta"]) + (load[1] - load[3])
    odd = ((s2 + s4) * n + (s2 - s4) * e - (s3 - s1) * d) / (s1 + s3 + (s2 + s4))
    even = n - odd
    forces = [(odd - d) / 2, (even + e) / 2, (odd + d) / 2, (even - e) / 2]  # halves of b i - c i^2
    return [root(f, m) for f, m in zip(forces, motors, strict=True)]


def root(half_force, m):
    """The smaller root i of b i - c i^2 = 2 half_force; beyond the largest force, the current that gives it."""
    D = ca.fmax(m.b**2 - 16 * m.half_c * half_force, 0)
    return 4 * half_force / (m.b + ca.sqrt(D))


def laws(plant: Plant) -> list[Block]:
    free = [acceleration(a) for a in AXES]
    return [paper.kinematics(plant), predictor.delay("delay", TIME, free), *(observer(a) for a in AXES), *(servo(a) for a in AXES),
            inversion(plant), paper.thrust_allocation()]


def controller(plant: Plant) -> stage.Controller:
    return stage.controller(NAME, TIME, INTERFACE, lambda: laws(plant), signal_names(OUTPUTS))
