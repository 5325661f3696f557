"""Faults of a campaign (FMEA), derived from the declaration of a stage.

    sensor              not finite, out of range, intermittent, frozen, offset, drift, noise, late, repeated,
                        bit flipped, bit stuck
    set-point           jump, refused
    actuator            dead, stuck, weak
    calls               missing, alternate, delayed
    two sensors         both lost, lost and frozen, both frozen: of one parity relation
    sensor, actuator    lost and dead: a sensor, and the actuator that moves it most

An intermittent sensor reads one good sample after each longest row of bad ones that does not latch by itself. A
permanent fault lasts to the end of the run, a short one for one sample less than the latch needs, and others as long
as the campaign declares. `fault_effects` states what each changes in a scenario.

Two sensors are in one parity relation where the projector on the left null space of the output Jacobian at rest,
I - C C+, has an entry for them: the positions do not determine their readings independently, so the loss of one leaves
the other redundant and the loss of both does not.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import combinations

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from synth.declare.stage import Stage
from synth.plant import Plant
from synth.simulate.rig import Rig

PERMANENT, SHORT = "permanent", "short"
SENSOR, SET_POINT, ACTUATOR, CALLS = "sensor", "set-point", "actuator", "calls"
SENSORS, SENSOR_AND_ACTUATOR = "two sensors", "sensor and actuator"
KINDS = {
    SENSOR: (
        *("not finite", "out of range", "intermittent", "frozen", "offset", "drift", "noise", "late", "repeated"),
        *("bit flipped", "bit stuck"),
    ),
    SET_POINT: ("jump", "refused"),
    ACTUATOR: ("dead", "stuck", "weak"),
    CALLS: ("missing", "alternate", "delayed"),
    SENSORS: ("both lost", "lost and frozen", "both frozen"),
    SENSOR_AND_ACTUATOR: ("lost and dead",),
}
# One target that fails for good: what a build runs.
BASIC = {SENSOR: ("not finite", "frozen"), ACTUATOR: ("dead",), CALLS: ("missing",)}
PAIRS = (SENSORS, SENSOR_AND_ACTUATOR)
PARITY = 1e-6  # of the projector, whose entries are at most 1: below it a sensor is in no parity relation
AND = " + "  # between the two targets of a pair


@dataclass(frozen=True)
class Injection:
    """One fault: the class of its target, the target, the kind and the duration.

    A sweep gives a `magnitude` in place of the campaign's, as a fraction of the range, and a number of `samples` in
    place of those of the duration.
    """

    group: str
    target: str
    kind: str
    duration: str
    magnitude: float | None = None
    samples: int | None = None

    @property
    def targets(self) -> tuple[str, ...]:
        """The faulty sensors, set-points and actuators."""
        return tuple(self.target.split(AND))


def derive(stage: Stage) -> tuple[Injection, ...]:
    """Return every fault of the stage's interface: of sensors, set-points, plant inputs with an actuator, calls."""
    interface, durations = stage.interface, stage.faults.durations_s
    targets = {
        SENSOR: [s.name for s in interface.sensors],
        SET_POINT: [s.name for s in interface.references],
        ACTUATOR: list(_connections(stage)),
        CALLS: ["calls"],
        SENSORS: [AND.join(pair) for pair in sensor_pairs(stage)],
        SENSOR_AND_ACTUATOR: [AND.join(pair) for pair in driven_sensors(stage)],
    }
    finite = ([SHORT] if interface.bad_samples > 1 else []) + [f"{seconds:g} s" for seconds in durations]
    return tuple(
        Injection(group, target, kind, duration)
        for group, kinds in KINDS.items()
        for target in targets[group]
        for kind in kinds
        for duration in (PERMANENT, *(finite if group not in PAIRS else ()))
    )


def sample_count(rig: Rig, injection: Injection, n: int) -> int:
    """Return the number of samples that a fault lasts in a run of n samples."""
    if injection.samples is not None:
        return injection.samples
    if injection.duration == PERMANENT:
        return n
    if injection.duration == SHORT:
        return rig.stage.interface.bad_samples - 1
    return max(1, round(float(injection.duration.removesuffix(" s")) / rig.period_s))


def is_basic(injection: Injection) -> bool:
    """Return whether a fault is one of BASIC for the rest of the run."""
    return injection.duration == PERMANENT and injection.kind in BASIC.get(injection.group, ())


def is_loss(injection: Injection) -> bool:
    """Return whether a fault is the loss of one sensor for the rest of the run."""
    return (injection.group, injection.kind, injection.duration) == (SENSOR, "not finite", PERMANENT)


def _plant(stage: Stage) -> Plant:
    """Return the plant with the inputs that faults of actuators concern: that of the drive, where there is one."""
    return stage.drive.plant if stage.drive else stage.plant


def _connections(stage: Stage) -> Iterable[str]:
    """Return the plant inputs that an actuator drives."""
    if stage.drive:
        return [s.name for s in stage.drive.plant.inputs if s.name not in stage.interface.disturbances]
    return stage.wires or [a.of for a in stage.interface.actuators]


def sensor_pairs(stage: Stage) -> tuple[tuple[str, str], ...]:
    """Return the pairs of sensors that are in one parity relation of the model at rest."""
    C, _, _ = _linear_model(stage)
    sensors = [s.name for s in stage.interface.sensors]
    projector = np.eye(len(sensors)) - C @ np.linalg.pinv(C)
    pairs = combinations(range(len(sensors)), 2)
    return tuple((sensors[i], sensors[j]) for i, j in pairs if abs(projector[i, j]) > PARITY)


def driven_sensors(stage: Stage) -> tuple[tuple[str, str], ...]:
    """Return each sensor with the plant input that moves it most: the largest Markov parameter times the input range.

    The Markov parameter is the first of C B, C A B, C A^2 B that is not 0; a sensor that no actuator moves is left out.
    """
    C, A, B = _linear_model(stage)
    plant_inputs = _plant(stage).inputs
    inputs = [s.name for s in plant_inputs]
    driven = [inputs.index(name) for name in _connections(stage)]
    spans = np.array([plant_inputs[j].high - plant_inputs[j].low for j in driven])
    pairs = []
    for sensor, row in zip(stage.interface.sensors, C, strict=True):
        markov = [np.abs(row @ np.linalg.matrix_power(A, k) @ B[:, driven]) * spans for k in range(3)]
        gains = next((g for g in markov if g.max(initial=0.0) > 0), None)
        if gains is not None:
            pairs.append((sensor.name, inputs[driven[int(np.argmax(gains))]]))
    return tuple(pairs)


def _linear_model(stage: Stage) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return C of the sensors, A and B at the start of the stage with zero inputs, in the units of the ranges.

    Rows and columns are scaled by the spans of the signals, so that metres and radians compare.
    """
    plant = _plant(stage)
    x, u = ca.SX.sym("x", len(plant.states)), ca.SX.sym("u", len(plant.inputs))
    f, h = plant.f(x, u, plant.values), plant.h(x, u, plant.values)
    jacobians = ca.Function("jacobians", [x, u], [ca.jacobian(h, x), ca.jacobian(f, x), ca.jacobian(f, u)])
    start = [stage.start.get(s.name, 0.0) for s in plant.states]
    C, A, B = (np.array(ca.DM(m)) for m in jacobians(start, np.zeros(len(plant.inputs))))
    outputs = [s.name for s in plant.outputs]
    rows = [outputs.index(s.of) for s in stage.interface.sensors]
    spans = np.array([s.high - s.low for s in plant.states])
    ranges = np.array([plant.outputs[i].high - plant.outputs[i].low for i in rows])
    return C[rows] * spans / ranges[:, None], A * spans / spans[:, None], B / spans[:, None]
