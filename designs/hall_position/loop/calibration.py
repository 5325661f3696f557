"""What is measured of a stage before its loop is closed: the field's model, and the map of the estimate's errors.

Both are measured of the truth field, at no yaw and so slowly that the filters do not lag: scans of the voltages over a
pitch give (2) by batch least squares, the mean over all channels; the laser gives where the platen was when the
estimator said where.

The noise of the array is the model's misfit: by it estimates settle, and their deviations are what they err by.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from string import ascii_lowercase

import casadi as ca
import numpy as np

from designs.hall_position.glsdc import estimator
from designs.hall_position.glsdc.parameters import Array, Pair
from designs.hall_position.loop import closed_loop, error_map
from designs.hall_position.loop.closed_loop import Source
from designs.hall_position.loop.error_map import Samples
from models import built_matrix, hall_chain, hall_scan, planar_stage
from models.built_matrix import Field, Tolerances
from models.hall_chain import Chain
from synth import numeric
from synth.block import unranged
from synth.blocks import lookup_table
from synth.emit.c import digits
from synth.errors import ModelError
from synth.execute import build, host
from synth.statespace import Array as Numbers
from synth.statespace import readonly
from synth.synthesise.identify.logs import Log
from synth.timing import Discrete

TIME = Discrete(1 / 800)
PITCH = closed_loop.PITCH
SCANNED = 48  # places along a pitch
DIGITS = 5  # of the field
MAPPED, CELL = 0.027, 1e-3  # m: to where, and by what spacing, the error is tabulated
BEYOND, LINE = 2.2e-3, 1e-3  # m: how far the samples go on, and how far their lines are apart
ASIDE, WAVER = 2e-4, 7.3e-3  # m: by how much lines waver, and over which way
STEP, READ = 5e-5, 8  # m between samples, of which so many are taken together
MOST = 8  # sensors that the true field is read at


@dataclass(frozen=True, eq=False)
class Bench:
    """A stage on the bench: the spread of its blocks, sensors at `places` in m, and what follows them.

    Raises ModelError for places that are none, fewer than two, or more than MOST.
    """

    spread: Tolerances = built_matrix.USUAL
    places: tuple[Pair, ...] = closed_loop.PLACES
    chain: Chain = field(default_factory=Chain)

    def __post_init__(self) -> None:
        object.__setattr__(self, "places", numeric.places(self.places, 2))
        numeric.whole("the number of places", len(self.places), 2, MOST)

    @property
    def true(self) -> Field:
        """The true field."""
        return built_matrix.field(self.spread)


def settled(bench: Bench, poses: Numbers) -> Numbers:
    """Return the voltages (N, 2 sensors) at rest at poses (N, 3) of X, Y in m and the yaw in rad, without noise.

    Raises ModelError for poses of another shape, none, or that take a sensor to where the true field is not known.
    """
    poses = numeric.table("the poses of X, Y and yaw", poses, 3)
    X, Y, yaw = poses.T
    c, s = np.cos(yaw), np.sin(yaw)
    furthest = max(float(np.abs([X + c * x - s * y, Y + s * x + c * y]).max()) for x, y in bench.places)
    if furthest > built_matrix.REACH + built_matrix.MARGIN:
        raise ModelError(
            f"a sensor comes {1e3 * furthest:.4g} mm from the origin: the true field is known to "
            f"{1e3 * (built_matrix.REACH + built_matrix.MARGIN):.4g} mm, measure nearer"
        )
    x = {name: ca.SX.sym(name) if name in closed_loop.HORIZONTAL else ca.SX(0) for name in planar_stage.AXES}
    volts = ca.vcat(list(built_matrix.voltages(bench.true, bench.places, x, bench.chain.gain).values()))
    of = ca.Function("volts", [ca.vcat([x[n] for n in closed_loop.HORIZONTAL])], [volts])
    return readonly(of.map(len(poses))(poses.T).full().T)


def read(bench: Bench, poses: Numbers, seed: int) -> dict[str, Numbers]:
    """Return what the converter reads of each voltage (N,), V, with the chain's noise."""
    true, step = settled(bench, poses).T, bench.chain.step
    noisy = true + hall_chain.noise(bench.chain, TIME, true.shape, seed)
    names = [f"V_{letter}{axis}" for letter in ascii_lowercase[: len(bench.places)] for axis in "xy"]
    return {name: readonly(step * np.rint(row / step)) for name, row in zip(names, noisy, strict=True)}


def fits(bench: Bench, seed: int = 1) -> list[hall_scan.Fit]:
    """Return model (2) of each channel, by scans over a pitch about the origin."""
    along = PITCH * (np.arange(SCANNED) / SCANNED - 0.5)
    X, Y = (each.ravel() for each in np.meshgrid(along, along, indexing="ij"))
    volts = read(bench, np.column_stack([X, Y, np.zeros(X.size)]), seed)
    found = []
    for name, volt in volts.items():
        x, y = bench.places[ascii_lowercase.index(name[2])]
        log = Log({"X": readonly(X + x), "Y": readonly(Y + y), name: volt})
        found.append(hall_scan.fit(log, name, PITCH, name[3].upper()))
    return found


def array(bench: Bench, scans: Sequence[hall_scan.Fit]) -> Array:
    """Return the array that the estimator is made for, of its channels' models."""
    c, alpha, beta = (
        digits.cut(float(np.mean([f.estimate[name] for f in scans])), DIGITS) for name in ("c", "alpha", "beta")
    )
    misfit = float(np.sqrt(np.mean([np.mean(f.residual**2) for f in scans])))
    return Array(bench.places, c, alpha, beta, PITCH, digits.cut(misfit, 2))


def samples(bench: Bench, source: Source, reach: float = MAPPED + BEYOND, line: float = LINE, seed: int = 2) -> Samples:
    """Return estimates beside the laser's places, means over READ samples on the way along lines `line` m apart.

    The platen comes from the origin, so that pitches are counted from there. Lines waver, as no loop follows them.

    Raises ModelError as `settled`.
    """
    way = _way(reach, line)
    poses = np.column_stack([way, np.zeros(len(way))])
    found = compiled(source).replay(read(bench, poses, seed)).outputs
    columns = np.stack([np.asarray(found[n], np.float64) for n in error_map.COORDINATES], axis=1)
    valid = np.asarray(found["valid"]).reshape(-1, READ).all(axis=1)
    estimated, true = (each.reshape(-1, READ, 3).mean(axis=1) for each in (columns, poses))
    return Samples(readonly(estimated[valid]), readonly(true[valid]))


def _way(reach: float, line: float) -> Numbers:
    """Return places (N, 2) in m, STEP apart: from the origin to a corner, then line by line to and fro."""
    across = np.arange(-reach, reach + line / 2, line)
    ends = np.array([(side * (-1) ** k * reach, y) for k, y in enumerate(across) for side in (-1, 1)])
    corners = np.vstack([np.zeros(2), ends])
    lengths = np.concatenate([[0], np.cumsum(np.abs(np.diff(corners, axis=0)).sum(axis=1))])
    at = np.arange(round(lengths[-1] / STEP) // READ * READ) * STEP
    X, Y = (np.interp(at, lengths, corners[:, k]) for k in (0, 1))
    return np.column_stack([X, Y + ASIDE * np.sin(2 * np.pi * at / WAVER)])


def compiled(source: Source) -> host.Controller:
    """Return the estimator of a source behind its guard, in single precision, with functions of libm."""
    return build.compiled(unranged(estimator.guarded(source.array, TIME, source.tuning)), np.float32, libm=True)


@cache
def calibrated(places: tuple[Pair, ...] = closed_loop.PLACES, spread: Tolerances = built_matrix.USUAL) -> Source:
    """Return the source of a stage, with its field measured and its errors mapped; raise ModelError as `Bench`."""
    bench = Bench(spread, places)
    plain = Source(array(bench, fits(bench)))
    return replace(plain, map=error_map.fit(samples(bench, plain), lookup_table.square(MAPPED, CELL)))
