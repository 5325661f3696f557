"""The estimate as the position source of a planar controller: X, Y and yaw close the loop.

    V_ax .. V_cy -->[ guard ]-->[ estimator ]--> X, Y, yaw -->[ error_map ]-->[ hall_source ]--> x_raw, y_raw, phi_raw
                       |             |------ valid, restarted, without ----------^   |   within, known, suspects
                       '<------------------------- suspected, suspect_V_.. ----------'

What follows is the planar controller's own: regulators, allocation, commutation, safe output. `hall_source` stands
between, so that an estimate that is not valid does not move the loop:

    not yet known   no estimate has been valid in the middle pitch, within the yaws of the stage: the platen counts as
                    at rest at its set-point, and no current flows. A search may end a pitch or a quarter turn off
    restarted       the estimate looked for its place again and counts pitches from anywhere: it is not valid until init
    valid           the estimate is the position; the motion a sample follows it, m <- m + FOLLOW (estimate - expected)
    invalid         the position is the one expected, the last position and the motion

After LOST invalid samples in a row all Hall voltages are suspects, and both voltages of a sensor that the estimator
leaves out are so at once: no sample is complete then, and the guard latches BAD_SAMPLES later.

The choice of PLACES: docs/decisions/hall_position_loop.md.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from designs.hall_position.accuracy import layouts
from designs.hall_position.glsdc import estimator
from designs.hall_position.glsdc.parameters import Tuning
from designs.planar_6dof import interface, vertical
from models import hall_sections as sensing
from models import planar_allocation as allocation
from models.hall_array import Pair
from models.hall_two_waves import PlanarArray as Array
from models.planar_allocation import HORIZONTAL, PITCH
from synth.block import Block, Exprs, State, Step, build, clip
from synth.blocks import error_map
from synth.blocks.error_map import ErrorMap
from synth.errors import ModelError
from synth.plant import Plant
from synth.signals import Signal, names
from synth.timing import Discrete

MAX_INVALID = 5  # samples
VELOCITY_GAIN = 0.1  # of what a sample differs from the expected one
MAX_MOTION = {"x": 1.25e-3, "y": 1.25e-3, "phi": 6.25e-3}  # m, rad a sample: 1 m/s and 5 rad/s at 800 Hz
ESTIMATE = {"x": "X", "y": "Y", "phi": "yaw"}
PLACES: tuple[Pair, ...] = tuple((x * PITCH, y * PITCH) for x, y in layouts.LAYOUTS[5])
MAP_INPUTS = [Signal(name, unit, -10, 10) for name, unit in (("X", "m"), ("Y", "m"), ("yaw", "rad"))]
SENSORS = 3
ALL_SENSORS = SENSORS + 1  # in place of the number of the sensor that failed
START_RANGE = {"x": PITCH / 2, "y": PITCH / 2, "phi": sensing.YAW}  # m, rad
KNOWN = Signal("known", "1", 0, 1, "an estimate before this one was valid")
FLOOR_OFFSET = 4  # that are added before a number is cut off, and taken off again: more than RAW reaches
SURROGATE_ERROR: dict[type[np.floating], float] = estimator.SURROGATE_ERROR
# Of a field that a calibration has shown: its misfit is what the voltages are wrong by, and a motion that changes by
# 0.9 m/s within a sample is none.
TUNING = Tuning(residual_limit=0.2, innovation_gate_sigma=0.3)


@dataclass(frozen=True, eq=False)
class Source:
    """Where the position comes from: sensors, and the map of what the estimate from them errs by."""

    array: Array
    map: ErrorMap | None = None


def controller(name: str, plant: Plant, time: Discrete, law: Sequence[Block], source: Source) -> Block:
    """Return the whole planar controller on this source, `law` being its Blocks from positions to computed currents.

    Raises ModelError for a source that is not of three sensors.
    """
    if len(source.array.positions) != SENSORS:
        raise ModelError(
            f"the source has {len(source.array.positions)} sensors: the stage reads {SENSORS}, give so many"
        )
    return interface.controller(name, plant, time, position_blocks(source, time), gate_currents(law, time))


def position_blocks(source: Source, time: Discrete) -> list[Block]:
    """Return the Blocks from held voltages to raw positions, places within the pitch and suspects."""
    estimated = estimator.estimator(source.array, time, TUNING)
    if source.map is None:
        return [estimated, _source(time, "")]
    return [estimated, error_map.block(source.map, time, MAP_INPUTS, "Figs. 10, 11"), _source(time, "_corrected")]


def _source(time: Discrete, suffix: str) -> Block:
    """Return ``hall_source``; the estimate's names end in `suffix`."""
    estimate = {axis: replace(sensing.RAW[axis], name=f"{ESTIMATE[axis]}{suffix}") for axis in HORIZONTAL}
    valid, restarted = Signal("valid", "1", 0, 1), Signal("lock_lost", "1", 0, 1, "pitches are not known any more")
    without = Signal("excluded_sensor", "1", 0, ALL_SENSORS - 1, "number of the sensor that is left out")

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        known, begins = x["known"], ca.SX(1)
        for axis, far in START_RANGE.items():
            begins = ca.logic_and(begins, ca.fabs(u[estimate[axis].name]) <= far)
        sound = ca.logic_and(u["valid"], ca.logic_not(u["lock_lost"]))
        good = ca.logic_and(sound, ca.logic_or(known, begins))
        after = ca.logic_and(good, known)
        next: dict[str, ca.SX] = {"known": ca.if_else(good, 1, known)}
        output: dict[str, ca.SX] = {KNOWN.name: known}
        for axis in HORIZONTAL:
            at, expected = u[estimate[axis].name], x[axis] + x[f"motion_{axis}"]
            held = ca.if_else(known, expected, u[vertical.REFERENCES[axis].name])
            raw = clip(ca.if_else(good, at, held), sensing.RAW[axis])
            output[f"{axis}_raw"] = next[axis] = raw
            next[f"motion_{axis}"] = x[f"motion_{axis}"] + ca.if_else(after, VELOCITY_GAIN * (raw - expected), 0)
        for signal, axis in zip(sensing.WITHIN, "xy", strict=True):
            whole = ca.floor(output[f"{axis}_raw"] / PITCH + (FLOOR_OFFSET + 0.5)) - FLOOR_OFFSET
            output[signal.name] = clip(output[f"{axis}_raw"] - PITCH * whole, signal)
        return Step(output | _suspects(x), next | _failures(u, x, good))

    references = [vertical.REFERENCES[axis] for axis in HORIZONTAL]
    return build(
        "hall_source",
        time,
        law,
        inputs=[*estimate.values(), valid, restarted, without, *references],
        outputs=[*sensing.RAW.values(), *sensing.WITHIN, KNOWN, sensing.SUSPECTED, *sensing.SUSPECTS],
        states=_states(),
        tag="hold what is expected, count to the latch",
    )


def _states() -> list[State]:
    reals = [replace(sensing.RAW[axis], name=axis, about="of the last sample") for axis in HORIZONTAL]
    reals += [
        Signal(f"motion_{a}", sensing.RAW[a].unit, -MAX_MOTION[a], MAX_MOTION[a], "expected in a sample")
        for a in HORIZONTAL
    ]
    counts = [replace(KNOWN, about="an estimate has been valid")]
    counts += [Signal("invalid", "1", 0, MAX_INVALID, "invalid samples in a row")]
    counts += [Signal("failed", "1", 0, ALL_SENSORS, "number of the sensor that failed, the last for any of them")]
    return [*(State(s, 0.0) for s in reals), *(State(s, 0, True) for s in counts)]


def _failures(u: Exprs, x: Exprs, good: ca.SX) -> dict[str, ca.SX]:
    """Return the next counts: invalid samples once the place is known, and the sensor that failed, for good."""
    lost = x["invalid"] >= MAX_INVALID
    counted = ca.if_else(lost, x["invalid"], ca.if_else(x["known"], x["invalid"] + 1, 0))
    failed_sensor = ca.if_else(lost, ALL_SENSORS, 0)
    for n in range(1, ALL_SENSORS):
        failed_sensor = ca.if_else(u["excluded_sensor"] >= n, n, failed_sensor)
    return {
        "invalid": ca.if_else(good, 0, counted),
        "failed": ca.if_else(x["failed"], x["failed"], ca.if_else(x["known"], failed_sensor, 0)),
    }


def _suspects(x: Exprs) -> dict[str, ca.SX]:
    failed = x["failed"]
    suspects = {sensing.SUSPECTED.name: failed > 0}
    for n, letter in enumerate("abc", 1):
        one = ca.logic_or(failed == n, failed == ALL_SENSORS)
        suspects |= {f"suspect_V_{letter}{axis}": one for axis in "xy"}
    return suspects


def gate_currents(law: Sequence[Block], time: Discrete) -> list[Block]:
    """Return a law that is ready when a position is known, and a gate that passes no current before."""
    computed = [s for b in law for s in b.outputs if s.name in names(allocation.COMPUTED)]
    demanded = {s.name: s.name.replace("_computed", "_wanted") for s in computed}
    raw, ready = {s.name for s in sensing.RAW.values()}, {sensing.READY.name: KNOWN.name}
    blocks = [b.renamed(demanded | (ready if raw & b.symbol.keys() else {})) for b in law]

    def gate(u: Exprs, x: Exprs, k: Exprs) -> Step:
        return Step({name: ca.if_else(u[KNOWN.name], u[to], 0) for name, to in demanded.items()})

    inputs, tag = (
        [*(replace(s, name=demanded[s.name]) for s in computed), KNOWN],
        "no current until a position is known",
    )
    return [*blocks, build("known_gate", time, gate, inputs=inputs, outputs=computed, tag=tag)]
