"""What a stage can follow: the largest speed, acceleration and jerk of each set-point, at the pose where it works.

    q'' = a(x, u),   B = da/du,   u0: a(x0, u0) = 0,   B+ = pinv(B)
    a_max,i = FRACTION * max s   such that u0 +- s B+ e_i stays within the ranges of the actuators

The rest of the actuators is left to feedback. The speed is the range of the velocity's state. The largest step is that
of the stage's experiments, or SHARE of the range where they have none.
"""

from collections.abc import Mapping
from typing import NamedTuple, TypeGuard

import casadi as ca
import numpy as np

from synth.declare.experiments import StepResponse
from synth.declare.stage import Stage
from synth.statespace import Array

FRACTION = 0.5  # of the actuators, for set-points
SHARE = 0.1  # of the range of a set-point: a step
RISE = 20  # samples: from no acceleration to the largest
TRAVEL_S = 0.1  # across the range of a set-point whose position is no state


class Limits(NamedTuple):
    """The largest speed, acceleration, jerk and step of a set-point, in its unit per s, s^2, s^3, and in its unit."""

    speed: float
    acceleration: float
    jerk: float
    step: float


def of_stage(stage: Stage, positions: Mapping[str, str], home: Mapping[str, float]) -> dict[str, Limits]:
    """Return the limits of each set-point, with its state in `positions`, and auxiliary input, around `home`."""
    plant, period = stage.plant, stage.controller.time.period_s
    names = [s.name for s in plant.states]
    ranges = {p.name: p.high - p.low for p in stage.interface.references}
    bounds = {name: (r / TRAVEL_S, r / TRAVEL_S / (RISE * period)) for name, r in ranges.items()}
    controlled = {name: names.index(q) for name, q in positions.items() if q in names}
    if controlled:
        start = {**stage.start, **{positions[n]: home[n] for n in controlled}}
        x0 = np.array([start.get(n, 0.0) for n in names])
        for (name, i), a in zip(controlled.items(), _accelerations(stage, x0, list(controlled.values())), strict=True):
            bounds[name] = _largest_rate(stage, i, bounds[name][0]), a if 0 < a < np.inf else bounds[name][1]
    steps = {
        name: [abs(e.height) for e in stage.experiments if _steps(e, name)] or [SHARE * ranges[name]] for name in ranges
    }
    return {name: Limits(v, a, a / (RISE * period), max(steps[name])) for name, (v, a) in bounds.items()}


def _steps(experiment: object, name: str) -> TypeGuard[StepResponse]:
    return isinstance(experiment, StepResponse) and experiment.set_point == name


def _largest_rate(stage: Stage, i: int, otherwise: float) -> float:
    """Return the largest speed of state i: the range of the state that is its derivative."""
    plant = stage.plant
    x, u, p = (
        ca.SX.sym(n, k) for n, k in (("x", len(plant.states)), ("u", len(plant.inputs)), ("p", len(plant.values)))
    )
    derivative = plant.f(x, u, p)[i]
    for k in ca.jacobian(derivative, x).sparsity().get_col():
        if ca.is_equal(ca.SX(derivative), x[k], 2):
            return float(min(-plant.states[k].low, plant.states[k].high))
    return otherwise


def _accelerations(stage: Stage, x0: Array, rows: list[int]) -> list[float]:
    """Return FRACTION of what the actuators give each coordinate alone, on top of what holds the stage at x0."""
    plant, actuators = stage.plant, stage.interface.actuators
    x, p = ca.SX.sym("x", len(plant.states)), plant.values
    index = [[s.name for s in plant.inputs].index(a.of) for a in actuators]
    driven = ca.SX.sym("u", len(index))
    u = ca.SX.zeros(len(plant.inputs))
    for k, i in enumerate(index):
        u[i] = driven[k]
    rate = plant.f(x, u, p)
    a = ca.mtimes(ca.jacobian(rate[rows], x), rate)
    acceleration = ca.Function("acceleration", [x, driven], [a, ca.jacobian(a, driven)])
    low, high = (np.array([float(getattr(s, end) or 0.0) for s in actuators]) for end in ("low", "high"))
    held = (low + high) / 2  # not the safe output: a force that grows with the square of a current has no slope at 0 A
    for _ in range(20):
        a0, B = (np.asarray(m, dtype=np.float64) for m in acceleration(x0, held))
        held = np.clip(held - np.linalg.pinv(B) @ a0.ravel(), low, high)
    gains = np.linalg.pinv(np.asarray(acceleration(x0, held)[1], dtype=np.float64))
    room = np.minimum(high - held, held - low)
    with np.errstate(divide="ignore", invalid="ignore"):
        return [float(FRACTION * np.nanmin(np.where(g == 0, np.inf, room / np.abs(g)))) for g in gains.T]
