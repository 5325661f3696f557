"""Verification of the paper's design: that of the stage, with random states of its filters and regulators."""

import numpy as np
from numpy.typing import NDArray

from designs.maglev import verification
from designs.maglev_5dof import control, reference
from synth.verify.sampling import Columns
from synth.verify.standard import Stimuli

NEAR = 0.003  # of a bound: states of the internal model whose demand a motor can meet


def law_states(
    rng: np.random.Generator, axis: str, position: NDArray[np.float64], error: NDArray[np.float64]
) -> Columns:
    """Return states of the filter and the regulator of an axis, (n,), that belong to a tracking error."""
    n = len(error)
    states = {
        f"filter_{axis}_q_prev": error + rng.normal(0, 1e-6, n),
        f"filter_{axis}_s": rng.normal(0, 5e-6, n),
        f"filter_{axis}_r": rng.normal(0, 1e-5, n),
    }
    for eta, bound in zip(reference.ETA, control.ETA_BOUNDS, strict=True):
        states[f"regulator_{axis}_{eta}"] = rng.normal(0, NEAR * bound, n)
    return states


def stimuli() -> Stimuli:
    """Return what drives the verification."""
    return verification.stimuli(law_states, reference.with_fault_handling)
