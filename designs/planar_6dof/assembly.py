"""Assembly of a planar design from its controller, NumPy reference, experiments, audit and contents of the report."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from designs.planar_6dof import faults, interface
from designs.planar_6dof.interface import Subject
from designs.planar_6dof.sensing import sections as sensing
from models import halbach, papers, planar_stage
from synth import stage
from synth.blocks.faults import innovation_monitor
from synth.declare.fault_campaign import StudyLimits
from synth.timing import Discrete

KNOWN_AFTER = innovation_monitor.longest(len(planar_stage.HALL), sensing.REPEATS)
PREDICTED = "none of the six voltages: x, y and yaw are predicted (dead reckoning)"
USED_INSTEAD = {"refused_not_held": PREDICTED, "suspected": PREDICTED}
REACTIONS = {"suspected": "all Hall voltages stay refused until init, so the latch follows"}
ABOUT = (
    "The six-axis planar positioner of Yu and Kim: a platen on air bearings, driven by three planar motors over a "
    "magnet matrix and seen by three Hall sensors and three laser distance sensors. This page was computed from the "
    "physics; every figure on it was measured on the C that ships, or on the model that the C was derived from."
)
# What a study runs, with the limits of the nominal plant, which all machines keep. Left out is what takes minutes: the
# finite matrix, and failures at many places of a pitch. Of these, under the lead-lag law and on one of 15 machines, a
# channel that reads zero is at some place out of bounds for good and neither named nor the cause of a latch: `synth
# study planar_6dof_leadlag --experiments zero_anywhere`.
STUDIED = ("step_?", "step_phi", "standstill", "standstill_printed_noise", "*_resting", "*_moving")


def stimuli(subject: Callable[[], Subject]) -> Any:
    """Return what drives the verification of a controller; an import of a design runs nothing of it."""
    from designs.planar_6dof import verification

    return verification.stimuli(subject())


def at_places(of: stage.Stage) -> Any:
    """Return the loops of the controller at the places of a pitch."""
    from designs.planar_6dof import loops

    return loops.at_places(of)


def audit(rows: Callable[[Any], Iterator[Any]], of: stage.Stage) -> Iterator[Any]:
    """Yield the rows of the audit, computed with the shipped loop."""
    from synth.app import standard_tasks

    return rows(standard_tasks.rig(of, of.scalar))


def design(
    name: str,
    time: Discrete,
    subject: Callable[[], Subject],
    gains: Callable[[], Mapping[str, Any]],
    runs: Callable[[], Sequence[Any]],
    rows: Callable[[Any], Iterator[Any]],
    contents: Callable[[stage.Stage, Any], Any],
    studied: Sequence[str] = (),
    **fields: Any,
) -> stage.Stage:
    """Return the design; `subject` returns its controller and reference, `gains` the contents of gains.json.

    `rows` yields those of the audit, computed with the shipped loop. `studied` are further experiments of a study,
    `fields` further ones of the stage.
    """
    return stage.design(
        interface.declare_controller(name, time, lambda: subject().block, interface.BRAKED),
        planar_stage.plant(halbach.HARMONICS),
        reference=lambda states, inputs: subject().reference(states, inputs),
        surrogate_error=interface.SURROGATE_ERROR,
        substeps=interface.SUBSTEPS,
        runs=runs,
        reactions=REACTIONS,
        used_instead=USED_INSTEAD,
        header_notes=stage.read_notes(Path(__file__).with_name("header.md")),
        datasheet_notes=stage.read_notes(
            Path(__file__).with_name("datasheet.md"),
            paper=papers.YU,
            memory=sensing.MEMORY,
            repeats=sensing.REPEATS,
            known_after=KNOWN_AFTER,
        ),
        safe_output=stage.read_safe_output(Path(__file__).parents[1] / name / "safe_output.json"),
        # The last pitch of the travel, and the largest yaw: a voltage that has failed may show a larger one.
        limited=(*interface.PITCHES, "sensing_phi_raw"),
        gains=lambda _: gains(),
        faults=faults.CAMPAIGN,
        loops=at_places,
        study=StudyLimits(0.95, experiments=(*STUDIED, *studied)),
        stimuli=partial(stimuli, subject),
        audit=partial(audit, rows),
        contents=contents,
        about=ABOUT,
        **fields,
    )
