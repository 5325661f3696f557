"""Servo regulators: errors die out, in other plants too, with and without an observer; what cannot be is refused."""

from dataclasses import replace

import control
import numpy as np
import pytest
import scipy.linalg
import scipy.signal
from hypothesis import given, settings
from hypothesis import strategies as st

from synth import statespace
from synth.analyse import discretise
from synth.errors import ModelError, SignalError, TimingError
from synth.statespace import StateSpace
from synth.synthesise.observers import kalman
from synth.synthesise.regulation import anti_windup, internal_model, servo
from synth.timing import Continuous, Discrete
from tests import tolerances
from tests.synthesise.observers.models import full_order_observer

OMEGA0 = 1.5 * np.pi
T = 0.01
UNITS = {"gap": "m", "speed": "m/s", "force": "m/s^2"}
DOUBLE = StateSpace(
    [[0, 1], [0, 0]], [[0], [1]], [[1, 0]], [[0]], ("gap", "speed"), ("force",), ("gap",), Continuous(), UNITS
)
WEIGHTS = np.diag([1500, 1500, 4.5e8, 2.25e6, 2.25e6])  # F: the x and z axes


def random_plant(seed: int) -> StateSpace:
    """Return a random plant with 1 or 2 outputs, as many inputs or one more, a disturbance and a direct term."""
    rng = np.random.default_rng(seed)
    p = int(rng.integers(1, 3))
    n, m = int(rng.integers(p, p + 3)), p + int(rng.integers(0, 2))
    names = [tuple(f"{letter}{i}" for i in range(k)) for letter, k in (("x", n), ("u", m), ("y", p))]
    D = np.hstack([0.3 * rng.normal(size=(p, m)) * rng.integers(0, 2), rng.normal(size=(p, 1))])
    matrices = rng.normal(size=(n, n)), rng.normal(size=(n, m + 1)), rng.normal(size=(p, n)), D
    return StateSpace(*matrices, names[0], (*names[1], "draught"), names[2], Continuous())


def random_servo(seed: int, exosystem: internal_model.Exosystem, period: float | None) -> servo.Servo:
    plant = random_plant(seed)
    controls = plant.inputs[:-1]
    order = len(plant.A) + len(plant.outputs) * len(internal_model.of(exosystem).Phi)
    weights = (np.eye(order), np.eye(len(controls)))
    if period is None:
        return servo.lqr(plant, exosystem, *weights, controls=controls)
    return servo.lqrd(plant, exosystem, *weights, period, controls=controls)


EXOSYSTEMS = [(0.0,), {0.0: 2}, (0.0, 2.0), {1.0: 2}, np.array([[0.0, 3.0], [-3.0, 0.0]])]


@settings(derandomize=True, max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from(EXOSYSTEMS), st.sampled_from([None, 0.05]))
def test_every_error_of_a_random_plant_dies_out_and_so_it_does_in_a_plant_that_differs(
    seed: int, exosystem: internal_model.Exosystem, period: float | None
) -> None:
    regulator = random_servo(seed, exosystem, period)
    assert regulator.steady.vanishes
    assert "draught" in regulator.steady.sources
    rng = np.random.default_rng(seed)
    plant = regulator.plant
    other = replace(
        plant, **{k: getattr(plant, k) * rng.uniform(0.995, 1.005, getattr(plant, k).shape) for k in "ABCD"}
    )
    meets = regulator.steady_error_with(other)
    poles = np.linalg.eigvals(regulator.closed_loop(other).A)
    growth = np.abs(poles).max() - 1 if period else poles.real.max()
    assert (meets.worst < np.inf) == (growth < 0)
    assert meets.vanishes or growth >= 0
    assert not np.allclose(meets.poles, regulator.poles, rtol=1e-9)


@pytest.mark.parametrize("period", [None, 0.05])
def test_units_do_not_matter(period: float | None) -> None:
    """Gains of 1e15 and 1e-9 beside each other: the loop is the same one."""
    plant = random_plant(11)
    n, m, p = len(plant.A), len(plant.inputs), len(plant.outputs)
    x, u, y = (10.0 ** np.linspace(a, b, k) for a, b, k in ((-6, 6, n), (9, -5, m), (-7, 3, p)))
    scaled = replace(
        plant, A=plant.A * x[:, None] / x, B=plant.B * x[:, None] / u, C=plant.C * y[:, None] / x,
        D=plant.D * y[:, None] / u,
    )  # fmt: skip
    controls = plant.inputs[:-1]
    Q, R = np.concatenate([x, np.repeat(y, 3)]) ** -2.0, u[:-1] ** -2.0
    gains = []
    for model, weights in ((plant, (np.eye(n + 3 * p), np.eye(m - 1))), (scaled, (Q, R))):
        if period is None:
            gains.append(servo.lqr(model, (0.0, 2.0), *weights, controls=controls))
        else:
            gains.append(servo.lqrd(model, (0.0, 2.0), *weights, period, controls=controls))
    np.testing.assert_allclose(gains[1].poles, gains[0].poles, rtol=tolerances.of("peak"))
    assert gains[1].steady.vanishes
    ours, theirs = (np.poly(anti_windup.back_calculation(f, 1.0).eigenvalues) for f in gains)
    np.testing.assert_allclose(theirs, ours, rtol=tolerances.of("lyapunov"))


def test_one_output_is_the_augmented_plant_and_the_published_gain() -> None:
    whole = internal_model.augmented(DOUBLE, (0.0, OMEGA0))
    regulator = servo.lqr(DOUBLE, (0.0, OMEGA0), WEIGHTS, [1.0])
    assert regulator.states == whole.states
    for value, printed in zip(regulator.K[0], (-525.33, -50.504, -21213, -1253.6, -2742.2), strict=True):
        last = 1.0 if printed == -21213 else 10.0 ** -(len(str(printed).split(".")[1]))
        assert abs(value - printed) <= tolerances.of("print_K") * last
    closed = np.sort_complex(np.linalg.eigvals(whole.A + whole.B @ regulator.K))
    np.testing.assert_allclose(np.sort_complex(regulator.poles), closed, rtol=tolerances.of("lyapunov"))
    np.testing.assert_array_equal(regulator.K_x, regulator.K[:, :2])
    np.testing.assert_array_equal(regulator.K_xi, regulator.K[:, 2:])


@pytest.mark.parametrize("time", [Continuous(), Discrete(T)])
def test_an_integrator_with_a_constant_has_the_poles_of_its_closed_form(time: Continuous | Discrete) -> None:
    """x' = u, xi' = x - r, u = -3 x - 2 xi: s^2 + 3 s + 2. Sampled, z^2 - (2 - 3 T) z + (1 - 3 T + 2 T^2)."""
    sampled = isinstance(time, Discrete)
    plant = StateSpace(
        [[1.0 if sampled else 0.0]], [[T if sampled else 1.0]], [[1]], [[0]], ("x",), ("u",), ("x",), time
    )
    regulator = servo.of_gain(plant, (0.0,), [[-3.0, -2.0]])
    expected = np.roots([1, -(2 - 3 * T), 1 - 3 * T + 2 * T * T]) if sampled else [-2, -1]
    np.testing.assert_allclose(np.sort(regulator.poles.real), np.sort(expected), rtol=tolerances.of("double"))
    s = np.exp(1j * T) if sampled else 1j
    response = regulator.closed_loop().response(s)[0]
    integral = T / (s - 1) if sampled else 1 / s
    lag = T / (s - 1) if sampled else 1 / s
    wanted_response = -(1 + 3 * lag) / (1 + 3 * lag + 2 * lag * integral)
    error = regulator.closed_loop().outputs.index("x_error")
    np.testing.assert_allclose(response[error, 0], wanted_response, rtol=tolerances.of("double"))


def test_gains_of_other_origin_are_taken_and_certified() -> None:
    whole = internal_model.augmented(DOUBLE, (0.0, 2.0))
    expected = np.array([-1, -2, -3, -4, -5.0])
    K = -scipy.signal.place_poles(whole.A, whole.B, expected).gain_matrix
    regulator = servo.of_gain(DOUBLE, (0.0, 2.0), K)
    np.testing.assert_allclose(np.sort(regulator.poles.real), np.sort(expected), rtol=tolerances.of("peak"))
    assert regulator.steady.vanishes
    with pytest.raises(
        ModelError, match=r"the servo loop has the pole .* which does not decay: give gains that stabili"
    ):
        servo.of_gain(DOUBLE, (0.0, 2.0), -K)
    with pytest.raises(
        SignalError, match=r"K is \(1, 4\): give a finite one of \(1, 5\), force by gap, speed, xi1, xi2"
    ):
        servo.of_gain(DOUBLE, (0.0, 2.0), K[:, :4])


def test_a_simulated_loop_settles_and_python_control_agrees() -> None:
    """A sine and a step disturbance in continuous time, by python-control's simulation of the closed loop."""
    regulator = servo.lqr(DOUBLE, (0.0, OMEGA0), WEIGHTS, [1.0])
    times = np.linspace(0, 20, 4001)
    signals = np.vstack([0.01 * np.sin(OMEGA0 * times + 0.3), np.full_like(times, 2.0)])
    answer = control.forced_response(regulator.closed_loop().to_control(), times, signals)
    error = answer.outputs[regulator.closed_loop().outputs.index("gap_error")]
    interpolated = (OMEGA0 * times[1]) ** 2 / 8 * 0.01  # python-control draws lines between the points of an input
    assert np.abs(error[times > 19]).max() < interpolated < 1e-3 * np.abs(error).max()
    detuned = np.vstack([0.01 * np.sin(1.1 * OMEGA0 * times), np.full_like(times, 2.0)])
    still = control.forced_response(regulator.closed_loop().to_control(), times, detuned).outputs
    assert np.abs(still[regulator.closed_loop().outputs.index("gap_error")][times > 19]).max() > 1e-4 * 0.01


def sampled_run(regulator: servo.Servo, frequency: float, count: int, inside: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the errors at the samples and between them, (count,) and (count, inside), computed without the package."""
    fine = scipy.linalg.expm(np.block([[DOUBLE.A, DOUBLE.B], [np.zeros((1, 3))]]) * T / inside)
    x, xi = np.zeros(2), np.zeros(len(regulator.model.Phi))
    at, between = np.zeros(count), np.zeros((count, inside))
    for k in range(count):
        e = x[0] - np.cos(frequency * k * T)
        u = regulator.K_x @ x + regulator.K_xi @ xi
        at[k] = e
        for j in range(inside):
            between[k, j] = x[0] - np.cos(frequency * (k + j / inside) * T)
            x = fine[:2, :2] @ x + fine[:2, 2:] @ u
        xi = regulator.model.Phi @ xi + regulator.model.N[:, 0] * e
    return at, between


def test_between_the_samples_a_sine_leaves_a_ripple_and_a_constant_none() -> None:
    regulator = servo.lqrd(DOUBLE, (0.0, 20.0), WEIGHTS, [1.0], T)
    at, between = sampled_run(regulator, 20.0, 3000, 5)
    assert np.abs(at[-100:]).max() < tolerances.of("settled")
    ripple = np.abs(between[-100:]).max()
    assert 1e-6 < ripple < (20.0 * T) ** 2
    at, between = sampled_run(regulator, 0.0, 3000, 5)
    assert np.abs(between[-100:]).max() < tolerances.of("settled")


def test_an_observer_adds_its_poles_and_leaves_no_error() -> None:
    regulator = servo.lqrd(DOUBLE, (0.0, OMEGA0), WEIGHTS, [1.0], T)
    plant = regulator.plant
    L = scipy.signal.place_poles(plant.A.T, plant.C.T, [0.5, 0.6]).gain_matrix.T
    seen = servo.with_estimator(regulator, full_order_observer(plant, L))
    expected = np.sort_complex([0.5, 0.6, *regulator.poles])
    np.testing.assert_allclose(np.sort_complex(seen.poles), expected, rtol=tolerances.of("lyapunov"))
    assert seen.steady.vanishes
    assert seen.controller.inputs == ("gap_error", "force_limited", "gap")
    assert seen.controller.states == ("xi1", "xi2", "xi3", "gap_estimate", "speed_estimate")
    assert seen.controller.unit("force_command") == "m/s^2"
    heavier = replace(plant, B=plant.B * 0.9)
    assert seen.steady_error_with(heavier).vanishes
    with pytest.raises(ModelError, match="and an estimator whose error decays"):
        servo.with_estimator(regulator, full_order_observer(plant, -L))


def test_an_estimator_with_a_direct_term_from_what_is_measured() -> None:
    """The current form of the observer: its estimate uses the sample of its own instant."""
    regulator = servo.lqrd(DOUBLE, (0.0, OMEGA0), WEIGHTS, [1.0], T)
    plant = regulator.plant
    M = np.array([[0.7], [20.0]])
    L = plant.A @ M
    H = np.eye(2) - M @ plant.C
    current = StateSpace(
        plant.A - L @ plant.C, np.hstack([plant.B, L]), H, np.hstack([np.zeros((2, 1)), M]),
        ("gap_predicted", "speed_predicted"), ("force", "gap"), ("gap_estimate", "speed_estimate"), plant.time,
    )  # fmt: skip
    seen = servo.with_estimator(regulator, current)
    assert seen.steady.vanishes
    expected = np.sort_complex([*np.linalg.eigvals(plant.A - L @ plant.C), *regulator.poles])
    np.testing.assert_allclose(np.sort_complex(seen.poles), expected, rtol=tolerances.of("lyapunov"))
    hasty = replace(current, D=current.D + np.array([[0.0, 0.0], [1.0, 0.0]]))
    with pytest.raises(SignalError, match="depends directly on force, which makes an algebraic loop"):
        servo.with_estimator(regulator, hasty)
    with pytest.raises(SignalError, match=r"input 'draught' is neither a control .* nor an output of the plant"):
        servo.with_estimator(regulator, current.renamed({"force": "draught"}))
    with pytest.raises(TimingError, match=r"discrete time of 0\.01 s meets continuous time"):
        servo.with_estimator(regulator, replace(current, time=Continuous()))


def test_the_states_of_an_estimator_keep_their_units() -> None:
    regulator = servo.lqrd(DOUBLE, (0.0,), np.eye(3), [1.0], T)
    filtered = kalman.kalmd(DOUBLE, {"force": 1.0}, [1e-6], T, G=["force"])
    current, predictor = (
        servo.with_estimator(regulator, part).controller.units for part in (filtered.current(), filtered.predictor())
    )
    assert (current["gap_predicted"], current["speed_predicted"]) == ("m", "m/s")
    assert (predictor["gap_estimate"], predictor["speed_estimate"]) == ("m", "m/s")
    by_hand = servo.with_estimator(regulator, full_order_observer(regulator.plant, [[0.9], [20.0]])).controller.units
    assert (by_hand["gap_estimate"], by_hand["speed_estimate"]) == ("m", "m/s")


def test_other_plants_must_have_the_signals() -> None:
    regulator = servo.lqrd(DOUBLE, (0.0,), np.eye(3), [1.0], T)
    with pytest.raises(SignalError, match="no state 'speed', which the regulator feeds back"):
        regulator.steady_error_with(regulator.plant.renamed({"speed": "v"}))
    with pytest.raises(SignalError, match="'gap' is not one of height"):
        regulator.steady_error_with(replace(regulator.plant, outputs=("height",)))
    with pytest.raises(TimingError, match="continuous time meets discrete time"):
        regulator.steady_error_with(DOUBLE)
    slower = discretise.zero_order_hold(
        StateSpace(
            [[0, 1, 0], [0, 0, 500], [0, 0, -500]],
            [[0], [0], [1]], [[1, 0, 0]], [[0]], ("gap", "speed", "lag"), ("force",), ("gap",), Continuous(),
        ),
        T,
    )  # fmt: skip
    assert regulator.steady_error_with(slower).vanishes  # an actuator that the design did not know


def test_a_servo_prints_gains_units_poles_and_certificate() -> None:
    text = repr(servo.lqr(DOUBLE, (0.0, OMEGA0), WEIGHTS, [1.0]))
    assert "Servo regulator of gap by force in continuous time" in text
    assert "xi1 [m s^3]" in text
    assert "Each error dies out" in text


@pytest.mark.parametrize("period", [None, 0.01])
@pytest.mark.parametrize("w", [0.0, *range(1, 20), 300.0])
def test_an_internal_model_that_is_not_fed_back_is_refused(w: float, period: float | None) -> None:
    """K_xi = 0 leaves the modes where they are, on the axis or the circle, whatever rounding says."""
    plant = statespace.of(([[-1.0]], [[1.0]], [[1.0]]))
    plant = plant if period is None else discretise.zero_order_hold(plant, period)
    with pytest.raises(ModelError, match="does not decay: give gains that stabilise the plant"):
        servo.of_gain(plant, [w], [[-1.0] + [0.0] * (2 if w else 1)])


@pytest.mark.parametrize("period", [None, 0.01])
def test_several_modes_that_are_not_fed_back_are_refused(period: float | None) -> None:
    plant = statespace.of(([[-1.0]], [[1.0]], [[1.0]]))
    plant = plant if period is None else discretise.zero_order_hold(plant, period)
    for modes in ({0.0: 2}, {0.0: 1, 3.0: 1, 100.0: 1}, {2.0: 2}, {0.0: 3}):
        order = internal_model.of(modes).Phi.shape[0]
        with pytest.raises(ModelError, match="does not decay: give gains"):
            servo.of_gain(plant, modes, [[-1.0] + [0.0] * order])


def test_no_regulated_output_and_names_that_are_none_are_refused() -> None:
    plant = statespace.of(([[-1.0]], [[1.0]], [[1.0]]))
    for nothing in (plant.select([], plant.inputs), discretise.zero_order_hold(plant.select([], plant.inputs), 0.1)):
        with pytest.raises(SignalError, match="no output is regulated: name one or more"):
            servo.of_gain(nothing, [0.0], [[-1.0]])
    for wrong in (np.array([["y1"]]), [["y1"]], 3):
        with pytest.raises(SignalError, match=r"`regulated` of .*: give a list of names"):
            servo.of_gain(plant, [0.0], [[-1.0, -1.0]], regulated=wrong)
        with pytest.raises(SignalError, match=r"`controls` of .*: give a list of names"):
            servo.of_gain(plant, [0.0], [[-1.0, -1.0]], controls=wrong)
    assert servo.of_gain(plant, [0.0], [[-1.0, -1.0]], regulated="y1").regulated == ("y1",)
