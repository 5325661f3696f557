"""Input-affine plants and their Lie derivatives.

    dx/dt = f(x) + G(x) u,    y = h(x) + E(x) u,    x (n,), u (m,), y (p,)

Along a solution a function e(x) changes at the rate L_f e + (L_G e) u with

    L_f e = de/dx f,    L_G e = de/dx G.

Source: Isidori, Nonlinear Control Systems, 4.1 and 5.1.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from synth import arguments
from synth.analyse.numerics import rounding
from synth.analyse.numerics.box import Box
from synth.errors import ModelError, SignalError
from synth.plant import Plant
from synth.signals import Signal, signal_names


@dataclass(frozen=True, eq=False)
class Affine:
    """The plant called `name` as f (n,), G (n, m), h (p,), E (p, m) in the symbols of `box`: states and parameters.

    Structural zeros of G and E are entries that vanish on the whole domain. `held` has the inputs that are constant.
    """

    name: str
    states: tuple[Signal, ...]
    inputs: tuple[Signal, ...]
    outputs: tuple[Signal, ...]
    box: Box
    f: ca.SX
    G: ca.SX
    h: ca.SX
    E: ca.SX
    held: Mapping[str, float]

    @property
    def x(self) -> ca.SX:
        """The states' symbols (n,)."""
        return self.box.symbols

    def along_drift(self, e: ca.SX) -> ca.SX:
        """Return L_f e for each entry of e (k,)."""
        return ca.cse(ca.jtimes(e, self.x, self.f))  # without cse the length grows as the factorial of the order

    def along_inputs(self, e: ca.SX) -> ca.SX:
        """Return L_G e (k, m) for the entries of e (k,), with structural zeros."""
        return rounding.without_zeros(ca.cse(ca.mtimes(ca.jacobian(e, self.x), self.G)), self.box)


@arguments.checked
def affine(plant: Plant, outputs: Sequence[str] | None = None, held: Mapping[str, float] | None = None) -> Affine:
    """Return the plant in affine form, with the named `outputs`, by default all, and the inputs that are not `held`.

    `held` gives the constant values of inputs, by name, in their units.

    Raises SignalError for a name that the plant does not have, ModelError if an equation is not affine in the inputs.
    """
    held = dict(held or {})
    rows = _output_rows(plant, outputs)
    inputs = _free_inputs(plant, held)
    x, u = (ca.vertcat(*(ca.SX.sym(s.name) for s in part)) for part in (plant.states, inputs))
    free = dict(zip(signal_names(inputs), ca.vertsplit(u), strict=True))
    all_inputs = ca.vertcat(*(free[s.name] if s.name in free else ca.SX(held[s.name]) for s in plant.inputs))
    p = ca.vertcat(ca.SX(0, 1), *(ca.SX.sym(s.name) for s in plant.parameters))
    stacked = ca.vertcat(plant.f(x, all_inputs, p), plant.h(x, all_inputs, p)[rows])
    base = ca.SX([float(np.clip(0.0, s.low, s.high)) for s in inputs])
    slopes, level = (ca.substitute(e, u, base) for e in (ca.jacobian(stacked, u), stacked))
    equations = [f"the rate of '{s.name}'" for s in plant.states] + [f"'{plant.outputs[k].name}'" for k in rows]
    box_of_all = Box(ca.vertcat(x, u), (*plant.states, *inputs), p, plant.values)
    _require_affine(plant.name, equations, (stacked, slopes, base), box_of_all)
    of_states = Box(x, plant.states, p, plant.values)
    slopes = rounding.without_zeros(slopes, of_states)
    ends = [0, len(plant.states), len(equations)]
    (f, h), (G, E) = ca.vertsplit(level - ca.mtimes(slopes, base), ends), ca.vertsplit(slopes, ends)
    outs = tuple(plant.outputs[k] for k in rows)
    return Affine(plant.name, plant.states, inputs, outs, of_states, f, G, h, E, held)


def _output_rows(plant: Plant, outputs: Sequence[str] | None) -> list[int]:
    known = signal_names(plant.outputs)
    chosen = known if outputs is None else tuple(outputs)
    if unknown := [n for n in chosen if n not in known]:
        raise SignalError(f"plant '{plant.name}' has no output '{unknown[0]}': it has {', '.join(known)}")
    if not chosen or len(set(chosen)) < len(chosen):
        raise SignalError(f"the outputs are ({', '.join(chosen)}): name at least one, and each once")
    return [known.index(n) for n in chosen]


def _free_inputs(plant: Plant, held: Mapping[str, float]) -> tuple[Signal, ...]:
    known = signal_names(plant.inputs)
    if unknown := [n for n in held if n not in known]:
        raise SignalError(f"plant '{plant.name}' has no input '{unknown[0]}' to hold: it has {', '.join(known)}")
    if bad := [n for n, v in held.items() if not np.isfinite(v)]:
        raise SignalError(f"the input '{bad[0]}' is held at {held[bad[0]]}: give a finite value")
    inputs = tuple(s for s in plant.inputs if s.name not in held)
    if not inputs:
        raise SignalError(f"plant '{plant.name}': every input is held: leave at least one free")
    return inputs


def _require_affine(
    plant: str,
    equations: Sequence[str],
    parts: tuple[ca.SX, ca.SX, ca.SX],
    box: Box,
) -> None:
    """Raise ModelError unless e (k,) = e(u with u_j = base_j) + slope_j (u_j - base_j) for every input j."""
    stacked, slopes, base = parts
    m = base.numel()
    u, inputs = box.symbols[-m:], box.signals[-m:]
    nonaffine: dict[str, list[str]] = {}
    for j, input in enumerate(inputs):
        remainder = stacked - ca.substitute(stacked, u[j], base[j]) - slopes[:, j] * (u[j] - base[j])
        for k in np.flatnonzero(~rounding.vanish(ca.densify(remainder), box)):
            nonaffine.setdefault(equations[int(k)], []).append(input.name)
    if nonaffine:
        terms = "; ".join(
            f"{equation} in {', '.join(nonaffine[equation])}" for equation in equations if equation in nonaffine
        )
        input_names = ", ".join(s.name for s in inputs if any(s.name in part for part in nonaffine.values()))
        raise ModelError(
            f"plant '{plant}' is not affine in its inputs: {terms}. Make {input_names} states, "
            "with their rates as inputs, declare the whole term as the input and invert it outside, or hold it"
        )
