"""Jobs of a fault campaign: one for each plant and condition of a design, in parallel, and the negative control.

The result does not depend on the number of processes: every run has its seeds, and runs are put together in the order
of plants and conditions.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

from synth import standard_tasks
from synth.declaration import Stage
from synth.errors import DesignError
from synth.jobs import Job, Outcome
from synth.progress import Progress
from synth.simulate import campaign, fault_rows
from synth.simulate.campaign import FaultRun, HealthyRun
from synth.simulate.rig import Rig
from synth.workspace import Design

Runs = tuple[HealthyRun, list[FaultRun]]


def stage_of(design: Design) -> Stage:
    """Return the declared stage of a design; raise DesignError without one, or without an actuator."""
    if design.stage is None or not design.stage.interface.actuators:
        raise DesignError(
            f"design '{design.name}' closes no loop: a fault campaign needs a declared stage with actuators"
        )
    return design.stage


def jobs(design: Design, plants: int) -> list[Job]:
    """Return the jobs of a design; the first compiles, the others need it.

    Raises DesignError as `stage_of`.
    """
    stage, name = stage_of(design), design.name
    first = f"{name} compile"
    cases = [(i, c) for i in range(plants) for c in _conditions(stage)]
    runs = [_job(_name(name, i, c), partial(_run, stage, i, c), first) for i, c in cases]
    control = [_job(_control(name, c), partial(_run_control, stage, c), first) for c in _conditions(stage)]
    return [_job(first, partial(_compile, stage)), *runs, *control]


def _job(name: str, work: Callable[[Progress], Any], *after: str) -> Job:
    return Job(name, name, work, after)


def result(design: Design, plants: int, outcomes: Mapping[str, Outcome]) -> fault_rows.Campaign:
    """Return the campaign of a design from the outcomes of all jobs, none of which failed."""
    stage, name = stage_of(design), design.name
    runs = [outcomes[_name(name, i, c)].value for i in range(plants) for c in _conditions(stage)]
    control = [run for c in _conditions(stage) for run in outcomes[_control(name, c)].value]
    return fault_rows.campaign(_rig(stage), plants, runs, control)


def _conditions(stage: Stage) -> Sequence[str]:
    return (campaign.AT_REST, campaign.IN_MOTION) if stage.interface.set_points else (campaign.AT_REST,)


def _name(design: str, plant: int, condition: str) -> str:
    return f"{design} plant {plant} {condition}"


def _control(design: str, condition: str) -> str:
    return f"{design} without latch {condition}"


def _rig(stage: Stage) -> Rig:
    return campaign.with_stops(standard_tasks.rig(stage, stage.scalar))


def _compile(stage: Stage, progress: Progress) -> None:
    progress("compile")
    for rig in (_rig(stage), standard_tasks.rig_without_latch(stage, stage.scalar)):
        rig.run(2 * rig.period_s)


def _run(stage: Stage, plant: int, condition: str, progress: Progress) -> Runs:
    return _run_condition(_rig(stage), plant, condition, progress)


def _run_control(stage: Stage, condition: str, progress: Progress) -> list[FaultRun]:
    rig = campaign.with_stops(standard_tasks.rig_without_latch(stage, stage.scalar))
    return _run_condition(rig, 0, condition, progress)[1]


def _run_condition(rig: Rig, plant: int, name: str, progress: Progress) -> Any:
    condition = next(c for c in campaign.motion_and_standstill(rig) if c.name == name)
    return campaign.run(rig, plant, condition, progress)
