"""Ensembles: N copies of one compiled controller side by side, each on inputs of its own, sample by sample.

Monte Carlo over starts, bodies and motions: what one closed loop or one recording shows of a single case, an ensemble
shows of its whole distribution.
"""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.execute import host

Columns = Mapping[str, NDArray[Any]]
Step = Callable[[host.Records, int], host.Batch]
"""States (N,) and the number of the sample to what one step makes of them."""


def started(controller: host.Controller, n: int) -> host.Records:
    """Return the states (n,) of as many copies after `init`."""
    return np.repeat(controller.init()[np.newaxis], n)


def followed(step: Step, states: host.Records, samples: int) -> Iterator[host.Batch]:
    """Yield what each of so many samples makes of states (N,)."""
    for k in range(samples):
        batch = step(states, k)
        states = batch.states
        yield batch


def replayed(controller: host.Controller, inputs: Columns) -> Iterator[host.Batch]:
    """Yield what `controller` makes of inputs (samples, N) from `init`, sample by sample."""
    samples, n = next(iter(inputs.values())).shape

    def step(states: host.Records, k: int) -> host.Batch:
        return controller.batch(states, {name: np.ascontiguousarray(v[k]) for name, v in inputs.items()})

    yield from followed(step, started(controller, n), samples)
