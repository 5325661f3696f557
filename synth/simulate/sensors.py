"""Sensors: what the controller reads when the plant's output is y.

    encoder:   m = r round(y / r), halves to even, so |m - y| <= r/2 for the resolution r;  m = y for r = 0
    override:  m_k = v_k at every sample k of the mask, whatever the sensor reads

Resolutions and values are in the unit of y.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth.errors import SignalError


@dataclass(frozen=True)
class Encoder:
    """An incremental encoder of `resolution`, in the unit of what it measures; 0 makes it ideal."""

    resolution: float = 0.0

    def __post_init__(self) -> None:
        if not (math.isfinite(self.resolution) and self.resolution >= 0):
            raise SignalError(f"encoder resolution is {self.resolution}: give a finite number, 0 for an ideal sensor")

    def read(self, y: ArrayLike) -> NDArray[np.float64]:
        """Return what the encoder shows at y, any shape, in the unit of y."""
        values = np.asarray(y, dtype=np.float64)
        return self.resolution * np.rint(values / self.resolution) if self.resolution else values


@dataclass(frozen=True, eq=False)
class Override:
    """Samples that replace what the controller would read: `values` (N,) where `mask` (N,) is true.

    Given in the controller's own scalar type, any bit pattern arrives as it is.
    """

    mask: NDArray[np.bool_]
    values: ArrayLike
