"""The exact inverse gives the demanded accelerations of the full model, with nearly the least copper loss."""

import casadi as ca
import numpy as np
import pytest
from scipy import optimize

from designs.maglev_5dof_precise import inverse
from models import maglev_stage, pmlsm

P = maglev_stage.nominal()
POSES = ({"y": 0.025, "phi": 0.0, "theta": 0.0}, {"y": 0.021, "phi": 1e-3, "theta": -4e-3})
W = {"y": 1.5, "phi": 3.0, "theta": -5.0, "x": 2.0, "z": -1.0}


def currents(pose: dict[str, float], w: dict[str, float]) -> dict[str, float]:
    x = {n: ca.SX(v) for n, v in pose.items()}
    motors = [pmlsm.force_law(g, P) for g in maglev_stage.gaps(x, P)]
    demands = {n: ca.SX(v) for n, v in w.items()}
    thrust = maglev_stage.thrust_currents(demands, motors, P)
    i_q = [thrust[n] for n in maglev_stage.QUADRATURE]
    i_d = inverse.direct_currents(demands, x, i_q, motors, P).currents
    return {n: float(i) for n, i in (i_d | thrust).items()}


def accelerations(pose: dict[str, float], i: dict[str, float]) -> dict[str, float]:
    x = {n: ca.SX(v) for n, v in pose.items()}
    return {n: float(a) for n, a in maglev_stage.accelerations(x, {n: ca.SX(v) for n, v in i.items()}, P).items()}


@pytest.mark.parametrize("pose", POSES)
def test_the_accelerations_are_the_demanded_ones(pose: dict[str, float]) -> None:
    a = accelerations(pose, currents(pose, W))
    assert a == pytest.approx(W, abs=1e-9)


@pytest.mark.parametrize("pose", POSES)
def test_the_copper_loss_is_within_a_percent_of_the_least(pose: dict[str, float]) -> None:
    i = currents(pose, W)
    names = [f"i_d{j}" for j in (1, 2, 3, 4)]

    def excess(values: np.ndarray) -> list[float]:
        a = accelerations(pose, i | dict(zip(names, values.tolist(), strict=True)))
        return [a[n] - W[n] for n in ("y", "phi", "theta")]

    start = np.array([i[n] for n in names])
    least = optimize.minimize(lambda v: float(v @ v), start, method="SLSQP", constraints={"type": "eq", "fun": excess})
    assert start @ start < 1.01 * least.fun


def test_beyond_the_largest_force_the_current_is_finite() -> None:
    i = currents(POSES[0], W | {"y": 1e4})
    assert np.isfinite(list(i.values())).all()
