"""What rounding of its numbers may do to a loop is a bound, and is reached within a factor."""

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse import perturbation, rational
from synth.errors import ModelError
from synth.statespace import of
from synth.timing import Discrete


@settings(derandomize=True, max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.booleans())
def test_no_rounding_of_the_numbers_given_moves_the_loop_by_more_than_told(seed: int, matrices: bool) -> None:
    """Every number is moved by up to half a unit in its last place, magnified so that rounding does not hide it."""
    rng = np.random.default_rng(seed)
    poles, T, magnified = -rng.uniform(1, 9, 3), 1e-2, 2.0**20
    b, a = rng.uniform(0.5, 1, 2), np.poly(np.exp(poles * T))
    moved = [v * (1 + magnified * perturbation.EPS * rng.uniform(-1, 1, len(v))) for v in (b, a)]
    system, other = control.tf(b, a, T), control.tf(*moved, T)
    if matrices:
        model = of(system)
        exact = (model.A, model.B, model.C, model.D)
        parts = [M * (1 + magnified * perturbation.EPS * rng.uniform(-1, 1, M.shape)) for M in exact]
        system, other = model, of((*parts, Discrete(T)))
    w = 30.0
    z = np.exp(1j * w * T)
    L, L2 = (complex(of(v).response(z)[0, 0, 0]) for v in (system, other))
    bound = perturbation.of_rational(rational.of_system(system), w).of_loop
    assert abs(L2 / L - 1) < magnified * bound * 1.1
    assert perturbation.of_rational(rational.of_system(system), w).of_closed > 0


def test_the_bound_of_a_transfer_function_is_reached_by_rounding_its_worst_way() -> None:
    """At z = 1 all coefficients of a denominator move it alike when each moves the way of its sign."""
    T = 1e-3
    a = np.poly(np.exp(np.array([-1.0, -2.0, -5.0]) * T))
    bound = perturbation.of_rational(rational.of_system(control.tf([1.0], a, T)), 0.0)
    moved = a * (1 - 2.0**-40 * np.sign(a))
    reached = abs(a.sum() / moved.sum() - 1)
    assert reached / (2.0**-40 / perturbation.EPS) == pytest.approx(bound.of_loop, rel=0.05)


def test_a_loop_whose_stability_rounding_hides_is_refused_and_a_hidden_integrator_is_not_stable() -> None:
    d1, d2 = 2.0**-30 + 2.0**-52, 2.0**-30  # (z - 1)^2 + d1 z - d2 is 2^-52 at z = 1, and its coefficients reach 2
    with pytest.raises(ModelError, match=r"hides whether the closed loop is stable.*loop\.sampled"):
        perturbation.is_stable(rational.of_system(control.tf([d1, -d2], [1.0, -2.0, 1.0], 1e-3)))
    hidden = of((np.diag([-1.0, 0.0]), [[1.0], [0.0]], [[1.0, 1.0]], [[0.0]]))
    assert not perturbation.is_stable(rational.of_system(hidden))
    slow = of(([[-1e-9, 0.0], [0.0, -1e9]], [[1e-9], [1e9]], [[1.0, 0.5]], [[0.0]]))
    assert perturbation.is_stable(rational.of_system(slow))
