"""Field above periodic magnet matrices from the remanence of each block: a symbolic Fourier series.

            z ^      strong side                 one pitch l by l has n_x by n_y blocks of height Delta with
              |  ~~~~~~~~~~~~~~~~~~              the remanence J_ij; the origin is the centre of block (0, 0), in the
              +---+---+---+---+---+---> X        plane of the blocks' upper faces. A Halbach array along X is a cell
              | ^ | < | v | > | ^ |              with n_y = 1, one along Y has n_x = 1, and the concentrated-field
                                                 matrix is the sum of the two.

With k = (2 pi / l) (p, q), kappa = |k| and J_k = sinc(p/n_x) sinc(q/n_y) / (n_x n_y) sum_ij J_ij exp(-i k.r_ij), where
sinc(t) = sin(pi t) / (pi t), the charges of the blocks' faces make above the matrix

    B = -grad Phi,    Phi = sum_k Phi_k exp(i k.r - kappa z),
    Phi_k = (1 - exp(-kappa Delta)) / (2 kappa) (J_z - i k.J / kappa),

written as waves (c cos(k.r) + s sin(k.r)) exp(-kappa z), one for each pair of k and -k.

Two ideal arrays have waves (n, 0) and (0, n) with n = 1, 5, 9, .. only. Blocks of one strong and one weak grade have
m = strong/2 and m = weak/sqrt(2). If these differ, the waves 3, 7, .. appear, and waves with nonzero p and q, one odd
and one even, chiefly (2, +-1) and (1, +-2). Model (2) contains none of them, and they are most of its residual.

Source: Kawato, Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors", section
2, Fig. 2.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import cos, pi, sin, sqrt

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from models.halbach import Field, wave_number
from synth.block import Exprs
from synth.errors import ModelError
from synth.signals import Parameter
from synth.statespace import readonly

Array = NDArray[np.float64]
Order = tuple[int, int]

SECTION = "Kawato, Kim, section 2"
PARAMETERS = (
    Parameter("l", 50.8e-3, "m", 1e-3, SECTION),
    Parameter("Delta", 12.7e-3, "m", 1e-3, SECTION),
    Parameter("strong", 1.43, "T", 0.02, SECTION),
    Parameter("weak", 1.10, "T", 0.02, SECTION),
)
STRONG, WEAK = (p.value for p in PARAMETERS if p.unit == "T")
CYCLE = readonly([(0, 1), (-1, 0), (0, -1), (1, 0)])  # along the array and up
CROSS = ((2, 1), (2, -1), (1, 2), (1, -2))


@dataclass(frozen=True, eq=False)
class Cell:
    """The remanence in T along X, Y and Z of the blocks (n_x, n_y) in one pitch."""

    x: ca.SX
    y: ca.SX
    z: ca.SX

    def __post_init__(self) -> None:
        if not self.x.shape == self.y.shape == self.z.shape or not self.x.numel():
            raise ModelError(
                f"a cell has {self.x.shape}, {self.y.shape} and {self.z.shape} remanences along X, Y and Z: "
                "give one of each for every block"
            )


@dataclass(frozen=True, eq=False)
class Wave:
    """The potential (cosine cos(k.r) + sine sin(k.r)) exp(-kappa z), T m; k = (kx, ky) and kappa in rad/m, written 1/m.

    `order` is k in units of 2 pi / l.
    """

    order: Order
    kx: ca.SX
    ky: ca.SX
    kappa: ca.SX
    cosine: ca.SX
    sine: ca.SX


def values() -> dict[str, ca.SX]:
    """Return the parameters of the paper as constants."""
    return {p.name: ca.SX(p.value) for p in PARAMETERS}


def directions(cycle_x: Array, cycle_y: Array) -> tuple[Array, Array]:
    """Return the directions of the strong and of the weak blocks, (n_x, n_y, 3) each, 0 at other blocks.

    A block is the sum a(i) + b(j) of two cycles (n, 2) along and up: strong where both point up or both down, absent
    where they cancel, else weak. The directions are not unit vectors: multiply them by strong/2 and weak/sqrt(2).
    """
    units = np.zeros((len(cycle_x), len(cycle_y), 3))
    units[:, :, 0], units[:, :, 1] = cycle_x[:, None, 0], cycle_y[None, :, 0]
    units[:, :, 2] = cycle_x[:, None, 1] + cycle_y[None, :, 1]
    squares = (units**2).sum(axis=2, keepdims=True)
    return np.where(squares == 4, units, 0.0), np.where(squares == 2, units, 0.0)


def array(along: Sequence[ca.SX | float], up: Sequence[ca.SX | float]) -> Cell:
    """Return an array along X of one pitch of blocks with the remanences `along` it and `up` in T."""
    x, z = (ca.vertcat(*(ca.SX(value) for value in each)) for each in (along, up))
    return Cell(x, ca.SX.zeros(len(along), 1), z)


def halbach_array(m: ca.SX | float) -> Cell:
    """Return the ideal array along X of the remanence m in T, the strong side up."""
    return array([m * a for a in CYCLE[:, 0]], [m * u for u in CYCLE[:, 1]])


def mirrored(cell: Cell) -> Cell:
    """Return a cell mirrored in X = Y, with every magnetisation along: an array along X becomes one along Y."""
    return Cell(cell.y.T, cell.x.T, cell.z.T)


def superpose(a: Cell, b: Cell) -> Cell:
    """Return the sum of two cells, with the single blocks of one divided as in the other.

    Raises ModelError unless along X and along Y one has as many blocks as the other or a single one.
    """
    shape = [max(n, m) for n, m in zip(a.x.shape, b.x.shape, strict=True)]
    if any(n not in (1, size) for each in (a, b) for n, size in zip(each.x.shape, shape, strict=True)):
        raise ModelError(
            f"cells of {a.x.shape} and {b.x.shape} blocks do not fit: each side needs equal numbers or a single block"
        )

    def divide(each: ca.SX) -> ca.SX:
        return ca.repmat(each, shape[0] // each.shape[0], shape[1] // each.shape[1])

    return Cell(divide(a.x) + divide(b.x), divide(a.y) + divide(b.y), divide(a.z) + divide(b.z))


def ideal_matrix(strong: ca.SX | float) -> Cell:
    """Return the matrix of two ideal arrays whose strong blocks have the remanence `strong` in T."""
    along_x = halbach_array(strong / 2)
    return superpose(along_x, mirrored(along_x))


def fabricated_matrix(strong: ca.SX | float, weak: ca.SX | float) -> Cell:
    """Return the matrix of blocks of two grades, of the remanences `strong` and `weak` in T."""
    first, second = directions(CYCLE, CYCLE)
    x, y, z = (strong / 2 * ca.SX(first[:, :, i]) + weak / sqrt(2) * ca.SX(second[:, :, i]) for i in range(3))
    return Cell(x, y, z)


def orders_on_axes(numbers: Iterable[int]) -> tuple[Order, ...]:
    """Return the orders (n, 0) and (0, n)."""
    return tuple(order for n in numbers for order in ((n, 0), (0, n)))


def orders_up_to(highest: int) -> tuple[Order, ...]:
    """Return every order with |p| and |q| up to `highest`, one of each pair k and -k."""
    side = range(-highest, highest + 1)
    return tuple((p, q) for p in range(highest + 1) for q in side if (p, q) > (0, 0))


def waves(cell: Cell, orders: Iterable[Order], p: Exprs) -> tuple[Wave, ...]:
    """Return the waves of a matrix, without those that vanish for blocks of these sides.

    `p` holds the pitch l and the blocks' height Delta in m.

    Raises ModelError for the order (0, 0), which has no field, and for one that is listed twice, as itself or as -k.
    """
    matrix_waves, w = [], wave_number(p)
    for order in _check_distinct(orders):
        shape = _sinc(order[0], cell.x.shape[0]) * _sinc(order[1], cell.x.shape[1])
        if shape:
            matrix_waves.append(_wave(cell, order, shape, w, p["Delta"]))
    return tuple(matrix_waves)


def _wave(cell: Cell, order: Order, shape: float, w: ca.SX, Delta: ca.SX) -> Wave:
    kx, ky, kappa = _numbers(order, w)
    real, sines = _phases(order, cell.x.shape)
    parts = (real, -sines)  # of exp(-i k.r)
    up = [ca.dot(part, cell.z) for part in parts]
    along = [(kx * ca.dot(part, cell.x) + ky * ca.dot(part, cell.y)) / kappa for part in parts]
    scale = shape / real.numel() * -ca.expm1(-kappa * Delta) / kappa
    return Wave(order, kx, ky, kappa, scale * (up[0] + along[1]), scale * (along[0] - up[1]))


def _numbers(order: Order, w: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
    p, q = order
    return p * w, q * w, sqrt(p**2 + q**2) * w


def waves_from_amplitudes(amplitudes: Mapping[int, ca.SX | float], height: ca.SX | float, p: Exprs) -> tuple[Wave, ...]:
    """Return the waves of B_X = sum_n A_n sin(n w X), B_Y likewise in Y, with A_n in T at a height in m: model (2)."""
    model_waves = []
    for order in _check_distinct(orders_on_axes(amplitudes)):
        kx, ky, kappa = _numbers(order, wave_number(p))
        model_waves.append(
            Wave(order, kx, ky, kappa, amplitudes[sum(order)] * ca.exp(kappa * height) / kappa, ca.SX(0))
        )
    return tuple(model_waves)


def amplitude(wave: Wave, z: ca.SX | float) -> ca.SX:
    """Return the amplitude of a wave's sin(k.r) in B_X in T, z in m above the matrix; of a wave (0, n) in B_Y."""
    k = wave.kx if wave.order[0] else wave.ky
    return k * wave.cosine * ca.exp(-wave.kappa * z)


def amplitudes(cell: Cell, numbers: Iterable[int], z: float) -> list[float]:
    """Return A_n in T of sin(n w X) in B_X, z in m above a matrix, 0 where the wave vanishes."""
    orders = [(n, 0) for n in numbers]
    sizes = {wave.order: float(amplitude(wave, z)) for wave in waves(cell, orders, values())}
    return [sizes.get(order, 0.0) for order in orders]


def field(waves: Iterable[Wave], X: ca.SX, Y: ca.SX, z: ca.SX) -> Field:
    """Return the flux density in T at X, Y in m, z in m above the matrix."""
    x, y, up = ca.SX(0), ca.SX(0), ca.SX(0)
    for wave in waves:
        phase, decay = wave.kx * X + wave.ky * Y, ca.exp(-wave.kappa * z)
        c, s = ca.cos(phase), ca.sin(phase)
        slope = decay * (wave.cosine * s - wave.sine * c)
        x, y = x + wave.kx * slope, y + wave.ky * slope
        up += wave.kappa * decay * (wave.cosine * c + wave.sine * s)
    return Field(x, y, up)


def _check_distinct(orders: Iterable[Order]) -> tuple[Order, ...]:
    distinct: list[Order] = []
    for p, q in orders:
        if (p, q) == (0, 0):
            raise ModelError("the order (0, 0) is the mean, which has no field above the matrix: leave it out")
        if (p, q) in distinct or (-p, -q) in distinct:
            raise ModelError(f"the wave ({p}, {q}) is listed twice, as itself or as ({-p}, {-q}): give it once")
        distinct.append((p, q))
    return tuple(distinct)


def _sinc(p: int, n: int) -> float:
    if p == 0:
        return 1.0
    return 0.0 if p % n == 0 else sin(pi * p / n) / (pi * p / n)


def _phases(order: Order, shape: tuple[int, int]) -> tuple[ca.SX, ca.SX]:
    """Return cosines and sines (n_x, n_y) of k.r_ij, exact at quarter turns, with exact zeros."""
    (p, q), (n, m) = order, shape
    turn = n * m
    steps = 4 * (p * m * np.arange(n)[:, None] + q * n * np.arange(m))  # in quarters of a turn, times n m

    def cosines(quarters: NDArray[np.int_]) -> ca.SX:
        exact = (1.0, 0.0, -1.0, 0.0)
        values = [exact[k // turn % 4] if k % turn == 0 else cos(pi / 2 * k / turn) for k in quarters.ravel().tolist()]
        return ca.SX(np.reshape(values, shape))

    return cosines(steps), cosines(steps - turn)
