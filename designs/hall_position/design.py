"""Absolute position from Hall voltages, after Kawato and Kim: from the magnets' geometry to verified C."""

import json
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

from designs.hall_position import config, random_steps, reference_guard, stimuli, verification
from designs.hall_position.glsdc import estimator
from designs.hall_position.paper import rows
from designs.hall_position.protected import config as protected
from designs.hall_position.protected import stimuli as protected_stimuli
from models import papers
from synth import stage
from synth.app.workspace import CostStimuli
from synth.base.progress import Progress
from synth.stage import Companion


def report(files: Any, evidence: Any, runs: Any, rows: Any, cost: Any, parts: Mapping[str, Any]) -> str:
    """Return the report; what draws it is imported here, since `synth emit` does not need it."""
    from designs.hall_position import page

    return page.report(files, evidence, runs, rows, cost, parts)


def quote_studies(results: str, progress: Progress) -> Any:
    """Return the results of the studies, as `python -m studies.hall` has written them."""
    return json.loads(results)


RESULTS = Path(__file__).parents[2] / "studies" / "hall" / "results.json"
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
    simulate={},  # it closes no loop
    audit=lambda of: rows.rows(),
    cost_stimuli=lambda of: CostStimuli(config.block, stimuli.replay, stimuli.sequences, stimuli.FLOOR),
    report=lambda of, *arguments, **further: report(*arguments, **further),
    report_parts={"studies": partial(quote_studies, RESULTS.read_text(encoding="utf-8"))},
    about=__doc__,
)
