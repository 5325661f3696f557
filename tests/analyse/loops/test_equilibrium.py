"""The equilibrium of plant and controller together; opened there, the loop is that of the linear parts."""

import casadi as ca
import numpy as np
import pytest

from synth.analyse import operating_points
from synth.analyse.loops import equilibrium, loop, stability_margins
from synth.block import Block, Exprs, State, Step, build
from synth.blocks.guard import safe_output, safety
from synth.composition import compose
from synth.errors import ModelError, SignalError
from synth.plant import Plant
from synth.plant import build as plant_of
from synth.signals import Parameter, Signal
from synth.timing import Discrete
from tests import tolerances

T = 0.01
TIME = Discrete(T)
KP, KD, KI, TAP, WEIGHT = 60.0, 10.0, 0.5, 0.2, 9.81
GAP, SPEED, CURRENT = Signal("gap", "m", -1, 1), Signal("speed", "m/s", -10, 10), Signal("i", "A", 0, 10)
PUSH = Signal("push", "N", -5, 5)
WISH, DRIVE = Signal("wish", "m", -1, 1), Signal("drive", "A", 0, 10)
SENSORS, ACTUATORS = {"q": "gap"}, {"i": "drive"}


def levitation_plant() -> Plant:
    """A mass of 1 kg with its weight, a force of 2 N/A^2 i^2 and a magnet of -4 N/m."""

    def physics(x: Exprs, u: Exprs, p: Exprs) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        pull = p["k"] * u["i"] ** 2 - WEIGHT + 4 * x["gap"] + u["push"]
        return {"gap": x["speed"], "speed": pull}, {"gap": x["gap"]}

    k = Parameter("k", 2.0, "N/A^2", 0.1, "test")
    return plant_of("levitated", [GAP, SPEED], [CURRENT, PUSH], [GAP], [k], physics)


def pid_block(integral: float = 1.0, tap: float = 0.0, toggles: bool = False) -> Block:
    """PID with an inverse root, whose slope is infinite at zero force; `tap` feeds the last command back."""

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        e = u["q_held"] - u["wish_held"]
        sum_ = integral * (x["sum"] - KI * e)
        force = sum_ - KP * e - KD * (e - x["last"]) / T - tap * x["before"]
        next = {"last": e, "sum": sum_, "before": force}
        if toggles:
            next["flag"] = ca.if_else(x["flag"] > 0, 0, 1)
        return Step({"drive_computed": ca.sqrt(ca.fmax(force, 0) / 2)}, next)

    bounds = {"last": 2.0, "sum": 40.0, "before": 100.0}
    states = [State(Signal(n, "1", -b, b), 0) for n, b in bounds.items()]
    states += [State(Signal("flag", "1", 0, 1), 0, True)] if toggles else []
    q = Signal("q", "m", -0.5, 0.5)
    inputs = [safety.GuardedInput(q, 0.0, True), safety.GuardedInput(WISH, 0.0, False)]
    rest = safety.Safety(3, {"drive": 0.0}, {"drive": 100.0}, "it falls on its feet")
    blocks = [
        safety.guard(TIME, inputs, 3),
        build(
            "law",
            TIME,
            law,
            inputs=[Signal("q_held", "m", -0.5, 0.5), Signal("wish_held", "m", -1, 1)],
            outputs=[Signal("drive_computed", "A", -100, 100)],
            states=states,
        ),
        safe_output.block(TIME, [DRIVE], rest),
    ]
    return compose("held", blocks, inputs=["q", "wish"], outputs=["drive"])


def at(gap: float, **options: float) -> equilibrium.Equilibrium:
    near = operating_points.trim(levitation_plant(), {"gap": gap}, ["i"])
    closed = equilibrium.SampledLoop(levitation_plant(), pid_block(**options), SENSORS, ACTUATORS)
    return equilibrium.solve(closed, {"wish": gap}, near)


def expected_loop(z: np.ndarray, gap: float, tap: float) -> np.ndarray:
    """L at the current: the slopes of the square and of its root cancel."""
    c, s = np.cosh(2 * T), np.sinh(2 * T)
    plant = ((c - 1) / 4 * (z - c) + s / 2 * s / 2) / ((z - c) ** 2 - s**2)
    pid = KP + KD * (z - 1) / (T * z) + KI * z / (z - 1)
    return pid / (1 + tap / z) / z * plant


@pytest.mark.parametrize("gap", [0.0, 0.3, -0.4])
def test_the_integrator_rests_at_the_force_that_the_plant_needs(gap: float) -> None:
    rest = at(gap)
    assert rest.state["law_sum"] == pytest.approx(WEIGHT - 4 * gap, rel=1e-7)
    assert rest.point["i"] == pytest.approx(np.sqrt((WEIGHT - 4 * gap) / 2), rel=1e-7)
    assert rest.state["safe_output_last_drive"] == pytest.approx(rest.point["i"], rel=1e-7)
    assert (rest.state["guard_ready"], rest.state["guard_latched"]) == (1.0, 0.0)
    assert rest.inputs == {"q": pytest.approx(gap, abs=1e-7), "wish": gap}
    f = rest.closed.controller.function()
    next, _ = f(list(rest.state.values()), list(rest.inputs.values()))
    np.testing.assert_allclose(np.asarray(next).ravel(), list(rest.state.values()), rtol=0, atol=1e-7)


def test_at_its_initial_state_the_controller_has_no_finite_slope() -> None:
    with pytest.raises(SignalError, match="all entries must be finite"):
        loop.linearise_block(pid_block(), {"guard_ready": 1.0}, {"q": 0.3, "wish": 0.3})


@pytest.mark.parametrize("tap", [0.0, TAP])
@pytest.mark.parametrize("signal", ["i", "q"])
def test_the_opened_loop_is_the_product_of_its_parts(signal: str, tap: float) -> None:
    """The feedback of the command to the controller stays closed if the loop opens at the actuator."""
    z = np.exp(1j * np.linspace(0.05, 3.0, 7))
    L = equilibrium.open_loop(at(0.3, tap=tap), signal)
    assert (L.inputs, L.outputs) == ((signal,), (f"{signal}_out",))
    np.testing.assert_allclose(L.response(z)[:, 0, 0], expected_loop(z, 0.3, tap), rtol=1e-5)
    assert stability_margins.of_loop(L).stable


def test_several_signals_open_at_once() -> None:
    L = equilibrium.open_loop(at(0.3), ["i", "q"])
    z = np.exp(0.4j)
    both = L.response([z])[0]
    alone = equilibrium.open_loop(at(0.3), "i").response([z])[0, 0, 0]
    assert abs(both[0, 0]) < tolerances.of("pencil") and abs(both[1, 1]) < tolerances.of("pencil")
    assert -both[0, 1] * both[1, 0] == pytest.approx(alone, rel=1e-9)


def test_without_integral_action_the_loop_rests_off_its_set_point() -> None:
    rest = at(0.3, integral=0.0)
    e = rest.inputs["q"] - 0.3
    assert -KP * e == pytest.approx(WEIGHT - 4 * rest.inputs["q"], rel=1e-7) and abs(e) > 0.1


def test_disturbances_stay_and_weights_share_a_command() -> None:
    near = operating_points.trim(levitation_plant(), {"gap": 0.1, "push": 2.0}, ["i"])
    closed = equilibrium.SampledLoop(levitation_plant(), pid_block(), SENSORS, {"i": {"drive": 0.5}})
    rest = equilibrium.solve(closed, {"wish": 0.1}, near)
    assert rest.point["push"] == 2.0
    assert rest.state["safe_output_last_drive"] == pytest.approx(2 * rest.point["i"], rel=1e-7)


@pytest.mark.slow
def test_a_loop_without_an_equilibrium_is_refused() -> None:
    with pytest.raises(ModelError, match="counts without end"):
        at(0.1, toggles=True)
    with pytest.raises(
        ModelError,
        match=r"'held' would balance where sensor 'q' reads 0.7 of -0.5 .. 0.5 m, which the guard refuses",
    ):
        at(0.7)
    near = operating_points.trim(levitation_plant(), {"gap": 0.1}, ["i"])
    closed = equilibrium.SampledLoop(levitation_plant(), pid_block(), SENSORS, ACTUATORS)
    with pytest.raises(SignalError, match=r"missing \['wish'\], not known \['hope'\]: give a value for each of wish"):
        equilibrium.solve(closed, {"hope": 1.0}, near)


def test_the_search_goes_on_after_an_equilibrium_that_raises_a_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    answers = iter([["fault_q"], []])
    monkeypatch.setattr(equilibrium, "_raised_faults", lambda rest: next(answers))
    assert at(0.3).point["gap"] == pytest.approx(0.3, abs=1e-7) and not [*answers]


POSITION, RATE = Signal("gap", "m", -0.05, 0.05), Signal("speed", "m/s", -1, 1)
ACCELERATION = Signal("i", "m/s^2", -20, 20)


def carriage(spring: float, bias: float = 0.0) -> Plant:
    """A mass of 1 kg on a spring, N/m, with a constant force."""

    def physics(x: Exprs, u: Exprs, p: Exprs) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        return {"gap": x["speed"], "speed": u["i"] - spring * x["gap"] + bias}, {"gap": x["gap"]}

    return plant_of("carriage", [POSITION, RATE], [ACCELERATION], [POSITION], [], physics)


def limited_pd(integral: float = 0.0) -> Block:
    """PD with a limit of 20, and an integral whose anti-windup takes back what the limit cuts off."""

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        demand = 900 * (u["wish"] - u["q"]) - 50 * (u["q"] - x["last"]) / 1e-3 + (x["sum"] if integral else 0)
        command = ca.fmin(ca.fmax(demand, -20), 20)
        next = {"last": u["q"]}
        if integral:
            next["sum"] = x["sum"] + integral * (u["wish"] - u["q"]) + 0.1 * (command - demand)
        return Step({"drive": command}, next)

    inputs = [Signal("q", "m", -0.05, 0.05), Signal("wish", "m", -0.05, 0.05)]
    states = [State(Signal("last", "m", -0.05, 0.05), 0)]
    states += [State(Signal("sum", "m/s^2", -1e3, 1e3), 0)] if integral else []
    outputs = [Signal("drive", "m/s^2", -20, 20)]
    return build("pd", Discrete(1e-3), law, inputs=inputs, outputs=outputs, states=states)


@pytest.mark.parametrize(("spring", "reached"), [(600.0, True), (1000.0, False)])
def test_a_point_beyond_the_actuators_force_is_refused(spring: float, reached: bool) -> None:
    """At its limit the loop rests by its anti-windup, with L = 0 and endless margins."""
    plant = carriage(spring)
    near = operating_points.trim(plant, {"gap": 0.03}, ["i"])
    closed = equilibrium.SampledLoop(plant, limited_pd(1.0), SENSORS, ACTUATORS)
    if reached:
        assert equilibrium.solve(closed, {"wish": 0.03}, near).point["i"] == pytest.approx(18)
        return
    with pytest.raises(ModelError, match=r"rests with a command at its limit, drive = 20 of -20 \.\. 20 m/s\^2"):
        equilibrium.solve(closed, {"wish": 0.03}, near)


def test_the_search_goes_on_after_an_equilibrium_at_a_limit_and_out_of_range() -> None:
    """The kick of the derivative at the first sample leads to 0.46 m, with the command at its limit."""
    plant = carriage(-50.0, -3.0)
    near = operating_points.trim(plant, {"gap": 6 / 850}, ["i"])
    closed = equilibrium.SampledLoop(plant, limited_pd(), SENSORS, ACTUATORS)
    assert equilibrium.solve(closed, {"wish": 0.01}, near).point["gap"] == pytest.approx(6 / 850)


@pytest.mark.parametrize("learns", [False, True])
def test_a_state_that_holds_a_number_is_not_free(learns: bool) -> None:
    """PD with a bias of 3 m/s^2, of 4 once a counter has run: 900 (wish - gap) + bias = spring gap at rest."""

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        demand = 900 * (u["wish"] - u["q"]) - 50 * (u["q"] - x["last"]) / 1e-3 + x["bias"]
        bias = ca.if_else(x["count"] < 5, 4.0, x["bias"]) if learns else x["bias"]
        return Step({"drive": demand}, {"last": u["q"], "bias": bias, "count": ca.fmin(x["count"] + 1, 9)})

    inputs = [Signal("q", "m", -0.05, 0.05), Signal("wish", "m", -0.05, 0.05)]
    states = [State(Signal("last", "m", -0.05, 0.05), 0), State(Signal("bias", "m/s^2", -20, 20), 3.0)]
    states.append(State(Signal("count", "1", 0, 9), 0, integer=True))
    pd = build("pd", Discrete(1e-3), law, inputs=inputs, outputs=[Signal("drive", "m/s^2", -20, 20)], states=states)
    plant = carriage(600.0)
    near = operating_points.trim(plant, {"gap": 0.01}, ["i"])
    rest = equilibrium.solve(equilibrium.SampledLoop(plant, pd, SENSORS, ACTUATORS), {"wish": 0.01}, near)
    bias = 4.0 if learns else 3.0
    assert rest.state["bias"] == bias and rest.point["gap"] == pytest.approx((9 + bias) / 1500, rel=1e-9)


def test_of_two_actuators_each_carries_the_share_that_the_law_gives_it() -> None:
    """The trim has the least squares of both relative to their ranges, 12 (r1, r2)^2; the law shares 3 : 1."""
    drives = [Signal("i", "m/s^2", -20, 20), Signal("j", "m/s^2", -10, 10)]

    def physics(x: Exprs, u: Exprs, p: Exprs) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        return {"gap": x["speed"], "speed": u["i"] + u["j"] - 12.0}, {"gap": x["gap"]}

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        demand = 900 * (u["wish"] - u["q"]) - 50 * (u["q"] - x["last"]) / 1e-3 + x["sum"]
        total = x["sum"] + u["wish"] - u["q"]
        return Step({"i": 0.75 * demand, "j": 0.25 * demand}, {"last": u["q"], "sum": total})

    plant = plant_of("pair", [POSITION, RATE], drives, [POSITION], [], physics)
    near = operating_points.trim(plant, {"gap": 0.01}, ["i", "j"])
    np.testing.assert_allclose(near.u, [12 * 400 / 500, 12 * 100 / 500], rtol=1e-12)
    inputs = [Signal("q", "m", -0.05, 0.05), Signal("wish", "m", -0.05, 0.05)]
    states = [State(Signal("last", "m", -0.05, 0.05), 0), State(Signal("sum", "m/s^2", -1e3, 1e3), 0)]
    pid = build("pid", Discrete(1e-3), law, inputs=inputs, outputs=drives, states=states)
    closed = equilibrium.SampledLoop(plant, pid, SENSORS, {"i": "i", "j": "j"})
    np.testing.assert_allclose(equilibrium.solve(closed, {"wish": 0.01}, near).point.u, [9.0, 3.0], rtol=1e-9)
