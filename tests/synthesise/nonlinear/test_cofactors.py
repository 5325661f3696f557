"""Solutions by cofactors against NumPy's, zeros that vanish, and products that stay few."""

import casadi as ca
import numpy as np
import pytest

from synth.synthesise.nonlinear import feedback_linearisation
from tests import tolerances


@pytest.mark.parametrize("n", [1, 2, 3, 5, 7])
def test_solutions_and_determinants(n: int) -> None:
    rng = np.random.default_rng(n)
    M, b = ca.SX.sym("M", n, n), ca.SX.sym("b", n, 2)
    solution = feedback_linearisation.solve(M, b)
    f = ca.Function("f", [M, b], [solution.value, solution.determinant])
    for _ in range(5):
        values = rng.normal(size=(n, n)) + 3 * np.eye(n)[rng.permutation(n)], rng.normal(size=(n, 2))
        solved, determinant = f(*values)
        np.testing.assert_allclose(solved.full(), np.linalg.solve(*values), rtol=1e-10, atol=tolerances.of("double"))
        np.testing.assert_allclose(float(determinant), np.linalg.det(values[0]), rtol=1e-10)
    assert f.n_instructions() < 8 * n**2 * 2**n + 40


def test_zeros_of_the_matrix_vanish_from_the_solution() -> None:
    M = ca.SX(3, 3)
    M[0, 0], M[1, 1], M[2, 2], M[0, 2] = (ca.SX.sym(name) for name in "abcd")
    b = ca.SX.sym("b", 3)
    solution = feedback_linearisation.solve(M, b).value
    assert not ca.depends_on(solution[1], ca.vertcat(b[0], b[2])) and not ca.depends_on(solution[2], b[:2])
    assert ca.depends_on(solution[0], b[2]) and not ca.depends_on(solution[0], b[1])
