"""Absolute position from Hall voltages, after Kawato and Kim: from the magnets' geometry to verified C."""

from collections.abc import Mapping
from functools import partial
from typing import Any

from designs.hall_position import config, random_steps, reference_guard, stimuli, verification
from designs.hall_position.glsdc import estimator
from designs.hall_position.loop import experiments, four_experiments
from designs.hall_position.paper import rows
from designs.hall_position.protected import config as protected
from designs.hall_position.protected import stimuli as protected_stimuli
from models import papers
from synth import stage
from synth.progress import Progress
from synth.stage import Companion
from synth.workspace import CostStimuli


def report(files: Any, evidence: Any, runs: Any, rows: Any, cost: Any, parts: Mapping[str, Any]) -> str:
    """Return the report; what draws it is imported here, since `synth emit` does not need it."""
    from designs.hall_position import page

    return page.report(files, evidence, runs, rows, cost, parts)


def measure_costs(progress: Progress) -> Any:
    """Return the cost of the other estimators."""
    from designs.hall_position import costs

    return costs.measure(progress)


def survey_integrity(progress: Progress) -> Any:
    """Return the tables of the integrity of three and four sensors."""
    from designs.hall_position.pages import integrity

    return integrity.tables(progress)


EQUATIONS = f"(n) is equation (n) of {papers.KAWATO}."
CONTROLLER = config.controller()
DESIGN = stage.design(
    CONTROLLER,
    CONTROLLER.interface.plant,
    warning=config.UNPROTECTED,
    header_notes=[config.preconditions(), EQUATIONS],
    reference=partial(reference_guard.step, random_steps.setup()),
    surrogate_error=estimator.SURROGATE_ERROR,
    recording=lambda rig: stimuli.recording(rig.controller.scalar),
    gains=config.gains,
    companions=[
        Companion(
            protected.block(name=name),
            partial(protected.vectors, name=name),
            partial(protected.gains, name=name),
            [protected.preconditions(name)],
            protected_stimuli.sequences,
        )
        for name in protected.PLACES
    ],
    verify=lambda of, progress, whole: verification.verify(progress, whole),
    simulate={
        "experiments": lambda of, progress: experiments.run(progress),
        "sources": lambda of, progress: experiments.compare_sources(progress),
        "four sensors": lambda of, progress: four_experiments.run(progress),
    },
    audit=lambda of: rows.rows(),
    cost_stimuli=lambda of: CostStimuli(config.block, stimuli.replay, stimuli.sequences, stimuli.FLOOR),
    report=lambda of, *arguments, **further: report(*arguments, **further),
    report_parts={"costs": measure_costs, "integrity": survey_integrity},
    about=__doc__,
)
