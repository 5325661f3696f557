"""Random plants are extended where they have a right inverse, and refused where a differential rank says so.

The rank knows nothing of integrators or decoupling matrices (Di Benedetto, Grizzle, Moog 1989): at a generic point

    rho = rank J_n - rank J_(n-1),    J_k = d(y, y', ..., y^(k)) / d(u, u', ..., u^(k))

independent outputs can be given at will; a right inverse exists where rho = p.
"""

import operator
from functools import reduce

import casadi as ca
import numpy as np
import pytest

from synth.errors import ModelError
from synth.plant import Plant, Symbols, build
from synth.signals import Signal
from synth.synthesise.nonlinear import dynamic_extension, feedback_linearisation

SEEDS = range(45)


def random_plant(seed: int) -> Plant:
    """Up to four states, three inputs and as many outputs, joined by sparse products of sines and states."""
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(2, 5)), int(rng.integers(1, 4))
    p = int(rng.integers(1, m + 1))

    def product(x: list[ca.SX]) -> ca.SX:
        factors = [
            (x[k], ca.sin(x[k]), ca.cos(x[k]))[int(rng.integers(3))] for k in rng.integers(0, n, rng.integers(3))
        ]
        return reduce(operator.mul, factors, ca.SX(int(rng.integers(1, 3))))

    def physics(x: Symbols, u: Symbols, p_: Symbols) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        states, rates = list(x.values()), {}
        for k, name in enumerate(x):
            rates[name] = product(states) + (states[(k + 1) % n] if rng.random() < 0.5 else 0)
            for v, share in zip(u.values(), (0.7, 0.3, 0.2), strict=False):
                if rng.random() < share:
                    rates[name] += (1 if rng.random() < 0.6 else product(states)) * v
        return rates, {f"y{k}": states[k % n] + (0 if rng.random() < 0.7 else product(states)) for k in range(p)}

    kinds = (("x", n, -1.0, 1.5), ("u", m, -1.0, 2.0), ("y", p, -9.0, 9.0))
    x, u, y = ([Signal(f"{s}{k}", "1", low, high) for k in range(count)] for s, count, low, high in kinds)
    return build("random", x, u, y, [], physics)


def independent_outputs(plant: Plant) -> int:
    """Return rho."""
    n, m, p = len(plant.states), len(plant.inputs), len(plant.outputs)
    x, u = ca.SX.sym("x", n), [ca.SX.sym(f"u{k}", m) for k in range(n + 2)]
    jet, flow = ca.vertcat(x, *u[:-1]), ca.vertcat(plant.f(x, u[0], []), *u[1:])
    y = [plant.h(x, u[0], [])]
    for _ in range(n):
        y.append(ca.cse(ca.jtimes(y[-1], jet, flow)))
    J = ca.Function("J", [ca.vertcat(x, *u)], [ca.densify(ca.jacobian(ca.vertcat(*y), ca.vertcat(*u)))])
    points = np.random.default_rng(1).uniform(-1.0, 1.4, (3, n + m * (n + 2)))
    return max(rank(M) - rank(M[:-p]) for M in (J(point).full() for point in points))


def rank(M: np.ndarray) -> int:
    size = np.linalg.norm(M, axis=1, keepdims=True)
    return int(np.linalg.matrix_rank(M / np.where(size > 0, size, 1.0), tol=1e-9))


def outcome(plant: Plant) -> str:
    """Return "served" or the kind of refusal; a law must pass its check."""
    try:
        extension = dynamic_extension.extend(plant)
        law = feedback_linearisation.of_plant(extension.plant, weight=np.eye(len(extension.plant.inputs)))
    except ModelError as error:
        kinds = {"cannot be decoupled": "dependent", "contains an input": "unreached", "not defined at": "singular"}
        kinds |= {"is singular in the domain": "singular"}
        return next(kind for text, kind in kinds.items() if text in str(error))
    assert law.check().passed
    return "extended" if extension.integrators else "served"


@pytest.fixture(scope="module")
def outcomes() -> dict[int, str]:
    return {seed: outcome(random_plant(seed)) for seed in SEEDS}


def test_refusals_are_those_without_a_right_inverse(outcomes: dict[int, str]) -> None:
    for seed, kind in outcomes.items():
        plant = random_plant(seed)
        has_inverse = independent_outputs(plant) == len(plant.outputs)
        assert has_inverse == (kind not in ("dependent", "unreached")), f"seed {seed}: {kind}"


def test_every_kind_occurs(outcomes: dict[int, str]) -> None:
    assert set(outcomes.values()) == {"served", "extended", "dependent", "unreached", "singular"}
