"""Sets of parameter values at the ends of their tolerances: the corners of a box (MATLAB: `ureal` vertices)."""

import itertools
from collections.abc import Mapping, Sequence

from synth import arguments
from synth.errors import SignalError
from synth.plant import Plant

MAX_CORNERS = 1024  # an equilibrium is solved for each of them at each operating point

Case = Mapping[str, float]  # parameter values that differ from the nominal ones


@arguments.checked
def corners(plant: Plant, parameters: Sequence[str]) -> list[Case]:
    """Return all combinations of some parameters at the ends of their tolerances: 2^k for k of them.

    Raises SignalError for an unknown parameter, one without a tolerance, or more than MAX_CORNERS corners.
    """
    ends = [_ends(plant, name) for name in parameters]
    if 2 ** len(ends) > MAX_CORNERS:
        raise SignalError(
            f"{len(ends)} parameters have 2^{len(ends)} corners, at most {MAX_CORNERS} are allowed: name fewer"
        )
    return [dict(zip(parameters, values, strict=True)) for values in itertools.product(*ends)] if ends else []


def _ends(plant: Plant, name: str) -> tuple[float, float]:
    p = plant.parameter(name)
    if not p.tolerance * abs(p.value):
        raise SignalError(
            f"parameter '{name}' is {p.value} {p.unit} with the tolerance {p.tolerance}: neither may be 0; set them"
        )
    return p.value * (1 - p.tolerance), p.value * (1 + p.tolerance)
