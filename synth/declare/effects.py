"""Effects that the model of a plant lacks, as data: what acts on the machine, its drives and its sensors beside it.

    Force          p v' += r F(t)                           on a position q with the rate v and the inertia p
    Cable          p v' -= r (k q + F)                      a spring with a preload
    Floor          v' += r a(t)                             white in a band, on each of some positions
    CurrentLoops   tau u' = c - u                           the inputs u of the plant lag behind the commands c
    Amplifiers     u = (1 + g s) c + b s'                   s and s' are -1 or 1, drawn for each input
    Mode           e'' + 2 zeta w e' + w^2 e = c v'         and sensors read q + e in place of q
    Readings       m = (1 + g) y + a sin(2 pi y / d) + n    of sensors, n white
    Changed        another plant, as the function of a share makes it

r rises from 0 to 1 within RAMP_S, or within RAMP_SHARE of a short run: the machine is switched on without the effect.
Inertias are those of the stage's fault campaign. Numbers are in the units of the signals that they act on. `scaled`
returns an effect s times as large.

Raises SignalError for a size that is not finite, and a negative one where its sign means nothing.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from synth.errors import SignalError
from synth.plant import Plant
from synth.statespace import Array

RAMP_S, RAMP_SHARE = 2.0, 0.2  # the share is the part of a step response before its step
Course = float | ArrayLike | Callable[[Array], ArrayLike]
"""A value over time: a constant, one for each sample, or a function of times in s."""


def _require(effect: object, needed: str, sound: bool, *sizes: float) -> None:
    """Raise SignalError for an effect with a size that is not finite, or that is not `sound`."""
    if not (sound and np.isfinite(sizes).all()):
        raise SignalError(f"{effect}: give {needed}")


@dataclass(frozen=True, eq=False)
class Force:
    """A force or torque on the position `of`, times `share`."""

    of: str
    course: Course
    share: float = 1.0

    def scaled(self, s: float) -> "Force":
        """Return s times the force."""
        return replace(self, share=s * self.share)


@dataclass(frozen=True)
class Cable:
    """A cable or hose that pulls the position `of` to -`preload` / `stiffness`."""

    of: str
    stiffness: float
    preload: float = 0.0

    def __post_init__(self) -> None:
        _require(self, "a finite stiffness and preload", True, self.stiffness, self.preload)

    def scaled(self, s: float) -> "Cable":
        """Return s times the stiffness and the preload."""
        return replace(self, stiffness=s * self.stiffness, preload=s * self.preload)


@dataclass(frozen=True)
class Floor:
    """Acceleration of the floor under the positions `of`: standard deviation `rms`, white in a band."""

    of: Sequence[str]
    rms: float
    low_hz: float = 1.0
    high_hz: float = 50.0

    def __post_init__(self) -> None:
        _require(self, "a finite rms from 0 on", self.rms >= 0, self.rms)

    def scaled(self, s: float) -> "Floor":
        """Return s times the acceleration."""
        return replace(self, rms=s * self.rms)


@dataclass(frozen=True)
class CurrentLoops:
    """The lag of the first order of each input that an actuator drives, in s."""

    lag_s: float

    def __post_init__(self) -> None:
        _require(self, "a finite lag in s, from 0 on", self.lag_s >= 0, self.lag_s)

    def scaled(self, s: float) -> "CurrentLoops":
        """Return s times the lag."""
        return replace(self, lag_s=s * self.lag_s)


@dataclass(frozen=True)
class Amplifiers:
    """Errors of the amplifiers of all driven inputs: a share of the command, and an offset in the inputs' unit."""

    gain: float = 0.0
    offset: float = 0.0

    def __post_init__(self) -> None:
        _require(self, "a finite gain and offset", True, self.gain, self.offset)

    def scaled(self, s: float) -> "Amplifiers":
        """Return s times both errors."""
        return replace(self, gain=s * self.gain, offset=s * self.offset)


@dataclass(frozen=True)
class Mode:
    """A flexible mode that sensors of the position `of` see: `participation` is c, below 0 in phase opposition."""

    of: str
    frequency_hz: float
    damping: float
    participation: float

    def __post_init__(self) -> None:
        sizes, sound = (
            (self.frequency_hz, self.damping, self.participation),
            self.frequency_hz > 0 and self.damping >= 0,
        )
        _require(self, "finite numbers, the frequency above 0 and the damping ratio from 0 on", sound, *sizes)

    def scaled(self, s: float) -> "Mode":
        """Return s times the participation."""
        return replace(self, participation=s * self.participation)


@dataclass(frozen=True)
class Readings:
    """Errors of the sensors `of`, by default all: a gain error g, a ripple a of the pitch d, and noise."""

    of: Sequence[str] = ()
    gain_error: float = 0.0
    noise: float = 0.0
    ripple: float = 0.0
    pitch: float = 1.0

    def __post_init__(self) -> None:
        sizes, sound = (self.gain_error, self.noise, self.ripple, self.pitch), self.noise >= 0 and self.pitch > 0
        _require(self, "finite numbers, the noise from 0 on and the pitch above 0", sound, *sizes)

    def scaled(self, s: float) -> "Readings":
        """Return s times the errors."""
        return replace(self, gain_error=s * self.gain_error, noise=s * self.noise, ripple=s * self.ripple)


@dataclass(frozen=True, eq=False)
class Changed:
    """The plant that `plant(of the machine, share)` returns, such as one with more harmonics in its field."""

    name: str
    plant: Callable[[Plant, float], Plant]
    share: float = 1.0

    def scaled(self, s: float) -> "Changed":
        """Return s times the share."""
        return replace(self, share=s * self.share)


Effect = Force | Cable | Floor | CurrentLoops | Amplifiers | Mode | Readings | Changed


def effect_text(effect: Effect) -> str:
    """Return the kind of an effect and what it acts on."""
    of = getattr(effect, "of", ())
    on = of if isinstance(of, str) else ", ".join(of)
    return f"{type(effect).__name__} on {on}" if on else type(effect).__name__
