"""NumPy reference of the planar positioner's Hall sensing and Kalman filters: Y(1)-(16).

Y is Yu and Kim, "Design of Precision Positioner with Hall-effect Sensors and Multivariable Control Methodology".
It is written from these equations with separate constants and gains. Arrays are columns: N platens advance one sample
at a time.

The gains of the filters come from the spectrum of the innovation instead of a Riccati equation. The transfer function
from the held jerk w to the position is T^3/6 (z^2 + 4 z + 1) / (z - 1)^3. The poles of the filter are the roots inside
the unit circle of

    R (z - 1)^6 - q (T^3/6)^2 z (z^2 + 4 z + 1)^2 = 0
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from math import pi
from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
from numpy.typing import NDArray

from synth.reference import repeated_codes

Array = NDArray[Any]
Columns = Mapping[str, Array]

HALL = ("V_ax", "V_ay", "V_bx", "V_by", "V_cx", "V_cy")
PITCH = 0.3048 / 6  # m, Table 2
REMANENCE = 0.71  # T, Table 2
THICKNESS = PITCH / 4  # m, Table 2
HEIGHT = 3e-3  # m
SENSITIVITY = 0.4 * 21  # V/T, section 3.1
DEVIATION = 5e-5  # m, after (9)
DENSITY = {"x": 100.0, "y": 100.0, "phi": 1e5}  # (13)
FASTEST = {"x": 4.0, "y": 4.0, "phi": 7.0}  # m/s, rad/s: beyond it a filter restarts
MAX_RAW_YAW = 0.025  # rad
COUNT, FARTHEST = 2, 0.16  # pitches to either side; m: of a raw position
EXCESS_WEIGHT, SQUARE_FLOOR = 0.1, 1e-6  # of the third equation; regularisation of a ratio
REGULARISATION = 0.01  # of the yaw
REGULARISATION_FROM_FORCES = 2.5e-5  # where predictions come from the demands
RESIDUAL_BOUND, EXCESS_BOUND = 0.08, 0.15  # of A, of A^2
INNOVATION, YAW_INNOVATION = 6e-4, 0.08  # m; of A, times the square root of the yaw's information
LASTING = 0.8  # of the yaw's innovation of the sample before
CONFIRMATION = 0.5  # of rho
MEMORY = 4.0  # samples
BRIDGED = PITCH / 2 + 2e-3  # m: from the middle of the pitch, in samples that are not measured
SCALE, SCALE_SHARE = (0.84, 1.2), 1e-3  # of the voltages; of its error, corrected in a sample
REPEATS, WATCHED = 14, 3  # codes in a row of a frozen channel; samples for which a sound one is watched
FIRST = ("m_x", "m_y", "r_1", "r_2", "s_x", "s_y", "phi")  # values stored at the first contradiction
TERMS, POINTS = 4, 64  # of the fitted position


@dataclass(frozen=True)
class Constants:
    """Amplitude in V, fits of position, slope and power, period, and gains (k_p, k_s, k_h) of the filters by axis."""

    amplitude: float
    position: Array
    slope: Array
    power: Array
    period_s: float
    gain: Mapping[str, Array]


@cache
def constants(period_s: float) -> Constants:
    """Return the constants at a sample period in s."""
    amplitude = {n: harmonic(n) for n in (1, 5, 9)}
    t = pi / 8 * (2 * np.arange(POINTS) + 1) / POINTS
    s, c, _ = wave(t, amplitude)
    r = s / c
    shapes = np.stack([r * (1 - r**2) * r ** (2 * k) for k in range(TERMS - 1)], axis=1)
    Q = np.linalg.lstsq(shapes, t - pi / 4 * r)[0]
    position = np.append(Q, 0) - np.append(-pi / 4, Q)
    s, c, derivative = wave(2 * t, amplitude)
    slope = np.linalg.lstsq(np.stack([c**3, c**3 * s**2], axis=1), derivative)[0]
    product = (s * c) ** 2
    power = np.linalg.lstsq(np.stack([product**0, product, product**2], axis=1), s**2 + c**2)[0]
    A = amplitude[1]
    return Constants(
        A,
        position * PITCH / (2 * pi),
        1.5 * pi * slope / A ** np.array([2, 4]),
        power * A ** np.array([2.0, -2.0, -6.0]),
        period_s,
        {axis: gain(q, period_s) for axis, q in DENSITY.items()},
    )


def harmonic(n: int) -> float:
    """Return the amplitude in V of the field's n-th harmonic as a sensor reads it."""
    w = 2 * pi * n / PITCH
    field = 4 / (n * pi) * np.sin(n * pi / 4) * REMANENCE * (1 - np.exp(-w * THICKNESS)) * np.exp(-w * HEIGHT)
    return float(SENSITIVITY * field)


def wave(t: Array, amplitude: Mapping[int, float]) -> tuple[Array, Array, Array]:
    """Return S, C and dS/dt at the phases t (n,), of A_1."""
    parts = [(n, a / amplitude[1]) for n, a in amplitude.items()]
    sine = sum((a * np.sin(n * t) for n, a in parts), start=np.zeros_like(t))
    cosine = sum((a * np.cos(n * t) for n, a in parts), start=np.zeros_like(t))
    return sine, cosine, sum((n * a * np.cos(n * t) for n, a in parts), start=np.zeros_like(t))


def gain(q: float, T: float) -> Array:
    """Return K of (16) at rest, on position, velocity times T and acceleration times T^2/2."""
    with mpmath.workdps(50):
        ratio = mpmath.mpf(q) * (mpmath.mpf(T) ** 3 / 6) ** 2 / mpmath.mpf(DEVIATION) ** 2
        sixth = [mpmath.binomial(6, k) * (-1) ** k for k in range(7)]
        square = [0, 1, 8, 18, 8, 1, 0]
        roots = mpmath.polyroots([a - ratio * b for a, b in zip(sixth, square, strict=True)], 500, extraprec=500)
        p = [z for z in roots if abs(z) < 1]
        A = mpmath.matrix([[1, 1, 1], [0, 1, 2], [0, 0, 1]])
        characteristic = mpmath.eye(3)
        for z in p:
            characteristic = characteristic * (A - z * mpmath.eye(3))
        observability = mpmath.matrix([[1, 0, 0], [1, 1, 1], [1, 2, 4]])  # C, C A, C A^2
        K = mpmath.lu_solve(A, characteristic * mpmath.lu_solve(observability, mpmath.matrix([0, 0, 1])))
        return np.array([float(mpmath.re(k)) for k in K])


def initial_state() -> dict[str, Array]:
    """Return the state after init, by name."""
    names = [f"sensing_{what}_{axis}" for what in ("offset", "within") for axis in "xy"]
    names += [
        "sensing_contradiction_left",
        "sensing_contradiction_confirmed",
        *(f"sensing_first_{name}" for name in FIRST),
    ]
    return {name: np.array(0.0) for name in names} | {"sensing_scale": np.array(1.0)}


def initial_state_with_innovation() -> dict[str, Array]:
    """Return the state after init where predictions come from the demands."""
    rest = {name: v for name, v in initial_state().items() if not name.startswith("sensing_within_")}
    rest |= repeated_codes.initial_state("sensing", REPEATS)
    return rest | {"sensing_phi_raw": np.array(0.0), "sensing_innovation_phi": np.array(0.0)}


def initial_filter_state() -> dict[str, Array]:
    """Return the state of the filters after init, by name."""
    return {f"filter_{axis}_{part}": np.array(0.0) for axis in DENSITY for part in "psh"}


@dataclass(frozen=True)
class Pair:
    """Voltages of one axis rotated back by the yaw, V."""

    s: Array
    c: Array
    k: Constants

    @property
    def m(self) -> Array:
        """The sum of squares less that of the field, V^2."""
        product, q = (self.s * self.c) ** 2, self.k.power
        return self.s**2 + self.c**2 - (q[0] + q[1] * product + q[2] * product**2)

    @property
    def slope(self) -> Array:
        """D A S', V."""
        return self.c**3 * (self.k.slope[0] + self.k.slope[1] * self.s**2)

    @property
    def place(self) -> Array:
        """The position within the pitch, m."""
        near = np.abs(self.s) <= np.abs(self.c)
        r = self.s * self.c / (np.maximum(self.s**2, self.c**2) + SQUARE_FLOOR * self.k.amplitude**2)
        f = sum((a * r ** (2 * n + 1) for n, a in enumerate(self.k.position)), start=np.zeros_like(r))
        back = np.where(f > 0, f - PITCH / 2, f + PITCH / 2)
        return np.where(near, np.where(self.c < 0, back, f), np.where(self.s < 0, -PITCH / 4, PITCH / 4) - f)


def _steady_innovation(state: Columns, complete: Array) -> Array:
    """Return what is added to the predicted yaw: the last innovation; once contradicted, its mean, if smaller."""
    last = np.asarray(state["sensing_innovation_phi"])
    return np.where(complete, np.clip(state["reckoning_phi_mean"], -np.abs(last), np.abs(last)), last)


def sense(
    state: Columns,
    v: Columns,
    flags: tuple[Array, Array],
    predicted: Columns,
    k: Constants,
    from_forces: bool = False,
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return raw position, that within its pitch and residuals, and the next state, from held voltages. Y(1)-(5).

    `flags` say whether every voltage has been good in one sample, and is good in this one. With predictions
    `from_forces` a measured motion that differs is a contradiction, too.
    """
    A, (ready, complete) = k.amplitude, flags
    phi = state["sensing_phi_raw"] if from_forces else predicted["phi"]
    scale = state["sensing_scale"]
    read, v = v, {name: scale * v[name] for name in HALL}
    x = Pair(v["V_ax"] - phi * v["V_ay"], phi * v["V_ay"] - v["V_bx"], k)
    y = Pair(v["V_ay"] + phi * v["V_ax"], -v["V_cy"] - phi * v["V_ax"], k)
    h1, h2 = y.slope + x.c + x.s, x.slope + y.c + y.s
    h3 = 2 * (2 * x.s * y.s - y.s * x.c - x.s * y.c)
    r1, r2, r3 = v["V_by"] - v["V_ay"] - h1 * phi, v["V_cx"] - v["V_ax"] + h2 * phi, x.m - y.m
    weight = EXCESS_WEIGHT / A**2
    information = (
        h1**2 + h2**2 + weight * h3**2 + (REGULARISATION_FROM_FORCES if from_forces else REGULARISATION) * A**2
    )
    step = (h1 * r1 - h2 * r2 + weight * h3 * r3) / information
    counted = {a: count_pitches(p.place, state[f"sensing_offset_{a}"], predicted[a]) for a, p in (("x", x), ("y", y))}
    off = [(p.place + counted[a] - predicted[a]) / INNOVATION for a, p in (("x", x), ("y", y))]
    e = phi + step - predicted["phi"]
    change = e - LASTING * state["sensing_innovation_phi"] if from_forces else e
    motion = off[0] ** 2 + off[1] ** 2 + information * (change / (YAW_INNOVATION * A)) ** 2
    squared = (r1**2 + r2**2) / (RESIDUAL_BOUND * A) ** 2 + (x.m**2 + y.m**2) / (EXCESS_BOUND * A**2) ** 2
    rho = np.sqrt(squared + motion if from_forces else squared)
    residuals = {"m_x": x.m, "m_y": y.m, "r_1": r1, "r_2": r2}
    before = np.asarray(state["sensing_contradiction_left"])
    contradiction = (ready > 0) & complete & (rho > np.where(before > 0, CONFIRMATION, 1))
    accepted = complete & ~contradiction
    bridge = predicted["phi"] + (_steady_innovation(state, complete) if from_forces else 0)
    out = residuals | {"phi_raw": np.clip(np.where(accepted, phi + step, bridge), -MAX_RAW_YAW, MAX_RAW_YAW)}
    after = {
        "sensing_contradiction_left": np.where(
            contradiction, MEMORY, np.where(accepted, np.maximum(before - 1, 0), before)
        ),
        "sensing_contradiction_confirmed": np.where(
            contradiction & (before > 0), 1.0, state["sensing_contradiction_confirmed"]
        ),
    }
    share, corrects = SCALE_SHARE, accepted
    if from_forces:
        watched, between, is_frozen = repeated_codes.next_state(
            "sensing", state, read, HALL, accepted, ready > 0, REPEATS
        )
        share, corrects = WATCHED * SCALE_SHARE, accepted & between
        confirmed = after["sensing_contradiction_confirmed"]
        after |= watched | {"sensing_contradiction_confirmed": np.where(is_frozen, 1.0, confirmed)}
    pace = np.where(ready > 0, share, 1.0) / (4 * k.power[0])
    after["sensing_scale"] = np.where(corrects, np.clip(scale - pace * (x.m + y.m), *SCALE), scale)
    e = np.where(ready > 0, out["phi_raw"] - predicted["phi"], 0)
    after |= {"sensing_phi_raw": out["phi_raw"], "sensing_innovation_phi": e} if from_forces else {}
    out |= {"measured": accepted} if from_forces else {}
    for name, value in (residuals | {"s_x": x.s, "s_y": y.s, "phi": phi}).items():
        after[f"sensing_first_{name}"] = np.where(contradiction & (before == 0), value, state[f"sensing_first_{name}"])
    for axis, pair in (("x", x), ("y", y)):
        offset = state[f"sensing_offset_{axis}"]
        expected = (
            np.clip(predicted[axis] - offset, -BRIDGED, BRIDGED) if from_forces else state[f"sensing_within_{axis}"]
        )
        bridge = expected + offset if from_forces else np.clip(predicted[axis], -FARTHEST, FARTHEST)
        out[f"{axis}_raw"] = np.where(accepted, pair.place + counted[axis], bridge)
        out[f"within_{axis}"] = np.where(accepted, pair.place, expected)
        after[f"sensing_offset_{axis}"] = np.where(accepted, counted[axis], offset)
        after |= {} if from_forces else {f"sensing_within_{axis}": out[f"within_{axis}"]}
    return out, after


def count_pitches(place: Array, offset: Array, predicted: Array) -> Array:
    """Return the whole pitches, m, that bring a place within the pitch nearest to the prediction, one more at most."""
    off = place + offset - predicted
    counted = offset + np.where(np.abs(off) > PITCH / 2, np.where(off > 0, -PITCH, PITCH), 0)
    return np.where(np.abs(counted) <= COUNT * PITCH, counted, offset)


def filter_positions(
    state: Columns, raw: Columns, ready: Array, k: Constants
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return the filtered x, y, phi and the filters' next states. Y(6)-(16)."""
    out, after = {}, {}
    for axis, fastest in FASTEST.items():
        measured = raw[f"{axis}_raw"]
        predicted = [state[f"filter_{axis}_{part}"] for part in "psh"]
        p, s, h = (v + K * (measured - predicted[0]) for v, K in zip(predicted, k.gain[axis], strict=True))
        next = [p + s + h, s + 2 * h, h]
        in_bounds = (ready > 0) & (np.abs(s + h) + np.abs(h) <= fastest * k.period_s)
        out[axis] = np.where(in_bounds, p, measured)
        at_rest = measured, np.zeros_like(measured), np.zeros_like(measured)
        for part, value, rest in zip("psh", next, at_rest, strict=True):
            after[f"filter_{axis}_{part}"] = np.where(in_bounds, value, rest)
    return out, after
