"""Phasors of an angle and of phases that are affine in it: residuals and Jacobian of the same model without them."""

from dataclasses import replace
from math import pi
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.blocks.estimate import glsdc_jacobian
from synth.blocks.estimate.glsdc_model import Phase, Unknown
from synth.signals import Signal
from synth.statespace import Array

CHANNELS = [Signal(f"y_{k}", "V", -3.0, 3.0) for k in range(3)]
TURN = Unknown(Signal("turn", "rad", -0.5, 0.5), 0.3, 0.2, angle=True)
WAVE = Unknown(Signal("wave", "rad", -pi, pi), 0.3, 0.4, periodic=True)
ARMS = ((0.4, 1.1), (-0.7, 0.3), (1.2, -0.5))


def along(k: int, form: str) -> Any:
    """Return the phase of channel k as a function of the unknowns; that of `bent` is not affine."""
    a, b = ARMS[k]

    def phase(q: Any, _: Any) -> Any:
        if form == "direct":
            return q["wave"] + a * ca.cos(q["turn"]) + b * ca.sin(q["turn"])
        bent = q["sin_turn"] ** 2 + q["cos_turn"] ** 2 - 1 if form == "bent" else 0
        return q["wave"] + a * q["cos_turn"] + b * q["sin_turn"] + bent

    return phase


def linearised(form: str, by: tuple[float, float], step: float = 0.2) -> tuple[Array, Array]:
    """Return residuals and Jacobian of field s + s^3/2 - s^5/5 of each phase's sine s, at a displacement."""

    def h(q: Any, k: Any) -> Any:
        if form == "direct":
            sines = [ca.sin(along(k, form)(q, {})) for k in range(3)]
        else:
            sines = [q[f"sin_p{k}"] for k in range(3)]
        return {s.name: v * (1 + v**2 * (0.5 - 0.2 * v**2)) for s, v in zip(CHANNELS, sines, strict=True)}

    phases = [] if form == "direct" else [Phase(f"p{k}", along(k, form), 5.0, 1.0) for k in range(3)]
    unknowns = [replace(TURN, step=step), WAVE]
    of = glsdc_jacobian.model(h, np.eye(3), CHANNELS, (), unknowns, phases, ())
    assert (of.phase_changes is None) == (form == "bent")
    start, measured = [ca.SX(0.2), ca.SX(-1.3)], [ca.SX(v) for v in (0.5, -0.2, 0.9)]
    prediction = glsdc_jacobian.predict(of, start, measured, ca.SX(0, 1), [])
    result = glsdc_jacobian.linearise(of, prediction, [ca.SX(v) for v in by])
    return np.array([float(ca.evalf(e)) for e in result.residuals]), np.array(
        [[float(ca.evalf(v)) for v in row] for row in result.rows]
    )


@pytest.mark.parametrize("by", [(0.0, 0.0), (0.15, -0.3), (-0.2, 0.4), (0.2, 0.1)])
@pytest.mark.parametrize("form", ["affine", "bent"])
def test_residuals_and_jacobian_are_those_without_phasors(form: str, by: tuple[float, float]) -> None:
    for value, reference in zip(linearised(form, by), linearised("direct", by), strict=True):
        np.testing.assert_allclose(value, reference, rtol=1e-12, atol=1e-12)
