"""Coloured noise: white noise through a shaping filter, whose states are estimated together with the plant's.

    process        white --> [shaping] --+
                                         v
                                 u ---->(+)--> [plant] --> y          [x ]'   [A  B C_f] [x ]   [B  B D_f] [u    ]
                                                                      [x_f]  = [0   A_f ] [x_f] + [0   B_f ] [white]

    measurement                  white --> [shaping] --+
                                                       v
                                 u ---> [plant] ----->(+)--> y        y = [C  C_f] [x; x_f] + [D  D_f] [u; white]

The filter's outputs have the names of the plant's inputs or outputs to which they are added. In the model that comes
out the white noises are inputs; name them as G to `kalman`. An input on which nothing known acts is taken out by
`select`. Noise that the filter makes of white noise alone, without a white part of its own (V = 0, D_f = 0), can be
differentiated until it is exact: `kalman` refuses it, and a reduced-order observer is in place.

Library: no design uses it yet; docs/library.md has an example.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.linalg

from synth import arguments
from synth.errors import SignalError
from synth.signals import dimension
from synth.statespace import Array, StateSpace, System, of
from synth.timing import common


@arguments.checked
def process(system: System, shaping: System) -> StateSpace:
    """Return the plant with noise of a shaping filter added to the inputs that the filter's outputs are named after.

    States (plant's, filter's), inputs (plant's, filter's white noises), outputs the plant's; units are carried.

    Raises TimingError for unlike times; SignalError for an output of the filter that is no input of the plant or has
    another unit, or when a name stands twice.
    """
    plant, f = of(system), of(shaping)
    E = _selection("input", plant.inputs, plant, f)
    A = np.block([[plant.A, plant.B @ E @ f.C], [np.zeros((len(f.A), len(plant.A))), f.A]])
    B = np.block([[plant.B, plant.B @ E @ f.D], [np.zeros((len(f.A), len(plant.inputs))), f.B]])
    C, D = np.hstack([plant.C, plant.D @ E @ f.C]), np.hstack([plant.D, plant.D @ E @ f.D])
    return _joined(plant, f, A, B, C, D)


@arguments.checked
def measurement(system: System, shaping: System) -> StateSpace:
    """Return the plant with noise of a shaping filter added to the outputs that the filter's outputs are named after.

    States, inputs, units and errors as for `process`.
    """
    plant, f = of(system), of(shaping)
    E = _selection("output", plant.outputs, plant, f)
    A, B = scipy.linalg.block_diag(plant.A, f.A), scipy.linalg.block_diag(plant.B, f.B)
    return _joined(plant, f, A, B, np.hstack([plant.C, E @ f.C]), np.hstack([plant.D, E @ f.D]))


def _joined(plant: StateSpace, f: StateSpace, A: Array, B: Array, C: Array, D: Array) -> StateSpace:
    if twice := sorted({*plant.states, *plant.inputs} & {*f.states, *f.inputs}):
        raise SignalError(f"'{twice[0]}' is a name of the plant and of the shaping filter: rename one")
    states, inputs = plant.states + f.states, plant.inputs + f.inputs
    return replace(plant, A=A, B=B, C=C, D=D, states=states, inputs=inputs, units={**f.units, **plant.units})


def _selection(kind: str, names: Sequence[str], plant: StateSpace, f: StateSpace) -> Array:
    """Return E with E[i, j] = 1 where the filter's output j is added to the plant's signal i."""
    common(plant.time, f.time)
    E = np.zeros((len(names), len(f.outputs)))
    for j, name in enumerate(f.outputs):
        if name not in names:
            raise SignalError(
                f"the shaping filter's output '{name}' is no {kind} of the plant: name it one of {', '.join(names)}"
            )
        here, there = plant.unit(name), f.unit(name)
        if here and there and dimension(here) != dimension(there):
            raise SignalError(f"'{name}' is in {there} in the shaping filter and in {here} in the plant: use one unit")
        E[names.index(name), j] = 1.0
    return E
