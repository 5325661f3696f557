"""A mass on a spring, and logs of its motion from the exponential of the held model."""

import numpy as np
import scipy.linalg

from synth.plant import Plant, build
from synth.signals import Parameter, Signal
from synth.synthesise.identify.logs import Log

MASS, DAMP, SPRING = (
    Parameter(n, v, u, 0.2, "test") for n, v, u in (("m", 2, "kg"), ("d", 3, "kg/s"), ("k", 40, "N/m"))
)


def stage(unstable: bool = False) -> Plant:
    """Return m v' = k x - d v + f, or with -k, seen by an encoder at x + offset."""

    def physics(x: dict, u: dict, p: dict) -> tuple[dict, dict]:
        force = (1 if unstable else -1) * p["k"] * x["x"] - p["d"] * x["v"] + u["f"]
        return {"x": x["v"], "v": force / p["m"]}, {"s": x["x"] + p["offset"]}

    return build(
        "stage",
        (Signal("x", "m", -1, 1), Signal("v", "m/s", -9, 9)),
        (Signal("f", "N", -9, 9),),
        (Signal("s", "m", -1, 1),),
        (MASS, DAMP, SPRING, Parameter("offset", 0.0, "m", 0.0, "test")),
        physics,
    )


def run(
    truth: dict[str, float], start: list[float], seed: int, noise: float, unstable: bool = False, push: float = 3.0
) -> Log:
    """Return 300 rows at 10 ms of the stage under random held forces, by the exponential of the held model."""
    rng, T = np.random.default_rng(seed), 0.01
    f, state, rows = np.repeat(push * rng.uniform(-1, 1, 30), 10), np.array(start), []
    sign = 1 if unstable else -1
    A = np.array([[0, 1, 0], [sign * truth["k"], -truth["d"], 1], [0, 0, 0]]) / [[1], [truth["m"]], [1]]
    M = scipy.linalg.expm(A * T)
    for k in range(len(f)):
        rows.append(state)
        if unstable:  # hold it by feedback, as a logged loop does
            f[k] += -90 * state[0] - 12 * state[1]
        state = M[:2, :2] @ state + M[:2, 2] * f[k]
    x, v = np.array(rows).T
    return Log(
        {
            "f": f,
            "x": x + noise * rng.normal(size=len(x)),
            "v": v + noise * rng.normal(size=len(x)),
            "s": x + truth.get("offset", 0.0) + noise * rng.normal(size=len(x)),
        },
        T,
    )
