"""Hall channel failures (stuck, zero, NaN), at rest and in motion: detection, isolation, and the consequences.

Each of the six channels fails alone, FAILURE seconds after the start, with noise. An experiment covers one kind of
failure. Its trajectory is that of the run with the largest excursion before the currents are switched off. Experiments
from START report each channel, a survey over PLACES reports counts. After the latch the currents may change by at most
SLEW.

Within ISOLATION_LIMIT samples of the first residual out of bounds, the failed channel is isolated (named in the fault
word), alone or with others that could cause the same residuals, or the controller brakes, or has latched where it does
not brake: a platen that a failure carries away may tilt until the lasers are out of range. The latch follows within
BAD_SAMPLES - 1 more samples and those of braking. A failure without such a residual is not detected; its share is
reported.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from designs.planar_6dof import interface
from designs.planar_6dof.loop import Array, measured_positions
from models import hall_calibration, hall_contradictions, planar_stage
from models import hall_sections as sensing
from synth.check import Check
from synth.fault import BRAKING_BIT
from synth.simulate import failure
from synth.simulate.experiment import Experiment
from synth.simulate.experiments import Run
from synth.simulate.failure import Failure
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory, sample_times

Place = Mapping[str, float]

FAILURE, DURATION, MOVES = 0.3, 1.3, 0.1  # s: from MOVES on the set-points move
START = {"x": 0.009, "y": 0.005}  # m: a place at which no channel reads zero
REST = {"x": 0.0, "y": 0.0}  # m/s
SPEED = {"x": 0.020, "y": 0.015}  # m/s, in motion
PLACES = 12  # of a survey, spread over a pitch; the platen leaves each in another direction
SPEEDS = (0.0, 0.02, 0.08)  # m/s, of a survey
HALL = planar_stage.HALL
SLEW = interface.SLEW * (1 + 1e-5)  # A/s: single precision of 1.26 A over a sample
ISOLATION_LIMIT = 5  # samples
FAULT_VALUES = {"nan": np.nan, "zero": 0.0, "stuck": None}
FAULT_TEXTS = {"nan": "reads NaN", "zero": "drops to zero", "stuck": "sticks"}


@dataclass(frozen=True, eq=False)
class Failed:
    """A failure of a channel, and the samples from it to the first residual out of bounds, None without one.

    Only residuals before the latch count, and only while no channel is named. The controller brakes for `braking`
    samples before the latch.
    """

    failure: Failure
    contradicted: int | None
    braking: int

    @property
    def others(self) -> tuple[str, ...]:
        """The sound Hall channels that are named before the latch."""
        return tuple(name for name in self.failure.misidentified_sensors if name in HALL)

    @property
    def samples_to_braking(self) -> int | None:
        """Samples from the failure until it brakes, None if it does not before the latch."""
        return self.failure.first(self.failure.words >> BRAKING_BIT & 1)

    @property
    def samples_to_reaction(self) -> int | None:
        """Samples from the failure until it brakes, or until it latches where it does not brake."""
        return self.samples_to_braking if self.braking else self.failure.samples_to_latch

    @property
    def isolation_delay(self) -> float:
        """Samples from the first residual out of bounds to the channel's name or the reaction, inf without both.

        A reaction does not count when only sound channels are named.
        """
        if self.contradicted is None:
            return 0.0
        answers = [self.failure.samples_to_detection, None if self.others else self.samples_to_reaction]
        return min((float(n - self.contradicted) for n in answers if n is not None), default=np.inf)

    @property
    def latch_delay(self) -> float:
        """Samples from the first residual out of bounds to the latch, without those of braking; inf without a latch."""
        if self.contradicted is None:
            return 0.0
        return _or_never(self.failure.samples_to_latch) - self.braking - self.contradicted

    @property
    def coasting_speed(self) -> float:
        """Speed of the coasting platen at the end, m/s; 0 without a latch."""
        run = self.failure.run
        return 0.0 if self.failure.samples_to_latch is None else float(np.hypot(run["vx"][-1], run["vy"][-1]))


def fail(loop: Rig, channel: str, kind: str, start: Place = START, speed: Place = REST) -> Failed:
    """Run the stage with a channel that fails permanently after FAILURE seconds, at a `speed` in m/s."""
    moving_s = np.maximum(sample_times(DURATION, loop.period_s) - MOVES, 0.0)
    references = {f"{axis}_ref": at + speed[axis] * moving_s for axis, at in start.items()}
    f = failure.fail(loop, channel, FAULT_VALUES[kind], FAILURE, DURATION, references, start)
    beyond = (residuals(loop, f.run) > 1) & (np.arange(len(moving_s)) >= f.sample)
    return Failed(f, f.first(beyond[: len(f.words)]), loop.stage.interface.braking)


def residuals(loop: Rig, run: Trajectory) -> Array:
    """Return rho (N,) of `hall_sections`, 0 once the fault word names a channel."""
    measured, A = measured_positions(loop, run), hall_calibration.of(loop.plant).amplitude
    bounds = {
        s.name: hall_contradictions.EXCESS_BOUND * A**2 if s.unit == "V^2" else hall_contradictions.RESIDUAL_BOUND * A
        for s in sensing.RESIDUALS
    }
    rho = np.sqrt(np.sum([(measured[name] / bound) ** 2 for name, bound in bounds.items()], axis=0))
    bits = failure.bits(loop)
    return np.where(run.faults & np.bitwise_or.reduce([bits[name] for name in HALL]), 0.0, rho)


def _by_channel(loop: Rig, name: str, kind: str, moving: bool) -> Experiment:
    """Return the experiment of one kind of failure over all channels."""
    runs = [fail(loop, channel, kind, START, SPEED if moving else REST) for channel in HALL]
    title = f"A Hall channel {FAULT_TEXTS[kind]} {'in motion' if moving else 'at rest'}"
    about = f"each of six channels by itself after {FAILURE:g} s; shown is "
    return _experiment(name, title, about, runs, _figures(runs), checks(runs, kind, moving))


def _experiment(
    name: str, title: str, about: str, runs: Sequence[Failed], figures: Mapping[str, float], checks: Sequence[Check]
) -> Experiment:
    worst = max((f.failure for f in runs), key=lambda f: f.excursion)
    return Experiment(name, title, about + worst.sensor, worst.run, ("x", "y", "phi"), {}, figures, tuple(checks))


def _figures(runs: Sequence[Failed]) -> dict[str, float]:
    figures: dict[str, float] = {}
    for each in runs:
        f = each.failure
        figures |= {
            f"samples until {f.sensor} is contradicted": _or_never(each.contradicted),
            f"samples until {f.sensor} is named": _or_never(f.samples_to_detection),
            **({f"samples until it brakes, {f.sensor}": _or_never(each.samples_to_braking)} if each.braking else {}),
            f"samples until the latch, {f.sensor}": _or_never(f.samples_to_latch),
            f"sound channels named, {f.sensor}": len(each.others),
            f"largest excursion before the latch, {f.sensor}, um": 1e6 * f.excursion,
            f"coasts at, {f.sensor}, mm/s": 1e3 * each.coasting_speed,
        }
    return figures


def _or_never(samples: int | None) -> float:
    return np.inf if samples is None else float(samples)


def checks(runs: Sequence[Failed], kind: str, moving: bool) -> list[Check]:
    """Return the checks of every failure; each must be detected except a stuck channel at rest."""
    each = [f.failure for f in runs]
    early = max(int(np.count_nonzero(f.run.faults[: f.sample])) for f in each)
    rows = [
        Check("samples with a fault before the failure", float(early), 0.0, "1"),
        _slew_check(runs),
        Check("current left at the end after a latch", max(f.final_command() for f in each), 0.0, "A"),
    ]
    if kind == "nan":
        return [*rows, *_latch_checks(runs)]
    rows.extend(_isolation_checks(runs))
    if kind == "zero" or moving:
        undetected = float(sum(f.samples_to_latch is None for f in each))
        rows.append(Check("channels whose failure is not noticed", undetected, 0.0, "1", "in 1 s"))
    return rows


def _latch_checks(runs: Sequence[Failed]) -> list[Check]:
    limit, late = interface.BAD_SAMPLES - 1.0, max(_or_never(f.failure.samples_to_latch) - f.braking for f in runs)
    checks = [Check("samples until the latch", late, limit, "1", "without those of braking; every channel")]
    if braked := [_or_never(f.samples_to_braking) for f in runs if f.braking]:
        checks.append(Check("samples until it brakes", max(braked), limit, "1", "every channel"))
    return checks


def _slew_check(runs: Sequence[Failed]) -> Check:
    fastest = max(f.failure.max_slew_rate() for f in runs)
    return Check("change of a current from the latch on", fastest, SLEW, "A/s", "declared: 126")


def _isolation_checks(runs: Sequence[Failed]) -> list[Check]:
    of = "samples from a residual out of bounds to the"
    slowest, latest = max(f.isolation_delay for f in runs), max(f.latch_delay for f in runs)
    limit = ISOLATION_LIMIT + interface.BAD_SAMPLES - 1.0
    return [
        Check(f"{of} channel's name, braking or the latch", slowest, ISOLATION_LIMIT, "1"),
        Check(f"{of} latch", latest, limit, "1", "without those of braking"),
    ]


@cache
def places() -> tuple[tuple[Place, Place], ...]:
    """Return PLACES starts in m with directions, a low-discrepancy sequence over a pitch and a turn (Roberts)."""
    pitch, pairs = planar_stage.plant().parameter("l").value, []
    for n in range(PLACES):
        x, y, turn = ((0.5 + n * step) % 1 for step in (0.7548776662466927, 0.5698402909980532, 0.6180339887498949))
        start = {"x": (0.8 * x - 0.4) * pitch, "y": (0.8 * y - 0.4) * pitch}
        pairs.append((start, {"x": float(np.cos(2 * np.pi * turn)), "y": float(np.sin(2 * np.pi * turn))}))
    return tuple(pairs)


def survey(loop: Rig, name: str, kind: str, speeds: Sequence[float] = SPEEDS) -> Experiment:
    """Return the survey of one kind of failure over all channels, places and speeds in m/s."""
    runs = [
        fail(loop, channel, kind, start, {axis: v * part for axis, part in way.items()})
        for channel in HALL
        for start, way in places()
        for v in speeds
    ]
    detected = [f for f in runs if f.contradicted is not None]
    isolated = [f for f in detected if f.failure.samples_to_detection is not None]
    latched_otherwise = [f.failure for f in runs if f.contradicted is None and f.failure.samples_to_latch is not None]
    undetected = [f.failure.excursion for f in runs if f.failure.samples_to_latch is None]
    figures = {
        "runs": float(len(runs)),
        "with a residual out of its bound, %": 100 * len(detected) / len(runs),
        "latched by other means alone, %": 100 * len(latched_otherwise) / len(runs),
        "of those detected, the channel is named, %": 100 * len(isolated) / len(detected),
        "of those detected, it is named alone, %": 100 * sum(not f.others for f in isolated) / len(detected),
        "sound channels named beside it, mean": float(np.mean([len(f.others) for f in isolated])),
        "largest excursion of undetected failures, um": 1e6 * max(undetected, default=0.0),
    }
    at = ", ".join(f"{1e3 * v:g}" for v in speeds)
    about = f"each channel at {PLACES} places, at {at} mm/s; shown is "
    title = f"A Hall channel {FAULT_TEXTS[kind]}, anywhere"
    return _experiment(name, title, about, runs, figures, (*_isolation_checks(runs), _slew_check(runs)))


ALL = (
    *(
        Run(f"{kind}_{'moving' if moving else 'resting'}", partial(_by_channel, kind=kind, moving=moving))
        for moving in (False, True)
        for kind in FAULT_VALUES
    ),
    *(Run(f"{kind}_anywhere", partial(survey, kind=kind)) for kind in ("zero", "stuck")),
)
