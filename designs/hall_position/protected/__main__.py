"""Print how often an estimate is valid, and valid and wrong: `python -m designs.hall_position.protected`.

Of three and of four sensors. An argument is the number of bodies of each case, 4,000 without it; cold starts have five
times as many.
"""

import sys

from designs.hall_position.protected import config, trust

UNCALIBRATED = (("built", config.USUAL), ("fabricated", config.USUAL))
ROWS = {
    config.NAME: (*UNCALIBRATED, ("calibrated", config.CALIBRATED)),
    config.THREE: (*UNCALIBRATED, ("calibrated", config.CALIBRATED_THREE), ("built", config.CALIBRATED_THREE)),
}


def write(line: str) -> None:
    """Write a line at once: a case takes seconds."""
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def main(bodies: int) -> None:
    """Print the tables of faults and of cold starts."""
    write("field, R in mV, motion, fault: valid %, valid and wrong % of samples, of bodies,")
    write("    rms/deviation, beyond 4 deviations %, largest um")
    for name in config.PLACES:
        write(name)
        for field, tuning in ROWS[name]:
            for speed in (0.0, trust.SPEED):
                for fault in trust.FAULTS:
                    o = trust.run(tuning, field, fault, bodies, speed, name=name).outcome()
                    case = f"{field:11s} {1e3 * tuning.model_error:3.0f} {speed:4.1f} m/s {fault:15s}"
                    shares = f"{100 * o.valid:7.2f} {100 * o.wrong:7.3f} {100 * o.wrong_bodies:7.3f}"
                    write(f"{case} {shares} {o.ratio:5.2f} {100 * o.beyond:6.3f} {1e6 * o.error:7.0f}")
        for field, tuning in ROWS[name]:
            write(f"cold start, {field}: {trust.cold_start(tuning, field, 5 * bodies, name=name)}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 4000)
