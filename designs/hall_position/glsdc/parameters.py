"""What the estimator is made for: two-axis sensors over a field of one pitch, and how it goes about its task.

    B_X(X) = c + alpha sin(w X) + beta sin(5 w X),   B_Y likewise in Y,   w = 2 pi / pitch        in volts: (2) times s

Source: Kawato, Kim, "Multi-Degree-of-Freedom Precision Position Sensing", (2), without gamma and delta.
"""

from dataclasses import dataclass
from math import hypot, inf, pi, radians, sqrt

from synth import numeric
from synth.errors import ModelError
from synth.numeric import between

Pair = tuple[float, float]


@dataclass(frozen=True)
class Array:
    """Sensors at `positions` in the body, m, and the field that they see, V; each axis is noisy by `deviation`, V.

    A sensor of a weight, 1 unless given, has the deviation `deviation` / sqrt(weight). Lists and arrays are taken, too.

    Raises ModelError for fewer than two places or more than 26 sensors, unlike numbers of weights, or a figure that is
    no number or out of its range.
    """

    positions: tuple[Pair, ...]
    c: float
    alpha: float
    beta: float
    pitch: float = 0.0508
    deviation: float = 1e-3
    weights: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "positions", numeric.places(self.positions, 2))
        object.__setattr__(self, "weights", numeric.numbers("weights", self.weights))
        if len(set(self.positions)) < 2:
            raise ModelError(f"sensors are at {self.positions}: the yaw takes two places, give another one")
        if self.weights and len(self.weights) != len(self.positions):
            raise ModelError(f"{len(self.weights)} weights for {len(self.positions)} sensors: give one for each")
        if not all(w > 0 for w in self.weights):
            raise ModelError(
                f"weights are {self.weights}: they must be finite, and weights positive; leave a sensor out"
            )
        for name in ("alpha", "pitch", "deviation"):
            object.__setattr__(self, name, numeric.positive(name, getattr(self, name)))
        for name in ("c", "beta"):
            object.__setattr__(self, name, numeric.number(name, getattr(self, name)))

    @property
    def wave_number(self) -> float:
        """Return w, rad/m."""
        return 2 * pi / self.pitch

    @property
    def centre(self) -> Pair:
        """Return the mean of the positions, m: where the estimate is made, so that X, Y and yaw are least coupled."""
        n = len(self.positions)
        return sum(x for x, _ in self.positions) / n, sum(y for _, y in self.positions) / n

    @property
    def arms(self) -> tuple[Pair, ...]:
        """Return the positions from the centre, as phases, rad."""
        w, (x0, y0) = self.wave_number, self.centre
        return tuple((w * (x - x0), w * (y - y0)) for x, y in self.positions)

    @property
    def radius(self) -> float:
        """Return the root mean square of the arms, rad of phase by rad of yaw."""
        return sqrt(sum(hypot(*arm) ** 2 for arm in self.arms) / len(self.arms))

    @property
    def scales(self) -> tuple[float, ...]:
        """Return the root of each sensor's weight, which multiplies its voltages."""
        return tuple(map(sqrt, self.weights)) if self.weights else (1.0,) * len(self.positions)


@dataclass(frozen=True)
class Tuning:
    """How the estimator of (X, Y, yaw) works; the damping holds to the prediction what the voltages do not tell.

    It stands for motions that deviate from their prediction by array.deviation / (alpha sqrt(damping)). Nothing is
    valid after a yaw of more than `yaw`, and with two sensors of more than half of `turn`.

    Raises ModelError for a figure that is out of its range.
    """

    iterations: int = between(1, 5, 20)  # a sample
    scale: float = between(0, 1.0, 1)  # of each correction
    damping: float = between(0, 1e-3, 1)  # of alpha^2, of phases from the prediction
    firm: float = between(0, 5.0, 100)  # times as much the yaw is damped, by what it moves the sensors
    reach: float = between(0, 1.0, 1)  # rad of phase by which a sample may move a sensor, half of it by the yaw
    follow: float = 0.5  # part of a correction by which the next motion is predicted to differ; 0: none is predicted
    settled: float = between(0, 0.1, 1)  # standard deviations: a smaller correction has converged
    leaning: float = between(0, 0.15, 3)  # parameters that the damping may decide; else `damped`
    surprise: float = between(0, 3.0, inf)  # deviations of motions: more is no motion of a body
    residual: float = between(0, 0.1, inf)  # V rms up to which residuals are those of the field's model
    pitches: int = between(1, 8, 1000)  # to either side up to which positions are counted
    certain: float = between(0, 0.004, 3)  # parameters that it may decide at a certain place of two sensors
    turn: float = between(0, radians(5), pi)  # rad from the last certain yaw: there two sensors tell places apart
    yaw: float = between(0, radians(10), pi)  # rad up to which a place is valid

    def __post_init__(self) -> None:
        numeric.check_fields(self)
        if not 0 <= numeric.number("follow", self.follow) <= 1:
            raise ModelError(f"follow is {self.follow}: it must be at least 0 and at most 1")
