"""The regulator in a loop leaves no error at the frequencies of its exosystem, and fits its gain, units and plant."""

from dataclasses import replace

import numpy as np
import pytest

from synth.analyse import discretise, loop
from synth.block import Block
from synth.errors import SignalError
from synth.signals import Signal, dimension
from synth.statespace import StateSpace
from synth.synthesise import internal_model, lqr, regulator
from synth.timing import Continuous, Discrete
from tests import tolerances

T, OMEGA = 5e-3, 6.0
FREQUENCIES = (0.0, OMEGA)
TIME = Discrete(T)
ERROR, RATE = Signal("e", "m", -10, 10), Signal("de", "m/s", -100, 100)
DEMAND, EXCESS = Signal("w", "m/s^2", -1e5, 1e5), Signal("excess", "A", -10, 10)
DOUBLE = StateSpace([[0, 1], [0, 0]], [[0], [1]], [[1, 0]], [[0]], ("e", "de"), ("w",), ("e",), Continuous())
BOUNDS = (100.0, 100.0, 100.0)


def gain() -> lqr.Gain:
    augmented = internal_model.augmented(DOUBLE, FREQUENCIES)
    return lqr.lqr(augmented, np.diag([1e4, 1e2, 1e8, 1e5, 1e6]), [[1.0]])


def block(**changes: object) -> Block:
    given: dict[str, object] = {"gain": gain(), "frequencies": FREQUENCIES, "error": ERROR, "rate": RATE}
    given |= {"demand": DEMAND, "bounds": BOUNDS, "tag": "test", **changes}
    return regulator.block("reg", TIME, **given)  # type: ignore[arg-type]


def last_errors(reference: float, omega: float, regulator_frequency: float = OMEGA) -> float:
    """Simulate x'' = w + 3 under the regulator, following a sine; return the largest error of the last period."""
    tuned = block(frequencies=(0.0, regulator_frequency))
    step, held = tuned.function(), discretise.zero_order_hold(DOUBLE, T)
    x, xi, errors = np.array([0.2, 0.0]), tuned.initial, []
    for k in range(2400):
        t = k * T
        e = x[0] - reference * np.sin(omega * t + 0.4)
        de = x[1] - reference * omega * np.cos(omega * t + 0.4)
        xi, w = (np.asarray(v).ravel() for v in step(xi, [e, de]))
        x = held.A @ x + held.B[:, 0] * (w[0] + 3.0)
        errors.append(abs(e))
    return float(max(errors[-250:]))


def test_a_sine_of_the_exosystem_and_a_constant_force_leave_no_error() -> None:
    assert last_errors(0.5, OMEGA) < tolerances.of("settled")


def test_another_sine_does() -> None:
    assert last_errors(0.5, 1.3 * OMEGA) > 1e-3
    assert last_errors(0.5, OMEGA, regulator_frequency=1.02 * OMEGA) > 1e-5
    assert last_errors(0.0, OMEGA, regulator_frequency=1.02 * OMEGA) < tolerances.of("settled")  # the force alone


def test_the_block_is_the_sampled_internal_model() -> None:
    E = np.array([0.1, -0.2, 0.3])
    found = loop.linearised(block(anti_windup=(EXCESS, E)), {}, {"e": 0, "de": 0, "excess": 0})
    d = internal_model.discrete(FREQUENCIES, T, E)
    np.testing.assert_array_equal(found.A, d.Phi)
    np.testing.assert_array_equal(found.B, np.hstack([d.N, np.zeros((3, 1)), d.E]))
    np.testing.assert_array_equal(np.hstack([found.D[:, :2], found.C]), gain().K)
    assert found.inputs == ("e", "de", "excess") and found.D[0, 2] == 0
    without = loop.linearised(block(), {}, {"e": 0, "de": 0})
    assert without.inputs == ("e", "de")
    np.testing.assert_array_equal(without.A, d.Phi)


@pytest.mark.parametrize("omega", [3.0, OMEGA, 12.0])
def test_the_closed_loop_is_stable_and_infinite_gain_sits_at_the_exosystem(omega: float) -> None:
    found = loop.linearised(block(), {}, {"e": 0, "de": 0})
    at = abs(found.response(np.exp(1j * omega * T) * (1 + 1e-9))[0, 0, 0])
    assert (at > 1e6) == (omega == OMEGA)


def test_states_stay_within_their_bounds() -> None:
    tight = block(bounds=(1e-3, 2e-3, 3e-3))
    step, xi = tight.function(), tight.initial
    for _ in range(500):
        xi = np.asarray(step(xi, [10, 0])[0]).ravel()
    assert (np.abs(xi) <= [1e-3, 2e-3, 3e-3]).all() and np.abs(xi).max() > 0.9e-3


def test_units_follow_from_the_terms() -> None:
    wound = block(anti_windup=(EXCESS, [1, 1, 1]))
    signals = {s.name: s.signal.unit for s in wound.states} | {"e": "m", "de": "m/s", "excess": "A"}
    for constant in wound.constants:
        head, _, source = constant.name.partition("_")
        target, source = ("m/s^2", source) if head == "k" else (signals[head], source)
        product = dimension(f"{constant.unit} {signals[source]}")
        assert product == dimension(target), constant.name
    force = Signal("excess", "kg m/s^2", -1, 1)
    units = {c.name: c.unit for c in block(anti_windup=(force, [1, 1, 1])).constants}
    assert dimension(f"{units['xi1_excess']} N") == dimension("m s^3")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"frequencies": (0.0,)}, r"the gain is \(1, 5\) and 3 bounds are given, but the exosystem of order 1"),
        ({"bounds": (1.0, 1.0)}, "2 bounds are given, but the exosystem of order 3"),
        ({"anti_windup": (EXCESS, [1.0])}, "has 1 entries, the internal model 3 states"),
        ({"rate": replace(RATE, unit="m")}, "'de' is in m, but the error 'e' asks for m/s"),
        ({"demand": replace(DEMAND, unit="N")}, r"'w' is in N, but the error 'e' asks for m/s\^2"),
        ({"frequencies": (0.0, 700.0)}, "must lie below 628.319 rad/s"),
    ],
)
def test_what_does_not_fit_is_refused(changes: dict[str, object], message: str) -> None:
    with pytest.raises(SignalError, match=message):
        block(**changes)
