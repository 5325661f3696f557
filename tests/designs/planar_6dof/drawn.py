"""Random steps of the planar controllers over the whole travel, and closed loops with the positions known."""

from collections.abc import Mapping, Sequence

import casadi as ca
import numpy as np

from designs.planar_6dof import allocation
from models import planar_stage
from synth.block import Block
from synth.compose import compose
from synth.emit import write
from synth.execute import host
from synth.signals import names
from synth.simulate import closed_loop
from synth.simulate.scenario import Scenario, Trajectory
from synth.timing import Discrete
from synth.verify import agree
from tests.designs.planar_6dof import opened

PLANT = opened.PLANT
# A: a phase is one projection of a current of up to 1.26 A. What the polynomials leave of it, 1e-14, is no smaller
# where the projection is, nor is what is left where terms of 1e4 N cancel.
FLOOR = 1.0
Columns = dict[str, np.ndarray]


def steps(block: Block, n: int, size: float, seed: int = 0) -> tuple[Columns, Columns]:
    """Draw n states and inputs of a whole controller near a pose; demands are of `size` of what the motors make."""
    rng = np.random.default_rng(seed)
    states = {s.name: rng.uniform(s.signal.low, s.signal.high, n) for s in block.states}
    for s in (s for s in block.states if s.integer):
        states[s.name] = rng.integers(int(s.signal.low), int(s.signal.high) + 1, n).astype(float)
    pose = {a: rng.uniform(allocation.BOX[a].low, allocation.BOX[a].high, n) for a in allocation.AXES}
    x = np.zeros((len(PLANT.states), n))
    x[:6] = [pose[a] for a in names(PLANT.states)[:6]]
    x0, u0, _ = PLANT.h.sx_in()
    h = ca.Function("h", [x0, u0], [PLANT.h(x0, u0, PLANT.values)])
    outputs = dict(zip(names(PLANT.outputs), np.asarray(h.map(n)(x, np.zeros((9, n)))), strict=True))
    inputs = {name: outputs[name] for name in (*planar_stage.HALL, *planar_stage.LASERS)}
    states |= {"guard_latched": np.zeros(n), "guard_ready": (rng.uniform(size=n) < 0.98).astype(float)}
    for name in planar_stage.HALL:
        states[f"sensing_found_{name}"] = (rng.uniform(size=n) < 0.01).astype(float)
    for a in allocation.HORIZONTAL:
        states[f"filter_{a}_p"] = pose[a] + rng.normal(0, 3e-5, n)
        states |= {f"filter_{a}_s": rng.normal(0, 1e-5, n), f"filter_{a}_h": rng.normal(0, 1e-6, n)}
    for a in "xy":
        states[f"sensing_count_{a}"] = np.clip(np.round(pose[a] / PLANT.parameter("l").value), -2, 2)
    most = allocation.authority(PLANT)
    for s in block.states:
        axis = s.name.split("_")[1]
        if s.name.startswith(("loop_", "lqg_")):
            drawn = rng.normal(0, 0.3 * size * most[axis], n)
            drawn -= _observed(block, axis) * pose[axis] if s.name.endswith("_x3") else 0.0
            states[s.name] = np.clip(drawn, s.signal.low, s.signal.high)
    for a, high in ((a, allocation.BOX[a].high) for a in allocation.AXES):
        error = size * most[a] / _stiffness(block, a) * rng.normal(0, 0.3, n)
        inputs[f"{a}_ref"] = np.clip(pose[a] + error, -high, high)
    return states, inputs


def _constant(block: Block, name: str) -> float:
    return next((c.value for c in block.constants if c.name == name), 0.0)


def _stiffness(block: Block, axis: str) -> float:
    """Return the demand for an error of 1."""
    return _constant(block, f"loop_{axis}_direct") or _constant(block, f"lqg_{axis}_on_error")


def _observed(block: Block, axis: str) -> float:
    return _constant(block, f"lqg_{axis}_L")


def disagreement(block: Block, first: agree.Stepped, second: agree.Stepped) -> float:
    """Return the worst difference of outputs, of max(FLOOR, |i|), and of the law's next states.

    Of these it is relative to max(|value|, what the motors can make of the axis).
    """
    worst, most = agree.compare("", ("", first), ("", second), FLOOR, block).worst, allocation.authority(PLANT)
    for name in (s.name for s in block.states if s.name.startswith(("loop_", "lqg_"))):
        r, v = first.states[name], second.states[name]
        worst = max(worst, float(np.max(np.abs(r - v) / np.maximum(np.abs(r), most[name.split("_")[1]]))))
    return worst


def at_rest() -> dict[str, float]:
    """Return what the sensors read in the middle of the travel."""
    y = np.asarray(PLANT.h(np.zeros(len(PLANT.states)), np.zeros(9), PLANT.values)).ravel()
    read = dict(zip(names(PLANT.outputs), y.tolist(), strict=True))
    return {name: read[name] for name in (*planar_stage.HALL, *planar_stage.LASERS)}


def saturated(outputs: Mapping[str, np.ndarray]) -> np.ndarray:
    """Tell for each sample whether a motor stands at its limit, from its phases."""
    size = []
    for motor in planar_stage.MOTORS:
        a, b, c = (np.asarray(outputs[f"i_{motor}{phase}"]) for phase in "ABC")
        size.append(np.sqrt(2 / 3 * (a**2 + b**2 + c**2)))
    return np.max(size, axis=0) >= allocation.QUADRATURE * (1 - 1e-9)


def compiled(law: Sequence[Block], time: Discrete, filtered: bool = False) -> host.Controller:
    """Return a law in float64 with the positions known, its set-points called as they are held."""
    parts = [*opened.seen(PLANT, time, filtered), *law]
    inputs = [f"{a}_seen" for a in allocation.HORIZONTAL] + [*planar_stage.LASERS, *opened.REFERENCES, *opened.PITCHES]
    block = compose("known", parts, inputs=[*inputs, *opened.ready(parts)], outputs=[*opened.ACTUATORS])
    emitted = write.emit(block, np.float64)
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
    rest = dict.fromkeys((*opened.REFERENCES, *opened.PITCHES), 0.0) | ({"ready": ready} if "ready" in known else {})
    sensors = {f"{a}_seen": a for a in allocation.HORIZONTAL} | {d: d for d in planar_stage.LASERS}
    given = rest | {f"{a}_ref_held": v for a, v in references.items()}
    scenario = Scenario(duration_s, start or {}, sensors, opened.ACTUATORS, references=given)
    return closed_loop.simulate(PLANT, controller, scenario)


def overshoot(y: np.ndarray, height: float) -> float:
    """Return by how much a step response goes beyond its height, of it."""
    return float(y.max() / height - 1)


def rise(y: np.ndarray, height: float, period_s: float) -> float:
    """Return the time in s from 10 % to 90 %."""
    return float((np.argmax(y > 0.9 * height) - np.argmax(y > 0.1 * height)) * period_s)
