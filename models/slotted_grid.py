"""Dimensions of one slotted motor and the tensor grid of one pole for its finite-difference field.

The grid is aligned with slot edges, tooth faces, mid-gap and magnet top, and graded quadratically towards the tooth
corners: there the potential varies as r^(2/3), and this grading keeps second order.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SLOTS_PER_POLE = 3


@dataclass(frozen=True)
class Geometry:
    """One motor: Table I of the paper, and two dimensions that are not printed (mu_rec, slot_depth).

    The winding has three slots per pole, so the slot pitch is tau/3. A t1 other than tau/3 is represented by a slot
    opening b with b^2/(tau/3) = b0^2/t1, the quantity that determines Carter's correction to leading order.
    """

    L_A: float = 50e-3  # [m] magnet length across the motion
    p_m: float = 4.0  # [-] magnets
    tau: float = 57.15e-3  # [m] pole pitch
    tau_p: float = 28.58e-3  # [m] magnet width
    t1: float = 19.05e-3  # [m] slot pitch
    b0: float = 12.7e-3  # [m] slot opening
    h_m: float = 5e-3  # [m] magnet height
    W: float = 900.0  # [-] turns per phase
    poles: float = 6.0  # [-] stator poles
    H_c: float = 875400.0  # [A/m] coercivity
    mu_rec: float = 1.0  # [-] recoil permeability; the closed form's charge sheet has 1
    slot_depth: float = 25.4e-3  # [m] two openings: deeper slots change no force by more than 5e-6

    @property
    def opening(self) -> float:
        """Return the width [m] of a slot on the pitch tau/3."""
        return self.b0 * float(np.sqrt(self.tau / (SLOTS_PER_POLE * self.t1)))

    @property
    def conductors(self) -> float:
        """Return N = 2 W/poles, the conductors in a slot (single layer, one slot per pole and phase)."""
        return 2.0 * self.W / self.poles


@dataclass(frozen=True)
class Grid:
    """Tensor grid of one pole: x[0] = 0 is the left edge of slot 0; x[-1] = tau is x[0] with A negated."""

    x: Array  # [m] (nx + 1,)
    y: Array  # [m] (ny + 1,)
    top: int  # row of the magnet top
    middle: int  # row of the mid-gap line
    face: int  # row of the tooth faces
    air: NDArray[np.bool_]  # (nx, ny) cells that are not iron
    nodes: NDArray[np.bool_]  # (nx, ny + 1) nodes that touch air
    slot: NDArray[np.intp]  # (nx,) slot above each column of cells, -1 above a tooth


def grid(geometry: Geometry, gap: float, cells: int) -> Grid:
    """Return the grid with `cells` cells across half a slot, a tooth, the magnet, a quarter gap and half a slot depth.

    Raises ValueError when a length is not positive, a slot leaves no tooth, or the magnet is as wide as the pole.
    """
    _check(geometry, gap, cells)
    b, pitch = geometry.opening, geometry.tau / SLOTS_PER_POLE
    even = np.linspace(0.0, 1.0, 2 * cells + 1)
    column = np.r_[b * _graded_at_both_ends(2 * cells)[:-1], b + (pitch - b) * _graded_at_both_ends(cells)[:-1]]
    x = np.r_[np.add.outer(pitch * np.arange(SLOTS_PER_POLE), column).ravel(), geometry.tau]
    half, low = gap / 2, geometry.h_m + gap / 2
    y = np.r_[
        geometry.h_m * even[:-1:2],
        geometry.h_m + half * even[:-1],
        low + half * (1 - (1 - even[:-1]) ** 2),
        low + half + geometry.slot_depth * even**2,
    ]
    slot = np.concatenate([np.r_[np.full(2 * cells, s), np.full(cells, -1)] for s in range(SLOTS_PER_POLE)])
    air = np.ones((len(x) - 1, len(y) - 1), dtype=bool)
    air[slot < 0, 5 * cells :] = False
    nodes = to_nodes(air.astype(float)) > 0
    return Grid(x, y, cells, 3 * cells, 5 * cells, air, nodes, slot)


def _check(geometry: Geometry, gap: float, cells: int) -> None:
    for name, value in {"gap": gap, **asdict(geometry)}.items():
        if not (np.isfinite(value) and value > 0):
            raise ValueError(f"{name} = {value} of the motor must be positive and finite; give it in SI units")
    if cells < 2:
        raise ValueError(f"cells = {cells} but cubic interpolation needs at least 2; refine the grid")
    if geometry.opening >= geometry.tau / SLOTS_PER_POLE:
        raise ValueError(f"slot opening {geometry.opening} m leaves no tooth in tau/3; reduce b0")
    if geometry.tau_p >= geometry.tau:
        raise ValueError(f"magnet width {geometry.tau_p} m reaches the pole pitch {geometry.tau} m; reduce tau_p")


def _graded_at_both_ends(n: int) -> Array:
    s = np.linspace(0.0, 1.0, n + 1)
    return s * s * (3 - 2 * s)


def to_nodes(cell: Array) -> Array:
    """Return a quarter of the sum of the cells that adjoin each node, taken as periodic in x; (nx, ny + 1)."""
    rows = np.pad(cell, ((0, 0), (1, 1)))
    rows = (rows[:, 1:] + rows[:, :-1]) / 2
    return (rows + np.roll(rows, 1, axis=0)) / 2
