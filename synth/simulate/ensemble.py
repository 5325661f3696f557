"""Ensembles: N copies of one compiled controller side by side, each on inputs of its own, sample by sample.

Monte Carlo over starts, bodies and motions: what one closed loop or one recording shows of a single case, an ensemble
shows of its whole distribution. Of estimators, which say when they are valid and by what deviations they may be off,
`Scores` keep how right they are: wrong is what is valid and off by more than WRONG of its own deviations.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.execute import host

WRONG = 10.0  # deviations: Gaussian noise alone exceeds 6 in 2e-9 of samples

Columns = Mapping[str, NDArray[Any]]


def started(controller: host.Controller, n: int) -> host.Records:
    """Return the states (n,) of as many copies after `init`."""
    return np.repeat(controller.init()[np.newaxis], n)


def replayed(controller: host.Controller, inputs: Columns) -> Iterator[host.Batch]:
    """Yield what `controller` makes of inputs (samples, N) from `init`, sample by sample."""
    samples, n = next(iter(inputs.values())).shape
    states = started(controller, n)
    for k in range(samples):
        batch = controller.batch(states, {name: np.ascontiguousarray(v[k]) for name, v in inputs.items()})
        states = batch.states
        yield batch


@dataclass(frozen=True, eq=False)
class Scores:
    """Estimates of N bodies beside the truth: whether they are valid (.., N), and by how much they are off (.., N).

    `deviations` (.., n, N) are the errors of n unknowns over the deviations that the estimates state.
    """

    valid: NDArray[np.bool_]
    off: NDArray[np.float64]
    deviations: NDArray[np.float64]

    @property
    def right(self) -> NDArray[np.bool_]:
        """Whether estimates are the truth, valid or not."""
        return np.asarray(self.deviations.max(axis=-2) <= WRONG)

    @property
    def first_valid(self) -> NDArray[np.int_]:
        """How many of K samples it takes until an estimate is valid (N,), 0 for never."""
        return np.where(self.valid.any(axis=0), 1 + self.valid.argmax(axis=0), 0)

    @property
    def wrong(self) -> NDArray[np.bool_]:
        """Whether estimates are valid elsewhere."""
        return self.valid & ~self.right


def stacked(samples: Sequence[Scores]) -> Scores:
    """Return the scores of K samples as one, (K, .., N)."""
    return Scores(*(np.array([getattr(each, name) for each in samples]) for name in ("valid", "off", "deviations")))
