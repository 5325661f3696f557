"""Signs of the actuators: which coordinates a positive input accelerates, from the plant's input Jacobian df/du.

i_d1: +y -phi     the rates of y and phi change with i_d1 by a positive and a negative amount
"""

from collections.abc import Mapping

import casadi as ca
import numpy as np

from synth.plant import Plant

SMALL = 1e-6  # of the largest entry of a rate: a smaller one is none


def signs(plant: Plant, rates: Mapping[str, str], point: Mapping[str, float]) -> dict[str, str]:
    """Return by input of the plant the coordinates that it accelerates, with their signs, at a point of operation.

    `rates` names the state that is the rate of each coordinate; states and inputs that the point does not have are 0.
    """
    x, u = ca.SX.sym("x", len(plant.states)), ca.SX.sym("u", len(plant.inputs))
    B = ca.Function("B", [x, u], [ca.jacobian(plant.f(x, u, plant.values), u)])
    at = [[point.get(s.name, 0.0) for s in signals] for signals in (plant.states, plant.inputs)]
    names = [s.name for s in plant.states]
    entries = np.array(B(*at))[[names.index(rate) for rate in rates.values()]]
    entries[np.abs(entries) <= SMALL * np.abs(entries).max(axis=1, keepdims=True)] = 0
    texts = {
        s.name: " ".join(f"{'+' if v > 0 else '-'}{q}" for q, v in zip(rates, column, strict=True) if v)
        for s, column in zip(plant.inputs, entries.T, strict=True)
    }
    return {name: text for name, text in texts.items() if text}
