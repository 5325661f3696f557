"""Loops of a study in one process: the rig of a stage and its integration, prepared once, and rows on them.

The report of a build has a brief study: BRIEF machines, and the experiments that begin in lanes with plant, controller
and drive of the stage. Others, with a controller or a disturbance of their own, would take minutes.
"""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from synth.app import standard_tasks
from synth.base import cache, store
from synth.base.progress import Progress
from synth.declare.stage import Stage
from synth.errors import ContentError, EmitError, WiringError
from synth.simulate import integration, study
from synth.simulate.integration import Integration
from synth.simulate.rig import Rig
from synth.simulate.sampling import Sampling
from synth.simulate.study import StudyTable

BRIEF = 16  # machines of the study in a report


@lru_cache(maxsize=4)
def rig(stage: Stage) -> Rig:
    """Return the rig of a stage under its controller in its own scalar type."""
    return standard_tasks.rig(stage, stage.scalar)


def run(stage: Stage, sampling: Sampling, patterns: tuple[str, ...], rows: Sequence[int]) -> StudyTable:
    """Return rows of a study of the experiments whose names match; raise DesignError as `study.select`."""
    experiments = study.select(stage.all_experiments, patterns)
    return study.run(rig(stage), experiments, sampling, rows, integration_of(stage, patterns))


@lru_cache(maxsize=4)
def integration_of(stage: Stage, patterns: tuple[str, ...]) -> Integration:
    """Return the integration that the first experiment that begins in lanes needs, stored or measured."""
    double, chosen = standard_tasks.rig(stage, np.float64), study.select(stage.all_experiments, patterns)
    first = next((e for e in chosen if integration.runs_in_lanes(double, e)), chosen[0])

    def measure() -> Integration:
        try:
            return integration.choose(double, first)
        except (EmitError, WiringError):
            return Integration(stage.substeps, np.nan)  # no loop runs in lanes

    try:
        return store.fetch(cache.key(integration.choose, stage, patterns, data=True), measure)
    except ContentError:
        return measure()


def brief(stage: Stage, progress: Progress) -> StudyTable | None:
    """Return the study of a report; None without an experiment that begins in lanes."""
    chosen = study.select(stage.all_experiments, stage.study.experiments)
    names = tuple(e.name for e in chosen if integration.runs_in_lanes(rig(stage), e))
    if not names:
        return None
    progress(f"study of {BRIEF} machines")
    return run(stage, Sampling(BRIEF), names, range(BRIEF))
