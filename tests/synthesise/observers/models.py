"""Models of a mass and of one state, the filter of the mass, observers by their gain or poles, and runs of models."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from synth.statespace import StateSpace, System, of
from synth.synthesise.feedback import pole_placement
from synth.synthesise.observers import kalman, lqg, reduced_observer
from synth.synthesise.observers.reduced_observer import ReducedObserver
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


def full_order_observer(plant: StateSpace, L: ArrayLike) -> StateSpace:
    """Return x^' = A x^ + B u + L (y - C x^ - D u), or x^+, from u and y to ``<state>_estimate``."""
    gain, n = np.asarray(L), len(plant.A)
    states, inputs = tuple(f"{x}_estimate" for x in plant.states), (*plant.inputs, *plant.outputs)
    B = np.hstack([plant.B - gain @ plant.D, gain])
    matrices = plant.A - gain @ plant.C, B, np.eye(n), np.zeros((n, len(inputs)))
    return StateSpace(*matrices, states, inputs, states, plant.time)


def by_poles(system: System, measured: Sequence[str] | str, poles: Sequence[complex]) -> ReducedObserver:
    """Return the reduced-order observer whose error has these poles, by state feedback of the dual pair."""
    part = reduced_observer.of_model(system, measured)
    dual = part.A22.T, part.A12.T, np.eye(len(part.A22)), np.zeros(part.A12.T.shape), part.model.time
    return reduced_observer.from_gain(system, measured, -pole_placement.place(dual, poles).K.T)
