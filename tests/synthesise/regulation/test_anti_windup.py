"""Anti-windup: what decays while actuators are held, what overshoots less, and what is refused."""

from collections.abc import Callable

import mpmath
import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse import precise
from synth.errors import ModelError, SignalError
from synth.statespace import StateSpace
from synth.synthesise.regulation import anti_windup, internal_model, optimal_servo, servo
from synth.timing import Continuous, Discrete
from tests import tolerances

T = 0.01
OMEGA0 = 1.5 * np.pi
DOUBLE = StateSpace([[0, 1], [0, 0]], [[0], [1]], [[1, 0]], [[0]], ("gap", "speed"), ("f",), ("gap",), Continuous())
X_AXIS = np.diag([1500, 1500, 4.5e8, 2.25e6, 2.25e6])  # F: its zeros from the error decay, those of the y axis do not
Y_AXIS = np.diag([3e4, 3e4, 2.5e9, 2.5e7, 2.5e7])


def two_axes(period: float | None = None, exosystem: internal_model.Exosystem = (0.0, 3.0)) -> servo.Servo:
    """Return the regulator of two coupled axes at constants and sines of 3 rad/s, or else, three actuators."""
    A = scipy.linalg.block_diag(DOUBLE.A, DOUBLE.A)
    B = [[0, 0, 0], [1, 0.5, 0], [0, 0, 0], [0, -0.5, 2]]
    plant = StateSpace(A, B, [[1, 0, 0, 0], [0, 0, 1, 0]], np.zeros((2, 3)), ("p", "dp", "q", "dq"), ("f", "g", "h"),
                       ("y", "z"), Continuous())  # fmt: skip
    weights = (np.eye(4 + 2 * len(internal_model.of(exosystem).Phi)), np.eye(3))
    if period is None:
        return optimal_servo.lqr(plant, exosystem, *weights)
    return optimal_servo.lqrd(plant, exosystem, *weights, period)


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
    regulator = optimal_servo.lqr(*args) if period is None else optimal_servo.lqrd(*args, period)
    values = anti_windup.back_calculation(regulator, 2.0).eigenvalues
    rates = values.real if period is None else np.log(np.abs(values)) / T
    np.testing.assert_allclose(rates, -2, rtol=1e-2)  # four eigenvalues that meet scatter by the root of the precision


@pytest.mark.parametrize(("rate", "period"), [(1e5, None), (2e5, None), (1e4, 1e-3), (1e5, 1e-3)])
def test_a_fast_decay_has_the_eigenvalues_of_its_rounded_gain(rate: float, period: float | None) -> None:
    """A - E C has entries that cancel: rounding it moves the eigenvalues by more than their size."""
    args = (DOUBLE, [0.0, 10.0], np.eye(5), [1.0])
    regulator = optimal_servo.lqr(*args) if period is None else optimal_servo.lqrd(*args, period)
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


def test_a_decay_out_of_proportion_is_refused_with_the_direction_to_change_it() -> None:
    args = (DOUBLE, [0.0, 10.0], np.eye(5), [1.0])
    for rate, text in ((1e-14, "choose a larger"), (1e8, "decides its decay at 1e[+]08 1/s: choose a smaller")):
        with pytest.raises(ModelError, match=f"by more than rounding errors .* winds up: .*{text} decay_per_s"):
            anti_windup.back_calculation(optimal_servo.lqr(*args), rate)
    with pytest.raises(ModelError, match=r"is 10000, and the gain .* deadbeat already: give .* of 40000 1/s or less"):
        anti_windup.back_calculation(optimal_servo.lqrd(*args, 1e-3), 1e7)


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
    regulator = optimal_servo.lqrd(DOUBLE, (0.0,), np.eye(3), [1.0], T)
    seen = servo.with_observer(regulator, [[0.9], [20.0]])
    design = anti_windup.back_calculation(seen, 5.0)
    assert design.E[1:].tolist() == [[0.0], [0.0]]
    observer = np.linalg.eigvals(regulator.plant.A - np.array([[0.9], [20.0]]) @ regulator.plant.C)
    expected = np.sort_complex([*observer, np.exp(-5 * T)])
    np.testing.assert_allclose(design.eigenvalues, expected, rtol=tolerances.of("lyapunov"))
    limited = design.controller.B[1:, design.controller.inputs.index("f_limited")]
    np.testing.assert_array_equal(limited, regulator.plant.B[:, 0])


def test_a_gain_that_does_not_stop_the_winding_is_refused() -> None:
    regulator = optimal_servo.lqrd(DOUBLE, (0.0,), np.eye(3), [1.0], T)
    with pytest.raises(ModelError, match=r"while its commands are held .* eigenvalue 1, .* winds up: take another E"):
        anti_windup.of_gain(regulator.controller, [[0.0]])
    good = anti_windup.back_calculation(regulator, 1.0)
    assert anti_windup.of_gain(regulator.controller, good.E).eigenvalues.tolist() == good.eigenvalues.tolist()
    with pytest.raises(ModelError, match="winds up"):
        anti_windup.of_gain(regulator.controller, -good.E)
    with pytest.raises(SignalError, match=r"E is \(1, 2\): give a finite one of \(1, 1\)"):
        anti_windup.of_gain(regulator.controller, [[1.0, 2.0]])


@pytest.mark.parametrize("rate", [0.0, -1.0, np.inf, np.nan])
def test_a_rate_is_positive(rate: float) -> None:
    with pytest.raises(SignalError, match=r"decays at .* 1/s: give a finite rate above 0"):
        anti_windup.back_calculation(two_axes(), rate)


def random_controller(seed: int, direct: bool) -> StateSpace:
    rng = np.random.default_rng(seed)
    D = np.hstack([direct * rng.normal(size=(2, 2)), rng.normal(size=(2, 1))])
    matrices = 0.4 * rng.normal(size=(3, 3)), rng.normal(size=(3, 3)), rng.normal(size=(2, 3)), D
    return StateSpace(*matrices, ("a", "b", "c"), ("r", "s", "y"), ("f_command", "g_command"), Discrete(T))


@settings(derandomize=True, max_examples=30, deadline=None)
@given(st.integers(0, 10**6))
def test_with_a_direct_term_the_next_state_is_that_of_the_realisable_reference(seed: int) -> None:
    """Hanus: with w^r = w + D^-1 (limited - u) the command is the limited one; the state follows w^r."""
    c = random_controller(seed, True)
    try:
        design = anti_windup.conditioning(c, ("r", "s"))
    except ModelError:
        zeros = scipy.linalg.eigvals(c.A - c.B[:, :2] @ np.linalg.solve(c.D[:, :2], c.C))
        assert np.abs(zeros).max() >= 1
        return
    rng = np.random.default_rng(seed)
    x, w, limited = rng.normal(size=3), rng.normal(size=3), rng.normal(size=2)
    u = c.C @ x + c.D @ w
    realisable = w + np.array([*np.linalg.solve(c.D[:, :2], limited - u), 0.0])
    np.testing.assert_allclose(c.C @ x + c.D @ realisable, limited, atol=tolerances.of("lyapunov"))
    after = design.controller.A @ x + design.controller.B @ np.concatenate([w, limited - u])
    np.testing.assert_allclose(
        after, c.A @ x + c.B @ realisable, rtol=tolerances.of("lyapunov"), atol=tolerances.of("lyapunov")
    )


def test_without_one_it_is_the_reference_of_the_sample_before() -> None:
    """Had xi followed it, the command would be the limited one; the next xi starts from there."""
    regulator = optimal_servo.lqrd(DOUBLE, (0.0, OMEGA0), X_AXIS, [1.0], 1e-3)
    design = anti_windup.conditioning(regulator.controller, ["gap_error"])
    rng = np.random.default_rng(1)
    x, xi, e, limited = rng.normal(size=2), rng.normal(size=3), 0.3, 1.7
    model = regulator.model
    u = regulator.K_x @ x + regulator.K_xi @ xi
    corrected_xi = xi + model.N[:, 0] * (limited - u) / (regulator.K_xi @ model.N)[0, 0]
    np.testing.assert_allclose(
        regulator.K_x @ x + regulator.K_xi @ corrected_xi, limited, rtol=tolerances.of("lyapunov")
    )
    expected = model.Phi @ corrected_xi + model.N[:, 0] * e
    inputs = {"gap": x[0], "speed": x[1], "gap_error": e, "f_excess": (limited - u)[0]}
    after = design.controller.A @ xi + design.controller.B @ [inputs[name] for name in design.controller.inputs]
    np.testing.assert_allclose(after, expected, rtol=tolerances.of("lyapunov"))
    assert np.abs(design.eigenvalues).min() < tolerances.of("lyapunov")  # at once
    gentle = anti_windup.conditioning(regulator.controller, ["gap_error"], 20.0)
    assert np.abs(gentle.eigenvalues - np.exp(-0.02)).min() < tolerances.of("lyapunov")


def test_a_continuous_controller_is_conditioned_at_a_rate() -> None:
    regulator = optimal_servo.lqr(DOUBLE, (0.0, OMEGA0), X_AXIS, [1.0])
    design = anti_windup.conditioning(regulator.controller, ["gap_error"], 30.0)
    k = regulator.K_xi[0]
    expected = np.sort_complex([-30, *np.roots(k[::-1])])
    np.testing.assert_allclose(design.eigenvalues, expected, rtol=tolerances.of("lyapunov"))
    with pytest.raises(SignalError, match="whose D is 0: give the rate decay_per_s"):
        anti_windup.conditioning(regulator.controller, ["gap_error"])


def test_conditioning_that_cannot_be_is_refused_with_the_mend() -> None:
    y_axis = optimal_servo.lqrd(DOUBLE, (0.0, OMEGA0), Y_AXIS, [1.0], 1e-3)
    with pytest.raises(ModelError, match=r"eigenvalue 1\.0002.* it is a zero from gap_error, .* use back_calculation"):
        anti_windup.conditioning(y_axis.controller, ["gap_error"])
    assert anti_windup.back_calculation(y_axis, 1.0).eigenvalues.size == 3
    with pytest.raises(SignalError, match="give as many references as commands, 3 for f_command, g_command, h_command"):
        anti_windup.conditioning(two_axes(T).controller, ["y_error", "z_error"])
    flat = random_controller(1, True)
    D = flat.D.copy()
    D[:, :2] = [[1.0, 2.0], [1e9, 2e9]]
    with pytest.raises(ModelError, match=r"from u1, u2 to y1, y2 the direct term D is singular: no reference makes"):
        anti_windup.conditioning((flat.A, flat.B, flat.C, D, Discrete(T)), ["u1", "u2"])
    with pytest.raises(ModelError, match=r"from u1, u2 to y1, y2 D = 0, and C B is singular"):
        anti_windup.conditioning((flat.A, flat.B, 0 * flat.C, 0 * D, Discrete(T)), ["u1", "u2"])


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
    regulator = optimal_servo.lqrd(DOUBLE, (0.0, OMEGA0), X_AXIS, [1.0], 1e-3)
    if with_observer:
        regulator = servo.with_observer(regulator, [[0.5], [60.0]])
    aims = np.full((3000, 1), 0.1)
    over = {}
    for name, controller in {
        "none": regulator.controller,
        "back": anti_windup.back_calculation(regulator, 5.0).controller,
        "hanus": anti_windup.conditioning(regulator.controller, ["gap_error"], 100.0).controller,
    }.items():
        start = np.zeros(2), np.zeros(len(controller.A))
        y, u = run(regulator.plant, controller, 1.5, aims, start)
        assert np.abs(u).max() > 1.5
        over[name] = y.max() / 0.1 - 1
        if name != "none":
            assert abs(y[-1, 0] - 0.1) < 1e-4
    assert over["back"] < 0.05 < 1 < over["none"]
    assert over["hanus"] < 0.05


def test_any_form_of_system_is_read_and_the_result_prints() -> None:
    regulator = optimal_servo.lqrd(DOUBLE, (0.0,), np.eye(3), [1.0], T)
    design = anti_windup.back_calculation(regulator, 5.0)
    again = anti_windup.of_gain(regulator.controller.to_control(), design.E)
    np.testing.assert_array_equal(again.E, design.E)
    assert "With all actuators at their limits the controller has the eigenvalues 0.95123" in repr(design)


@pytest.mark.parametrize("sampled", [False, True])
def test_a_gain_of_zero_is_refused_for_any_rounding(sampled: bool) -> None:
    plant = ([[-1.0]], [[1.0]], [[1.0]])
    for w in np.linspace(0, 30, 21):
        n = 3 if w else 2
        if sampled:
            regulator = optimal_servo.lqrd(plant, [w], np.ones(n), [1.0], 0.01)
        else:
            regulator = optimal_servo.lqr(plant, [w], np.ones(n), [1.0])
        with pytest.raises(ModelError, match="which does not decay"):
            anti_windup.of_gain(regulator.controller, np.zeros((n - 1, 1)))


@pytest.mark.parametrize("rate", [1j, "a", None, [1.0], np.nan])
def test_a_rate_that_is_no_number_is_refused(rate: float) -> None:
    regulator = optimal_servo.lqr(([[-1.0]], [[1.0]], [[1.0]]), [0.0], np.ones(2), [1.0])
    with pytest.raises(SignalError, match="decay"):
        anti_windup.back_calculation(regulator, rate)


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
