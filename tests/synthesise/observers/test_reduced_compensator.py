"""Loops with reduced-order observers separate; the planar positioner's published loop, and its misapplied gain."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linear_sum_assignment

from synth.analyse import discretise
from synth.analyse.loops import interconnect
from synth.errors import ModelError
from synth.statespace import Array, StateSpace
from synth.synthesise.feedback import lqr
from synth.synthesise.observers import reduced_observer
from synth.timing import Continuous, Discrete
from tests import tolerances
from tests.synthesise.observers.models import by_poles

# The planar positioner, Y(31): positions, their integrals, speeds; currents of the motors A, B, C.
T = 1 / 800
POSITIONS, INTEGRALS, SPEEDS = ("x", "y", "phi"), ("z1", "z2", "z3"), ("d", "f", "v")
FORCES = np.array([[0, 0, 13.2547], [13.2547, 13.2547, 0], [-117.15, 117.15, 0]])
Q = np.diag([1e4, 1e3, 1e3, 1e10, 1e9, 1e10, 1e2, 1e1, 2e1])
K49 = np.array(
    [
        [0, 507.24, -472.64, 0, 19975, -41394, 0, 6.4304, -2.6962],
        [0, 507.24, 472.64, 0, 19975, 41394, 0, 6.4304, 2.6962],
        [1757.55, 0, 0, 84872, 0, 0, 18.1556, 0, 0],
    ]
)
H42 = np.hstack([1600 * np.eye(3) + 0.0006 * (1 - np.eye(3)), np.eye(3)])


def planar(integrals: bool = True) -> StateSpace:
    """Return Y(31), or Y(26) without the integrals, in continuous time."""
    A, B = np.zeros((9, 9)), np.vstack([np.zeros((6, 3)), FORCES])
    A[:3, 6:] = A[3:6, :3] = np.eye(3)
    names = (*POSITIONS, *INTEGRALS, *SPEEDS)
    keep = [i for i in range(9) if integrals or names[i] not in INTEGRALS]
    states, units = tuple(names[i] for i in keep), dict(zip(POSITIONS, ("m", "m", "rad"), strict=True))
    C = np.eye(len(keep))[:3]
    return StateSpace(
        A[np.ix_(keep, keep)], B[keep], C, np.zeros((3, 3)), states, ("iA", "iB", "iC"), POSITIONS, Continuous(), units
    )


HELD = discretise.zero_order_hold(planar(), T)
PLAIN = discretise.zero_order_hold(planar(integrals=False), T)


def speed_gain(p: float) -> Array:
    return np.hstack([(1 - p) / T * np.eye(3), np.zeros((3, 3))])


def farthest(poles: Array, expected: Array) -> float:
    """Return the largest distance between two sets of poles, matched."""
    distance = np.abs(np.asarray(poles)[:, None] - expected)
    return float(distance[linear_sum_assignment(distance)].max())


def printed_matrix(L: Array, k: Array) -> Array:
    """Return the matrix of Y(33) for u = -k1 x1 - k2 x2^, term by term as printed."""
    A, B = HELD.A, HELD.B
    A11, A12, A21, A22, B1, B2, k1, k2 = A[:6, :6], A[:6, 6:], A[6:, :6], A[6:, 6:], B[:6], B[6:], k[:, :6], k[:, 6:]
    return np.block(
        [
            [A11 - B1 @ k1 - B1 @ k2 @ L, A12, -B1 @ k2],
            [A21 - B2 @ k1 - B2 @ k2 @ L, A22, -B2 @ k2],
            [
                (A22 - L @ A12) @ L + A21 - L @ A11 - (B2 - L @ B1) @ (k1 + k2 @ L),
                np.zeros((3, 3)),
                A22 - L @ A12 - B2 @ k2 + L @ B1 @ k2,
            ],
        ]
    )


def test_the_published_gain_is_lqrd_of_the_corrected_weights() -> None:
    gain = -lqr.lqrd(planar(), Q, np.eye(3), T).K
    np.testing.assert_allclose(gain, K49, rtol=1.3e-5, atol=1e-6)


@pytest.mark.parametrize("p", [0.0, 0.35, 0.7])
def test_the_planar_loop_separates_and_is_the_one_of_33(p: float) -> None:
    L = speed_gain(p)
    observer = reduced_observer.from_gain(HELD, (*POSITIONS, *INTEGRALS), L)
    compensator = reduced_observer.compensator(observer, -K49)
    np.testing.assert_allclose(
        compensator.loop.A, printed_matrix(L, K49), rtol=1e-10, atol=1e-10 * np.abs(compensator.loop.A).max()
    )
    np.testing.assert_allclose(observer.poles, [p] * 3, atol=tolerances.of("double"))
    both = np.concatenate([np.linalg.eigvals(HELD.A - HELD.B @ K49), [p] * 3])
    assert farthest(compensator.poles, both) < tolerances.of("double")
    assert compensator.separation < 8e-15
    assert round(float(np.abs(compensator.poles).max()), 5) == 0.94562


def misapplied_equation(psi: Array, theta: Array) -> Array:
    """Return H of Y(41), a continuous Riccati equation, for the matrices of the sampled model."""
    A12 = HELD.A[:6, 6:]
    sigma = scipy.linalg.solve_continuous_are(np.eye(3), A12.T, psi, theta)
    return np.asarray(np.linalg.solve(theta, A12 @ sigma).T)


def test_the_gain_42_solves_a_continuous_equation_with_sampled_matrices() -> None:
    """A22 = I, A12 = (T I; T^2/2 I), Theta = Psi_ij = 5e-5: H has 2/T, T/2 and 1, each as printed."""
    H = misapplied_equation(np.full((3, 3), 5e-5), 5e-5 * np.eye(6))
    np.testing.assert_allclose(H[:, :3], 1600 * np.eye(3) + 0.000625 * (1 - np.eye(3)), rtol=2e-6)
    np.testing.assert_allclose(H[:, 3:], np.eye(3), atol=1e-6)
    np.testing.assert_array_equal(np.round(H, 4), H42)


def test_the_gain_42_is_refused_by_its_poles() -> None:
    """Eigenvectors of its F are (1, 1, 1), with |z| = 1 + 3 T^2 / 2 to first order, and two with z = -1."""
    H = misapplied_equation(np.full((3, 3), 5e-5), 5e-5 * np.eye(6))
    poles = np.linalg.eigvals(np.eye(3) - H @ HELD.A[:6, 6:])
    assert float(np.abs(poles).max()) == pytest.approx(1 + 1.5 * T**2, abs=1e-11)
    with pytest.raises(ModelError, match=r"observer of d, f, v with this gain has the poles -1\.00000234, -1, -1"):
        reduced_observer.from_gain(HELD, (*POSITIONS, *INTEGRALS), H)
    with pytest.raises(ModelError, match=r"has the poles -1\.00000"):
        reduced_observer.from_gain(HELD, (*POSITIONS, *INTEGRALS), H42)


@given(seed=st.integers(0, 10**6), rank=st.integers(1, 3))
@settings(derandomize=True, max_examples=25, deadline=None)
def test_no_choice_of_noise_would_have_mended_42(seed: int, rank: int) -> None:
    """For A = I the Hamiltonian squares to I + S Psi, S >= 0: every pole of I - H C is at -sqrt(1 + ..) <= -1."""
    rng = np.random.default_rng(seed)
    g, h = rng.normal(size=(3, rank)), rng.normal(size=(6, 6))
    size = 10.0 ** rng.uniform(-3, 3)
    H = misapplied_equation(size * g @ g.T, h @ h.T + np.eye(6))
    C = HELD.A[:6, 6:]
    poles = np.linalg.eigvals(np.eye(3) - H @ C)
    assert np.abs(poles.imag).max() < tolerances.of("pencil")
    assert poles.real.max() < -1 + tolerances.of("pencil")
    with pytest.raises(ModelError, match="its error does not decay"):
        reduced_observer.from_gain(HELD, (*POSITIONS, *INTEGRALS), H)


def test_integrals_that_the_compensator_computes_itself() -> None:
    """z+ = z + T y for K designed on that very model; a constant force on each axis leaves no error in y."""
    observer = by_poles(PLAIN, POSITIONS, [0.5, 0.5, 0.5])
    computed = interconnect.integrals(PLAIN, dict(zip(INTEGRALS, POSITIONS, strict=True)))
    np.testing.assert_array_equal(computed.B, T * np.eye(3))
    plant = reduced_observer.augmented(observer, computed)
    assert plant.states == (*POSITIONS, *SPEEDS, *INTEGRALS)
    assert [plant.unit(z) for z in INTEGRALS] == ["m s", "m s", "rad s"]
    order = [HELD.states.index(name) for name in plant.states]
    gain = lqr.lqr(plant, Q[np.ix_(order, order)], np.eye(3))
    compensator = reduced_observer.compensator(observer, gain.K, computed)
    both = np.concatenate([np.linalg.eigvals(plant.A + plant.B @ gain.K), [0.5] * 3])
    assert farthest(compensator.poles, both) < tolerances.of("settled")
    assert compensator.separation < tolerances.of("double")
    assert compensator.model.inputs == POSITIONS and compensator.model.outputs == ("iA", "iB", "iC")
    assert compensator.model.states == ("d_x3", "f_x3", "v_x3", *INTEGRALS)
    at_rest = compensator.loop.response(1.0)[0].real
    forces = compensator.loop.select(POSITIONS, ("iA_disturbance", "iB_disturbance", "iC_disturbance")).response(1.0)
    assert np.abs(forces).max() < 1e-9 * np.abs(at_rest).max()


def test_the_loop_runs_as_plant_and_compensator_do_step_by_step() -> None:
    """Written out without matrices of the loop: u acts on the y of its own sample."""
    observer = by_poles(HELD, (*POSITIONS, *INTEGRALS), [0.0, 0.0, 0.0])
    compensator = reduced_observer.compensator(observer, -K49)
    L, x = observer.L, np.arange(1, 10) * 1e-5
    x3, w = np.zeros(3), np.concatenate([x, np.zeros(3)])
    for k in range(60):
        estimate = x3 + L @ x[:6]
        u = -K49 @ np.concatenate([x[:6], estimate])
        x3 = observer.F @ x3 + observer.G @ x[:6] + observer.H @ u
        x = HELD.A @ x + HELD.B @ u
        if k:
            np.testing.assert_allclose(estimate, w[6:9], atol=1e-9)  # deadbeat: true from the second sample on
        w = compensator.loop.A @ w
        np.testing.assert_allclose(w[:9], x, rtol=1e-7, atol=1e-12)


def direct(seed: int) -> StateSpace:
    """Return a sampled model with D != 0 and outputs that mix the states."""
    rng = np.random.default_rng(seed)
    A, B, C, D = (rng.normal(size=shape) for shape in ((4, 4), (4, 2), (2, 4), (2, 2)))
    labels = (("p", "q", "r", "s"), ("f", "g"), ("a", "b"))
    return StateSpace(0.6 * A, B, C, D, *labels, Discrete(0.1))


@pytest.mark.parametrize("seed", range(4))
def test_a_direct_path_is_taken_off_at_the_same_sample(seed: int) -> None:
    model = direct(seed)
    observer = by_poles(model, ("a", "b"), [0.2, 0.3])
    z = StateSpace([[0.5]], [[1, 2, 3]], [[1]], [[0, 0, 0]], ("z",), ("b", "r_estimate", "g"), ("z",), Discrete(0.1))
    plant = reduced_observer.augmented(observer, z)
    np.testing.assert_allclose(plant.A[4, :4], model.C[1] + 2 * np.eye(4)[2], rtol=tolerances.of("double"))
    np.testing.assert_allclose(plant.B[4], model.D[1] + [0, 3], rtol=tolerances.of("double"))
    gain = lqr.lqr(plant, np.eye(5), np.eye(2))
    compensator = reduced_observer.compensator(observer, gain.K, z)
    assert compensator.separation < tolerances.of("double")
    both = np.concatenate([np.linalg.eigvals(plant.A + plant.B @ gain.K), [0.2, 0.3]])
    assert farthest(compensator.poles, both) < tolerances.of("placed")
    forgotten = replace(observer, partition=replace(observer.partition, D=0 * observer.partition.D))
    assert reduced_observer.compensator(forgotten, gain.K, z).separation > 1e-3


def test_the_loop_answers_disturbances_and_noise_as_its_parts_say() -> None:
    """y = P (u + d), u = C (y + n) with P and C the responses of plant and compensator."""
    observer = by_poles(PLAIN, POSITIONS, [0.5, 0.5, 0.5])
    compensator = reduced_observer.compensator(observer, lqr.lqr(PLAIN, np.eye(6), np.eye(3)).K)
    z = np.exp(1j * np.array([0.01, 0.3, 2.0]))
    P, C, one = PLAIN.response(z), compensator.model.response(z), np.eye(3)
    loop = compensator.loop.response(z)
    to_y = np.linalg.solve(one - P @ C, np.concatenate([P, P @ C], axis=2))
    to_u = np.linalg.solve(one - C @ P, np.concatenate([C @ P, C], axis=2))
    expected = np.concatenate([to_y, to_u], axis=1)
    np.testing.assert_allclose(loop, expected, rtol=1e-8, atol=1e-9 * np.abs(expected).max())
    assert compensator.loop.inputs[::3] == ("iA_disturbance", "x_noise")


def test_a_continuous_loop_separates() -> None:
    observer = by_poles(planar(integrals=False), POSITIONS, [-300, -300, -400])
    computed = interconnect.integrals(planar(integrals=False), {"z1": "x"})
    gain = lqr.lqr(reduced_observer.augmented(observer, computed), np.diag([1e6, 1e6, 1e6, 1, 1, 1, 1e8]), np.eye(3))
    compensator = reduced_observer.compensator(observer, gain.K, computed)
    assert compensator.separation < tolerances.of("double")
    both = np.concatenate([gain.poles, [-300, -300, -400]])
    assert farthest(compensator.poles, both) < tolerances.of("placed") * 400


def test_a_sample_of_delay_belongs_to_the_plant() -> None:
    late = discretise.delay_samples(PLAIN)
    gain = lqr.lqr(late, np.diag([1e6] * 3 + [1.0] * 3 + [1e-3] * 3), np.eye(3))
    known = (*POSITIONS, "iA_late1", "iB_late1", "iC_late1")
    for observer in (
        by_poles(late, POSITIONS, [0.1, 0.1, 0.1, 0.2, 0.2, 0.2]),
        by_poles(late, known, [0.2, 0.2, 0.2]),
    ):
        assert reduced_observer.compensator(observer, gain.K).separation < tolerances.of("double")


def test_an_input_that_acts_on_itself_at_once_without_a_solution() -> None:
    """y = x + u and u = -x^ = -(y - u) leave no u."""
    A, B, C = [[0.5, 1], [0, 0.5]], [[0.1], [0]], [[1, 0]]
    observer = by_poles((A, B, C, [[1]], 0.1), "y1", [0.2])
    with pytest.raises(ModelError, match="the algebraic loop of u through D and K has no solution"):
        reduced_observer.compensator(observer, [[-1, 0]])
    without = by_poles((A, B, C, [[0]], 0.1), "y1", [0.2])
    assert reduced_observer.compensator(without, [[-1, 0]]).separation < tolerances.of("double")


def test_a_model_without_inputs_has_an_observer_and_nothing_to_feed_back() -> None:
    plant = ([[0.5, 1], [0, 0.5]], np.zeros((2, 0)), [[1, 0]], np.zeros((1, 0)), 0.1)
    compensator = reduced_observer.compensator(by_poles(plant, "y1", [0.1]), np.zeros((0, 2)))
    assert compensator.model.outputs == ()
    np.testing.assert_allclose(np.sort(compensator.poles.real), [0.1, 0.5, 0.5])


def test_the_result_prints_itself() -> None:
    observer = reduced_observer.from_gain(HELD, (*POSITIONS, *INTEGRALS), speed_gain(0.7))
    text = repr(reduced_observer.compensator(observer, -K49))
    assert "Poles of the observer: 0.7, 0.7, 0.7" in text
    assert "The loop separates into them to" in text
    assert "next d_x3" in text
