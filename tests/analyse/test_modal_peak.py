"""The bound from the modal form against SLICOT and exact arithmetic, and against planted defects."""

from dataclasses import replace
from typing import Any

import control
import numpy as np
import pytest

from synth.analyse import modal, modal_peak, norms, peak_gain
from synth.analyse.modal_peak import Axis, Bound, Distance
from synth.statespace import StateSpace, of
from synth.timing import Continuous
from tests.analyse.test_norms import lag, random_model, slicot_hinf

S = control.tf("s")
TWO_PEAKS = of(0.3 * lag(0.01) + 1e4 / (S**2 + 2 * S + 1e4))  # 15 at 1 rad/s, 50 at 100 rad/s


def modes(model: StateSpace, wrong: float = 0.0) -> Any:
    """Return the modes from poles and eigenvectors with a planted error, relative to the slowest decay."""
    poles, V = modal.eigen(model.A)
    sampled = not isinstance(model.time, Continuous)
    rng = np.random.default_rng(len(V))
    decay = (1 - np.abs(poles) if sampled else -poles.real).min()
    poles = poles + wrong * decay * np.where(poles.imag == 0, 1.0, 1 + 1j * np.sign(poles.imag))
    V = V + wrong * decay * rng.standard_normal(V.shape) / np.abs(model.A).max()
    return modal.of(model.A, model.B, model.C, model.D, poles, V, sampled)


def assert_holds(model: StateSpace, wrong: float = 0.0) -> None:
    """Assert that the norm lies between the two bounds."""
    modal_form = modes(model, wrong)
    bound = modal_peak.peak(modal_form)
    assert bound is not None
    peak, truth = peak_gain._from_modes(model, modal_form, bound), slicot_hinf(model)
    assert peak.lower * (1 - 1e-9) <= truth <= peak.upper * (1 + 1e-9)


@pytest.mark.parametrize("wrong", [0.0, 1e-9, 1e-7, 1e-5, 1e-3])
def test_the_bound_holds_however_wrong_poles_and_eigenvectors_are(wrong: float) -> None:
    """The first is from LAPACK; the others are wrong, and the residual accounts for it."""
    proved = 0
    for seed in range(40):
        model = random_model(seed, 0.0)
        modal_form = modes(model, wrong)
        bound = modal_form and modal_peak.peak(modal_form)
        if bound:
            proved += 1
            assert_holds(model, wrong)
    assert proved >= (40 if wrong <= 1e-7 else 10)


@pytest.mark.parametrize("wrong", [0.0, 1e-9, 1e-7, 1e-5])
def test_the_error_covers_what_the_modes_leave_out(wrong: float) -> None:
    rng = np.random.default_rng(1)
    for seed in range(40):
        model = random_model(seed, 0.0)
        modal_form, sampled = modes(model, wrong), not isinstance(model.time, Continuous)
        w = rng.uniform(0, np.pi, 20) if sampled else np.geomspace(1e-3, 30, 20)
        Z, size = Axis(modal_form).inverses(w)
        exact = model.response(np.exp(1j * w) if sampled else 1j * w)
        far = np.linalg.norm(modal_form.response(Z) - exact, axis=(1, 2))
        response_error = 1e-14 * np.linalg.norm(exact, axis=(1, 2)) / 1e-3  # the rounding of `response`
        assert (far <= modal_form.error(size) + response_error).all()
        if wrong == 1e-5:
            assert (far > response_error).any()


def test_the_second_derivative_stays_below_its_bound() -> None:
    """Taken by differences at 50 points inside each of a few intervals."""
    for seed in range(20):
        modal_form = modes(random_model(seed, 0.0))
        charts: list[tuple[Any, Any]] = [(Axis(modal_form), Axis(modal_form).edges())]
        if not modal_form.sampled:
            charts.append((Distance(modal_form), np.array([0.0, 0.5, 1.0]) / charts[0][1][-1]))
        for chart, edges in charts:
            a, b = edges[:-1], edges[1:]
            wide = b - a > 1e-6  # below, differences show rounding alone
            a, b = a[wide], b[wide]
            size = np.maximum(chart.inverses(a)[1], chart.inverses(b)[1])
            for first, last, bend in zip(a, b, chart.curvature(a, b, size), strict=True):
                t = np.linspace(first, last, 52)
                M = modal_form.response(chart.inverses(t)[0])
                second = np.linalg.norm(M[2:] - 2 * M[1:-1] + M[:-2], 2, axis=(1, 2))
                assert second.max() <= bend * (t[1] - t[0]) ** 2 * (1 + 1e-6) + 1e-13 * np.abs(M).max()


def test_a_start_at_the_lower_peak_still_finds_the_higher_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(modal_peak, "_start", lambda axis, w: modal_peak._climb(axis.modes, 0.97, 1e-6))
    assert_holds(TWO_PEAKS)
    assert modal_peak.peak(modes(TWO_PEAKS)).w > 90  # type: ignore[union-attr]


def without_an_interval(axis: Axis, edges: Any, bound: Bound) -> Any:
    return edges[edges < 50]


def test_an_omitted_interval_is_detected(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(modal_peak, "_start", lambda axis, w: modal_peak._climb(axis.modes, 0.97, 1e-6))
    monkeypatch.setattr(modal_peak, "_refine_edges", without_an_interval)
    monkeypatch.setattr(modal_peak, "_bound_beyond", lambda modes: 0.0)
    with pytest.raises(AssertionError):
        assert_holds(TWO_PEAKS)


def test_a_pole_omitted_from_the_bound_is_detected(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the pole in the edges and in the second derivative, its peak lies between two points."""
    pole, edges, bend = 100.0, Axis.edges, Axis.curvature

    def forgetful(axis: Axis, a: Any, b: Any, size: Any) -> Any:
        near = np.abs(np.abs(axis.modes.poles) - pole) < 1
        kept = replace(axis.modes, sizes=np.where(near, 0.0, axis.modes.sizes))
        return bend(Axis(kept), a, b, size)

    monkeypatch.setattr(modal_peak, "_start", lambda axis, w: modal_peak._climb(axis.modes, 0.97, 1e-6))
    monkeypatch.setattr(Axis, "edges", lambda axis: (w := edges(axis))[np.abs(w - pole) > 1])
    monkeypatch.setattr(Axis, "curvature", forgetful)
    with pytest.raises(AssertionError):
        assert_holds(TWO_PEAKS)


def test_modes_without_their_error_are_detected(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(modal.Modes, "error", lambda modes, a: np.zeros(len(a)))
    assert_holds(TWO_PEAKS)
    with pytest.raises(AssertionError):
        assert_holds(TWO_PEAKS, 1e-3)


def test_no_modal_form_proves_an_unstable_model_stable() -> None:
    """A pole at +1e-12 that counts as one at -1e-12."""
    A, poles = np.diag([1e-12, -1.0]), np.array([-1e-12, -1.0 + 0j])
    modal_form = modal.of(A, np.ones((2, 1)), np.ones((1, 2)), np.zeros((1, 1)), poles, np.eye(2), sampled=False)
    assert modal_form is not None and modal_peak.peak(modal_form) is None
    right = modal.of(A - 2e-12 * np.eye(2), np.ones((2, 1)), np.ones((1, 2)), np.zeros((1, 1)), poles, np.eye(2), False)
    assert right is not None and modal_peak.peak(right) is not None


@pytest.mark.parametrize(("damping", "gap"), [(1e-6, 1e-6), (1e-8, 1e-5), (1e-10, 1e-3)])
def test_a_narrow_peak_is_proved(damping: float, gap: float) -> None:
    for system in (lag(damping), lag(damping) + 100 / (S + 1)):
        norm = norms.norm_hinf(system)
        assert norm.certified and norm.upper <= (1 + 2.1 * gap) * norm.lower
        assert norm.lower <= (1 / (2 * damping)) * (1 + 1e-3) and norm.upper >= (1 / (2 * damping)) * (1 - 1e-3)


def test_dependent_eigenvectors_are_left_to_the_lyapunov_matrix() -> None:
    A = np.array([[-1.0, 1.0, 0.0], [0.0, -1.0, 1.0], [0.0, 0.0, -1.0]])
    norm = norms.norm_hinf((A, np.eye(3)[:, 2:], np.eye(3)[:1], np.zeros((1, 1))))
    assert norm.certified and norm.lower <= 1.0 <= norm.upper <= 1 + 2e-6
    poles, V = -np.ones(3, dtype=np.complex128), np.array([[1.0, 1.0, 1.0], [0.0, 1e-20, 0.0], [0.0, 0.0, 0.0]])
    for eigenvectors in (V, V + 1e-17 * np.eye(3)):
        modal_form = modal.of(A, np.eye(3)[:, 2:], np.eye(3)[:1], np.zeros((1, 1)), poles, eigenvectors, sampled=False)
        assert modal_form is None or modal_peak.peak(modal_form) is None


def test_numbers_out_of_range_are_left_to_the_lyapunov_matrix() -> None:
    for scale in (1e40, 1e-40):
        model = of(([[-1.0]], [[scale]], [[1.0]]))
        modal_form = modes(model)
        assert modal_form is None or modal_peak.peak(modal_form) is None
        assert norms.norm_hinf(model).peak == pytest.approx(scale, rel=1e-12)


def test_singular_values_in_closed_form() -> None:
    rng = np.random.default_rng(3)
    for p, m in ((1, 1), (1, 3), (2, 2), (2, 4), (3, 2), (3, 3), (4, 3)):
        M = rng.standard_normal((30, p, m)) + 1j * rng.standard_normal((30, p, m))
        M[0] = np.eye(p, m)
        expected = np.linalg.svd(M, compute_uv=False)[:, 0]
        np.testing.assert_allclose(modal_peak._gains(M, 0.0), expected, rtol=1e-14)
        assert (modal_peak._gains(M, np.inf) >= expected * (1 - 1e-14)).all()
