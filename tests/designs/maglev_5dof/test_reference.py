"""The maglev controller's NumPy reference against closed forms, SciPy, the full plant and the published poles.

The full plant is the reference's own F(6)-(7); F(11) is taken from it by differences, which are exact for a quadratic.
"""

from math import asin, exp, sin

import numpy as np
import pytest
from numpy.typing import NDArray

from designs.maglev import reference_stage
from designs.maglev_5dof import reference
from tests.designs.maglev_5dof import full_plant

Array = NDArray[np.float64]
P = reference_stage.Parameters()
# Largest |error|: |s| stays below twice that over 1 - 1/e, and |r| below twice that over 1 - 2/e.
ERRORS = {"y": 0.0165, "x": 0.15, "z": 0.15, "phi": 0.023, "theta": 0.045}


def start(n: int = 1, **changes: float) -> dict[str, Array]:
    return {name: np.full(n, changes.get(name, value)) for name, value in full_plant.initial_state().items()}


def any_state(rng: np.random.Generator, n: int) -> dict[str, Array]:
    """Return n states anywhere in their bounds, ready and not latched."""
    state = start(n, guard_ready=1)
    for s, widest in ERRORS.items():
        state[f"filter_{s}_q_prev"] = rng.uniform(-1, 1, n) * widest
        state[f"filter_{s}_s"] = rng.uniform(-1, 1, n) * 2 * widest / (1 - exp(-1))
        state[f"filter_{s}_r"] = rng.uniform(-1, 1, n) * 2 * widest / (1 - 2 * exp(-1))
        bounds = zip(reference.ETA, reference.ETA_BOUNDS, strict=True)
        state |= {f"regulator_{s}_{name}": rng.uniform(-b, b, n) for name, b in bounds}
    for s in reference_stage.SAFE:
        state[f"safe_output_last_{s}"] = rng.uniform(-4.9, 4.9, n)
    return state


def any_inputs(rng: np.random.Generator, n: int) -> dict[str, Array]:
    return {s: rng.uniform(low, high, n) for s, (low, high) in reference_stage.LIMITS.items()}


def test_kinematics_invert_5() -> None:
    at = {"y": 0.024, "phi": 0.0025, "theta": -0.012}
    tilt, roll = P.r * sin(at["phi"]), P.r * sin(at["theta"])
    v = np.array([at["y"] - tilt, at["y"] + roll, at["y"] + tilt, at["y"] - roll, 0.01, 0.02])
    y, x, z, phi, theta = reference_stage.pose(v, P.r)
    pose = {"y": y, "x": x, "z": z, "phi": phi, "theta": theta}
    assert pose == pytest.approx(at | {"x": 0.01, "z": 0.02}, abs=1e-16)
    assert phi == pytest.approx(asin(tilt / P.r), rel=1e-12)


def test_scalars_and_columns_agree() -> None:
    rng, n = np.random.default_rng(4), 5
    state, at = any_state(rng, n), any_inputs(rng, n)
    at["y1"][2] = np.nan
    after, out, word = reference.step(state, at)
    for j in range(n):
        one = reference.step({s: v[j] for s, v in state.items()}, {s: v[j] for s, v in at.items()})
        np.testing.assert_allclose([one[0][s] for s in after], [v[j] for v in after.values()], rtol=1e-13, atol=1e-15)
        np.testing.assert_allclose([one[1][s] for s in out], [v[j] for v in out.values()], rtol=1e-13, atol=1e-15)
        assert one[2] == word[j]
