"""Gramians are those of their definition, of SLICOT and of hand calculation, in any units."""

import control
import numpy as np
import pytest
import scipy.linalg
import scipy.signal
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse import discretise
from synth.analyse.structure import gramian
from synth.errors import ModelError, SignalError
from synth.statespace import StateSpace
from synth.timing import Continuous, Discrete, Time
from tests import tolerances


def model(seed: int, shift: float | None, period_s: float = 0.0, decades: float = 3) -> StateSpace:
    """Return a random model, its slowest or fastest mode moved to the real part `shift` if one is given."""
    rng = np.random.default_rng(seed)
    n, m, p = (int(rng.integers(1, k)) for k in (6, 4, 4))
    A = rng.normal(size=(n, n))
    if shift is not None:
        A -= (np.linalg.eigvals(A).real.max() - shift) * np.eye(n)
    x = 10.0 ** rng.uniform(-decades, decades, n)
    A, B, C = A * x / x[:, None], rng.normal(size=(n, m)) / x[:, None], rng.normal(size=(p, n)) * x
    labels = tuple(tuple(f"{letter}{k}" for k in range(size)) for letter, size in (("x", n), ("u", m), ("y", p)))
    continuous = StateSpace(A, B, C, np.zeros((p, m)), *labels, Continuous())
    return discretise.zero_order_hold(continuous, period_s) if period_s else continuous


@settings(derandomize=True, max_examples=25, deadline=None)
@given(st.integers(0, 10**6))
def test_stable_gramians_are_those_of_slicot(seed: int) -> None:
    """In other units x = X x~, too: Wc = X Wc~ X, and the same Hankel values."""
    plain, other = model(seed, -0.1, decades=0), model(seed, -0.1)
    grams, sys = gramian.gramians(plain), plain.to_control()
    close = {"rtol": tolerances.of("lyapunov"), "atol": tolerances.of("lyapunov") * np.abs(grams.Wc).max()}
    np.testing.assert_allclose(grams.Wc, control.gram(sys, "c"), **close)
    np.testing.assert_allclose(grams.Wo, control.gram(sys, "o"), **close)
    hankel = np.sort(np.asarray(control.hankel_singular_values(sys)).ravel())[::-1]
    np.testing.assert_allclose(grams.hankel, hankel, atol=tolerances.of("lyapunov") * hankel[0])
    np.testing.assert_allclose(gramian.gramians(other).hankel, hankel, atol=tolerances.of("lyapunov") * hankel[0])
    assert grams.residual < tolerances.of("double") and grams.span == "over all time"


@pytest.mark.parametrize("seed", range(6))
def test_unstable_parts_run_backward_in_time(seed: int) -> None:
    """T blkdiag(Ws, Wu) T' is the integral forward in time for the stable part, backward for the unstable one."""
    system = model(seed + 40, None)
    grams = gramian.gramians(system)
    values, V = np.linalg.eig(system.A)
    b = np.linalg.solve(V, system.B.astype(complex))
    same_side = np.sign(values.real)[:, None] == np.sign(values.real)
    sided = np.where(same_side, np.sign(values.real)[:, None] / (values[:, None] + values.conj()), 0.0)
    np.testing.assert_allclose(grams.Wc, (V @ (sided * (b @ b.conj().T)) @ V.conj().T).real, rtol=1e-6)


def test_sampled_gramians_are_sums_over_the_samples() -> None:
    A = np.array([[0.5, 0.2, 0.1], [0.0, -0.8, 0.3], [0.0, 0.0, 2.0]])
    B, C = np.array([[1.0], [2.0], [1.0]]), np.array([[1.0, 0.0, 1.0]])
    grams = gramian.gramians((A, B, C, [[0.0]], Discrete(1e-3)))
    values, V = np.linalg.eig(A)
    b = np.linalg.solve(V, B)
    forward = [1, 1, 0] if values[2] == 2 else np.abs(values) < 1
    ahead = sum(np.outer(r := V @ (np.asarray(forward)[:, None] * values[:, None] ** k * b), r) for k in range(400))
    back = sum(np.outer(r := V @ (np.where(forward, 0, values**-k)[:, None] * b), r) for k in range(1, 100))
    np.testing.assert_allclose(grams.Wc, ahead + back, rtol=tolerances.of("settled"))
    assert grams.span == "forward in time for stable modes, backward for unstable ones"


def test_one_mode_by_hand() -> None:
    """x' = -a x + b u + 2 b w, y = c x: Wc = 5 b^2 / 2 a, Wo = c^2 / 2 a, and w has the share 4/5."""
    a, b, c = 3.0, 2.0, 0.5
    grams = gramian.gramians(([[-a]], [[b, 2 * b]], [[c]]))
    assert grams.Wc[0, 0] == pytest.approx(5 * b * b / (2 * a)) and grams.Wo[0, 0] == pytest.approx(c * c / (2 * a))
    assert grams.hankel == pytest.approx([np.sqrt(5) * b * c / (2 * a)])
    assert grams.by_input == pytest.approx({"u1": 0.2, "u2": 0.8}) and grams.by_output == pytest.approx({"y1": 1})
    assert "Hankel value" in str(grams) and "u2      80.00%" in str(grams)


@settings(derandomize=True, max_examples=10, deadline=None)
@given(st.integers(0, 10**6))
def test_shares_are_those_of_each_input_and_output_alone(seed: int) -> None:
    system = model(seed, -0.2)
    grams = gramian.gramians(system)
    total = float((grams.hankel**2).sum())
    for name, share in grams.by_input.items():
        alone = gramian.gramians(system.select(system.outputs, (name,)))
        assert share * total == pytest.approx(float((alone.hankel**2).sum()), rel=1e-6)
    for name, share in grams.by_output.items():
        alone = gramian.gramians(system.select((name,), system.inputs))
        assert share * total == pytest.approx(float((alone.hankel**2).sum()), rel=1e-6)


def test_a_weak_state_is_named_last() -> None:
    A = np.diag([-1.0, -1.5, -2.0])
    grams = gramian.gramians((A, [[1.0], [1e-4], [1.0]], np.eye(3), np.zeros((3, 1))))
    assert "x2" in grams.directions[-1] and grams.hankel[-1] < 1e-3 * grams.hankel[0]


def test_a_mode_on_the_stability_boundary_is_named_with_the_mend() -> None:
    A = scipy.linalg.block_diag([[0.0, 1.0], [0.0, 0.0]], [[-1.0]])
    for seed in range(4):
        U = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0] if seed else np.eye(3)
        for time, M in ((Continuous(), A), (Discrete(1e-3), A + np.diag([1.0, 1.0, 0.5]))):
            with pytest.raises(
                ModelError, match=r"mode .* in .* lies on the border of stability.*; close a loop .*over"
            ):
                gramian.gramians((U @ M @ U.T, U @ [[0.0], [1.0], [1.0]], time))
    with pytest.raises(ModelError, match=r"mode 0 in x1 lies"):
        gramian.gramians((A, [[0.0], [1.0], [1.0]]))
    gramian.gramians(([[-1e-9]], [[1.0]]))


def test_a_slow_mode_beside_a_fast_one_is_resolved_on_the_diagonal() -> None:
    """-1e-4 beside -1e9 is exact on the diagonal; in other coordinates, rounding of the fast mode moves it by 1e-7."""
    A = np.diag([-1e-4, -1e9])
    assert gramian.gramians((A, np.ones((2, 1)))).Wc[0, 0] == pytest.approx(5e3)
    U = np.linalg.qr(np.random.default_rng(0).normal(size=(2, 2)))[0]
    with pytest.raises(ModelError, match="border of stability, within rounding of the fastest mode; close"):
        gramian.gramians((U @ A @ U.T, np.ones((2, 1))))


@pytest.mark.parametrize("time", [Continuous(), Discrete(1e-3)])
def test_a_model_without_states_has_empty_gramians(time: Time, capfd: pytest.CaptureFixture[str]) -> None:
    static = StateSpace(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), [[1.0]], (), ("u",), ("y",), time)
    for grams in (gramian.over_horizon(static, 1.0), gramian.gramians(static)):
        assert grams.Wc.shape == grams.Wo.shape == (0, 0) and grams.by_input == {"u": 0}
    assert capfd.readouterr() == ("", ""), "LAPACK writes to the terminal when it is given nothing"


@pytest.mark.filterwarnings("error")
def test_sizes_at_the_ends_of_the_range_are_refused_or_right() -> None:
    with pytest.raises(SignalError, match=r"the entries of A reach 1e\+308: choose units"):
        gramian.gramians(([[-1e308]], [[1.0]]))
    grams = gramian.gramians(([[-1e-200]], [[1.0]]))
    assert grams.Wc[0, 0] == pytest.approx(5e199) and "100.00%" in str(grams)


def test_over_a_horizon_a_double_integrator_has_the_gramian_of_the_textbook() -> None:
    T = 0.3
    grams = gramian.over_horizon(([[0.0, 1.0], [0.0, 0.0]], [[0.0], [1.0]], [[1.0, 0.0]]), T)
    np.testing.assert_allclose(grams.Wc, [[T**3 / 3, T**2 / 2], [T**2 / 2, T]], rtol=tolerances.of("double"))
    np.testing.assert_allclose(grams.Wo, [[T, T**2 / 2], [T**2 / 2, T**3 / 3]], rtol=tolerances.of("double"))
    assert grams.residual < tolerances.of("double") and grams.span == "over 0.3 s"


def test_over_a_horizon_agrees_with_quadrature_and_with_sums() -> None:
    system = model(5, 0.3)

    nodes, weights = np.polynomial.legendre.leggauss(24)
    n = len(system.A)
    reference = sum(
        w * (r := scipy.linalg.expm(system.A * (1 + t)) @ system.B) @ r.T for t, w in zip(nodes, weights, strict=True)
    )
    np.testing.assert_allclose(gramian.over_horizon(system, 2.0).Wc, reference, rtol=tolerances.of("quadrature"))
    sampled = model(5, 0.3, 1e-2)
    for samples in (1, 2, 7, 100):
        grams = gramian.over_horizon(sampled, samples * 1e-2)
        power, Wc = sampled.B, np.zeros((n, n))
        for _ in range(samples):
            Wc, power = Wc + power @ power.T, sampled.A @ power
        np.testing.assert_allclose(grams.Wc, Wc, rtol=tolerances.of("settled"))


def test_the_residual_catches_a_wrong_integral(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: the Lyapunov equation is solved for the transposed matrix."""
    right = gramian._lyapunov
    monkeypatch.setattr(gramian, "_lyapunov", lambda F, Q, continuous: right(F.T, Q, continuous))
    system = ([[-1.0, 3.0], [0.0, -2.0]], [[1.0], [0.0]], [[1.0, 2.0]])
    assert gramian.gramians(system).residual > 1e-3


def butterworth(direct: bool) -> control.StateSpace:
    """Return a slow filter of order 4: in direct form, or in modal coordinates."""
    if direct:
        return control.tf(*scipy.signal.butter(4, 20, fs=2e4), 5e-5)
    zeros, poles, gain = scipy.signal.butter(4, 20, fs=2e4, output="zpk")
    blocks, C = [], []
    for pole in poles[poles.imag > 0]:
        blocks.append([[pole.real, pole.imag], [-pole.imag, pole.real]])
        residue = gain * np.prod(pole - zeros) / np.prod(pole - poles[poles != pole])
        C += [2 * residue.real, 2 * residue.imag]
    return control.ss(scipy.linalg.block_diag(*blocks), [[1.0], [0.0]] * 2, C, gain, 5e-5)


def test_a_gramian_that_rounding_decides_is_refused_and_modal_coordinates_determine_it() -> None:
    with pytest.raises(
        ModelError, match=r"mode 0\.99758 .* is off the border of stability, .* give the model in modal"
    ):
        gramian.gramians(butterworth(True))
    with pytest.raises(ModelError, match=r"over 2000 samples is not determined .* less than 1e-04 is needed; give the"):
        gramian.over_horizon(butterworth(True), 0.1)
    h = scipy.signal.sosfilt(scipy.signal.butter(4, 20, fs=2e4, output="sos"), np.eye(1, 20_001)[0])[1:]
    energy = float(np.arange(1, 20_001) @ h**2)  # of all entries h(i + j - 1) of the Hankel matrix
    modal = gramian.gramians(butterworth(False)).hankel
    assert (modal**2).sum() == pytest.approx(energy, rel=1e-6) and modal[0] == pytest.approx(0.86593686, rel=1e-6)


def test_a_horizon_in_which_a_mode_grows_beyond_rounding_is_refused() -> None:
    model = ([[0.0, 1.0], [400.0, 0.0]], [[1.0], [-20.0]], [[20.0, -1.0]], [[0.0]])
    exact = (1 - np.exp(-40 * 0.3)) / 40 * np.array([[400.0, -20.0], [-20.0, 1.0]])
    np.testing.assert_allclose(gramian.over_horizon(model, 0.3).Wo, exact, rtol=1e-9)
    with pytest.raises(ModelError, match=r"over 1 s is not determined .*; take a shorter horizon"):
        gramian.over_horizon(model, 1.0)
