"""Audit of what two sensors and a third one tell: lost rank, the worst deviations, what is absolute.

Deviations are as in `audit_accuracy`; the largest over the pitch are proved by `hall_fisher.worst`.
"""

from math import radians

import numpy as np

from designs.hall_position.accuracy import layouts
from designs.hall_position.paper import errors
from designs.hall_position.paper.stage import MM, NOISE, NUMBERS, POINTS, TOLERANCE, UM, Array, Stage, grid, worst
from models import concentrated_field, hall_accuracy, hall_correction, hall_fisher, hall_singular_points, hall_two_waves
from synth.report.audit import Outcome, Published, recomputes

FINE = 120  # places along a pitch of a map with more harmonics
TOLERANCES = {5: 0.1, 15: 0.25}  # relative, of proofs over yaws in degrees
TURNS = (0.0, 0.05, -0.7)  # rad
YAWS = (5.0, 15.0, 45.0)  # degrees
NEAR = (0.49712, 0.09771, 9.385)  # pitches, pitches and degrees: where three sensors nearly lose rank
LEVER = 50e-3  # m, by which a yaw counts as a displacement


@recomputes("K-13", *NOISE)
def sufficient(stage: Stage, printed: Published) -> Outcome:
    """Find the places at which two sensors do not tell X, Y and yaw."""
    at = {turn: hall_singular_points.of_pair(stage.pair, turn) for turn in TURNS}
    l = stage.pitch
    figures = [
        (f"singular points in a pitch, yaw {turn:.3g} rad", float(len(found)), "1") for turn, found in at.items()
    ]
    nearest = np.abs(at[0.0] - [l / 8, 3 * l / 8]).max(axis=1).min() if len(at[0.0]) else np.inf
    cell = hall_fisher.deviations(stage.pair, grid(stage.pair, POINTS))
    condition = hall_accuracy.of_sensors(
        errors.sensors(stage.pair, stage.chain), _model(stage), hall_two_waves.poses(l, 60).T, LEVER
    ).condition
    figures += [
        ("from the nearest of them to (1/8, 3/8) pitch", float(nearest) / UM, "um"),
        (
            "part of the pitch where X or Y deviates by more than 10 um",
            100 * float(np.mean(cell[:2].max(axis=0) > 10 * UM)),
            "%",
        ),
        ("condition number, yaw times 50 mm, least", float(condition.min()), "1"),
        ("condition number, yaw times 50 mm, median", float(np.median(condition)), "1"),
    ]
    return Outcome(figures, not any(len(found) for found in at.values()))


@recomputes("K-14", *NOISE)
def redundant(stage: Stage, printed: Published) -> Outcome:
    """Recompute the worst deviations with a third sensor, and of layouts that were searched for."""
    figures, proved = [], worst(stage.three, 0.0, 0.0, TOLERANCE)
    for name, value, unit in zip(("X", "Y", "yaw"), proved.met, ("um", "um", "urad"), strict=True):
        figures.append((f"three sensors, yaw 0, largest of {name}", value / UM, unit))
    ninth = with_ninth(stage)
    figures += [
        (f"the same with the 9th harmonic, {name}", float(v) / UM, "um") for name, v in zip("XY", ninth, strict=False)
    ]
    for turn in YAWS:
        found = worst(stage.three, radians(turn), radians(turn), 10 * TOLERANCE).met
        figures.append((f"larger of X and Y, yaw {turn:g} degrees", float(found[:2].max()) / UM, "um"))
    near = hall_fisher.deviations(stage.three, _near(stage))[:, 0]
    figures += [("X near the lost rank, yaw 9.385 degrees", float(near[0]) / UM, "um")]
    for turn, places in layouts.LAYOUTS.items():
        tolerance = TOLERANCES[turn]
        bound = worst(stage.array(places), -radians(turn), radians(turn), tolerance).bound
        figures.append(
            (f"searched layout, yaw up to {turn} degrees, X or Y at most", float(bound[:2].max()) / UM, "um")
        )
    two, three = (np.hypot(*errors.by_waves(stage, of)) for of in (stage.pair, stage.three))
    for name, off in (("two", two), ("three", three)):
        figures.append((f"error by the field, rms, {name} sensors", errors.rms(off) / MM, "mm"))
    figures += [("error by the field, largest, three sensors", float(three.max()) / MM, "mm")]
    better = bool(np.isfinite(proved.bound).all()) and errors.rms(three) < errors.rms(two)
    return Outcome(figures, better)


@recomputes("K-15", *NOISE)
def absolute(stage: Stage, printed: Published) -> Outcome:
    """Recompute by what voltages change when a body is moved by a pitch or turned with its place by a quarter."""
    rng = np.random.default_rng(0)
    q = np.vstack([rng.uniform(0, stage.pitch, (2, 200)), rng.uniform(-np.pi, np.pi, 200)])
    moves = {
        "moved by a pitch": q + np.array([[stage.pitch], [0.0], [0.0]]),
        "turned by 90 degrees about a strong block": np.vstack([-q[1], q[0], q[2] + np.pi / 2]),
        "turned by 180 degrees about a strong block": np.vstack([-q[0], -q[1], q[2] + np.pi]),
        "turned by 45 degrees about itself": q + np.array([[0.0], [0.0], [np.pi / 4]]),
    }
    changes = {name: float(np.abs(_read(stage, at) - _read(stage, q)).max()) for name, at in moves.items()}
    figures = [(f"largest change of a voltage, {name}", v, "V") for name, v in changes.items()]
    same = [changes[n] < 1e-9 for n in moves]
    return Outcome(figures, not any(same), same == [True, True, True, False])


def with_ninth(stage: Stage, points: int = FINE) -> Array:
    """Return the largest deviations of X, Y and yaw of all sensors at yaw 0, the 9th harmonic included."""
    waves = stage.waves(concentrated_field.on_axes((1, 5, 9)))
    of = errors.sensors(stage.three, stage.chain)
    at = hall_two_waves.poses(stage.pitch, points).T
    return hall_accuracy.of_sensors(of, waves, at, hall_accuracy.spread(of), stage.height).deviations.max(axis=0)


def _model(stage: Stage) -> tuple[concentrated_field.Wave, ...]:
    sizes = dict(zip(NUMBERS, stage.amplitudes(NUMBERS).tolist(), strict=True))
    return concentrated_field.fitted(sizes, stage.height, concentrated_field.values())


def _read(stage: Stage, q: Array) -> Array:
    """Return what three sensors read in the body (2, sensors, N) at q (3, N), V."""
    return hall_correction.turned(hall_correction.volts(stage.three, q), -q[2])


def _near(stage: Stage) -> Array:
    X, Y, turn = NEAR
    return np.array([[X * stage.pitch], [Y * stage.pitch], [radians(turn)]])
