"""Print how often an estimate is valid, and valid and wrong: `python -m studies.hall.protected`.

Of three and of four sensors, and of two the cold starts. An argument is the number of bodies of each case, 4,000
without it; cold starts without a fault have five times as many.
"""

import sys
from collections.abc import Iterator

from designs.hall_position.protected import config
from studies.hall.protected import cold_start, faults, trust
from studies.hall.trust import starts
from synth.base import progress

UNCALIBRATED = (("built", config.USUAL), ("fabricated", config.USUAL))
ROWS = {
    config.NAME: (*UNCALIBRATED, ("calibrated", config.CALIBRATED)),
    config.THREE: (*UNCALIBRATED, ("calibrated", config.CALIBRATED_THREE), ("built", config.CALIBRATED_THREE)),
}


def lines(bodies: int) -> Iterator[str]:
    """Yield the tables of faults and of cold starts."""
    yield f"field, R in mV, motion, fault: {trust.OUTCOME}"
    for name in config.PLACES:
        yield name
        for field, tuning in ROWS[name]:
            case = f"{field:11s} {1e3 * tuning.model_error:3.0f}"
            for speed in (0.0, trust.SPEED):
                for fault in faults.FAULTS:
                    outcome = trust.run(tuning, field, fault, bodies, speed, name=name).outcome()
                    yield f"{case} {speed:4.1f} m/s {fault:15s} {outcome}"
            for fault in faults.LASTING:
                count = (5 if fault == "none" else 1) * bodies
                started = cold_start.run(tuning, field, count, name=name, fault=fault)
                yield f"{case} {count} cold starts, {fault:15s} {started}"
    yield f"two sensors in the field of the model, cold start: {starts.in_pitch(5 * bodies)}"


if __name__ == "__main__":
    progress.write(lines(int(sys.argv[1]) if len(sys.argv) > 1 else 4000))
