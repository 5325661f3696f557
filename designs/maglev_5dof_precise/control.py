"""Precise controller of the maglev stage as Blocks, from encoders to currents.

    encoders -> guard -> kinematics -> observers -> servos -> exact inversion and limits -> safe output

Every coordinate has an observer of position, rate and disturbance, which predicts the state at which the command acts,
and a servo with internal models at 0, 1, 2 and 3 times the frequency of the references (0 and 1 for phi, which does not
move). It cancels CANCELLED of the disturbance at once. The inversion solves the whole force law of each motor, one
quadratic equation in its direct current, at the predicted gap, and limits the thrust to what the levitation leaves.

The bandwidth of an observer is limited by the noise of its encoders, whose variance is resolution^2 / 12: with these
bandwidths the loop turns a rounding of 2.9 um rms into 1.0 um rms of x. The gains are those of continuous LQR, as in
the paper, with the weights of the internal models from the speed at which each error shall decay.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

from designs.maglev import fault_handling, platen
from designs.maglev.platen import (
    AXES,
    COMPENSATED,
    CURRENT,
    CURRENTS,
    DIRECT,
    HELD,
    INTERFACE,
    OMEGA0,
    OUTPUTS,
    TIME,
    Axis,
    acceleration,
)
from designs.maglev_5dof_precise import inverse
from models import maglev_stage, pmlsm
from synth import stage
from synth.block import Block, Constant, Exprs, Step, build, clip
from synth.blocks.estimate import predictor
from synth.blocks.faults import probe
from synth.blocks.guard import safety
from synth.blocks.laws import predictive_servo
from synth.blocks.laws.axis_regulator import internal_weights
from synth.law import label
from synth.plant import Plant
from synth.signals import Signal, signal_names
from synth.statespace import StateSpace
from synth.synthesise import digits
from synth.synthesise.feedback import lqr

NAME = "maglev_5dof_precise"
FREQUENCIES = (0.0, OMEGA0, 2 * OMEGA0, 3 * OMEGA0)  # rad/s: the references', and what a wrong model makes of them
CANCELLED = 0.8  # of the estimated disturbance
# At rest a frozen code of one count beside the set-point makes this loop accelerate by 5 k_e e = 0.05 m/s^2, because
# 0.8 of its own demand is cancelled as a disturbance. So the probe has to be fast: 77 ms, from 2.2 to 9.9 um.
PROBE = probe.Probe(quiet=12, quarter=1, step=2.2e-6, attempts=8, both_sides=True)
MEMORY = 4.0  # m, rad: bound of the states of the internal models


@dataclass(frozen=True)
class Loop:
    """One coordinate: weights on (e, de), decay of each mode in 1/s, bandwidth of the observer in rad/s, and bounds.

    `rate` and `disturbance` bound the observer. The internal models see errors up to `error`; the set-point is followed
    up to the rate `fastest`.
    """

    weights: tuple[float, float]
    speeds: tuple[float, ...]
    bandwidth: float
    rate: float
    disturbance: float
    error: float
    fastest: float


X = Loop((1e5, 800), (5, 4, 4, 4), 400.0, 2.0, 20.0, 1e-3, 0.3)
LOOPS: Mapping[str, Loop] = {
    "y": Loop((1e6, 1e4), (6, 4, 4, 4), 400.0, 4.0, 50.0, 3e-4, 0.1),
    "x": X,
    "z": X,
    "phi": Loop((1e5, 5e3), (4, 2), 400.0, 4.0, 200.0, 1e-4, 0.1),
    "theta": Loop((3e5, 5e3), (6, 4, 4, 4), 250.0, 4.0, 200.0, 3e-4, 0.1),
}
TILTS = [a for a in AXES if a.name not in "xz"]  # the coordinates that the gaps determine


def name_in_loop(axis: Axis) -> str:
    """Return the name of the coordinate in the control loop, whose observer differs from that of the fault handling."""
    return f"{axis.name}_fast"


def frequencies(axis: Axis) -> tuple[float, ...]:
    """Return the frequencies of the internal models of an axis; those of phi, which no reference moves, are two."""
    return FREQUENCIES[: len(LOOPS[axis.name].speeds)]


def axis_plant(axis: Axis) -> StateSpace:
    """Return the double integrator of an axis with its internal models."""
    return platen.axis_plant(axis, frequencies(axis))


def gain(axis: Axis) -> lqr.Gain:
    """Return the axis' continuous LQR gain, w = K (e, de, xi)."""
    return loop_gain(axis, LOOPS[axis.name])


@cache
def loop_gain(axis: Axis, loop: Loop) -> lqr.Gain:
    """Return the gain of an axis for other weights than those of LOOPS; the frequencies are the same."""
    model = axis_plant(axis)
    Q = np.zeros(model.A.shape)
    Q[0, 0], Q[1, 1] = loop.weights
    Q[2:, 2:] = internal_weights(dict(zip(frequencies(axis), loop.speeds, strict=True)), loop.weights[0])
    return lqr.lqr(model, Q, np.eye(1))


def observer(axis: Axis, loop: Loop) -> Block:
    """Return the observer of an axis that predicts where the platen is when the command acts."""
    before = replace(acceleration(axis), name=f"{acceleration(axis).name}_before", low=-1e6, high=1e6)
    return predictor.block(
        name_in_loop(axis),
        TIME,
        axis.position,
        before,
        bandwidth=loop.bandwidth,
        rate=loop.rate,
        disturbance=loop.disturbance,
        ahead=True,
    )


def servo(axis: Axis, loop: Loop) -> Block:
    """Return the servo of an axis."""
    return predictive_servo.block(
        name_in_loop(axis),
        TIME,
        loop_gain(axis, loop),
        frequencies(axis),
        measured=axis.position,
        reference=axis.reference,
        demand=axis.demand,
        cancelled=CANCELLED,
        limits=predictive_servo.Limits(loop.error, loop.fastest, MEMORY),
        disturbance=loop.disturbance,
    )


def inversion(plant: Plant) -> Block:
    """Return the Block from demanded accelerations to limited currents, the inverse of F(2), (6) and (7).

    The thrust currents are demanded first, because they attract the platen; then the direct currents carry it, and the
    thrust is limited to what is left.
    """
    lifting, thrusting = (Signal("i", "A", -most, most) for most in (DIRECT, CURRENT))
    values = maglev_stage.nominal(plant)
    values |= {n: part * values[n] for n, part in COMPENSATED.items()}
    ahead = [replace(a.position, name=f"{name_in_loop(a)}_ahead") for a in TILTS]
    r, numbers = plant.parameter("r").value, _numbers(plant)

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        w = {a.name: u[a.demand.name] for a in AXES}
        y, phi, theta = (u[s.name] for s in ahead)
        tilts = (-r * phi, r * theta, r * phi, -r * theta)
        motors = [pmlsm.force_law(clip(y + tilt, s), values) for tilt, s in zip(tilts, HELD, strict=True)]
        demand = maglev_stage.thrust_currents(w, motors, values)
        i_q = [clip(demand[name], thrusting) for name in maglev_stage.QUADRATURE]
        direct = inverse.direct_currents(w, {"phi": phi, "theta": theta}, i_q, motors, values)
        i_d = [clip(i, lifting) for i in direct.currents.values()]
        limited = {"u_x": platen.limit_thrust("u_x", demand["u_x"], i_d[1], i_d[3])}
        limited["u_z"] = platen.limit_thrust("u_z", demand["u_z"], i_d[0], i_d[2])
        output = dict(zip((f"{s.name}_computed" for s in CURRENTS), [*i_d, *limited.values()], strict=True))
        thrust = maglev_stage.thrust_accelerations(limited, motors, values)
        named = [(Signal(n, "N", -1e6, 1e6), force) for n, force in direct.half_forces.items()]
        named += [(Signal(f"{n}_demand", "A", -1e6, 1e6), i) for n, i in demand.items()]
        # All coefficients of a motor follow from these two, so only they become polynomials.
        named += [(Signal(f"thrust_per_ampere_{j}", "N/A", 0, 100), m.h) for j, m in enumerate(motors, 1)]
        named += [(Signal(f"half_a_over_h2_{j}", "A^2/N", 0, 100), m.ratio) for j, m in enumerate(motors, 1)]
        label(motors=motors, tilts=tilts, i_q=i_q)
        return Step(output | {f"a_{n}": a for n, a in thrust.items()}, named=named, numbers=numbers)

    outputs = [*(INTERFACE.computed_output(s.name) for s in CURRENTS), *(acceleration(a) for a in AXES if a.excess)]
    inputs, tag = [*ahead, *(a.demand for a in AXES)], "exact inversion of F(2), (6), (7)"
    return build("inversion", TIME, law, inputs=inputs, outputs=outputs, tag=tag)


def _numbers(plant: Plant) -> list[Constant]:
    """Return the numbers of the inversion that the C names."""
    return [
        *maglev_stage.numbers(plant, COMPENSATED),
        *maglev_stage.inverse_masses(plant),
        plant.constant("r"),
        *pmlsm.numbers(plant),
        *(n for s in HELD for n in safety.ends(s)),
        Constant("direct_limit", DIRECT, "A", "largest direct current, rms: a little below the current limit"),
        Constant("current_limit", CURRENT, "A", "largest current of a motor, rms: 7 A peak", is_limit=True),
        Constant("squared_current_limit", CURRENT**2, "A^2", "square of the current limit, 7 A peak"),
    ]


def laws(plant: Plant, of: Mapping[str, Loop] = LOOPS) -> list[Block]:
    """Return the laws for the parameters of the stage."""
    loops = [block for a in AXES for block in (observer(a, of[a.name]), servo(a, of[a.name]))]
    parts = [platen.kinematics(plant), platen.errors()]
    return [*parts, *loops, inversion(plant), platen.thrust_allocation()]


def law_alone(plant: Plant) -> stage.Controller:
    """Return the law without fault handling, from six encoders and five set-points to the motors' currents."""
    last = fault_handling.delayed_accelerations()
    return stage.controller(NAME, TIME, INTERFACE, lambda: [*laws(plant), last], signal_names(OUTPUTS))


def controller(plant: Plant, of: Mapping[str, Loop] = LOOPS) -> stage.Controller:
    """Return the controller of some loops, by default the shipped one: the law with its fault handling."""
    return fault_handling.controller(NAME, plant, lambda: laws(plant, of), PROBE)


def gains(scalar: type[np.floating]) -> dict[str, Any]:
    """Return the contents of gains.json: each axis' gain with its weights, plant and certificate."""
    return {axis.name: _gain(axis, scalar) for axis in AXES}


def _gain(axis: Axis, scalar: type[np.floating]) -> dict[str, Any]:
    K, loop = gain(axis), LOOPS[axis.name]
    return {
        "plant": "q'' = w, xi' = Phi xi + N e, Phi and N for the frequencies below; states e, de, xi1, ..",
        "frequencies_rad_s": list(frequencies(axis)),
        "decay_per_s": list(loop.speeds),
        "weights_Q": list(loop.weights),
        "weights_of_internal_models": np.asarray(K.Q)[2:, 2:].tolist(),
        "weight_R": 1.0,
        "period_s": TIME.period_s,
        "K": [float(v) for v in K.K[0].astype(scalar)],
        "poles_rad_s": [digits.pole(s) for s in K.poles],
        "certificate": digits.certificate(K.certificate),
        "observer_rad_s": loop.bandwidth,
        "cancelled": CANCELLED,
    }
