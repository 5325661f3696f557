"""Monte Carlo ensembles: N copies of one compiled controller run side by side, each on separate inputs.

An ensemble varies initial states, bodies and motions and shows the distribution of an error, where one closed loop or
one recording shows a single case. `Scores` compare estimates with the truth. An estimator reports when its estimate is
valid, with standard deviations; an estimate is wrong if it is valid and its error exceeds WRONG of these deviations.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.execute import host

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
