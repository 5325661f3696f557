"""What gains.json says of the axes: weights, gain, poles, certificate, and the sampled-data optimum beside them."""

from dataclasses import replace
from typing import Any

import numpy as np

from designs.maglev_5dof import control
from synth.emit import digits
from synth.statespace import Array, readonly
from synth.synthesise import internal_model, lqr


def document(scalar: type[np.floating]) -> dict[str, Any]:
    """Return each axis' gain with the weights, plant and rate it came from, its certificate, and lqrd beside it."""
    return {axis.name: _gain(axis, scalar) for axis in control.AXES}


def _gain(axis: control.Axis, scalar: type[np.floating]) -> dict[str, Any]:
    model, period = control.axis_plant(axis), control.TIME.period_s
    Q, R = np.diag(axis.weights), np.eye(1)
    gain = control.gain(axis)
    sampled = lqr.lqrd(model, Q, R, period, exact=True)
    T = internal_model.leapfrog(control.FREQUENCIES, period).T
    ratio = lqr.cost_ratio(model, replace(gain, K=_shipped(axis, T, scalar)), Q, R, period, exact=True)
    certificate = gain.certificate
    return {
        "plant": "q'' = w, xi' = Phi xi + N e, Phi and N for the frequencies below; states e, de, xi1, xi2, xi3",
        "coordinates": "K is on these states; the constants are on e, de, sum, p1, q1 with xi = T (sum, p1, q1)",
        "T": T.tolist(),
        "frequencies_rad_s": list(control.FREQUENCIES),
        "weights_Q": list(axis.weights),
        "weight_R": 1.0,
        "published_weights": axis.name != "phi",
        "period_s": period,
        "K": [float(v) for v in gain.K[0].astype(scalar)],
        "poles_rad_s": [digits.pole(s) for s in gain.poles],
        "certificate": {
            "relative_residual_below": digits.bound(float(certificate.defect.max()) / max(axis.weights)),
            "relative_forward_error_estimate": digits.bound(
                float((certificate.step / np.abs(certificate.X).max()).max())
            ),
        },
        "sampled_data_optimum": {
            "K": [digits.cut(v, 6) for v in sampled.K[0]],
            "worst_cost_ratio_of_K": digits.cut(ratio, 4),
        },
    }


def _shipped(axis: control.Axis, T: Array, scalar: type[np.floating]) -> Array:
    """Return the gain (1, 5) on (e, de, xi) to which the rounded constants on (e, de, eta) amount."""
    block = control.regulator_block(axis).rounded(scalar)
    k = {c.name: c.value for c in block.constants}
    on_eta = [k[f"k_{s.name}"] for s in block.states]
    return readonly([[k["k_e"], k["k_de"], *np.linalg.solve(T.T, on_eta)]])
