"""Fault handling of the maglev controller: readings replaced by parity and prediction, frozen encoders, landing.

    guard -> redundancy -> [ kinematics, laws of the axes ] -> landing -> probe -> [ currents ] -> safe output
                 ^ expected gaps, x, z                |-> pose, demands -> observers -> estimates -> landing

One encoder of the gap is redundant, because y1 - y2 + y3 - y4 = 0 by F(5): without it the controller continues. The
loss of x, of z or of two gap encoders starts the landing; with fewer than two gap encoders, or without x and z, the
currents go to the safe output at once. The commutation gets x and z as they are used, predictions included.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import casadi as ca

from designs.maglev import handover, platen
from designs.maglev.platen import (
    AXES,
    COMMUTATED,
    HELD,
    INTERFACE,
    LIFTED,
    LOST,
    MOTORS,
    OUTPUTS,
    RESOLUTION,
    TIME,
    Axis,
    acceleration,
)
from models import maglev_stage, pmlsm
from synth import stage
from synth.analyse.structure import parity
from synth.block import Block, Constant, Exprs, Step, build
from synth.blocks.estimate import predictor
from synth.blocks.faults import innovation_monitor, landing, probe, redundancy
from synth.blocks.faults.redundancy_decision import frozen_gate, jump_gate
from synth.blocks.guard import missed_calls
from synth.fault import Fault
from synth.law import label
from synth.plant import Plant
from synth.signals import Signal, signal_names
from synth.synthesise import digits

# Of sound encoders: with them the threshold of the parity is 48 um, and up to 0.16 mm with noise of one count.
SOUND = parity.Tolerance(RESOLUTION, offset=7e-6, noise=RESOLUTION)
BANDWIDTH = {"y": 120.0, "phi": 120.0, "theta": 120.0, "x": 60.0, "z": 60.0}  # rad/s
RATES = {"y": 4.0, "x": 2.0, "z": 2.0, "phi": 4.0, "theta": 4.0}  # m/s or rad/s
DISTURBANCES = {"y": 50.0, "x": 20.0, "z": 20.0, "phi": 200.0, "theta": 200.0}  # m/s^2 or rad/s^2
# m/s^2: twice the largest thrust, as if it acted against its prediction, at the smallest gap with magnets 10 % stronger
WRONG_ACCELERATION = 2 * 1.1 * platen.largest_acceleration()
THRUST_GAIN = predictor.Gain(0.8, 1.2, 30.0)  # of x and z: the magnets' flux is known within 10 %
TRAVEL = 0.0499  # m: beyond, a stop may hold the platen
PROBE = probe.Probe(quiet=40, quarter=3, step=4.2e-6, attempts=5)  # to 21 um: guide friction of 1.8 N takes half
GATE = 40e-6  # m: a prediction that is nearer agrees with its code
FROZEN = digits.round_up(frozen_gate(GATE, RESOLUTION, SOUND.noise))  # m: 40 um would do without noise
# m: without a fault the distance from code to prediction grows by at most 0.24 mm in a sample and by 0.10 mm while the
# code stands still, in steps of x and z and after 40 missed calls
WIDE_JUMP, WIDE_FROZEN = 0.5e-3, 0.2e-3
JUMP = jump_gate(GATE, WRONG_ACCELERATION, RESOLUTION, TIME.period_s)
DECISION = redundancy.Decision(
    gate=dict.fromkeys("xz", GATE),
    travel=dict.fromkeys("xz", (-TRAVEL, TRAVEL)),
    at_rest=PROBE.count_limit,
    jump=dict.fromkeys("xz", digits.round_up(JUMP)),
    wide_jump=dict.fromkeys("xz", WIDE_JUMP),
    wide_frozen=dict.fromkeys("xz", WIDE_FROZEN),
    frozen=dict.fromkeys("xz", FROZEN),
)
STOP, RAMP_BOUND = platen.GAP[1], 0.5  # m: the stop, and a bound of the ramps that is wider than any estimate
COURSES: dict[str, landing.Course] = {
    "y": landing.Descent("y", STOP, 0.08, 5e-3, 1e-3, 2.0, 0.4e-3, 60.0, RAMP_BOUND, LIFTED),
    "x": landing.Braking("x", 4.0, 30.0, RAMP_BOUND),
    "z": landing.Braking("z", 4.0, 30.0, RAMP_BOUND),
    "theta": landing.Levelling("theta", 40.0, 14.0),
}
SENSORS = tuple(s.name for s in INTERFACE.sensors)
MISSED_CALLS = 40  # from 45 on theta may reach its stop in motion, on one of 17 plants; up to 44 on none
SENSOR_LOSS_EFFECT = (
    "a gap encoder that is refused or excluded is replaced; without x, without z or without two gap encoders the "
    f"platen lands, latches on the stop and rests there without current, while its gap is above {LIFTED * 1e3:g} mm; "
    "without three gap encoders, or without x and z, it latches in flight, with the safe output; "
)
DEGRADED = Fault(
    len(INTERFACE.inputs) + len(SENSORS),
    "degraded",
    about="a reading is refused, replaced or contradicted, or a sensor was a suspect since init",
)
INTERFACE_OF_ALL = replace(
    INTERFACE,
    # At the lower stop the magnets carry less than the weight. Current at a measured angle would repel the platen, but
    # an encoder that freezes there turns it into an unstable thrust, which drives the platen sideways and up.
    actuators=tuple(replace(a, landed=0.0) for a in INTERFACE.actuators),
    suspected=SENSORS,
    safe_output_effect=SENSOR_LOSS_EFFECT + INTERFACE.safe_output_effect,
    missed_calls=missed_calls.signal(MISSED_CALLS),
)


def courses(plant: Plant) -> list[landing.Course]:
    """Return the course of each axis of a landing; phi is left to the guide spring that the law compensates."""
    part = platen.COMPENSATED["k_s_phi"]
    spring = plant.constant("spring_phi", "1/s^2", lambda p: part * p["k_s_phi"])
    return [COURSES.get(a.name, landing.Release(a.name, spring)) for a in AXES]


def relations(plant: Plant) -> tuple[parity.Relation, ...]:
    """Return the parity relation of the gap encoders, from the kinematics."""
    return parity.relations(plant, {s.name: s.of for s in INTERFACE.sensors}, dict.fromkeys(SENSORS, SOUND))


def predict_gaps(plant: Plant) -> Block:
    """Return the Block from the predicted pose to the expected gaps, F(5) for small angles."""
    r = plant.constant("r")
    inputs = [replace(axis.position, name=f"{axis.name}_expected") for axis in AXES if axis.name not in "xz"]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        y, r_phi, r_theta = u["y_expected"], r.value * u["phi_expected"], r.value * u["theta_expected"]
        gaps = (y - r_phi, y + r_theta, y + r_phi, y - r_theta)
        label(r_phi=r_phi, r_theta=r_theta)
        return Step({f"y{j}_expected": g for j, g in zip(MOTORS, gaps, strict=True)}, numbers=[r])

    outputs = [replace(s, name=f"y{j}_expected", low=-1.0, high=1.0) for j, s in zip(MOTORS, HELD, strict=True)]
    return build("gap_prediction", TIME, law, inputs=inputs, outputs=outputs, tag="gaps of the predicted pose, F(5)")


def _with_free_range(w: Signal) -> Signal:
    """Return an acceleration with a range that no demand leaves, so that none is limited."""
    return replace(w, low=-1e6, high=1e6)


def accelerations(plant: Plant) -> Block:
    """Return the Block from the limited thrust currents and the gaps to the accelerations of x and z, F(6)."""
    values, currents = maglev_stage.nominal(plant), [INTERFACE.computed_output(f"u_{n}") for n in "xz"]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        motors = [pmlsm.force_law(u[s.name], values) for s in HELD]
        thrust = {f"u_{n}": u[s.name] for n, s in zip("xz", currents, strict=True)}
        accelerations = maglev_stage.thrust_accelerations(thrust, motors, values)
        label(motors=motors)
        return Step({f"a_{n}": a for n, a in accelerations.items()}, numbers=maglev_stage.inverse_masses(plant))

    outputs = [acceleration(a) for a in AXES if a.excess]
    return build("accelerations", TIME, law, inputs=[*HELD, *currents], outputs=outputs, tag="F(6)")


def delayed_accelerations() -> Block:
    """Return the Block that delays the accelerations by one sample: those that act until the next one."""
    return predictor.delay("delay", TIME, [_with_free_range(acceleration(a)) for a in AXES])


def observer(axis: Axis) -> Block:
    """Return the observer of an axis; x and z learn the gain of their thrust."""
    before = _with_free_range(replace(acceleration(axis), name=f"{acceleration(axis).name}_before"))
    flags = predictor.Flags(f"{axis.name}_trusted", f"{axis.name}_unchanged", f"{axis.name}_frozen")
    return predictor.block(
        axis.name,
        TIME,
        axis.position,
        before,
        bandwidth=BANDWIDTH[axis.name],
        rate=RATES[axis.name],
        disturbance=DISTURBANCES[axis.name],
        flags=flags if axis.excess else None,
        gain=THRUST_GAIN if axis.excess else None,
    )


def sufficiency() -> Block:
    """Return the Block that lets the platen land with two gap encoders, and x or z measured; lifted, it is probed."""
    flags = [Signal(n, "1", 0, 1) for n in ("gaps_sufficient", "x_trusted", "z_trusted", "regular")]
    height = replace(AXES[0].position, name="y_expected")

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        one = ca.logic_or(u["x_trusted"], u["z_trusted"])
        free = ca.logic_and(u["regular"], u[height.name] < LIFTED)
        label(one=one, free=free)
        return Step({"sufficient": ca.logic_and(u["gaps_sufficient"], one), "free": free}, numbers=[lifted])

    lifted = Constant("lifted", LIFTED, "m", "at a larger gap a stop may hold the platen")
    outputs = [Signal("sufficient", "1", 0, 1, "it can be controlled"), Signal("free", "1", 0, 1, "no stop holds it")]
    return build("sufficiency", TIME, law, inputs=[*flags, height], outputs=outputs, tag="it can land, is probed")


def positions_to_commutate() -> Block:
    """Return the Block from the readings of x and z to use to the positions for the commutation.

    While the controller lands, the prediction takes the place of a lost reading. After the latch nothing predicts it.
    """

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        lost = {n: ca.logic_and(u["latched"], ca.logic_not(u[f"{n}_trusted"])) for n in COMMUTATED}
        positions = {s.name: ca.if_else(lost[n], LOST, u[f"{n}_held"]) for n, s in COMMUTATED.items()}
        label(lost=lost)
        return Step(positions, numbers=[Constant("not_known", LOST, "m", "outside the range of x and z: it is lost")])

    flags = [Signal(f, "1", 0, 1) for f in ("latched", *(f"{n}_trusted" for n in COMMUTATED))]
    inputs, outputs = [*(INTERFACE.held(n) for n in COMMUTATED), *flags], [*COMMUTATED.values()]
    return build("angles", TIME, law, inputs=inputs, outputs=outputs, tag="positions for the commutation")


def laws(plant: Plant, law: Sequence[Block], at_rest: probe.Probe) -> list[Block]:
    """Return a law with the fault handling around it, and the probe `at_rest`.

    What the law demands and its direct currents pass through the fault handling. Where the law also computes the
    accelerations of x and z by the thrust currents, these are used.
    """
    diverted = {a.demand.name: f"{a.demand.name}_tracking" for a in AXES} | handover.BALANCED
    computed = {s.name for block in law for s in block.outputs}
    modelled = [] if {acceleration(a).name for a in AXES if a.excess} <= computed else [accelerations(plant)]
    readings = redundancy.block(TIME, [INTERFACE.signals[n] for n in SENSORS], relations(plant), DECISION)
    readings = replace(readings, faults=(DEGRADED,))
    missed, positions = INTERFACE_OF_ALL.missed_calls, [INTERFACE.signals[n] for n in COMMUTATED]
    descent = landing.block(TIME, courses(plant), [a.demand for a in AXES], platen.BAD_SAMPLES, platen.GOOD_SAMPLES)
    return [
        *(innovation_monitor.block(TIME, s, DECISION, missed) for s in positions),
        readings.renamed({"sufficient": "gaps_sufficient", "determined": "theta_measured"}),
        sufficiency(),
        predict_gaps(plant),
        *(b.renamed({s.name: diverted[s.name] for s in b.outputs if s.name in diverted}) for b in law),
        handover.block(),
        *modelled,
        delayed_accelerations(),
        *(observer(a) for a in AXES),
        descent.renamed({f"w_{n}": f"w_{n}_unprobed" for n in "xz"}),
        *(probe.block(TIME, a.name, a.error, a.demand, at_rest) for a in AXES if a.excess),
        positions_to_commutate(),
    ]


def controller(
    name: str, plant: Plant, law: Callable[[], Sequence[Block]], at_rest: probe.Probe = PROBE
) -> stage.Controller:
    """Return the controller `name`: a law with its fault handling."""
    return stage.controller(
        name,
        TIME,
        INTERFACE_OF_ALL,
        lambda: laws(plant, law(), at_rest),
        signal_names((*OUTPUTS, *COMMUTATED.values())),
    )
