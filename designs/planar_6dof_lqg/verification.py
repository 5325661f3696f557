"""Verification of the LQG controller's emitted C."""

from collections.abc import Callable, Mapping
from typing import Any

from numpy.typing import NDArray

from designs.planar_6dof import lqg
from designs.planar_6dof import verification as shared
from designs.planar_6dof.allocation import HORIZONTAL
from designs.planar_6dof.random_steps import Columns, Subject
from designs.planar_6dof_lqg import reference
from models import planar_stage
from synth.block import Block
from synth.verify.evidence import Evidence

SIZE, STEP = 0.1, 0.06  # of what the motors meet, m


def subject() -> Subject:
    """Return the controller beside its reference."""
    block = lqg.controller(planar_stage.plant())
    return Subject(block, reference.step, SIZE, STEP, lambda pose: at_rest(block, pose))


def at_rest(block: Block, pose: Mapping[str, NDArray[Any]]) -> Columns:
    """Return x3 (N,) of platens at rest: it is less L times the position, as large as 50 times what the motors meet."""
    L = {c.name: c.value for c in block.constants}
    return {f"lqg_{axis}_x3": -L[f"lqg_{axis}_L"] * pose[axis] for axis in HORIZONTAL}


def verify(told: Callable[[str], None], replay_s: float) -> Evidence:
    """Compare the witnesses; `replay_s` is how much of the tour they replay, in s."""
    return shared.verify(subject(), told, replay_s)
