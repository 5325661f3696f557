"""Machines of a fault campaign: the nominal one, and perturbed ones that are the same in every campaign.

    parameter   p (1 + tolerance s)
    sensor      offset s, gain error s, of the largest ones that are declared

Each s is -1 or 1 at random for the first CORNERS perturbed machines, and uniform in -1 .. 1 for the others.
"""

from dataclasses import replace

import numpy as np

from synth.plant import Plant
from synth.simulate import sampling
from synth.simulate.rig import Rig
from synth.simulate.sampling import Array

CORNERS, SEED = 8, 18  # number of perturbed machines at corners of the tolerances, and the seed of all


def plant_number(plant: Plant, i: int) -> Plant:
    """Return the nominal plant for i = 0, otherwise perturbed plant i."""
    tolerances = {p.name: p.value * p.tolerance for p in plant.parameters if p.tolerance > 0}
    if i == 0 or not tolerances:
        return plant
    changes = dict(zip(tolerances, _s(i, len(tolerances)) * np.array(list(tolerances.values())), strict=True))
    return plant.with_parameters(**{n: plant.parameter(n).value + float(d) for n, d in changes.items()})


def machine_number(rig: Rig, i: int) -> Rig:
    """Return the rig with plant number i, and with that plant's errors of the sensors."""
    if i == 0:
        return rig
    quantities = sampling.quantities(rig)
    s = dict(zip(quantities, _s(i, len(quantities)).tolist(), strict=True))
    return sampling.with_sensor_errors(replace(rig, plant=plant_number(rig.plant, i)), s)


def _s(i: int, n: int) -> Array:
    """Return the first n numbers s of plant i, which do not depend on n."""
    rng = np.random.default_rng([SEED, i])
    return rng.choice((-1.0, 1.0), n) if i <= CORNERS else rng.uniform(-1, 1, n)
