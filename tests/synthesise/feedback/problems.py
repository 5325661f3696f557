"""Models from bare matrices and random problems of the regulator."""

import numpy as np

from synth.statespace import StateSpace
from synth.timing import Continuous


def model(A: object, B: object) -> StateSpace:
    A, B = np.atleast_2d(np.asarray(A, float)), np.atleast_2d(np.asarray(B, float))
    states, inputs = tuple(f"x{i}" for i in range(len(A))), tuple(f"u{i}" for i in range(B.shape[1]))
    return StateSpace(A, B, np.eye(len(A)), np.zeros(B.shape), states, inputs, states, Continuous())


def random_problem(seed: int) -> tuple[StateSpace, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    n, m = rng.integers(2, 4), rng.integers(1, 3)
    C = rng.normal(size=(n, n))
    return (
        model(rng.normal(size=(n, n)), rng.normal(size=(n, m))),
        C @ C.T + 0.1 * np.eye(n),
        np.diag(rng.uniform(1, 3, m)),
    )
