"""The nonlinear plant under the law follows the chains of integrators."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from models import maglev_stage
from synth.analyse import trim
from synth.plant import Plant
from synth.synthesise.nonlinear import dynamic_extension, feedback_linearisation
from synth.synthesise.nonlinear.feedback_linearisation import Linearisation
from tests import tolerances
from tests.synthesise.nonlinear.laws import lawful


def full_stage() -> Plant:
    """The platen with every quadratic term and an integrator before each current: 16 states."""
    return dynamic_extension.integrators(maglev_stage.plant(), [s.name for s in maglev_stage.INPUTS])


def chain(law: Linearisation, x: np.ndarray) -> np.ndarray:
    """Return the outputs and their derivatives below the degrees at a state."""
    chains = ca.Function("chains", [law.x], [ca.densify(ca.vertcat(*law.degree.chains))])
    return chains(x).full().ravel()


def companion(law: Linearisation, pole: float) -> tuple[np.ndarray, np.ndarray]:
    """Return K and A + B K of the integrator chains with every pole at -pole."""
    order = law.degree.degrees
    K, closed, row = np.zeros((len(order), sum(order))), np.zeros((sum(order), sum(order))), 0
    for i, r in enumerate(order):
        K[i, row : row + r] = -np.poly(np.full(r, -pole))[:0:-1]
        closed[row : row + r - 1, row + 1 : row + r] = np.eye(r - 1)
        closed[row + r - 1] = K[i]
        row += r
    return K, closed


def followed(law: Linearisation, x0: np.ndarray, pole: float, seconds: float, sign: float = 1.0) -> float:
    """Simulate the nonlinear plant under w = K (chain); return how far its chain is from exp(A t) of the first one."""
    K, closed = companion(law, pole)
    chains = ca.vertcat(*law.degree.chains)
    u = sign * ca.substitute(law.u, law.w, ca.mtimes(ca.SX(K), chains))
    loop = ca.Function("loop", [law.x], [law.plant.f(law.x, u, law.plant.values)])
    times = np.linspace(0, seconds, 5)
    run = solve_ivp(
        lambda t, x: loop(x).full().ravel(), (0, seconds), x0, t_eval=times, method="DOP853", rtol=1e-11, atol=1e-12
    )
    first = chain(law, x0)
    reached = np.array([chain(law, x) for x in run.y.T])
    expected = np.array([expm(closed * t) @ first for t in run.t])
    return float((np.abs(reached - expected) / np.abs(expected).max(axis=0)).max())


STARTS = {
    "flexible_joint": ([0.6, 0.3, 0.5, -0.2], 6.0, 1.0),
    "unicycle": ([0.5, -0.4, 0.3, 0.8], 0.3, 0.8),
    "flat aircraft": ([0.3, 0.0, -0.2, 0.1, 0.2, 0.1, 1.1, 0.05], 1.0, 1.0),
    "ball_and_beam": ([0.5, 0.2, 0.1, 0.4], 0.8, 0.2),
}


@pytest.mark.parametrize("name", STARTS)
def test_the_nonlinear_plant_follows_the_linear_chain(name: str) -> None:
    start, pole, seconds = STARTS[name]
    law = lawful(name)
    assert followed(law, np.array(start), pole, seconds) < tolerances.of("ode")
    assert followed(law, np.array(start), pole, seconds, sign=1.001) > 1e-5


def test_the_levitated_stage_follows_fifteen_integrators() -> None:
    """All quadratic terms of the currents are in the plant, and no term is dropped from the law."""
    stage = full_stage()
    point = trim.trim(stage, {"y": 0.025}, ["i_d1", "i_d2", "i_d3", "i_d4"])
    law = feedback_linearisation.of_plant(stage, list(maglev_stage.RATE), point=point, weight=np.eye(6))
    assert law.degree.degrees == (3,) * 5 and law.zeros is not None and law.zeros.agreed
    assert law.check().passed
    assert law.zeros.order == 1 and law.zeros.verdict == "not hyperbolic"  # the sixth current, at rest
    x0 = np.array(point.x)
    names = [s.name for s in stage.states]
    for state, value in {"y": 2e-4, "x": 1e-3, "z": -1e-3, "phi": 2e-4, "theta": -1e-3}.items():
        x0[names.index(state)] += value
    origin = ca.DM(chain(law, np.array(point.x)).tolist())
    ends = np.cumsum([0, *law.degree.degrees])
    centred = tuple(c - origin[i:j] for c, i, j in zip(law.degree.chains, ends, ends[1:], strict=False))
    about = replace(law, degree=replace(law.degree, chains=centred))
    assert followed(about, x0, 40.0, 0.05) < 1e-6
