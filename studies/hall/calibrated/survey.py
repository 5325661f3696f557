"""Survey of integrity of calibrated units: faults of a sensor, at rest and in motion, with gains that have drifted.

A unit is calibrated (`stages`), its estimator compiled (`estimator`), and run in its own field. Since the calibration
the amplitude has changed by +-10 %, and each gain by +-`drift`, both drawn for each body. The risk, the limit of the
table's steps and the table's spacing were chosen on the first two units of SEEDS and on the fabricated field; the last
unit was used to choose nothing.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import combinations, product

import numpy as np

from designs.hall_position.protected import config
from designs.hall_position.protected.parameters import Tuning
from models.hall_motions import Numbers, Pose
from studies.hall.calibrated import estimator, stages
from studies.hall.calibrated import unit as units
from studies.hall.calibrated.estimator import GAIN_DRIFT
from studies.hall.protected import cold_start as cold_starts
from studies.hall.protected import faults, trust
from studies.hall.protected.cold_start import ColdStart
from studies.hall.protected.trust import Outcome, Samples, World
from synth.base.cache import cached
from synth.check import Check
from synth.execute import host
from synth.simulate import worst_case
from synth.simulate.worst_case import Diagram

SEEDS = (11, 12, 13)  # of units as built: two for tuning, one to check it
COLD_SAMPLES = 125
STARTED = ("none", "dead voltage", "stuck sensor", "saturated")  # faults of the cold starts that are checked
BODIES, SPEEDS = 400, (0.0, trust.SPEED)  # of each case of the report, m/s
UNCALIBRATED = 2000  # bodies
BARS = {config.NAME: (2e-3, 0.99), config.THREE: (5e-3, 0.75)}  # samples valid and wrong, and valid without a fault
LEAST_RATIO, LARGEST_RATIO, BEYOND = 0.7, 1.5, 1e-3  # rms error over deviation; share of errors above 4 deviations


@dataclass(frozen=True)
class Case:
    """A unit by its field and seed, the stage of its calibration, the drift that R covers, and that of the gains."""

    field: str
    seed: int
    stage: str = stages.STAGES[-1]
    budget: float = GAIN_DRIFT
    drift: float = GAIN_DRIFT
    name: str = config.NAME


UNITS = {"fabricated": Case("fabricated", 0), "as built": Case("built", SEEDS[-1])}  # of the report


@cache
def compile_unit(
    field: str, seed: int, stage: str, budget: float, name: str = config.NAME
) -> tuple[host.Controller, Tuning]:
    """Return the C of a calibrated unit in single precision, and its tuning.

    It calls sinf and cosf of the C library: each unit has its own ranges, and no C of a unit is shipped.
    """
    block, tuning = estimator.of_unit(field, seed, stage, budget, name)
    return host.compile_block(block, np.float32, libm=True), tuning


def world(case: Case, bodies: int, rng: np.random.Generator, refused: Sequence[int] = ()) -> World:
    """Return bodies in the field of a unit, whose converters of the `refused` sensors give NaN."""
    unit = units.draw(case.field, case.seed, case.name)
    sensors = len(unit.bench.places)
    scale = 1 + trust.AMPLITUDE * rng.uniform(-1, 1, (bodies, 1, 1))
    scale = scale * (1 + case.drift * rng.uniform(-1, 1, (bodies, sensors, 2)))

    def read(pose: Pose) -> Numbers:
        V = scale * unit.read(np.column_stack([pose.X, pose.Y, pose.yaw]))
        V[:, list(refused)] = np.nan
        return np.asarray(V)

    return World(read, sensors)


@cache
@cached
def run(
    case: Case, fault: str, bodies: int, speed: float = 0.0, seed: int = 0, refused: tuple[int, ...] = ()
) -> Samples:
    """Return the samples after a fault, some sensors being `refused`; raise ModelError for an unknown fault."""
    rng = np.random.default_rng(seed)
    controller, tuning = compile_unit(case.field, case.seed, case.stage, case.budget, case.name)
    return trust.simulate(controller, tuning, world(case, bodies, rng, refused), fault, bodies, speed, rng)


def tuning(case: Case) -> Tuning:
    """Return the tuning of the estimator of a case."""
    return estimator.tuning(stages.of_unit(case.field, case.seed, case.stage, case.name), case.budget)


def tune_without_corrections(case: Case) -> Tuning:
    """Return the tuning with the R of the residuals in the model's waves, for voltages that are not corrected."""
    return tuning(replace(case, stage=stages.STAGES[0]))


def checks(progress: Callable[[str], None]) -> list[Check]:
    """Check deviations, availability, faults at rest and in motion, and cold starts of the units of the report.

    Without a calibration the deviations of four sensors and their cold starts are checked, and not what faults do:
    with the R of the unit's residuals in the model's waves, and with the one that ships, which serves every field.
    """
    made = []
    for (name, (wrong, valid)), (field, unit) in product(BARS.items(), UNITS.items()):
        case, what = replace(unit, name=name), f"{name}, {field}, calibrated"
        progress(what)
        by_fault = {f: [run(case, f, BODIES, speed).outcome() for speed in SPEEDS] for f in faults.FAULTS}
        none = by_fault.pop("none")
        least = min(o.valid for o in none)
        fault = max(by_fault, key=lambda f: max(o.wrong for o in by_fault[f]))
        most = max(o.wrong for o in by_fault[fault])
        made.append(Check(f"{what}: samples not valid without a fault", 1 - least, 1 - valid, "1"))
        made.append(Check(f"{what}: samples valid and wrong after a fault", most, wrong, "1", fault))
        made += [*_deviation_checks(what, none), yaw_check(what, none)]
        by_start = {f: cold_start(case, BODIES, f) for f in STARTED}
        fault = max(STARTED, key=lambda f: by_start[f].misled)
        made += _start_checks(what, list(by_start.values()), valid)
        made.append(
            Check(f"{what}: valid samples of cold starts that are wrong", by_start[fault].misled, wrong, "1", fault)
        )
    for name, case in UNITS.items():
        residuals, shipped = f"{config.NAME}, {name}, R of its residuals", f"{config.NAME}, {name}, not calibrated"
        for what, tuned in ((residuals, tune_without_corrections(case)), (shipped, config.USUAL)):
            progress(what)
            outcomes = [trust.run(tuned, case.field, "none", UNCALIBRATED, speed).outcome() for speed in SPEEDS]
            made += _deviation_checks(what, outcomes)
            started = cold_starts.run(tuned, case.field, UNCALIBRATED, COLD_SAMPLES)
            made += _start_checks(what, [started], BARS[config.NAME][1])
            made += [yaw_check(what, outcomes)] if what == residuals else []
    return made


def _deviation_checks(what: str, without_fault: Sequence[Outcome]) -> list[Check]:
    """Check that the errors are at most as large as the deviations say, and those of X and Y as large."""
    largest, least = max(max(o.ratio, o.yaw_ratio) for o in without_fault), min(o.ratio for o in without_fault)
    beyond = max(o.beyond for o in without_fault)
    return [
        Check(f"{what}: rms error over deviation of X, Y and yaw", largest, LARGEST_RATIO, "1"),
        Check(f"{what}: deviation over rms error of X and Y", 1 / max(least, 1e-9), 1 / LEAST_RATIO, "1"),
        Check(f"{what}: errors above 4 deviations", beyond, BEYOND, "1"),
    ]


def yaw_check(what: str, without_fault: Sequence[Outcome]) -> Check:
    """Check that the errors of the yaw are as large as the deviations say; an R for several fields is too wide."""
    least = min(o.yaw_ratio for o in without_fault)
    return Check(f"{what}: deviation over rms error of the yaw", 1 / max(least, 1e-9), 1 / LEAST_RATIO, "1")


def _start_checks(what: str, started: Sequence[ColdStart], valid: float) -> list[Check]:
    """Check cold starts, of which the first ones have no fault: of these, a share of `valid` becomes so, in time."""
    wrong, healthy = max(s.wrong for s in started), started[0]
    return [
        Check(f"{what}: cold starts a pitch off", wrong, 0, "1"),
        Check(f"{what}: cold starts that are never valid", 1 - healthy.valid, 1 - valid, "1"),
        Check(f"{what}: samples from init until valid", healthy.longest, cold_starts.SAMPLES, "1"),
    ]


def subsets() -> list[tuple[int, ...]]:
    """Return every set of sensors that may be refused, from none to all."""
    return [each for size in range(5) for each in combinations(range(4), size)]


def cold_start(case: Case, bodies: int, fault: str = "none", seed: int = 1) -> ColdStart:
    """Return the result from init of bodies at rest anywhere in the pitch; raise ModelError for an unknown fault."""
    rng = np.random.default_rng(seed)
    pose = cold_starts.in_pitch(bodies, rng)
    controller, _ = compile_unit(case.field, case.seed, case.stage, case.budget, case.name)
    return cold_starts.start(controller, world(case, bodies, rng), pose, COLD_SAMPLES, rng, fault)


def join(runs: Sequence[Samples]) -> Samples:
    """Return the samples of several runs side by side."""
    parts = ([getattr(r, n) for r in runs] for n in ("valid", "errors", "deviations", "levels"))
    return Samples(*(np.concatenate(part, axis=1) for part in parts))


def diagram(samples: Samples, limit: float, axis: int = 0) -> Diagram:
    """Return the Stanford diagram of X, or of another coordinate; lengths in mm, angles in mrad."""
    errors, levels = (1e3 * v[..., axis].ravel() for v in (samples.errors, samples.levels))
    return worst_case.diagram(errors, levels, samples.valid.ravel(), 1e3 * limit, "mrad" if axis == 2 else "mm")
