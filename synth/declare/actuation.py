"""Signs of the actuators: which coordinates a positive input accelerates, from the plant's input Jacobian df/du.

i_d1: +y -phi     the rates of y and phi change with i_d1 by a positive and a negative amount

An input without a slope at the point, such as a current of 0 A whose force grows with its square, has the signs of what
its upper end changes.
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
    f = ca.Function("f", [x, u], [plant.f(x, u, plant.values)])
    B = ca.Function("B", [x, u], [ca.jacobian(f(x, u), u)])
    at = [np.array([point.get(s.name, 0.0) for s in signals]) for signals in (plant.states, plant.inputs)]
    slopes = np.array(B(*at))
    for k, signal in enumerate(plant.inputs):
        if not slopes[:, k].any():
            upper = np.where(np.arange(len(at[1])) == k, signal.high, at[1])
            slopes[:, k] = np.asarray(f(at[0], upper) - f(*at)).ravel()
    names = [s.name for s in plant.states]
    entries = slopes[[names.index(rate) for rate in rates.values()]]
    entries[np.abs(entries) <= SMALL * np.abs(entries).max(axis=1, keepdims=True)] = 0
    texts = {
        s.name: " ".join(f"{'+' if v > 0 else '-'}{q}" for q, v in zip(rates, column, strict=True) if v)
        for s, column in zip(plant.inputs, entries.T, strict=True)
    }
    return {name: text for name, text in texts.items() if text}
