"""Fault campaign (fault injection, FMEA): every fault of an interface in closed loop, compared with the healthy run.

    excursion of q    max over t >= onset of |q(t) - q_healthy(t)|
    impact on q       largest speed v at which q hits a stop; 0 unless it exceeds that of the healthy run
    energy of it      J v^2 / 2 with the declared mass or moment of inertia J of q
    speed of q        max over t from the latch on of |dq/dt|, 0 without a latch; the final speed is that at the end
    time to notice    detection time, from the onset to the first fault bit that the healthy run does not have
    time to latch     from the onset to the latch; a time is inf if there is no such bit or no latch

Plant 0 is the nominal one, the others are sampled. Positions without declared stops have stops at the
limits of the plant's domain.

Sweeps of a fault campaign on the nominal plant: smallest magnitude noticed, and fault-tolerant time interval.

    noticed    the smallest magnitude of 1, 1/2, 1/4, ... of the range such that it and all larger ones set a fault bit
    harmful    the smallest one such that it and all larger ones run into a stop
    tolerated  the longest duration of the fault that ends without harm when the controller never latches

The magnitude that is harmful and not noticed is a gap of the detector. The tolerated time is the fault-tolerant time
interval of ISO 26262-1, 3.61: time to notice plus time to react should be shorter. Durations double from one sample
until one harms, and are then bisected to REFINEMENT; harm is assumed to grow with the duration in between.

Each value is the worst over the onsets of a condition.

Machines of a fault campaign: the nominal one, and perturbed ones that are the same in every campaign.

    parameter   p (1 + tolerance s)
    sensor      offset s, gain error s, of the largest ones that are declared

Each s is -1 or 1 at random for the first CORNERS perturbed machines, and uniform in -1 .. 1 for the others.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.base.progress import Counted, Progress, each
from synth.declare.stage import Stage
from synth.errors import SignalError
from synth.fault import LATCH_BIT
from synth.plant import Plant, velocities
from synth.simulate import conditions, sampling
from synth.simulate.faults import injections
from synth.simulate.faults.injections import Injection
from synth.simulate.rig import Rig
from synth.simulate.scenario import Array, Trajectory, sample_times

CORNERS, SEED = 8, 18  # number of perturbed machines at corners of the tolerances, and the seed of all


def plant_number(plant: Plant, i: int) -> Plant:
    """Return the nominal plant for i = 0, otherwise perturbed plant i."""
    varying = [p for p in plant.parameters if p.varies]
    if i == 0 or not varying:
        return plant
    s = _s(i, len(varying)).tolist()
    return plant.with_parameters(**{p.name: p.at(z) for p, z in zip(varying, s, strict=True)})


def machine_number(rig: Rig, i: int) -> Rig:
    """Return the rig with plant number i, and with that plant's errors of the sensors."""
    if i == 0:
        return rig
    quantities = sampling.quantities(rig)
    s = dict(zip(quantities, _s(i, len(quantities)).tolist(), strict=True))
    return sampling.with_sensor_errors(replace(rig, plant=plant_number(rig.plant, i)), s)


def _s(i: int, n: int) -> Array:
    """Return the first n numbers s of plant i, which do not depend on n."""
    rng = np.random.default_rng([SEED, i])
    return rng.choice((-1.0, 1.0), n) if i <= CORNERS else rng.uniform(-1, 1, n)


FAR = 0.2  # of the range of a set-point: largest distance from it, on average, at rest without a fault
SWING = 0.2  # amplitude of the default motion, over the distance from rest to the nearer end of the range
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
    """A run with a fault, compared with the healthy run of the same plant, condition and noise.

    `named` says whether fault bits of all faulty inputs are set up to the latch; actuators have none. `wrong_names`
    lists the other inputs with a fault bit until then. `effect` says whether a state or a fault word differs.
    """

    injection: Injection
    condition: str
    plant: int
    onset_s: float
    excursion: Values
    impacts: Values
    energies: Values
    speeds: Values
    final_speeds: Values
    notice_s: float
    latch_s: float
    named: bool
    wrong_names: tuple[str, ...]
    effect: bool

    @property
    def harms(self) -> bool:
        """Whether a position hits a stop faster than in the healthy run, or is not finite."""
        return any(self.impacts.values()) or not all(np.isfinite(list(self.excursion.values())))


@dataclass(frozen=True)
class HealthyRun:
    """A run without a fault: `alarms`, its number of samples with a fault bit, and its impacts."""

    condition: str
    plant: int
    alarms: int
    impacts: Values


def with_stops(rig: Rig) -> Rig:
    """Return the rig with the velocity of each position, and stops at the plant's domain where none are declared."""
    stage, plant = rig.stage, rig.stage.plant
    rates = velocities(plant) | dict(stage.velocities)
    domain = {s.name: (s.low, s.high) for s in plant.states if s.name in rates}
    return replace(rig, stage=replace(stage, velocities=rates, stops=domain | dict(stage.stops)))


def condition_names(stage: Stage) -> tuple[str, ...]:
    """Return the names of the conditions; a stage without set-points has one."""
    if not stage.interface.set_points:
        return (AT_REST,)
    return AT_REST, IN_MOTION, *(f"{AT_REST}, {name}" for name in stage.faults.operating_points)


def motion_and_standstill(rig: Rig) -> tuple[Condition, ...]:
    """Return the conditions of `condition_names`: at rest, in motion, and at rest at each declared operating point.

    Raises SignalError for an operating point or a motion with an unknown set-point, or one out of its range.
    """
    campaign, T = rig.stage.faults, rig.period_s
    first_onset = round(campaign.settle_s / T)
    rest_s, names = campaign.settle_s + campaign.watch_s, condition_names(rig.stage)
    still = Condition(AT_REST, rest_s, {}, {}, (first_onset,))
    if names == (AT_REST,):
        return (still,)
    onsets = tuple(first_onset + round(i * campaign.period_s / campaign.onsets / T) for i in range(campaign.onsets))
    duration = onsets[-1] * T + campaign.watch_s
    courses = motion(rig, sample_times(duration, T))
    samples = len(sample_times(rest_s, T))
    courses_at_rest = [_hold(rig, point, samples) for point in campaign.operating_points.values()]
    return (
        still,
        Condition(IN_MOTION, duration, start_of(rig, courses), courses, onsets),
        *(
            Condition(name, rest_s, start_of(rig, held), held, (first_onset,))
            for name, held in zip(names[2:], courses_at_rest, strict=True)
        ),
    )


def _hold(rig: Rig, operating_point: Values, n: int) -> dict[str, Array]:
    """Return n samples of the set-points of an operating point."""
    points = {s.name: s for s in rig.stage.interface.set_points}
    for name, value in operating_point.items():
        if name not in points:
            known = ", ".join(points)
            raise SignalError(
                f"an operating point of the fault campaign gives '{name}', which is no set-point: give some of {known}"
            )
        low, high = points[name].low, points[name].high
        if not low <= value <= high:
            raise SignalError(
                f"the fault campaign has an operating point with {name} = {value:g}; its range is {low:g} .. {high:g}; "
                "choose a value in it"
            )
    return {name: np.full(n, value) for name, value in operating_point.items()}


def motion(rig: Rig, time: Array) -> dict[str, Array]:
    """Return the declared motion at times (N,), or by default a sine about rest for each set-point."""
    campaign, points = rig.stage.faults, rig.stage.interface.set_points
    if campaign.motion:
        return conditions.profiles(rig.stage.interface, campaign.motion, time)
    rest, frequency = rig.at_rest(), 2 * np.pi / campaign.period_s
    amplitudes = {s.name: SWING * max(min(s.high - rest[s.name], rest[s.name] - s.low), 0.0) for s in points}
    return {name: rest[name] + amplitude * np.sin(frequency * time) for name, amplitude in amplitudes.items()}


def start_of(rig: Rig, courses: Mapping[str, Array]) -> dict[str, float]:
    """Return the initial state: each position starts at the first value of its set-point."""
    states = [s.name for s in rig.plant.states]
    return {rig.positions[name]: float(r[0]) for name, r in courses.items() if rig.positions[name] in states}


def run(
    rig: Rig, plant: int, condition: Condition, progress: Progress, faults: Sequence[Injection] | None = None
) -> tuple[HealthyRun, list[FaultRun]]:
    """Run `faults`, by default all, in a condition on the plant with this number; `rig` is from `with_stops`.

    Raises SignalError for an operating point at which the nominal machine does not rest, and as `Rig.run`, like
    WiringError.
    """
    perturbed = machine_number(rig, plant)
    healthy, begun = run_healthy(perturbed, condition)
    if plant == 0 and condition.name not in (AT_REST, IN_MOTION):
        _require_rest(rig, condition, healthy)
    runs: list[FaultRun] = []
    chosen = injections.derive(rig.stage) if faults is None else faults
    for k, injection in enumerate(chosen):
        if k == 0 or injection.target != chosen[k - 1].target:
            progress(Counted(f"faults of {injection.group} {injection.target}", k, len(chosen)))
        for onset in condition.onsets:
            try:
                runs.append(inject(begun[onset], plant, condition, injection, onset, healthy))
            except Exception as error:
                error.add_note(f"{injection.target} {injection.kind}, {injection.duration}, from sample {onset}")
                raise
    return HealthyRun(condition.name, plant, int(np.count_nonzero(healthy.faults)), healthy.impacts), runs


def _require_rest(rig: Rig, condition: Condition, healthy: Trajectory) -> None:
    """Refuse an operating point that the machine has left for good, as where a sensor repeats with each pitch."""
    points, onset = {s.name: s for s in rig.stage.interface.set_points}, condition.onsets[0]
    for name, course in condition.references.items():
        point, position = points[name], rig.positions[name]
        distance = abs(float(np.mean(healthy[position][onset // 2 : onset + 1])) - float(course[onset]))
        if not distance <= FAR * (point.high - point.low):
            unit = rig.stage.interface.signals[name].unit
            raise SignalError(
                f"{condition.name}: without a fault '{position}' is {distance:g} {unit} from '{name}' = "
                f"{course[onset]:g} {unit} before the fault; give an operating point at which the machine rests, one "
                "that its controller can tell from others at init"
            )


def run_healthy(rig: Rig, condition: Condition) -> tuple[Trajectory, dict[int, Rig]]:
    """Return the run without a fault, and for each onset the rig that has run the samples before it."""
    course = condition.duration_s, condition.start, condition.references
    return rig.run(*course), {onset: rig.begun(onset, *course) for onset in condition.onsets}


def inject(
    rig: Rig, plant: int, condition: Condition, injection: Injection, onset: int, healthy: Trajectory
) -> FaultRun:
    """Run one fault from sample `onset` on, and compare it with the healthy run.

    `rig` has plant number `plant`; it may have run the samples before the onset.
    """
    fields = injections.scenario_fields(rig, rig.stage.faults, injection, healthy, onset)
    faulty = rig.run(condition.duration_s, condition.start, condition.references, **fields)
    new_bits = faulty.faults & ~healthy.faults
    notice, latch = _first(_all_bits(faulty) & ~_all_bits(healthy)), _first(new_bits >> LATCH_BIT & 1)
    notice_s, latch_s = (np.inf if k is None else (k - onset) * rig.period_s for k in (notice, latch))
    bits_to_latch = int(np.bitwise_or.reduce(new_bits[: None if latch is None else latch + 1], initial=0))
    of_inputs = input_bits(rig)
    named = {name for name, bits in of_inputs.items() if bits_to_latch & bits}
    targets = {*injection.targets, *_count_of_calls(rig, injection)}
    identified = targets & set(of_inputs)
    impacts = {q: v if v > healthy.impacts[q] else 0.0 for q, v in faulty.impacts.items()}
    same = np.array_equal(healthy.faults, faulty.faults) and all(
        np.array_equal(healthy.states[s], faulty.states[s]) for s in healthy.states
    )
    return FaultRun(
        injection,
        condition.name,
        plant,
        onset * rig.period_s,
        {q: _largest(faulty.states[q] - healthy.states[q]) for q in rig.stage.velocities},
        impacts,
        {q: _inertia(rig, q) * impacts[q] ** 2 / 2 for q in rig.stage.faults.inertias},
        {q: 0.0 if latch is None else _largest(faulty.states[v][latch:]) for q, v in rig.stage.velocities.items()},
        {q: _largest(faulty.states[v][-1:]) for q, v in rig.stage.velocities.items()},
        notice_s,
        latch_s,
        named=named.issuperset(identified) and bool(identified),
        wrong_names=tuple(sorted(named - targets)),
        effect=not same,
    )


def _all_bits(run: Trajectory) -> NDArray[np.uint32]:
    """Return the fault bits of the controller and of the drive in each sample."""
    return np.bitwise_or.reduce([run.faults, *run.drive_faults.values()])


def _inertia(rig: Rig, q: str) -> float:
    return sum(rig.plant.parameter(name).value for name in rig.stage.faults.inertia(q))


def input_bits(rig: Rig) -> dict[str, int]:
    """Return the bits of the fault word that identify each controller input, as out of range or as a suspect."""
    words: dict[str, int] = {}
    for fault in rig.controller.manifest["faults"]:
        if name := fault.get("input") or fault.get("suspect"):
            words[name] = words.get(name, 0) | 1 << fault["bit"]
    return words


def _count_of_calls(rig: Rig, injection: Injection) -> tuple[str, ...]:
    """Return the input that counts missed calls, for a fault of the calls."""
    count = rig.stage.interface.missed_calls
    return (count.name,) if count and injection.group == injections.CALLS else ()


def _first(flags: NDArray[Any]) -> int | None:
    """Return the first sample at which a flag is set."""
    samples = np.flatnonzero(flags)
    return int(samples[0]) if samples.size else None


def _largest(difference: Array) -> float:
    """Return the largest magnitude, inf if a value is not finite."""
    largest = float(np.max(np.abs(difference)))
    return largest if np.isfinite(largest) else np.inf


MAGNITUDES = tuple(0.5**k for k in range(13))  # of the range, largest first
SWEPT = {
    injections.SENSOR: ("offset", "drift", "noise", "bit flipped", "bit stuck"),
    injections.SET_POINT: ("jump",),
    injections.ACTUATOR: ("weak",),
}
REFINEMENT = 1.1  # ratio of the shortest harmful duration to the longest harmless one


@dataclass(frozen=True)
class Sweep:
    """The sweep of one fault in one condition: magnitudes as fractions of the range, inf for none, and a time.

    `noticed` and `harmful` are None for a fault without a magnitude. `tolerated_s`, inf without a limit, is None for a
    fault that is not permanent.
    """

    group: str
    target: str
    kind: str
    duration: str
    condition: str
    noticed: float | None
    harmful: float | None
    tolerated_s: float | None


def run_sweeps(
    rig: Rig, without_latch: Rig, condition: Condition, progress: Progress, faults: Sequence[Injection]
) -> list[Sweep]:
    """Return the sweeps of faults in a condition; both rigs are from `with_stops`.

    Raises SignalError and WiringError as `Rig.run`.
    """
    chosen = [f for f in faults if is_swept(f)]
    latching, unlatched = (_Bench(condition, *run_healthy(r, condition)) for r in (rig, without_latch))
    line: Callable[[Injection], str] = lambda f: f"sweep of {f.target} {f.kind}, {f.duration}"  # noqa: E731
    return [_sweep(latching, unlatched, injection) for injection in each(chosen, progress, line)]


def is_swept(injection: Injection) -> bool:
    """Return whether a fault has a magnitude, or is permanent and so has a tolerated time."""
    return _has_magnitude(injection) or injection.duration == injections.PERMANENT


def _has_magnitude(injection: Injection) -> bool:
    return injection.kind in SWEPT.get(injection.group, ())


@dataclass(frozen=True, eq=False)
class _Bench:
    """A condition with the healthy run of a rig, and for each onset the rig that has run the samples before it."""

    condition: Condition
    healthy: Trajectory
    begun: Mapping[int, Rig]

    def inject(self, injection: Injection, onset: int) -> FaultRun:
        """Run a fault on the nominal plant."""
        return inject(self.begun[onset], 0, self.condition, injection, onset, self.healthy)


def _sweep(bench: _Bench, without_latch: _Bench, injection: Injection) -> Sweep:
    onsets, noticed, harmful, tolerated = bench.condition.onsets, None, None, None
    if _has_magnitude(injection):
        least = [_least_magnitudes(bench, injection, onset) for onset in onsets]
        noticed, harmful = max(n for n, _ in least), min(h for _, h in least)
    if injection.duration == injections.PERMANENT:
        tolerated = min(_tolerated_samples(without_latch, injection, onset) for onset in onsets)
        tolerated *= bench.begun[onsets[0]].period_s
    return Sweep(
        injection.group, injection.target, injection.kind, injection.duration, bench.condition.name,
        noticed, harmful, tolerated,
    )  # fmt: skip


def _least_magnitudes(bench: _Bench, injection: Injection, onset: int) -> tuple[float, float]:
    """Return the smallest magnitude noticed and the smallest that harms, each with all larger ones."""
    least = [math.inf, math.inf]
    open_ends = {0, 1}
    for magnitude in MAGNITUDES:
        fault = bench.inject(replace(injection, magnitude=magnitude), onset)
        flags = (math.isfinite(fault.notice_s), fault.harms)
        open_ends = {i for i in open_ends if flags[i]}
        for i in open_ends:
            least[i] = magnitude
        if not open_ends:
            break
    return least[0], least[1]


def _tolerated_samples(bench: _Bench, injection: Injection, onset: int) -> float:
    """Return the longest harmless duration in samples, inf for a fault that never does harm."""
    longest = len(bench.healthy.time) - onset

    def harms(samples: int) -> bool:
        return bench.inject(replace(injection, samples=samples), onset).harms

    if not harms(longest):
        return math.inf
    harmful = next((n for n in _doubling(longest) if harms(n)), longest)
    harmless = harmful // 2
    while harmful - harmless > 1 and harmful > REFINEMENT * harmless:
        middle = (harmless + harmful) // 2
        harmless, harmful = (harmless, middle) if harms(middle) else (middle, harmful)
    return harmless


def _doubling(limit: int) -> Iterable[int]:
    """Yield 1, 2, 4, ... below a limit."""
    n = 1
    while n < limit:
        yield n
        n *= 2
