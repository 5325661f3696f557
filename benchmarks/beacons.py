"""Two problems for a least-squares estimator: ranges to beacons with a clock bias, and bearings from a turning body.

The reference is written from the textbook's equations in NumPy, with pseudoinverses in place of L D L'.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi
from typing import Any

import casadi as ca
import numpy as np

from synth.block import Block, Exprs
from synth.blocks.estimate import glsdc_estimator, glsdc_model
from synth.blocks.estimate.glsdc_integrity import Integrity
from synth.blocks.estimate.glsdc_model import Unknown
from synth.signals import Signal
from synth.statespace import Array
from synth.timing import Discrete

TIME = Discrete(1e-2)
CORNERS = np.array([[-7.0, -6.0], [7.0, -6.5], [0.5, 8.0], [-7.5, 5.0], [7.5, 6.0], [0.0, -8.0]])  # m
NOISE, MODEL_ERROR, BEARING_NOISE = 0.02, 0.015, 2e-3  # m, m, rad
SIGMA = float(np.hypot(NOISE, MODEL_ERROR))
HALF = 5.0  # m, half the width of the field
LETTERS = "abcdef"


@dataclass(frozen=True)
class Problem:
    """A problem: unknowns with their ranges, number of beacons, deviations of the channels."""

    kind: str
    beacons: int
    unknowns: tuple[str, ...]

    @property
    def channels(self) -> list[Signal]:
        """The channels, one a beacon."""
        if self.kind == "ranges":
            return [Signal(f"range_{k}", "m", 0.0, 30.0, "range to a beacon") for k in LETTERS[: self.beacons]]
        return [Signal(f"bearing_{k}", "rad", -pi, pi, "bearing of a beacon") for k in LETTERS[: self.beacons]]

    @property
    def sigma(self) -> float:
        """The standard deviation of a channel."""
        return SIGMA if self.kind == "ranges" else BEARING_NOISE


def ranges(beacons: int = 4, bias: bool = False) -> Problem:
    """Return the problem of ranges to beacons, with a clock bias or without."""
    return Problem("ranges", beacons, ("x", "y", "bias") if bias else ("x", "y"))


def bearings(beacons: int = 4) -> Problem:
    """Return the problem of bearings from a turning body."""
    return Problem("bearings", beacons, ("x", "y", "heading"))


UNKNOWNS: Mapping[str, Unknown] = {
    "x": Unknown(Signal("x", "m", -HALF, HALF, "position"), largest_deviation=1.0, step=3.0),
    "y": Unknown(Signal("y", "m", -HALF, HALF, "position"), largest_deviation=1.0, step=3.0),
    "bias": Unknown(Signal("bias", "m", -2.0, 2.0, "clock bias"), largest_deviation=1.0, step=1.0),
    "heading": Unknown(Signal("heading", "rad", -pi, pi, "heading"), largest_deviation=0.2, step=0.5, periodic=True),
}


def measurement(of: Problem) -> Any:
    """Return h of a problem."""

    def h(q: Exprs, k: Exprs) -> Exprs:
        away = [(bx - q["x"], by - q["y"]) for bx, by in CORNERS[: of.beacons]]
        if of.kind == "ranges":
            distances = [ca.sqrt(dx**2 + dy**2) for dx, dy in away]
            return {
                s.name: d + q["bias"] if "bias" in of.unknowns else d
                for s, d in zip(of.channels, distances, strict=True)
            }
        return {s.name: ca.atan2(dy, dx) - q["heading"] for s, (dx, dy) in zip(of.channels, away, strict=True)}

    return h


def block(
    of: Problem, integrity: Integrity | None = None, changed: Mapping[str, Unknown] | None = None, **other: Any
) -> Block:
    """Return the guarded estimator of a problem."""
    unknowns = dict(UNKNOWNS) | dict(changed or {})
    R = glsdc_model.covariance([NOISE] * of.beacons, [MODEL_ERROR] * of.beacons)
    R = R if of.kind == "ranges" else BEARING_NOISE**2 * np.eye(of.beacons)
    bare = glsdc_estimator.estimator(
        "estimator",
        TIME,
        measurement(of),
        R,
        channels=of.channels,
        unknowns=[unknowns[n] for n in of.unknowns],
        angles=[s.name for s in of.channels] if of.kind == "bearings" else [],
        integrity=integrity,
        **other,
    )
    return glsdc_estimator.guarded(bare, of.kind, of.channels, bad_samples=5)


def values(of: Problem, q: Array) -> Array:
    """Return h (N, m) at unknowns (N, n), in NumPy."""
    q = np.atleast_2d(q)
    away = CORNERS[None, : of.beacons] - q[:, None, :2]
    if of.kind == "ranges":
        return np.linalg.norm(away, axis=2) + (q[:, 2:3] if "bias" in of.unknowns else 0)
    return wrap(np.arctan2(away[..., 1], away[..., 0]) - q[:, 2:3])


def jacobian(of: Problem, q: Array) -> Array:
    """Return dh/dq (N, m, n) at unknowns (N, n)."""
    away = CORNERS[None, : of.beacons] - q[:, None, :2]
    squared = (away**2).sum(axis=2)
    if of.kind == "ranges":
        H = -away / np.sqrt(squared)[..., None]
        return np.dstack([H, np.ones_like(squared)]) if "bias" in of.unknowns else H
    return np.dstack([away[..., 1] / squared, -away[..., 0] / squared, -np.ones_like(squared)])


def wrap(angle: Array) -> Array:
    """Return angles wrapped to half a turn."""
    return np.asarray((angle + pi) % (2 * pi) - pi)


def solve(of: Problem, y: Array, start: Array, corrections: int = 25) -> tuple[Array, Array, Array]:
    """Return least-squares unknowns (N, n), covariances (N, n, n) and chi-squares (N,) of measurements (N, m)."""
    q = np.array(start, dtype=float)
    for _ in range(corrections):
        e, H = y - values(of, q), jacobian(of, q)
        e = wrap(e) if of.kind == "bearings" else e
        q = q + (np.linalg.pinv(H) @ e[..., None])[..., 0]
    e, H = y - values(of, q), jacobian(of, q)
    e = wrap(e) if of.kind == "bearings" else e
    P = of.sigma**2 * np.linalg.inv(np.swapaxes(H, 1, 2) @ H)
    return q, np.asarray(P, float), np.asarray((e**2).sum(axis=1) / of.sigma**2)


def draw(of: Problem, n: int, rng: np.random.Generator) -> Array:
    """Return unknowns (n, k) in the middle of their ranges."""
    widths = {"x": 4.0, "y": 4.0, "bias": 1.0, "heading": 3.1}
    return np.column_stack([rng.uniform(-widths[name], widths[name], n) for name in of.unknowns])
