"""Sweeps of a fault campaign on the nominal plant: smallest magnitude noticed, and fault-tolerant time interval.

    noticed    the smallest magnitude of 1, 1/2, 1/4, ... of the range such that it and all larger ones set a fault bit
    harmful    the smallest one such that it and all larger ones run into a stop
    tolerated  the longest duration of the fault that ends without harm when the controller never latches

The magnitude that is harmful and not noticed is a gap of the detector. The tolerated time is the fault-tolerant time
interval of ISO 26262-1, 3.61: time to notice plus time to react should be shorter. Durations double from one sample
until one harms, and are then bisected to REFINEMENT; harm is assumed to grow with the duration in between.

Each value is the worst over the onsets of a condition.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from synth.base.progress import Progress, each
from synth.simulate.faults import campaign, injections
from synth.simulate.faults.campaign import Condition, FaultRun
from synth.simulate.faults.injections import Injection
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory

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


def run(
    rig: Rig, without_latch: Rig, condition: Condition, progress: Progress, faults: Sequence[Injection]
) -> list[Sweep]:
    """Return the sweeps of faults in a condition; both rigs are from `campaign.with_stops`.

    Raises SignalError and WiringError as `Rig.run`.
    """
    chosen = [f for f in faults if is_swept(f)]
    latching, unlatched = (_Bench(condition, *campaign.run_healthy(r, condition)) for r in (rig, without_latch))
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
        return campaign.inject(self.begun[onset], 0, self.condition, injection, onset, self.healthy)


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
