"""Jacobians against central differences; the stage's unstable poles."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from models import maglev_stage
from synth.analyse.operating_points import OperatingPoint, linearise, trim
from synth.plant import Plant
from synth.signals import Signal
from synth.statespace import StateSpace
from synth.timing import Continuous

DIRECT = ("i_d1", "i_d2", "i_d3", "i_d4")


def differences(stage: Plant, at: OperatingPoint) -> tuple[np.ndarray, ...]:
    """Return A, B, C, D by fourth-order central differences in 1e-3 of each signal's range."""

    def slope(f: ca.Function, which: str, signals: tuple[Signal, ...]) -> np.ndarray:
        columns = []
        for i, signal in enumerate(signals):
            h = 1e-3 * (signal.high - signal.low)

            def value(steps: int, i: int = i, h: float = h) -> np.ndarray:
                args = {"x": at.x.copy(), "u": at.u.copy()}
                args[which][i] += steps * h
                return np.asarray(f(args["x"], args["u"], at.p)).ravel()

            columns.append((8 * (value(1) - value(-1)) - (value(2) - value(-2))) / (12 * h))
        return np.array(columns).T

    pairs = [(f, w, s) for f in (stage.f, stage.h) for w, s in (("x", stage.states), ("u", stage.inputs))]
    return tuple(slope(*pair) for pair in pairs)


def agrees(model: StateSpace, numeric: tuple[np.ndarray, ...]) -> bool:
    pairs = zip((model.A, model.B, model.C, model.D), numeric, strict=True)
    return all(np.allclose(M, N, rtol=1e-7, atol=1e-6) for M, N in pairs)


def tilted_plant() -> tuple[Plant, OperatingPoint]:
    stage = maglev_stage.plant()
    return stage, trim(stage, {"y": 0.023, "theta": 0.006, "phi": -0.001}, DIRECT)


def test_jacobians_are_the_limits_of_differences() -> None:
    stage, at = tilted_plant()
    assert agrees(linearise(stage, at), differences(stage, at))


@pytest.mark.parametrize(("lv3", "pole"), [("coth2", 37.33), ("csch2", 37.76)])
def test_the_vertical_unstable_pole_at_25_mm(lv3: str, pole: float) -> None:
    stage = maglev_stage.plant(lv3)
    model = linearise(stage, trim(stage, {"y": 0.025}, DIRECT))
    vertical = [model.states.index(n) for n in ("y", "vy")]
    assert np.linalg.eigvals(model.A[np.ix_(vertical, vertical)]).real.max() == pytest.approx(pole, abs=5e-3)


def test_magnets_oppose_the_springs_at_25_mm() -> None:
    # Attraction that grows as the gap closes tilts the platen further: 1438 1/s^2 with coth^2 and the holding currents.
    stage = maglev_stage.plant("coth2").with_parameters(k_s_phi=0.0, k_s_theta=0.0)
    model = linearise(stage, trim(stage, {"y": 0.025}, DIRECT))
    row, column = model.states.index("wtheta"), model.states.index("theta")
    assert model.A[row, column] == pytest.approx(1438.2, abs=0.1)


def test_names_and_time() -> None:
    stage, at = tilted_plant()
    model = linearise(stage, at)
    assert (model.states[0], model.inputs[4], model.outputs[-1]) == ("y", "u_x", "g4")
    assert model.time == Continuous()


def test_parameters_are_those_of_the_point() -> None:
    stage, at = tilted_plant()
    softer = replace(at, p=stage.with_parameters(k_s_theta=0.0).values)
    change = linearise(stage, softer).A - linearise(stage, at).A
    row, column = stage.states.index(maglev_stage.STATES[9]), stage.states.index(maglev_stage.STATES[8])
    assert change[row, column] == pytest.approx(3000.0, rel=1e-12)
    assert np.count_nonzero(change) == 1
