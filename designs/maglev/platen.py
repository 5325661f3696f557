"""The maglev stage that both controllers drive: interface, coordinates, kinematics and allocation, F(5), (6), (13).

    encoders, set-points -> guard -> kinematics -> a law for each coordinate -> currents and limits -> safe output

Assumptions where the paper gives no information: the current limit of a motor is on sqrt(i_d^2 + i_q^2), with priority
for levitation. The laws compensate only a part of the guide springs.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import pi, sqrt

import casadi as ca
import numpy as np

from models import maglev_stage, pmlsm
from synth import stage
from synth.block import Block, Exprs, Step, build
from synth.declare.experiments import Sine
from synth.law import label
from synth.plant import Plant
from synth.signals import Signal
from synth.stage import Actuator, Sensor, SetPoint
from synth.statespace import StateSpace, readonly
from synth.synthesise.regulation import internal_model
from synth.timing import Continuous, Discrete

TIME = Discrete(1e-3)
OMEGA0 = 1.5 * pi  # rad/s, the frequency of the references, F section IV-B
CURRENT = maglev_stage.PEAK  # A rms, F section II
DIRECT = CURRENT * (1 - 1e-4)  # A rms, limit of i_d: keeps sqrt(CURRENT^2 - i_d^2) away from 0
RATED = 5 / sqrt(2)  # A rms, 5 A peak continuous, F section II
BAD_SAMPLES = 5
GOOD_SAMPLES = 4  # make up for a bad one: more than one bad sample in five lands, too
SAFE_CURRENT = 2.5  # A rms of i_d: lowers the platen from every gap; with 2 A the magnets hold it at the upper stop
HELD_UP = 7e-3  # rad: from this tilt on the safe output does not lower every plant from its upper stop
PULLED_UP = 28.7e-3  # m: gap of balance without current, rounded down
LIFTED = 30.5e-3  # m: at larger gaps a stop may hold the platen: it is not probed, and once landed it rests
SLEW = 100.0  # A/s
CURRENT_FLOOR = 1.0  # A: differences of smaller currents between witnesses are absolute
RESOLUTION = 10e-6  # m, F section II
SURROGATE_ERROR = {np.float32: 5e-7, np.float64: 1e-14}  # relative; the force law itself is accurate to some 1e-3
# The part of each guide spring that the law compensates: too much makes an axis unstable, too little slow. With
# springs 30 % (phi) and 20 % (theta) weaker than assumed the axes are stable.
COMPENSATED = {"k_s_phi": 0.75, "k_s_theta": 0.95}
BOX = {s.name: (s.low, s.high) for s in maglev_stage.STATES if s.name in maglev_stage.RATE}  # m, rad
GAP, MOTORS = BOX["y"], (1, 2, 3, 4)
COURSES = {  # of the 4-DOF tracking, F section IV-B
    "y": Sine(0.005, OMEGA0, -pi / 2, 0.025),
    "x": Sine(0.03, OMEGA0, -pi / 2),
    "z": Sine(0.03, OMEGA0),
    "theta": Sine(0.01, OMEGA0),
}
WIRES = {f"i_d{j}": f"i_d{j}" for j in MOTORS} | {"u_x": "i_q2", "u_z": "i_q1"}  # plant inputs: currents
WIDE = 0.1  # m: twice the stroke, to accept overshoot and the compliance of a stop
LOST = 2 * WIDE  # m, outside the range of x and z
ENCODER_OFFSET = 7e-6  # m: largest error of the zero of an encoder
# m at a motor: more than the error of an encoder, ENCODER_OFFSET, half a count and 0.1 % of the largest gap
STOP_MARGIN = 50e-6
ARM = 1 / (2 * maglev_stage.plant().parameter("r").value)  # 1/m


def _off_stops(name: str, scale: float = 1.0) -> tuple[float, float]:
    """Return the range of a set-point off the stops; a motor that moves by d changes the coordinate by `scale` d."""
    low, high = BOX[name]
    return low + scale * STOP_MARGIN, high - scale * STOP_MARGIN


_ENCODER = partial(Sensor, resolution=RESOLUTION, offset=ENCODER_OFFSET)
INTERFACE = stage.interface(
    maglev_stage.plant(),
    sensors=[
        *(_ENCODER(f"y{j}", of=f"g{j}", initial=GAP[1]) for j in MOTORS),
        *(_ENCODER(n, low=-WIDE, high=WIDE, about=f"platen along {n.upper()}") for n in "xz"),
    ],
    set_points=[
        SetPoint("y_ref", "y", *_off_stops("y"), initial=GAP[1] - STOP_MARGIN, about="set-point of the gap"),
        SetPoint("x_ref", "x", *_off_stops("x"), about="set-point along X"),
        SetPoint("z_ref", "z", *_off_stops("z"), about="set-point along Z"),
        SetPoint("phi_ref", "phi", *_off_stops("phi", 2 * ARM), about="set-point of the rotation about X"),
        SetPoint("theta_ref", "theta", *_off_stops("theta", 2 * ARM), about="set-point of the rotation about Z"),
    ],
    actuators=[
        *(Actuator(f"i_d{j}", SAFE_CURRENT, SLEW) for j in MOTORS),
        *(Actuator(f"u_{n}", 0.0, SLEW) for n in "xz"),
    ],
    bad_samples=BAD_SAMPLES,
    good_samples=GOOD_SAMPLES,
    safe_output_effect=f"zero current pulls the platen up from a gap below {PULLED_UP * 1e3:g} mm; in flight the "
    f"safe output, {SAFE_CURRENT:g} A rms, lowers a level platen from every gap between its stops, {GAP[0] * 1e3:g} mm "
    f"to {GAP[1] * 1e3:g} mm, also with all parameters at their tolerances, but at {GAP[0] * 1e3:g} mm magnets 10 % "
    f"stronger than assumed may hold one that is tilted about Z by {HELD_UP * 1e3:g} mrad or more; it is no soft "
    "landing: from 18 mm the platen meets its lower stop at up to 0.57 m/s",
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
# y, phi and theta from the gaps of the four motors, F(5) linearised: coordinates in which the loops are opened.
POSE = {"y": {f"y{j}": 0.25 for j in MOTORS}, "phi": {"y3": ARM, "y1": -ARM}, "theta": {"y2": ARM, "y4": -ARM}}


@dataclass(frozen=True)
class Axis:
    """One controlled coordinate and its position."""

    name: str
    position: Signal

    @property
    def reference(self) -> Signal:
        """The set-point."""
        return INTERFACE.held(f"{self.name}_ref")

    @property
    def error(self) -> Signal:
        """The tracking error, position less reference."""
        q, (low, high) = self.position, BOX[self.name]  # the stops: round numbers, which single precision keeps
        return Signal(f"e_{self.name}", q.unit, q.low - high, q.high - low, "tracking error")

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


AXES = (
    Axis("y", Signal("y", "m", 0.0145, 0.0345, "gap at the centre")),
    Axis("x", INTERFACE.held("x")),
    Axis("z", INTERFACE.held("z")),
    Axis("phi", Signal("phi", "rad", -0.02, 0.02, "rotation about X")),
    Axis("theta", Signal("theta", "rad", -0.031, 0.031, "rotation about Z")),
)


def axis_plant(axis: Axis, frequencies: Sequence[float]) -> StateSpace:
    """Return the double integrator q'' = w of F(13) with the internal model of F(14), states (e, de, xi1, ..)."""
    A, B, C, D = (readonly(m) for m in ([[0, 1], [0, 0]], [[0], [1]], [[1, 0]], [[0]]))
    integrator = StateSpace(A, B, C, D, ("e", "de"), (axis.demand.name,), ("e",), Continuous())
    return internal_model.augmented(integrator, frequencies)


def acceleration(axis: Axis) -> Signal:
    """Return the acceleration by the limited currents: of x and z from the model, of the others the demanded one."""
    about = f"acceleration by u_{axis.name}"
    return Signal(f"a_{axis.name}", "m/s^2", -1e3, 1e3, about) if axis.excess else axis.demand


def largest_acceleration() -> float:
    """Return the largest acceleration of x or z by thrust, in m/s^2: CURRENT at the smallest gap."""
    values, limits = maglev_stage.nominal(), []
    for gap, mass in ((maglev_stage.GAP_2_4[0], "M_x"), (maglev_stage.GAP_1_3[0], "M_z")):
        limits.append(2 * CURRENT * float(ca.DM(pmlsm.force_law(ca.SX(gap), values).h / values[mass])))
    return max(limits)


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


def limit_thrust(name: str, thrust: ca.SX, *direct: ca.SX) -> ca.SX:
    """Return the thrust current limited to sqrt(CURRENT^2 - i_d^2) of both of its motors."""
    room = ca.sqrt(CURRENT**2 - ca.fmax(direct[0] ** 2, direct[1] ** 2))
    label(name, room=room)
    return ca.fmax(ca.fmin(thrust, room), -room)


def thrust_allocation() -> Block:
    """Return the Block that gives both motors of an axis its thrust current."""

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        return Step({f"i_q{j}": u[name] for j, name in enumerate(maglev_stage.QUADRATURE, 1)})

    return build("thrust_allocation", TIME, law, inputs=CURRENTS[4:], outputs=OUTPUTS[4:], tag="F(6)")
