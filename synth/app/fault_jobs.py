"""Jobs of a fault campaign: chunks of faults on one plant in one condition, in parallel, each cached by content.

The result does not depend on the number of processes: every run has its seeds, and chunks are put together in the order
of plants, conditions and faults. A chunk is stored as soon as it is computed, so an interrupted campaign continues
where it was. Its key covers the controller as composed and all that the loop runs, but neither the limits, which the
runs do not depend on, nor the texts of the safe output, which may quote them.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache, partial

from synth.app import standard_tasks
from synth.base import cache, contents, store
from synth.base.jobs import Job, Outcome
from synth.base.progress import Counted, Progress, silent
from synth.check import Check, Incomplete, of_error
from synth.declare.fault_campaign import SafeOutput
from synth.declare.stage import Stage
from synth.errors import ContentError, DesignError, SynthError
from synth.execute import compile as host_compiler
from synth.signals import per_second
from synth.simulate.faults import campaign, fault_table, injections
from synth.simulate.faults.campaign import FaultRun, HealthyRun, Sweep
from synth.simulate.faults.fault_table import Campaign
from synth.simulate.faults.injections import Injection
from synth.simulate.rig import Rig

CHUNK = 12  # faults whose runs are stored together
PART = 8  # chunks of one job
RUNS, BASIC, SWEEPS, LOSSES = "plant", "basic faults on plant", "sweeps of plant", "losses on plant"


@dataclass(frozen=True)
class Chunk:
    """The healthy run, the runs of some faults, those of the negative control, and sweeps."""

    healthy: HealthyRun
    runs: tuple[FaultRun, ...]
    control: tuple[FaultRun, ...] = ()
    sweeps: tuple[Sweep, ...] = ()


@dataclass(frozen=True)
class Chunks:
    """The chunks of a part, and a failed check for each that raised an error."""

    computed: tuple[Chunk, ...]
    failed: tuple[Check, ...]


@dataclass(frozen=True)
class Part:
    """The faults from number `first` on, on one plant in one condition.

    `what` is RUNS of all faults, BASIC or LOSSES, runs of those of `injections`, or SWEEPS.
    """

    plant: int
    condition: str
    first: int
    what: str


def stage_of(stage: Stage) -> Stage:
    """Return a stage that closes a loop; raise DesignError for one without an actuator."""
    if not closes_loop(stage):
        raise DesignError(f"design '{stage.name}' closes no loop: a fault campaign needs a stage with actuators")
    return stage


def closes_loop(stage: Stage) -> bool:
    """Return whether a stage has actuators."""
    return bool(stage.interface.actuators)


def parts(stage: Stage, plants: int, sweep: bool = False) -> list[Part]:
    """Return the parts of a campaign: of each plant and condition, then the sweeps on the nominal plant.

    Raises DesignError as `stage_of`.
    """
    stage_of(stage)
    return [
        *(part for plant in range(plants) for part in _parts(stage, plant, RUNS)),
        *(_parts(stage, 0, SWEEPS) if sweep else ()),
    ]


def basic(stage: Stage) -> list[Part]:
    """Return the parts of the faults that a build runs on the nominal plant; raise DesignError as `stage_of`."""
    return list(_parts(stage_of(stage), 0, BASIC))


def losses(stage: Stage, plants: int) -> list[Part]:
    """Return the parts that `safe_output` needs; raise DesignError as `stage_of`."""
    stage_of(stage)
    return [part for plant in range(plants) for part in _parts(stage, plant, LOSSES)]


def jobs(stage: Stage, parts: Sequence[Part], after: Sequence[str] = ()) -> list[Job]:
    """Return the jobs of a stage: one that compiles, after the jobs in `after`, and one for each part.

    A part returns its chunks. Raises DesignError as `stage_of`.
    """
    name = stage_of(stage).name
    first = f"{name} compile"
    with suppress(SynthError):  # the job that compiles reports it
        _identity(stage)  # composed here, the controller is composed in every process that is forked
    runs = [Job(_name(name, part), name, partial(_run_part, stage, part), (first,)) for part in parts]
    return [Job(first, name, partial(_compile, stage), tuple(after)), *runs]


def result(stage: Stage, parts: Sequence[Part], outcomes: Mapping[str, Outcome] | None = None) -> Campaign:
    """Return the campaign of a stage, from the outcomes of all jobs, none of which failed, or from the cache.

    Raises DesignError as `stage_of`, SignalError as `fault_table.campaign`, and Incomplete where a run raised an error,
    with the campaign of the others, None where there is none.
    """
    of_parts = _all_chunks(stage, parts, outcomes)
    chunks, failed = [c for each in of_parts for c in each.computed], [c for each in of_parts for c in each.failed]
    if failed and not chunks:
        raise Incomplete(None, failed)
    healthy = {(c.healthy.plant, c.healthy.condition): c.healthy for c in chunks}
    whole = fault_table.campaign(
        _rigs(stage_of(stage))[0],
        len({plant for plant, _ in healthy}),
        list(healthy.values()),
        [run for c in chunks for run in c.runs],
        [run for c in chunks for run in c.control],
        [each for c in chunks for each in c.sweeps],
    )
    if failed:
        raise Incomplete(whole, failed)
    return whole


def safe_output(stage: Stage, parts: Sequence[Part], outcomes: Mapping[str, Outcome] | None = None) -> SafeOutput:
    """Return what the machine does after the latch, from the parts of `losses`; other arguments as `result`.

    Raises DesignError as `stage_of`, and where no run latches; Incomplete where a run raised an error.
    """
    stage, of_parts = stage_of(stage), _all_chunks(stage, parts, outcomes)
    if failed := [check for each in of_parts for check in each.failed]:
        raise Incomplete(None, failed)
    runs = [run for each in of_parts for chunk in each.computed for run in chunk.runs]
    latched = [run for run in runs if math.isfinite(run.latch_s)]
    if not latched:
        raise DesignError(
            f"design '{stage.name}': of {len(runs)} lost sensors none latches; there is nothing to measure"
        )
    units = {s.name: per_second(s.unit) for s in stage.plant.states if s.name in latched[0].speeds}
    conditions = {name: [run for run in latched if run.condition == name] for name in campaign.condition_names(stage)}
    return SafeOutput(
        f"synth faults {stage.name} --write",
        len({part.plant for part in parts}),
        len(runs),
        len(latched),
        units,
        {name: _largest([run.speeds for run in each], units) for name, each in conditions.items()},
        {name: _largest([run.impacts for run in each], stage.stops) for name, each in conditions.items()},
    )


def _largest(values: Sequence[Mapping[str, float]], positions: Iterable[str]) -> dict[str, float]:
    """Return the largest value of each position to three significant digits."""
    return {q: float(f"{max((v[q] for v in values), default=0.0):.3g}") for q in positions}


def _all_chunks(stage: Stage, parts: Sequence[Part], outcomes: Mapping[str, Outcome] | None) -> list[Chunks]:
    stage_of(stage)
    return [outcomes[_name(stage.name, part)].value if outcomes else _run_part(stage, part, silent) for part in parts]


def _parts(stage: Stage, plant: int, what: str) -> Iterator[Part]:
    count = len(_faults(stage, what))
    for condition in campaign.condition_names(stage):
        yield from (Part(plant, condition, first, what) for first in range(0, count, CHUNK * PART))


def _faults(stage: Stage, what: str) -> Sequence[Injection]:
    chosen = {BASIC: injections.is_basic, LOSSES: injections.is_loss}.get(what)
    return [i for i in injections.derive(stage) if chosen is None or chosen(i)]


def _name(design: str, part: Part) -> str:
    return f"{design} {part.what} {part.plant} {part.condition} {part.first}"


def _compile(stage: Stage, progress: Progress) -> None:
    progress("compile")
    for rig in _rigs(stage):
        rig.run(2 * rig.period_s)


@lru_cache(maxsize=4)
def _rigs(stage: Stage) -> tuple[Rig, Rig]:
    """Return the rig of a stage, and the one whose controller never latches."""
    rigs = standard_tasks.rig(stage, stage.scalar), standard_tasks.rig_without_latch(stage, stage.scalar)
    return campaign.with_stops(rigs[0]), campaign.with_stops(rigs[1])


def _run_part(stage: Stage, part: Part, progress: Progress) -> Chunks:
    """Return the chunks of a part, from the cache where they are stored."""
    faults = _faults(stage, part.what)[part.first : part.first + CHUNK * PART]
    chunks, failed = [], []
    for k in range(0, len(faults), CHUNK):
        chosen = faults[k : k + CHUNK]
        compute = partial(compute_chunk, stage, part, chosen, partial(_report, progress, k, len(faults)))
        try:
            key = _key(stage, part, chosen)
            chunks.append(store.fetch(key, compute) if key else compute())
        except Exception as error:
            failed.append(
                of_error(f"faults {part.condition}, plant {part.plant}, from fault {part.first + k} on", error)
            )
    return Chunks(tuple(chunks), tuple(failed))


def _report(progress: Progress, done: int, total: int, line: str) -> None:
    """Report a line of a chunk with its place in the part."""
    progress(Counted(line, done + (line.done if isinstance(line, Counted) else 0), total))


def _key(stage: Stage, part: Part, faults: Sequence[Injection]) -> str | None:
    """Return the key of a chunk, None for a stage whose content has no digest."""
    identity = _identity(stage)
    return contents.digest(identity, part.plant, part.condition, part.what, tuple(faults)) if identity else None


@lru_cache(maxsize=16)
def _identity(stage: Stage) -> str | None:
    """Return a digest of all that the runs of a stage depend on, besides the faults."""
    block = stage.controller.block
    if block.safety is not None:
        block = replace(block, safety=replace(block.safety, safe_output_effect=""))
    loop = (
        *(block, stage.scalar, stage.surrogate_error, stage.plant, replace(stage.interface, safe_output_effect="")),
        *(
            stage.drive,
            stage.wires,
            stage.start,
            stage.stops,
            stage.velocities,
            stage.substeps,
            replace(stage.faults, limits=()),
        ),
    )
    compiler = host_compiler.find_compiler()
    try:
        return cache.key(compute_chunk, compiler.command, compiler.identity, compiler.machine_flags, *loop, data=True)
    except ContentError:
        return None


def compute_chunk(stage: Stage, part: Part, faults: Sequence[Injection], progress: Progress) -> Chunk:
    """Return the runs of some faults, or their sweeps, computed.

    The control repeats the faults that latch on the nominal plant with a controller that never latches.
    """
    rig, without_latch = _rigs(stage)
    condition = next(c for c in campaign.motion_and_standstill(rig) if c.name == part.condition)
    if part.what == SWEEPS:
        healthy, _ = campaign.run(rig, part.plant, condition, progress, ())
        return Chunk(healthy, (), (), tuple(campaign.run_sweeps(rig, without_latch, condition, progress, faults)))
    healthy, runs = campaign.run(rig, part.plant, condition, progress, faults)
    latched = list(dict.fromkeys(run.injection for run in runs if math.isfinite(run.latch_s)))
    if part.plant != 0 or part.what == LOSSES or not latched:
        return Chunk(healthy, tuple(runs))
    return Chunk(healthy, tuple(runs), tuple(campaign.run(without_latch, 0, condition, silent, latched)[1]))
