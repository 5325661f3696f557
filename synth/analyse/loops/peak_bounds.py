"""Peak bounds of the states of a stable sampled model for bounded inputs: the l1 norm (peak-to-peak gain).

    x+ = A x + B u,   |u_j| <= u_max_j,   x(0) = 0:      |x_i| <= sum_k sum_j |(A^k B)_ij| u_max_j

attained by the worst input (Dahleh, Diaz-Bobillo 1995, 2.3). With s the sum of the first N terms and |A^N| s <= q s,
q < 1, entry by entry, the remaining terms add at most q / (1 - q) s.
"""

import numpy as np
from numpy.typing import ArrayLike

from synth import arguments
from synth.errors import ModelError, SignalError
from synth.statespace import Array, System, of, readonly
from synth.timing import period

REMAINDER = 1e-3  # q, at which the sum ends
BLOCK = 64  # samples summed at once
MIN_DECAY = 1e-6  # of 1 - |z|: a slower mode counts as not decaying


@arguments.checked
def state_bounds(system: System, inputs: ArrayLike) -> Array:
    """Return bounds (n,) of a stable sampled model's states from 0, for inputs within +-`inputs` (m,).

    Raises TimingError for a continuous model; SignalError for bounds that are not finite or are negative; ModelError
    for a model that is not stable or settles too slowly.
    """
    model = of(system)
    period(model.time)
    largest = arguments.real("bounds of the inputs", inputs)
    if largest.shape != (len(model.inputs),) or not (np.isfinite(largest).all() and (largest >= 0).all()):
        raise SignalError(
            f"the bounds of the inputs have shape {largest.shape}, or are not finite or below 0: give "
            f"{len(model.inputs)}, one for each of {', '.join(model.inputs) or 'no inputs'}"
        )
    if not len(model.states):
        return readonly([])
    slowest = float(np.abs(model.poles).max(initial=0.0))
    if slowest > 1 - MIN_DECAY:
        raise ModelError(
            f"the states {', '.join(model.states)} have no bound: a mode of them has |z| = {slowest:.9g}, at most "
            f"{1 - MIN_DECAY:.9g} is needed; stabilise the model, or give its slow modes a faster decay"
        )
    columns = [model.B * largest]
    for _ in range(BLOCK - 1):
        columns.append(model.A @ columns[-1])
    terms, step, power = np.hstack(columns), np.linalg.matrix_power(model.A, BLOCK), np.eye(len(model.A))
    total = np.zeros(len(model.A))
    while np.isfinite(terms).all():
        total += np.abs(terms).sum(axis=1)
        terms, power = step @ terms, step @ power
        if (np.abs(power) @ total <= REMAINDER * total).all():
            return readonly(total / (1 - REMAINDER))
    raise ModelError(
        f"the states {', '.join(model.states)} grow beyond what a double holds before they settle: choose units in "
        "which they are closer to 1"
    )
