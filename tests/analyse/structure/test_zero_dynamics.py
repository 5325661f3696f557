"""Zero dynamics against closed forms, SLICOT's transmission zeros and planted defects that the pencil must detect."""

from collections.abc import Sequence

import control
import numpy as np
import pytest

from synth.analyse import operating_points
from synth.analyse.structure import relative_degree, zero_dynamics
from synth.analyse.structure.zero_dynamics import ZeroDynamics
from synth.errors import ModelError
from synth.plant import Plant
from synth.statespace import StateSpace
from synth.timing import Continuous
from tests import textbook_plants, tolerances

ROOT = tolerances.of("multiple_root")
FREE = {"aircraft": ["T"], "two_masses": [], "flexible_joint": [], "ball_and_beam": []}


def of_plant(plant: Plant, *outputs: str) -> ZeroDynamics:
    degree = relative_degree.of_plant(plant, outputs or None)
    return zero_dynamics.at_point(plant, degree, operating_points.trim(plant, {}, FREE[plant.name]))


def values(dynamics: ZeroDynamics) -> list[complex]:
    return [mode.value for mode in dynamics.modes]


def sorted_values(values: Sequence[complex]) -> np.ndarray:
    """Sort by real parts to seven digits, then by imaginary parts."""
    return np.array(sorted(values, key=lambda v: (round(v.real, 7), v.imag)))


@pytest.mark.parametrize("eps", [0.04, 0.1, 2.0])
def test_the_aircraft_falls_over_while_it_hovers(eps: float) -> None:
    """theta'' = sin theta / eps: a saddle at +-eps^-1/2, in the roll angle and its rate."""
    dynamics = of_plant(textbook_plants.aircraft(eps))
    np.testing.assert_allclose(values(dynamics), [-(eps**-0.5), eps**-0.5], rtol=1e-10)
    assert dynamics.verdict == "not minimum phase" and dynamics.is_consistent
    assert set(dynamics.modes[1].states) == {"theta", "w"}
    assert "a mode grows while" in repr(dynamics)


def test_negative_eps_swings() -> None:
    dynamics = of_plant(textbook_plants.aircraft(-0.25))
    np.testing.assert_allclose(np.sort_complex(values(dynamics)), [-2j, 2j], atol=1e-10)
    assert dynamics.verdict == "not hyperbolic" and "does not decide" in repr(dynamics)


def test_two_masses() -> None:
    """With x2 held, m1 swings on the spring: m1 s^2 + d s + k = 0; with the output x1 there are no zero dynamics."""
    dynamics = of_plant(textbook_plants.two_masses(0.7), "y2")
    np.testing.assert_allclose(values(dynamics), np.sort_complex(np.roots([2.0, 0.7, 50.0])), rtol=1e-10)
    assert dynamics.verdict == "minimum phase" and dynamics.is_consistent and dynamics.modes[0].states == ("v1", "x1")
    assert of_plant(textbook_plants.two_masses(), "y2").verdict == "not hyperbolic"
    assert of_plant(textbook_plants.two_masses(), "y1").verdict == "none"
    assert "none, the degree is full" in repr(of_plant(textbook_plants.flexible_joint()))


def random_model(n: int, p: int, degrees: tuple[int, ...], seed: int) -> StateSpace:
    """Random chains of the given lengths, fed by random inputs and coupled to random remaining states."""
    rng = np.random.default_rng(seed)
    A, B, C = rng.normal(size=(n, n)), rng.normal(size=(n, p)), np.zeros((p, n))
    row = 0
    for i, r in enumerate(degrees):
        C[i, row] = 1.0
        for k in range(r - 1):
            A[row + k] = 0.0
            A[row + k, row + k + 1] = 1.0
            B[row + k] = 0.0
        row += r
    Q = np.linalg.qr(rng.normal(size=(n, n)))[0]
    names = tuple(f"x{k}" for k in range(n)), tuple(f"u{k}" for k in range(p)), tuple(f"y{k}" for k in range(p))
    return StateSpace(Q @ A @ Q.T, Q @ B, C @ Q.T, np.zeros((p, p)), *names, Continuous())


CASES = [(4, 1, (1,)), (5, 1, (3,)), (6, 2, (2, 1)), (8, 2, (2, 3)), (9, 3, (1, 2, 2)), (10, 3, (3, 2, 2))]


@pytest.mark.parametrize(("n", "p", "degrees"), CASES)
@pytest.mark.parametrize("seed", range(4))
def test_random_models_have_slicots_zeros(n: int, p: int, degrees: tuple[int, ...], seed: int) -> None:
    model = random_model(n, p, degrees, seed)
    dynamics = zero_dynamics.of_linear(model, degrees)
    expected = control.zeros(model.to_control())
    assert dynamics.order == len(expected) == n - sum(degrees)
    np.testing.assert_allclose(sorted_values(values(dynamics)), sorted_values(expected), rtol=ROOT, atol=ROOT)
    assert dynamics.is_consistent
    assert dynamics.verdict == ("minimum phase" if expected.real.max() < 0 else "not minimum phase")


def test_direct_feedthrough_counts_as_degree_0() -> None:
    """y = x + 2 u, x' = -x + u: held at 0, u = -x / 2 and x' = -1.5 x."""
    dynamics = zero_dynamics.of_linear(([[-1.0]], [[1.0]], [[1.0]], [[2.0]]), (0,))
    assert (
        values(dynamics) == [pytest.approx(-1.5)]
        and dynamics.zeros[0] == pytest.approx(-1.5)
        and dynamics.is_consistent
    )


@pytest.mark.parametrize(("zeros", "C", "degree"), [([2], [-2, 1, 0], 2), ([-1, 1], [-1, 0, 1], 1)])
def test_a_degree_above_that_of_the_output_is_refused(zeros: list[float], C: list[float], degree: int) -> None:
    """Chains of integrators, whose transfer function is C's polynomial over s^3: its zeros are the roots."""
    model = np.diag([1.0, 1.0], 1), [[0.0], [0.0], [1.0]], [C], [[0.0]]
    np.testing.assert_allclose(values(zero_dynamics.of_linear(model, [degree])), zeros, atol=1e-12)
    with pytest.raises(ModelError, match=f"degree of 'y1' is {degree}, but 3 was given: 'u1' acts on its derivative"):
        zero_dynamics.of_linear(model, [3])


@pytest.mark.parametrize(
    ("slow", "verdict"), [(10.0, "not minimum phase"), (-10.0, "minimum phase"), (0.0, "not hyperbolic")]
)
def test_a_slow_zero_beside_a_fast_one_has_its_own_rounding(slow: float, verdict: str) -> None:
    s = control.tf("s")
    dynamics = zero_dynamics.of_linear((s - slow) * (s + 2e7) / ((s + 1) * (s + 2) * (s + 3)), [1])
    np.testing.assert_allclose(values(dynamics), [-2e7, slow], rtol=1e-6, atol=1e-9)
    assert dynamics.verdict == verdict


def test_states_are_ranked_in_half_ranges() -> None:
    """A mode's states in other units are the same states when their ranges go with them."""
    model = random_model(6, 2, (2, 1), 3)
    T = np.diag(10.0 ** np.arange(-3, 3))
    scaled = StateSpace(
        T @ model.A @ np.linalg.inv(T), T @ model.B, model.C @ np.linalg.inv(T), model.D,
        model.states, model.inputs, model.outputs, Continuous(),
    )  # fmt: skip
    here = zero_dynamics.of_linear(model, (2, 1))
    there = zero_dynamics.of_linear(scaled, (2, 1), dict(zip(model.states, np.diag(T), strict=True)))
    assert [m.states for m in here.modes] == [m.states for m in there.modes]
    np.testing.assert_allclose(values(there), values(here), rtol=1e-9)
