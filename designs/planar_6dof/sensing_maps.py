"""By place in the matrix: errors and noise of the raw position, and what a failed sensor does before it is noticed.

Everything is computed with the Block itself, in double precision, from the voltages of the plant, over a pitch in x and
in y, with the filters that predict or with the sample before as the prediction. Nothing here is noisy: what noise does
to the residuals is far inside their bounds. A failure is noticed in the sample in which the fault word names suspects.
The results are discussed in docs/decisions/planar_sensing.md.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from designs.planar_6dof import filtering, sensing
from models import hall_calibration, planar_stage
from synth.block import Block
from synth.compose import compose
from synth.plant import Plant
from synth.statespace import Array, readonly
from synth.timing import Discrete

NOISE = filtering.DEVIATION  # m rms of a position
NUDGE = 1e-4  # V, of a difference quotient
SPEED = 0.1  # m/s, at which the platen moves away from where a sensor sticks
SETTLED = 100  # samples after which nothing more is noticed of a sensor at rest

Columns = Mapping[str, Array]


@dataclass(frozen=True, eq=False)
class ErrorMap:
    """Over a pitch, rows x and columns y at `place` (n,) in m: error (n, n) and noise rms (n, n) of each raw axis."""

    place: Array
    error: Columns
    noise: Columns


@dataclass(frozen=True)
class Unseen:
    """What a failed voltage does before it is noticed: shares of the places, and the largest errors in m and rad.

    `named` is the share of the noticed failures in which the voltage is among those named, `alone` in which it is the
    only one. `moved` is the largest movement in m before the failure is noticed; inf where it is not within a pitch.
    """

    voltage: str
    failure: str
    unnoticed: float
    named: float
    alone: float
    moved: float
    position: float
    yaw: float


def voltages(plant: Plant, pose: Mapping[str, ArrayLike]) -> dict[str, Array]:
    """Return the six voltages (N,) of N poses in m and rad by axis; an axis that is left out is 0."""
    columns = np.broadcast_arrays(*(np.asarray(pose.get(s.name, 0.0), float).ravel() for s in plant.states))
    x = np.array(columns)
    u, p = np.zeros((len(plant.inputs), x.shape[1])), np.tile(plant.values[:, None], x.shape[1])
    y = plant.h.map(x.shape[1])(x, u, p).full()
    names = [s.name for s in plant.outputs]
    return {name: y[names.index(name)] for name in planar_stage.HALL}


def estimation(plant: Plant, time: Discrete, predicted: bool = True) -> Block:
    """Return sensing as one Block with the filters that predict, or without, from held voltages and the guard's flags.

    Without filters the prediction is the sample before.
    """
    sensed = sensing.sensing(plant, time, predicted)
    parts = [sensed, *(filtering.blocks(time) if predicted else [])]
    inputs = [s.name for s in (*sensing.HELD, sensing.READY, sensing.COMPLETE)]
    outputs = [s.name for s in sensed.outputs] + [*(filtering.AXES if predicted else ())]
    return compose("estimation", parts, inputs=inputs, outputs=outputs)


def error_map(plant: Plant, yaw: float = 0.0, lift: float = 0.0, doubt: float = 0.0, points: int = 48) -> ErrorMap:
    """Return the map at a yaw in rad, known to `doubt` in rad, and a lift in m."""
    block = sensing.sensing(plant, Discrete(1e-3))
    l = hall_calibration.of(plant).pitch
    place = l * ((np.arange(points) + 0.5) / points - 0.5)
    x, y = (v.ravel() for v in np.meshgrid(place, place, indexing="ij"))
    u = voltages(plant, {"x": x, "y": y, "phi": yaw, "z": lift})
    known = {
        "x_predicted": x,
        "y_predicted": y,
        "phi_predicted": np.full_like(x, yaw + doubt),
        **{flag.name: np.ones_like(x) for flag in (sensing.READY, sensing.COMPLETE)},
    }
    step = block.function().map(len(x))
    state = np.tile(block.initial[:, None], len(x))
    raw = [s.name for s in sensing.RAW.values()]

    def evaluated(change: str = "", by: float = 0.0) -> Array:
        given = {f"{name}_held": v + (by if name == change else 0.0) for name, v in u.items()} | known
        outputs = step(state, np.array([given[s.name] for s in block.inputs]))[1].full()
        return outputs[: len(raw)]

    error = evaluated() - np.array([x, y, np.full_like(x, yaw)])
    slopes = [(evaluated(name, NUDGE) - evaluated(name, -NUDGE)) / (2 * NUDGE) for name in u]
    noise = deviation(plant) * np.sqrt(np.sum(np.square(slopes), axis=0))
    squares = [
        {axis: readonly(v.reshape(points, points)) for axis, v in zip(sensing.RAW, rows, strict=True)}
        for rows in (error, noise)
    ]
    return ErrorMap(readonly(place), *squares)


def deviation(plant: Plant) -> float:
    """Return the noise rms of a voltage in V that makes NOISE in a position."""
    cal = hall_calibration.of(plant)
    return float(cal.amplitude * 2 * np.pi / cal.pitch * NOISE)


def faults(plant: Plant, time: Discrete, points: int = 12, predicted: bool = True) -> list[Unseen]:
    """Return what each voltage does that drops to zero at rest, or sticks while it moves at SPEED; see `estimation`."""
    block = estimation(plant, time, predicted)
    dropped = [_summary(name, "zero", _dropped(plant, block, name, points), 0.0) for name in planar_stage.HALL]
    return [*dropped, *(_stuck(plant, block, name, points) for name in planar_stage.HALL)]


def unnoticed(plant: Plant, time: Discrete, points: int, predicted: bool = True) -> dict[str, NDArray[np.bool_]]:
    """Tell by voltage at which places (points, points) over a pitch its drop to zero at rest is never noticed."""
    block, shape = estimation(plant, time, predicted), (points, points)
    return {n: (_dropped(plant, block, n, points).noticed < 0).reshape(shape) for n in planar_stage.HALL}


@dataclass(frozen=True, eq=False)
class _Watch:
    """Over N starts: when a failure was noticed, -1 if never, who was named, and the errors (axes, N) until then."""

    noticed: NDArray[np.int64]
    named: NDArray[np.bool_]
    error: Array


def _watched(
    plant: Plant, block: Block, start: Array, velocity: Array, samples: int, failed: str, stuck: bool
) -> _Watch:
    """Follow N platens from `start` (2, N) in m with `velocity` (2, N) in m/s and a voltage that fails at once."""
    T, n, outputs = block.time.period_s, start.shape[1], [s.name for s in block.outputs]
    step, state = block.function().map(n), _moving(block, start, velocity)
    axes = [axis if axis in outputs else f"{axis}_raw" for axis in filtering.AXES]
    estimated, suspects = ([outputs.index(name) for name in wanted] for wanted in (axes, _SUSPECTS))
    pose = start + T * np.arange(samples)[:, None, None] * velocity
    u = voltages(plant, {axis: pose[:, i] for i, axis in enumerate("xy")})
    u = {name: v.reshape(samples, n) for name, v in u.items()}
    u[failed] = np.tile(u[failed][:1], (samples, 1)) if stuck else np.zeros((samples, n))
    noticed, named, worst = np.full(n, -1), np.zeros((len(_SUSPECTS), n), bool), np.zeros((3, n))
    for k in range(samples):
        after, found = (v.full() for v in step(state, np.array([*(v[k] for v in u.values()), *np.ones((2, n))])))
        error = np.abs(found[estimated] - np.array([*pose[k], np.zeros(n)]))
        worst = np.where(noticed < 0, np.maximum(worst, error), worst)
        fresh = (found[outputs.index(sensing.SUSPECTED.name)] > 0) & (noticed < 0)
        noticed, named, state = np.where(fresh, k, noticed), np.where(fresh, found[suspects] > 0, named), after
        if (noticed >= 0).all():
            break
    return _Watch(noticed, named, worst)


_SUSPECTS = tuple(s.name for s in sensing.SUSPECTS)


def _moving(block: Block, start: Array, velocity: Array) -> Array:
    """Return the states (.., N) of an estimation that has followed platens in the middle pitch up to `start`."""
    state = np.tile(block.initial[:, None], start.shape[1]).astype(float)
    for k, name in enumerate(s.name for s in block.states):
        for axis, at, v in zip("xy", start, velocity, strict=True):
            known = {f"sensing_within_{axis}": at, f"filter_{axis}_p": at, f"filter_{axis}_s": block.time.period_s * v}
            state[k] = known.get(name, state[k])
    return state


def _summary(name: str, failure: str, seen: _Watch, speed: float) -> Unseen:
    noticed = seen.noticed >= 0
    own = seen.named[planar_stage.HALL.index(name)]
    alone = own & (seen.named.sum(axis=0) == 1)
    return Unseen(
        name,
        failure,
        float(np.mean(~noticed)),
        float(own[noticed].mean()) if noticed.any() else 0.0,
        float(alone[noticed].mean()) if noticed.any() else 0.0,
        float(np.where(noticed, speed * seen.noticed, np.inf).max()),
        float(seen.error[:2].max()),
        float(seen.error[2].max()),
    )


def _places(plant: Plant, points: int) -> Array:
    place = hall_calibration.of(plant).pitch * ((np.arange(points) + 0.5) / points - 0.5)
    return np.array([v.ravel() for v in np.meshgrid(place, place, indexing="ij")])


def _dropped(plant: Plant, block: Block, name: str, points: int) -> _Watch:
    start = _places(plant, points)
    return _watched(plant, block, start, np.zeros_like(start), SETTLED, name, stuck=False)


def _stuck(plant: Plant, block: Block, name: str, points: int) -> Unseen:
    """Return what happens on the way from each place, to and fro along the voltage's own axis, over a pitch at most."""
    place, T = _places(plant, points), block.time.period_s
    along = np.array([[name[-1] == axis] for axis in "xy"])
    velocity = SPEED * along * np.repeat([1.0, -1.0], place.shape[1])
    samples = round(hall_calibration.of(plant).pitch / SPEED / T)
    seen = _watched(plant, block, np.tile(place, 2), velocity, samples, name, stuck=True)
    return _summary(name, "stuck", seen, SPEED * T)
