"""The maglev controller's NumPy reference in its loop: steps, tracking, levitation before thrust.

plant x' = f(x, u), F(6)-(7), by Runge-Kutta at 1 ms; ideal encoders; the currents of sample k act from k + 1
"""

from dataclasses import dataclass
from math import pi

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import linalg, signal

from designs.maglev import reference_stage
from designs.maglev_5dof import reference, reference_gains
from tests.designs.maglev_5dof import full_plant

Array = NDArray[np.float64]
P = reference_stage.Parameters()
T = 1e-3


@dataclass(frozen=True)
class Run:
    """A closed loop at 1 kHz: x (N, 10, n), set-points (N, n) by axis."""

    x: Array
    references: dict[str, Array]

    def error(self, axis: str, column: int) -> Array:
        row = 2 * reference_stage.AXES.index(axis)
        return self.x[:, row, column] - self.references[axis][:, column]


def closed_loop(x: Array, references: dict[str, Array], k: reference.Constants) -> Run:
    """Run from rest under ideal sensing; a sample's currents act one sample later, the first at once."""
    state = {name: np.full(x.shape[1], value) for name, value in full_plant.initial_state().items()}
    applied, path = None, []
    for n in range(len(references["y"])):
        tilt, roll = P.r * np.sin(x[6]), P.r * np.sin(x[8])
        at = {"y1": x[0] - tilt, "y2": x[0] + roll, "y3": x[0] + tilt, "y4": x[0] - roll, "x": x[2], "z": x[4]}
        state, out, _ = reference.step(state, at | {f"{s}_ref": r[n] for s, r in references.items()}, k)
        commanded = np.stack([out[f"i_{axis}{j}"] for axis in "dq" for j in range(1, 5)])
        path.append(x)
        x = runge_kutta(x, commanded if applied is None else applied)
        applied = commanded
    return Run(np.array(path), references)


def runge_kutta(x: Array, u: Array) -> Array:
    a = full_plant.plant(x, u, P)
    b = full_plant.plant(x + T / 2 * a, u, P)
    c = full_plant.plant(x + T / 2 * b, u, P)
    return x + T / 6 * (a + 2 * b + 2 * c + full_plant.plant(x + T * c, u, P))


STEP, THRUST, TRACK, KICK, SMALL = range(5)


def scenario(duration: float) -> tuple[Array, dict[str, Array]]:
    """Return starts and set-points: y by 7 mm; x by 30 mm; 4-DOF references, F IV-B; y after 10 ms; x by 10 mm."""
    t = np.arange(0, duration, T)
    wave = reference_gains.OMEGA0 * t
    r = {s: np.zeros((len(t), 5)) for s in reference_stage.AXES}
    r["y"][:] = 0.029, 0.025, 0.025, 0.029, 0.025
    r["y"][:10, KICK] = 0.022
    r["x"][:, THRUST], r["x"][:, SMALL] = 0.03, 0.01
    r["y"][:, TRACK] -= 0.005 * np.cos(wave)
    r["x"][:, TRACK], r["z"][:, TRACK] = -0.03 * np.cos(wave), 0.03 * np.sin(wave)
    r["theta"][:, TRACK] = 0.01 * np.sin(wave)
    x = np.zeros((10, 5))
    x[0] = 0.022, 0.025, 0.020, 0.022, 0.025
    x[2, TRACK] = -0.03
    return x, r


@pytest.fixture(scope="module")
def corrected() -> Run:
    return closed_loop(*scenario(3.0), reference.constants())


def linear_step(axis: str, height: float, n: int, delayed: bool = True) -> Array:
    """Return the error of q'' = w after a step, sampled with one sample of delay, from K, SciPy's filter and model."""
    K, w = reference_gains.gain(reference.WEIGHTS[axis]), reference_gains.FILTER
    M = np.zeros((4, 4))
    M[:4, :4] = [[0, 1, 0, 0], [0, 0, 1, 0], [0, -(reference_gains.OMEGA0**2), 0, 1], [0] * 4]
    A = linalg.expm(M * T)
    b, a, _ = signal.cont2discrete(([w**2, 0.0], [1.0, 2.0 * w, w**2]), T, method="foh")
    b, past, rates = b.ravel(), np.zeros(2), np.zeros(2)
    e, v, xi, applied, path = -height, 0.0, np.zeros(3), None, []
    for _ in range(n):
        path.append(e)
        q = e + height  # the filter starts at rest on the first error, so that only the change counts
        rate = b[0] * q + b[1:] @ past - a[1:] @ rates
        past, rates = np.array([q, past[0]]), np.array([rate, rates[0]])
        demand = K[0] * e + K[1] * rate + K[2:] @ xi
        xi = A[:3, :3] @ xi + A[:3, 3] * e
        acting = demand if applied is None or not delayed else applied
        e, v, applied = e + T * v + T**2 / 2 * acting, v + T * acting, demand
    return np.array(path)


def test_steps_are_those_of_the_double_integrator(corrected: Run) -> None:
    """Restored and within its limits, the law leaves F(13) with the hold and the delay; without the delay it shows."""
    for axis, height, column in (("y", 0.007, STEP), ("x", 0.01, SMALL)):
        expected = linear_step(axis, height, 3000)
        error = corrected.error(axis, column)
        assert np.max(np.abs(error - expected)) < 6e-3 * height
        prompt = linear_step(axis, height, 3000, delayed=False)
        assert np.max(np.abs(prompt - expected)) > 7e-3 * height


def test_table_iii(corrected: Run) -> None:
    """F table III: overshoot under 30 %, |error| below 0.1 mm within 3 s; 7 mm overshoot by 14.3 % or less."""
    assert 13.0 < 100 * np.max(corrected.error("y", STEP)) / 0.007 < 14.3
    for axis, height, column in (("y", 0.007, STEP), ("x", 0.03, THRUST), ("y", 0.007, KICK)):
        error = corrected.error(axis, column)
        assert np.max(error) < 0.3 * height
        assert np.max(np.abs(error[2500:])) < 1e-4


def test_levitation_comes_first(corrected: Run) -> None:
    """The gap holds while x steps by 30 mm."""
    assert np.max(np.abs(corrected.error("y", THRUST))) < 20e-6


def test_tracking(corrected: Run) -> None:
    """Mean |error| of y over the last period of 3 s, 4-DOF references: as printed about 45 um, corrected under 2."""
    x, r = scenario(3.0)
    one = {s: v[:, TRACK : TRACK + 1] for s, v in r.items()}
    printed = closed_loop(x[:, TRACK : TRACK + 1], one, reference.constants(corrected=False))
    period = slice(-round(2 * pi / reference_gains.OMEGA0 / T), None)
    assert 40e-6 < np.mean(np.abs(printed.error("y", 0)[period])) < 50e-6
    assert np.mean(np.abs(corrected.error("y", TRACK)[period])) < 2e-6
