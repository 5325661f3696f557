"""Scalar loops from their coefficients, and their closed-loop poles at the stability boundary."""

import control
import numpy as np
import scipy.signal

from synth.statespace import StateSpace, from_control
from synth.timing import Continuous, Discrete
from tests import tolerances

EXACT = tolerances.of("frequency")


def loop(numerator: object, denominator: object, period: float = 0) -> StateSpace:
    A, B, C, D = scipy.signal.tf2ss(np.asarray(numerator, float), np.asarray(denominator, float))
    return from_control(control.ss(A, B, C, D, period))


def gain(L: StateSpace, k: float) -> StateSpace:
    return StateSpace(L.A, L.B, k * L.C, k * L.D, L.states, L.inputs, L.outputs, L.time)


def decays(L: StateSpace) -> bool:
    """Tell whether the loop is stable, from the roots of denominator + numerator, in either time."""
    b, a = scipy.signal.ss2tf(L.A, L.B, L.C, L.D)
    roots = np.roots(np.polyadd(a, b[0]))
    return bool((roots.real < 0).all() if isinstance(L.time, Continuous) else (np.abs(roots) < 1).all())


def closed_loop_poles(L: StateSpace, factor: complex) -> np.ndarray:
    """The poles of the loop closed on `factor` L."""
    return np.linalg.eigvals(L.A - factor * L.B @ L.C / (1 + factor * L.D[0, 0]))


def off_boundary(L: StateSpace, factor: complex, frequency: float) -> float:
    """How far, relative to the frequency, a closed-loop pole is from the point of the boundary at `frequency`."""
    poles = closed_loop_poles(L, factor)
    if isinstance(L.time, Discrete):
        poles = np.log(poles[poles != 0]) / L.time.period_s
    return float(np.abs(poles - 1j * frequency).min() / frequency)
