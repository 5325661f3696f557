"""Internal-model regulator in a loop: no error at its exosystem's frequencies; checks of gain, units and plant."""

from collections.abc import Sequence
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
import scipy.linalg

from synth.analyse import discretise
from synth.analyse.loops import loop
from synth.block import Block
from synth.blocks.laws import regulator
from synth.signals import Signal, dimension
from synth.statespace import StateSpace
from synth.synthesise.feedback import lqr
from synth.synthesise.regulation import internal_model
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
    arguments: dict[str, object] = {"gain": gain(), "frequencies": FREQUENCIES, "error": ERROR, "rate": RATE}
    arguments |= {"demand": DEMAND, "bounds": BOUNDS, "tag": "test", **changes}
    return regulator.block("reg", TIME, **arguments)  # type: ignore[arg-type]


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


def test_a_sine_outside_the_exosystem_leaves_an_error() -> None:
    assert last_errors(0.5, 1.3 * OMEGA) > 1e-3
    assert last_errors(0.5, OMEGA, regulator_frequency=1.02 * OMEGA) > 1e-5
    assert last_errors(0.0, OMEGA, regulator_frequency=1.02 * OMEGA) < tolerances.of("settled")  # the force alone


def test_the_block_is_the_sampled_internal_model() -> None:
    """By xi = T eta it is xi' = Phi_d xi + N_d e + E_d excess, w = K (e, de, xi), sampled by SciPy's exponential."""
    E = np.array([0.1, -0.2, 0.3])
    linear = loop.linearise_block(block(anti_windup=(EXCESS, E)), {}, {"e": 0, "de": 0, "excess": 0})
    model, to_xi = internal_model.exosystem(FREQUENCIES), internal_model.leapfrog(FREQUENCIES, T).T
    M = np.zeros((5, 5))
    M[:3, :3], M[:3, 3:] = model.Phi, np.column_stack([model.N[:, 0], E])
    held = scipy.linalg.expm(M * T)
    back = np.linalg.inv(to_xi)
    np.testing.assert_allclose(to_xi @ linear.A @ back, held[:3, :3], rtol=0, atol=tolerances.of("settled"))
    np.testing.assert_allclose(to_xi @ linear.B[:, [0, 2]], held[:3, 3:], rtol=tolerances.of("settled"))
    np.testing.assert_allclose(np.hstack([linear.D[:, :2], linear.C @ back]), gain().K, rtol=tolerances.of("settled"))
    assert linear.inputs == ("e", "de", "excess") and linear.D[0, 2] == 0 and not linear.B[:, 1].any()
    without = loop.linearise_block(block(), {}, {"e": 0, "de": 0})
    assert without.inputs == ("e", "de") and without.states == ("sum", "p1", "q1")
    np.testing.assert_array_equal(without.A, linear.A)


def test_a_regulator_of_two_sines_has_a_pair_for_each() -> None:
    frequencies = (OMEGA, 2.0)
    augmented = internal_model.augmented(DOUBLE, frequencies)
    wide = lqr.lqr(augmented, np.diag([1e4, 1e2, 1e8, 1e5, 1e6, 1e5]), [[1.0]])
    two_sines = block(gain=wide, frequencies=frequencies, bounds=(100.0,) * 4)
    assert [s.name for s in two_sines.states] == ["p1", "q1", "p2", "q2"]
    A = loop.linearise_block(two_sines, {}, {"e": 0, "de": 0}).A
    poles = np.linalg.eigvals(A)
    np.testing.assert_allclose(np.sort(np.angle(poles)) / T, [-OMEGA, -2.0, 2.0, OMEGA], rtol=tolerances.of("settled"))


@pytest.mark.parametrize("omega", [3.0, OMEGA, 12.0])
def test_the_closed_loop_is_stable_and_infinite_gain_sits_at_the_exosystem(omega: float) -> None:
    linear = loop.linearise_block(block(), {}, {"e": 0, "de": 0})
    at = abs(linear.response(np.exp(1j * omega * T) * (1 + 1e-9))[0, 0, 0])
    assert (at > 1e6) == (omega == OMEGA)


TIGHT = (1e-3, 1e-4, 3e-3)


def run(tuned: Block, eta: Sequence[float], errors: Sequence[float]) -> np.ndarray:
    """Return the states (N, 3) after each error."""
    step, x, path = tuned.function(), np.array(eta, dtype=float), []
    for e in errors:
        x = np.asarray(step(x, [e, 0])[0]).ravel()
        path.append(x)
    return np.array(path)


def test_a_state_that_would_leave_its_bounds_keeps_its_value() -> None:
    states = run(block(bounds=TIGHT), [0, 0, 0], [3e-4] * 40)
    assert (np.abs(states) <= TIGHT).all()
    assert states[2, 0] == pytest.approx(9e-4) and (states[2:, 0] == states[2, 0]).all()  # 12e-4 would be too much
    assert states[:, 1].max() <= TIGHT[1] and np.unique(states[:, 1]).size > 3
    back = run(block(bounds=TIGHT), states[-1], [-3e-4] * 2)
    assert back[-1, 0] == pytest.approx(3e-4)  # the other way it moves at once


def still(tuned: Block) -> Block:
    """Planted defect: all states keep their values where one would leave its bounds."""
    names, inside = [s.name for s in tuned.states], ca.SX(1)
    free = block(bounds=(1e9, 1e9, 1e9))
    next_values = ca.substitute([free.next[n] for n in names], list(free.symbol.values()), list(tuned.symbol.values()))
    for s, v in zip(tuned.states, next_values, strict=True):
        inside = ca.logic_and(inside, ca.fabs(v) <= s.signal.high)
    return replace(
        tuned, next={n: ca.if_else(inside, v, tuned.symbol[n]) for n, v in zip(names, next_values, strict=True)}
    )


def turns(tuned: Block, p: float, q: float) -> bool:
    """Tell whether the oscillation from p, q, relative to the bounds, changes sign twice per period for 20 periods."""
    start = [0.0, p * TIGHT[1], q * TIGHT[2]]
    period = round(2 * np.pi / OMEGA / T)
    states = run(tuned, start, [0.0] * (20 * period))
    crossings = np.count_nonzero(np.diff(np.sign(states[:, 2])) != 0)
    return bool(38 <= crossings <= 42 and np.abs(states).max(axis=0)[2] <= TIGHT[2])


@pytest.mark.parametrize("p", [-1.0, -0.5, 0.0, 0.9, 1.0])
@pytest.mark.parametrize("q", [-1.0, 0.3, 1.0])
def test_an_oscillation_at_its_bounds_continues(p: float, q: float) -> None:
    """It never locks: of two neighbours at their bounds the rotation takes one inwards."""
    assert turns(block(bounds=TIGHT), p, q)


def test_freezing_all_states_together_would_lock() -> None:
    assert not turns(still(block(bounds=TIGHT)), 1.0, 1.0)


def test_units_follow_from_the_terms() -> None:
    with_anti_windup = block(anti_windup=(EXCESS, [1, 1, 1]))
    assert {s.signal.unit for s in with_anti_windup.states} == {"m"}
    units = {c.name: c.unit for c in with_anti_windup.constants}
    for name, source, target in (
        *((f"k_{s}", "m", "m/s^2") for s in ("e", "sum", "p1", "q1")),
        ("k_de", "m/s", "m/s^2"),
        ("c1", "m", "m"),
        *((f"{s}_excess", "A", "m") for s in ("sum", "p1", "q1")),
    ):
        assert dimension(f"{units.pop(name)} {source}") == dimension(target), name
    assert not units
    force = Signal("excess", "kg m/s^2", -1, 1)
    by_force = {c.name: c.unit for c in block(anti_windup=(force, [1, 1, 1])).constants}
    assert dimension(f"{by_force['p1_excess']} N") == dimension("m")
