"""The exosystem's poles, its exact sampling, and plants that cannot be regulated."""

import numpy as np
import pytest
import scipy.integrate

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


def test_sampling_is_the_solution_over_one_period() -> None:
    period, E = 0.05, np.array([0.3, -0.2, 0.5])
    c, d = internal_model.exosystem((0.0, 7.0)), internal_model.discrete((0.0, 7.0), period, E)
    x0, e, excess = np.array([0.4, -1.0, 2.0]), 0.7, -1.3
    solved = scipy.integrate.solve_ivp(
        lambda t, x: c.Phi @ x + c.N[:, 0] * e + E * excess, (0, period), x0, rtol=1e-11, atol=1e-13
    ).y[:, -1]
    ours = d.Phi @ x0 + d.N[:, 0] * e + d.E[:, 0] * excess
    np.testing.assert_allclose(ours, solved, rtol=tolerances.of("ode"))
    assert not internal_model.discrete((0.0, 7.0), period).E.any()


def test_the_sampled_poles_lie_on_the_unit_circle() -> None:
    poles = np.linalg.eigvals(internal_model.discrete((0.0, 7.0), T).Phi)
    wanted = np.exp(1j * np.array([-7.0, 0, 7.0]) * T)
    np.testing.assert_allclose(poles[np.argsort(np.angle(poles))], wanted, atol=tolerances.of("last_bit") * 1e6)


def test_the_sampled_model_has_its_limits() -> None:
    with pytest.raises(SignalError, match=r"frequency 3200.0 rad/s: it must lie below 3141\.59 rad/s"):
        internal_model.discrete((0.0, 3200.0), T)
    with pytest.raises(SignalError, match="has 2 entries, the internal model 3 states: give 3"):
        internal_model.discrete((0.0, 7.0), T, [1.0, 2.0])
    with pytest.raises(TimingError, match="finite and positive"):
        internal_model.discrete((0.0, 7.0), 0.0)


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
