"""The exosystem's poles, its exact sampling, and plants that cannot be regulated."""

import re
from collections.abc import Sequence

import flint
import mpmath  # type: ignore[import-untyped]
import numpy as np
import pytest
import scipy.integrate
import scipy.linalg

from synth.analyse.numerics import precise
from synth.analyse.structure import structure
from synth.block import Block
from synth.blocks.laws import linear_block
from synth.emit import write
from synth.errors import ModelError, SignalError
from synth.signals import Signal, dimension
from synth.statespace import StateSpace
from synth.synthesise.feedback import lqr
from synth.synthesise.regulation import internal_model
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
    model = internal_model.exosystem(frequencies)
    expected = [s for w in frequencies for s in ((1j * w, -1j * w) if w else (0j,))]
    np.testing.assert_allclose(np.sort(np.linalg.eigvals(model.Phi).imag), np.sort(np.imag(expected)), atol=1e-7)
    n = len(model.Phi)
    assert model.N.tolist() == [[0.0]] * (n - 1) + [[1.0]]
    np.testing.assert_array_equal(model.Phi[:-1], np.eye(n)[1:])
    unstable = model.Phi + 100 * np.eye(n)
    structure.require_stabilisable(unstable, model.N, tuple("abcdefg"[:n]), ("e",), Continuous())


def test_the_published_form() -> None:
    model = internal_model.exosystem((0.0, 2.0))
    np.testing.assert_array_equal(model.Phi, [[0, 1, 0], [0, 0, 1], [0, -4, 0]])
    assert not np.signbit(model.Phi[model.Phi == 0]).any()


FREQUENCIES = [(0.0,), (7.0,), (0.0, 7.0), (2.0, 7.0), (0.0, 2.0, 7.0, 31.0)]


def leapfrog_sample(c: Sequence[float], eta: np.ndarray, e: float, added: Sequence[float]) -> np.ndarray:
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
    A = np.column_stack([leapfrog_sample(c, unit, 0.0, none) for unit in units])
    return A, leapfrog_sample(c, none, 1.0, none), leapfrog_sample(c, none, 0.0, E)


def sampled_companion(
    frequencies: Sequence[float], period: float, E: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return xi over one period under constant e and x, by mpmath's exponential of the companion form in 60 digits."""
    model = internal_model.exosystem(frequencies)
    n = len(model.Phi)
    M = np.zeros((n + 2, n + 2))
    M[:n, :n], M[:n, n:] = model.Phi, np.column_stack([model.N[:, 0], E])
    with mpmath.workdps(60):
        X = np.array(mpmath.expm(mpmath.matrix(M.tolist()) * mpmath.mpf(period)).tolist(), dtype=float)
    return X[:n, :n], X[:n, n], X[:n, n + 1]


@pytest.mark.parametrize(("frequencies", "period"), [*((f, 0.05) for f in FREQUENCIES), ((0.0, 4.7), T)])
def test_the_coordinates_lead_to_the_sampled_companion_form(frequencies: tuple[float, ...], period: float) -> None:
    """xi = T eta: Phi_d T = T A, N_d = T B and E_d = T D, each row to the rounding of T and c."""
    n = len(internal_model.exosystem(frequencies).Phi)
    E = np.linspace(0.3, -0.5, n)
    leapfrog = internal_model.leapfrog(frequencies, period, E)
    A, B, D = matrices(leapfrog.c, leapfrog.E[:, 0])
    Phi, N, E_d = sampled_companion(frequencies, period, E)
    row = 1 / np.abs(leapfrog.T).max(axis=1)[:, None]
    np.testing.assert_allclose(row * (Phi @ leapfrog.T), row * (leapfrog.T @ A), rtol=0, atol=tolerances.of("double"))
    np.testing.assert_allclose(leapfrog.T @ B, N, rtol=tolerances.of("ode"))
    np.testing.assert_allclose(leapfrog.T @ D, E_d, rtol=tolerances.of("ode"), atol=tolerances.of("double"))
    assert not internal_model.leapfrog(frequencies, period).E.any()


def test_a_run_is_the_solution_of_the_continuous_form() -> None:
    """From xi = 0 under an error and an anti-windup that change at each sample."""
    period, E, rng = 0.05, np.array([0.3, -0.2, 0.5]), np.random.default_rng(3)
    model, leapfrog = internal_model.exosystem((0.0, 7.0)), internal_model.leapfrog((0.0, 7.0), period, E)
    eta, xi = np.zeros(3), np.zeros(3)
    for e, x in rng.normal(size=(40, 2)):
        drive = model.N[:, 0] * e + E * x
        eta = leapfrog_sample(leapfrog.c, eta, e, leapfrog.E[:, 0] * x)
        xi = scipy.integrate.solve_ivp(
            lambda t, v, d=drive: model.Phi @ v + d, (0, period), xi, rtol=1e-11, atol=1e-13
        ).y[:, -1]
    np.testing.assert_allclose(leapfrog.T @ eta, xi, rtol=10 * tolerances.of("ode"))


@pytest.mark.parametrize("scalar", [np.float16, np.float32, np.float64])
def test_the_poles_stay_on_the_unit_circle_whatever_c_is_rounded_to(scalar: type[np.floating]) -> None:
    leapfrog = internal_model.leapfrog((0.0, 7.0, 40.0), T)
    c = leapfrog.c.astype(scalar).astype(float)
    A = matrices(c, np.zeros(5))[0]
    poles = np.linalg.eigvals(A)
    np.testing.assert_allclose(np.abs(poles), 1, rtol=0, atol=tolerances.of("double"))
    angles = np.sort(np.angle(poles)[np.angle(poles) > 1e-6])
    np.testing.assert_allclose(angles, np.array([7.0, 40.0]) * T, rtol=float(np.finfo(scalar).eps) + 1e-10)


def test_the_companion_form_leaves_the_circle_when_it_is_rounded() -> None:
    """The reason for the leapfrog form: the companion form grows or decays in single precision."""
    Phi = sampled_companion((0.0, 4.7), T, np.zeros(3))[0].astype(np.float32).astype(float)
    assert np.abs(np.abs(np.linalg.eigvals(Phi)) - 1).max() > 1e-9


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


@pytest.mark.parametrize("counts", [{0.0: 2}, {3.0: 2}, {0.0: 3, 2.0: 1}, {2.0: 2, 0.0: 1, 5.0: 1}])
def test_multiplicities_appear_in_the_characteristic_polynomial(counts: dict[float, int]) -> None:
    model = internal_model.exosystem(counts)
    expected = np.array([1.0])
    for w, count in counts.items():
        for _ in range(count):
            expected = np.polymul(expected, [1, 0, w * w] if w else [1, 0])
    np.testing.assert_allclose(np.poly(model.Phi), expected, atol=tolerances.of("double") * np.abs(expected).max())
    assert {m.value.imag: m.multiplicity for m in model.modes} == counts


def test_an_exosystem_is_read_from_frequencies_multiplicities_and_matrices() -> None:
    ramp_and_sine = scipy.linalg.block_diag([[0, 1], [0, 0]], [[0, 3], [-3, 0]])
    by_count, by_matrix = internal_model.of({0.0: 2, 3.0: 1}), internal_model.of(ramp_and_sine)
    np.testing.assert_allclose(by_matrix.Phi, by_count.Phi, rtol=tolerances.of("double"))
    assert internal_model.of(by_count) is by_count
    np.testing.assert_array_equal(internal_model.of(np.array([0.0, 3.0])).Phi, internal_model.exosystem((0.0, 3.0)).Phi)
    with pytest.raises(SignalError, match=r"4\.7 is not an exosystem: list frequencies in rad/s, or give a matrix"):
        internal_model.of(4.7)  # type: ignore[arg-type]


def test_modes_that_decay_are_to_be_left_out() -> None:
    S = scipy.linalg.block_diag([[0, 2], [-2, 0]], [[-0.5]])
    with pytest.raises(SignalError, match=r"has the mode -0\.5 1/s, which decays .*: take it out of S"):
        internal_model.from_matrix(S)
    grows = internal_model.from_matrix([[0.5]])
    assert grows.Phi.tolist() == [[0.5]]


def distances(Phi: np.ndarray, points: Sequence[complex]) -> list[float]:
    """Return |p(z) / p'(z)| at each point for p = det(z I - Phi), in 400 bits: how far off a simple root is."""
    n = len(Phi)
    with precise.precision(400):
        p = precise.matrix(Phi).charpoly()
        distances = []
        for z in points:
            powers = [z**k for k in range(n + 1)]
            value = sum((p[k] * powers[k] for k in range(n + 1)), start=flint.acb(0))
            slope = sum((k * p[k] * powers[k - 1] for k in range(1, n + 1)), start=flint.acb(0))
            distances.append(float(abs(value / slope).mid()))
    return distances


@pytest.mark.parametrize(("frequencies", "period"), [((0.0, 4.7), T), ((0.0, 2.0, 7.0, 31.0), 0.02)])
def test_the_sampled_modes_lie_on_the_unit_circle_at_the_frequencies(
    frequencies: tuple[float, ...], period: float
) -> None:
    """To a few units of the last place, though they lie close together; Euler's rule misses by some (w T)^2 / 2."""
    model = internal_model.in_time(frequencies, Discrete(period))
    with precise.precision(400):
        points = [(flint.acb(0, w) * flint.arb(period)).exp() for w in frequencies]
    assert max(distances(model.Phi, points)) < 10 * np.finfo(float).eps
    Phi, N, _ = sampled_companion(frequencies, period, np.zeros(len(model.Phi)))
    np.testing.assert_allclose(model.Phi, Phi, rtol=tolerances.of("last_bit"))
    np.testing.assert_allclose(model.N[:, 0], N, rtol=tolerances.of("last_bit"))
    euler = np.eye(len(Phi)) + internal_model.exosystem(frequencies).Phi * period
    assert max(distances(euler, points)) > 0.2 * (max(frequencies) * period) ** 2


def test_each_error_has_a_copy_with_names_and_units() -> None:
    units = {"gap": "m", "tilt": "rad"}
    two = StateSpace(-np.eye(2), np.eye(2), np.eye(2), np.zeros((2, 2)), ("a", "b"), ("f", "g"), ("gap", "tilt"),
                     Continuous(), units)  # fmt: skip
    whole, one = internal_model.augmented(two, (0.0, 2.0)), internal_model.exosystem((0.0, 2.0))
    assert whole.states[2:] == ("xi1_gap", "xi2_gap", "xi3_gap", "xi1_tilt", "xi2_tilt", "xi3_tilt")
    assert [whole.unit(x) for x in whole.states[2:5]] == ["m s^3", "m s^2", "m s"]
    assert whole.unit("xi1_tilt") == "rad s^3"
    np.testing.assert_array_equal(whole.A[2:5, 2:5], one.Phi)
    np.testing.assert_array_equal(whole.A[5:, 5:], one.Phi)
    assert not whole.A[2:5, 5:].any()
    np.testing.assert_array_equal(whole.A[2:, :2], scipy.linalg.block_diag(one.N, one.N))


@pytest.mark.parametrize("time", [Continuous(), Discrete(T)])
def test_an_integrator_has_the_unit_of_an_integral_in_either_time(time: Continuous | Discrete) -> None:
    model = internal_model.in_time([0.0], time)
    unit = model.units(["x"], {"x": "m"})["xi1"]
    axis = StateSpace([[0.5]], [[1]], [[1]], [[0]], ("p",), ("f",), ("x",), time, {"x": "m"})
    assert unit == lqr.with_integrators(axis, ["x"]).unit("x_integral") == "m s"
    assert model.N[0, 0] == (1.0 if time == Continuous() else T)  # the unit s of the second stands in N


def test_the_recursion_is_of_one_unit_in_each_row() -> None:
    """Scale the unit of time by 1000: each entry of the sampled model scales as its states' units say."""
    slow, fast = (internal_model.in_time([0.0, w], Discrete(t)) for w, t in ((7.0, 0.05), (7e3, 0.05e-3)))
    powers = np.array([dict(dimension(u)).get("s", 0) for u in slow.units(["x"], {"x": "m"}).values()], dtype=float)
    assert powers.tolist() == [3, 2, 1]
    size = 1e-3**powers
    np.testing.assert_allclose(fast.Phi, slow.Phi * size[:, None] / size, rtol=tolerances.of("double"))
    np.testing.assert_allclose(fast.N, slow.N * size[:, None], rtol=tolerances.of("double"))


def copy(frequencies: Sequence[float]) -> Block:
    """The sampled model as a Block, its states in the units that it gives."""
    model = internal_model.in_time(frequencies, Discrete(T))
    names, units, n = model.state_names(["x"]), model.units(["x"], {"x": "m"}), len(model.Phi)
    system = StateSpace(model.Phi, model.N, np.eye(n), np.zeros((n, 1)), names, ("e",), names, model.time)
    states = [Signal(name, units[name], -1, 1) for name in names]
    return linear_block.block(
        "copy", system, inputs=[Signal("e", "m", -1, 1)], outputs=states, states=states, tag="(14)"
    )


def test_the_c_shows_the_period_in_s() -> None:
    text = write.emit(copy([0.0]), np.float32).files["copy.c"]
    assert re.search(r"next_xi1_from_e = 0\.001f; +/\* s \*/", text)


def test_every_constant_of_the_recursion_is_in_a_power_of_s() -> None:
    """That of its row over that of its column."""
    power = {"xi1": 3, "xi2": 2, "xi3": 1, "e": 0}
    for c in copy([0.0, 7.0]).constants:
        row, column = c.name.removeprefix("next_").split("_from_")
        apart = power[row] - power[column]
        assert dict(dimension(c.unit)) == ({"s": apart} if apart else {})


def test_a_sampled_plant_gets_the_sampled_model() -> None:
    whole = internal_model.augmented(plant([1, 0, 0], Discrete(T)), (0.0, 2.0))
    model = internal_model.in_time((0.0, 2.0), Discrete(T))
    np.testing.assert_array_equal(whole.A[3:, 3:], model.Phi)
    np.testing.assert_array_equal(whole.A[3:, :1], model.N)
    assert whole.time == Discrete(T)
    assert "Internal model of order 3 for each error, discrete time of 0.001 s" in repr(model)
