"""Bench test of a Hall array: static voltages over a matrix as built, and identification of model (2) by scans.

    pose --> field as built --> 200 Hz filter, settled --> + noise --> converter --> model (2) by batch least squares

Source: Kawato, Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors", sections
2.C and 3.A.
"""

from dataclasses import dataclass, field
from functools import lru_cache
from string import ascii_lowercase

import casadi as ca
import numpy as np

from designs.hall_position.paper import scan_fit
from models import hall_chain, planar_stage
from models.hall_array import Pair
from models.hall_chain import Chain
from studies.hall import built_matrix
from studies.hall.built_matrix import Field, Mounting, Tolerances
from synth import numeric
from synth.base import column_maps
from synth.errors import ModelError
from synth.statespace import Array, readonly
from synth.synthesise.identify.logs import Log
from synth.timing import Discrete

POSE = ("x", "y", "phi")
SCANNED = 48  # places along a pitch
SPACING = 5e-5  # m, between samples of a scan
WAVER_AMPLITUDE, WAVER_LENGTH = 2e-4, 7.3e-3  # m, amplitude and wavelength of the lines of a scan


@dataclass(frozen=True, eq=False)
class Bench:
    """Sensors at `places` in m over blocks with tolerances, their signal chain, and how each sensor is mounted.

    Raises ModelError for invalid places, fewer than two, or more than `built_matrix.MAX_SENSORS`.
    """

    places: tuple[Pair, ...]
    tolerances: Tolerances = built_matrix.DEFAULT_TOLERANCES
    chain: Chain = field(default_factory=Chain)
    mountings: tuple[Mounting, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "places", numeric.positions(self.places, 2))
        numeric.whole("the number of places", len(self.places), 2, built_matrix.MAX_SENSORS)

    @property
    def true(self) -> Field:
        """The true field."""
        return built_matrix.field(self.tolerances)


def static_voltages(bench: Bench, poses: Array) -> Array:
    """Return the voltages (N, 2 sensors) at rest at poses (N, 3) of X, Y in m and the yaw in rad, without noise.

    Raises ModelError for poses of another shape, none, or with a sensor outside the known true field.
    """
    poses = numeric.table("the poses of X, Y and yaw", poses, len(POSE))
    X, Y, yaw = poses.T
    c, s = np.cos(yaw), np.sin(yaw)
    furthest = max(float(np.abs([X + c * x - s * y, Y + s * x + c * y]).max()) for x, y in bench.places)
    if furthest > built_matrix.MAX_REACH + built_matrix.TABLE_MARGIN:
        raise ModelError(
            f"a sensor comes {1e3 * furthest:.4g} mm from the origin: the true field is tabulated up to "
            f"{1e3 * (built_matrix.MAX_REACH + built_matrix.TABLE_MARGIN):.4g} mm: measure nearer"
        )
    return readonly(column_maps.map_columns(_voltages(bench), poses.T)[0].T)


@lru_cache(maxsize=32)
def _voltages(bench: Bench) -> ca.Function:
    """Return the voltages as a function of a pose; a simulation evaluates it at every sample."""
    x = {name: ca.SX.sym(name) if name in POSE else ca.SX(0) for name in planar_stage.AXES}
    volts = built_matrix.voltages(bench.true, bench.places, x, bench.chain.gain, bench.mountings)
    return ca.Function("volts", [ca.vcat([x[n] for n in POSE])], [ca.vcat(list(volts.values()))])


def sampled_voltages(bench: Bench, poses: Array, time: Discrete, seed: int) -> dict[str, Array]:
    """Return the converted voltages V_ax, V_ay, V_bx .. (N,), V, with the chain's noise at a sample time."""
    true, step = static_voltages(bench, poses).T, bench.chain.step
    noisy = true + hall_chain.noise(bench.chain, time, true.shape, seed)
    names = [f"V_{letter}{axis}" for letter in ascii_lowercase[: len(bench.places)] for axis in "xy"]
    return {name: readonly(step * np.rint(row / step)) for name, row in zip(names, noisy, strict=True)}


def scan(reach: float, line: float, together: int) -> Array:
    """Return poses (N, 3) without yaw, SPACING apart: from the origin to a corner, then along lines `line` m apart.

    The lines are slightly wavy, as no loop tracks them; N is a multiple of the samples averaged `together`.
    """
    across = np.arange(-reach, reach + line / 2, line)
    ends = np.array([(side * (-1) ** k * reach, y) for k, y in enumerate(across) for side in (-1, 1)])
    corners = np.vstack([np.zeros(2), ends])
    lengths = np.concatenate([[0], np.cumsum(np.abs(np.diff(corners, axis=0)).sum(axis=1))])
    at = np.arange(round(lengths[-1] / SPACING) // together * together) * SPACING
    X, Y = (np.interp(at, lengths, corners[:, k]) for k in (0, 1))
    return readonly(
        np.column_stack([X, Y + WAVER_AMPLITUDE * np.sin(2 * np.pi * at / WAVER_LENGTH), np.zeros(len(at))])
    )


def fits(bench: Bench, pitch: float, time: Discrete, seed: int = 1) -> list[scan_fit.Fit]:
    """Return the fit of model (2) for each channel, from scans over a pitch in m about the origin."""
    along = pitch * (np.arange(SCANNED) / SCANNED - 0.5)
    X, Y = (each.ravel() for each in np.meshgrid(along, along, indexing="ij"))
    volts = sampled_voltages(bench, np.column_stack([X, Y, np.zeros(X.size)]), time, seed)
    channel_fits = []
    for name, volt in volts.items():
        x, y = bench.places[ascii_lowercase.index(name[2])]
        log = Log({"X": readonly(X + x), "Y": readonly(Y + y), name: volt})
        channel_fits.append(scan_fit.fit(log, name, pitch, name[3].upper()))
    return channel_fits
