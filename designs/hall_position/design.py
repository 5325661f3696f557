"""Absolute position from Hall voltages, after Kawato and Kim: from the magnets' geometry to verified C."""

import json
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

from designs.hall_position import config, random_steps, reference_guard
from designs.hall_position.glsdc import estimator
from designs.hall_position.protected import config as protected
from designs.hall_position.protected import stimuli as protected_stimuli
from models import papers
from synth import stage
from synth.stage import Companion


def verify(of: stage.Stage, progress: Callable[[str], None], whole: bool) -> Any:
    """Compare the witnesses; docs/decisions/hall_position_verification.md says why the standard cannot."""
    from designs.hall_position import verification

    return verification.verify(progress, whole)


def stimuli() -> Any:
    """Return the recorded and random inputs of an estimator, which closes no loop."""
    from designs.hall_position import stimuli

    return stimuli.of_stage()


def audit(of: stage.Stage) -> Iterator[Any]:
    """Yield the recomputed figures of the paper."""

    from designs.hall_position.paper import rows

    return rows.rows()


def contents(studies: str, of: stage.Stage, results: Any) -> Any:
    """Return what the report has beyond the standard sections; `studies` are results of `python -m studies.hall`."""
    from designs.hall_position import page

    return page.contents(json.loads(studies), results)


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
    verify=verify,
    stimuli=stimuli,
    audit=audit,
    contents=partial(contents, RESULTS.read_text(encoding="utf-8")),
    about=__doc__,
)
