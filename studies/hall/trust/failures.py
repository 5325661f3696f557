"""Response of the estimate to a sensor failure: dead, saturated, NaN, weak or stuck, at rest and in motion.

    dead         both voltages of a sensor are 0 V            one axis     one of them is 0 V
    saturated    one is at the end of the converter           NaN          one is NaN
    stuck        one keeps its value                          weak         both are a tenth smaller
    none         no failure, for comparison

An invalid sample or a fault bit flags a failure: at once where the residual exceeds its limit,
which is a residual fault. Where a failure changes the voltages little, or they are consistent with a position nearby,
nothing is flagged. The error is then bounded by `Tuning.residual_limit` over the least slope. A sensor that is stuck
while the body is at rest is not detected, and does no harm before the body moves.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from designs.hall_position.glsdc import channels
from models import hall_motions as motions
from models import hall_two_waves
from models.hall_motions import Course, Limits, Numbers, Pose
from studies.hall.trust import estimator_ensemble
from studies.hall.trust.estimator_ensemble import EstimatorConfig
from synth import numeric
from synth.errors import ModelError
from synth.execute import host
from synth.simulate import sampling
from synth.simulate.sampling import Scores
from synth.statespace import readonly

MAX_DELAY = 5  # samples from a residual above its limit to the flag, at most
BEFORE, AFTER = 20, 40  # samples
WEAK_GAIN = 0.9
Samples = Sequence[tuple[host.Batch, Scores]]
Failing = Callable[[Numbers, Numbers], Numbers]  # a sensor's voltages (N, 2), and those before -> the failed ones


def _replace_first_axis(value: Numbers | float, volts: Numbers) -> Numbers:
    return np.column_stack([np.broadcast_to(value, len(volts)), volts[:, 1]])


FAILURES: MappingProxyType[str, Failing] = MappingProxyType(
    {
        "none": lambda now, before: now,
        "dead": lambda now, before: 0 * now,
        "one axis": lambda now, before: _replace_first_axis(0.0, now),
        "saturated": lambda now, before: _replace_first_axis(
            np.where(now[:, 0] < 0, -channels.SPAN, channels.SPAN), now
        ),
        "NaN": lambda now, before: _replace_first_axis(np.nan, now),
        "weak": lambda now, before: WEAK_GAIN * now,
        "stuck": lambda now, before: _replace_first_axis(before[:, 0], now),
    }
)


@dataclass(frozen=True)
class FailureResponse:
    """Shares of bodies with a failed sensor, and the errors of their estimates.

    Shares: `residual_exceeded` its limit, failure `flagged`, position `lock_lost`, estimate `valid` at the end, ever
    `misleading` (valid with an error above 10 standard deviations).
    `delay`: largest number of samples from the exceeded residual to the flag, AFTER without a flag. `rms_error_sigma`:
    rms error of the valid estimates in standard deviations; `max_valid_error`: the largest, m.
    """

    residual_exceeded: float
    flagged: float
    lock_lost: float
    delay: int
    valid: float
    rms_error_sigma: float
    max_valid_error: float
    misleading: float


def run_failure(
    config: EstimatorConfig, failure: str, sensor: int, bodies: int, within: Limits | None, seed: int = 0
) -> FailureResponse:
    """Simulate the failure of a sensor, numbered from 1, of bodies that move within limits or rest in the pitch.

    Raises ModelError for an unknown failure, a sensor that does not exist, or no body.
    """
    rng = np.random.default_rng(seed)
    if within:
        at = motions.random_course(config.array, estimator_ensemble.TIME, bodies, within, rng)
    else:
        at = motions.course_at_rest(motions.random_poses(config.array, bodies, motions.YAW, rng))
    return _outcome(config, _run(config, failure, sensor, at, rng))


def undetected_error(config: EstimatorConfig, failure: str, sensor: int, points: int, seed: int = 0) -> Numbers:
    """Return the error of the estimate, at rest, where the failure of a sensor is not flagged.

    In m, over X and Y of the pitch (points, points), at yaw 0; NaN where it is flagged.

    Raises ModelError for an unknown failure, a sensor that does not exist, or no point.
    """
    at = motions.course_at_rest(Pose(*hall_two_waves.poses(config.array.pitch, points)))
    samples = _run(config, failure, sensor, at, np.random.default_rng(seed))
    flagged = np.any([_is_flagged(batch) for batch, _ in samples[: MAX_DELAY + 1]], axis=0)
    return readonly(np.where(flagged, np.nan, samples[MAX_DELAY][1].error).reshape(points, points))


def _run(config: EstimatorConfig, failure: str, sensor: int, at: Course, rng: np.random.Generator) -> Samples:
    """Return the samples from the failure on."""
    if failure not in tuple(FAILURES):
        raise ModelError(f"'{failure}' is not a known failure: give one of {', '.join(FAILURES)}")
    numeric.whole("the number of the sensor that fails", sensor, 1, len(config.array.positions))
    fails, held = FAILURES[failure], np.zeros(0)

    def corrupt(k: int, volts: Numbers) -> Numbers:
        nonlocal held
        if k < BEFORE:
            held = volts[:, sensor - 1].copy()
        else:
            volts[:, sensor - 1] = fails(volts[:, sensor - 1], held)
        return volts

    state = estimator_ensemble.states_on_course(config, at)
    return list(estimator_ensemble.track(config, state, at, BEFORE + AFTER, rng, corrupt))[BEFORE:]


def _is_flagged(batch: host.Batch) -> NDArray[np.bool_]:
    """Return for each body whether the sample flags a failure."""
    return np.asarray((batch.outputs["valid"] == 0) | (batch.faults > 0))


def _outcome(config: EstimatorConfig, samples: Samples) -> FailureResponse:
    batches, each = zip(*samples, strict=True)
    scores, state = sampling.stack(each), batches[-1].states
    flag = _first_sample(np.array([_is_flagged(batch) for batch in batches]))
    exceeding = _first_sample(np.array([batch.outputs["residual"] > config.tuning.residual_limit for batch in batches]))
    exceeded, valid = exceeding < AFTER, scores.valid
    rms = np.sqrt((scores.deviations**2).mean(axis=1))
    return FailureResponse(
        residual_exceeded=float(exceeded.mean()),
        flagged=float((flag < AFTER).mean()),
        lock_lost=float((state["estimator_lock_lost"] > 0).mean()),
        delay=int((flag - exceeding)[exceeded].max(initial=0)),
        valid=float(valid[-1].mean()),
        rms_error_sigma=float(np.sqrt((rms[valid] ** 2).mean())) if valid.any() else 0.0,
        max_valid_error=float(scores.error[valid].max(initial=0)),
        misleading=float(scores.is_wrong.any(axis=0).mean()),
    )


def _first_sample(flags: NDArray[np.bool_]) -> NDArray[np.int_]:
    """Return the number of the first flagged sample (N,), AFTER where none is flagged."""
    return np.where(flags.any(axis=0), flags.argmax(axis=0), AFTER)
