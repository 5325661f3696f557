"""Anti-windup: what decays while actuators are held, what overshoots less, and what is refused."""

from collections.abc import Callable

import mpmath
import numpy as np
import pytest
import scipy.linalg

from synth.analyse.numerics import precise
from synth.statespace import StateSpace
from synth.synthesise.regulation import anti_windup, internal_model, servo
from synth.timing import Continuous, Discrete
from tests import tolerances
from tests.synthesise.observers.models import full_order_observer

T = 0.01
OMEGA0 = 1.5 * np.pi
DOUBLE = StateSpace([[0, 1], [0, 0]], [[0], [1]], [[1, 0]], [[0]], ("gap", "speed"), ("f",), ("gap",), Continuous())
X_AXIS = np.diag([1500, 1500, 4.5e8, 2.25e6, 2.25e6])  # F


def two_axes(period: float | None = None, exosystem: internal_model.Exosystem = (0.0, 3.0)) -> servo.Servo:
    """Return the regulator of two coupled axes at constants and sines of 3 rad/s, or else, three actuators."""
    A = scipy.linalg.block_diag(DOUBLE.A, DOUBLE.A)
    B = [[0, 0, 0], [1, 0.5, 0], [0, 0, 0], [0, -0.5, 2]]
    plant = StateSpace(A, B, [[1, 0, 0, 0], [0, 0, 1, 0]], np.zeros((2, 3)), ("p", "dp", "q", "dq"), ("f", "g", "h"),
                       ("y", "z"), Continuous())  # fmt: skip
    weights = (np.eye(4 + 2 * len(internal_model.of(exosystem).Phi)), np.eye(3))
    if period is None:
        return servo.lqr(plant, exosystem, *weights)
    return servo.lqrd(plant, exosystem, *weights, period)


@pytest.mark.parametrize("rate", [0.5, 20.0])
@pytest.mark.parametrize("period", [None, T])
def test_every_mode_keeps_its_frequency_and_decays_at_the_rate(rate: float, period: float | None) -> None:
    design = anti_windup.back_calculation(two_axes(period), rate, [1.0, 2.0, 1.0])
    values = design.eigenvalues if period is None else np.log(design.eigenvalues) / T
    expected = np.array([-rate + 1j * w for w in (-3, -3, 0, 0, 3, 3)])
    np.testing.assert_allclose(np.sort(values.imag), expected.imag, atol=tolerances.of("multiple_root") * rate)
    np.testing.assert_allclose(values.real, -rate, rtol=tolerances.of("multiple_root"))
    assert design.E.shape == (6, 3)
    assert design.controller.inputs[-3:] == ("f_excess", "g_excess", "h_excess")
    np.testing.assert_array_equal(design.controller.B[:, -3:], design.E)


@pytest.mark.parametrize("frequencies", [{0.0: 2}, {0.0: 1, 2.0: 2}, (0.0, 5.0, 10.0, 15.0)])
@pytest.mark.parametrize("period", [None, T])
def test_multiple_and_many_modes_decay_too(frequencies: object, period: float | None) -> None:
    order = 2 + sum(frequencies.values()) + (2 if 2.0 in frequencies else 0) if isinstance(frequencies, dict) else 9
    args = (DOUBLE, frequencies, np.eye(order), [1.0])
    regulator = servo.lqr(*args) if period is None else servo.lqrd(*args, period)
    values = anti_windup.back_calculation(regulator, 2.0).eigenvalues
    rates = values.real if period is None else np.log(np.abs(values)) / T
    np.testing.assert_allclose(rates, -2, rtol=1e-2)  # four eigenvalues that meet scatter by the root of the precision


@pytest.mark.parametrize(("rate", "period"), [(1e5, None), (2e5, None), (1e4, 1e-3), (1e5, 1e-3)])
def test_a_fast_decay_has_the_eigenvalues_of_its_rounded_gain(rate: float, period: float | None) -> None:
    """A - E C has entries that cancel: rounding it moves the eigenvalues by more than their size."""
    args = (DOUBLE, [0.0, 10.0], np.eye(5), [1.0])
    regulator = servo.lqr(*args) if period is None else servo.lqrd(*args, period)
    design = anti_windup.back_calculation(regulator, rate)
    with mpmath.workdps(80):
        A, E, C = (mpmath.matrix(M.tolist()) for M in (regulator.controller.A, design.E, regulator.controller.C))
        exact = np.sort_complex([complex(v) for v in mpmath.eig(A - E * C, left=False, right=False)])
    np.testing.assert_allclose(np.sort(design.eigenvalues.real), exact.real, rtol=1e-12)
    np.testing.assert_allclose(np.sort(design.eigenvalues.imag), np.sort(exact.imag), rtol=1e-12, atol=1e-12 * rate)
    if period is None:
        np.testing.assert_allclose(design.eigenvalues.real, -rate, rtol=1e-2)
    else:
        assert np.abs(design.eigenvalues).max() < 2e-4


def test_a_constant_has_the_closed_form() -> None:
    """xi' = e + E (u_limited - u), u = K_x x + k xi: the rate is E k; sampled it is (1 - exp(-a T)) / k."""
    lag = StateSpace([[-1.0]], [[1.0]], [[1.0]], [[0.0]], ("x",), ("u",), ("x",), Continuous())
    regulator = servo.of_gain(lag, (0.0,), [[-2.0, -4.0]])
    np.testing.assert_allclose(anti_windup.back_calculation(regulator, 3.0).E, [[-3 / 4]], rtol=tolerances.of("double"))
    sampled = servo.of_gain(StateSpace([[0.9]], [[0.1]], [[1.0]], [[0.0]], ("x",), ("u",), ("x",), Discrete(T)), (0.0,),
                            [[-2.0, -4.0]])  # fmt: skip
    design = anti_windup.back_calculation(sampled, 3.0)
    np.testing.assert_allclose(design.E, [[-(1 - np.exp(-3 * T)) / 4]], rtol=tolerances.of("double"))


def test_an_observer_goes_on_with_what_the_actuators_do() -> None:
    regulator = servo.lqrd(DOUBLE, (0.0,), np.eye(3), [1.0], T)
    seen = servo.with_estimator(regulator, full_order_observer(regulator.plant, [[0.9], [20.0]]))
    design = anti_windup.back_calculation(seen, 5.0)
    assert design.E[1:].tolist() == [[0.0], [0.0]]
    observer = np.linalg.eigvals(regulator.plant.A - np.array([[0.9], [20.0]]) @ regulator.plant.C)
    expected = np.sort_complex([*observer, np.exp(-5 * T)])
    np.testing.assert_allclose(design.eigenvalues, expected, rtol=tolerances.of("lyapunov"))
    limited = design.controller.B[1:, design.controller.inputs.index("f_limited")]
    np.testing.assert_array_equal(limited, regulator.plant.B[:, 0])


def run(
    plant: StateSpace, controller: StateSpace, limit: float, aims: np.ndarray, start: tuple[np.ndarray, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Return outputs and commands of a sampled loop with saturation, step by step, from (x, x_c)."""
    x, c = start
    outputs, commands = [], []
    for aim in aims:
        y = plant.C @ x
        known = dict(zip(plant.states, x, strict=True)) | dict(zip(plant.outputs, y, strict=True))
        known |= {f"{name}_error": v for name, v in zip(plant.outputs, y - aim, strict=True)}
        w = np.array([known.get(name, 0.0) for name in controller.inputs])
        u = controller.C @ c + controller.D @ w  # limits and excess have no direct term
        limited = np.clip(u, -limit, limit)
        for ending, values in (("limited", limited), ("excess", limited - u)):
            for name, value in zip(plant.inputs, values, strict=True):
                if f"{name}_{ending}" in controller.inputs:
                    w[controller.inputs.index(f"{name}_{ending}")] = value
        x, c = plant.A @ x + plant.B @ limited, controller.A @ c + controller.B @ w
        outputs.append(y)
        commands.append(u)
    return np.array(outputs), np.array(commands)


@pytest.mark.parametrize("with_observer", [False, True])
def test_a_saturated_step_overshoots_less(with_observer: bool) -> None:
    """0.1 m under 1.5 m/s^2: without anti-windup the internal model winds up and the mass swings on."""
    regulator = servo.lqrd(DOUBLE, (0.0, OMEGA0), X_AXIS, [1.0], 1e-3)
    if with_observer:
        regulator = servo.with_estimator(regulator, full_order_observer(regulator.plant, [[0.5], [60.0]]))
    aims = np.full((3000, 1), 0.1)
    over = {}
    for name, controller in {
        "none": regulator.controller,
        "back": anti_windup.back_calculation(regulator, 5.0).controller,
    }.items():
        start = np.zeros(2), np.zeros(len(controller.A))
        y, u = run(regulator.plant, controller, 1.5, aims, start)
        assert np.abs(u).max() > 1.5
        over[name] = y.max() / 0.1 - 1
        if name != "none":
            assert abs(y[-1, 0] - 0.1) < 1e-4
    assert over["back"] < 0.05 < 1 < over["none"]


def test_the_result_prints() -> None:
    regulator = servo.lqrd(DOUBLE, (0.0,), np.eye(3), [1.0], T)
    design = anti_windup.back_calculation(regulator, 5.0)
    assert "With all actuators at their limits the controller has the eigenvalues 0.95123" in repr(design)


def perturb_rounding(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let LAPACK's solutions and products differ in their last digits, as on another processor."""

    def perturbed(solve: Callable[..., np.ndarray]) -> Callable[..., np.ndarray]:
        return lambda *args, **named: np.asarray(solve(*args, **named)) * (1 + 2.0**-45)

    for module, names in (
        (np.linalg, ("solve", "inv")),
        (scipy.linalg, ("solve_continuous_lyapunov", "solve_discrete_lyapunov", "expm")),
    ):
        for name in names:
            monkeypatch.setattr(module, name, perturbed(getattr(module, name)))


@pytest.mark.parametrize("exosystem", [(0.0, 3.0), {0.0: 2, 3.0: 1}, {3.0: 2}])
@pytest.mark.parametrize("period", [None, T])
def test_the_exact_gain_is_the_same_whatever_lapack_rounds(
    exosystem: internal_model.Exosystem, period: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    regulator = two_axes(period, exosystem)
    exact = anti_windup.back_calculation(regulator, 20.0).E
    with monkeypatch.context() as patched:
        patched.setattr(precise, "BITS", 1024)
        np.testing.assert_array_equal(anti_windup.back_calculation(regulator, 20.0).E, exact)
    perturb_rounding(monkeypatch)
    np.testing.assert_array_equal(anti_windup.back_calculation(regulator, 20.0).E, exact)


@pytest.mark.parametrize("period", [None, T])
def test_the_exact_gain_shares_by_weights_too(period: float | None) -> None:
    regulator = two_axes(period)
    exact = anti_windup.back_calculation(regulator, 20.0, [1.0, 2.0, 5.0])
    rates = exact.eigenvalues.real if period is None else np.log(np.abs(exact.eigenvalues)) / T
    np.testing.assert_allclose(rates, -20, rtol=tolerances.of("multiple_root"))
    lag = StateSpace([[-1.0]], [[1.0]], [[1.0]], [[0.0]], ("x",), ("u",), ("x",), Continuous())
    one = servo.of_gain(lag, (0.0,), [[-2.0, -4.0]])
    assert anti_windup.back_calculation(one, 3.0).E.tolist() == [[-0.75]]
