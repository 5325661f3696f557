"""Linear loops of the planar positioner: the whole controller, one sample of delay, the hold, and the stage.

    i_AQ .. i_CD                                              x .. psi
    ---*--->[ delay, hold, motors, stage, sampler ]-------*--->[ Hall sensors, lasers, controller ]---+
       ^                                                                                              |
       +----------------------------------------------------------------------------------------------+

Controller and stage are linearised about the platen at rest at a place. The controller is the shipped one, with guard,
sensing, filters, law, allocation, commutation and safe output, and with the local slope of the calibration of the Hall
sensors. The signals of the loop are the six positions and the quadrature (Q) and direct (D) currents of the three
motors, the phase currents in coordinates of the field:

    phases = E (i_Q, i_D),   (i_Q, i_D) = 2/3 E' phases         E'E = 3/2 I, for each motor

A loop is opened at some of these signals, marked by *, with the others closed. L is minus the returned signal, so the
closed loop has the characteristic function det(I + L).
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from designs.planar_6dof import allocation, interface
from designs.planar_6dof import loop as simulated
from designs.planar_6dof.allocation import AXES
from models import planar_stage
from models.planar_stage import commutation_matrix
from synth.analyse import operating_points
from synth.analyse.loops import loop, robustness, stability_margins
from synth.block import Block
from synth.declare.stage import Stage
from synth.plant import Plant
from synth.signals import signal_names
from synth.statespace import Array, StateSpace
from synth.timing import Discrete
from synth.verify import agree, replays

Place = Mapping[str, float]  # m and rad, by axis

MIDDLE: Place = dict.fromkeys(AXES, 0.0)  # of the travel
IN_THE_MIDDLE = "in the middle"  # the name of that place
PLACES = 7  # over a pitch in x and in y
SETTLING_SAMPLES = 50  # samples after which the filters are in steady state
PHASES, SENSED = signal_names(planar_stage.INPUTS), interface.SENSORS
MOTORS = signal_names(allocation.CURRENTS)
HORIZONTAL = MOTORS[:3]


@dataclass(frozen=True, eq=False)
class LoopParts:
    """The stage from motor currents in A to positions in m and rad, the controller back, and the delay in samples."""

    plant: StateSpace
    controller: StateSpace
    delay: float = 1


@dataclass(frozen=True, eq=False)
class OpenLoop:
    """The loop of one axis, opened at its position `signal`, with a label and its margins."""

    signal: str
    label: str
    L: StateSpace
    margins: stability_margins.Margins


def parts(plant: Plant, block: Block, place: Place = MIDDLE, delay: float = 1) -> LoopParts:
    """Return plant and controller of the loop of a whole controller, with the platen at rest at a place."""
    pose = {**MIDDLE, **place}
    stage = operating_points.linearise(plant, operating_points.trim(plant, pose, []))
    C = stage.select(SENSED, ()).C[:, [stage.states.index(axis) for axis in AXES]]
    K = loop.linearise_block(block, *rest_point(plant, block, pose))
    return in_motor_coordinates(stage.select(AXES, PHASES), K, C, commutation_matrix(plant, pose), delay)


def in_motor_coordinates(
    stage: StateSpace, controller: StateSpace, measurement: Array, E: Array, delay: float = 1
) -> LoopParts:
    """Return a loop in motor currents and positions; `measurement` (9, 6) maps positions to sensor values."""
    K = controller.select(PHASES, SENSED)
    B, C, D = K.B @ measurement, 2 / 3 * E.T @ K.C, 2 / 3 * E.T @ K.D @ measurement
    motors = replace(stage, B=stage.B @ E, D=stage.D @ E, inputs=MOTORS)
    return LoopParts(motors, replace(K, B=B, C=C, D=D, inputs=AXES, outputs=MOTORS), delay)


def rest_point(plant: Plant, block: Block, place: Place) -> tuple[dict[str, float], dict[str, float]]:
    """Return states and inputs of the controller with the platen at rest at its set-points, as measured."""
    outputs, view = plant.output_values(place), simulated.position_block(block.time)
    measured = {name: float(outputs[name][0]) for name in SENSED}
    positions = _hold_inputs(view, dict.fromkeys(signal_names(view.inputs), 0.0) | measured, SETTLING_SAMPLES).outputs
    inputs = measured | {f"{a}_ref": float(positions[a][-1]) if a in positions else place.get(a, 0.0) for a in AXES}
    return {name: float(v[0]) for name, v in _hold_inputs(block, inputs, 2).states.items()}, inputs


def _hold_inputs(block: Block, inputs: Mapping[str, float], samples: int) -> agree.StepResults:
    """Return outputs and states of a Block after some samples of constant inputs, from init."""
    start, columns = {s.name: s.initial for s in block.states}, {n: np.full(samples, v) for n, v in inputs.items()}
    return replays.run(agree.casadi(block), start, columns)


def open_loop(both: LoopParts, signals: Sequence[str]) -> StateSpace:
    """Return L (p, p), opened at some of the axes and motor currents, with all others closed.

    Raises SignalError for another signal.
    """
    sensors, actuators = ({name: name for name in ends} for ends in (both.plant.outputs, both.plant.inputs))
    return loop.open_loop(both.plant, both.controller, list(signals), sensors, actuators, both.delay)


def of_block(plant: Plant, block: Block, axes: Iterable[str], label: str) -> list[OpenLoop]:
    """Return the loops of some axes of a whole controller in the middle of the travel, the other five closed."""
    return of_parts(parts(plant, block), axes, label)


def of_parts(both: LoopParts, axes: Iterable[str], label: str) -> list[OpenLoop]:
    """Return the loops of some axes, all others closed."""
    return [OpenLoop(axis, label, L, stability_margins.of_loop(L)) for axis in axes for L in [open_loop(both, [axis])]]


def rounded_controller(plant: Plant, time: Discrete, sensed: Sequence[Block], law: Sequence[Block]) -> Block:
    """Return the controller of `interface` with its constants in single precision."""
    return interface.controller("whole", plant, time, sensed, law).rounded(np.float32)


def with_axis_of(law: Sequence[Block], other: Sequence[Block], axis: str) -> list[Block]:
    """Return a law with the Blocks of one axis taken from another law."""
    replacement = {b.name: b for b in other if b.name.endswith(f"_{axis}")}
    return [replacement.get(b.name, b) for b in law]


def places_over_pitch(pitch: float, places: int) -> list[Place]:
    """Return places spread over a pitch in x and in y."""
    offsets = (pitch * ((np.arange(places) + 0.5) / places - 0.5)).tolist()
    return [{"x": offsets[k], "y": offsets[3 * k % places]} for k in range(places)]


def at_places(stage: Stage) -> list[robustness.LoopsAt]:
    """Return the loops of the shipped controller in the middle and at places over a pitch, for the margins of a stage.

    A loop is opened at the position of each axis. For the disk margin it is opened at all axes and motor currents.
    """
    block = stage.controller.block.rounded(stage.scalar)
    spread = places_over_pitch(stage.plant.parameter("l").value, PLACES)
    places = {IN_THE_MIDDLE: MIDDLE} | {f"at place {k + 1} of the pitch": place for k, place in enumerate(spread)}
    each = {name: parts(stage.plant, block, place) for name, place in places.items()}
    return [robustness.LoopsAt(name, AXES, (*MOTORS, *AXES), partial(open_loop, both)) for name, both in each.items()]


def horizontal(both: LoopParts) -> dict[str, StateSpace]:
    """Return the loop of x, y and phi opened at the quadrature currents, at the positions, and at both."""
    cuts = {"currents": HORIZONTAL, "positions": allocation.HORIZONTAL}
    cuts["both"] = (*HORIZONTAL, *allocation.HORIZONTAL)
    return {name: open_loop(both, cut) for name, cut in cuts.items()}


def scaled(L: StateSpace, sizes: Mapping[str, float]) -> StateSpace:
    """Return L with some channels scaled by a factor, by name: S L S^-1."""
    s = np.array([sizes.get(name, 1.0) for name in L.inputs])
    return replace(L, B=L.B / s, C=L.C * s[:, None], D=L.D * s[:, None] / s, units={})
