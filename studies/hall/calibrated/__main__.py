"""Print stages and survey of calibrated units: `python -m studies.hall.calibrated`.

An argument is the number of bodies of each case, 2,000 without it; cold starts without a fault have five
times as many.
"""

import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product

from designs.hall_position.protected import config
from studies.hall.calibrated import estimator, stages, survey
from studies.hall.calibrated.survey import Case
from studies.hall.protected import faults, trust
from synth.base import progress

UNITS = (("fabricated", 0), *(("built", seed) for seed in survey.SEEDS))
WIDE = 0.01  # drift of gains, for a second budget


def stage_lines() -> Iterator[str]:
    """Yield residuals, model error with the drift of gains, and position errors of each stage."""
    yield "estimator, field, seed, stage: residual held out, model error with drift, mV; position um, yaw urad, rms"
    for name, (field, seed), stage in product(config.PLACES, UNITS, stages.STAGES):
        of = stages.of_unit(field, seed, stage, name)
        error = of.model_error(estimator.UNIFORM * estimator.GAIN_DRIFT)
        sizes = f"{1e3 * of.residual:6.2f} {1e3 * error:6.2f} {1e6 * of.position_error:6.1f} {1e6 * of.yaw_error:6.0f}"
        yield f"{name:20s} {field:10s} {seed:2d} {stage:10s} {sizes}"


def survey_lines(cases: Sequence[Case], bodies: int) -> Iterator[str]:
    """Yield the survey of cases, and their cold starts."""
    yield f"estimator, field, seed, stage, drift, motion, fault: {trust.OUTCOME}"
    for case in cases:
        name = f"{case.name:20s} {case.field:10s} {case.seed:2d} {case.stage:6s} {case.drift:g}"
        for speed in (0.0, trust.SPEED):
            for fault in faults.FAULTS:
                outcome = survey.run(case, fault, bodies, speed).outcome()
                yield f"{name} {speed:4.1f} m/s {fault:15s} {outcome}"
        for fault in faults.LASTING if case.stage == "map" else ("none",):
            count = (5 if fault == "none" else 1) * bodies
            yield f"{name} {count} cold starts, {fault:15s} {survey.cold_start(case, count, fault)}"


def uncorrected_lines(bodies: int) -> Iterator[str]:
    """Yield how the R of each unit's residuals suits voltages that are not corrected, without a fault."""
    yield f"field, seed, R of the residuals in mV, motion: {trust.OUTCOME}"
    for field, seed in UNITS:
        tuned = survey.tune_without_corrections(Case(field, seed))
        for speed in (0.0, trust.SPEED):
            outcome = trust.run(tuned, field, "none", bodies, speed).outcome()
            yield f"{field:10s} {seed:2d} {1e3 * tuned.model_error:5.1f} {speed:4.1f} m/s {outcome}"


def lines(bodies: int) -> Iterator[str]:
    """Yield the stages, then the survey of units with map, with waves alone, and with gains that drift further."""
    yield from stage_lines()
    yield from uncorrected_lines(bodies)
    cases = [Case(field, seed) for field, seed in UNITS]
    three = [replace(case, name=config.THREE) for case in cases]
    waves = [replace(case, stage="waves") for case in cases[:2]]
    drifted = [replace(cases[1], budget=WIDE, drift=WIDE), replace(cases[1], drift=WIDE)]
    yield from survey_lines([*cases, *waves, *drifted, *three], bodies)


if __name__ == "__main__":
    progress.write(lines(int(sys.argv[1]) if len(sys.argv) > 1 else 2000))
