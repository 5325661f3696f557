"""Controller of the five-axis maglev stage as Blocks, from encoders to currents: F(8), (12), (14), (16), (17).

    encoders, set-points -> guard -> kinematics -> filters -> regulators -> decoupling and limits -> safe output

The published gains come from continuous LQR. They are used at 1 kHz as in the paper; gains.json lists the sampled-data
optimum beside them. Assumptions where the paper gives no information: the phi loop has the weights of the theta loop;
the current limit of a motor is on sqrt(i_d^2 + i_q^2), with priority for levitation; the forces of each motor are
computed at its own measured gap; the attraction by i_q^2 is that of the thrust current of the sample before. The
shipped law differs from F(12) in two points, which `corrected=False` undoes: it includes the attraction by i_d^2 at the
currents of the sample before, and it compensates only a part of the guide springs.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np

from designs.maglev import fault_handling, platen
from designs.maglev.platen import COMPENSATED, CURRENT, CURRENTS, DIRECT, HELD, INTERFACE, MOTORS, OMEGA0, OUTPUTS, TIME
from models import maglev_stage, pmlsm
from synth import stage
from synth.block import Block, Constant, Exprs, Step, build, clip
from synth.blocks.laws import derivative_filter, regulator
from synth.law import label
from synth.plant import Plant
from synth.signals import Signal, signal_names
from synth.statespace import StateSpace
from synth.synthesise.feedback import lqr

NAME = "maglev_5dof"
FREQUENCIES = (0.0, OMEGA0)  # rad/s, the exosystem of F(15)
FILTER = 1000.0  # rad/s: with 300 the phi loop is unstable, with 500 its peak sensitivity is 4.6
ANTI_WINDUP = (7e-5, 7e-5, 7e-5)  # E_x = E_z, F section IV-A
ETA_BOUNDS = (600.0, 3.0, 600.0)  # of the states of the internal model
VERTICAL, THRUST = (3e4, 3e4, 2.5e9, 2.5e7, 2.5e7), (1500.0, 1500.0, 4.5e8, 2.25e6, 2.25e6)
TILT = (4e4, 4e4, 4e9, 4e7, 4e7)


@dataclass(frozen=True)
class Axis(platen.Axis):
    """A coordinate with LQR weights on (e, de, xi1, xi2, xi3) with R = 1."""

    weights: tuple[float, ...]


WEIGHTS = {"y": VERTICAL, "x": THRUST, "z": THRUST, "phi": TILT, "theta": TILT}
AXES = tuple(Axis(a.name, a.position, WEIGHTS[a.name]) for a in platen.AXES)


def axis_plant(axis: Axis) -> StateSpace:
    """Return the double integrator of an axis with the internal model of F(14)."""
    return platen.axis_plant(axis, FREQUENCIES)


@cache
def gain(axis: Axis) -> lqr.Gain:
    """Return the axis' continuous LQR gain, w = K (e, de, xi)."""
    return lqr.lqr(axis_plant(axis), np.diag(axis.weights), np.eye(1))


def regulator_block(axis: Axis, anti_windup: bool = True) -> Block:
    """Return the regulator of one axis, F(14)-(17), or F(14)-(16) when `anti_windup` is false."""
    return regulator.block(
        f"regulator_{axis.name}",
        TIME,
        gain(axis),
        FREQUENCIES,
        error=axis.error,
        rate=axis.rate,
        demand=axis.demand,
        bounds=ETA_BOUNDS,
        anti_windup=(axis.excess, ANTI_WINDUP) if axis.excess and anti_windup else None,
        tag="F(14)-(17)" if axis.excess else "F(14)-(16)",
    )


def decoupling(plant: Plant, corrected: bool = True) -> Block:
    """Return the Block from demanded accelerations to limited currents, F(8) and F(12).

    The forces of each motor are computed at its own measured gap. The attraction by i_d^2 + i_q^2 is that of the sample
    before, which makes the equations linear; without `corrected`, that of i_d^2 is neglected as in F(11). Each motor
    keeps hypot(i_d, i_q) <= CURRENT with priority for i_d.
    """
    lifting, values = Signal("i", "A", -DIRECT, DIRECT), maglev_stage.nominal(plant)
    values |= {n: part * values[n] for n, part in COMPENSATED.items()} if corrected else {}
    angles = [a.position for a in AXES if a.name in ("phi", "theta")]
    before = [INTERFACE.before(s.name) for s in CURRENTS]
    numbers = _numbers(plant, COMPENSATED if corrected else {})

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        motors = [pmlsm.force_law(u[s.name], values) for s in HELD]
        squares = [u[f"{thrust}_before"] ** 2 for thrust in maglev_stage.QUADRATURE]
        if corrected:
            squares = [i_q + u[f"i_d{j}_before"] ** 2 for j, i_q in zip(MOTORS, squares, strict=True)]
        w = {a.name: u[a.demand.name] for a in AXES}
        direct = maglev_stage.direct_currents(w, u, squares, motors, values)
        i_d = {n: clip(i, lifting) for n, i in direct.currents.items()}
        demand = maglev_stage.thrust_currents(w, motors, values)
        pairs = {"u_x": (i_d["i_d2"], i_d["i_d4"]), "u_z": (i_d["i_d1"], i_d["i_d3"])}
        thrust = {n: platen.limit_thrust(n, demand[n], *pair) for n, pair in pairs.items()}
        output = {f"{n}_computed": i for n, i in (i_d | thrust).items()}
        output |= {f"excess_{n[-1]}": thrust[n] - demand[n] for n in thrust}
        named_signals = [
            pair for j, m, square in zip(MOTORS, motors, squares, strict=True) for pair in _named_forces(j, m, square)
        ]
        named_signals += [(Signal(f"{n}_demand", "A", -1e6, 1e6), demand[n]) for n in thrust]
        named_signals += [(Signal(n, "N", -1e6, 1e6), force) for n, force in direct.half_forces.items()]
        label(motors=motors, squares=squares)
        return Step(output, named=named_signals, numbers=numbers)

    inputs = [*HELD, *angles, *(a.demand for a in AXES), *before]
    outputs = [*(INTERFACE.computed_output(s.name) for s in CURRENTS), *(a.excess for a in AXES if a.excess)]
    return build("decoupling", TIME, law, inputs=inputs, outputs=outputs, tag="direct and thrust currents, F(8), F(12)")


def _numbers(plant: Plant, compensated: Mapping[str, float]) -> list[Constant]:
    """Return the numbers of the decoupling that the C names; `compensated` are the parts of the springs."""
    return [
        *maglev_stage.numbers(plant, compensated),
        *pmlsm.numbers(plant),
        Constant("direct_limit", DIRECT, "A", "largest direct current, rms: a little below the current limit"),
        Constant("squared_current_limit", CURRENT**2, "A^2", "square of the current limit, 7 A peak"),
    ]


def _named_forces(j: int, m: pmlsm.ForceLaw, square: ca.SX) -> list[tuple[Signal, ca.SX]]:
    """Return the named expressions of a motor's forces, for the C."""
    return [
        (Signal(f"thrust_per_ampere_{j}", "N/A", 0, 100), m.h),
        (Signal(f"half_a_over_h2_{j}", "A^2/N", 0, 100), m.ratio),
        (Signal(f"half_a_{j}", "N", 0, 1e3), m.half_a),
        (Signal(f"half_c_{j}", "N/A^2", 0, 10), m.half_c),
        (Signal(f"half_load_{j}", "N", 0, 1e3), m.half_a + m.half_c * square),
        (Signal(f"inverse_b_{j}", "A/N", 0, 1), 1 / m.b),
    ]


def laws(plant: Plant, corrected: bool = True, anti_windup: bool = True) -> list[Block]:
    """Return the laws for the parameters of the stage, with or without anti-windup."""
    loops: list[Block] = []
    for a in AXES:
        loops += [
            derivative_filter.block(f"filter_{a.name}", TIME, a.error, a.rate, FILTER),
            regulator_block(a, anti_windup),
        ]
    parts = [platen.kinematics(plant), platen.errors()]
    return [*parts, *loops, decoupling(plant, corrected), platen.thrust_allocation()]


def controller(plant: Plant, corrected: bool = True, anti_windup: bool = True) -> stage.Controller:
    """Return the law alone, from six encoders and five set-points to the motors' currents."""
    return stage.controller(NAME, TIME, INTERFACE, lambda: laws(plant, corrected, anti_windup), signal_names(OUTPUTS))


def with_fault_handling(plant: Plant, corrected: bool = True, anti_windup: bool = True) -> stage.Controller:
    """Return the shipped controller: the law with its fault handling."""
    return fault_handling.controller(NAME, plant, lambda: laws(plant, corrected, anti_windup))
