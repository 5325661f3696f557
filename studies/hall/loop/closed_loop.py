"""Planar controller with the estimate as its position source: X, Y and yaw close the loop.

    V_ax .. V_cy -->[ guard ]-->[ estimator ]--> X, Y, yaw -->[ error_map ]-->[ hall_source ]--> x_raw, y_raw, phi_raw
                       |             |-- valid, lock_lost ----------------------^   |   within, known, suspects
                       '<------------------------- suspected, suspect_V_.. ----------'

The rest is the planar controller: regulators, allocation, commutation, safe output. The estimator is a `PoseSource`:
three sensors and the map of errors (`Source`), or four with protection levels (`four_sensors`). `hall_source` keeps an
invalid estimate out of the loop:

    not yet known   no estimate has been valid in the middle pitch, within the yaws of the stage: the position is taken
                    to be the set-point, and no current flows. A search may end a quarter turn off
    lock lost       the count of pitches is unknown: no estimate is used until init
    valid           the estimate is the position, and the motion per sample is filtered,
                    m <- m + VELOCITY_GAIN (estimate - prediction)
    invalid         the position is the prediction, the last position plus the motion

After MAX_INVALID consecutive invalid samples all Hall voltages are suspects. Without one of four sensors the estimate
is valid as long as its protection levels allow. While there are suspects no sample is complete, and the guard latches
BAD_SAMPLES later.

The choice of PLACES: docs/decisions/hall_position_loop.md.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import casadi as ca
import numpy as np

from designs.hall_position.glsdc import estimator
from designs.hall_position.glsdc.parameters import Tuning
from designs.hall_position.paper import layouts
from designs.planar_6dof import allocation, interface, vertical
from designs.planar_6dof.allocation import HORIZONTAL, PITCH
from designs.planar_6dof.sensing import sections as sensing
from models import planar_stage
from models.hall_array import Pair
from models.hall_two_waves import PlanarArray as Array
from synth.block import Block, Exprs, State, Step, build, clip
from synth.blocks.laws import error_map
from synth.blocks.laws.error_map import ErrorMap
from synth.declare.stage import Interface
from synth.errors import ModelError
from synth.plant import Plant
from synth.signals import Signal, signal_names
from synth.timing import Discrete

MAX_INVALID = 5  # samples
VELOCITY_GAIN = 0.1  # of the difference between estimate and prediction
MAX_MOTION = {"x": 1.25e-3, "y": 1.25e-3, "phi": 6.25e-3}  # m, rad a sample: 1 m/s and 5 rad/s at 800 Hz
ESTIMATE = {"x": "X", "y": "Y", "phi": "yaw"}
PLACES: tuple[Pair, ...] = tuple((x * PITCH, y * PITCH) for x, y in layouts.LAYOUTS[5])
MAP_INPUTS = [Signal(name, unit, -10, 10) for name, unit in (("X", "m"), ("Y", "m"), ("yaw", "rad"))]
FLAGS = tuple(Signal(n, "1", 0, 1, about) for n, about in (("valid", ""), ("lock_lost", "nothing is valid until init")))
START_RANGE = {"x": PITCH / 2, "y": PITCH / 2, "phi": sensing.MAX_RAW_YAW}  # m, rad
KNOWN = Signal("known", "1", 0, 1, "an estimate before this one was valid")
FLOOR_OFFSET = 4  # added before rounding down and subtracted after it: more than RAW holds
SURROGATE_ERROR: dict[type[np.floating], float] = estimator.SURROGATE_ERROR
# For the identified field, whose misfit is the noise: a change of speed by 0.9 m/s within a sample is not a motion.
TUNING = Tuning(residual_limit=0.2, innovation_gate_sigma=0.3)


class PoseSource(Protocol):
    """Source of the pose: the Blocks from the held voltages of so many `sensors` to the estimate and its flags.

    They give ``valid``, ``lock_lost``, and X, Y and yaw with the `suffix`. `shown` are outputs of interest beside
    them. A refused voltage is its last good one where the source needs it `held`.
    """

    @property
    def sensors(self) -> int: ...
    @property
    def suffix(self) -> str: ...
    @property
    def shown(self) -> tuple[str, ...]: ...
    @property
    def held(self) -> bool: ...
    def blocks(self, time: Discrete) -> list[Block]: ...


@dataclass(frozen=True, eq=False)
class Source:
    """Position source: the sensors, and the map of the estimate's errors."""

    array: Array
    map: ErrorMap | None = None
    shown: tuple[str, ...] = ("residual",)
    held: bool = False

    @property
    def sensors(self) -> int:
        """The number of sensors."""
        return len(self.array.positions)

    @property
    def suffix(self) -> str:
        """What the names of a corrected estimate end in."""
        return "_corrected" if self.map else ""

    def blocks(self, time: Discrete) -> list[Block]:
        """Return the estimator, and the map behind it."""
        estimated = estimator.estimator(self.array, time, TUNING)
        return [estimated, *([error_map.block(self.map, time, MAP_INPUTS, "Figs. 10, 11")] if self.map else [])]


def controller(
    name: str,
    plant: Plant,
    time: Discrete,
    law: Sequence[Block],
    source: PoseSource,
    declared: Interface = interface.INTERFACE,
) -> Block:
    """Return the planar controller on this source; `law` are its Blocks from positions to computed currents.

    Raises ModelError for a source with other than the sensors of the declared interface.
    """
    if 2 * source.sensors != len(declared.suspected):
        raise ModelError(
            f"the source has {source.sensors} sensors: the stage reads {len(declared.suspected) // 2}, give that many"
        )
    return interface.controller(name, plant, time, position_blocks(source, time), gate_currents(law, time), declared)


def position_blocks(source: PoseSource, time: Discrete) -> list[Block]:
    """Return the Blocks from held voltages to raw positions, positions within the pitch and suspects."""
    return [*source.blocks(time), _source(time, source.suffix, source.sensors)]


def _source(time: Discrete, suffix: str, sensors: int = 3) -> Block:
    """Return ``hall_source``, which reads estimates whose names end in `suffix`."""
    estimate = {axis: replace(sensing.RAW[axis], name=f"{ESTIMATE[axis]}{suffix}") for axis in HORIZONTAL}
    suspects = {f"suspect_{s.name}": s for s in planar_stage.hall_signals(sensors)}

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        known, starts = x["known"], ca.SX(1)
        for axis, limit in START_RANGE.items():
            starts = ca.logic_and(starts, ca.fabs(u[estimate[axis].name]) <= limit)
        is_usable = ca.logic_and(u["valid"], ca.logic_not(u["lock_lost"]))
        good = ca.logic_and(is_usable, ca.logic_or(known, starts))
        is_tracked = ca.logic_and(good, known)
        next: dict[str, ca.SX] = {"known": ca.if_else(good, 1, known)}
        output: dict[str, ca.SX] = {KNOWN.name: known}
        for axis in HORIZONTAL:
            at, predicted = u[estimate[axis].name], x[axis] + x[f"motion_{axis}"]
            held = ca.if_else(known, predicted, u[vertical.REFERENCES[axis].name])
            raw = clip(ca.if_else(good, at, held), sensing.RAW[axis])
            output[f"{axis}_raw"] = next[axis] = raw
            next[f"motion_{axis}"] = x[f"motion_{axis}"] + ca.if_else(is_tracked, VELOCITY_GAIN * (raw - predicted), 0)
        for signal, axis in zip(sensing.WITHIN, "xy", strict=True):
            whole = ca.floor(output[f"{axis}_raw"] / PITCH + (FLOOR_OFFSET + 0.5)) - FLOOR_OFFSET
            output[signal.name] = clip(output[f"{axis}_raw"] - PITCH * whole, signal)
        output |= dict.fromkeys((*suspects, sensing.SUSPECTED.name), x["failed"])
        return Step(output, next | _failures(x, good))

    references = [vertical.REFERENCES[axis] for axis in HORIZONTAL]
    return build(
        "hall_source",
        time,
        law,
        inputs=[*estimate.values(), *FLAGS, *references],
        outputs=[
            *(*sensing.RAW.values(), *sensing.WITHIN, KNOWN, sensing.SUSPECTED),
            *(Signal(n, "1", 0, 1, f"{s.name} contradicts the others") for n, s in suspects.items()),
        ],
        states=_states(),
        tag="predict while invalid, count to the latch",
    )


def _states() -> list[State]:
    reals = [replace(sensing.RAW[axis], name=axis, about="position of the last sample") for axis in HORIZONTAL]
    reals += [
        Signal(f"motion_{a}", sensing.RAW[a].unit, -MAX_MOTION[a], MAX_MOTION[a], "predicted motion per sample")
        for a in HORIZONTAL
    ]
    counts = [replace(KNOWN, about="an estimate has been valid")]
    counts += [Signal("invalid", "1", 0, MAX_INVALID, "consecutive invalid samples")]
    counts += [Signal("failed", "1", 0, 1, "the estimate has been invalid for too long")]
    return [*(State(s, 0.0) for s in reals), *(State(s, 0, True) for s in counts)]


def _failures(x: Exprs, good: ca.SX) -> dict[str, ca.SX]:
    """Return the next counts: invalid samples once the position is known, and whether they were ever too many."""
    too_long = x["invalid"] >= MAX_INVALID
    counted = ca.if_else(too_long, x["invalid"], ca.if_else(x["known"], x["invalid"] + 1, 0))
    return {
        "invalid": ca.if_else(good, 0, counted),
        "failed": ca.logic_or(x["failed"], ca.logic_and(x["known"], too_long)),
    }


def gate_currents(law: Sequence[Block], time: Discrete) -> list[Block]:
    """Return the law, made ready by a known position, and a gate that passes no current before."""
    computed = [s for b in law for s in b.outputs if s.name in signal_names(allocation.COMPUTED)]
    ungated = {s.name: s.name.replace("_computed", "_ungated") for s in computed}
    raw, ready = {s.name for s in sensing.RAW.values()}, {sensing.READY.name: KNOWN.name}
    blocks = [b.renamed(ungated | (ready if raw & b.symbol.keys() else {})) for b in law]

    def gate(u: Exprs, x: Exprs, k: Exprs) -> Step:
        return Step({name: ca.if_else(u[KNOWN.name], u[to], 0) for name, to in ungated.items()})

    inputs = [*(replace(s, name=ungated[s.name]) for s in computed), KNOWN]
    tag = "no current until a position is known"
    return [*blocks, build("known_gate", time, gate, inputs=inputs, outputs=computed, tag=tag)]
