"""Norms against SLICOT and closed forms, and their proofs against planted defects."""

import re
from typing import Any

import control
import flint
import mpmath
import numpy as np
import pytest
import scipy
import slycot

from synth.analyse import bounded_real, modal, norms, peak_gain, precise
from synth.errors import ModelError, SynthError
from synth.statespace import StateSpace, of
from synth.timing import Continuous

S, Z = control.tf("s"), control.tf([1.0, 0.0], [1.0], 0.5)
LIGHT = 1e-6


def lag(damping: float) -> Any:
    return 1 / (S**2 + 2 * damping * S + 1)


def random_model(seed: int, decades: float = 3.0) -> StateSpace:
    """Return a stable model with up to 12 states and 3 inputs and outputs, every other one sampled.

    Its states are in units that differ by factors up to 10 to the power of twice the decades.
    """
    rng = np.random.default_rng(seed)
    n, m, p = int(rng.integers(1, 13)), int(rng.integers(1, 4)), int(rng.integers(1, 4))
    A = rng.standard_normal((n, n))
    poles = np.linalg.eigvals(A)
    margin = 10.0 ** rng.uniform(-3, 0)
    A = A / np.abs(poles).max() / (1 + margin) if seed % 2 else A - (poles.real.max() + margin) * np.eye(n)
    D = rng.standard_normal((p, m)) * (seed % 3 == 0)
    time = (0.1,) if seed % 2 else (0,)
    B, C = rng.standard_normal((n, m)), rng.standard_normal((p, n))
    unit = 2.0 ** np.round(rng.uniform(-1, 1, n) * decades * np.log2(10))
    return of((A * unit[:, None] / unit, B * unit[:, None], C / unit, D, *time))


def slicot_hinf(model: StateSpace) -> float:
    n, (p, m) = len(model.A), model.D.shape
    dico = "C" if isinstance(model.time, Continuous) else "D"
    parts = model.A, np.eye(n), model.B, model.C, model.D
    return float(slycot.ab13dd(dico, "I", "S", "D", n, m, p, *parts, 1e-10)[0])


def slicot_h2(model: StateSpace) -> float:
    n, (p, m) = len(model.A), model.D.shape
    dico = "C" if isinstance(model.time, Continuous) else "D"
    parts = (np.array(part) for part in (model.A, model.B, model.C, model.D))
    return float(slycot.ab13bd(dico, "H", n, m, p, *parts))


@pytest.mark.parametrize("seeds", np.arange(200).reshape(10, 20).tolist(), ids=lambda s: f"{s[0]}..{s[-1]}")
@pytest.mark.parametrize("by_modes", [True, False], ids=["modes", "Lyapunov matrix"])
def test_200_random_models_are_certified_and_agree_with_slicot(
    seeds: list[int], by_modes: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    gap = 2e-6 if by_modes else 2e-4  # rounding decides whether seed 31 needs the level 1e-5 of the Lyapunov matrix
    if not by_modes:
        monkeypatch.setattr(modal, "of", lambda *args: None)
    for seed in seeds:
        model, plain = random_model(seed), random_model(seed, 0.0)  # SLICOT loses digits in badly scaled units
        norm, theirs = norms.norm_hinf(model), slicot_hinf(plain)
        assert norm.certified and norm.upper <= (1 + gap) * norm.lower
        assert norm.lower * (1 - 1e-9) <= theirs <= norm.upper * (1 + 1e-9)
        assert norm.lower <= norm.peak * (1 + 1e-14) and norm.peak <= norm.upper
        if not (isinstance(model.time, Continuous) and model.D.any()):
            square = norms.norm_h2(model)
            assert square.error < 1e-9 and square.value == pytest.approx(slicot_h2(plain), rel=1e-8)


@pytest.mark.parametrize(
    ("system", "peak", "frequency"),
    [
        (lag(0.1), 1 / (0.2 * np.sqrt(0.99)), np.sqrt(0.98)),
        (lag(0.8), 1.0, 0.0),
        (lag(1e-3), 1 / (2e-3 * np.sqrt(1 - 1e-6)), np.sqrt(1 - 2e-6)),
        (1 / (S + 1), 1.0, 0.0),
        (S / (S + 1), 1.0, np.inf),
        (2 / (Z + 0.5), 4.0, np.pi / 0.5),
        (2 / (Z - 0.5), 4.0, 0.0),
        (control.tf([0.0], [1.0, 1.0]), 0.0, 0.0),
    ],
    ids=["light", "heavy", "lighter", "at 0", "at infinity", "at Nyquist", "sampled at 0", "nothing"],
)
def test_closed_forms(system: Any, peak: float, frequency: float) -> None:
    norm = norms.norm_hinf(system)
    assert norm.certified and norm.lower <= peak * (1 + 1e-12) and peak <= norm.upper * (1 + 1e-12)
    assert norm.peak == pytest.approx(peak, rel=1e-9) and norm.frequency == pytest.approx(frequency, rel=1e-4)


@pytest.mark.parametrize("system", [(S - 1) / (S + 1), (0.5 * Z - 1) / (Z - 0.5)], ids=["continuous", "sampled"])
def test_an_all_pass_has_its_gain_everywhere(system: Any) -> None:
    norm = norms.norm_hinf(system)
    assert norm.certified and float(norm) == pytest.approx(1.0, rel=1e-12)


def test_a_static_gain_is_its_largest_singular_value() -> None:
    D = np.array([[3.0, 0.0, 4.0], [0.0, 2.0, 0.0]])
    norm = norms.norm_hinf((np.zeros((0, 0)), np.zeros((0, 3)), np.zeros((2, 0)), D))
    assert norm.certified and float(norm) == pytest.approx(5.0, rel=1e-14)
    assert norms.norm_hinf((-np.eye(2), np.zeros((2, 0)))).upper == 0.0


def test_a_narrow_peak_is_found_and_proved_as_far_as_rounding_allows() -> None:
    """1e-6 wide in frequency: any grid without the pole misses it."""
    system = lag(LIGHT) + 100 / (S + 1)
    norm = norms.norm_hinf(system)
    expected = slicot_hinf(of(system))
    assert norm.certified and norm.peak == pytest.approx(expected, rel=1e-6) and norm.upper < (1 + 2e-6) * norm.lower
    assert norms.norm_h2(lag(LIGHT)).value == pytest.approx(1 / np.sqrt(4 * LIGHT), rel=1e-9)


def test_a_peak_away_from_all_poles_is_found() -> None:
    """Twelve equal lags in companion form, whose poles scatter by 1 %; a notch below and a lead above."""
    system = (S**2 + 0.02 * S + 1) / (S + 1) ** 2 * 30 * (S + 3) / (S + 100) / (0.1 * S + 1)
    norm = norms.norm_hinf(system)
    assert norm.certified and norm.peak == pytest.approx(slicot_hinf(of(system)), rel=1e-7)


@pytest.mark.parametrize(
    ("system", "frequency", "text"),
    [
        (1 / S, 0.0, "the pole at 0 does not decay"),
        (1 / (S**2 + 4), 2.0, "the pole at .*2i does not decay"),
        (1 / (S - 1), 0.0, "the pole at 1 does not decay"),
        (1 / (Z - 1), 0.0, "the pole at 1 does not decay"),
        (1 / (Z + 1.5), np.pi / 0.5, "the pole at -1.5 does not decay"),
    ],
)
def test_an_undamped_mode_makes_both_norms_infinite(system: Any, frequency: float, text: str) -> None:
    hinf = norms.norm_hinf(system)
    assert float(hinf) == hinf.lower == np.inf and hinf.frequency == pytest.approx(frequency) and hinf.certified
    for norm in (hinf, norms.norm_h2(system)):
        assert float(norm) == np.inf
        assert re.search(text, norm.reason) and norm.reason in repr(norm)


def test_h2_in_closed_form() -> None:
    assert float(norms.norm_h2(1 / (S + 3))) == pytest.approx(1 / np.sqrt(6), rel=1e-14)
    assert float(norms.norm_h2((Z + 1) / (Z - 0.5))) == pytest.approx(2.0, rel=1e-14)  # 1 + 1.5^2 / (1 - 1/4)
    assert float(norms.norm_h2(([[0.5]], [[0.0]], [[1.0]], [[3.0]], 1.0))) == pytest.approx(3.0, rel=1e-14)
    through = norms.norm_h2((S + 2) / (S + 1))
    assert float(through) == np.inf and "D[y[0], u[0]] is 1: white noise passes it" in through.reason


def h2_by_residues(numerator: Any, denominator: Any) -> float:
    """Return the H2 norm of a strictly proper sampled filter with different poles, from h(k) = sum r p^(k-1)."""
    with mpmath.workdps(80):
        num, den = ([mpmath.mpf(float(v)) for v in part] for part in (numerator, denominator))
        num = [n - num[0] / den[0] * d for n, d in zip(num, den, strict=True)]
        poles = mpmath.polyroots(den, maxsteps=500, extraprec=500)
        slope = [d * (len(den) - 1 - k) for k, d in enumerate(den[:-1])]
        residues = [mpmath.polyval(num, p) / mpmath.polyval(slope, p) for p in poles]
        terms = list(zip(residues, poles, strict=True))
        pairs = [r * s / (1 - p * q) for r, p in terms for s, q in terms]
        return float(mpmath.sqrt(mpmath.re(mpmath.fsum(pairs)) + (mpmath.mpf(float(numerator[0])) / den[0]) ** 2))


@pytest.mark.parametrize(
    ("order", "cutoff_hz", "rate_hz", "norm"),
    [(4, 20, 2e4, 0.04530279), (4, 50, 1e5, 0.03203391), (6, 100, 2e4, 0.10057373)],
)
def test_h2_of_a_slow_filter_in_direct_form(order: int, cutoff_hz: float, rate_hz: float, norm: float) -> None:
    """Its Gramian reaches 1e16 times its output variance."""
    b, a = scipy.signal.butter(order, cutoff_hz, fs=rate_hz)
    h2 = norms.norm_h2(control.tf(b, a, 1 / rate_hz))
    assert h2.value == pytest.approx(norm, rel=1e-6) and h2.error < 3e-16
    assert h2.value == pytest.approx(h2_by_residues(b, a), rel=1e-14)  # the state space rounds b - D a


def test_h2_of_fast_and_slow_modes_is_rounded_correctly() -> None:
    h2 = norms.norm_h2(([[-1e-5, 0.0], [0.0, -1e7]], [[1.0], [1e6]], [[1.0, -1e-6]], [[0.0]]))
    with mpmath.workdps(50):
        slow, fast, across = mpmath.mpf(1e-5), mpmath.mpf(1e7), mpmath.mpf(1e-6) * mpmath.mpf(1e6)
        exact = float(mpmath.sqrt(1 / (2 * slow) + across**2 / (2 * fast) - 2 * across / (slow + fast)))
    assert h2.value == exact and h2.error < 3e-16
    small = norms.norm_h2(([[-1.0]], [[1e-90]], [[1e-90]]))  # its square is below the least double
    assert small.value == pytest.approx(1e-180 / np.sqrt(2), rel=1e-15)


def test_an_h2_norm_that_cancels_is_zero_with_an_absolute_error() -> None:
    A = np.array([[-1.0, 0.3], [0.0, -2.0]])
    same = scipy.linalg.block_diag(A, A)
    h2 = norms.norm_h2((same, [[1.0], [0.7], [1.0], [0.7]], [[0.1, 0.2, -0.1, -0.2]], [[0.0]]))
    assert h2.value == 0 and 0 <= h2.error < 1e-59 and "absolute error" in repr(h2)


def test_the_ball_of_h2_covers_the_missing_part_of_the_gramian(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(norms, "MISSING", flint.arb(2) ** -4)
    matrices = (precise.matrix(part) for part in ([[0.5, 1.0], [0.0, 0.25]], np.eye(2), [[1.0, 1.0]]))
    square, _ = norms._output_variance(*matrices)
    exact = np.ones(2) @ scipy.linalg.solve_discrete_lyapunov([[0.5, 1.0], [0.0, 0.25]], np.eye(2)) @ np.ones(2)
    assert 1e-4 < float(square.rad()) / exact < 0.1 and abs(float(square.mid()) - exact) <= float(square.rad())


def test_h2_refuses_a_model_whose_exact_poles_do_not_decay(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(norms.transfer, "is_stable", lambda *args: True)
    for time in ((), (0.1,)):
        with pytest.raises(ModelError, match=r"slowest pole is computed as 1\.5; give the model in sections"):
            norms.norm_h2(([[1.5]], [[1.0]], [[1.0]], [[0.0]], *time))


MODEL = of(control.ss(lag(0.1)))
MATRICES = MODEL.A, MODEL.B, MODEL.C, MODEL.D
PEAK = 1 / (0.2 * np.sqrt(0.99))


def proof(level: float, weights: float = 1e-6) -> Any:
    return bounded_real.solve(MATRICES, level, np.full(2, weights)).X


def test_nothing_proves_a_level_below_the_peak() -> None:
    above = proof(PEAK * (1 + 1e-5))
    assert bounded_real.is_proof(above, MATRICES, PEAK * (1 + 1e-5), continuous=True)
    for level in (PEAK * (1 - 1e-9), 0.5 * PEAK):
        for X in (above, proof(level)):
            assert X is None or not bounded_real.is_proof(X, MATRICES, level, continuous=True)


def test_no_lyapunov_matrix_proves_an_unstable_model_stable() -> None:
    A = np.diag([-1.0, 1.0])
    matrices = A, np.ones((2, 1)), np.ones((1, 2)), np.zeros((1, 1))
    for X in (np.eye(2), np.diag([1.0, -1.0]), bounded_real.solve(matrices, 10.0, np.full(2, 1e-3)).X):
        assert not bounded_real.is_proof(X, matrices, 10.0, continuous=True)


def test_a_matrix_is_definite_only_beyond_its_uncertainty() -> None:
    H = np.array([[1.0, 1.0 - 1e-8], [1.0 - 1e-8, 1.0]])  # eigenvalues 1e-8 and 2
    assert bounded_real.is_positive_definite(H, np.zeros((2, 2)))
    assert not bounded_real.is_positive_definite(H, np.full((2, 2), 0.6e-8))
    assert not bounded_real.is_positive_definite(np.ones((2, 2)), np.zeros((2, 2)))
    assert not bounded_real.is_positive_definite(np.diag([1.0, np.nan]), np.zeros((2, 2)))
    assert bounded_real.is_positive_definite(np.diag([1e-300, 1e300]), np.zeros((2, 2)))


def test_a_climb_to_the_wrong_peak_is_corrected(monkeypatch: pytest.MonkeyPatch) -> None:
    """Started far from the higher of two peaks, the search finds it by the eigenvalues of the Hamiltonian."""
    system = of(0.3 * lag(0.01) + 1e4 / (S**2 + 2 * S + 1e4))
    right, start = norms.norm_hinf(system), peak_gain._start
    monkeypatch.setattr(modal, "of", lambda *args: None)
    monkeypatch.setattr(peak_gain, "_start", lambda form: (0.97, start(form)[1]))
    norm = norms.norm_hinf(system)
    assert norm.certified and norm.frequency == pytest.approx(right.frequency, rel=1e-4) and right.frequency > 90


def test_where_nothing_is_proved_the_norm_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(modal, "of", lambda *args: None)
    monkeypatch.setattr(bounded_real, "is_proof", lambda *args: False)
    norm = norms.norm_hinf(lag(0.1))
    assert not norm.certified and norm.upper == np.inf and norm.lower == pytest.approx(PEAK, rel=1e-9)
    assert "no upper bound was proved" in repr(norm)


@pytest.mark.parametrize(("norm", "size"), [(norms.norm_h2, 1e200), (norms.norm_hinf, 1e99), (norms.norm_hinf, 1e200)])
def test_numbers_beyond_a_double_are_refused(norm: Any, size: float) -> None:
    with pytest.raises(SynthError, match=r"exceed what a double holds: scale the units|choose units in which"):
        norm(([[-1.0]], [[size]], [[size]]))


def test_h2_needs_only_a_norm_that_a_double_holds() -> None:
    assert norms.norm_h2(([[-1.0]], [[1e99]], [[1e99]])).value == pytest.approx(1e198 / np.sqrt(2), rel=1e-15)
    with pytest.raises(ModelError, match="the H2 norm needs numbers that exceed what a double holds"):
        norms.norm_h2(([[-1e-250]], [[1e99]], [[1e99]]))


def test_the_lower_bound_holds_at_its_frequency() -> None:
    model = random_model(7)
    norm = norms.norm_hinf(model)
    z = np.exp(1j * norm.frequency * model.time.period_s)
    there = float(np.linalg.norm(model.response([z])[0], 2))
    assert norm.lower <= there * (1 + 1e-9) and norm.lower == pytest.approx(there, rel=2.5e-7)
    assert norm.peak == pytest.approx(there, rel=1e-9)
