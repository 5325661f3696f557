"""Lyapunov and Stein equations in balls: they hold the solution that was chosen, and a ball that is off does not."""

import flint
import numpy as np
import pytest
import scipy.linalg

from synth.analyse.numerics import precise
from synth.synthesise.riccati import exact
from synth.synthesise.riccati.equation import Bilinear
from tests import tolerances


def stable(seed: int, continuous: bool) -> np.ndarray:
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(int(rng.integers(1, 7)),) * 2)
    s = np.linalg.eigvals(A)
    return A - (s.real.max() + 1e-3) * np.eye(len(A)) if continuous else A * 0.999 / np.abs(s).max()


@pytest.mark.parametrize("continuous", [True, False])
@pytest.mark.parametrize("seed", range(6))
def test_the_balls_hold_the_solution(continuous: bool, seed: int) -> None:
    A = stable(seed, continuous)
    C = np.random.default_rng(seed).integers(-9, 9, size=A.shape)
    Y = precise.matrix(C @ C.T + np.eye(len(A)))
    with precise.precision():
        balls = precise.matrix(A)
        W = exact.operator(balls, Y, continuous) * -1
        enclosed = exact.solution(balls, W.mid(), continuous)
        np.testing.assert_array_equal(precise.doubles(enclosed), precise.rounded(Y))
        assert enclosed.contains(Y) and not enclosed.contains(Y * (1 + flint.arb(2) ** -150))
        solver = scipy.linalg.solve_continuous_lyapunov if continuous else scipy.linalg.solve_discrete_lyapunov
        theirs = solver(A.T, precise.rounded(W) * (-1 if continuous else 1))
    np.testing.assert_allclose(precise.rounded(enclosed), theirs, atol=tolerances.of("lyapunov") * np.abs(theirs).max())


@pytest.mark.parametrize("continuous", [True, False])
@pytest.mark.parametrize("off", [1e-40, 1e-10, 1e-2])
def test_a_centre_that_is_off_has_a_radius_that_covers_it(continuous: bool, off: float) -> None:
    A = stable(3, continuous)
    with precise.precision():
        balls, Y = precise.matrix(A), precise.matrix(np.eye(len(A)))
        W = exact.operator(balls, Y, continuous) * -1
        decay = exact.stable_map(balls, Bilinear(1.0, continuous))
        H = decay.majorant(np.ones(len(A)))
        away = Y + precise.matrix(np.ones(A.shape)) * off
        defect = exact.frobenius(exact.operator(balls, away, continuous) + W)
        assert exact.balls(away, H, defect).contains(Y)
        assert not exact.balls(away, H, defect * flint.arb(2) ** -20).contains(Y)


@pytest.mark.parametrize("continuous", [True, False])
def test_a_majorant_that_is_too_small_is_detected(continuous: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    A, gramian = stable(3, continuous), exact.StableMap.gramian
    with precise.precision():
        decay = exact.stable_map(precise.matrix(A), Bilinear(1.0, continuous))
        for factor, is_proved in ((1.0, True), (0.4, False)):
            monkeypatch.setattr(exact.StableMap, "gramian", lambda s, W, f=factor: gramian(s, W) * f)
            assert (decay.majorant(np.ones(len(A))) is not None) == is_proved


@pytest.mark.parametrize(("A", "continuous"), [(0.0, True), (0.5, True), (1.0, False), (-1.5, False)])
def test_what_is_not_stable_has_no_solution(A: float, continuous: bool) -> None:
    with precise.precision(), pytest.raises(ZeroDivisionError):
        exact.solution(flint.arb_mat([[A]]), flint.arb_mat([[1]]), continuous)
