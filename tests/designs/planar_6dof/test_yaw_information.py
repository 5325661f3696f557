"""What is left of the yaw rate in the worst run of a stuck channel, and what the other five voltages say about it."""

from functools import cache

import casadi as ca
import numpy as np

from designs.planar_6dof import loop as loops
from designs.planar_6dof_lqg.design import subject
from models import planar_stage
from synth.simulate.rig import Rig
from tests.designs.planar_6dof import yaw_information
from tests.designs.planar_6dof.yaw_information import CHANNEL, Failure

SOUND = tuple(name for name in planar_stage.HALL if name != CHANNEL)


@cache
def worst() -> tuple[Rig, Failure]:
    rig = loops.of(subject().block)
    return rig, yaw_information.stick(rig)


def test_the_worst_run_leaves_half_as_much_again_as_the_limit() -> None:
    """The limit of 0.2 rad/s is not met here; docs/decisions/planar_faults.md gives the reason."""
    rig, failed = worst()
    assert 0.2 < failed.left(rig.period_s) < 0.33 and failed.latch - failed.braking == 24
    assert np.abs(failed.run["wphi"][failed.failure : failed.latch]).max() > 3.0


def test_five_calibrated_channels_would_tell_the_yaw_rate_and_unequal_ones_do_not() -> None:
    rig, failed = worst()
    known = yaw_information.information(rig, failed)
    assert known.noise < 3e-3 and known.rate_noise < 0.05  # so noise is not what forbids it
    assert known.rate_unequal > 1.0 and known.unequal > known.rotation / 2


def test_the_rows_estimate_the_yaw_and_nothing_else() -> None:
    rig, failed = worst()
    (row, *_), (values, *_) = yaw_information.yaw_rows(rig, failed.run, SOUND)
    plant, names = rig.plant, [s.name for s in rig.plant.states]
    outputs = [s.name for s in plant.outputs]
    state = np.array([failed.run[name][0] for name in names])

    def voltages(**moved: float) -> np.ndarray:
        shifted = state + [moved.get(name, 0.0) for name in names]
        out = np.array(ca.DM(plant.h(shifted, np.zeros(len(plant.inputs)), plant.values))).ravel()
        return out[[outputs.index(name) for name in SOUND]]

    assert np.allclose(voltages(), values)
    for name, expected in (("phi", 1e-5), ("x", 0.0), ("y", 0.0)):
        assert abs(row @ (voltages(**{name: 1e-5}) - values) - expected) < 1e-7
    assert abs(row @ values) < 1e-9  # nor does a common amplitude
