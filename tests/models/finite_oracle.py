"""The Lorentz integral over the conductors of a motor in the field of blocks, by quadrature: forces without any series.

Bands are written out in sixths of a pitch; currents run along x in them and, in flat end turns, along y between them.
Blocks are magpylib's. Nothing here is shared with `models.finite_*` but the parameters' values and what blocks there
are.
"""

from dataclasses import dataclass

import magpylib
import numpy as np

from models import finite_matrix, lorentz_motor

V = {p.name: p.value for p in lorentz_motor.PARAMETERS}
l, Gamma = V["l"], 6 * V["area"] / V["l"]
SIXTHS = ("A", "-B", "C", "-A", "B", "-C")  # bands at 0, l/6, .. and so on periodically
FIRST, LAST = -6, 6  # sixths: a window of two pitches


@dataclass(frozen=True, eq=False)
class Conductors:
    """Points (k, 3) in m about the motor's centre, the current's density (3, k, 2) along x, y per A, volumes (k,)."""

    at: np.ndarray
    j: np.ndarray
    volume: np.ndarray


def single(matrix: finite_matrix.Blocks) -> magpylib.Collection:
    """Return a matrix block by block."""
    magnets, s = magpylib.Collection(), l / 4
    for x, row in zip(matrix.places, matrix.remanence, strict=True):
        for y, J in zip(matrix.places, row, strict=True):
            if J.any():
                magnets.add(magpylib.magnet.Cuboid(polarization=J, dimension=(s, s, s), position=(x, y, -s / 2)))
    return magnets


def bars(m: float) -> magpylib.Collection:
    """Return two ideal arrays of 24 bars each, from -11.5 to 12.5 widths of a bar, one through the other."""
    magnets, s, middle = magpylib.Collection(), l / 4, l / 8
    for i in range(-11, 13):
        along, up = [(0, 1), (-1, 0), (0, -1), (1, 0)][i % 4]
        for polarization, size, at in (
            ((along, 0, up), (s, 24 * s, s), (i * s, middle)),
            ((0, along, up), (24 * s, s, s), (middle, i * s)),
        ):
            magnets.add(
                magpylib.magnet.Cuboid(
                    polarization=m * np.array(polarization, float), dimension=size, position=(*at, -s / 2)
                )
            )
    return magnets


def conductors(flat: bool, along: int = 3, across: int = 20, up: int = 4) -> Conductors:
    """Return the three phases' conductors, with end turns in the bands' plane or without any."""
    y, dy, slope, height = _bands(along)
    x, dx, g, fall = _lengths(flat, across)
    z, dz = _gauss(0.0, Gamma, up)
    X, Y, Z = np.meshgrid(x, y, z - Gamma / 2, indexing="ij")
    shape = np.ones_like(Z)
    j = np.array(
        [
            [g[:, None, None] * s[:, None] * shape, -fall[:, None, None] * t[:, None] * shape]
            for s, t in zip(slope, height, strict=True)
        ]
    )
    volume = dx[:, None, None] * dy[:, None] * dz
    at = np.column_stack([q.ravel() for q in (X, Y, Z)])
    return Conductors(at, V["turns"] / V["area"] * j.reshape(3, 2, -1).transpose(0, 2, 1), volume.ravel())


def wrenches(
    matrix: magpylib.Collection, wires: Conductors, place: tuple[float, float], phi: float = 0.0, lift: float = 0.0
) -> np.ndarray:
    """Return force and torque (3, 6), in its frame, for 1 A in each phase of a motor at `place` in m."""
    c, s = np.cos(phi), np.sin(phi)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    middle = np.array([*place, V["z0"] + Gamma / 2 + lift])
    B = matrix.getB(wires.at @ turn.T + middle) @ turn
    columns = []
    for j in wires.j:
        force = wires.volume[:, None] * np.cross(np.column_stack([j, np.zeros(len(j))]), B)
        columns.append(np.concatenate([force.sum(axis=0), np.cross(wires.at, force).sum(axis=0)]))
    return np.array(columns)


def _bands(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return nodes y, weights, and by phase the current in bands (3, k) and what of it is still to come back, m."""
    y, dy, slope, height = [], [], [[], [], []], [[], [], []]
    level = np.zeros(3)
    for half in range(2 * FIRST, 2 * LAST):  # half bands: the band about a sixth ends half a sixth on either side
        band = SIXTHS[((half + 1) // 2) % 6]
        nodes, weights = _gauss(half * l / 12, (half + 1) * l / 12, n)
        y.append(nodes)
        dy.append(weights)
        for k, phase in enumerate("ABC"):
            rate = 0.0 if phase not in band else 1.0 if band.startswith("-") else -1.0
            slope[k].append(np.full(n, rate))
            height[k].append(level[k] + rate * (nodes - half * l / 12))
            level[k] += rate * l / 12
    assert np.allclose(level, 0)
    return np.concatenate(y), np.concatenate(dy), *(np.array([np.concatenate(r) for r in f]) for f in (slope, height))


def _lengths(flat: bool, n: int) -> tuple[np.ndarray, ...]:
    """Return nodes x, weights, the share of the current that still runs along x and how fast it turns off, 1/m."""
    if not flat:
        x, dx = _gauss(-l / 2, l / 2, n)
        return x, dx, np.ones(n), np.zeros(n)
    inner, outer, few = l / 2 - l / 12, l / 2 + l / 12, 4
    left, wl = _gauss(-outer, -inner, few)
    middle, wm = _gauss(-inner, inner, n)
    right, wr = _gauss(inner, outer, few)
    share = np.concatenate([(left + outer) / (l / 6), np.ones(n), (outer - right) / (l / 6)])
    rate = np.concatenate([np.full(few, 6 / l), np.zeros(n), np.full(few, -6 / l)])
    return np.concatenate([left, middle, right]), np.concatenate([wl, wm, wr]), share, rate


def _gauss(low: float, high: float, n: int) -> tuple[np.ndarray, np.ndarray]:
    nodes, weights = np.polynomial.legendre.leggauss(n)
    return low + (high - low) * (nodes + 1) / 2, (high - low) / 2 * weights
