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
from synth.declare.experiments import Run
from synth.declare.fault_campaign import StudyLimits
from synth.timing import Discrete

START = (
    "At init the platen is within half a pitch, 25.4 mm, of the middle in x and y, and its yaw is below 0.025 rad: the "
    "Hall voltages repeat with each pitch, and the pitches are counted from there. After a latch move the platen there "
    "before init."
)
CONTRADICTION = (
    "Hall voltages are refused from the sample after the second one in which they are inconsistent, if it follows the "
    f"first within {sensing.MEMORY} samples. Up to then no bit is set, the two samples are not used, and predictions "
    "take their place. From then on the bits of the suspects are set, and all Hall voltages stay refused until init, "
    "even if they agree again, so the latch follows."
)
CALIBRATED = (
    "Calibrate the sensitivity of each Hall channel to 0.2 % and its offset to 2 mV: what a single channel is off by "
    "turns the platen, by up to 6 mrad at the worst place of a pitch. With 0.5 % and 5 mV it turns by up to 15 mrad "
    "there, and beyond 20 mrad while it starts. With 1 % and 5 mV in all channels a simulated stage hit its yaw stop "
    "in 17 of 48 runs under the LQG law and in 6 of 48 under the lead-lag law. None of this sets a fault bit for "
    "certain. What all channels share may be off by 10 %."
)
BEGINS = (
    "Before the first sample in which all Hall voltages are good no current is demanded, since x, y and the yaw are "
    "not known. Six suspects at once can also mean a dead or reversed phase, a steady force above 1.8 N, or missed "
    "calls."
)
KNOWN_AFTER = innovation_monitor.longest(len(planar_stage.HALL), sensing.REPEATS)
REPEATED = (
    f"A Hall voltage with the same value {sensing.REPEATS} times in a row is frozen. One is watched at a time, so it "
    f"becomes a suspect after {KNOWN_AFTER} samples, and one more for each value that a sound one repeats by chance. "
    "The first that is frozen is named; the others are not examined. All Hall voltages then stay refused until init. "
    "Sound converters need noise: with 3 codes rms one is taken for frozen once in 90 years, with 2 twice a year. "
    "Simulated without noise, a platen at rest latches."
)
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
    runs: Callable[[], Sequence[Run]],
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
        header_notes=[f"(n) is equation (n) of {papers.YU}.", START, BEGINS, CALIBRATED, CONTRADICTION, REPEATED],
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
