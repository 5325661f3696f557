"""Verification of the precise design: that of the stage, with random states of its observers and internal models."""

import numpy as np
from numpy.typing import NDArray

from designs.maglev import platen, verification
from designs.maglev_5dof_precise import reference
from synth.verify.sampling import Columns
from synth.verify.standard import Stimuli

NEAR = {"sum": 0.2, "p": 5e-3, "q": 0.2}  # m, rad: whose demand a motor can meet


def law_states(
    rng: np.random.Generator, axis: str, position: NDArray[np.float64], error: NDArray[np.float64]
) -> Columns:
    """Return states of observer and servo of an axis, (n,), that belong to a position and a tracking error."""
    n = len(error)
    states = {f"observer_{axis}_fast_q": position + rng.normal(0, 5e-6, n)}
    states[f"observer_{axis}_fast_v"] = rng.normal(0, 0.02, n)
    states[f"observer_{axis}_fast_d"] = rng.normal(0, 0.5, n)
    states[f"servo_{axis}_fast_r"] = np.clip(position - error + rng.normal(0, 1e-4, n), *platen.BOX[axis])
    modes = reference.SPEEDS[reference.AXES.index(axis)]
    for eta in reference.ETA[: 2 * len(modes) - 1]:
        states[f"servo_{axis}_fast_{eta}"] = rng.normal(0, NEAR[eta.rstrip("123")], n)
    return states


def stimuli() -> Stimuli:
    """Return what drives the verification."""
    return verification.stimuli(law_states, reference.with_fault_handling)
