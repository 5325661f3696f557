"""Forces and torques of one planar motor over a finite magnet matrix, per unit current in each phase.

    x ^   half A  -B   C  -A  ..   C  half A      g(x)      Bands as in `models.lorentz_motor`, cut by a window of Nm
      |   +---+---+---+---+-- .. -+---+---+   _             pitches about the motor's centre, where a band A lies: at
      |   |   |   |   |   |       |   |   |    |            the window's ends there is half a band. A current is the
      |   |   |   |   |   |       |   |   |    | w          curl of -t(y) g(x) z: t is 0 outside the window and changes
      |   |   |   |   |   |       |   |   |   _|            where a band runs along x; g is 1 over the conductors.
      +-> y  --- end turns, from band to band --

End turns in the plane of the bands are as wide and high as the bands. g falls to 0 across them, and a turn has the mean
width w. Three phases cannot all have their end turns there. Raised by d, end turns contribute about exp(-2 pi d / l) of
that, which is RAISED_END_TURNS for the least possible d, the height of the winding. Without end turns g is 1 over w and
0 beyond, and no current runs along y. The paper prints neither the end turns nor which band lies in the middle.

In a field of exponentials exp(i k.r - kappa z) (`models.finite_matrix`) about the centre's place R the integrals of
j x B and of r x (j x B) over the conductors are products of moments int x^a g exp(i kx x) dx, int y^b t exp(i ky y) dy
and of integrals over the height: forces and torques over R are Fourier series with known coefficients. Torques are
about the middle of the window, half way up. In the frame of a motor turned by phi, k turns by -phi: "yaw" is the
derivative by phi at phi = 0, in the frame of the motor.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import exp, pi, sqrt
from typing import Literal

import numpy as np

from models import lorentz_motor
from models.finite_matrix import VALUES, Array, Complex, Series

Order = Literal["value", "lift", "yaw"]
Moment = Callable[[int, int], Complex]
Force = tuple[Complex, Complex, Complex]

PHASES = tuple(lorentz_motor.PHASE_OFFSETS)
COMPONENTS = ("f_x", "f_y", "f_z", "m_x", "m_y", "m_z")  # N/A and N m/A, y along the motion
ORDERS: tuple[Order, ...] = ("value", "lift", "yaw")
BAND = VALUES["l"] / 6  # m, the width of a band
THICKNESS = 6 * VALUES["area"] / VALUES["l"]  # m
DENSITY = VALUES["turns"] / VALUES["area"]  # 1/m^2
GAP, DECAY = VALUES["z0"], 2 * pi / VALUES["l"]  # m, 1/m
RAISED_END_TURNS = exp(-DECAY * THICKNESS)
NODES = 24  # Gauss-Legendre nodes in a cell: exact to rounding for every harmonic of the series


@dataclass(frozen=True)
class Cell:
    """An interval from low to high, m, over which a function is linear from `start` to `end`."""

    low: float
    high: float
    start: float
    end: float


@dataclass(frozen=True, eq=False)
class _Moments:
    """Moments (4, n) of a function of one coordinate and of its slope: int y^b t exp(i k y) dy for b = 0 .. 3."""

    value: Complex
    slope: Complex


def winding_profile(phase: str) -> tuple[Cell, ...]:
    """Return t(y) in m of a phase, from one end of the window to the other."""
    l, half, bands = VALUES["l"], VALUES["Nm"] * VALUES["l"] / 2, []
    for n in range(-round(VALUES["Nm"]) - 1, round(VALUES["Nm"]) + 2):
        forward = n + lorentz_motor.PHASE_OFFSETS[phase]
        for sign, pitches in ((-1, forward), (1, forward + 0.5)):
            low, high = max(pitches * l - BAND / 2, -half), min(pitches * l + BAND / 2, half)
            if high - low > 1e-9 * l:
                bands.append((low, high, sign))
    cells, height, last = [], 0.0, -half
    for low, high, sign in sorted(bands):
        risen = height + sign * (high - low)
        cells += [Cell(last, low, height, height), Cell(low, high, height, risen)]
        height, last = risen, high
    return tuple(c for c in cells if c.high > c.low)


def width_profile(flat: bool) -> tuple[Cell, ...]:
    """Return g(x), with end turns in the bands' plane or without."""
    half, end = VALUES["w"] / 2, BAND / 2
    if not flat:
        return (Cell(-half, half, 1.0, 1.0),)
    inner, outer = half - end, half + end
    return Cell(-outer, -inner, 0.0, 1.0), Cell(-inner, inner, 1.0, 1.0), Cell(inner, outer, 1.0, 0.0)


def maps(series: Series, phase: str, order: Order, half_width: float, end_turns: float = RAISED_END_TURNS) -> Array:
    """Return the COMPONENTS (6, n, n) in N/A and N m/A for centres on the grid up to `reach` in m, x first.

    With `order` "lift" it is the derivative by a lift d in m of the value times exp(2 pi d / l). `end_turns` is the
    weight of the end turns, 1 in the plane of the bands.
    """
    scale, parts = _potential_at_gap(series, order), ((True, end_turns), (False, 1 - end_turns))
    wrenches = [[weight * c for c in _wrench(series, phase, order, flat)] for flat, weight in parts if weight]
    return np.array([series.evaluate(scale * np.sum(c, axis=0), half_width) for c in zip(*wrenches, strict=True)])


def commutated_wrenches(values: Array, y: Array) -> Array:
    """Return wrenches (2, 6, n, n) per A of i_Q and of i_D from those (3, 6, n, n) per A of PHASES at y (n,) in m."""
    c, s = np.cos(DECAY * y), np.sin(DECAY * y)

    def driven(alpha: Array, beta: Array) -> Array:
        half = sqrt(3) / 2 * beta
        phases = (alpha, half - alpha / 2, -half - alpha / 2)
        return np.asarray(sum(i * w for i, w in zip(phases, values, strict=True)))

    return np.array([driven(c, s), driven(-s, c)])


def _potential_at_gap(series: Series, order: Order) -> Complex:
    """Return the potential at the gap, times the density of turns."""
    value = DENSITY * series.potential * np.exp(-series.kappa * GAP)
    return value * (DECAY - series.kappa) if order == "lift" else value


def _wrench(series: Series, phase: str, order: Order, flat: bool) -> tuple[Complex, ...]:
    """Return the coefficients of the COMPONENTS for a potential of 1."""
    force = _yaw_derivative(series, phase, flat) if order == "yaw" else _force(series, phase, flat)
    level, tilted = _height_integrals(series.kappa)
    f, f_x, f_y = force(0, 0), force(1, 0), force(0, 1)
    return (
        *(each * level for each in f),
        f_y[2] * level - f[1] * tilted,
        f[0] * tilted - f_x[2] * level,
        (f_x[1] - f_y[0]) * level,
    )


def _force(series: Series, phase: str, flat: bool) -> Callable[[int, int], Force]:
    """Return the moments x^a y^b of the force's density j x B, by (a, b)."""
    along_x, along_y = _currents(series, phase, flat)
    kx, ky, kappa = series.kx, series.ky, series.kappa

    def force(a: int, b: int) -> Force:
        j_x, j_y = along_x(a, b), along_y(a, b)
        return kappa * j_y, -kappa * j_x, -1j * (ky * j_x - kx * j_y)

    return force


def _yaw_derivative(series: Series, phase: str, flat: bool) -> Callable[[int, int], Force]:
    """Return the derivative of `_force` by the yaw: k = (kx, ky) changes by (ky, -kx)."""
    along_x, along_y = _currents(series, phase, flat)
    force, kx, ky = _force(series, phase, flat), series.kx, series.ky

    def derivative(a: int, b: int) -> Force:
        f_x, f_y, f_z = (1j * (ky * p - kx * q) for p, q in zip(force(a + 1, b), force(a, b + 1), strict=True))
        return f_x, f_y, f_z + 1j * (kx * along_x(a, b) + ky * along_y(a, b))

    return derivative


@lru_cache(maxsize=2 * len(PHASES))
def _currents(series: Series, phase: str, flat: bool) -> tuple[Moment, Moment]:
    """Return the moments of the current's density along x, t' g, and along y, -t g', by (a, b)."""
    x, y = _moments(width_profile(flat), series.kx[:, 0]), _moments(winding_profile(phase), series.ky[0])

    def along_x(a: int, b: int) -> Complex:
        return np.asarray(x.value[a][:, None] * y.slope[b])

    def along_y(a: int, b: int) -> Complex:
        return np.asarray(-x.slope[a][:, None] * y.value[b])

    return along_x, along_y


def _moments(cells: Sequence[Cell], k: Array) -> _Moments:
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    low, width = (np.array(v)[:, None] for v in zip(*((c.low, c.high - c.low) for c in cells), strict=True))
    start, rise = (np.array(v)[:, None] for v in zip(*((c.start, c.end - c.start) for c in cells), strict=True))
    fraction = (nodes + 1) / 2
    points = low + width * fraction
    weighted = np.array([width / 2 * weights * points**b for b in range(4)])
    functions = np.concatenate([weighted * (start + rise * fraction), weighted * rise / width])
    moments = functions.reshape(8, -1) @ np.exp(1j * np.outer(points, k))
    return _Moments(moments[:4], moments[4:])


def _height_integrals(kappa: Array) -> tuple[Array, Array]:
    """Return int exp(-kappa z) dz over the winding's height and int (z - THICKNESS / 2) exp(-kappa z) dz."""
    x = kappa * THICKNESS
    level = -np.expm1(-x) / kappa
    first = (1 - np.exp(-x) * (1 + x)) / kappa**2
    return level, first - THICKNESS / 2 * level
