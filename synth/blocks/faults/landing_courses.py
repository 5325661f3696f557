"""Courses of the coordinates in a landing: descent to the stop, braking, levelling, release to a spring."""

from dataclasses import dataclass

from synth import arguments
from synth.block import Constant


@arguments.checked
@dataclass(frozen=True)
class Descent:
    """To the stop at `end`: speed, touch and press in m/s, acceleration in m/s^2, `beyond` in m, p in rad/s.

    `bound` in m bounds the set-point below 0. A body that has landed rests on its stop while it is farther than
    `rests_beyond`, in m.
    """

    coordinate: str
    end: float
    speed: float
    touch: float
    press: float
    acceleration: float
    beyond: float
    pole: float
    bound: float
    rests_beyond: float


@arguments.checked
@dataclass(frozen=True)
class Braking:
    """To rest within +-`bound`, with at most `acceleration`; the poles are at -`pole` rad/s."""

    coordinate: str
    acceleration: float
    pole: float
    bound: float


@arguments.checked
@dataclass(frozen=True)
class Levelling:
    """To zero, with the poles at -`pole` rad/s, or -`predicted_pole` without a measurement.

    A fast motion along predictions alone excites what the model does not know.
    """

    coordinate: str
    pole: float
    predicted_pole: float


@arguments.checked
@dataclass(frozen=True)
class Release:
    """To its guide spring: `spring` in 1/s^2, with a name for the C, is the part of it that the laws compensate."""

    coordinate: str
    spring: Constant


Course = Descent | Braking | Levelling | Release
