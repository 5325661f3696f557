"""Slotted magnetostatic field of an iron-cored linear motor, by finite differences.

Problem. In one pole pitch tau, antiperiodic because magnets and currents change sign from pole to pole,
A(x + tau, y) = -A(x, y), the vector potential A(x, y) along z obeys

    -div(nu grad A) = J + curl M,   B_x = dA/dy,   B_y = -dA/dx,   nu = 1/mu0, in the magnet 1/(mu0 mu_rec),

over the back iron, in the gap and in three open slots. Both irons are infinitely permeable: dA/dn = 0 on them.

    y = h_m + g + d          ________           slot bottom (iron)
                            |  N i   |
    y = h_m + g     --------+        +-------   tooth faces (iron)
                               gap
    y = h_m             +----------+            magnet top; coercivity H_c along +-y: current sheets +-H_c on its sides
    y = 0           ----+----------+--------    back iron

Method. Five-point scheme (control volumes) on a tensor grid aligned with slot edges, tooth faces, mid-gap and magnet
top, graded quadratically towards the tooth corners: there A varies as r^(2/3), and this grading preserves second order.
The magnet's sides may be anywhere in x: cubic interpolation spreads each sheet over four nodes, and the forces depend
smoothly on every dimension. The forces are the integral of Maxwell's stress over the mid-gap line.

Signs. The mover (magnets) hangs below the stator; y points up. With a magnet that points up centred at x_m, slot s
carries N (i_d sin k(x_s - x_m) + i_q cos k(x_s - x_m)), k = pi/tau, where i_d, i_q are *peak* phase currents (amplitude
of a phase, sqrt(2) times the rms value). i_q > 0 pushes the mover along +x, i_d > 0 weakens the attraction.

Source: the motor of Fulford, Maggiore and Apkarian, Table I, whose closed-form forces (1)-(4) this field checks.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix, csc_matrix
from scipy.sparse.linalg import SuperLU, splu

from models.slotted_grid import SLOTS_PER_POLE, Geometry, Grid, grid, to_nodes

Array = NDArray[np.float64]

MU0 = 4e-7 * np.pi
POSITIONS = 6


@dataclass(frozen=True)
class Forces:
    """Forces of one motor at one gap, per peak phase current; means over a slot pitch except the cogging."""

    thrust: float  # [N/A] along x, per i_q
    vertical: float  # [N/A] downwards, per i_d
    attraction: float  # [N/A^2] upwards, per i_d^2 + i_q^2
    lift: float  # [N] upwards, without current
    cogging: float  # [N] amplitude of the component of period t1, without current


@dataclass(frozen=True)
class Converged:
    """Forces extrapolated to zero cell size, with the size of the extrapolation as the error of each."""

    value: Forces
    error: Forces


@dataclass(frozen=True)
class Field:
    """Potential A [Wb/m] on the nodes, (nx, ny + 1), and the currents I [A] that generate it."""

    grid: Grid
    A: Array
    I: Array


def matrix(g: Grid, geometry: Geometry, x_m: float) -> csc_matrix:
    """Return the five-point matrix of -div(nu mu0 grad A), nu averaged in series along x and in parallel along y."""
    nu_x, nu_y = g.air.astype(float), g.air.astype(float)
    share = np.abs(_magnet_share(g, geometry, x_m))[:, None]
    nu_x[:, : g.top] /= 1 + share * (geometry.mu_rec - 1)
    nu_y[:, : g.top] *= 1 + share * (1 / geometry.mu_rec - 1)
    h_x, h_y = np.diff(g.x)[:, None], np.diff(g.y)[None, :]
    along_x = np.pad(nu_x * h_y, ((0, 0), (1, 1)))
    along_x = (along_x[:, 1:] + along_x[:, :-1]) / 2 / h_x
    along_y = nu_y * h_x
    along_y = (along_y + np.roll(along_y, 1, axis=0)) / 2 / h_y
    number = np.cumsum(g.nodes.ravel()).reshape(g.nodes.shape) - 1
    sign = np.ones_like(along_x)
    sign[-1] = -1
    i, j = np.nonzero(along_x)
    m, n = np.nonzero(along_y)
    start = np.r_[number[i, j], number[m, n]]
    end = np.r_[number[(i + 1) % len(number), j], number[m, n + 1]]
    weight = np.r_[along_x[i, j], along_y[m, n]]
    cross = -weight * np.r_[sign[i, j], np.ones(len(m))]
    places = np.r_[start, end, start, end], np.r_[start, end, end, start]
    return coo_matrix((np.r_[weight, weight, cross, cross], places)).tocsc()


def _magnet_share(g: Grid, geometry: Geometry, x_m: float) -> Array:
    """Return the share of each column of cells that lies in a magnet, negative in one that points down; (nx,)."""
    first = np.floor(x_m / geometry.tau)
    share = np.zeros(len(g.x) - 1)
    for turn in (-1, 0, 1):
        centre = x_m - (first - turn) * geometry.tau
        inside = np.clip(g.x, centre - geometry.tau_p / 2, centre + geometry.tau_p / 2)
        share += (-1) ** ((first - turn) % 2) * np.diff(inside) / np.diff(g.x)
    return share


def _sheet(g: Grid, position: float) -> Array:
    """Return the weights that spread a unit current at x = position over its four nearest nodes; (nx,)."""
    tau, count = g.x[-1], len(g.x) - 1
    turn = np.floor(position / tau)
    position -= turn * tau
    near = np.searchsorted(g.x, position, side="right") - 1 + np.arange(-1, 3)
    x = g.x[near % count] + (near // count) * tau
    weights = np.zeros(count)
    for m in range(4):
        others = np.delete(x, m)
        sign = (-1) ** ((turn + near[m] // count) % 2)
        weights[near[m] % count] += sign * np.prod((position - others) / (x[m] - others))
    return weights


def magnet_currents(g: Grid, geometry: Geometry, x_m: float) -> Array:
    """Return the nodes' share [A] of the sheets +-H_c of a magnet pointing up at x_m and of its neighbours.

    A cell that a magnet of mu_rec != 1 covers in part, f of it, has the mean H_c f mu_rec/(1 + f (mu_rec - 1)).
    """
    f = _magnet_share(g, geometry, x_m)
    excess = f * (geometry.mu_rec / (1 + np.abs(f) * (geometry.mu_rec - 1)) - 1)
    sides = _sheet(g, x_m - geometry.tau_p / 2) - _sheet(g, x_m + geometry.tau_p / 2)
    h_y = np.where(np.arange(len(g.y) - 1) < g.top, np.diff(g.y), 0.0)
    heights = (np.r_[h_y, 0.0] + np.r_[0.0, h_y]) / 2
    return geometry.H_c * np.outer(sides + excess - np.r_[-excess[-1], excess[:-1]], heights)


def slot_currents(g: Grid, ampere_turns: Array) -> Array:
    """Return the nodes' share [A] of currents (3,) [A] spread evenly over the slots."""
    area = np.diff(g.x)[:, None] * np.diff(g.y)[None, :]
    area[:, : g.face] = 0.0
    density = np.r_[ampere_turns, 0.0][g.slot] / area[g.slot == 0].sum()
    return to_nodes(density[:, None] * area)


def slot_positions(geometry: Geometry) -> Array:
    """Return the slots' centres [m] in one pole, (3,)."""
    return np.asarray(geometry.opening / 2 + geometry.tau / SLOTS_PER_POLE * np.arange(SLOTS_PER_POLE))


def solve(g: Grid, lu: SuperLU, currents: Array) -> Field:
    """Return the field of the nodes' currents [A], (nx, ny + 1)."""
    A = np.zeros(g.nodes.shape)
    A[g.nodes] = lu.solve(MU0 * currents[g.nodes])
    return Field(g, A, currents)


def stress(geometry: Geometry, one: Field, other: Field) -> tuple[float, float]:
    """Return the bilinear force (F_x, F_y) [N] on the mover, so that stress(f, f) is the force of the field f.

    F_x = l integral of B_x B_y/mu0 dx and F_y = l integral of (B_y^2 - B_x^2)/(2 mu0) dx over the mid-gap line of a
    pole, l = L_A p_m being the length of all poles.
    """
    B, C = _mid_gap(one), _mid_gap(other)
    h = np.diff(one.grid.x)
    scale = geometry.L_A * geometry.p_m / MU0
    B_x, C_x = (B[0][1:] + B[0][:-1]) / 2, (C[0][1:] + C[0][:-1]) / 2
    square = B[0] * C[0]
    F_x = np.sum(h * (B_x * C[1] + C_x * B[1])) / 2
    F_y = np.sum(h * (B[1] * C[1] - (square[1:] + square[:-1]) / 2)) / 2
    return float(scale * F_x), float(scale * F_y)


def _mid_gap(field: Field) -> tuple[Array, Array]:
    """Return B_x [T] on the nodes, (nx + 1,), and B_y [T] between them, (nx,), along the mid-gap line."""
    A, y, j = np.r_[field.A, -field.A[:1]], field.grid.y, field.grid.middle
    h, k = y[j] - y[j - 1], y[j + 1] - y[j]
    B_x = ((A[:, j] - A[:, j - 1]) * k / h + (A[:, j + 1] - A[:, j]) * h / k) / (h + k)
    return B_x, -np.diff(A[:, j]) / np.diff(field.grid.x)


def forces(geometry: Geometry, gap: float, cells: int = 12) -> Forces:
    """Return the forces at a gap [m] by superposing magnets, d and q currents; `cells` and ValueError as in `grid`."""
    g = grid(geometry, gap, cells)
    k, x_s = np.pi / geometry.tau, slot_positions(geometry)
    rows, lu = [], None
    for x_m in x_s[0] + geometry.tau / SLOTS_PER_POLE * np.arange(POSITIONS) / POSITIONS:
        if lu is None or geometry.mu_rec != 1:
            lu = splu(matrix(g, geometry, x_m))
        magnet = solve(g, lu, magnet_currents(g, geometry, x_m))
        d = solve(g, lu, slot_currents(g, geometry.conductors * np.sin(k * (x_s - x_m))))
        q = solve(g, lu, slot_currents(g, geometry.conductors * np.cos(k * (x_s - x_m))))
        rows.append(
            (
                2 * stress(geometry, magnet, q)[0],
                -2 * stress(geometry, magnet, d)[1],
                stress(geometry, d, d)[1],
                *reversed(stress(geometry, magnet, magnet)),
            )
        )
    table = np.array(rows)
    thrust, vertical, attraction, lift = (float(mean) for mean in table[:, :4].mean(axis=0))
    return Forces(thrust, vertical, attraction, lift, 2 * float(np.abs(np.fft.rfft(table[:, 4])[1])) / POSITIONS)


def extrapolate(geometry: Geometry, gap: float, cells: int = 12) -> Converged:
    """Return Richardson's (4 F(2 cells) - F(cells))/3, the scheme being of second order; ValueError as in `grid`."""
    coarse, fine = (np.array(astuple(forces(geometry, gap, n))) for n in (cells, 2 * cells))
    correction = (fine - coarse) / 3
    return Converged(Forces(*map(float, fine + correction)), Forces(*map(float, np.abs(correction))))
