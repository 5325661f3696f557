"""What ships: the estimator of two sensors as published, and of three where the worst deviation is least.

The field is that of the fabricated matrix at the sensors' height, by the blocks' remanences, times the chain's V/T.
"""

from collections.abc import Mapping
from types import MappingProxyType

from designs.hall_position.accuracy import layouts
from designs.hall_position.glsdc import estimator
from designs.hall_position.glsdc.parameters import Array, Pair, Tuning
from models import concentrated_field, hall_array
from models.concentrated_field import STRONG, WEAK
from models.hall_chain import Chain
from synth.block import Block
from synth.emit.c import digits
from synth.errors import DesignError
from synth.timing import Discrete

NAME, THREE = "hall_position", "hall_position_three"
TIME = Discrete(1 / 800)
LAYOUT = 5  # degrees of yaw to either side, for which the three sensors are placed
PLACES: Mapping[str, tuple[Pair, ...]] = MappingProxyType(
    {NAME: layouts.PUBLISHED[:2], THREE: layouts.LAYOUTS[LAYOUT]}
)  # in pitches
TUNING = Tuning()
DIGITS = 6  # of the field, so that it is the same on every machine


def array(name: str = NAME, chain: Chain | None = None) -> Array:
    """Return the sensors that ship under a name, their field in V and their noise.

    Raises DesignError for an unknown name.
    """
    if name not in tuple(PLACES):
        raise DesignError(f"'{name}' is none of the estimators that ship: give one of {', '.join(PLACES)}")
    chain = chain or Chain()
    alpha, beta = (digits.cut(chain.gain * b, DIGITS) for b in amplitudes())
    pitch = concentrated_field.PARAMETERS[0].value
    places = tuple((x * pitch, y * pitch) for x, y in PLACES[name])
    return Array(places, 0.0, alpha, beta, pitch, chain.noise)


def amplitudes() -> tuple[float, float]:
    """Return alpha and beta of (2) for the fabricated matrix, T."""
    cell = concentrated_field.fabricated(STRONG, WEAK)
    waves = concentrated_field.waves(cell, [(1, 0), (5, 0)], concentrated_field.values())
    first, fifth = (float(concentrated_field.amplitude(w, hall_array.HEIGHT)) for w in waves)
    return first, fifth


def block(name: str = NAME) -> Block:
    """Return the guarded estimator that ships under a name; raise DesignError for an unknown one."""
    return estimator.guarded(array(name), TIME, TUNING, name)
