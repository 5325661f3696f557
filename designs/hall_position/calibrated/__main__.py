"""Print stages and survey of calibrated units: `python -m designs.hall_position.calibrated`.

An argument is the number of bodies of each case, 2,000 without it; cold starts have five times as many.
"""

import sys
from collections.abc import Sequence
from dataclasses import replace
from itertools import product

from designs.hall_position.calibrated import estimator, stages, survey
from designs.hall_position.calibrated.survey import Case
from designs.hall_position.protected import config, trust

UNITS = (("fabricated", 0), *(("built", seed) for seed in survey.SEEDS))
WIDE = 0.01  # drift of gains, for a second budget


def write(line: str) -> None:
    """Write a line at once: a case takes seconds."""
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def print_stages() -> None:
    """Print residuals, model error with the drift of gains, and position errors of each stage."""
    write("estimator, field, seed, stage: residual held out, model error with drift, mV; position um, yaw urad, rms")
    for name, (field, seed), stage in product(config.PLACES, UNITS, stages.STAGES):
        of = stages.of_unit(field, seed, stage, name)
        error = of.model_error(estimator.UNIFORM * estimator.GAIN_DRIFT)
        sizes = f"{1e3 * of.residual:6.2f} {1e3 * error:6.2f} {1e6 * of.position_error:6.1f} {1e6 * of.yaw_error:6.0f}"
        write(f"{name:20s} {field:10s} {seed:2d} {stage:10s} {sizes}")


def print_survey(cases: Sequence[Case], bodies: int) -> None:
    """Print the survey of cases, and their cold starts."""
    write("estimator, field, seed, stage, drift, motion, fault: valid %, valid and wrong % of samples, of bodies,")
    write("    rms/deviation, beyond 4 deviations %, largest um")
    for case in cases:
        name = f"{case.name:20s} {case.field:10s} {case.seed:2d} {case.stage:6s} {case.drift:g}"
        for speed in (0.0, trust.SPEED):
            for fault in trust.FAULTS:
                o = survey.run(case, fault, bodies, speed).outcome()
                shares = f"{100 * o.valid:7.2f} {100 * o.wrong:7.3f} {100 * o.wrong_bodies:7.3f}"
                sizes = f"{o.ratio:5.2f} {100 * o.beyond:6.3f} {1e6 * o.error:7.0f}"
                write(f"{name} {speed:4.1f} m/s {fault:15s} {shares} {sizes}")
        write(f"{name} cold start: {survey.cold_start(case, 5 * bodies)}")


def main(bodies: int) -> None:
    """Print the stages, then the survey of units with map, with waves alone, and with gains that drift further."""
    print_stages()
    cases = [Case(field, seed) for field, seed in UNITS]
    three = [replace(case, name=config.THREE) for case in cases]
    waves = [replace(case, stage="waves") for case in cases[:2]]
    drifted = [replace(cases[1], budget=WIDE, drift=WIDE), replace(cases[1], drift=WIDE)]
    print_survey([*cases, *waves, *drifted, *three], bodies)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 2000)
