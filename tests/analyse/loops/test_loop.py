"""A loop that is opened and closed again has the poles of the closed loop."""

import itertools
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
import scipy.linalg

from synth.analyse import discretise
from synth.analyse.loops import loop, stability_margins
from synth.block import Block, Exprs, Fault, State, Step, build
from synth.composition import compose
from synth.errors import ModelError, TimingError
from synth.signals import Signal
from synth.statespace import StateSpace
from synth.timing import Continuous, Discrete
from tests import tolerances

T = 0.01
TIME = Discrete(T)
KP, KD = 30.0, 8.0
ENCODER, Q = Signal("encoder", "m", -1, 1), Signal("q", "m", -1, 1)
RATE, FORCE = Signal("rate", "m/s", -100, 100), Signal("force", "N", -1e3, 1e3)
DRIVE = Signal("drive", "N", -1e3, 1e3)
NAMES = (("a", "b", "c"), ("u", "v"), ("a", "b", "c"))
SENSORS, ACTUATORS = {"encoder": "position"}, {"f": "force"}


def plant(passes: float = 0.0) -> StateSpace:
    """1 kg on a spring of -4 N/m (as a magnet's), with a second output that nothing reads."""
    A, B, C = [[0, 1], [4, 0]], [[0], [1]], [[1, 0], [0, 1]]
    names = (("x", "v"), ("f",), ("position", "speed"))
    return StateSpace(A, B, C, [[passes], [0]], *names, Continuous())


def blocks() -> list[Block]:
    """Sensor, rate by difference, PD law with a slight cubic term."""
    sense = build("sense", TIME, lambda u, x, k: Step({"q": u["encoder"]}), inputs=[ENCODER], outputs=[Q])

    def difference(u: Exprs, x: Exprs, k: Exprs) -> Step:
        return Step({"rate": (u["q"] - x["last"]) / T}, {"last": u["q"]})

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        return Step({"force": -KP * u["q"] - KD * u["rate"] - 5 * u["q"] ** 3 + u["feed"]})

    last, feed = State(Signal("last", "m", -1, 1), 0), Signal("feed", "N", -10, 10)
    return [
        sense,
        build("rater", TIME, difference, inputs=[Q], outputs=[RATE], states=[last]),
        build("law", TIME, law, inputs=[Q, RATE, feed], outputs=[FORCE]),
    ]


def controller(signal: str) -> StateSpace:
    outputs = ["force", f"{signal}_out"] if signal != "force" else ["force_out", "rate"]
    inputs = ["encoder", "feed", signal]
    parts = loop.cut(blocks(), signal)
    if signal == "force":  # the actuator reads the cut signal
        through = build("through", TIME, lambda u, x, k: Step({"drive": u["force"]}), inputs=[FORCE], outputs=[DRIVE])
        parts, outputs = (*parts, through), ["drive", "force_out"]
    block = compose("pd", parts, inputs=inputs, outputs=outputs)
    return loop.linearise_block(block, {}, dict.fromkeys(inputs, 0.0))


def open_loop(signal: str, delay: int = 1) -> StateSpace:
    actuators = {"f": "drive"} if signal == "force" else ACTUATORS
    return loop.open_loop(plant(), controller(signal), signal, SENSORS, actuators, delay)


def closed_loop_poles(L: StateSpace) -> np.ndarray:
    return np.linalg.eigvals(L.A - L.B @ np.linalg.solve(np.eye(1) + L.D, L.C))


def independent_poles(delay: int) -> np.ndarray:
    """The loop written out by hand: x'' = 4 x + f has exp(A T) in cosh and sinh."""
    c, s = np.cosh(2 * T), np.sinh(2 * T)
    F, G = np.array([[c, s / 2], [2 * s, c]]), np.array([(c - 1) / 4, s / 2])
    n = 2 + delay + 1  # x, v, delayed forces, last q
    M = np.zeros((n, n))
    M[:2, :2] = F
    force = np.zeros(n)
    force[0], force[-1] = -KP - KD / T, KD / T
    chain = [M[2 + i] for i in range(delay)]
    M[:2, 2] = G
    for i in range(delay - 1):
        chain[i][2 + i + 1] = 1
    chain[-1][:] = force
    M[-1, 0] = 1
    return np.linalg.eigvals(M)


def held_response(u: np.ndarray, tau: float, A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray) -> np.ndarray:
    """y at the samples of x' = A x + B u(t - tau), u held, from one exponential for each piece of constant input."""
    n, m = B.shape
    last = len(u) * T
    switches = {round(k * T + shift, 12) for k in range(len(u) + 1) for shift in (0.0, tau)}
    times, x, y = sorted(t for t in switches if t <= last), np.zeros(n), []
    for a, b in itertools.pairwise(times):
        k = int(np.floor(((a + b) / 2 - tau) / T))
        value = u[k] if k >= 0 else np.zeros(m)
        # if u jumps at a sample, the sample has the value after the jump
        if abs(a / T - round(a / T)) < 1e-9:
            y.append(C @ x + D @ value)
        E = scipy.linalg.expm(np.block([[A, B], [np.zeros((m, n + m))]]) * (b - a))
        x = E[:n, :n] @ x + E[:n, n:] @ value
    return np.array(y)


def simulate(model: StateSpace, u: np.ndarray) -> np.ndarray:
    x, y = np.zeros(len(model.A)), []
    for value in u:
        y.append(model.C @ x + model.D @ value)
        x = model.A @ x + model.B @ value
    return np.array(y)


@pytest.mark.parametrize("samples", [0.0, 0.3, 1.0, 1.3, 2.7, 3.0])
def test_a_plant_with_any_delay_is_sampled_exactly(samples: float) -> None:
    """Two inputs, a direct path, an undamped mode; half a sample more, the planted defect, is detected."""
    rng = np.random.default_rng(3)
    A, B, C = np.array([[0, 1, 0], [-900, 0, 2], [0, 0, -50.0]]), rng.normal(size=(3, 2)), rng.normal(size=(2, 3))
    D, u = rng.normal(size=(2, 2)), rng.normal(size=(15, 2))
    expected = held_response(u, samples * T, A, B, C, D)
    y = simulate(loop.sampled((A, B, C, D), T, samples * T), u)
    np.testing.assert_allclose(y, expected, rtol=0, atol=tolerances.of("double"))
    late = simulate(loop.sampled((A, B, C, D), T, (samples + 0.5) * T), u)
    assert np.abs(late - expected).max() > 1e-3


def test_delayed_inputs_are_states_with_names_and_units() -> None:
    known = replace(plant(), units={"f": "N", "x": "m", "position": "m"})
    late = loop.sampled(known, T, 2.5 * T)
    assert late.states == ("x", "v", "f_held", "f_late1", "f_late2") and late.time == TIME
    assert [late.unit(s) for s in late.states] == ["m", "", "N", "N", "N"]
    assert loop.sampled(known, T, 2 * T).states == ("x", "v", "f_late1", "f_late2")
    # 0.3 / 0.1 is 2.9999999999999996
    assert loop.sampled(known, 0.1, 0.3).states == ("x", "v", "f_late1", "f_late2", "f_late3")


def test_the_poles_of_a_delayed_sampled_loop_near_those_of_a_finely_sampled_one() -> None:
    """1.5 samples of delay before the hold are 15 samples of a tenth, with the controller's output held over ten."""
    P, K = plant(), np.array([-3 * KP, -KD])
    coarse = loop.sampled(P, T, 1.5 * T)
    closed = coarse.A + coarse.B @ (K @ np.hstack([np.eye(2), np.zeros((2, 2))]))[None]
    fine = loop.sampled(P, T / 10, 0.0)
    x, commands, outputs = np.array([1.0, 0.0]), [0.0] * 15, []
    z = np.concatenate([x, [0.0, 0.0]])
    for k in range(200):
        if k % 10 == 0:
            outputs.append(np.abs(x - z[:2]).max())
            z, command = closed @ z, float(K @ x)
        x, commands = fine.A @ x + fine.B[:, 0] * commands[0], [*commands[1:], command]
    assert max(outputs) < tolerances.of("double") < np.abs(x).max()


def test_a_loop_is_opened_with_a_fraction_of_a_sample_too() -> None:
    between = [stability_margins.of_loop(open_loop("q", delay)).phase_margin for delay in (1, 1.5, 2)]
    crossing = stability_margins.of_loop(open_loop("q", 1)).gain_crossings[0].frequency
    assert between[0] - between[1] == pytest.approx(np.degrees(crossing * T / 2), rel=0.02)
    assert between[0] - between[2] == pytest.approx(np.degrees(crossing * T), rel=0.02)


def test_a_delay_of_very_many_samples_is_refused_before_it_is_built() -> None:
    for call in (lambda: loop.sampled(plant(), T, 1e6), lambda: open_loop("q", 10**8), lambda: open_loop("q", 501.5)):
        with pytest.raises(TimingError, match=r"samples of 0.01 s for each of 1 inputs: at most 500 .* longer period"):
            call()
    assert len(loop.sampled(plant(), T, 20.3 * T).states) == 2 + 21


@pytest.mark.parametrize("delay", [0.0, 1.0, 0.4])
def test_a_mode_that_overflows_within_a_period_is_refused(delay: float) -> None:
    fast = ([[1e5, 0.0], [0.0, -1.0]], [[1.0], [1.0]], [[1.0, 1.0]], [[0.0]])
    with pytest.raises(ModelError, match=r"over 0\.01 s exceeds what a double holds: take a shorter period"):
        loop.sampled(fast, T, delay * T)
    assert np.isfinite(loop.sampled(fast, 1e-3, delay * 1e-3).A).all()  # e^100


def test_without_a_delay_the_sampled_plant_is_that_of_the_hold() -> None:
    rng = np.random.default_rng(5)
    P = StateSpace(rng.normal(size=(3, 3)), rng.normal(size=(3, 2)), np.eye(3), np.zeros((3, 2)), *NAMES, Continuous())
    sampled, expected = loop.sampled(P, T), discretise.zero_order_hold(P, T)
    assert np.array_equal(sampled.A, expected.A) and np.array_equal(sampled.B, expected.B)
    assert (sampled.states, sampled.inputs, sampled.time) == (expected.states, expected.inputs, TIME)


def sort_poles(poles: np.ndarray) -> np.ndarray:
    return np.sort_complex(np.round(poles[np.abs(poles) > 1e-6], 9))


@pytest.mark.parametrize("signal", ["q", "rate", "force"])
@pytest.mark.parametrize("delay", [1, 2])
def test_closing_the_loop_again_gives_the_poles_of_the_whole(signal: str, delay: int) -> None:
    """`rate` cut leaves the proportional path closed; the whole is the same wherever it is cut."""
    ours, whole = sort_poles(closed_loop_poles(open_loop(signal, delay))), sort_poles(independent_poles(delay))
    np.testing.assert_allclose(ours, whole, rtol=0, atol=tolerances.of("pencil"))
    other = sort_poles(independent_poles(3 - delay))
    assert len(other) != len(ours) or np.abs(ours - other).max() > 1e-3  # another delay is distinguished


def test_the_loop_at_the_position_is_the_product_of_its_parts() -> None:
    """L = (K_p + K_d (z - 1) / (T z)) z^-1 P(z) at a cut without a parallel path."""
    z = np.exp(1j * np.linspace(0.05, 3.0, 7))
    c, s = np.cosh(2 * T), np.sinh(2 * T)
    P = ((c - 1) / 4 * (z - c) + s / 2 * s / 2) / ((z - c) ** 2 - s**2)
    expected = (KP + KD * (z - 1) / (T * z)) / z * P
    for signal in ("q", "force"):
        np.testing.assert_allclose(open_loop(signal).response(z)[:, 0, 0], expected, rtol=tolerances.of("pencil"))


def test_the_stiffness_of_the_magnet_is_its_lower_gain_margin() -> None:
    """At rest L = -K_p / 4: the gain may decrease to 4/30 before the magnet destabilises it."""
    loop_margins = stability_margins.of_loop(open_loop("q"))
    assert loop_margins.stable and loop_margins.gain_reduction_margin == pytest.approx(4 / KP, rel=1e-6)


def test_inputs_that_are_not_wired_stay_at_rest_and_names_say_what_is_what() -> None:
    L = open_loop("q")
    assert (L.inputs, L.outputs, L.time) == (("q",), ("q_out",), TIME)
    assert L.states == ("plant_x", "plant_v", "plant_f_late1", "rater_last")


def test_jacobians_agree_with_differences_off_rest() -> None:
    block = compose("pd", blocks(), inputs=["encoder", "feed"], outputs=["force"])
    at, h = {"encoder": 0.3, "feed": 1.0}, 1e-6
    jacobians, f = loop.linearise_block(block, {"rater_last": 0.2}, at), block.function()
    up, down = (np.array(f([0.2], [0.3 + d, 1.0])[1]).item() for d in (h, -h))
    assert jacobians.D[0, 0] == pytest.approx((up - down) / (2 * h), rel=1e-6)
    assert jacobians.D[0, 0] == pytest.approx(-KP - KD / T - 15 * 0.3**2, rel=tolerances.of("double"))
    np.testing.assert_array_equal(jacobians.A, [[0]])
    np.testing.assert_allclose(jacobians.C, [[KD / T]])


def test_a_flag_that_is_cut_stays_the_flag_of_its_fault() -> None:
    flagged = replace(blocks()[0], faults=(Fault(0, "q", None),))
    (cut,) = loop.cut([flagged], "q")
    assert cut.faults[0].output == "q_out" and ca.is_equal(cut.output["q_out"], flagged.output["q"])
