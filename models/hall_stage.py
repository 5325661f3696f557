"""Stage of two-axis Hall sensors over a Halbach magnet matrix as printed: signal chain, and model (2) of the field.

    alpha_n = s A_n(z),    A_n the amplitude of sin(n w X) in B_X above the fabricated blocks, s in V/T.

Sensors are at +-(3/8, 3/8) l about the body's origin: the paper gives the spacing (3) only, whose first is (3/4) l.

Source: Kawato, Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors", (2), (3),
section 3.A.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from models import concentrated_field, finite_matrix, hall_array, hall_two_waves
from models.concentrated_field import STRONG, WEAK, Cell, Order, Wave
from models.finite_matrix import Scan
from models.hall_array import Array, Pair
from models.hall_chain import Chain
from models.hall_two_waves import PlanarArray

PUBLISHED: tuple[Pair, ...] = ((-0.375, -0.375), (0.375, 0.375), (0.640, 0.613))  # pitches; a third was added to (3)
PER_PITCH = 40  # points of a scan, with sensors at (3/8) l on grid points
NUMBERS = (1, 5)  # of model (2)


@dataclass(frozen=True)
class Stage:
    """Remanences in T, the sensors' height above the matrix in m, and their sensitivity in V/T and noise in V."""

    strong: float = STRONG
    weak: float = WEAK
    height: float = hall_array.HEIGHT
    sensitivity: float = Chain.sensitivity
    noise: float = Chain.noise

    @property
    def chain(self) -> Chain:
        """The signal chain of the sensors."""
        return Chain(self.sensitivity, noise=self.noise)

    @cached_property
    def pitch(self) -> float:
        """The pitch l in m."""
        return float(concentrated_field.values()["l"])

    @cached_property
    def pair(self) -> PlanarArray:
        """The first two sensors and model (2)."""
        return self.array(PUBLISHED[:2])

    @cached_property
    def three(self) -> PlanarArray:
        """All sensors and model (2)."""
        return self.array(PUBLISHED)

    @property
    def truth(self) -> Scan:
        """The voltages above six pitches of the fabricated blocks."""
        return finite_matrix.scan(self.strong, self.weak, self.height, self.chain.gain, PER_PITCH)

    def array(self, places: Sequence[Pair]) -> PlanarArray:
        """Return model (2) for sensors at places in pitches."""
        alpha, beta = (self.chain.gain * self.amplitudes(NUMBERS)[k] for k in (0, 1))
        two = ((0.0, 0.0), (self.pitch, 0.0))
        model = PlanarArray(two, 0.0, float(alpha), float(beta), self.pitch, self.chain.noise)
        return hall_two_waves.with_positions(model, tuple(places))

    def waves(self, orders: Sequence[Order], ideal: bool = False) -> tuple[Wave, ...]:
        """Return waves above the fabricated blocks, or above `ideal` ones."""
        return concentrated_field.waves(self._cell(ideal), orders, concentrated_field.values())

    def amplitudes(self, numbers: Sequence[int], z: float | None = None, ideal: bool = False) -> Array:
        """Return A_n in T of sin(n w X) in B_X, z in m above the matrix, at the sensors' height unless given."""
        at = self.height if z is None else z
        return np.array(concentrated_field.amplitudes(self._cell(ideal), numbers, at))

    def cross(self, z: float) -> float:
        """Return the amplitude in T of sin(w (2 X + Y)) in B_X."""
        return float(concentrated_field.amplitude(self.waves([(2, 1)])[0], z))

    def _cell(self, ideal: bool) -> Cell:
        return (
            concentrated_field.ideal_matrix(self.strong)
            if ideal
            else concentrated_field.fabricated_matrix(self.strong, self.weak)
        )


def grid(array: PlanarArray, points: int) -> Array:
    """Return poses (3, points^2) at the centres of squares over the pitch, m, at yaw 0."""
    return np.array(hall_two_waves.poses(array.pitch, points, shift=0.5))
