"""Gains against published tables and printed digits."""

import control
import numpy as np
import pytest

from synth.errors import SignalError
from synth.statespace import StateSpace
from synth.synthesise.feedback import lqr
from synth.synthesise.regulation import internal_model
from synth.timing import Continuous, Discrete
from tests import tolerances
from tests.synthesise.feedback.problems import random_problem

OMEGA0 = 1.5 * np.pi
# The poles are printed in the paper; weights and gains are recomputed from them: (Q, K, poles, decimals of the poles)
PUBLISHED = {
    "y": (
        (3e4, 3e4, 2.5e9, 2.5e7, 2.5e7),
        ("-1699.7", "-182.75", "-50000", "2725.5", "-7806.8"),
        (-173.2, -2.61 + 5.48j, -2.61 - 5.48j, -2.16 + 1.77j, -2.16 - 1.77j),
        (1, 2, 2, 2, 2),
    ),
    "x, z": (
        (1500, 1500, 4.5e8, 2.25e6, 2.25e6),
        ("-525.33", "-50.504", "-21213", "-1253.6", "-2742.2"),
        (-38.73, -3.2 + 5.89j, -3.2 - 5.89j, -2.69 + 2.23j, -2.69 - 2.23j),
        (2, 1, 1, 2, 2),
    ),
    "theta": (
        (4e4, 4e4, 4e9, 4e7, 4e7),
        ("-2050.0", "-210.00", "-63246", "1910.6", "-9901.3"),
        (-200, -2.81 + 5.58j, -2.81 - 5.58j, -2.19 + 1.82j, -2.19 - 1.82j),
        (0, 2, 2, 2, 2),
    ),
}


def axis() -> StateSpace:
    """A double integrator with the internal model of 0 and OMEGA0, states (e, de, xi1, xi2, xi3)."""
    double = StateSpace([[0, 1], [0, 0]], [[0], [1]], [[1, 0]], [[0]], ("e", "de"), ("w",), ("e",), Continuous())
    return internal_model.augmented(double, (0.0, OMEGA0))


NAMES = ("x", "y", "phi", "d", "f", "v")
UNITS = {"x": "m", "y": "m", "phi": "rad", "d": "m/s", "f": "m/s", "v": "rad/s", "i_A": "A", "i_B": "A", "i_C": "A"}


def positioner() -> StateSpace:
    """Y(26): three masses of a planar stage on three currents, with the integrals of the positions, Y(31)."""
    A = np.block([[np.zeros((3, 3)), np.eye(3)], [np.zeros((3, 6))]])
    B = np.vstack([np.zeros((3, 3)), [[0, 0, 13.2547], [13.2547, 13.2547, 0], [-117.15, 117.15, 0]]])
    C, inputs = np.eye(3, 6), ("i_A", "i_B", "i_C")
    plant = StateSpace(A, B, C, np.zeros((3, 3)), NAMES, inputs, NAMES[:3], Continuous(), UNITS)
    return lqr.with_integrators(plant, NAMES[:3])


# Y(49) with its decimals, columns x y phi, their integrals, d f v; u = -K x.
PRINTED_GAIN = (
    ("0", "507.24", "-472.64", "0", "19975", "-41394", "0", "6.4304", "-2.6962"),
    ("0", "507.24", "472.64", "0", "19975", "41394", "0", "6.4304", "2.6962"),
    ("1757.55", "0", "0", "84872", "0", "0", "18.1556", "0", "0"),
)
# In the same order: what gives the print, and what is printed beside it, Y(47).
USED, STATED = (
    (1e4, 1e3, 1e3, 1e10, 1e9, 1e10, 1e2, 1e1, 2e1),
    (1e3, 1e4, 1e3, 1e9, 1e8, 1e8, 1e2, 1e2, 1e2),
)


def printed_gain(Q: tuple[float, ...]) -> np.ndarray:
    """-K at 800 Hz for weights in the order of the print."""
    model = positioner()
    order = (*NAMES[:3], *(f"{name}_integral" for name in NAMES[:3]), *NAMES[3:])
    gain = lqr.lqrd(model, dict(zip(order, Q, strict=True)), np.eye(3), 1 / 800)
    return -gain.K[:, [model.states.index(name) for name in order]]


def test_the_planar_positioners_gain_comes_out_to_the_printed_digits() -> None:
    """Y-10: nine gains, each within 1.3e-5; figures printed with five digits or six."""
    gain = printed_gain(USED)
    for row, texts in zip(gain, PRINTED_GAIN, strict=True):
        for value, text in zip(row, texts, strict=True):
            assert value == pytest.approx(float(text), rel=1.4e-5, abs=1e-6)
    continuous = lqr.lqr(positioner(), np.ones(9), np.eye(3)).K
    assert continuous.shape == gain.shape
    assert abs(printed_gain((1e4, *USED[1:-1], 2.2e1))[0, 8] / float(PRINTED_GAIN[0][8]) - 1) > 1e-4


def test_the_weights_printed_beside_it_give_another_gain() -> None:
    """Y-11."""
    gain = printed_gain(STATED)
    known = [[316.06, 6140.1, 7.8274], [144.24, 3124.6, 3.3136], [898.22, 27793, 14.500]]
    rows = [gain[1, [1, 4, 7]], gain[1, [2, 5, 8]], gain[2, [0, 3, 6]]]
    np.testing.assert_allclose(rows, known, rtol=6e-5)


USED_BY_NAME = dict(zip((*NAMES[:3], *(f"{n}_integral" for n in NAMES[:3]), *NAMES[3:]), USED, strict=True))


def test_integrals_are_states_with_names_and_units() -> None:
    model = positioner()
    assert model.states == (*NAMES, "x_integral", "y_integral", "phi_integral")
    assert [model.units[f"{n}_integral"] for n in ("x", "phi")] == ["m s", "rad s"]
    s = np.array([2j, 30j])
    there = model.response(s)
    np.testing.assert_allclose(there[:, 3:], there[:, :3] / s[:, None, None], rtol=tolerances.of("double"))


def test_sampled_integrals_are_sums_and_units_cancel() -> None:
    units = {"v": "m/s", "n": "1", "a": "m/s^2"}
    plant = StateSpace(
        np.diag([0.5, 0.2]),
        [[1], [1]],
        [[1, 0], [0, 1], [1, 1]],
        [[0], [3], [0]],
        ("p", "q"),
        ("u",),
        ("v", "n", "a"),
        Discrete(0.1),
        units,
    )
    held = lqr.with_integrators(plant, ("n", "v", "a"))
    z = np.exp(1j * np.array([0.2, 2.0]))
    there = held.response(z)
    np.testing.assert_allclose(
        there[:, 3:], 0.1 / (z[:, None, None] - 1) * there[:, [1, 0, 2]], rtol=tolerances.of("double")
    )
    assert [held.units[f"{n}_integral"] for n in ("v", "n", "a")] == ["m", "s", "m/s^2 s"]
    with pytest.raises(SignalError, match="a name is listed twice among the outputs n, n"):
        lqr.with_integrators(plant, ("n", "n"))
    with pytest.raises(SignalError, match="'z' is not one of v, n, a"):
        lqr.with_integrators(plant, ("z",))


def test_arrays_are_read_and_results_print_names_and_units() -> None:
    c, Q, R = random_problem(2)
    np.testing.assert_array_equal(lqr.lqrd((c.A, c.B), Q, R, 0.1).K, lqr.lqrd(c, Q, R, 0.1).K)
    gain = lqr.lqrd(positioner(), USED_BY_NAME, np.eye(3), 1 / 800)
    assert gain.units["phi_integral"] == "rad s"
    text = repr(gain)
    assert text.startswith("Optimal gain u = K x in discrete time of 0.00125 s: 3 inputs, 9 states\nresidual ")
    assert "phi_integral [rad s]" in text and "i_A [A]" in text and "-507.2" in text and "pole, z" in text
    assert "Cost over one period" in repr(lqr.sampled_cost(c, Q, R, 0.1))


@pytest.mark.parametrize("name", PUBLISHED)
def test_the_published_gains_and_poles_come_out_to_the_printed_digits(name: str) -> None:
    Q, printed, poles, decimals = PUBLISHED[name]
    gain = lqr.lqr(axis(), np.diag(Q), [[1.0]])
    for value, text in zip(gain.K[0], printed, strict=True):
        last = 10.0 ** -(len(text.split(".")[1]) if "." in text else 0)
        assert abs(value - float(text)) <= tolerances.of("print_K") * last
    for pole, places in zip(poles, decimals, strict=True):
        nearest = min(gain.poles, key=lambda s: abs(s - pole))
        off = max(abs(nearest.real - pole.real), abs(nearest.imag - pole.imag))
        assert off <= tolerances.of("print_K") * 10.0**-places * (1 + 1e-9)
    detuned = lqr.lqr(axis(), np.diag(Q) * 1.01, [[1.0]])
    assert abs(detuned.K[0, 0] - float(printed[0])) > tolerances.of("print_K")


def test_the_sign_is_inside_the_gain_and_the_fields_say_what_was_minimised() -> None:
    c, Q, R = random_problem(2)
    gain = lqr.lqr(c, Q, R)
    K, *_ = control.lqr(c.A, c.B, Q, R, method="scipy")
    np.testing.assert_allclose(gain.K, -K, rtol=tolerances.of("pencil"))
    np.testing.assert_allclose(np.linalg.eigvals(c.A + c.B @ gain.K).real.max(), gain.poles.real.max(), rtol=1e-9)
    np.testing.assert_array_equal(gain.Q, Q)
    np.testing.assert_array_equal(gain.N, np.zeros(c.B.shape))
    assert (gain.states, gain.inputs, gain.time) == (c.states, c.inputs, Continuous())
