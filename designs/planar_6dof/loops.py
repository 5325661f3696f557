"""The loops as the hardware sees them: the whole controller, a sample of delay, the hold, and the stage at a place.

    i_AQ .. i_CD                                              x .. psi
    ---*--->[ delay, hold, motors, stage, sampler ]-------*--->[ Hall sensors, lasers, controller ]---+
       ^                                                                                              |
       +----------------------------------------------------------------------------------------------+

Controller and stage are linearised about the platen at rest. Guard, sensing, filters, law, allocation, commutation and
safe output are in the controller as they ship, and with them the slope that the calibration of the Hall sensors has at
this place. What goes around are the six positions and the currents of the three motors along their motion (Q) and up
(D), which are the phases in coordinates that go along with the field:

    phases = E (i_Q, i_D),   (i_Q, i_D) = 2/3 E' phases         E'E = 3/2 I, for each motor

A loop is opened at some of these signals, marked by *, the others closed: L = -(what comes back), and 1 + L is closed.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from designs.planar_6dof import allocation, interface
from designs.planar_6dof import loop as simulated
from designs.planar_6dof.allocation import AXES
from models import lorentz_motor, planar_stage
from synth.analyse import disk, interconnect, linearise, loop, margins, realisation, trim
from synth.block import Block
from synth.errors import SignalError
from synth.plant import Plant
from synth.signals import names
from synth.statespace import Array, StateSpace, readonly
from synth.timing import Discrete

Place = Mapping[str, float]  # m and rad, by axis

MIDDLE: Place = dict.fromkeys(AXES, 0.0)  # of the travel
SETTLED = 50  # samples after which the filters have come to rest
PHASES, SENSED = names(planar_stage.INPUTS), (*planar_stage.HALL, *planar_stage.LASERS)
MOTORS = names(allocation.CURRENTS)
HORIZONTAL = MOTORS[:3]


@dataclass(frozen=True, eq=False)
class Parts:
    """The sampled stage from motor currents in A to positions in m and rad, and the controller back."""

    plant: StateSpace
    controller: StateSpace


@dataclass(frozen=True, eq=False)
class OpenLoop:
    """The loop of one axis, opened at its position, under a label, and its margins."""

    axis: str
    label: str
    L: StateSpace
    margins: margins.Margins


@dataclass(frozen=True, eq=False)
class Horizontal:
    """The loop of x, y and phi opened at the motors' currents along their motion, at the positions, and at both."""

    currents: StateSpace
    positions: StateSpace
    both: StateSpace

    def disks(self) -> dict[str, disk.DiskMargin]:
        """Return the disk margin at each cut, all of its channels varied at once."""
        return {name: disk.of_loop(getattr(self, name)) for name in ("currents", "positions", "both")}


def parts(plant: Plant, block: Block, place: Place = MIDDLE, delay: float = 1) -> Parts:
    """Return both parts of the loop of a whole controller with the platen at rest at a place, `delay` in samples."""
    pose = {**MIDDLE, **place}
    stage, E = linearise.linearise(plant, trim.trim(plant, pose, [])), commutation_matrix(plant, pose)
    T = block.time.period_s
    shown = stage.select(SENSED, ()).C[:, [stage.states.index(axis) for axis in AXES]]
    motors = stage.select(AXES, PHASES)
    held = loop.sampled(replace(motors, B=motors.B @ E, D=motors.D @ E, inputs=MOTORS), T, delay * T)
    K = loop.linearised(block, *resting(plant, block, pose)).select(PHASES, SENSED)
    seen, commands = tuple(f"{axis}_seen" for axis in AXES), tuple(f"{name}_command" for name in MOTORS)
    B, C, D = K.B @ shown, 2 / 3 * E.T @ K.C, 2 / 3 * E.T @ K.D @ shown
    return Parts(held, replace(K, B=B, C=C, D=D, inputs=seen, outputs=commands))


def resting(plant: Plant, block: Block, place: Place) -> tuple[dict[str, float], dict[str, float]]:
    """Return states and inputs of the controller with the platen at rest at its set-points, as its sensors show it."""
    pose = {**MIDDLE, **place}
    x = [pose.get(s.name, 0.0) for s in plant.states]
    y = np.asarray(plant.h(x, np.zeros(len(plant.inputs)), plant.values)).ravel().tolist()
    measured = {name: v for name, v in zip(names(plant.outputs), y, strict=True) if name in SENSED}
    view = simulated.view(block.time)
    shown = _stepped(view, dict.fromkeys(names(view.inputs), 0.0) | measured, SETTLED)[1]
    inputs = measured | {f"{axis}_ref": shown.get(axis, pose[axis]) for axis in AXES}
    return _stepped(block, inputs, 2)[0], inputs


def _stepped(block: Block, inputs: Mapping[str, float], samples: int) -> tuple[dict[str, float], dict[str, float]]:
    """Return states and outputs after some samples of constant inputs, from init."""
    step, x, u = block.function(), ca.DM(block.initial), [inputs[name] for name in names(block.inputs)]
    y = ca.DM()
    for _ in range(samples):
        x, y = step(x, u)
    columns = ((s.name for s in block.states), x), (names(block.outputs), y)
    states, outputs = (dict(zip(known, np.asarray(v).ravel().tolist(), strict=True)) for known, v in columns)
    return states, outputs


def commutation_matrix(plant: Plant, pose: Place) -> Array:
    """Return E (9, 6): the phase currents of a current of 1 A of each motor, along its motion or up."""
    p = {s.name: ca.SX(s.value) for s in plant.parameters}
    centres = planar_stage.centres({axis: ca.SX(v) for axis, v in pose.items()}, p)
    E = np.zeros((len(PHASES), len(MOTORS)))
    for column, name in enumerate(MOTORS):
        motor, along = name[2], name[3] == "Q"
        at = centres[motor].X if motor == "C" else centres[motor].Y
        phases = lorentz_motor.commutated(ca.SX(along), ca.SX(not along), at, p)
        for phase, current in phases.items():
            E[PHASES.index(f"i_{motor}{phase}"), column] = float(current)
    return readonly(E)


def opened(found: Parts, signals: Sequence[str]) -> StateSpace:
    """Return L (p, p) from and to some of the axes and motor currents, all others closed.

    Raises SignalError for a signal that is neither.
    """
    known = (*MOTORS, *AXES)
    if unknown := [name for name in signals if name not in known]:
        raise SignalError(f"{', '.join(unknown)} do not go around this loop: open it at some of {', '.join(known)}")
    ends = {name: f"{name}_command" for name in found.plant.inputs} | {a: a for a in found.plant.outputs}
    wires = {(n if n in MOTORS else f"{n}_seen"): {f"{n}_in" if n in signals else end: 1.0} for n, end in ends.items()}
    inputs, outputs = [f"{n}_in" for n in signals], [ends[n] for n in signals]
    around = interconnect.connect([found.plant, found.controller], inputs, outputs, wires)
    back = tuple(f"{n}_out" for n in signals)
    return realisation.connected(replace(around, C=-around.C, D=-around.D, inputs=tuple(signals), outputs=back))


def of_block(plant: Plant, block: Block, axes: Iterable[str], label: str) -> list[OpenLoop]:
    """Return the loops of some axes of a whole controller in the middle of the travel, the other five closed."""
    return of_parts(parts(plant, block), axes, label)


def of_parts(found: Parts, axes: Iterable[str], label: str) -> list[OpenLoop]:
    """Return the loops of some axes, all others closed."""
    return [OpenLoop(axis, label, L, margins.of_loop(L)) for axis in axes for L in [opened(found, [axis])]]


def whole(plant: Plant, time: Discrete, sensed: Sequence[Block], law: Sequence[Block]) -> Block:
    """Return the controller of `interface` with its constants in single precision."""
    return interface.controller("whole", plant, time, sensed, law).rounded(np.float32)


def exchanged(law: Sequence[Block], other: Sequence[Block], axis: str) -> list[Block]:
    """Return a law whose Blocks of one axis are those of another law: only its own loop is then as there."""
    own = {b.name: b for b in other if b.name.endswith(f"_{axis}")}
    return [own.get(b.name, b) for b in law]


def over_pitch(plant: Plant, block: Block, places: int = 7) -> list[dict[str, margins.Margins]]:
    """Return the margins of the six loops by axis at places spread over a pitch in x and in y."""
    l = plant.parameter("l").value
    spread = [{"x": l * _within(k, places), "y": l * _within(3 * k % places, places)} for k in range(places)]
    found = (parts(plant, block, place) for place in spread)
    return [{axis: margins.of_loop(opened(each, [axis])) for axis in AXES} for each in found]


def _within(k: int, places: int) -> float:
    return (k + 0.5) / places - 0.5


def horizontal(found: Parts) -> Horizontal:
    """Return the loop of x, y and phi, any other axes closed."""
    axes = allocation.HORIZONTAL
    return Horizontal(*(opened(found, cut) for cut in (HORIZONTAL, axes, (*HORIZONTAL, *axes))))


def scaled(L: StateSpace, sizes: Mapping[str, float]) -> StateSpace:
    """Return L with some channels taken times a factor, by name, where they leave it and where they come back."""
    s = np.array([sizes.get(name, 1.0) for name in L.inputs])
    return replace(L, B=L.B / s, C=L.C * s[:, None], D=L.D * s[:, None] / s, units={})
