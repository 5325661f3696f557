"""Contents of gains.json: weights, gain, poles and certificate of each axis, and the sampled-data optimum."""

from dataclasses import replace
from typing import Any

import numpy as np

from designs.maglev import platen
from designs.maglev_5dof import control
from synth.statespace import readonly
from synth.synthesise import digits
from synth.synthesise.feedback import lqr
from synth.synthesise.regulation import internal_model


def document(scalar: type[np.floating]) -> dict[str, Any]:
    """Return each axis' gain with its weights, plant, period and certificate, and the gain by lqrd for comparison."""
    return {axis.name: _gain(axis, scalar) for axis in control.AXES}


def _gain(axis: control.Axis, scalar: type[np.floating]) -> dict[str, Any]:
    model, period, Q, R = control.axis_plant(axis), platen.TIME.period_s, np.diag(axis.weights), np.eye(1)
    published, T = control.gain(axis), internal_model.leapfrog(control.FREQUENCIES, period).T
    constants = {c.name: c.value for c in control.regulator_block(axis).rounded(scalar).constants}
    on_xi = np.linalg.solve(T.T, [constants[f"k_{s}"] for s in ("sum", "p1", "q1")])
    rounded = replace(published, K=readonly([[constants["k_e"], constants["k_de"], *on_xi]]))
    sampled = lqr.lqrd(model, Q, R, period)
    return {
        "plant": "q'' = w, xi' = Phi xi + N e, Phi and N for the frequencies below; states e, de, xi1, xi2, xi3",
        "coordinates": "K is on these states; the constants are on e, de, sum, p1, q1 with xi = T (sum, p1, q1)",
        "T": T.tolist(),
        "frequencies_rad_s": list(control.FREQUENCIES),
        "weights_Q": list(axis.weights),
        "weight_R": 1.0,
        "published_weights": axis.name != "phi",  # the paper gives none for phi
        "period_s": period,
        "K": [float(v) for v in published.K[0].astype(scalar)],
        "poles_rad_s": [digits.pole(s) for s in published.poles],
        "certificate": digits.certificate(published.certificate),
        "sampled_data_optimum": {
            "K": [digits.significant(v, 6) for v in sampled.K[0]],
            "worst_cost_ratio_of_K": digits.significant(lqr.cost_ratio(model, rounded, Q, R, period), 4),
        },
    }
