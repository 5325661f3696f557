"""A flipped bit of a Hall channel at rest off the middle, where a torque about Z hides in the predicted yaw rate."""

from types import ModuleType

import pytest

from designs.planar_6dof.faults import AFTER_JUMP
from designs.planar_6dof_leadlag import design as leadlag
from designs.planar_6dof_lqg import design as lqg
from synth.block import Block
from synth.declare.stage import Stage
from tests.designs.planar_6dof.faulty_runs import OFF_THE_MIDDLE, campaign_runs

FLIPPED = "V_ax", "bit flipped", "permanent"
PLANTS = 5, 6  # those with the largest torques, one of each sign


def largest_yaw_rate(design: Stage, block: Block, plant: int) -> float:
    """Return the largest yaw rate from the latch on, or at a stop before it, rad/s."""
    (run,) = campaign_runs(design, block, plant, OFF_THE_MIDDLE, FLIPPED)
    assert run.named and run.latch_s < 0.05
    return max(run.speeds["phi"], run.impacts["phi"])


@pytest.mark.parametrize("plant", PLANTS)
@pytest.mark.parametrize("package", [leadlag, lqg])
def test_a_flipped_bit_leaves_a_slow_yaw(package: ModuleType, plant: int) -> None:
    assert largest_yaw_rate(package.DESIGN, package.subject().block, plant) < AFTER_JUMP["phi"]
