"""What becomes of the estimate when a sensor fails: dead, saturated, no number, or stuck, at rest and in motion.

    dead         both voltages of a sensor are 0 V            one axis     one of them is
    saturated    one is at the end of the converter           no number    one is NaN
    stuck        one stays as it was                       weak           both are a tenth smaller
    none         with which others are compared

A failure is flagged by a sample that is not valid, by a sensor that is left out, or by a fault bit: at once where the
residual exceeds its bound, as that is astray. Where the voltages hardly change by a failure, or agree with a place near
by, nothing is flagged: the estimate is off then by what residuals up to the bound allow, `Tuning.residual` over the
least slope. A sensor that is stuck while the body rests shows nothing, and does no harm before it moves.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from designs.hall_position.glsdc import channels
from designs.hall_position.trust import estimator_ensemble
from designs.hall_position.trust.estimator_ensemble import EstimatorConfig
from models import hall_motions as motions
from models import hall_two_waves
from models.hall_motions import Course, Limits, Numbers, Pose
from synth import numeric
from synth.errors import ModelError
from synth.execute import host
from synth.simulate import ensemble
from synth.simulate.ensemble import Scores
from synth.statespace import readonly

MAX_DELAY = 5  # samples within which a residual out of its bound is to be flagged
BEFORE, AFTER = 20, 40  # samples
WEAK = 0.9
Samples = Sequence[tuple[host.Batch, Scores]]
Failing = Callable[[Numbers, Numbers], Numbers]  # a sensor's voltages (N, 2), and those before: what is read


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
        "no number": lambda now, before: _replace_first_axis(np.nan, now),
        "weak": lambda now, before: WEAK * now,
        "stuck": lambda now, before: _replace_first_axis(before[:, 0], now),
    }
)


@dataclass(frozen=True)
class Outcome:
    """Of bodies with a failed sensor the shares whose residual was `out` of bound, `flagged`, `named` and `lost`.

    `late`: samples from the residual out of bound to the flag, at most, AFTER where it never came. `valid`: share of
    the estimates at the end. `error`: root mean square of the valid ones in deviations; `worst`: the largest, m.
    `away`: share of the bodies that were ever valid further off than 10 deviations.
    """

    residual_exceeded: float
    flagged: float
    isolated: float
    lost: float
    delay: int
    valid: float
    error: float
    worst: float
    misleading: float


def run_failure(
    kind: EstimatorConfig, failure: str, sensor: int, bodies: int, within: Limits | None, seed: int = 0
) -> Outcome:
    """Let a sensor, numbered from 1, of bodies fail that move within a limit, or rest anywhere in the pitch.

    Raises ModelError for an unknown failure, a sensor that is not there, or no body.
    """
    rng = np.random.default_rng(seed)
    if within:
        at = motions.random_course(kind.array, estimator_ensemble.TIME, bodies, within, rng)
    else:
        at = motions.course_at_rest(motions.random_poses(kind.array, bodies, motions.YAW, rng))
    return _outcome(kind, _run(kind, failure, sensor, at, rng), sensor)


def undetected_error(kind: EstimatorConfig, failure: str, sensor: int, points: int, seed: int = 0) -> Numbers:
    """Return by how much the estimate errs where the failure of a sensor of bodies at rest is not flagged.

    In m, over X and Y of the pitch (points, points), at yaw 0; NaN where it is flagged.

    Raises ModelError for an unknown failure, a sensor that is not there, or no point.
    """
    at = motions.course_at_rest(Pose(*hall_two_waves.poses(kind.array.pitch, points)))
    samples = _run(kind, failure, sensor, at, np.random.default_rng(seed))
    flagged = np.any([_is_flagged(batch) for batch, _ in samples[: MAX_DELAY + 1]], axis=0)
    return readonly(np.where(flagged, np.nan, samples[MAX_DELAY][1].off).reshape(points, points))


def _run(kind: EstimatorConfig, failure: str, sensor: int, at: Course, rng: np.random.Generator) -> Samples:
    """Return the samples from the failure on."""
    if failure not in tuple(FAILURES):
        raise ModelError(f"'{failure}' is no failure that is known: give one of {', '.join(FAILURES)}")
    numeric.whole("the number of the sensor that fails", sensor, 1, len(kind.array.positions))
    fails, held = FAILURES[failure], np.zeros(0)

    def spoilt(k: int, volts: Numbers) -> Numbers:
        nonlocal held
        if k < BEFORE:
            held = volts[:, sensor - 1].copy()
        else:
            volts[:, sensor - 1] = fails(volts[:, sensor - 1], held)
        return volts

    return list(
        estimator_ensemble.track(kind, estimator_ensemble.states_on_course(kind, at), at, BEFORE + AFTER, rng, spoilt)
    )[BEFORE:]


def _is_flagged(batch: host.Batch) -> NDArray[np.bool_]:
    """Tell of which bodies a sample shows that something is wrong."""
    left_out = batch.outputs.get("excluded_sensor", np.zeros(len(batch.states))) > 0
    return np.asarray((batch.outputs["valid"] == 0) | left_out | (batch.faults > 0))


def _outcome(kind: EstimatorConfig, samples: Samples, sensor: int) -> Outcome:
    batches, scores = zip(*samples, strict=True)
    judged, state = ensemble.stacked(scores), batches[-1].states
    flag = _first_sample(np.array([_is_flagged(batch) for batch in batches]))
    out = _first_sample(np.array([batch.outputs["residual"] > kind.tuning.residual_limit for batch in batches]))
    exceeded, valid = out < AFTER, judged.valid
    without = (
        state["estimator_excluded_sensor"]
        if "estimator_excluded_sensor" in (state.dtype.names or ())
        else np.zeros(out.size)
    )
    rms = np.sqrt((judged.deviations**2).mean(axis=1))
    return Outcome(
        residual_exceeded=float(exceeded.mean()),
        flagged=float((flag < AFTER).mean()),
        isolated=float((without == sensor).mean()),
        lost=float((state["estimator_lock_lost"] > 0).mean()),
        delay=int((flag - out)[exceeded].max(initial=0)),
        valid=float(valid[-1].mean()),
        error=float(np.sqrt((rms[valid] ** 2).mean())) if valid.any() else 0.0,
        worst=float(judged.off[valid].max(initial=0)),
        misleading=float(judged.wrong.any(axis=0).mean()),
    )


def _first_sample(flags: NDArray[np.bool_]) -> NDArray[np.int_]:
    """Return the first of AFTER samples that is flagged (N,), AFTER where none is."""
    return np.where(flags.any(axis=0), flags.argmax(axis=0), AFTER)
