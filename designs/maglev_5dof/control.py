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
from dataclasses import dataclass, replace
from functools import cache
from math import pi, sqrt

import casadi as ca
import numpy as np

from models import maglev_stage, pmlsm
from synth import stage
from synth.block import Block, Constant, Exprs, Step, build, clip
from synth.blocks import derivative_filter, regulator
from synth.plant import Plant
from synth.signals import Signal, signal_names
from synth.stage import Actuator, Sensor, SetPoint
from synth.statespace import StateSpace, readonly
from synth.synthesise.feedback import lqr
from synth.synthesise.regulation import internal_model
from synth.timing import Continuous, Discrete

NAME = "maglev_5dof"
TIME = Discrete(1e-3)
OMEGA0 = 1.5 * pi  # rad/s, the frequency of the references, F section IV-B
FREQUENCIES = (0.0, OMEGA0)  # rad/s, the exosystem of F(15)
FILTER = 1000.0  # rad/s: with 300 the phi loop is unstable, with 500 its peak sensitivity is 4.6
CURRENT = maglev_stage.PEAK  # A rms, F section II
DIRECT = CURRENT * (1 - 1e-4)  # A rms, limit of i_d: keeps sqrt(CURRENT^2 - i_d^2) away from 0
RATED = 5 / sqrt(2)  # A rms, 5 A peak continuous, F section II
ANTI_WINDUP = (7e-5, 7e-5, 7e-5)  # E_x = E_z, F section IV-A
ETA_BOUNDS = (600.0, 3.0, 600.0)  # of the states of the internal model
BAD_SAMPLES = 5
SAFE_CURRENT = 2.5  # A rms of i_d: lowers the platen from every gap of 18.1 mm or more
SLEW = 100.0  # A/s
RESOLUTION = 10e-6  # m, F section II
SURROGATE_ERROR = {np.float32: 5e-7, np.float64: 1e-14}  # relative; the force law itself is accurate to some 1e-3

# The part of each guide spring that the law compensates: too much makes an axis unstable, too little slow. With
# springs 30 % (phi) and 20 % (theta) weaker than assumed the axes are stable.
COMPENSATED = {"k_s_phi": 0.75, "k_s_theta": 0.95}

BOX = {s.name: (s.low, s.high) for s in maglev_stage.STATES if s.name in maglev_stage.RATE}  # m, rad
GAP, MOTORS = BOX["y"], (1, 2, 3, 4)
WIDE = 0.1  # m: twice the stroke, to accept overshoot and the compliance of a stop
LOST = 2 * WIDE  # m, outside the range of x and z

INTERFACE = stage.interface(
    maglev_stage.plant(),
    sensors=[
        *(Sensor(f"y{j}", of=f"g{j}", resolution=RESOLUTION, initial=GAP[1]) for j in MOTORS),
        *(Sensor(n, resolution=RESOLUTION, low=-WIDE, high=WIDE, about=f"platen along {n.upper()}") for n in "xz"),
    ],
    set_points=[
        SetPoint("y_ref", "y", *GAP, initial=GAP[1], about="set-point of the gap"),
        SetPoint("x_ref", "x", *BOX["x"], about="set-point along X"),
        SetPoint("z_ref", "z", *BOX["z"], about="set-point along Z"),
        SetPoint("phi_ref", "phi", *BOX["phi"], about="set-point of the rotation about X"),
        SetPoint("theta_ref", "theta", *BOX["theta"], about="set-point of the rotation about Z"),
    ],
    actuators=[
        *(Actuator(f"i_d{j}", SAFE_CURRENT, SLEW) for j in MOTORS),
        *(Actuator(f"u_{n}", 0.0, SLEW) for n in "xz"),
    ],
    bad_samples=BAD_SAMPLES,
    reason="zero current pulls the platen up below 28.7 mm; 2.5 A rms lowers it from 18.1 mm and above",
)
CURRENTS = INTERFACE.outputs
OUTPUTS = (
    *CURRENTS[:4],
    *(Signal(f"i_q{j}", "A", -CURRENT, CURRENT, f"quadrature current of motor {j}, rms") for j in MOTORS),
)
COMMUTATED = {  # positions for the commutation; LOST says that a position is not known
    n: replace(
        INTERFACE.signals[n], name=f"{n}_commutation", high=LOST, about=f"{n} for the commutation, {LOST:g} if lost"
    )
    for n in "xz"
}
HELD = tuple(INTERFACE.held(f"y{j}") for j in MOTORS)
ARM = 1 / (2 * INTERFACE.plant.parameter("r").value)  # 1/m
# y, phi and theta from the gaps of the four motors, F(5) linearised: coordinates in which the loops are opened.
POSE = {"y": {f"y{j}": 0.25 for j in MOTORS}, "phi": {"y3": ARM, "y1": -ARM}, "theta": {"y2": ARM, "y4": -ARM}}


@dataclass(frozen=True)
class Axis:
    """One controlled coordinate: its position, and LQR weights on (e, de, xi1, xi2, xi3) with R = 1."""

    name: str
    position: Signal
    weights: tuple[float, ...]

    @property
    def reference(self) -> Signal:
        """The set-point."""
        return INTERFACE.held(f"{self.name}_ref")

    @property
    def error(self) -> Signal:
        """The tracking error, position less reference."""
        q, r = self.position, self.reference
        return Signal(f"e_{self.name}", q.unit, q.low - r.high, q.high - r.low, "tracking error")

    @property
    def rate(self) -> Signal:
        """The filtered derivative of the error."""
        unit, bound = f"{self.position.unit}/s", (self.error.high - self.error.low) / TIME.period_s
        return Signal(f"de_{self.name}", unit, -bound, bound, "filtered rate of the error")

    @property
    def demand(self) -> Signal:
        """The demanded acceleration w."""
        return Signal(f"w_{self.name}", f"{self.position.unit}/s^2", -1e4, 1e4, "demanded acceleration")

    @property
    def excess(self) -> Signal | None:
        """The limited less the demanded thrust current of x and z."""
        about = f"u_{self.name} limited less u_{self.name} demanded"
        return Signal(f"excess_{self.name}", "A", -1e6, 1e6, about) if self.name in "xz" else None


VERTICAL, THRUST = (3e4, 3e4, 2.5e9, 2.5e7, 2.5e7), (1500.0, 1500.0, 4.5e8, 2.25e6, 2.25e6)
TILT = (4e4, 4e4, 4e9, 4e7, 4e7)
AXES = (
    Axis("y", Signal("y", "m", 0.0145, 0.0345, "gap at the centre"), VERTICAL),
    Axis("x", INTERFACE.held("x"), THRUST),
    Axis("z", INTERFACE.held("z"), THRUST),
    Axis("phi", Signal("phi", "rad", -0.02, 0.02, "rotation about X"), TILT),
    Axis("theta", Signal("theta", "rad", -0.031, 0.031, "rotation about Z"), TILT),
)


def axis_plant(axis: Axis) -> StateSpace:
    """Return the double integrator q'' = w of F(13) with the internal model of F(14), states (e, de, xi1, xi2, xi3)."""
    A, B, C, D = (readonly(m) for m in ([[0, 1], [0, 0]], [[0], [1]], [[1, 0]], [[0]]))
    integrator = StateSpace(A, B, C, D, ("e", "de"), (axis.demand.name,), ("e",), Continuous())
    return internal_model.augmented(integrator, FREQUENCIES)


@cache
def gain(axis: Axis) -> lqr.Gain:
    """Return the axis' continuous LQR gain, w = K (e, de, xi)."""
    return lqr.lqr(axis_plant(axis), np.diag(axis.weights), np.eye(1), exact=True)


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


def kinematics(plant: Plant) -> Block:
    """Return the Block from the four vertical encoders to y, phi and theta, the inverse of F(5)."""
    r = ca.SX(plant.parameter("r").value)

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        y1, y2, y3, y4 = (u[s.name] for s in HELD)
        return Step(maglev_stage.kinematics(y1, y2, y3, y4, r))

    outputs = [a.position for a in AXES if a.name in POSE]
    return build("kinematics", TIME, law, inputs=HELD, outputs=outputs, tag="pose from the gaps, F(5)")


def errors() -> Block:
    """Return the Block that subtracts the set-points from the positions."""

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        return Step({a.error.name: u[a.position.name] - u[a.reference.name] for a in AXES})

    inputs = [s for a in AXES for s in (a.position, a.reference)]
    return build("errors", TIME, law, inputs=inputs, outputs=[a.error for a in AXES], tag="tracking errors, F(14)")


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
        thrust = {n: _limit_thrust(demand[n], *pair) for n, pair in pairs.items()}
        output = {f"{n}_computed": i for n, i in (i_d | thrust).items()}
        output |= {f"excess_{n[-1]}": thrust[n] - demand[n] for n in thrust}
        named_signals = [
            pair for j, m, square in zip(MOTORS, motors, squares, strict=True) for pair in _named_forces(j, m, square)
        ]
        named_signals += [(Signal(f"{n}_demand", "A", -1e6, 1e6), demand[n]) for n in thrust]
        named_signals += [(Signal(n, "N", -1e6, 1e6), force) for n, force in direct.half_forces.items()]
        return Step(output, named=named_signals, numbers=numbers)

    inputs = [*HELD, *angles, *(a.demand for a in AXES), *before]
    outputs = [*(INTERFACE.computed_output(s.name) for s in CURRENTS), *(a.excess for a in AXES if a.excess)]
    return build("decoupling", TIME, law, inputs=inputs, outputs=outputs, tag="direct and thrust currents, F(8), F(12)")


def _numbers(plant: Plant, compensated: Mapping[str, float]) -> list[Constant]:
    """Return the numbers of the decoupling that the C names; `compensated` are the parts of the springs."""
    half_forces = {
        "half_M_y": ("kg", lambda p: p["M_y"] / 2),
        "half_I_x_over_r": ("kg m/rad", lambda p: p["I_x"] / (2 * p["r"])),
        "half_I_z_over_r": ("kg m/rad", lambda p: p["I_z"] / (2 * p["r"])),
    }
    springs = {f"compensated_{n}": ("1/s^2", lambda p, n=n, part=part: part * p[n]) for n, part in compensated.items()}
    formulas = half_forces | springs
    return [
        *(plant.constant(name) for name in ("M_x", "M_z", "G")),
        *(plant.constant(name, unit, formula) for name, (unit, formula) in formulas.items()),
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


def _limit_thrust(thrust: ca.SX, *direct: ca.SX) -> ca.SX:
    """Return the thrust current limited to sqrt(CURRENT^2 - i_d^2) of both of its motors."""
    room = ca.sqrt(CURRENT**2 - ca.fmax(direct[0] ** 2, direct[1] ** 2))
    return ca.fmax(ca.fmin(thrust, room), -room)


def thrust_allocation() -> Block:
    """Return the Block that gives both motors of an axis its thrust current."""

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        return Step({f"i_q{j}": u[name] for j, name in enumerate(maglev_stage.QUADRATURE, 1)})

    return build("thrust_allocation", TIME, law, inputs=CURRENTS[4:], outputs=OUTPUTS[4:], tag="F(6)")


def laws(plant: Plant, corrected: bool = True, anti_windup: bool = True) -> list[Block]:
    """Return the laws for the parameters of the stage, with or without anti-windup."""
    loops: list[Block] = []
    for a in AXES:
        loops += [
            derivative_filter.block(f"filter_{a.name}", TIME, a.error, a.rate, FILTER),
            regulator_block(a, anti_windup),
        ]
    return [kinematics(plant), errors(), *loops, decoupling(plant, corrected), thrust_allocation()]


def controller(plant: Plant, corrected: bool = True, anti_windup: bool = True) -> stage.Controller:
    """Return the whole controller, from six encoders and five set-points to the motors' currents."""
    return stage.controller(NAME, TIME, INTERFACE, lambda: laws(plant, corrected, anti_windup), signal_names(OUTPUTS))
