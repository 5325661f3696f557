"""What the estimator of all six degrees of freedom is made for: two-axis sensors anywhere in a body, over one matrix.

    Phi = sum over n = 1, 5 of a_n / (n w) exp(-n w (Z - height)) (cos(n w X) + cos(n w Y)),    a_1 = alpha, a_5 = beta
    B = -grad Phi,   w = 2 pi / pitch,   in volts: times the sensors' sensitivity

so that B_X = alpha sin(w X) + beta sin(5 w X) at the height, as (2) has it without c, gamma and delta: offsets of the
sensors are to be taken off before.

Source: Kawato, Kim, "Multi-Degree-of-Freedom Precision Position Sensing", (2), section 3.A, Fig. 6 (b).
"""

from dataclasses import dataclass
from math import inf, pi, sqrt

from synth import numeric
from synth.errors import ModelError
from synth.numeric import between

Triple = tuple[float, float, float]
FEWEST = 3  # sensors of two axes for six unknowns


@dataclass(frozen=True)
class Array:
    """Sensors at `positions` in the body, m, and the field that they see at a `height` in m above the matrix, V.

    Their axes are along the body's x and y; each is noisy by `deviation`, V. Positions may be lists or an array.

    Raises ModelError for fewer than three places or more than 26 sensors, for places that are all above one another,
    or a figure that is no number or out of its range.
    """

    positions: tuple[Triple, ...]
    alpha: float
    beta: float
    height: float = 3e-3
    pitch: float = 0.0508
    deviation: float = 1e-3

    def __post_init__(self) -> None:
        object.__setattr__(self, "positions", numeric.places(self.positions, 3))
        if len(set(self.positions)) < FEWEST:
            raise ModelError(
                f"{len(set(self.positions))} sensors have fewer than six voltages: give {FEWEST} places or more"
            )
        if len({r[:2] for r in self.positions}) < 2:
            raise ModelError(
                f"all sensors are at x, y = {self.positions[0][:2]} m, above one another: their voltages differ by the "
                "decay with Z alone, which hardly tells turns from displacements; give places apart in x and y"
            )
        for name in ("alpha", "height", "pitch", "deviation"):
            object.__setattr__(self, name, numeric.positive(name, getattr(self, name)))
        object.__setattr__(self, "beta", numeric.number("beta", self.beta))

    @property
    def wave_number(self) -> float:
        """Return w, rad/m."""
        return 2 * pi / self.pitch

    @property
    def arms(self) -> tuple[Triple, ...]:
        """Return the positions as phases, rad."""
        w = self.wave_number
        return tuple((w * x, w * y, w * z) for x, y, z in self.positions)

    @property
    def radius(self) -> float:
        """Return the root mean square of the arms in the body's plane, rad of phase by rad of turn."""
        return sqrt(sum(x * x + y * y for x, y, _ in self.arms) / len(self.arms))


@dataclass(frozen=True)
class Tuning:
    """How the estimator of six degrees of freedom works, in the words of `parameters.Tuning`.

    Above the fabricated matrix, other waves leave up to 0.093 V of four sensors' voltages: allow more than `residual`.

    Raises ModelError for a figure that is out of its range.
    """

    corrections: int = between(1, 4, 20)  # a sample, all by the Jacobian where it begins
    damping: float = between(0, 1e-4, 1)  # of alpha^2
    reach: float = between(0, 0.5, 1)  # rad of phase
    follow: float = between(0, 0.5, 1)  # part of a correction
    settled: float = between(0, 0.1, 1)  # standard deviations
    leaning: float = between(0, 0.15, 6)  # parameters
    surprise: float = between(0, 3.0, inf)  # deviations of motions
    residual: float = between(0, 0.02, inf)  # V rms
    gap: float = between(0, 1e-3, 0.002)  # m from the height within which Z is valid
    tilt: float = between(0, 0.02, 0.05)  # rad within which roll and pitch are valid
    pitches: int = between(1, 8, 1000)

    def __post_init__(self) -> None:
        numeric.check_fields(self)
