"""Kalman filters for coloured noise: state augmentation with a shaping filter driven by white noise (Simon, chapter 7).

    process        white --> [shaping] --+
                                         v
                                 u ---->(+)--> [plant] --> y          [x ]'   [A  B C_f] [x ]   [B  B D_f] [u    ]
                                                                      [x_f]  = [0   A_f ] [x_f] + [0   B_f ] [white]

    measurement                  white --> [shaping] --+
                                                       v
                                 u ---> [plant] ----->(+)--> y        y = [C  C_f] [x; x_f] + [D  D_f] [u; white]

The outputs of the filter have the names of the plant's inputs or outputs to which they are added. The white noises are
inputs of the augmented model; name them as G in `kalman`. `select` removes an input on which no known signal acts.
Coloured measurement noise without a white part (V = 0, D_f = 0) can be differentiated until the measurement is exact.
`kalman` refuses it; use a reduced-order observer.

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
    """Return the plant with noise of a shaping filter added to the inputs named by the filter's outputs.

    The states are (plant's, filter's), the inputs (plant's, filter's white noises), the outputs those of the plant.
    Units are kept.

    Raises TimingError for different times; SignalError for an output of the filter that is no input of the plant or has
    another unit, or for a duplicate name.
    """
    plant, f = of(system), of(shaping)
    E = _added_outputs("input", plant.inputs, plant, f)
    A = np.block([[plant.A, plant.B @ E @ f.C], [np.zeros((len(f.A), len(plant.A))), f.A]])
    B = np.block([[plant.B, plant.B @ E @ f.D], [np.zeros((len(f.A), len(plant.inputs))), f.B]])
    C, D = np.hstack([plant.C, plant.D @ E @ f.C]), np.hstack([plant.D, plant.D @ E @ f.D])
    return _augmented(plant, f, A, B, C, D)


@arguments.checked
def measurement(system: System, shaping: System) -> StateSpace:
    """Return the plant with noise of a shaping filter added to the outputs named by the filter's outputs.

    States, inputs, units and errors as for `process`.
    """
    plant, f = of(system), of(shaping)
    E = _added_outputs("output", plant.outputs, plant, f)
    A, B = scipy.linalg.block_diag(plant.A, f.A), scipy.linalg.block_diag(plant.B, f.B)
    return _augmented(plant, f, A, B, np.hstack([plant.C, E @ f.C]), np.hstack([plant.D, E @ f.D]))


def _augmented(plant: StateSpace, f: StateSpace, A: Array, B: Array, C: Array, D: Array) -> StateSpace:
    if twice := sorted({*plant.states, *plant.inputs} & {*f.states, *f.inputs}):
        raise SignalError(f"'{twice[0]}' is a name of the plant and of the shaping filter: rename one")
    states, inputs = plant.states + f.states, plant.inputs + f.inputs
    return replace(plant, A=A, B=B, C=C, D=D, states=states, inputs=inputs, units={**f.units, **plant.units})


def _added_outputs(kind: str, names: Sequence[str], plant: StateSpace, f: StateSpace) -> Array:
    """Return E with E[i, j] = 1 where the filter's output j is added to the plant's signal i."""
    common(plant.time, f.time)
    E = np.zeros((len(names), len(f.outputs)))
    for j, name in enumerate(f.outputs):
        if name not in names:
            raise SignalError(
                f"the shaping filter's output '{name}' is not an {kind} of the plant: name it one of {', '.join(names)}"
            )
        here, there = plant.unit(name), f.unit(name)
        if here and there and dimension(here) != dimension(there):
            raise SignalError(f"'{name}' is in {there} in the shaping filter and in {here} in the plant: use one unit")
        E[names.index(name), j] = 1.0
    return E
