"""True field of the experiments: a finite magnet matrix of blocks with manufacturing and placement tolerances.

Each block of `models.finite_matrix` has random errors with uniform distributions: a relative error of its remanence, a
tilt of its direction about a perpendicular axis, and a displacement d = (dx, dy, dz). The displacement multiplies the
block's contribution to the potential's coefficient by exp(-i k.d + kappa dz), expanded to second order:

    Phi_k = (1 - exp(-kappa Delta)) / (2 kappa) sum_j (J_z - i k.J / kappa)_j S_k exp(-i k.r_j)
            sum over a + b + c <= 2 of (-i kx dx_j)^a (-i ky dy_j)^b (kappa dz_j)^c / (a! b! c!)

Every sum is then a product of matrices. The truncation error is (|k| d)^3 / 6 of a harmonic: 4e-5 of the 5th at 0.1 mm.
`field` tabulates B_X, B_Y and their slopes along z on a grid, with splines of the fifth degree in between;
`tabulation_error` measures their error, 2.6e-6 T or 0.02 mV. The field is averaged over the sensors' volume as in
`models.hall_array`, at yaw 0.

The plant is `models.planar_stage` with the Hall voltages of this field, each behind its first-order anti-aliasing
filter (`models.hall_chain`). Its motors are in the nominal matrix; `models.finite_stage` covers their model errors.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import product
from math import factorial, isfinite, radians
from string import ascii_lowercase

import casadi as ca
import numpy as np
from scipy import interpolate

from models import finite_matrix, halbach, hall_array, hall_chain, planar_stage
from models.finite_matrix import Array, Blocks, Complex, Series
from models.hall_array import Pair
from models.hall_chain import Chain
from synth import numeric
from synth.base.cache import cached
from synth.errors import ModelError
from synth.plant import Plant, build
from synth.signals import Signal, signal_names
from synth.statespace import readonly

Exprs = Mapping[str, ca.SX]

HARMONICS = 32  # of a pitch
MAX_REACH = 0.07  # m, distance of a sensor from the origin
TABLE_MARGIN = 0.008  # m tabulated beyond, because splines are less accurate at their ends
EXPANSION_ORDER = 2  # of the expansion in a block's displacement
SPLINE_DEGREE = 5
CHANNELS = ("B_X", "B_Y", "B_X slope", "B_Y slope")  # T, T/m along z
MAX_SENSORS = 8
VOLUME = hall_array.HallArray(hall_array.sensors([(0.0, 0.0)]).sensors).volume


@dataclass(frozen=True)
class Tolerances:
    """Bounds of the blocks' errors: remanence, relative, tilt in rad, displacement in m; `seed` of the random numbers.

    Raises ModelError unless every bound is finite and not negative.
    """

    remanence: float = 0.02
    tilt: float = radians(1)
    displacement: float = 1e-4
    seed: int = 0

    def __post_init__(self) -> None:
        for name in ("remanence", "tilt", "displacement"):
            if not (isfinite(getattr(self, name)) and getattr(self, name) >= 0):
                raise ModelError(
                    f"the tolerance of {name} is {getattr(self, name)}: it must be finite and not negative"
                )


DEFAULT_TOLERANCES = Tolerances()


@dataclass(frozen=True)
class Mounting:
    """A sensor as mounted: relative gains of its axes, and the angle in rad by which it rotates the field it reads."""

    gains: Pair = (1.0, 1.0)
    angle: float = 0.0


@dataclass(frozen=True, eq=False)
class AsBuilt:
    """Blocks as built: remanences, nominal places, and the `displacements` (n, n, 3) of the blocks, m."""

    blocks: Blocks
    displacements: Array


@dataclass(frozen=True, eq=False)
class Field:
    """CHANNELS (4,) as a function of X, Y in m up to MAX_REACH from the origin, at a `height` in m above the matrix."""

    at: ca.Function
    height: float


def draw_blocks(tolerances: Tolerances = DEFAULT_TOLERANCES) -> AsBuilt:
    """Return the blocks of two grades with random errors within tolerances."""
    nominal = finite_matrix.fabricated_blocks()
    n, rng = len(nominal.places), np.random.default_rng(tolerances.seed)
    remanence_factor = 1 + tolerances.remanence * rng.uniform(-1, 1, (n, n, 1))
    normal = np.cross(nominal.remanence, rng.standard_normal((n, n, 3)))
    length = np.linalg.norm(normal, axis=2, keepdims=True)
    axis = normal / np.where(length > 0, length, 1.0)  # across the magnetisation; places without a block have none
    tilt = tolerances.tilt * rng.uniform(-1, 1, (n, n, 1))
    tilted = np.cos(tilt) * nominal.remanence + np.sin(tilt) * np.cross(axis, nominal.remanence)
    displacements = tolerances.displacement * rng.uniform(-1, 1, (n, n, 3))
    return AsBuilt(replace(nominal, remanence=readonly(remanence_factor * tilted)), readonly(displacements))


def series(built: AsBuilt, harmonics: int = HARMONICS) -> Series:
    """Return the Fourier series of the potential above the blocks, averaged over the sensors' volume."""
    nominal_series = finite_matrix.series(built.blocks, harmonics)
    kx, ky, kappa = nominal_series.kx, nominal_series.ky, nominal_series.kappa
    total = np.zeros_like(nominal_series.potential)
    for a, b, c in product(range(EXPANSION_ORDER + 1), repeat=3):
        if a + b + c <= EXPANSION_ORDER:
            weight = (
                built.displacements[:, :, 0] ** a
                * built.displacements[:, :, 1] ** b
                * built.displacements[:, :, 2] ** c
            )
            weighted = replace(built.blocks, remanence=built.blocks.remanence * weight[:, :, None])
            shift = (-1j * kx) ** a * (-1j * ky) ** b * kappa**c / (factorial(a) * factorial(b) * factorial(c))
            total += shift * finite_matrix.series(weighted, harmonics).potential
    return replace(nominal_series, potential=total * _averaging_factors(nominal_series))


def _averaging_factors(waves: Series) -> Array:
    """Return the factors of the waves by the mean over a sensor's volume, with its sides along X, Y and Z."""
    x, y, z = (side / 2 for side in VOLUME)
    z_phase = waves.kappa * z
    mean = np.sinc(waves.kx * x / np.pi) * np.sinc(waves.ky * y / np.pi) * np.sinh(z_phase)
    return np.asarray(mean / np.where(z_phase > 0, z_phase, 1.0))


def tabulate(waves: Series, height: float = hall_array.HEIGHT, reach: float = MAX_REACH) -> Array:
    """Return CHANNELS (4, n, n) on the grid of the series, X changing slowest."""
    both: list[Complex] = [c for order in (0, 1) for c in finite_matrix.flux_density(waves, height, order)[:2]]
    return readonly(np.array([waves.evaluate(c, reach) for c in both]))


@cache
@cached
def field(tolerances: Tolerances = DEFAULT_TOLERANCES, height: float = hall_array.HEIGHT) -> Field:
    """Return the field of blocks with tolerances, at a height in m above them."""
    potential = series(draw_blocks(tolerances))
    points, values = potential.grid(MAX_REACH + TABLE_MARGIN), tabulate(potential, height, MAX_REACH + TABLE_MARGIN)
    coefficients, knots = values.transpose(1, 2, 0), []
    for axis in (0, 1):
        spline = interpolate.make_interp_spline(points, coefficients, k=SPLINE_DEGREE, axis=axis)
        coefficients = np.moveaxis(spline.c, 0, axis)
        knots.append(spline.t.tolist())
    X, Y = ca.MX.sym("X"), ca.MX.sym("Y")
    flat = coefficients.transpose(1, 0, 2).ravel()  # in CasADi the last coordinate changes slowest
    at = ca.bspline(ca.vertcat(X, Y), ca.DM(flat), knots, [SPLINE_DEGREE, SPLINE_DEGREE], len(CHANNELS), {})
    return Field(ca.Function("truth_field", [X, Y], [at], {"never_inline": True}), height)


def flux(field: Field, X: ca.SX, Y: ca.SX, lift: ca.SX) -> halbach.Field:
    """Return the flux density in T at X, Y and `lift` in m above the field's height; its component along Z is NaN."""
    bx, by, slope_x, slope_y = ca.vertsplit(field.at(X, Y))
    return halbach.Field(bx + lift * slope_x, by + lift * slope_y, ca.SX(np.nan))


def voltages(
    field: Field, places: Sequence[Pair], x: Exprs, gain: float, mountings: Sequence[Mounting] = ()
) -> dict[str, ca.SX]:
    """Return V_ax, V_ay, V_bx .. in V before the filter, of sensors at `places` in m, for a pose by name.

    Sensors are as designed, or mounted as in `mountings`. An angle e makes of the field in the body's axes
    [cos e, -sin e; sin e, cos e] times it.
    """
    volts: dict[str, ca.SX] = {}
    letters = ascii_lowercase[: len(places)]
    for letter, (u, v), mounting in zip(letters, places, mountings or [Mounting()] * len(places), strict=True):
        at = planar_stage.place(x, ca.SX(u), ca.SX(v))
        B = flux(field, at.X, at.Y, at.lift)
        yaw = x["phi"] - mounting.angle
        c, s = ca.cos(yaw), ca.sin(yaw)
        by_axis = c * B.x + s * B.y, c * B.y - s * B.x
        volts |= {f"V_{letter}{n}": gain * k * b for n, k, b in zip("xy", mounting.gains, by_axis, strict=True)}
    return volts


def plant(
    places: Sequence[Pair],
    field: Field,
    chain: Chain,
    gain: float | None = None,
    mountings: Sequence[Mounting] = (),
) -> Plant:
    """Return the planar stage with Hall sensors at `places` in m in the platen, over a field, behind a chain.

    The filters' voltages are states. The gain is the chain's, V/T, unless given. Sensors are as designed, or mounted as
    in `mountings`.

    Raises ModelError for fewer than three places, or more than MAX_SENSORS.
    """
    numeric.whole("the number of places", len(places), 3, MAX_SENSORS)
    s, scale = planar_stage, chain.gain if gain is None else gain
    hall = signal_names(s.hall_signals(len(places)))
    filtered = [Signal(f"filtered_{name}", "V", -10.0, 10.0, "behind its filter") for name in hall]

    def physics(x: Exprs, u: Exprs, p: Exprs) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        accelerations = s.accelerations(x, u, p, halbach.HARMONICS)
        derivative = {q: x[v] for q, v in s.RATE.items()} | {v: accelerations[q] for q, v in s.RATE.items()}
        hall_voltages = voltages(field, places, x, scale, mountings)
        derivative |= {
            f"filtered_{n}": hall_chain.slope(chain, x[f"filtered_{n}"], v) for n, v in hall_voltages.items()
        }
        measured = {name: x[f"filtered_{name}"] for name in hall} | s.laser_distances(x, p)
        return derivative, {q: x[q] for q in s.AXES} | measured

    return build("planar_stage_truth", (*s.STATES, *filtered), s.INPUTS, s.outputs(len(places)), s.PARAMETERS, physics)
