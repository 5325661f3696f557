"""Models of a mass and of one state, the filter of the mass, and the run of a sampled model over recorded inputs."""

import numpy as np

from synth.statespace import StateSpace, of
from synth.synthesise.observers import kalman, lqg
from synth.timing import Continuous, Time

UNITS = {"x": "m", "v": "m/s", "f": "N", "y": "m"}
FORMS = (lqg.predictor, lqg.current)
T = 1e-3


def mass() -> StateSpace:
    """1.52 kg on a guide, its position measured."""
    return StateSpace(
        [[0, 1], [0, 0]], [[0], [1 / 1.52]], [[1, 0]], [[0]], ("x", "v"), ("f",), ("y",), Continuous(), UNITS
    )


def held_mass() -> kalman.Estimator:
    return kalman.kalmd(mass(), [1e-3], [25e-10], T, G=mass().B)


def scalar(a: float, time: Time, c: float = 1.0) -> StateSpace:
    return of((a, 1.0, c, 0.0, time))


def run(form: StateSpace, inputs: np.ndarray) -> np.ndarray:
    x, outputs = np.zeros(len(form.states)), []
    for u in inputs:
        outputs.append(form.C @ x + form.D @ u)
        x = form.A @ x + form.B @ u
    return np.array(outputs)
