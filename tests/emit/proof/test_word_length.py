"""What float32 does to linear dynamics, as predicted, beside NumPy's recursions, an hour and a day of the C."""

from collections.abc import Callable
from math import cos, pi, sin
from typing import Any

import casadi as ca
import numpy as np
import pytest
from scipy import signal

from synth.block import Block, Constant, State, Step, build
from synth.blocks.laws import biquad, linear_block
from synth.composition import compose
from synth.emit.proof.word_length import LinearPart, summary
from synth.emit.write import emit
from synth.errors import EmitError, SignalError
from synth.execute import host
from synth.signals import Signal
from synth.statespace import StateSpace
from synth.timing import Discrete

F32 = np.float32
U = Signal("u", "m", -1, 1)
Model = tuple[Any, Any, Any, Any]


def make(law: Callable[..., Step], states: dict[str, float], constants: dict[str, float], rate: float = 1e3) -> Block:
    """Return a Block from u to y with constants, and states of given bounds."""
    return build(
        "made",
        Discrete(1 / rate),
        law,
        inputs=[U],
        outputs=[Signal("y", "m", -1e9, 1e9)],
        states=[State(Signal(n, "m", -b, b), 0.0) for n, b in states.items()],
        constants=[Constant(n, v, "1", "test") for n, v in constants.items()],
    )


def parts(block: Block, scalar: type[np.floating] = F32) -> tuple[LinearPart, ...]:
    return emit(block, scalar, gain_error=np.inf).parts


def of(model: Model, rate: float, bound: float) -> Block:
    """Return the Block of a discrete model (A, B, C, D) with one input and one output."""
    names = tuple(f"x{k}" for k in range(len(model[0])))
    system = StateSpace(*model, names, ("u",), ("y",), Discrete(1 / rate))
    states = [Signal(n, "m", -bound, bound) for n in names]
    return linear_block.block("made", system, inputs=[U], outputs=[Signal("y", "m", -99, 99)], states=states, tag="t")


def direct(hertz: float, rate: float) -> Model:
    """Return a Butterworth low-pass of order 2 in direct form, whose states have a DC gain of 1."""
    A, B, C, D = signal.tf2ss(*signal.butter(2, hertz, fs=rate))
    scale = np.linalg.solve(np.eye(2) - A, B)[0, 0]
    return A, B / scale, C * scale, D


def rotated(hertz: float, rate: float) -> Model:
    """Return the same filter with a rotation of its states, [[a, b], [-b, a]] for the poles a +- ib."""
    A, B, C, D = direct(hertz, rate)
    v = np.linalg.eig(A)[1][:, 0]
    T = np.column_stack([v.real, v.imag])
    return np.linalg.solve(T, A @ T), np.linalg.solve(T, B), C @ T, D


def resting_output(model: Model, u: float, steps: int, scalar: type[np.floating]) -> float:
    """Return y after many steps of a recursion in a scalar type with the coefficients of float32."""
    A, B, C, D = (np.asarray(m, F32).astype(scalar) for m in model)
    x, w = np.zeros((len(A), 1), scalar), scalar(u)
    for _ in range(steps):
        x = A @ x + B * w
    return float((C @ x + D * w)[0, 0])


@pytest.mark.parametrize("form", [direct, rotated])
@pytest.mark.parametrize(("hertz", "rate"), [(1, 1e4), (3, 1e4), (5, 1e3), (20, 1e3), (100, 1e3)])
def test_the_dc_gain_is_that_of_a_recursion_with_rounded_coefficients(form: Any, hertz: float, rate: float) -> None:
    model, steps = form(hertz, rate), int(4 * rate / hertz)
    (part,) = parts(of(model, rate, 9.0))
    assert part.gain is not None and (part.gain.input, part.gain.output) == ("u", "y")
    assert part.gain.exact == pytest.approx(1, abs=1e-6)
    assert resting_output(model, 1.0, steps, np.float64) == pytest.approx(part.gain.rounded, abs=1e-6)


def test_a_slow_low_pass_loses_its_dc_gain_in_direct_form_alone() -> None:
    gains = [g for form in (direct, rotated) if (g := parts(of(form(1, 1e4), 1e4, 9.0))[0].gain)]
    assert gains[0].rounded == pytest.approx(0.946, abs=5e-4) and gains[1].rounded == pytest.approx(1, abs=3e-4)
    with pytest.raises(
        EmitError, match=r"DC gain from 'u' to 'y' is 1, but .* float32 0\.94.*: write the states x0, x1"
    ):
        emit(of(direct(1, 1e4), 1e4, 9.0), F32)
    emit(of(rotated(1, 1e4), 1e4, 9.0), F32)
    emit(of(direct(1, 1e4), 1e4, 9.0), np.float64)
    emit(of(direct(1, 1e4), 1e4, 9.0), F32, gain_error=0.1)


def test_the_low_pass_of_the_toolkit_keeps_its_dc_gain() -> None:
    block = biquad.block("slow", Discrete(1e-4), U, "y", poles=(2 * pi, 0.7071))
    (part,) = emit(block, F32).parts
    assert part.gain is not None and part.gain.error < 2e-5 and part.shift < 2e-5
    u = np.full(30_000, 0.75)
    u[0] = 0.0
    y = host.compile_block(block).replay({"u": u, "ready": np.ones(len(u))}).outputs["y"]
    assert y[-1] == pytest.approx(0.75, rel=2e-5)


@pytest.mark.parametrize(("form", "hertz", "rate"), [(direct, 20, 1e3), (rotated, 1, 1e4), (rotated, 20, 1e3)])
def test_states_rest_within_their_dead_band(form: Any, hertz: float, rate: float) -> None:
    model = form(hertz, rate)
    (part,) = parts(of(model, rate, 1.0))
    steps = int(4 * rate / hertz)
    gain = resting_output(model, 1.0, steps, np.float64)
    ends = [resting_output(model, u, steps, F32) - u * gain for u in (0.3, 0.7, -0.9)]
    assert 0 < np.abs(ends).max() < part.lost * np.abs(model[2]).sum()


def rotation(hertz: float, rate: float = 1e3) -> Block:
    c, s = cos(2 * pi * hertz / rate), sin(2 * pi * hertz / rate)

    def law(u: Any, x: Any, k: Any) -> Step:
        p, q = k["c"] * x["p"] - k["s"] * x["q"], k["s"] * x["p"] + k["c"] * x["q"]
        return Step({"y": p}, {"p": ca.if_else(u["u"] > 0, 0.5, p), "q": ca.if_else(u["u"] > 0, 0, q)})

    return make(law, {"p": 1.0, "q": 1.0}, {"c": c, "s": s}, rate)


def test_an_oscillation_keeps_in_an_hour_of_the_c_what_is_predicted() -> None:
    (part,) = parts(rotation(7.0))
    assert part.amplitude == pytest.approx(0.931, abs=5e-4)
    u = np.zeros(3_600_001)
    u[0] = 1.0  # sets the state
    y = host.compile_block(rotation(7.0)).replay({"u": u}).outputs["y"]
    assert np.abs(y[-1000:]).max() / 0.5 == pytest.approx(part.amplitude, abs=1e-3)


@pytest.mark.whole
def test_a_day_of_the_c_at_1_khz_drifts_no_further_than_predicted() -> None:
    """An oscillator, a low-pass of 0.05 Hz, an integrator, and one under less than its dead band, for 86.4e6 steps."""
    c, s = cos(0.014 * pi), sin(0.014 * pi)  # 7 Hz

    def law(u: Any, x: Any, k: Any) -> Step:
        p, q = k["c"] * x["p"] - k["s"] * x["q"], k["s"] * x["p"] + k["c"] * x["q"]
        oscillation = {"p": ca.if_else(u["u"] > 0.99, 0.5, p), "q": ca.if_else(u["u"] > 0.99, 0, q)}
        sums = {f"s_{name}": x[f"s_{name}"] + k["k"] * u[name] for name in ("hum", "still")}
        slow = x["slow"] + k["a"] * (u["level"] - x["slow"])
        return Step(
            {"y": p, "low": x["slow"], "sum": x["s_hum"], "rest": x["s_still"]}, oscillation | sums | {"slow": slow}
        )

    states = [State(Signal(n, "m", -b, b), v) for n, b, v in
              (("p", 1, 0.0), ("q", 1, 0.0), ("s_hum", 10, 5.0), ("s_still", 10, 5.0), ("slow", 1, 0.0))]  # fmt: skip
    values = {"c": c, "s": s, "k": 1e-3, "a": 1e-4 * pi}
    block = build(
        "day",
        Discrete(1e-3),
        law,
        inputs=[Signal(n, "m", -1, 1) for n in ("u", "level", "hum", "still")],
        outputs=[Signal(n, "m", -20, 20) for n in ("y", "low", "sum", "rest")],
        states=states,
        constants=[Constant(n, v, "1", "test") for n, v in values.items()],
    )
    by_state = {part.states[0]: part for part in parts(block)}
    controller, state, hour = host.compile_block(block), None, 3_600_000
    time = np.arange(hour) * 1e-3
    worst, exact = 0.0, 5.0
    for h in range(24):
        hum = np.sin(2 * pi * 1.2345678 * time + h).astype(F32)  # no whole periods: rounding takes all phases
        inputs: dict[str, Any] = {"u": (time == 0) & (h == 0), "level": 0.7, "still": 0.49 * by_state["s_still"].lost}
        made = controller.replay({**inputs, "hum": hum}, state)
        state, y = made.state, made.outputs
        sums = exact + np.cumsum(float(F32(1e-3)) * hum.astype(float))
        worst, exact = max(worst, np.abs(y["sum"][1:] - sums[:-1]).max()), sums[-1]
    predicted = by_state["p"].amplitude
    assert predicted is not None and np.abs(y["y"][-1000:]).max() / 0.5 == pytest.approx(predicted**24, rel=0.01)
    assert np.abs(y["low"] - 0.7).max() < by_state["slow"].lost
    assert (y["rest"] == 5.0).all()  # below 5 a unit in the last place is half that at the bound of 10
    assert worst < 24 * hour * float(F32(1e-3)) * by_state["s_hum"].lost  # that of each step has one sign
    assert worst < 4e-3  # and they are as good as independent: three times sqrt(n / 3) of half a unit at 5


@pytest.mark.parametrize("hertz", [0.5, 1.3, 11.0, 50.0, 123.0])
def test_an_oscillation_keeps_what_a_power_of_its_matrix_does(hertz: float) -> None:
    (part,) = parts(rotation(hertz))
    c, s = (float(F32(f(2 * pi * hertz / 1e3))) for f in (cos, sin))
    power = np.linalg.matrix_power(np.array([[c, -s], [s, c]]), 3_600_000)
    assert part.amplitude == pytest.approx(np.linalg.norm(power, 2), rel=1e-9)
    assert part.pole.imag == pytest.approx(abs(sin(2 * pi * hertz / 1e3)))


def integrator(k: float, bound: float = 10.0) -> Block:
    return make(lambda u, x, c: Step({"y": x["s"]}, {"s": x["s"] + c["k"] * u["u"]}), {"s": bound}, {"k": k})


@pytest.mark.parametrize(("k", "bound"), [(1.001, 10.0), (0.3, 10.0), (0.007, 2.0), (33.3, 100.0), (5e-4, 0.3)])
def test_an_integrator_does_not_integrate_what_is_below_half_a_unit(k: float, bound: float) -> None:
    (part,) = parts(integrator(k, bound))
    assert part.gain is None and part.input is not None and part.input.name == "u" and part.at.name == "s"
    x = np.nextafter(F32(bound), F32(0))
    assert x + F32(k) * F32(0.99 * part.lost) == x and x - F32(k) * F32(1.01 * part.lost) != x


def test_the_dead_band_of_an_integrator_is_said_with_its_input() -> None:
    text = summary(parts(integrator(1.0 + 1e-9)), "float32")
    assert text[-1] == "s: no u below 4.8e-07 m is integrated at the bound of s"


def low_pass(a: float) -> Block:
    return make(lambda u, x, k: Step({"y": x["s"]}, {"s": k["a"] * x["s"] + k["b"] * u["u"]}), {"s": 9.0},
                {"a": a, "b": 1 - a})  # fmt: skip


def test_a_filter_that_becomes_an_integrator_is_refused() -> None:
    emit(low_pass(0.999), F32)
    with pytest.raises(EmitError, match=r"to 's' is 1, but with the coefficients of float32 inf"):
        emit(low_pass(1 - 1e-8), F32)
    emit(low_pass(1 - 1e-8), np.float64)


SAME: list[tuple[Callable[..., Any], int]] = [
    (lambda u, x, k: k["a"] * x["s"] + u["u"], 1),
    (lambda u, x, k: x["s"] + (k["a"] - 1) * x["s"] + u["u"], 1),
    (lambda u, x, k: u["u"] - (-k["a"]) * x["s"], 1),
    (lambda u, x, k: ca.if_else(u["u"] > 0.5, x["s"], k["a"] * x["s"] + u["u"]), 1),
    (lambda u, x, k: ca.fmin(k["a"] * x["s"] + u["u"], 3), 1),
    (lambda u, x, k: k["a"] * ca.if_else(u["u"] > 0.5, x["s"] + 2 * u["u"], x["s"]) + u["u"], 1),
    (lambda u, x, k: x["s"] / (1 / k["a"]) + ca.sin(x["s"]), 1),
    (lambda u, x, k: ca.sin(k["a"] * x["s"]) + u["u"], 0),
    (lambda u, x, k: x["s"] * u["u"], 0),
    (lambda u, x, k: u["u"], 0),
]


@pytest.mark.parametrize(("next", "count"), SAME)
def test_linear_dynamics_are_known_in_every_form(next: Callable[..., Any], count: int) -> None:
    made = parts(make(lambda u, x, k: Step({"y": x["s"]}, {"s": next(u, x, k)}), {"s": 5.0}, {"a": 0.75}))
    assert [part.pole for part in made] == pytest.approx([0.75] * count)


@pytest.mark.parametrize(
    ("order", "hertz", "kind", "rate"),
    [(4, 1.0, "low", 1e4), (4, 10.0, "high", 1e4), (2, [10.0, 20.0], "band", 1e4), (3, 1.0, "low", 1e4),
     (4, 1.0, "high", 1e3)],
)  # fmt: skip
def test_a_filter_that_becomes_unstable_is_refused(order: int, hertz: Any, kind: str, rate: float) -> None:
    """Its DC gain alone would not show it: that of a band-pass is 0, and (1 - z)^4 near z = 1 is like an integrator."""
    b, a = signal.butter(order, hertz, kind, fs=rate)
    A, B, C, D = signal.tf2ss(b / np.abs(b).max(), a)
    assert np.abs(np.linalg.eigvals(A)).max() < 1 < np.abs(np.linalg.eigvals(np.float32(A).astype(float))).max()
    block = of((A, B, C * 1e-12, D * 1e-12), rate, 1e6)
    with pytest.raises(EmitError, match=r"have a pole with \|z\| = 0.99\d+, but with .* float32 1\.\d+, which is unst"):
        emit(block, F32)
    emit(block, np.float64)
    emit(block, F32, gain_error=np.inf)
    fast = signal.butter(2, [0.01 * rate, 0.02 * rate], "band", fs=rate)
    A, B, C, D = signal.tf2ss(*fast)
    emit(of((A, B, C * 1e-6, D), rate, 1e6), F32)


def test_a_gain_that_is_zero_by_design_is_left_alone() -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        s = k["a"] * x["s"] + k["b"] * u["u"]
        return Step({"y": u["u"] - s}, {"s": s})

    (part,) = emit(make(law, {"s": 5.0}, {"a": 0.99, "b": 1 - 0.99}), F32).parts
    assert part.gain is None and part.pole == 0.99


def test_parts_of_a_composition_are_its_blocks() -> None:
    y = Signal("y", "m", -99, 99)
    second = build("second", Discrete(1e-3), lambda u, x, k: Step({"z": x["s"]}, {"s": 0.5 * x["s"] + u["y"]}),
                   inputs=[y], outputs=[Signal("z", "m", -999, 999)],
                   states=[State(Signal("s", "m", -200, 200), 0)])  # fmt: skip
    both = compose("both", [low_pass(0.9).renamed({}), second], inputs=["u"], outputs=["z"])
    assert {p.states: round(p.pole.real, 6) for p in emit(both, F32).parts} == {("made_s",): 0.9, ("second_s",): 0.5}


@pytest.mark.parametrize("value", [1e-46, -3e-47, 1e-60])
def test_a_constant_that_becomes_zero_is_refused_by_name(value: float) -> None:
    with pytest.raises(SignalError, match=r"constant 'k' is .*, which is 0 in float32: scale it"):
        emit(integrator(value), F32)
    with pytest.raises(EmitError, match=r"the number .* is 0 in float: scale the expression"):
        emit(make(lambda u, x, k: Step({"y": value * u["u"]}), {}, {}), F32)
    emit(integrator(value), np.float64)


def test_a_product_of_constants_that_becomes_zero_is_refused_by_name() -> None:
    law = lambda u, x, k: Step({"y": k["a"] * (k["b"] * u["u"])})  # noqa: E731
    with pytest.raises(SignalError, match="constant 'a_times_b' is 1e-60"):
        emit(make(law, {}, {"a": 1e-30, "b": 1e-30}), F32)
    emit(make(law, {}, {"a": 1e-10, "b": 1e-30}), F32)
