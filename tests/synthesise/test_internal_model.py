"""The exosystem's poles, its exact sampling, and plants that cannot be regulated."""

from collections.abc import Sequence

import numpy as np
import pytest
import scipy.integrate
import scipy.linalg

from synth.analyse import structure
from synth.errors import ModelError, SignalError, TimingError
from synth.statespace import StateSpace
from synth.synthesise import internal_model
from synth.timing import Continuous, Discrete
from tests import tolerances

T = 1e-3


def plant(C: object, time: Continuous | Discrete | None = None) -> StateSpace:
    """A triple lag 1 / (s + 1)^3 in companion form."""
    A, B, C = [[0, 1, 0], [0, 0, 1], [-1, -3, -3]], [[0], [0], [1]], np.atleast_2d(np.asarray(C, float))
    outputs = tuple(f"y{i}" for i in range(len(C)))
    return StateSpace(A, B, C, np.zeros((len(C), 1)), ("a", "b", "c"), ("force",), outputs, time or Continuous())


@pytest.mark.parametrize("frequencies", [(0.0,), (3.0,), (0.0, 2.0), (1.0, 2.0, 5.0), (0.0, 4.7, 9.4)])
def test_the_poles_are_the_frequencies_and_the_input_reaches_all(frequencies: tuple[float, ...]) -> None:
    found = internal_model.exosystem(frequencies)
    wanted = [s for w in frequencies for s in ((1j * w, -1j * w) if w else (0j,))]
    np.testing.assert_allclose(np.sort(np.linalg.eigvals(found.Phi).imag), np.sort(np.imag(wanted)), atol=1e-7)
    n = len(found.Phi)
    assert found.N.tolist() == [[0.0]] * (n - 1) + [[1.0]]
    np.testing.assert_array_equal(found.Phi[:-1], np.eye(n)[1:])
    unstable = found.Phi + 100 * np.eye(n)
    structure.require_stabilisable(unstable, found.N, tuple("abcdefg"[:n]), ("e",), Continuous())


def test_the_published_form() -> None:
    found = internal_model.exosystem((0.0, 2.0))
    np.testing.assert_array_equal(found.Phi, [[0, 1, 0], [0, 0, 1], [0, -4, 0]])
    assert not np.signbit(found.Phi[found.Phi == 0]).any()


@pytest.mark.parametrize("frequencies", [(), (-1.0,), (1.0, 1.0), (0.0, 0.0), (np.inf,), (np.nan,)])
def test_frequencies_that_make_no_exosystem_are_refused(frequencies: tuple[float, ...]) -> None:
    with pytest.raises(SignalError, match="distinct finite numbers >= 0"):
        internal_model.exosystem(frequencies)


FREQUENCIES = [(0.0,), (7.0,), (0.0, 7.0), (2.0, 7.0), (0.0, 2.0, 7.0, 31.0)]


def turned(c: Sequence[float], eta: np.ndarray, e: float, added: Sequence[float]) -> np.ndarray:
    """Return one sample of the leapfrog form, written out in its order of computation."""
    first, after = len(eta) % 2, np.array(eta, dtype=float)
    if first:
        after[0] = eta[0] + e + added[0]
    for k, step in enumerate(c):
        p, q = first + 2 * k, first + 2 * k + 1
        after[p] = eta[p] + step * eta[q] + added[p]
        after[q] = eta[q] - after[p] + e + added[q]
    return after


def matrices(c: Sequence[float], E: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the leapfrog form as eta' = A eta + B e + D x, column by column."""
    n = len(E)
    none, units = np.zeros(n), np.eye(n)
    A = np.column_stack([turned(c, unit, 0.0, none) for unit in units])
    return A, turned(c, none, 1.0, none), turned(c, none, 0.0, E)


def held(frequencies: Sequence[float], period: float, E: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return xi over one period under constant e and x, by SciPy's exponential of the companion form."""
    model = internal_model.exosystem(frequencies)
    n = len(model.Phi)
    M = np.zeros((n + 2, n + 2))
    M[:n, :n], M[:n, n:] = model.Phi, np.column_stack([model.N[:, 0], E])
    X = scipy.linalg.expm(M * period)
    return X[:n, :n], X[:n, n], X[:n, n + 1]


@pytest.mark.parametrize(("frequencies", "period"), [*((f, 0.05) for f in FREQUENCIES), ((0.0, 4.7), T)])
def test_the_coordinates_lead_to_the_sampled_companion_form(frequencies: tuple[float, ...], period: float) -> None:
    """xi = T eta: Phi_d T = T A, N_d = T B and E_d = T D, each row to the rounding of SciPy's exponential."""
    n = len(internal_model.exosystem(frequencies).Phi)
    E = np.linspace(0.3, -0.5, n)
    found = internal_model.leapfrog(frequencies, period, E)
    A, B, D = matrices(found.c, found.E[:, 0])
    Phi, N, E_d = held(frequencies, period, E)
    row = 1 / np.abs(found.T).max(axis=1)[:, None]
    np.testing.assert_allclose(row * (Phi @ found.T), row * (found.T @ A), rtol=0, atol=tolerances.of("double"))
    np.testing.assert_allclose(found.T @ B, N, rtol=tolerances.of("ode"))
    np.testing.assert_allclose(found.T @ D, E_d, rtol=tolerances.of("ode"), atol=tolerances.of("double"))
    assert not internal_model.leapfrog(frequencies, period).E.any()


def test_a_run_is_the_solution_of_the_continuous_form() -> None:
    """From xi = 0 under an error and an anti-windup that change at each sample."""
    period, E, rng = 0.05, np.array([0.3, -0.2, 0.5]), np.random.default_rng(3)
    model, found = internal_model.exosystem((0.0, 7.0)), internal_model.leapfrog((0.0, 7.0), period, E)
    eta, xi = np.zeros(3), np.zeros(3)
    for e, x in rng.normal(size=(40, 2)):
        drive = model.N[:, 0] * e + E * x
        eta = turned(found.c, eta, e, found.E[:, 0] * x)
        xi = scipy.integrate.solve_ivp(
            lambda t, v, d=drive: model.Phi @ v + d, (0, period), xi, rtol=1e-11, atol=1e-13
        ).y[:, -1]
    np.testing.assert_allclose(found.T @ eta, xi, rtol=10 * tolerances.of("ode"))


@pytest.mark.parametrize("scalar", [np.float16, np.float32, np.float64])
def test_the_poles_stay_on_the_unit_circle_whatever_c_is_rounded_to(scalar: type[np.floating]) -> None:
    found = internal_model.leapfrog((0.0, 7.0, 40.0), T)
    c = found.c.astype(scalar).astype(float)
    A = matrices(c, np.zeros(5))[0]
    poles = np.linalg.eigvals(A)
    np.testing.assert_allclose(np.abs(poles), 1, rtol=0, atol=tolerances.of("double"))
    angles = np.sort(np.angle(poles)[np.angle(poles) > 1e-6])
    np.testing.assert_allclose(angles, np.array([7.0, 40.0]) * T, rtol=float(np.finfo(scalar).eps) + 1e-10)


def test_the_companion_form_leaves_the_circle_when_it_is_rounded() -> None:
    """What the leapfrog form is for: the same model sampled as it stands grows or decays in single precision."""
    Phi = held((0.0, 4.7), T, np.zeros(3))[0].astype(np.float32).astype(float)
    assert np.abs(np.abs(np.linalg.eigvals(Phi)) - 1).max() > 1e-9


def test_the_sampled_model_has_its_limits() -> None:
    with pytest.raises(SignalError, match=r"frequency 3200.0 rad/s: it must lie below 3141\.59 rad/s"):
        internal_model.leapfrog((0.0, 3200.0), T)
    with pytest.raises(SignalError, match="has 2 entries, the internal model 3 states: give 3"):
        internal_model.leapfrog((0.0, 7.0), T, [1.0, 2.0])
    with pytest.raises(TimingError, match="finite and positive"):
        internal_model.leapfrog((0.0, 7.0), 0.0)
    with pytest.raises(SignalError, match="distinct finite numbers >= 0"):
        internal_model.leapfrog((7.0, 7.0), T)


def test_the_augmented_plant_is_driven_by_the_output() -> None:
    whole = internal_model.augmented(plant([1, 0, 0]), (0.0, 2.0))
    s = 1j * np.array([0.3, 1.0, 5.0])
    response = whole.response(s)[:, :, 0]
    lag = 1 / (s + 1) ** 3
    assert whole.states == whole.outputs == ("a", "b", "c", "xi1", "xi2", "xi3")
    np.testing.assert_allclose(response[:, 0], lag, rtol=tolerances.of("double"))
    np.testing.assert_allclose(response[:, 3], lag / (s * (s * s + 4)), rtol=tolerances.of("double"))
    structure.require_stabilisable(whole.A, whole.B, whole.states, whole.inputs, whole.time)


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
def test_a_transmission_zero_at_a_frequency_is_refused_by_name(scale: float) -> None:
    notched = plant([4 * scale, 0, scale])  # s^2 + 4
    with pytest.raises(ModelError, match="from force to y0 has a transmission zero at 2 rad/s, a frequency of the"):
        internal_model.augmented(notched, (0.0, 2.0))
    whole = internal_model.augmented(notched, (0.0, 2.001))
    structure.require_stabilisable(whole.A, whole.B, whole.states, whole.inputs, whole.time)
    with pytest.raises(ModelError, match="zero at 0 rad/s"):
        internal_model.augmented(plant([0, scale, 0]), (0.0, 2.0))


def test_other_plants_are_refused() -> None:
    with pytest.raises(SignalError, match="outputs y0, y1: give the one whose error is regulated"):
        internal_model.augmented(plant(np.eye(3)[:2]), (0.0,))
    with pytest.raises(TimingError, match="continuous time meets discrete time"):
        internal_model.augmented(plant([1, 0, 0], Discrete(T)), (0.0,))
