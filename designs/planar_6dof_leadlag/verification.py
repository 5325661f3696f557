"""Verification of the lead-lag controller's emitted C."""

from collections.abc import Callable

from designs.planar_6dof import verification as shared
from designs.planar_6dof.random_steps import Subject
from designs.planar_6dof_leadlag import control, reference
from models import planar_stage
from synth.verify.evidence import Evidence

SIZE, STEP = 0.3, 0.06  # of what the motors meet, m


def subject() -> Subject:
    """Return the controller beside its reference."""
    return Subject(control.controller(planar_stage.plant()), reference.step, SIZE, STEP)


def verify(told: Callable[[str], None], replay_s: float) -> Evidence:
    """Compare the witnesses; `replay_s` is how much of the tour they replay, in s."""
    return shared.verify(subject(), told, replay_s)
