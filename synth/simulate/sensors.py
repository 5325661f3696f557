"""Sensor models: the reading m of the controller for the plant output y.

    seen      s = (1 + gain_error) y + offset + noise          of every sensor
    Encoder   m = r round(s / r), halves to even, so |m - s| <= r/2 for the resolution r;  m = s for r = 0
    Analogue  as an encoder with r = (high - low) / 2^bits, limited to low .. high
    word      the count of a reading with some bits set or inverted, see `Word`
    override  m_k = v_k at every sample k of the mask, independent of y

Offsets, resolutions, noise and values are in the unit of y; a gain error is a fraction.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth.errors import SignalError

Chain = tuple[float, float, float, float, float]  # gain, offset, resolution, low, high


@dataclass(frozen=True)
class Encoder:
    """An incremental encoder of `resolution`, in the unit of the measured quantity; 0 makes it ideal."""

    resolution: float = 0.0
    offset: float = 0.0
    gain_error: float = 0.0

    def __post_init__(self) -> None:
        if not (math.isfinite(self.resolution) and self.resolution >= 0):
            raise SignalError(f"encoder resolution is {self.resolution}: give a finite number, 0 for an ideal sensor")
        _check_errors("encoder", self.offset, self.gain_error)

    @property
    def chain(self) -> Chain:
        """Gain, offset, resolution and limits."""
        return 1 + self.gain_error, self.offset, self.resolution, -math.inf, math.inf

    def read(self, y: ArrayLike) -> NDArray[np.float64]:
        """Return the reading of the encoder at y, any shape, in the unit of y."""
        return _read(self.chain, y)

    def noise_of(self, n: int, stream: int) -> NDArray[np.float64]:
        """Return no noise, (n,)."""
        return np.zeros(n)


@dataclass(frozen=True)
class Analogue:
    """An analogue sensor with a converter of `bits` that saturates at low and high, in the unit of y.

    `noise` is the rms of white Gaussian noise, repeatable for the same `seed`; each sensor of a loop has a stream.
    """

    low: float
    high: float
    bits: int = 16
    noise: float = 0.0
    offset: float = 0.0
    gain_error: float = 0.0
    seed: int = 0

    def __post_init__(self) -> None:
        if not (math.isfinite(self.high - self.low) and self.low < self.high):
            raise SignalError(f"analogue sensor spans {self.low} .. {self.high}: give finite ends, low below high")
        if not (isinstance(self.seed, int | np.integer) and self.seed >= 0):
            raise SignalError(f"analogue sensor has the seed {self.seed}: give a whole number from 0 on")
        if not (1 <= self.bits <= 53 and self.bits == int(self.bits)):
            raise SignalError(f"analogue sensor has {self.bits} bits: give a whole number from 1 to 53")
        if not (math.isfinite(self.noise) and self.noise >= 0):
            raise SignalError(f"analogue sensor has the noise {self.noise} rms: give a finite number, 0 for none")
        _check_errors("analogue sensor", self.offset, self.gain_error)

    @property
    def resolution(self) -> float:
        """One count, in the unit of y."""
        return (self.high - self.low) / 2**self.bits

    @property
    def chain(self) -> Chain:
        """Gain, offset, resolution and limits."""
        return 1 + self.gain_error, self.offset, self.resolution, self.low, self.high

    def read(self, y: ArrayLike) -> NDArray[np.float64]:
        """Return the reading of the converter at y without noise, any shape, in the unit of y."""
        return _read(self.chain, y)

    def noise_of(self, n: int, stream: int) -> NDArray[np.float64]:
        """Return n samples of noise of the sensor with number `stream`, (n,), in the unit of y."""
        return self.noise * np.random.default_rng([self.seed, stream]).standard_normal(n)


Sensor = Encoder | Analogue


def _check_errors(what: str, offset: float, gain_error: float) -> None:
    if not (math.isfinite(offset) and math.isfinite(gain_error)):
        raise SignalError(f"{what} has the offset {offset} and the gain error {gain_error}: give finite numbers")


def _read(chain: Chain, y: ArrayLike) -> NDArray[np.float64]:
    gain, offset, resolution, low, high = chain
    seen = gain * np.asarray(y, dtype=np.float64) + offset
    return np.clip(resolution * np.rint(seen / resolution) if resolution else seen, low, high)


@dataclass(frozen=True, eq=False)
class Override:
    """Samples that replace the sensor reading: `values` (N,) where `mask` (N,) is true.

    Values in the scalar type of the controller keep their bit pattern.
    """

    mask: NDArray[np.bool_]
    values: ArrayLike


@dataclass(frozen=True, eq=False)
class Word:
    """A faulty word of a sensor: of its count w = round((m - low) / step) some bits are inverted, then some fixed.

    `low` and `step` are in the unit of the reading m; `flipped`, `set_bits` and `cleared` (N,) are masks of bits.
    """

    low: float
    step: float
    flipped: ArrayLike = 0
    set_bits: ArrayLike = 0
    cleared: ArrayLike = 0
