"""Random motion without end: how fast a body may be, by derivation, and that the estimate stays with it.

A sample expects the last motion m, m <- m + follow e, e = d - m the correction, in rad of phase of the sensors' centre.

    speed           m is kept within reach / 2 along each axis:                 w v T <= reach / 2
    acceleration    e <- (1 - follow) e + w a T^2, so that |e| <= w |a| T^2 / follow, and a motion from a certain place
                    is one that a body makes while alpha sqrt(damping) |e| <= surprise deviation

For 800 Hz and the tuning that ships the first is 3.23 m/s along each axis. Of the second, 77.9 m/s^2 in the plane,
MARGIN is left to the noise and to yaws, which move the sensors by their mean arm: 39.0 m/s^2. At all of it one body in
fifty is lost with three sensors in 1500 samples.
"""

from dataclasses import dataclass, replace
from math import sqrt

import numpy as np

from designs.hall_position.glsdc import tracking
from designs.hall_position.trust import estimator_ensemble
from designs.hall_position.trust.estimator_ensemble import EstimatorConfig
from models import hall_motions as motions
from models.hall_motions import Limits
from synth.check import Check

MARGIN = 0.5  # of the acceleration
PITCHES = 1000  # pitches: motions at the limits lead further than what ships counts
MAX_ERROR = 1e-4  # m: ten deviations at the worst place where an estimate is valid
SLOWEST = 1e-3  # part of the speed: bodies creep as well
PART = 0.95  # of the yaws that are declared


@dataclass(frozen=True)
class Endurance:
    """What came of so many samples: the shares that are valid, and of bodies that have `lost` their place.

    `wrong` were valid elsewhere; `worst` is the largest error of the valid ones, m, `off` of all, within the pitch.
    """

    limits: Limits
    samples: int
    valid: float
    lost: float
    wrong: int
    worst: float
    off: float


def checks(name: str, kind: EstimatorConfig, bodies: int, samples: int) -> list[Check]:
    """Check that no body is lost, and none wrong, within the limits."""
    outcome = run(kind, bodies, samples, limits(kind))
    within = f"{outcome.limits.speed:.3g} m/s, {outcome.limits.acceleration:.3g} m/s^2, {outcome.samples} samples"
    about = f"{within}, {100 * outcome.valid:.3g} % valid"
    what = f"{name}, random motion"
    return [
        Check(f"{what}: bodies lost", outcome.lost, 0, "1", about),
        Check(f"{what}: samples valid elsewhere", outcome.wrong, 0, "1", about),
        Check(f"{what}: worst valid position", outcome.worst, MAX_ERROR, "m", about),
    ]


def limits(kind: EstimatorConfig) -> Limits:
    """Return how fast the sensors' centre may be, with MARGIN."""
    t, a, T = kind.tuning, kind.array, estimator_ensemble.TIME.period_s
    e = t.innovation_gate_sigma * a.deviation / (a.alpha * sqrt(t.damping))
    speed, acceleration = (
        t.max_phase_step / 2 / (a.wave_number * T),
        (1 - MARGIN) * t.velocity_gain * e / (a.wave_number * T**2),
    )
    return Limits(speed, acceleration, PART * tracking.valid_yaw_limit(a, t))


def run(kind: EstimatorConfig, bodies: int, samples: int, within: Limits, seed: int = 0) -> Endurance:
    """Run so many bodies for so many samples on random motions within a limit; pitches are counted to FAR.

    Half of the bodies come to the limit, the others to parts of it that are drawn down to SLOWEST.

    Raises ModelError for no sample, and as `motions.sines`.
    """
    kind = replace(kind, tuning=replace(kind.tuning, pitches=PITCHES))
    rng = np.random.default_rng(seed)
    at = motions.random_course(kind.array, estimator_ensemble.TIME, bodies, within, rng, SLOWEST)
    state = estimator_ensemble.states_on_course(kind, at)
    valid = wrong = 0
    worst = off = 0.0
    for batch, seen in estimator_ensemble.track(kind, state, at, samples, rng):
        state = batch.states
        valid, wrong = valid + int(seen.valid.sum()), wrong + int(seen.wrong.sum())
        worst, off = max(worst, float(seen.off[seen.valid].max(initial=0))), max(off, float(seen.off.max()))
    lost = float((state["estimator_lock_lost"] > 0).mean())
    return Endurance(within, bodies * samples, valid / (bodies * samples), lost, wrong, worst, off)
