"""Field above a finite magnet matrix of fabricated or ideal blocks, by a Fourier series over a larger cell.

A block of side s = l/4 is the sum of one of each of two arrays, a(i) + b(j), with the cycle +z, -x, -z, +x along X and
+z, -y, -z, +y along Y. Where both are +z or both -z it is a strong block (2 m). Where one is +z and the other -z there
is no block. All others are weak (sqrt(2) m), tilted by 45 degrees or horizontal. There are 24 x 24 places, six pitches;
the origin is the centre of a strong block, with BEFORE places before it along X and along Y.

The matrix is one cell of a lattice of equal matrices, CELL pitches apart, with empty space between them. With J_k the
Fourier coefficients of the remanence over a cell and kappa = |k|, k = 2 pi (p, q) / (CELL l), above the matrix

    B = -grad Phi,   Phi = sum_k Phi_k exp(i k.r - kappa z),
    Phi_k = (1 - exp(-kappa Delta)) / (2 kappa) (J_z - i k.J / kappa)

of the charges on the blocks' faces. The other matrices of the lattice add less than 1e-4 T at motors and sensors.

Table 2 gives the remanence of an ideal array. The fabricated blocks have 1.43 and 1.10 T; an ideal weak block would
have 1.01 T. The papers do not print which strong block is the origin, and thus where the travel lies.

Source: Yu, Kim, "Design of Precision Positioner with Hall-effect Sensors", Table 2; Kawato, Kim, "A Novel Multi-DOF
Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors", section 2.
"""

from dataclasses import dataclass
from functools import cache
from math import pi, sqrt

import numpy as np
from numpy.typing import NDArray

from models import concentrated_field, lorentz_motor
from synth.statespace import readonly

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

VALUES = {p.name: p.value for p in lorentz_motor.PARAMETERS}
SIDE, HEIGHT = VALUES["l"] / 4, VALUES["Delta"]  # m
BLOCKS, BEFORE = 24, 11  # along each side, and before the origin: the Hall sensors are ahead of the platen's centre
STRONG, WEAK = concentrated_field.STRONG, concentrated_field.WEAK  # T
CYCLE = concentrated_field.CYCLE
CELL = 12  # pitches


@dataclass(frozen=True, eq=False)
class Blocks:
    """The remanence (n, n, 3) in T of blocks whose centres are at `places` (n,) in m along X and along Y."""

    places: Array
    remanence: Array


@dataclass(frozen=True, eq=False)
class Series:
    """Phi_k (N, N/2 + 1) in T m up to some `harmonics` of a pitch, with kx, ky >= 0 and kappa in rad/m, written 1/m.

    A pitch of its grid has twice as many points as harmonics, a cell N.
    """

    harmonics: int
    kx: Array
    ky: Array
    kappa: Array
    potential: Complex

    @property
    def spacing(self) -> float:
        """The distance of the grid's points in m."""
        return VALUES["l"] / (2 * self.harmonics)

    def grid(self, reach: float) -> Array:
        """Return the points (n,) of the grid, at least from -reach to reach in m, the same on both axes."""
        n = int(np.ceil(reach / self.spacing))
        return np.asarray(self.spacing * np.arange(-n, n + 1), dtype=np.float64)

    def evaluate(self, coefficients: Complex, reach: float) -> Array:
        """Return the real series with coefficients (N, N/2 + 1) on grid x grid (n, n)."""
        at = np.rint(self.grid(reach) / self.spacing).astype(int)
        return np.asarray(np.fft.irfft2(coefficients)[np.ix_(at, at)] * len(coefficients) ** 2)


def blocks(strong: float, weak: float) -> Blocks:
    """Return the matrix of strong and weak blocks with remanences in T."""
    cycle = CYCLE[(np.arange(BLOCKS) - BEFORE) % 4]
    first, second = concentrated_field.directions(cycle, cycle)
    places = SIDE * np.arange(-BEFORE, BLOCKS - BEFORE, dtype=np.float64)
    return Blocks(places, strong / 2 * first + weak / sqrt(2) * second)


def ideal_blocks() -> Blocks:
    """Return the matrix of two ideal arrays with the remanence of Table 2."""
    m = VALUES["mu0_M0"]
    return blocks(2 * m, sqrt(2) * m)


def fabricated_blocks() -> Blocks:
    """Return the matrix of the fabricated blocks."""
    return blocks(STRONG, WEAK)


def series(matrix: Blocks, harmonics: int) -> Series:
    """Return the Fourier series of the potential above a matrix."""
    length, n = CELL * VALUES["l"], 2 * CELL * harmonics
    counts = np.arange(n, dtype=np.float64)
    kx = 2 * pi / length * np.where(counts < n / 2, counts, counts - n)
    ky = 2 * pi / length * counts[: n // 2 + 1]
    along_x, along_y = _transform(matrix.places, kx) / length, _transform(matrix.places, ky) / length
    J = [along_x @ matrix.remanence[:, :, axis] @ along_y.T for axis in range(3)]
    KX, KY = (np.ascontiguousarray(k) for k in np.broadcast_arrays(kx[:, None], ky[None, :]))
    kappa = np.hypot(KX, KY)
    kappa[0, 0] = 1.0  # of the mean, which has no field
    potential = -np.expm1(-kappa * HEIGHT) / (2 * kappa) * (J[2] - 1j * (KX * J[0] + KY * J[1]) / kappa)
    for edge in ((0, 0), (n // 2, slice(None)), (slice(None), n // 2)):
        potential[edge] = 0.0
    return Series(harmonics, KX, KY, kappa, potential)


def _transform(places: Array, k: Array) -> Complex:
    """Return the Fourier integrals (len(k), n) of blocks of side SIDE, m."""
    shape = SIDE * np.sinc(k * SIDE / (2 * pi))
    return np.asarray(shape[:, None] * np.exp(-1j * np.outer(k, places)))


def flux_density(potential_series: Series, z: float, order: int = 0) -> tuple[Complex, Complex, Complex]:
    """Return the coefficients of B_X, B_Y, B_Z in T at z in m above the matrix; with `order` 1 of d/dz, T/m."""
    at = potential_series.potential * np.exp(-potential_series.kappa * z) * (-potential_series.kappa) ** order
    return -1j * potential_series.kx * at, -1j * potential_series.ky * at, potential_series.kappa * at


@dataclass(frozen=True, eq=False)
class Scan:
    """Voltages of B_X (n, n) over X and Y above a matrix of six pitches, about one pitch, V.

    Points are multiples of `spacing`, m; the body's origin is at 0 up to `count` of them. B_Y is the transpose.
    """

    spacing: float
    count: int
    first: int
    B_X: Array

    def at(self, i: NDArray[np.int_], j: NDArray[np.int_]) -> Array:
        """Return B_X and B_Y (2, ..) at the points i along X and j along Y."""
        return np.array([self.B_X[i + self.first, j + self.first], self.B_X[j + self.first, i + self.first]])


@cache
def scan(strong: float, weak: float, height: float, gain: float, count: int) -> Scan:
    """Return the voltages, with a gain in V/T, in the pitch ahead of the centre, above blocks with remanences in T.

    `height` is in m above them; `count` is the number of points along a pitch.
    """
    reach = 1.5 * VALUES["l"]
    potential = series(blocks(strong, weak), count // 2)
    flux = potential.evaluate(flux_density(potential, height)[0], reach)
    return Scan(potential.spacing, count, len(potential.grid(reach)) // 2, readonly(gain * flux))
