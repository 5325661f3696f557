"""Regulators by decay rates: where the poles lie, that they are optimal, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
import scipy.optimize

from synth.analyse import discretise, loop
from synth.errors import ModelError, SignalError, TimingError
from synth.statespace import StateSpace
from synth.synthesise.feedback import lqr
from synth.synthesise.regulation import internal_model, prescribed_decay, servo
from synth.timing import Continuous, Discrete
from tests import tolerances

T = 5e-4
HUM = 2 * np.pi * 50
RATES = {0.0: 25.0, HUM: 40.0}
UNITS = {"gap": "m", "speed": "m/s", "current": "A"}
AXIS = StateSpace(
    [[0, 1], [900, 0]], [[0], [3]], [[1, 0]], [[0]], ("gap", "speed"), ("current",), ("gap",), Continuous(), UNITS
)
Q, R = {"gap": 1e8, "speed": 1e2}, {"current": 1.0}
PLACED = tolerances.of("placed")


def axis(period: float | None, delay: float = 0.0) -> tuple[StateSpace, lqr.Gain]:
    """Return an unstable axis, sampled and late or not, with the optimal gain of its states."""
    if period is None:
        return AXIS, lqr.lqr(AXIS, Q, R, exact=True)
    return loop.sampled(AXIS, period, delay), lqr.lqrd(AXIS, Q, R, period, exact=True, delay_s=delay)


def random_plant(seed: int, period: float | None) -> tuple[StateSpace, lqr.Gain]:
    """Return a random plant of 3 states, 3 inputs and 2 outputs with a direct term, with a gain."""
    rng = np.random.default_rng(seed)
    matrices = rng.normal(size=(3, 3)), rng.normal(size=(3, 3)), rng.normal(size=(2, 3)), 0.3 * rng.normal(size=(2, 3))
    plant = StateSpace(*matrices, ("a", "b", "c"), ("f", "g", "h"), ("y", "z"), Continuous())
    if period is None:
        return plant, lqr.lqr(plant, [1.0, 2.0, 3.0], [1.0, 2.0, 0.5])
    return discretise.zero_order_hold(plant, period), lqr.lqrd(plant, [1.0, 2.0, 3.0], [1.0, 2.0, 0.5], period)


def distance(poles: np.ndarray, expected: np.ndarray) -> float:
    """Return the largest distance of a pole from its own, relative to the largest pole."""
    apart = np.abs(poles[:, None] - expected)
    return float(apart[scipy.optimize.linear_sum_assignment(apart)].max() / np.abs(expected).max())


def expected_poles(gain: lqr.Gain, rates: dict[float, float], counts: dict[float, int], p: int) -> np.ndarray:
    s = [-a + 1j * turn for w, a in rates.items() for turn in ({w, -w}) for _ in range(p * counts.get(w, 1))]
    z = np.array(s) if isinstance(gain.time, Continuous) else np.exp(np.array(s) * gain.time.period_s)
    return np.concatenate([gain.poles, z])


@pytest.mark.parametrize(("period", "delay"), [(None, 0.0), (T, 0.0), (T, T), (T, 0.4 * T), (T, 2.3 * T)])
def test_each_mode_decays_at_its_rate_and_the_other_poles_stay(period: float | None, delay: float) -> None:
    plant, gain = axis(period, delay)
    regulator = prescribed_decay.design(plant, gain, RATES)
    late = len(plant.A) - 2
    seen, expected = (sorted(v, key=abs) for v in (regulator.poles, expected_poles(gain, RATES, {}, 1)))
    assert distance(np.array(seen[late:]), np.array(expected[late:])) < PLACED
    assert np.abs(seen[:late]).max(initial=0.0) < 1e-4  # deadbeat, scattered by the third root of the precision
    assert regulator.steady.vanishes
    assert regulator.states == (*plant.states, "xi1", "xi2", "xi3")
    rates = regulator.poles.real if period is None else np.log(np.abs(regulator.poles)) / T
    slowest = np.sort(-rates)[:3]
    np.testing.assert_allclose(slowest, [25, 40, 40], rtol=1e-6)


@pytest.mark.parametrize("period", [None, 0.05])
@pytest.mark.parametrize("counts", [{}, {0.0: 2}, {3.0: 2}])
@pytest.mark.parametrize("seed", range(3))
def test_several_outputs_inputs_and_multiplicities(seed: int, counts: dict[float, int], period: float | None) -> None:
    """Poles that meet scatter by a root of the precision: four of them by its fourth root."""
    plant, gain = random_plant(seed, period)
    rates = {0.0: 0.7, 3.0: 1.3, 5.0: 0.4}
    regulator = prescribed_decay.design(plant, gain, rates, multiplicity=counts)
    assert distance(regulator.poles, expected_poles(gain, rates, counts, 2)) < (1e-3 if counts else 1e-6)
    assert regulator.steady.vanishes
    assert regulator.steady_error_with(replace(plant, B=plant.B * 0.97)).vanishes


def return_difference(regulator: servo.Servo, w: np.ndarray) -> np.ndarray:
    """Return 1 + L at the commands (N, m, m) for the frequencies w (N,), the states fed back."""
    n, model = len(regulator.plant.A), regulator.model
    p = len(regulator.regulated)
    acting = regulator.plant.select(regulator.regulated, regulator.controls)
    Phi, N = np.kron(np.eye(p), model.Phi), np.kron(np.eye(p), model.N)
    A = np.block([[acting.A, np.zeros((n, len(Phi)))], [N @ acting.C, Phi]])
    B = np.vstack([acting.B, N @ acting.D])
    one = np.eye(B.shape[1])
    return np.array([one - regulator.K @ np.linalg.solve(1j * v * np.eye(len(A)) - A, B) for v in w])


@pytest.mark.parametrize("which", ["axis", 0, 1])
def test_the_continuous_loop_has_the_return_difference_of_an_optimal_one(which: str | int) -> None:
    """Kalman's inequality (1 + L)* R (1 + L) >= R: gain margins 1/2 and inf, 60 degrees. A planted gain breaks it."""
    plant, gain = axis(None) if which == "axis" else random_plant(int(which), None)
    rates = RATES if which == "axis" else {0.0: 0.7, 3.0: 1.3, 5.0: 0.4}
    design = prescribed_decay.design(plant, gain, rates)
    w = np.concatenate([np.geomspace(1e-2, 1e5, 400), *(v + np.linspace(-1, 1, 40) * a for v, a in rates.items())])

    def least(regulator: servo.Servo) -> float:
        root = np.linalg.cholesky(gain.R).T
        return min(
            np.linalg.svd(root @ F @ np.linalg.inv(root), compute_uv=False)[-1] for F in return_difference(regulator, w)
        )

    assert least(design) > 1 - 1e-9
    assert least(replace(design, K=0.6 * design.K)) < 1 - 1e-3


def test_sampled_fast_it_is_the_continuous_regulator() -> None:
    """To the first order of the period."""
    whole = prescribed_decay.design(*random_plant(4, None), {0.0: 0.7, 3.0: 1.3}).K
    far, near = (
        np.abs(prescribed_decay.design(*random_plant(4, t), {0.0: 0.7, 3.0: 1.3}).K - whole).max() for t in (1e-2, 1e-3)
    )
    assert far / near == pytest.approx(10, rel=0.1)


def test_a_sampled_regulator_is_the_cheapest_to_place_its_mode() -> None:
    """An integrator behind x+ = u: of all gains with the pole exp(-a T), and others, that of least sum of u^2.

    The cost is discounted by exp(2 a T / 2) each sample, which is what the prescribed rate stands for.
    """
    plant = StateSpace([[0.0]], [[1.0]], [[1.0]], [[0.0]], ("x",), ("u",), ("x",), Discrete(0.1))
    gain = lqr.dlqr(plant, [1e-9], [1.0])
    regulator = prescribed_decay.design(plant, gain, {0.0: 2.0})

    def cost(K: np.ndarray) -> float:
        closed = (np.array([[0.0, 0.0], [0.1, 1.0]]) + np.array([[1.0], [0.0]]) @ K) * np.exp(0.1)
        if np.abs(np.linalg.eigvals(closed)).max() >= 1:
            return np.inf
        start = np.array([0.3, 1.0])
        x, total = start, 0.0
        for _ in range(4000):
            total += float((K @ x).item()) ** 2
            x = closed @ x
        return total

    best = cost(regulator.K)
    for turn in ([0.01, 0.0], [-0.01, 0.0], [0.0, 0.05], [0.0, -0.05], [0.01, 0.05]):
        assert cost(regulator.K + np.array([turn])) > best


def test_the_sampled_regulator_is_optimal_for_weights_of_like_size() -> None:
    """The recursion in NumPy, in leapfrog coordinates: its weights, given to `dlqr`, lead to the same gain.

    There they are 8, 21180 and 460; on xi in companion form the same weights are 3e17, 2e14 and 2e9.
    """
    plant, gain = axis(T)
    c, K = 2 - 2 * np.cos(HUM * T), gain.K
    A, B, C, S = plant.A + plant.B @ K, plant.B, plant.C, gain.R + plant.B.T @ gain.certificate.X @ plant.B
    whole, W = plant.A, np.array(gain.Q)
    for J, N, a in (([[1.0]], [[1.0]], 25.0), ([[1.0, c], [-1.0, 1.0 - c]], [[0.0], [1.0]], 40.0)):
        J, N = np.array(J), np.array(N) @ C
        M = scipy.linalg.solve_sylvester(-J, A, N)
        b, grown = -M @ B, np.exp(a * T)
        inverse = np.linalg.inv(J * np.sqrt(grown))
        Y = scipy.linalg.solve_discrete_lyapunov(inverse, inverse @ (b @ b.T * grown / S) @ inverse.T)
        P = grown * np.linalg.inv(Y)
        S = S + b.T @ P @ b
        zeta = np.hstack([-M, np.eye(len(J))])
        k = -np.linalg.solve(S, b.T @ P @ J) @ zeta
        none = np.zeros((len(A), len(J)))
        W = scipy.linalg.block_diag(W, 0 * J) + (1 - 1 / grown) * zeta.T @ P @ zeta
        whole = np.block([[whole, none], [N, J]])
        K, B, C = (
            np.hstack([K, 0 * k[:, : len(J)]]) + k,
            np.vstack([B, np.zeros((len(J), 1))]),
            np.hstack([C, none[:1]]),
        )
        A = np.block([[A, none], [N, J]]) + B @ k
    regulator = prescribed_decay.design(plant, gain, RATES)
    turn = internal_model.leapfrog(list(RATES), T).T
    np.testing.assert_allclose(np.hstack([regulator.K_x, regulator.K_xi @ turn]), K, rtol=1e-6)
    cross = np.vstack([gain.N, np.zeros((3, 1))])
    again = lqr.dlqr((whole, B, np.eye(5), np.zeros((5, 1)), plant.time), (W + W.T) / 2, gain.R, cross)
    np.testing.assert_allclose(again.K, K, rtol=1e-6)
    like = np.diag(W)[2:]
    companion = np.diag(np.linalg.inv(turn).T @ W[2:, 2:] @ np.linalg.inv(turn))
    assert like.max() / like.min() < 1e4
    assert companion.max() / companion.min() > 1e8


def test_the_gain_is_the_same_whatever_lapack_rounds(monkeypatch: pytest.MonkeyPatch) -> None:
    plant, gain = axis(T, 1.5 * T)
    regulator = prescribed_decay.design(plant, gain, RATES)
    monkeypatch.setattr(np.linalg, "solve", lambda A, b: np.linalg.inv(A) @ b * (1 + 2.0**-40))
    np.testing.assert_array_equal(prescribed_decay.design(plant, gain, RATES).K, regulator.K)


def test_what_does_not_fit_is_refused() -> None:
    plant, gain = axis(T)
    for rate in (0.0, -1.0, np.inf, np.nan):
        with pytest.raises(SignalError, match=r"the mode of 0\.0 rad/s decays at .*: give a finite rate above 0"):
            prescribed_decay.design(plant, gain, {0.0: rate})
    for rates in ([25.0], 25.0, None):
        with pytest.raises(SignalError, match=r"`decay_per_s` of `prescribed_decay.design` is .*: give a mapping"):
            prescribed_decay.design(plant, gain, rates)  # type: ignore[arg-type]
    with pytest.raises(SignalError, match=r"`multiplicity` of `prescribed_decay.design` is 2: give a mapping"):
        prescribed_decay.design(plant, gain, RATES, multiplicity=2)  # type: ignore[arg-type]
    for key in (None, "a", 1j):
        with pytest.raises(SignalError):
            prescribed_decay.design(plant, gain, {key: 25.0})  # type: ignore[dict-item]
    with pytest.raises(SignalError, match=r"`gain` of `prescribed_decay.design` is an array of .*: give a Gain"):
        prescribed_decay.design(plant, gain.K, RATES)  # type: ignore[arg-type]
    with pytest.raises(SignalError, match=r"frequency 3\.0 rad/s has a multiplicity, but no decay rate"):
        prescribed_decay.design(plant, gain, {0.0: 25.0}, multiplicity={3.0: 2})
    with pytest.raises(SignalError, match="distinct finite numbers >= 0, at least one"):
        prescribed_decay.design(plant, gain, {})
    with pytest.raises(SignalError, match=r"must lie below 6283\.19 rad/s"):
        prescribed_decay.design(plant, gain, {7e3: 25.0})
    with pytest.raises(TimingError, match="meets"):
        prescribed_decay.design(AXIS, gain, RATES)
    with pytest.raises(SignalError, match="the gain is from gap, speed, the plant has the states gap, speed, current_"):
        prescribed_decay.design(axis(T, T)[0], gain, RATES)
    with pytest.raises(ModelError, match="transmission zero at 0 rad/s"):
        prescribed_decay.design(replace(AXIS, C=[[0, 1]]), axis(None)[1], {0.0: 25.0})
