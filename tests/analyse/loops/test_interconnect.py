"""Wired models against python-control's connections, and the wires that are refused."""

import control
import numpy as np
import pytest

from synth.analyse.loops import interconnect
from synth.errors import SignalError
from synth.statespace import StateSpace, of
from synth.timing import Continuous
from tests import tolerances


def model(seed: int, n: int, inputs: str, outputs: str, states: str, direct: bool = True) -> StateSpace:
    rng = np.random.default_rng(seed)
    u, y = tuple(inputs.split()), tuple(outputs.split())
    A, B, C = rng.normal(size=(n, n)), rng.normal(size=(n, len(u))), rng.normal(size=(len(y), n))
    D = direct * rng.normal(size=(len(y), len(u)))
    return StateSpace(A, B, C, D, tuple(f"{states}{k}" for k in range(n)), u, y, Continuous())


PLANT = model(1, 3, "u d", "y z", "p")
CONTROLLER = model(2, 2, "e z", "v", "c")
POINTS = np.array([0.3j, 1 + 2j, 40j])


def test_a_loop_wired_by_name_agrees_with_python_control() -> None:
    wires = {"e": {"r": 1.0, "y": -1.0}, "u": {"v": 2.0}}
    mine = interconnect.connect([PLANT, CONTROLLER], ["r", "d"], ["y", "v"], wires)
    P, K = PLANT.to_control(), CONTROLLER.to_control()
    whole = control.append(P, K)  # inputs u, d, e, z; outputs y, z, v
    feedback = np.array([[0, 0, 2], [0, 0, 0], [-1, 0, 0], [0, 1, 0]])
    outside = np.array([[0, 0], [0, 1], [1, 0], [0, 0]])
    closed = control.feedback(whole, control.ss([], [], [], feedback), sign=1)
    theirs = np.array([(closed(s) @ outside)[[0, 2]] for s in POINTS])
    np.testing.assert_allclose(mine.response(POINTS), theirs, rtol=1e3 * tolerances.of("double"))
    assert (mine.inputs, mine.outputs, mine.states) == (("r", "d"), ("y", "v"), ("p0", "p1", "p2", "c0", "c1"))


def test_models_may_have_no_states_and_come_as_arrays() -> None:
    gain = of((np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), [[3.0]])).renamed({"u1": "a", "y1": "b"})
    mine = interconnect.connect([gain, ([[-1.0]], [[1.0]], [[1.0]])], ["a"], ["y1"], {"u1": {"b": 1.0}})
    assert mine.response(0)[0, 0, 0] == 3


def test_a_wire_between_unlike_units_needs_its_factor() -> None:
    units = {"y": "m", "u": "N"}
    spring = StateSpace([[-1.0]], [[1.0]], [[1.0]], [[0.0]], ("x",), ("u",), ("y",), Continuous(), units)
    with pytest.raises(SignalError, match="from 'y' in m to 'u' in N"):
        interconnect.connect([spring], [], ["y"], {"u": {"y": -1.0}})
    stiff = interconnect.connect([spring], [], ["y"], {"u": {"y": -3.0}})
    assert stiff.A[0, 0] == -4 and stiff.unit("y") == "m"


def test_units_make_no_algebraic_loop() -> None:
    """A loop through two gains of 1e12 and 1e-12 equals one of two gains of 1."""
    for scale in (1.0, 1e12):
        first = of((np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), [[scale]])).renamed({"u1": "a", "y1": "b"})
        second = of((np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), [[1 / scale]]))
        wires = {"a": {"r": 1.0, "y1": -1.0}, "u1": {"b": 1.0}}
        assert interconnect.connect([first, second], ["r"], ["y1"], wires).response(0)[0, 0, 0] == 0.5
