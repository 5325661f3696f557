"""Closed loops of the planar controllers with the positions known."""

from collections.abc import Mapping, Sequence

import numpy as np

from designs.planar_6dof import allocation
from models import planar_stage
from synth.block import Block, unranged
from synth.composition import compose
from synth.emit import write
from synth.execute import host
from synth.signals import signal_names
from synth.simulate import closed_loop
from synth.simulate.scenario import Scenario, Trajectory
from synth.timing import Discrete
from tests.designs.planar_6dof import ideal_loops

PLANT = ideal_loops.PLANT


def at_rest() -> dict[str, float]:
    """Return what the sensors read in the middle of the travel."""
    y = np.asarray(PLANT.h(np.zeros(len(PLANT.states)), np.zeros(9), PLANT.values)).ravel()
    read = dict(zip(signal_names(PLANT.outputs), y.tolist(), strict=True))
    return {name: read[name] for name in (*planar_stage.HALL, *planar_stage.LASERS)}


def compile_law(law: Sequence[Block], time: Discrete, filtered: bool = False) -> host.Controller:
    """Return a law in float64 with the positions known, its set-points called as they are held."""
    parts = [*ideal_loops.sensing_blocks(PLANT, time, filtered), *law]
    inputs = [f"{a}_seen" for a in allocation.HORIZONTAL] + [*planar_stage.LASERS, *ideal_loops.REFERENCES]
    block = compose("known", parts, inputs=[*inputs, *ideal_loops.ready(parts)], outputs=[*ideal_loops.ACTUATORS])
    emitted = write.emit(unranged(block), np.float64)
    return host.load(emitted.files, emitted.manifest)


def run(
    controller: host.Controller,
    duration_s: float,
    references: Mapping[str, object],
    start: Mapping[str, float] | None = None,
    ready: object = 1.0,
) -> Trajectory:
    """Simulate the stage from rest at `start`, the middle if left out, with ideal sensors and a sample of delay."""
    known = controller.inputs.names or ()
    rest = dict.fromkeys(ideal_loops.REFERENCES, 0.0) | ({"ready": ready} if "ready" in known else {})
    sensors = {f"{a}_seen": a for a in allocation.HORIZONTAL} | {d: d for d in planar_stage.LASERS}
    inputs = rest | {f"{a}_ref_held": v for a, v in references.items()}
    scenario = Scenario(duration_s, start or {}, sensors, ideal_loops.ACTUATORS, references=inputs)
    return closed_loop.simulate(PLANT, controller, scenario)


def overshoot(y: np.ndarray, height: float) -> float:
    """Return by how much a step response goes beyond its height, of it."""
    return float(y.max() / height - 1)


def rise(y: np.ndarray, height: float, period_s: float) -> float:
    """Return the time in s from 10 % to 90 %."""
    return float((np.argmax(y > 0.9 * height) - np.argmax(y > 0.1 * height)) * period_s)
