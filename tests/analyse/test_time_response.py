"""Step and impulse responses against closed forms and python-control."""

import math
from typing import Any

import control
import numpy as np
import pytest
import scipy.linalg

from synth.analyse import discretise, time_response
from synth.errors import ModelError, TimingError
from synth.statespace import StateSpace, of
from synth.timing import Continuous, Discrete
from tests import tolerances

S, Z = control.tf("s"), control.tf([1.0, 0.0], [1.0], 0.1)
EXACT = tolerances.of("double")


def model(time: Any = None) -> StateSpace:
    rng = np.random.default_rng(3)
    A, B, C = rng.standard_normal((4, 4)), rng.standard_normal((4, 2)), rng.standard_normal((3, 4))
    A = A - 3 * np.eye(4)
    names = ("a", "b", "c", "d"), ("f", "g"), ("x", "y", "z")
    continuous = StateSpace(A, B, C, rng.standard_normal((3, 2)), *names, Continuous(), {"x": "m", "f": "N"})
    return continuous if time is None else discretise.zero_order_hold(continuous, time)


def test_closed_forms_of_a_step_and_an_impulse() -> None:
    zeta, rate = 0.2, np.sqrt(1 - 0.2**2)
    step, impulse = (f(1 / (S**2 + 0.4 * S + 1)) for f in (time_response.step_response, time_response.impulse_response))
    t, decay = step.time, np.exp(-zeta * step.time)
    expected = 1 - decay * (np.cos(rate * t) + zeta / rate * np.sin(rate * t))
    np.testing.assert_allclose(step.outputs[:, 0, 0], expected, rtol=0, atol=EXACT)
    later = np.exp(-zeta * impulse.time) * np.sin(rate * impulse.time) / rate
    np.testing.assert_allclose(impulse.outputs[:, 0, 0], later, rtol=0, atol=EXACT)
    assert step.final is not None and step.final[0, 0] == pytest.approx(1.0) and impulse.final is None
    assert 5e-4 < decay[-1] <= 1.001e-3 and len(t) > 500


@pytest.mark.parametrize("period", [None, 0.05])
def test_all_channels_agree_with_python_control(period: float | None) -> None:
    mine = model(period)
    response = time_response.step_response(mine, 2.0)
    theirs = control.step_response(mine.to_control(), response.time)
    np.testing.assert_allclose(response.outputs, theirs.outputs.transpose(2, 0, 1), rtol=0, atol=1e-11)
    assert (response.output_names, response.input_names) == (mine.outputs, mine.inputs)
    assert response.output_units == ("m", "", "") and response.input_units == ("N", "")


def test_the_impulse_of_a_sampled_model_is_one_sample_of_height_1() -> None:
    mine = model(0.05)
    response, step = time_response.impulse_response(mine, 1.0), time_response.step_response(mine, 1.0)
    theirs = control.impulse_response(mine.to_control(), response.time)
    np.testing.assert_allclose(response.outputs, 0.05 * theirs.outputs.transpose(2, 0, 1), rtol=0, atol=1e-11)
    np.testing.assert_allclose(np.cumsum(response.outputs, axis=0), step.outputs, rtol=0, atol=1e-11)
    np.testing.assert_array_equal(response.outputs[0], mine.D)
    markov = time_response.impulse_response((Z + 1) / (Z - 0.5), 0.4).outputs[:, 0, 0]
    np.testing.assert_allclose(markov, [1, 1.5, 0.75, 0.375, 0.1875], rtol=1e-14)


def test_the_figures_of_a_step_are_those_of_the_textbook() -> None:
    zeta, rate = 0.5, np.sqrt(0.75)
    row = time_response.step_response(3 / (S**2 + S + 1), interval_s=1e-3).sheet().tables[0].rows[0]
    assert row[1] == "3" and row[2] == f"{np.exp(-np.pi * zeta / rate):.2%}"
    assert float(row[4]) == pytest.approx(1.639, abs=2e-3)  # Franklin, Powell: t_r = 1.64 / w_n at zeta = 0.5
    theirs = control.step_info(3 / (S**2 + S + 1), T=np.arange(0, 20, 1e-3))
    assert float(row[4]) == pytest.approx(theirs["RiseTime"], abs=2e-3)
    assert float(row[5]) == pytest.approx(theirs["SettlingTime"], abs=2e-3)
    assert float(row[7]) == pytest.approx(np.pi / rate, abs=2e-3)


@pytest.mark.parametrize(
    ("system", "end"),
    [
        (1 / (S + 2), np.log(1000) / 2),
        (1 / (S - 2), np.log(1000) / 2),
        (1 / S, 1.0),
        (1 / (S**2 + 4), 10 * np.pi),
        (1 / (S * (S + 2)), np.log(1000) / 2),
        (control.ss([], [], [], [[2.0]], 0), 1.0),
        (1 / (Z - 0.5), 1.0),
        (1 / Z, 1.0),
    ],
)
def test_the_duration_follows_the_poles(system: Any, end: float) -> None:
    response = time_response.step_response(system)
    assert response.time[0] == 0.0 and response.time[-1] == pytest.approx(end, rel=1e-9)
    assert np.isfinite(response.outputs).all() and len(response.time) <= 20_001 and "unit step" in repr(response)


def test_an_oscillation_is_shown_by_twenty_points_in_a_period() -> None:
    response = time_response.step_response(1 / (S**2 + 0.01 * S + 1))
    assert 2 * np.pi / response.time[1] == pytest.approx(20, rel=0.01)


FAST = 2 * np.pi * 1000


def fast_beside_slow(damping: float) -> Any:
    """Return 0.2 / (10 s + 1) and an oscillator of 1 kHz in parallel."""
    oscillator = [[0, 1], [-(FAST**2), -2 * damping * FAST]]
    return scipy.linalg.block_diag([[-0.1]], oscillator), [[0.02], [0], [FAST**2]], [[1.0, 1, 0]], [[0.0]]


def test_default_times_resolve_a_fast_oscillation_beside_a_slow_mode() -> None:
    def exact(t: np.ndarray) -> np.ndarray:
        root = np.sqrt(1 - 0.01**2)
        wave = np.cos(root * FAST * t) + 0.01 / root * np.sin(root * FAST * t)
        return 0.2 * (1 - np.exp(-0.1 * t)) + 1 - np.exp(-0.01 * FAST * t) * wave

    response = time_response.step_response(fast_beside_slow(0.01))
    np.testing.assert_allclose(response.outputs[:, 0, 0], exact(response.time), rtol=0, atol=1e-12)
    assert response.time[-1] == pytest.approx(np.log(1000) / 0.1) and 2000 < len(response.time) < 4000
    t = np.linspace(0, 2e-3, 200_001)
    row, record = response.sheet().tables[0].rows[0], exact(t) / 1.2
    assert float(str(row[2]).rstrip("%")) == pytest.approx(100 * (record.max() - 1), abs=0.5)  # 64.1 %
    rise = t[np.argmax(record >= 0.9)] - t[np.argmax(record >= 0.1)]
    assert float(row[4]) == pytest.approx(rise, rel=0.05)
    assert float(row[5]) == pytest.approx(10 * np.log(0.2 / 0.024), abs=0.15)
    assert "intervals from 4.9996e-05 to 0.13794 s" in repr(response)
    impulse = time_response.impulse_response(fast_beside_slow(0.01))
    np.testing.assert_array_equal(impulse.time, response.time)
    slope = np.gradient(exact(t), t)
    at = np.searchsorted(t, impulse.time[10])
    assert impulse.outputs[10, 0, 0] == pytest.approx(
        np.interp(impulse.time[10], t[at - 3 : at + 3], slope[at - 3 : at + 3]), rel=1e-5
    )


@pytest.mark.parametrize("slow", [1e-3, 1.0])
def test_default_times_resolve_a_fast_decay_beside_a_slow_one(slow: float) -> None:
    """The output is 1.01 - exp(-1000 t), short of a slow part of 0.01; its times follow from a logarithm."""
    response = time_response.step_response(([[-slow, 0], [0, -1e3]], [[0.01 * slow], [1e3]], [[1.0, 1.0]], [[0.0]]))
    t = response.time
    np.testing.assert_allclose(
        response.outputs[:, 0, 0], -0.01 * np.expm1(-slow * t) - np.expm1(-1e3 * t), rtol=0, atol=1e-12
    )
    assert t[-1] == pytest.approx(np.log(1000) / slow) and len(t) < 1000
    row = response.sheet().tables[0].rows[0]
    rise = 1e-3 * np.log((1 - 0.1 * 1.01) / (1 - 0.9 * 1.01))
    assert float(row[4]) == pytest.approx(rise, rel=0.01)
    assert float(row[5]) == pytest.approx(-1e-3 * np.log(1 - 0.98 * 1.01), rel=0.02)


def test_the_peak_of_a_fast_impulse_response_stands_beside_a_slow_mode() -> None:
    """The difference of exp(-1000 t) and exp(-2000 t) is largest, 1/4, at ln 2 ms."""
    system = np.diag([-1e3, -2e3, -1e-2]), [[1.0]] * 3, [[1.0, -1.0, 1e-6]], [[0.0]]
    row = time_response.impulse_response(system).sheet().tables[0].rows[0]
    assert float(row[6]) == pytest.approx(0.25, abs=1e-4) and float(row[7]) == pytest.approx(1e-3 * np.log(2), rel=0.02)


def test_modes_within_a_factor_of_70_have_equally_spaced_times() -> None:
    for fast, count in ((3.0, 500), (10.0, 1381), (70.0, 9670)):
        response = time_response.step_response(1 / ((S + 1) * (S + fast)))
        np.testing.assert_allclose(np.diff(response.time), np.log(1000) / count, rtol=1e-9)
    assert len(time_response.step_response(1 / ((S + 1) * (S + 100))).time) < 1000


def test_default_times_that_cannot_resolve_an_oscillation_are_refused() -> None:
    text = r"mode at 6283\.2 rad/s needs an interval of 5e-05 s for 69\.078 s .* than 20000; give a shorter duration_s"
    with pytest.raises(TimingError, match=text):
        time_response.step_response(fast_beside_slow(0.0))
    assert np.diff(time_response.step_response(fast_beside_slow(0.0), 0.9).time).max() <= 5.01e-5
    assert len(time_response.step_response(fast_beside_slow(0.0), 10.0, 1e-3).time) == 10_001


def test_the_sheet_of_a_sampled_model_says_that_its_default_duration_is_limited() -> None:
    response = time_response.step_response(1e-4 / (Z - 1 + 1e-4))
    assert len(response.time) == 10_001 and "the slowest mode needs 69075; give duration_s" in repr(response)
    assert "limited" not in repr(time_response.step_response(1e-4 / (Z - 1 + 1e-4), 2000.0))


def test_fast_and_slow_modes_are_exact_side_by_side() -> None:
    response = time_response.step_response((np.diag([-1e6, -1e-3]), np.ones((2, 1)), np.eye(2)), 1000.0, 10.0)
    slow = (1 - np.exp(-1e-3 * response.time)) * 1e3
    np.testing.assert_allclose(response.outputs[1:, :, 0], np.column_stack([np.full(100, 1e-6), slow[1:]]), rtol=EXACT)


def test_an_impulse_through_D_is_refused_in_continuous_time_alone() -> None:
    with pytest.raises(
        ModelError, match=r"contains an impulse at t = 0, D\[y\[0\], u\[0\]\] is 1: give the model with D"
    ):
        time_response.impulse_response((S + 2) / (S + 1))
    assert time_response.impulse_response(of(([[0.5]], [[1.0]], [[1.0]], [[2.0]], Discrete(0.1)))).outputs[0, 0, 0] == 2


T = 0.1
FIGURES = ("final", "overshoot", "undershoot", "rise", "settled", "peak", "at")


def figures(system: Any) -> dict[str, str]:
    row = time_response.step_response(system).sheet().tables[0].rows[0]
    return dict(zip(FIGURES, map(str, row[1:]), strict=True))


DAMPED = float(np.sqrt(1 - 1e-4))
# Continuous models, their step responses in closed form, and whether these only approach their largest values.
CLOSED_FORMS = {
    "first order": (2 / (S + 1), lambda t: 2 * (1 - np.exp(-t)), True),
    "three equal poles": (1 / (S + 1) ** 3, lambda t: 1 - np.exp(-t) * (1 + t + t**2 / 2), True),
    "five equal poles": (
        1 / (S + 1) ** 5, lambda t: 1 - np.exp(-t) * sum(t**k / math.factorial(k) for k in range(5)), True
    ),
    "slow zero": (
        (S + 0.1) / 0.1 / (S + 1) ** 4, lambda t: 1 - np.exp(-t) * (1 + t + t**2 / 2 - 9 * t**3 / 6), False
    ),
    "non-normal triple": (
        ([[-1.0, 1e3, 0.0], [0.0, -1.0, 1e3], [0.0, 0.0, -1.0]], [[0.0], [0.0], [1.0]], [[3e-6, -2e-3, 0.0]], [[0.0]]),
        lambda t: 1 - np.exp(-t) * (1 + t + 1.5 * t**2),
        True,
    ),
    "non-minimum phase": ((1 - S) / (S + 1) ** 2, lambda t: 1 - np.exp(-t) * (1 + 2 * t), True),
    "lightly damped": (
        1 / (S**2 + 0.02 * S + 1),
        lambda t: 1 - np.exp(-0.01 * t) * (np.cos(DAMPED * t) + 0.01 / DAMPED * np.sin(DAMPED * t)),
        False,
    ),
    # Plant 1/(s (s + 1)), integral action 1 on the error, proportional 3 and derivative 2 on the output.
    "I-PD": (
        1 / (S * (S**2 + 3 * S + 3) + 1), lambda t: 1 - np.exp(-t) * (1 + t + t**2 / 2), True
    ),
}  # fmt: skip


@pytest.mark.parametrize("is_sampled", [False, True])
@pytest.mark.parametrize("name", CLOSED_FORMS)
def test_the_default_duration_shows_the_figures_of_the_closed_form(name: str, is_sampled: bool) -> None:
    system, exact, approached = CLOSED_FORMS[name]
    t = np.arange(0, 3000, T if is_sampled else T / 10)
    y = exact(t)
    model = discretise.zero_order_hold(of(system), T) if is_sampled else of(system)
    response = time_response.step_response(model)
    np.testing.assert_allclose(response.outputs[:, 0, 0], exact(response.time), rtol=0, atol=1e-9 * np.abs(y).max())
    assert response.final is not None
    final, later = float(response.final[0, 0]), t > response.time[-1]
    assert final == pytest.approx(y[-1], abs=1e-9) and not response.note
    assert np.abs(y[later] - final).max() <= time_response.REST * final
    shown, step = figures(model), np.diff(response.time).max()
    y = y / final
    assert float(shown["overshoot"].rstrip("%")) == pytest.approx(100 * max(0.0, y.max() - 1), abs=0.2)
    assert float(shown["undershoot"].rstrip("%")) == pytest.approx(max(0.0, -100 * y.min()), abs=0.2)
    outside = np.flatnonzero(np.abs(y - 1) > 0.02)[-1]
    assert float(shown["settled"]) == pytest.approx(t[outside], abs=T)
    assert (shown["at"] == "approached") == approached
    if not approached:
        assert float(shown["at"]) == pytest.approx(t[np.abs(y).argmax()], abs=step)


def test_a_record_that_ends_early_shows_its_largest_value() -> None:
    row = time_response.step_response(1 / (S + 1), 1.0).sheet().tables[0].rows[0]
    assert float(row[6]) == pytest.approx(1 - np.exp(-1), rel=1e-4) and row[5:8:2] == ("", "1")


def test_a_final_value_that_is_attained_is_a_peak() -> None:
    dead_beat, direct = figures(1 / Z), figures(control.ss([], [], [], [[2.0]], 0))
    assert (dead_beat["peak"], dead_beat["at"], direct["peak"], direct["at"]) == ("1", "0.1", "2", "0")


def test_no_later_output_exceeds_the_bound_of_the_remainder() -> None:
    rng = np.random.default_rng(9)
    for mine in (model(), model(0.05)):
        period = None if mine.time == Continuous() else 0.05
        for _ in range(10):
            X = rng.standard_normal((4, 2))
            free = [
                time_response.forced_response(
                    mine, {"f": np.zeros(2000)}, None if period else 0.005, dict(zip(mine.states, x, strict=True))
                )
                for x in X.T
            ]
            bound = time_response._tail_bound(mine.A, mine.C, mine.time)(X)
            largest = np.abs(np.array(free)).max(axis=1).T
            assert (largest <= bound * (1 + 1e-9)).all() and (bound < 10 * largest).all()
    one = of(([[-2.0]], [[1.0]], [[3.0]], [[0.0]]))
    assert time_response._tail_bound(one.A, one.C, one.time)(np.array([[5.0]]))[0, 0] == pytest.approx(15.0)
    sampled = of(([[0.5]], [[1.0]], [[3.0]], [[0.0]], Discrete(0.1)))
    assert time_response._tail_bound(sampled.A, sampled.C, sampled.time)(np.array([[5.0]]))[0, 0] == pytest.approx(15.0)


@pytest.mark.parametrize("period", [None, 0.05])
def test_a_forced_response_from_initial_states_is_that_of_python_control(period: float | None) -> None:
    mine, rng = model(period), np.random.default_rng(5)
    f, g, x0 = rng.standard_normal(40), rng.standard_normal(40), rng.standard_normal(4)
    initial = dict(zip(mine.states, x0, strict=True))
    ours = time_response.forced_response(
        mine, {"g": g, "f": f}, None if period else 0.05, initial, linear=period is None
    )
    theirs = control.forced_response(mine.to_control(), 0.05 * np.arange(40), [f, g], x0)
    np.testing.assert_allclose(ours, theirs.outputs.T, rtol=0, atol=1e-11)


def test_held_inputs_give_the_response_of_the_hold_and_superpose() -> None:
    continuous, rng = model(), np.random.default_rng(6)
    f, x0 = rng.standard_normal(30), {"a": 1.0, "d": -2.0}
    both = time_response.forced_response(continuous, {"f": f, "g": 3.0}, 0.05, x0)
    np.testing.assert_array_equal(both, time_response.forced_response(model(0.05), {"f": f, "g": 3.0}, initial=x0))
    parts = [
        time_response.forced_response(continuous, inputs, 0.05, start)
        for inputs, start in (({"f": f}, {}), ({"g": np.full(30, 3.0)}, {}), ({"f": np.zeros(30)}, x0))
    ]
    np.testing.assert_allclose(both, sum(parts), rtol=0, atol=1e-11)


def test_forced_responses_have_closed_forms() -> None:
    t = 0.01 * np.arange(200)
    free = time_response.forced_response(([[-2.0]], [[1.0]]), {"u1": np.zeros(200)}, 0.01, {"x1": 3.0})
    np.testing.assert_allclose(free[:, 0], 3 * np.exp(-2 * t), rtol=EXACT)
    ramp = time_response.forced_response(1 / S, {"u[0]": t}, 0.01, linear=True)
    np.testing.assert_allclose(ramp[:, 0], t**2 / 2, rtol=0, atol=EXACT)
    step = time_response.forced_response(1 / (S + 2), {"u[0]": np.ones(200)}, 0.01)
    np.testing.assert_allclose(step[:, 0], (1 - np.exp(-2 * t)) / 2, rtol=0, atol=EXACT)


def test_a_forced_response_that_overflows_is_refused() -> None:
    with pytest.raises(ModelError, match="the response grows beyond"):
        time_response.forced_response(([[2e3]], [[1.0]]), {"u1": np.ones(1000)}, 0.01)


@pytest.mark.parametrize("time", [Continuous(), Discrete(1e-3)])
def test_a_model_without_outputs_has_an_empty_response(time: Any) -> None:
    model = StateSpace(
        [[-1.0 if isinstance(time, Continuous) else 0.9]],
        [[1.0]],
        np.zeros((0, 1)),
        np.zeros((0, 1)),
        ("x",),
        ("u",),
        (),
        time,
    )
    for response in (time_response.step_response(model), time_response.impulse_response(model)):
        assert response.outputs.shape[1:] == (0, 1) and len(response.time) > 1
