"""Fault campaign (fault injection, FMEA): every fault of an interface in closed loop, compared with the healthy run.

    excursion of q    max over t >= onset of |q(t) - q_healthy(t)|
    impact on q       largest speed into a stop of q, where the healthy run has no faster one
    time to notice    from the onset to the first fault bit that the healthy run does not have
    time to latch     from the onset to the latch; both times are inf where it does not happen

The plants are the nominal one and wrong ones, p (1 + tolerance s) with s of random signs first (corners) and later
uniform in -1 .. 1; plant number i is always the same. Positions without declared stops end at the plant's domain.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from synth.fault import LATCH_BIT
from synth.plant import Plant
from synth.progress import Counted, Progress
from synth.simulate import conditions, failure, injections
from synth.simulate.injections import Injection
from synth.simulate.rig import Rig
from synth.simulate.scenario import Array, Trajectory, sample_times

CORNERS, SEED = 8, 18  # wrong plants at corners of the tolerances before the first inside, and the seed of all
SWING = 0.2  # of the distance of a set-point from the nearer end of its range: amplitude of the default motion
AT_REST, IN_MOTION = "at rest", "in motion"
Values = Mapping[str, float]


@dataclass(frozen=True, eq=False)
class Condition:
    """Initial state, set-points (N,) and the samples at which faults begin."""

    name: str
    duration_s: float
    start: Values
    references: Mapping[str, Array]
    onsets: tuple[int, ...]


@dataclass(frozen=True)
class FaultRun:
    """A run with a fault beside the healthy run of the same plant, condition and noise.

    `named` says whether a fault bit names the faulty sensor before or at the latch, `wrong_names` which other sensors.
    Without `effect` neither a state nor a fault word differs.
    """

    injection: Injection
    condition: str
    plant: int
    onset_s: float
    excursion: Values
    impacts: Values
    notice_s: float
    latch_s: float
    named: bool
    wrong_names: tuple[str, ...]
    effect: bool

    @property
    def harms(self) -> bool:
        """Whether a position runs into a stop, or is not finite."""
        return any(self.impacts.values()) or not all(np.isfinite(list(self.excursion.values())))


@dataclass(frozen=True)
class HealthyRun:
    """A run without a fault: its samples with a fault bit, and impacts."""

    condition: str
    plant: int
    alarms: int
    impacts: Values


def plant_number(plant: Plant, i: int) -> Plant:
    """Return the nominal plant for i = 0, else wrong plant number i."""
    tolerances = {p.name: p.value * p.tolerance for p in plant.parameters if p.tolerance > 0}
    if i == 0 or not tolerances:
        return plant
    rng = np.random.default_rng([SEED, i])
    s = rng.choice((-1.0, 1.0), len(tolerances)) if i <= CORNERS else rng.uniform(-1, 1, len(tolerances))
    changes = dict(zip(tolerances, s * np.array(list(tolerances.values())), strict=True))
    return plant.with_parameters(**{n: plant.parameter(n).value + float(d) for n, d in changes.items()})


def velocities(plant: Plant) -> dict[str, str]:
    """Return the velocity of each position: the state that is its derivative in the model."""
    x, u, p = (ca.SX.sym(name, n) for name, n in zip("xup", map(plant.f.size1_in, range(3)), strict=True))
    f, states = ca.vertsplit(plant.f(x, u, p)), [s.name for s in plant.states]
    pairs = ((i, j) for i in range(len(states)) for j in range(len(states)) if ca.is_equal(f[i], x[j]))
    return {states[i]: states[j] for i, j in pairs}


def with_stops(rig: Rig) -> Rig:
    """Return the rig with velocities of all positions, and the plant's domain as stops where none are declared."""
    stage, plant = rig.stage, rig.stage.plant
    rates = velocities(plant) | dict(stage.velocities)
    domain = {s.name: (s.low, s.high) for s in plant.states if s.name in rates}
    return replace(rig, stage=replace(stage, velocities=rates, stops=domain | dict(stage.stops)))


def motion_and_standstill(rig: Rig) -> tuple[Condition, ...]:
    """Return the conditions of the stage's campaign; a stage without set-points has no motion."""
    campaign, period = rig.stage.faults, rig.period_s
    first = round(campaign.settle_s / period)
    still = Condition(AT_REST, campaign.settle_s + campaign.watch_s, {}, {}, (first,))
    if not rig.stage.interface.set_points:
        return (still,)
    onsets = tuple(first + round(i * campaign.period_s / campaign.onsets / period) for i in range(campaign.onsets))
    duration = onsets[-1] * period + campaign.watch_s
    courses = _motion(rig, sample_times(duration, period))
    return still, Condition(IN_MOTION, duration, _start(rig, courses), courses, onsets)


def _motion(rig: Rig, time: Array) -> dict[str, Array]:
    """Return the declared motion, or by default sines whose phases differ, from rest."""
    campaign, points = rig.stage.faults, rig.stage.interface.set_points
    if campaign.motion:
        return {name: conditions.values(course, time) for name, course in campaign.motion.items()}
    still, frequency = rig.at_rest(), 2 * np.pi / campaign.period_s
    sizes = {s.name: SWING * max(min(s.high - still[s.name], still[s.name] - s.low), 0.0) for s in points}
    return {name: still[name] + size * np.sin(frequency * time) for name, size in sizes.items()}


def _start(rig: Rig, courses: Mapping[str, Array]) -> dict[str, float]:
    sensors = {s.name: s.of for s in rig.stage.interface.sensors}
    positions = {s.name: sensors.get(s.of, s.of) for s in rig.stage.interface.set_points}
    states = [s.name for s in rig.plant.states]
    return {positions[name]: float(r[0]) for name, r in courses.items() if positions[name] in states}


def run(
    rig: Rig, plant: int, condition: Condition, progress: Progress, faults: Sequence[Injection] | None = None
) -> tuple[HealthyRun, list[FaultRun]]:
    """Run all faults, or some, in a condition on a plant, given by its number; `rig` is from `with_stops`.

    Raises SignalError and WiringError as `Rig.run`.
    """
    faulty = replace(rig, plant=plant_number(rig.plant, plant))
    healthy = faulty.run(condition.duration_s, condition.start, condition.references)
    runs: list[FaultRun] = []
    chosen = injections.derive(faulty) if faults is None else faults
    for k, injection in enumerate(chosen):
        if k == 0 or injection.target != chosen[k - 1].target:
            progress(Counted(f"faults of {injection.group} {injection.target}", k, len(chosen)))
        for onset in condition.onsets:
            fields = injections.scenario_fields(faulty, rig.stage.faults, injection, healthy, onset)
            trajectory = faulty.run(condition.duration_s, condition.start, condition.references, **fields)
            runs.append(_compare(faulty, plant, condition.name, injection, onset, healthy, trajectory))
    return HealthyRun(condition.name, plant, int(np.count_nonzero(healthy.faults)), healthy.impacts), runs


def _compare(
    rig: Rig, plant: int, condition: str, injection: Injection, onset: int, healthy: Trajectory, faulty: Trajectory
) -> FaultRun:
    words = faulty.faults & ~healthy.faults
    latch, notice = _first(words >> LATCH_BIT & 1), _first(words)
    notice_s, latch_s = (np.inf if k is None else (k - onset) * rig.period_s for k in (notice, latch))
    word = int(np.bitwise_or.reduce(words[: None if latch is None else latch + 1], initial=0))
    sensors = [name for name, bits in failure.bits(rig).items() if word & bits]
    states = rig.stage.velocities
    same = np.array_equal(healthy.faults, faulty.faults) and all(
        np.array_equal(healthy.states[s], faulty.states[s]) for s in healthy.states
    )
    return FaultRun(
        injection,
        condition,
        plant,
        onset * rig.period_s,
        {q: _largest(faulty.states[q] - healthy.states[q]) for q in states},
        {q: v if v > healthy.impacts[q] else 0.0 for q, v in faulty.impacts.items()},
        notice_s,
        latch_s,
        named=injection.target in sensors,
        wrong_names=tuple(s for s in sensors if s != injection.target),
        effect=not same,
    )


def _first(flags: NDArray[Any]) -> int | None:
    samples = np.flatnonzero(flags)
    return int(samples[0]) if samples.size else None


def _largest(difference: Array) -> float:
    largest = float(np.max(np.abs(difference)))
    return largest if np.isfinite(largest) else np.inf
