"""Linear models against python-control, and what their shapes and names refuse."""

from typing import Any

import control
import numpy as np
import pytest
import scipy.signal

from synth.errors import ModelError, SignalError, TimingError
from synth.statespace import StateSpace, from_control, of
from synth.timing import Continuous, Discrete, Time

TIMES: list[Time] = [Continuous(), Discrete(1e-3)]


def model(time: Time, n: int = 4, m: int = 2, p: int = 3) -> StateSpace:
    rng = np.random.default_rng(n + 10 * m + 100 * p)
    A, B, C, D = (rng.normal(size=shape) for shape in ((n, n), (n, m), (p, n), (p, m)))
    labels = [tuple(f"{letter}{i}" for i in range(k)) for letter, k in (("x", n), ("u", m), ("y", p))]
    return StateSpace(0.4 * A, B, C, D, *labels, time)


def change(**fields: Any) -> StateSpace:
    good = model(Continuous())
    return StateSpace(**{name: getattr(good, name) for name in good.__dataclass_fields__} | fields)


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("n", [0, 4])
def test_the_way_to_python_control_and_back_keeps_everything(time: Time, n: int) -> None:
    first = model(time, n)
    back = from_control(first.to_control())
    for letter in "ABCD":
        np.testing.assert_array_equal(getattr(back, letter), getattr(first, letter))
    assert (back.states, back.inputs, back.outputs) == (first.states, first.inputs, first.outputs)
    assert back.time == time


@pytest.mark.parametrize("time", TIMES)
def test_response_and_poles_agree_with_python_control(time: Time) -> None:
    mine = model(time)
    theirs = mine.to_control()
    points = np.array([1j, 3 - 2j, np.exp(0.3j)])
    expected = np.array([theirs(v) for v in points])
    np.testing.assert_allclose(mine.response(points), expected, rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(mine.poles, np.sort_complex(theirs.poles()), rtol=1e-11)
    np.testing.assert_allclose(mine.channel("y2", "u1").response(points)[:, 0, 0], expected[:, 2, 1], rtol=1e-11)


def test_a_static_gain_responds_with_itself() -> None:
    static = model(Continuous(), 0)
    np.testing.assert_array_equal(static.response([0, 5j]), [static.D, static.D])
    assert static.poles.size == 0


@pytest.mark.parametrize("dt", [None, True])
def test_a_system_without_a_time_base_is_refused(dt: object) -> None:
    with pytest.raises(SignalError, match="no sample period"):
        from_control(control.ss([[0.5]], [[1]], [[1]], [[0]], dt))


@pytest.mark.parametrize(
    ("fields", "text"),
    [
        ({"A": np.zeros((4, 3))}, r"A has shape \(4, 3\) but the signal names require \(4, 4\)"),
        ({"D": np.zeros(2)}, r"D has shape \(2,\)"),
        ({"B": np.full((4, 2), np.nan)}, r"B\[0, 0\] is nan, that of '.*' by '.*': all entries must be finite"),
        ({"C": np.diag([1, 1, np.inf, 1])[:3]}, r"C\[2, 2\] is inf"),
        ({"A": 1j * np.eye(4)}, "entries of A are no real numbers .they are complex"),
        ({"A": "text"}, "`A` of `StateSpace` is 'text': give an array of numbers"),
        ({"B": [[1.0, 2.0], [1.0]]}, "entries of B are no real numbers"),
        ({"states": ("a", "b", "a", "c")}, "twice among the states"),
        ({"outputs": ("a", "b", "b")}, "twice among the outputs"),
    ],
)
def test_what_does_not_fit_is_refused(fields: dict[str, Any], text: str) -> None:
    with pytest.raises(SignalError, match=text):
        change(**fields)


def test_a_number_is_no_time() -> None:
    with pytest.raises(TimingError, match=r"`time` of `StateSpace` is 0\.1: give a Continuous or a Discrete"):
        change(time=0.1)


def test_an_unknown_channel_is_refused_with_the_known_ones() -> None:
    with pytest.raises(SignalError, match="'y9' is not one of y0, y1, y2"):
        model(Continuous()).channel("y9", "u0")
    with pytest.raises(SignalError, match="'y0' is not one of u0, u1"):
        model(Continuous()).channel("y0", "y0")


def test_matrices_are_copies_that_cannot_be_written() -> None:
    A = np.zeros((4, 4))
    mine = change(A=A)
    A[0, 0] = 7
    assert mine.A[0, 0] == 0
    with pytest.raises(ValueError, match="read-only"):
        mine.A[0, 0] = 1


def test_arrays_and_python_control_systems_are_read_as_models() -> None:
    arrays = ([[0.5, 1.0], [0.0, 0.2]], [[0.0], [1.0]], [[1.0, 0.0]], [[0.0]])
    for system in ((*arrays, Discrete(0.1)), (*arrays, 0.1), control.ss(*arrays, 0.1)):
        model = of(system)
        assert model.time == Discrete(0.1)
        for letter, value in zip("ABCD", arrays, strict=True):
            np.testing.assert_array_equal(getattr(model, letter), value)
    assert of(arrays).time == of((*arrays, 0)).time == Continuous()
    assert of(arrays) is not None and of(arrays).outputs == ("y1",)


def test_a_model_is_read_as_itself_and_a_transfer_function_by_its_response() -> None:
    mine = model(Continuous())
    assert of(mine) is mine
    np.testing.assert_allclose(of(control.tf([2, 1], [1, 3, 5])).response(2j)[0, 0, 0], (4j + 1) / (6j + 1), rtol=1e-14)


@pytest.mark.parametrize("dt", [None, 0.1])
def test_systems_of_scipy_are_read(dt: float | None) -> None:
    options = {} if dt is None else {"dt": dt}
    form = scipy.signal.TransferFunction([2.0, 1.0], [1.0, 3.0, 5.0], **options)
    for system in (form, form.to_ss(), form.to_zpk()):
        model = of(system)
        assert model.time == (Continuous() if dt is None else Discrete(dt)) and model.states == ("x1", "x2")
        np.testing.assert_allclose(model.response(2j)[0, 0, 0], (4j + 1) / (6j + 1), rtol=1e-12)


def test_a_response_is_asked_for_at_a_list_of_points_off_the_poles() -> None:
    system = of(([[1.0, 0.0], [0.0, -2.0]], [[1.0], [1.0]]))
    with pytest.raises(ModelError, match=r"the response has no value at -2, a pole: leave it out"):
        system.response([3.0, -2.0, 1j])
    with pytest.raises(SignalError, match=r"the points have shape \(1, 2\): give a list"):
        system.response([[3.0, 4.0]])
    with pytest.raises(SignalError, match="the points are not numbers"):
        system.response("a")


def test_a_model_that_python_control_does_not_hold_is_refused() -> None:
    with pytest.raises(SignalError, match=r"no model with 0 inputs and 1 outputs .*: give it at least one of each"):
        of(([[-1.0]], np.zeros((1, 0)))).to_control()


def test_a_model_of_200_states_prints_its_ends() -> None:
    shown = repr(of((np.eye(200), np.ones((200, 1)), np.ones((1, 200)))))
    assert len(shown) < 10_000 and "d/dt x1 " in shown and "y1" in shown and "d/dt x100" not in shown


def test_all_states_are_outputs_where_no_C_is_given() -> None:
    model = of((np.diag([1.0, 2.0]), [[1.0], [1.0]]))
    assert model.states == model.outputs == ("x1", "x2") and model.inputs == ("u1",)
    np.testing.assert_array_equal(model.C, np.eye(2))


@pytest.mark.parametrize(
    ("system", "message"),
    [
        (3.0, "float is not a linear model"),
        ((), "0 arrays make no linear model"),
        (([[1.0]],), "1 arrays make no linear model"),
        (([[1.0]], [[1.0]], [[1.0]], [[1.0]], None), "no sample period, dt is None"),
        (([[1.0]], [[1.0]], [[1.0]], [[1.0]], True), "no sample period, dt is True"),
        (([[1.0]], [[1.0]], [[1.0]], [[1.0]], "x"), "no sample period, dt is 'x'"),
        (([[1.0]], [[1.0]], [[1.0]], [[1.0]], np.array([0.1])), "no sample period, dt is array"),
        (scipy.signal.dlti([1.0], [1.0, 0.5]), "no sample period, dt is True"),
        (scipy.signal.TransferFunction([1.0, 2.0, 3.0], [1.0, 2.0]), "has no state-space form .*: give A, B, C, D"),
        (([[1.0, 2.0]], [[1.0]]), "A has shape"),
        (([1.0, 2.0], [[1.0]]), "A has shape .2,.: give a matrix"),
        (([["a"]], [[1.0]]), "entries of A are no real numbers"),
        (([[1j]], [[1.0]]), "entries of A are no real numbers .they are complex"),
        (([[1.0]], [[np.nan]]), "B.0, 0. is nan"),
        (control.ss([[0.5]], [[1]], [[1]], [[0]], True), "no sample period"),
    ],
)
def test_what_is_no_model_is_refused(system: Any, message: str) -> None:
    with pytest.raises(SignalError, match=message):
        of(system)


def test_units_follow_the_signals() -> None:
    changed = change(units={"x0": "m", "u1": "A", "y2": "m", "gone": "s"})
    assert changed.units == {"x0": "m", "u1": "A", "y2": "m"} and changed.unit("x1") == ""
    assert changed.renamed({"x0": "gap"}).unit("gap") == "m" and changed.channel("y2", "u1").unit("u1") == "A"
    assert "d/dt x0 [m]" in repr(changed) and "u1 [A]" in repr(changed)
    with pytest.raises(SignalError, match="unit 'mm'"):
        change(units={"x0": "mm"})


def test_some_outputs_and_inputs_are_selected_in_the_order_given() -> None:
    mine = model(Continuous())
    part = mine.select(("y2", "y0"), ("u1",))
    np.testing.assert_allclose(part.response(3j)[0], mine.response(3j)[0][np.ix_([2, 0], [1])], rtol=1e-13)
    with pytest.raises(SignalError, match="'u7' is not one of u0, u1"):
        mine.select(("y0",), ("u7",))


def test_nothing_of_a_transfer_function_is_cancelled() -> None:
    """A minimal realisation would lose the unstable pole that (s - 1) / (s^2 - 1) hides."""
    model = of(control.tf([1, -1], [1, 0, -1]))
    np.testing.assert_allclose(np.sort(model.poles.real), [-1, 1], atol=1e-12)
    assert model.response(2.0)[0, 0, 0] == pytest.approx(1 / 3)


def test_transfer_functions_of_several_channels_are_read() -> None:
    theirs = control.tf([[[1.0], [2.0, 1.0]], [[3.0], [0.0]]], [[[1.0, 2.0], [1.0, 1.0, 5.0]], [[4.0], [1.0]]], 0.1)
    mine = of(theirs)
    for z in (0.3, np.exp(0.4j)):
        np.testing.assert_allclose(mine.response(z)[0], theirs(z), rtol=1e-13)
    assert mine.time == Discrete(0.1) and len(mine.states) == 3


@pytest.mark.parametrize(
    ("numerator", "denominator", "message"),
    [
        ([np.nan], [1, 0.2, 1, 0], "not finite"),
        ([1, 0, 0], [1, 1], "its degree must be at least"),
        ([1], [np.inf, 1], "not finite"),
    ],
)
def test_a_transfer_function_without_a_model_is_refused(numerator: Any, denominator: Any, message: str) -> None:
    with pytest.raises(SignalError, match=message):
        of(control.tf(numerator, denominator))
