"""Random machines within their tolerances: plant parameters, and zeros and sensitivities of sensors.

    value = nominal (1 + tolerance z)     of a parameter          offset = largest offset times z     of a sensor
                                                              gain error = largest gain error times z

    uniform   z uniform in -1 .. 1
    normal    z normal with standard deviation 1/3: the tolerance is three deviations
    corners   z = -1 or 1
    latin     z uniform, one row in each of n slices of every quantity (Latin hypercube)

Row k of a seed is the same however many rows are drawn with it; a Latin hypercube also depends on their number.

Monte Carlo ensembles: N copies of one compiled controller run side by side, each on separate inputs.

An ensemble varies initial states, bodies and motions and shows the distribution of an error, where one closed loop or
one recording shows a single case. `Scores` compare estimates with the truth. An estimator reports when its estimate is
valid, with standard deviations; an estimate is wrong if it is valid and its error exceeds WRONG of these deviations.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.errors import SignalError
from synth.execute import host
from synth.simulate.rig import Rig

WRONG = 10.0  # deviations: Gaussian noise alone exceeds 6 in 2e-9 of samples

Columns = Mapping[str, NDArray[Any]]


def initial_states(controller: host.Controller, n: int) -> host.Records:
    """Return the states (n,) of n copies after `init`."""
    return np.repeat(controller.init()[np.newaxis], n)


def replay(controller: host.Controller, inputs: Columns) -> Iterator[host.Batch]:
    """Run N copies of `controller` from `init` on inputs (samples, N); yield the results of each sample."""
    samples, n = next(iter(inputs.values())).shape
    states = initial_states(controller, n)
    for k in range(samples):
        batch = controller.batch(states, {name: np.ascontiguousarray(v[k]) for name, v in inputs.items()})
        states = batch.states
        yield batch


def consecutive_steps(
    controller: host.Controller, inputs: Columns
) -> tuple[dict[str, NDArray[Any]], dict[str, NDArray[Any]]]:
    """Return the members of the state and the inputs (samples N,) of the steps of N copies from `init`.

    The inputs are (samples, N).
    """
    batches = list(replay(controller, inputs))
    first = initial_states(controller, len(batches[0].states))
    before = np.concatenate([first, *(batch.states for batch in batches[:-1])])
    return {name: before[name] for name in before.dtype.names or ()}, {name: v.ravel() for name, v in inputs.items()}


@dataclass(frozen=True, eq=False)
class Scores:
    """Scores of estimates of N bodies: `valid` (.., N), and the distance `error` (.., N) from the truth.

    `deviations` (.., n, N) are the errors of n unknowns in units of the reported standard deviations.
    """

    valid: NDArray[np.bool_]
    error: NDArray[np.float64]
    deviations: NDArray[np.float64]

    @property
    def is_correct(self) -> NDArray[np.bool_]:
        """Whether each estimate agrees with the truth, whether it is valid or not."""
        return np.asarray(self.deviations.max(axis=-2) <= WRONG)

    @property
    def first_valid(self) -> NDArray[np.int_]:
        """Number of samples until the first valid estimate (N,), 0 for never."""
        return np.where(self.valid.any(axis=0), 1 + self.valid.argmax(axis=0), 0)

    @property
    def is_wrong(self) -> NDArray[np.bool_]:
        """Whether each estimate is valid although it differs from the truth."""
        return self.valid & ~self.is_correct


def stack(samples: Sequence[Scores]) -> Scores:
    """Stack the scores of K samples into one, (K, .., N)."""
    return Scores(*(np.array([getattr(each, name) for each in samples]) for name in ("valid", "error", "deviations")))


Array = NDArray[np.float64]
_NOISE = 2**31  # the seed of a row's sensor noise comes after its z


class Method(StrEnum):
    """How z is drawn."""

    UNIFORM = "uniform"
    NORMAL = "normal"
    CORNERS = "corners"
    LATIN = "latin"


@dataclass(frozen=True)
class Sampling:
    """`rows` machines drawn by `method` from `seed`; the first is nominal, with z = 0."""

    rows: int
    seed: int = 0
    method: Method = Method.UNIFORM

    def __post_init__(self) -> None:
        numbers = (self.rows, self.seed)
        if not all(isinstance(n, int | np.integer) for n in numbers) or self.rows < 1 or self.seed < 0:
            raise SignalError(
                f"sampling of {self.rows} rows with seed {self.seed}: give at least 1 row and a seed >= 0, both whole"
            )
        if self.method not in list(Method):
            raise SignalError(f"sampling by '{self.method}': give one of {', '.join(Method)}")


def quantities(rig: Rig) -> tuple[str, ...]:
    """Return the names of what is drawn: parameters with a tolerance, then `offset.NAME` and `gain.NAME` of sensors."""
    sensors = rig.stage.interface.sensors
    return (
        *(p.name for p in rig.plant.parameters if p.varies),
        *(_offset(s.name) for s in sensors if s.offset > 0),
        *(_gain(s.name) for s in sensors if s.gain_error > 0),
    )


def draw(sampling: Sampling, number: int, rows: Sequence[int]) -> Array:
    """Return z of the rows (rows, number)."""
    drawn = np.array([_row(sampling, number, row) for row in rows]).reshape(len(rows), number)
    if sampling.method == Method.LATIN:
        drawn = (
            np.array([_slices(sampling, number)[:, row] for row in rows]).reshape(drawn.shape) + drawn / sampling.rows
        )
    return np.where(np.array(rows)[:, np.newaxis] == 0, 0.0, drawn)


def _row(sampling: Sampling, number: int, row: int) -> Array:
    generator = np.random.default_rng([sampling.seed, row])
    if sampling.method == Method.NORMAL:
        return generator.standard_normal(number) / 3
    z = generator.uniform(-1.0, 1.0, number)
    return np.copysign(1.0, z) if sampling.method == Method.CORNERS else z


def _slices(sampling: Sampling, number: int) -> Array:
    """Return the middles of the slices in -1 .. 1 (number, rows), in an order of its own for each quantity."""
    middles = (2 * np.arange(sampling.rows) + 1) / sampling.rows - 1
    generators = (np.random.default_rng([sampling.seed, _NOISE + k]) for k in range(number))
    return np.array([generator.permutation(middles) for generator in generators])


def machine(rig: Rig, z: Mapping[str, float], seed: int, row: int) -> Rig:
    """Return the rig of a machine with z by quantity; its sensor noise follows from the seed and the row."""
    plant = rig.plant.with_parameters(**{p.name: p.at(z[p.name]) for p in rig.plant.parameters if p.name in z})
    noise = int(np.random.default_rng([seed, row, 1]).integers(_NOISE))
    return with_sensor_errors(replace(rig, plant=plant, seed=noise), z)


def with_sensor_errors(rig: Rig, z: Mapping[str, float]) -> Rig:
    """Return the rig whose sensors have the errors with z by quantity."""
    sensors = rig.stage.interface.sensors
    return replace(
        rig,
        offsets={s.name: s.offset * z[_offset(s.name)] for s in sensors if _offset(s.name) in z},
        gain_errors={s.name: s.gain_error * z[_gain(s.name)] for s in sensors if _gain(s.name) in z},
    )


def _offset(sensor: str) -> str:
    return f"offset.{sensor}"


def _gain(sensor: str) -> str:
    return f"gain.{sensor}"
