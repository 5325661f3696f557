"""The perturbation bound covers rounding of the coefficients, and is attained within a factor."""

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse.loops import disk, zpk
from synth.errors import ModelError
from synth.statespace import of
from synth.timing import Discrete


@settings(derandomize=True, max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.booleans())
def test_no_rounding_of_the_coefficients_changes_the_loop_by_more_than_the_bound(seed: int, matrices: bool) -> None:
    """Every coefficient changes by up to half a unit in the last place, magnified above the rounding errors."""
    rng = np.random.default_rng(seed)
    poles, T, magnified = -rng.uniform(1, 9, 3), 1e-2, 2.0**20
    b, a = rng.uniform(0.5, 1, 2), np.poly(np.exp(poles * T))
    moved = [v * (1 + magnified * disk.EPS * rng.uniform(-1, 1, len(v))) for v in (b, a)]
    system, other = control.tf(b, a, T), control.tf(*moved, T)
    if matrices:
        model = of(system)
        exact = (model.A, model.B, model.C, model.D)
        parts = [M * (1 + magnified * disk.EPS * rng.uniform(-1, 1, M.shape)) for M in exact]
        system, other = model, of((*parts, Discrete(T)))
    w = 30.0
    z = np.exp(1j * w * T)
    L, L2 = (complex(of(v).response(z)[0, 0, 0]) for v in (system, other))
    bound = disk.of_rational(zpk.of_system(system), w).of_loop
    assert abs(L2 / L - 1) < magnified * bound * 1.1
    assert disk.of_rational(zpk.of_system(system), w).of_closed > 0


def test_the_worst_rounding_attains_the_bound_of_a_transfer_function() -> None:
    """At z = 1 the changes of all coefficients of a denominator add up if each has the sign of its coefficient."""
    T = 1e-3
    a = np.poly(np.exp(np.array([-1.0, -2.0, -5.0]) * T))
    bound = disk.of_rational(zpk.of_system(control.tf([1.0], a, T)), 0.0)
    moved = a * (1 - 2.0**-40 * np.sign(a))
    reached = abs(a.sum() / moved.sum() - 1)
    assert reached / (2.0**-40 / disk.EPS) == pytest.approx(bound.of_loop, rel=0.05)


def test_undecidable_stability_is_refused_and_a_cancelled_integrator_is_not_stable() -> None:
    d1, d2 = 2.0**-30 + 2.0**-52, 2.0**-30  # (z - 1)^2 + d1 z - d2 is 2^-52 at z = 1, and its coefficients reach 2
    with pytest.raises(ModelError, match=r"hides whether the closed loop is stable.*loop\.sampled"):
        disk.is_stable(zpk.of_system(control.tf([d1, -d2], [1.0, -2.0, 1.0], 1e-3)))
    hidden = of((np.diag([-1.0, 0.0]), [[1.0], [0.0]], [[1.0, 1.0]], [[0.0]]))
    assert not disk.is_stable(zpk.of_system(hidden))
    slow = of(([[-1e-9, 0.0], [0.0, -1e9]], [[1e-9], [1e9]], [[1.0, 0.5]], [[0.0]]))
    assert disk.is_stable(zpk.of_system(slow))
