"""Identification of model (2) of a voltage from scans by batch least squares, and decay of its coefficients.

    V_u = c + alpha sin(w X) + beta sin(5 w X) + gamma sin(w Y) + delta sin(5 w Y) + e,    w = 2 pi / l,

for a sensor's axis along X, and with X and Y exchanged for one along Y. Above the matrix the wave with number n decays
as exp(-n w z). For six degrees of freedom, at heights z about z_0, this gives

    alpha(z) = alpha exp(-w (z - z_0)),  beta(z) = beta exp(-5 w (z - z_0)),  gamma as alpha, delta as beta,  c is c.

Scans at several heights verify this: -d ln |alpha| / dz with its confidence interval.

The residual of (2) consists mostly of waves outside the model, (2, +-1) above all. It is repeatable, not noise. The
intervals treat it as independent errors: they state how well the data determine the coefficients. The map of the
residual shows the error of the model.

Source: Kawato, Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors", (2),
section 3.A, Fig. 8.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import pi

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from models import hall_array
from models.concentrated_field import Wave
from models.hall_array import HallArray
from synth import show
from synth.base import column_maps
from synth.errors import SignalError
from synth.signals import Parameter
from synth.statespace import readonly
from synth.synthesise.identify import identify, least_squares
from synth.synthesise.identify.estimates import Estimate
from synth.synthesise.identify.logs import Log

Array = NDArray[np.float64]

COEFFICIENTS = ("c", "alpha", "beta", "gamma", "delta")
NUMBERS = {"alpha": 1, "beta": 5, "gamma": 1, "delta": 5}
PARAMETERS = tuple(Parameter(name, 0.0, "V", 0.0, "(2)") for name in COEFFICIENTS)
ACROSS = {"X": "Y", "Y": "X"}


@show.with_repr
@dataclass(frozen=True, eq=False, repr=False)
class Fit:
    """Fit of model (2) to a channel: estimates in V with intervals, measured and modelled voltages (N,) in V.

    `X` and `Y` (N,), in m, are their positions: Fig. 8 (a), (b) and (c).
    """

    channel: str
    estimate: Estimate
    X: Array
    Y: Array
    measured: Array
    modelled: Array

    @property
    def residual(self) -> Array:
        """Return measured less modelled voltages (N,), V."""
        return readonly(self.measured - self.modelled)

    def sheet(self) -> show.Sheet:
        """Return the estimate, and where the largest residual is."""
        k, inner = int(np.abs(self.residual).argmax()), self.estimate.sheet()
        line = (
            f"The largest residual is {1e3 * self.residual[k]:.4g} mV, at X = {1e3 * self.X[k]:.4g} mm and "
            f"Y = {1e3 * self.Y[k]:.4g} mm."
        )
        return show.Sheet(f"Model (2) of {self.channel}", (line, *inner.lines), inner.tables)


@dataclass(frozen=True, eq=False)
class Decay:
    """Decay of a coefficient with the height: `estimate` of ln|a| at z_0, a in V, and of the rate in 1/m.

    `law` is the rate n w of the wave with number n, 1/m.
    """

    coefficient: str
    estimate: Estimate
    law: float


def places(pitch: float, points: int, heights: Sequence[float] = (hall_array.HEIGHT,)) -> dict[str, Array]:
    """Return a scan's X, Y, Z (N,) in m: a square grid over a pitch at each height in m."""
    along = pitch * np.arange(points) / points
    Z, X, Y = np.meshgrid(np.asarray(heights, dtype=np.float64), along, along, indexing="ij")
    return {"X": readonly(X.ravel()), "Y": readonly(Y.ravel()), "Z": readonly(Z.ravel())}


def simulate_scan(array: HallArray, waves: Sequence[Wave], at: Mapping[str, Array], seed: int) -> Log:
    """Return the log of a scan, with the body's origin at X, Y, Z (N,) in m without yaw or tilt, and the chain's noise.

    Channels are V_ax, V_ay, V_bx, .. for the axes u and v of each sensor, V.
    """
    poses = np.column_stack([at["X"], at["Y"], at["Z"], np.zeros((len(at["X"]), 3))])
    true = hall_array.spatial(array, waves).evaluate(poses).T
    noisy = true + array.chain.noise * np.random.default_rng(seed).standard_normal(true.shape)
    names = [f"V_{chr(ord('a') + k)}{axis}" for k in range(len(array.sensors)) for axis in "xy"]
    return Log({name: at[name] for name in ("X", "Y", "Z")} | dict(zip(names, noisy, strict=True)))


def fit(log: Log, channel: str, pitch: float, along: str = "X", level: float = 0.95) -> Fit:
    """Return the fit of model (2) to a channel with its axis along X or Y, from X, Y (m) and the channel (V) of a log.

    The pitch is in m.

    Raises SignalError for another axis or a signal that the log does not hold; ModelError naming coefficients that the
    scan does not determine, as with a line at one Y.
    """
    if along not in ACROSS:
        raise SignalError(f"the channel's axis is along '{along}': give X or Y")
    w = 2 * pi / pitch
    signals = {name: ca.SX.sym(name) for name in ("X", "Y", channel)}
    k = {name: ca.SX.sym(name) for name in COEFFICIENTS}
    u, v = signals[along], signals[ACROSS[along]]
    model: ca.SX = k["c"]
    for name, place in {"alpha": u, "beta": u, "gamma": v, "delta": v}.items():
        model += k[name] * ca.sin(NUMBERS[name] * w * place)
    estimate = identify.fit_linear({channel: model - signals[channel]}, signals, PARAMETERS, k, log, level=level)
    data = log.columns(tuple(signals))
    by_row = ca.Function("model", [ca.vcat(list(signals.values())), ca.vcat(list(k.values()))], [model])
    modelled = column_maps.map_columns(by_row, data.T, estimate.values)[0].ravel()
    X, Y, V = (log.samples[name] for name in ("X", "Y", channel))
    return Fit(channel, estimate, X, Y, V, readonly(modelled))


def decay(
    fits: Mapping[float, Fit], coefficient: str, pitch: float, height: float = hall_array.HEIGHT, level: float = 0.95
) -> Decay:
    """Return the decay of a coefficient, from fits by height in m: ln |a| = ln |a_0| - rate (z - height).

    Raises SignalError for c, which does not decay, an unknown coefficient, fewer than three heights, or a coefficient
    whose interval holds 0 at one of them, which leaves its logarithm undetermined.
    """
    if coefficient not in NUMBERS:
        raise SignalError(f"'{coefficient}' has no decay: give one of {', '.join(NUMBERS)}")
    if len(fits) < 3:
        raise SignalError(f"{len(fits)} heights do not determine a rate and its error: scan at three or more")
    for z, scan_fit in fits.items():
        low, high = scan_fit.estimate.intervals[COEFFICIENTS.index(coefficient)]
        if low <= 0 <= high:
            raise SignalError(
                f"{coefficient} of '{scan_fit.channel}' at {1e3 * z:.4g} mm is {scan_fit.estimate[coefficient]:.3g} V, "
                "not distinguishable from 0: leave that height out"
            )
    above = np.array(list(fits)) - height
    y = np.log(np.abs([scan_fit.estimate[coefficient] for scan_fit in fits.values()]))
    units = {"rate": "1/m"}
    estimate = least_squares.solve(
        np.column_stack([np.ones_like(above), -above]),
        y,
        ("ln_at_height", "rate"),
        ("ln_at_height",),
        None,
        level,
        units,
    )
    return Decay(coefficient, estimate, NUMBERS[coefficient] * 2 * pi / pitch)
