"""Absolute position from Hall voltages, after Kawato and Kim: from the magnets' geometry to verified C."""

import json
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from designs.hall_position import config
from designs.hall_position.glsdc import estimator
from designs.hall_position.protected import config as protected
from synth import stage
from synth.stage import Companion


def reference(states: Any, inputs: Any) -> Any:
    """Compute steps of the independent witness."""
    from designs.hall_position import random_steps, reference_guard

    return reference_guard.step(random_steps.setup(), states, inputs)


def verify(of: stage.Stage, progress: Callable[[str], None], whole: bool) -> Any:
    """Compare the witnesses; docs/decisions/hall_position_verification.md says why the standard cannot."""
    from designs.hall_position import verification

    return verification.verify(progress, whole)


def runs() -> Sequence[Any]:
    """Return the experiments; they are imported here, since an import of the design simulates nothing."""
    from designs.hall_position import experiments

    return experiments.ALL


def stimuli() -> Any:
    """Return the recorded and random inputs of an estimator, which closes no loop."""
    from designs.hall_position import stimuli

    return stimuli.of_stage()


def protected_sequences(controller: Any) -> Sequence[Any]:
    """Return the steps that cover the decisions of the estimators of three and of four sensors."""
    from designs.hall_position.protected import stimuli

    return stimuli.sequences(controller)


def audit(of: stage.Stage) -> Iterator[Any]:
    """Yield the recomputed figures of the paper."""
    from designs.hall_position.paper import rows

    return rows.rows()


def contents(studies: str, of: stage.Stage, results: Any) -> Any:
    """Return what the report has beyond the standard sections; `studies` are results of `python -m studies.hall`."""
    from designs.hall_position import page

    return page.contents(json.loads(studies), results)


RESULTS = Path(__file__).parents[2] / "studies" / "hall" / "results.json"
CONTROLLER = config.controller()
DESIGN = stage.design(
    CONTROLLER,
    CONTROLLER.interface.plant,
    warning=config.UNPROTECTED,
    header_notes=config.header_notes(),
    reference=reference,
    surrogate_error=estimator.SURROGATE_ERROR,
    gains=config.gains,
    companions=[
        Companion(
            name,
            partial(protected.block, name=name),
            inputs=partial(protected.vectors, name=name),
            gains=partial(protected.gains, name=name),
            header_notes=protected.header_notes(name),
            sequences=protected_sequences,
        )
        for name in protected.PLACES
    ],
    runs=runs,
    verify=verify,
    stimuli=stimuli,
    audit=audit,
    contents=partial(contents, RESULTS.read_text(encoding="utf-8")),
    about=__doc__,
)
