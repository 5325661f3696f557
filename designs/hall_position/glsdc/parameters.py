"""What the estimator is made for: two-axis sensors over a field of one pitch, and how it goes about its task.

    B_X(X) = c + alpha sin(w X) + beta sin(5 w X),   B_Y likewise in Y,   w = 2 pi / pitch        in volts: (2) times s

Source: Kawato, Kim, "Multi-Degree-of-Freedom Precision Position Sensing", (2), without gamma and delta.
"""

from dataclasses import dataclass
from math import hypot, inf, pi, radians, sqrt

from synth import numeric
from synth.errors import ModelError

Pair = tuple[float, float]
WHOLE = ("iterations", "pitches")  # of a tuning
RANGES = {  # of the other numbers, above the first and at most the second
    **dict.fromkeys(("scale", "damping", "reach", "settled"), (0, 1)),
    **dict.fromkeys(("surprise", "residual"), (0, inf)),
    **dict.fromkeys(("leaning", "certain"), (0, 3)),
    **dict.fromkeys(("turn", "yaw"), (0, pi)),
    "iterations": (1, 20),
    "firm": (0, 100),
    "pitches": (1, 1000),
}


@dataclass(frozen=True)
class Array:
    """Sensors at `positions` in the body, m, and the field that they see, V; each axis is noisy by `deviation`, V.

    `weights` are those of the sensors, 1 for each unless given; a sensor's deviation is `deviation` / sqrt(weight).
    Both may be given as lists or arrays.

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
    """How the estimator goes about its task.

    `iterations` a sample; `scale` of each correction; `damping`, of alpha^2, of phases towards the expected ones; the
    yaw, by what it moves the sensors on an average, `firm` times as firmly as they; `reach`, rad of phase by which
    corrections may move a sensor in a sample, half of it by the yaw; `follow`, the part of a sample's correction by
    which the next motion is expected to differ: with 0 none is expected. A correction of less than `settled` standard
    deviations ends the search, and of more than `leaning` parameters that the damping decides instead of the voltages
    there is `damped`, the yaw no more firmly than the phases. To the damping belongs a deviation of motions from the
    expected one, array.deviation / (alpha sqrt(damping)); by more than `surprise` times that a body does not move in
    a sample. Residuals up to `residual` V rms are those of the field's model. Positions are counted to `pitches` on
    either side.

    A place is certain once the damping decides no more than `certain` parameters there, of two sensors, which elsewhere
    may read the same at another place, and four times as many of more than two. With two sensors, or after a search,
    its yaw is within `turn`, rad, of that at the last certain place, 0 at first. Nothing is valid at a yaw of more than
    `yaw`, rad, with two sensors than half of `turn` besides, nor after it.

    Raises ModelError for a figure that is out of its range.
    """

    iterations: int = 5
    scale: float = 1.0
    damping: float = 1e-3
    firm: float = 5.0
    reach: float = 1.0
    follow: float = 0.5
    settled: float = 0.1
    leaning: float = 0.15
    surprise: float = 3.0
    residual: float = 0.1
    pitches: int = 8
    certain: float = 0.004
    turn: float = radians(5)
    yaw: float = radians(10)

    def __post_init__(self) -> None:
        numeric.check_fields(self, RANGES, WHOLE)
        if not 0 <= numeric.number("follow", self.follow) <= 1:
            raise ModelError(f"follow is {self.follow}: it must be at least 0 and at most 1")
