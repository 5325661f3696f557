"""Maps over a pitch: error and noise of the raw position, and errors until a sensor failure is detected.

All are computed with the Block itself in double precision, from the voltages of the plant, over a pitch in x and y. The
prediction is that of the filters, or the previous sample. There is no noise: its effect on the residuals is far within
their bounds. A failure is noticed in the sample whose fault word names suspects. Results:
docs/decisions/planar_sensing.md.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from designs.planar_6dof.sensing import calibration
from designs.planar_6dof.sensing import sections as sensing
from models import planar_stage
from synth.block import Block
from synth.composition import compose
from synth.plant import Plant
from synth.signals import signal_names
from synth.statespace import Array, readonly
from synth.timing import Discrete
from synth.verify import agree

NOISE = 5e-5  # m rms of a position, section 3.2
VOLTAGE_STEP = 1e-4  # V, of a difference quotient
SPEED = 0.1  # m/s, of the platen after a sensor sticks
FLAGS = (sensing.READY, sensing.COMPLETE)
NOTICE_SAMPLES = 100  # samples after which no further failure at rest is noticed

Columns = Mapping[str, Array]


@dataclass(frozen=True, eq=False)
class ErrorMap:
    """Over a pitch, rows x and columns y at `place` (n,) in m: error (n, n) and noise rms (n, n) of each raw axis."""

    place: Array
    error: Columns
    noise: Columns


def voltages(plant: Plant, pose: Mapping[str, ArrayLike]) -> dict[str, Array]:
    """Return the six voltages (N,) of N poses in m and rad by axis; an axis that is left out is 0."""
    outputs = plant.output_values({axis: np.ravel(values) for axis, values in pose.items()})
    return {name: outputs[name] for name in planar_stage.HALL}


def estimation(plant: Plant, time: Discrete, filters: Sequence[Block] = ()) -> Block:
    """Return sensing and the filters that predict x, y and phi as one Block, from held voltages and the guard's flags.

    Without filters the prediction is the previous sample.
    """
    sensed = sensing.sensing(plant, time, bool(filters))
    outputs = [*signal_names(sensed.outputs), *(sensing.RAW if filters else ())]
    return compose("estimation", [sensed, *filters], inputs=signal_names((*sensing.HELD, *FLAGS)), outputs=outputs)


def error_map(plant: Plant, yaw: float = 0.0, lift: float = 0.0, doubt: float = 0.0, points: int = 48) -> ErrorMap:
    """Return the map at a yaw in rad, known to `doubt` in rad, and a lift in m."""
    x, y = _places(plant, points)
    error, noise = errors(plant, {"x": x, "y": y, "phi": np.full_like(x, yaw), "z": np.full_like(x, lift)}, doubt)
    squares = ({axis: v.reshape(points, points) for axis, v in values.items()} for values in (error, noise))
    return ErrorMap(readonly(y[:points]), *squares)


def errors(plant: Plant, pose: Columns, doubt: float = 0.0) -> tuple[Columns, Columns]:
    """Return error and noise rms (N,) of each raw axis at N poses, whose yaw is known to `doubt` in rad."""
    block = sensing.sensing(plant, Discrete(1e-3))
    step, start = agree.casadi(block), {s.name: np.array(float(s.initial)) for s in block.states}
    u = voltages(plant, pose)
    known = {f"{axis}_predicted": pose[axis] + (doubt if axis == "phi" else 0.0) for axis in sensing.RAW}
    known |= {flag.name: np.ones_like(pose["x"]) for flag in FLAGS}

    def raw(change: str = "", by: float = 0.0) -> Array:
        held = {f"{name}_held": v + (by if name == change else 0.0) for name, v in u.items()}
        outputs = step(start, held | known).outputs
        return np.array([outputs[s.name] for s in sensing.RAW.values()])

    error = raw() - np.array([pose[axis] for axis in sensing.RAW])
    slopes = [(raw(name, VOLTAGE_STEP) - raw(name, -VOLTAGE_STEP)) / (2 * VOLTAGE_STEP) for name in u]
    noise = deviation(plant) * np.sqrt(np.sum(np.square(slopes), axis=0))
    first, second = (dict(zip(sensing.RAW, map(readonly, rows), strict=True)) for rows in (error, noise))
    return first, second


def deviation(plant: Plant) -> float:
    """Return the noise rms of a voltage in V that causes NOISE in a position."""
    return calibration.of(plant).volts_per_metre * NOISE


def zero_voltages(plant: Plant, time: Discrete, points: int = 12, filters: Sequence[Block] = ()) -> dict[str, "Watch"]:
    """Return the effect of each voltage dropping to zero at rest, at points^2 places over a pitch; see `estimation`."""
    block, start = estimation(plant, time, filters), _places(plant, points)
    return {name: watch(plant, block, start, 0 * start, NOTICE_SAMPLES, name) for name in planar_stage.HALL}


def stuck_voltages(plant: Plant, time: Discrete, points: int = 12, filters: Sequence[Block] = ()) -> dict[str, "Watch"]:
    """Return the effect of each voltage sticking while the platen moves at SPEED, as `faults`.

    It moves from each place in both directions along the voltage's axis, over a pitch at most.
    """
    block, start = estimation(plant, time, filters), _places(plant, points)
    samples, watches = round(calibration.of(plant).pitch / SPEED / time.period_s), {}
    for name in planar_stage.HALL:
        along = np.array([[name[-1] == axis] for axis in "xy"])
        velocity = SPEED * along * np.repeat([1.0, -1.0], start.shape[1])
        watches[name] = watch(plant, block, np.tile(start, 2), velocity, samples, name, sticks=True)
    return watches


def _places(plant: Plant, points: int) -> Array:
    """Return x and y (2, points^2) in m over a pitch."""
    place = calibration.of(plant).pitch * ((np.arange(points) + 0.5) / points - 0.5)
    return np.array([v.ravel() for v in np.meshgrid(place, place, indexing="ij")])


@dataclass(frozen=True, eq=False)
class Watch:
    """Over N starts: sample in which a failure was noticed, or -1, named suspects, and errors (axes, N) until then.

    `distance` (N,) is the distance in m until it was noticed, inf where it was not.
    """

    noticed: NDArray[np.int64]
    named: NDArray[np.bool_]
    error: Array
    distance: Array

    def summary(self, name: str) -> dict[str, float]:
        """Return shares in % and worst errors for the failed voltage `name`; named ones are shares of the noticed."""
        noticed, named_right = self.noticed >= 0, self.named[planar_stage.HALL.index(name)]
        alone = named_right & (self.named.sum(axis=0) == 1)
        named, only = (float(flags[noticed].mean()) if noticed.any() else 0.0 for flags in (named_right, alone))
        worst = {"moved, mm": self.distance, "position, mm": self.error[:2], "yaw, mrad": self.error[2]}
        shares = {"unnoticed, %": 100 * float(np.mean(~noticed)), "named, %": 100 * named, "alone, %": 100 * only}
        return shares | {what: 1e3 * float(v.max()) for what, v in worst.items()}


def watch(
    plant: Plant, block: Block, start: Array, velocity: Array, samples: int, failed: str, sticks: bool = False
) -> Watch:
    """Simulate N platens from `start` (2, N) in m with `velocity` (2, N) in m/s and a voltage that fails at once."""
    n, step = start.shape[1], agree.casadi(block)
    state: Columns = _states_in_motion(block, start, velocity)
    instants = np.arange(samples if velocity.any() else 1)  # a platen at rest has the same voltages in all samples
    pose = start + block.time.period_s * instants[:, None, None] * velocity
    seen = voltages(plant, {"x": pose[:, 0], "y": pose[:, 1]})
    u = {name: np.broadcast_to(v.reshape(-1, n), (samples, n)) for name, v in seen.items()}
    pose = np.broadcast_to(pose, (samples, *start.shape))
    u[failed] = np.tile(u[failed][:1], (samples, 1)) if sticks else np.zeros((samples, n))
    flags = {flag.name: np.ones(n) for flag in FLAGS}
    axes = [axis if axis in signal_names(block.outputs) else f"{axis}_raw" for axis in sensing.RAW]
    noticed, named, error = np.full(n, -1), np.zeros((len(u), n), bool), np.zeros((len(axes), n))
    for k in range(samples):
        stepped = step(state, {f"{name}_held": v[k] for name, v in u.items()} | flags)
        state, y = stepped.states, stepped.outputs
        off = np.abs(np.array([y[axis] for axis in axes]) - np.array([*pose[k], np.zeros(n)]))
        error = np.where(noticed < 0, np.maximum(error, off), error)
        fresh = (y[sensing.SUSPECTED.name] > 0) & (noticed < 0)
        named = np.where(fresh, np.array([y[s.name] for s in sensing.SUSPECTS]) > 0, named)
        noticed = np.where(fresh, k, noticed)
        if (noticed >= 0).all():
            break
    distance = np.hypot(*velocity) * block.time.period_s * noticed
    return Watch(noticed, named, error, np.where(noticed < 0, np.inf, distance))


def _states_in_motion(block: Block, start: Array, velocity: Array) -> dict[str, Array]:
    """Return the states (N,) of an estimation that has tracked platens in the middle pitch up to `start`."""
    state = {s.name: np.full(start.shape[1], float(s.initial)) for s in block.states}
    for axis, at, v in zip("xy", start, velocity, strict=True):
        known = {f"sensing_within_{axis}": at, f"filter_{axis}_p": at, f"filter_{axis}_s": block.time.period_s * v}
        state |= {name: values for name, values in known.items() if name in state}
    return state
