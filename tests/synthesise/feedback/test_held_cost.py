"""The cost of a late input against the integral along a simulated loop, and against the sum for whole samples."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg

from synth.analyse import discretise
from synth.analyse.loops import loop
from synth.statespace import StateSpace, of
from synth.synthesise.feedback import lqr
from synth.timing import Continuous
from tests import tolerances

T = 0.1
DELAYS = (0.0, 0.03, 0.1, 0.17, 0.3)  # s: none, a fraction, one sample, both, three samples


def problem(seed: int) -> tuple[StateSpace, np.ndarray, np.ndarray, np.ndarray]:
    """Return a random plant, of which a mode may grow, with its weights Q, R, N."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(5, 5))
    W = root @ root.T + 0.2 * np.eye(5)
    plant = of((rng.normal(size=(3, 3)), rng.normal(size=(3, 2)), np.eye(2, 3)))
    return plant, W[:3, :3], W[3:, 3:], W[:3, 3:]


def integral(
    gain: lqr.Gain, plant: StateSpace, weights: tuple[np.ndarray, ...], delay: float, z: np.ndarray, first: float = 0.0
) -> float:
    """Return int (x'Qx + u'Ru + 2 x'Nu) dt from the time `first` on; u(t) is the command of the time t - delay.

    The loop runs in continuous time between the instants at which the acting input changes, with Gauss quadrature.
    """
    n, m = plant.B.shape
    Q, R, N = weights
    W = np.block([[Q, N], [N.T, R]])
    F = np.zeros((n + m, n + m))
    F[:n, :n], F[:n, n:] = plant.A, plant.B
    nodes, parts = np.polynomial.legendre.leggauss(10)

    def flow(t: float) -> np.ndarray:
        return np.asarray(scipy.linalg.expm(F * t))

    def over(t: float) -> np.ndarray:
        flows = [flow(t / 2 * (v + 1)) for v in nodes]
        return np.asarray(t / 2 * sum(w * M.T @ W @ M for w, M in zip(parts, flows, strict=True)))

    d = int(delay / T + 1e-9)
    f = delay / T - d if delay / T - d > 1e-9 else 0.0
    pieces = [(t, flow(t)[:n], over(t)) for t in (f * T, (1 - f) * T)]
    held = z[n : n + m] if f else np.zeros(m)
    late = list(z[n + (m if f else 0) :].reshape(d, m))  # the oldest first
    x, total = z[:n], 0.0
    for k in range(4000):
        u = gain.K @ np.concatenate([x, held if f else [], *late])
        now = [*late, u][0]
        for acting, (_, M, V) in zip((held, now), pieces, strict=True):
            y = np.concatenate([x, acting])
            total += y @ V @ y if k * T >= first - 1e-9 else 0.0
            x = M @ y
        held, late = now, [*late, u][1:]
        if max(np.abs(v).max() for v in (x, held, *late)) < 1e-10:
            return float(total)
    raise AssertionError("the loop does not settle")


@pytest.mark.parametrize("delay", DELAYS)
@pytest.mark.parametrize("seed", [1, 2, 5])
def test_the_cost_is_the_integral_along_the_loop_and_no_other_gain_has_a_lower_one(seed: int, delay: float) -> None:
    plant, *weights = problem(seed)
    Q, R, N = weights
    gain = lqr.lqrd(plant, Q, R, T, N, delay_s=delay)
    rng = np.random.default_rng(seed)
    z = rng.normal(size=gain.K.shape[1])
    first = int(delay / T + 1e-9) * T
    least = integral(gain, plant, (Q, R, N), delay, z, first)
    assert z @ gain.certificate.X @ z == pytest.approx(least, rel=tolerances.of("quadrature"))
    whole = integral(gain, plant, (Q, R, N), delay, z)
    for _ in range(3):
        other = replace(gain, K=gain.K * (1 + 0.01 * rng.normal(size=gain.K.shape)))
        assert integral(other, plant, (Q, R, N), delay, z) > whole * (1 + 1e-9)


def test_without_a_delay_nothing_changes() -> None:
    plant, Q, R, N = problem(3)
    plain, none = lqr.lqrd(plant, Q, R, T, N), lqr.lqrd(plant, Q, R, T, N, delay_s=0)
    np.testing.assert_array_equal(none.K, plain.K)
    assert none.states == plain.states == plant.states
    negligible = lqr.lqrd(plant, Q, R, T, N, delay_s=1e-6 * T)
    np.testing.assert_allclose(negligible.K[:, :3], lqr.lqrd(plant, Q, R, T, N).K, rtol=1e-5)


@pytest.mark.parametrize("samples", [1, 2, 4])
def test_for_whole_samples_it_is_the_sum_of_the_delayed_model(samples: int) -> None:
    """Against `dlqr` of `delay_samples`, x predicted by hand; against the sum with the cost on the late input alone.

    The latter weighs u[k] by nothing, so that its gain is found from the end of a long horizon backwards.
    """
    plant, Q, R, N = problem(4)
    gain = lqr.lqrd(plant, Q, R, T, N, delay_s=samples * T)
    cost = lqr.sampled_cost(plant, Q, R, T, N)
    late = discretise.delay_samples(cost.model, samples)
    assert gain.states == late.states == loop.sampled(plant, T, samples * T).states
    A, B = cost.model.A, cost.model.B
    powers = [np.linalg.matrix_power(A, k) for k in range(samples, -1, -1)]
    P = np.hstack([powers[0], *(power @ B for power in powers[1:])])
    predicted_Q = P.T @ cost.Q @ P
    summed = lqr.lqr(late, (predicted_Q + predicted_Q.T) / 2, cost.R, P.T @ cost.N)
    size = np.abs(gain.K).max()
    np.testing.assert_allclose(gain.K, summed.K, rtol=0, atol=tolerances.of("pencil") * size)
    np.testing.assert_allclose(gain.K, lqr.lqrd(plant, Q, R, T, N).K @ P, rtol=0, atol=tolerances.of("pencil") * size)
    W = np.zeros((len(late.A) + 2, len(late.A) + 2))
    W[:5, :5] = np.block([[cost.Q, cost.N], [cost.N.T, cost.R]])
    F, X = np.hstack([late.A, late.B]), np.eye(len(late.A))
    for _ in range(600):
        H = W + F.T @ X @ F
        K = -np.linalg.solve(H[-2:, -2:], H[-2:, :-2])
        X = H[:-2, :-2] + H[:-2, -2:] @ K
    np.testing.assert_allclose(gain.K, K, rtol=0, atol=tolerances.of("pencil") * size)


def test_late_inputs_have_names_and_units() -> None:
    plant = StateSpace([[0, 1], [0, 0]], [[0], [1]], [[1, 0]], [[0]], ("x", "v"), ("i",), ("x",),
                       Continuous(), {"i": "A", "x": "m", "v": "m/s"})  # fmt: skip
    gain = lqr.lqrd(plant, [1.0, 1.0], [1.0], T, delay_s=0.25)
    assert gain.states == ("x", "v", "i_held", "i_late1", "i_late2")
    assert [gain.units[name] for name in gain.states[2:]] == ["A"] * 3
    text = repr(lqr.lqrd(plant, [1.0, 1.0], [1.0], T, delay_s=T))
    assert "i_late1 [A]" in text and "deadbeat" in text
