"""What Hall channels that are off turn the platen by, as the header says, at the worst place of a pitch."""

from dataclasses import replace
from types import ModuleType

import numpy as np
import pytest

from designs.planar_6dof import interface
from designs.planar_6dof import loop as loops
from designs.planar_6dof_leadlag import design as leadlag
from designs.planar_6dof_lqg import design as lqg
from models import planar_stage
from synth.simulate.scenario import Trajectory

PLACE = {"x": 9.3e-3, "y": -16.1e-3}  # m
# Signs of the errors that add up in the yaw there, by channel.
GAINS = dict(zip(planar_stage.HALL, (-1, 1, -1, -1, 1, 1), strict=True))
OFFSETS = dict(zip(planar_stage.HALL, (-1, -1, 1, 1, 1, 1), strict=True))


def rest_at_the_worst_place(package: ModuleType, part: float) -> Trajectory:
    """Return a second at rest with this part of the errors that the machines of the campaign have at most."""
    rig = loops.of(package.subject().block)
    rig = replace(
        rig,
        gain_errors={n: part * interface.HALL_GAIN_ERROR * s for n, s in GAINS.items()},
        offsets={n: part * interface.HALL_OFFSET * s for n, s in OFFSETS.items()},
    )
    still = {axis: np.full(round(1.0 / rig.period_s), at) for axis, at in PLACE.items()}
    return loops.simulate(rig, 1.0, still, PLACE)


@pytest.mark.parametrize("package", [leadlag, lqg])
@pytest.mark.parametrize(("part", "low", "high"), [(0.0, 0.0, 1e-3), (0.4, 4e-3, 6e-3), (1.0, 12e-3, 15e-3)])
def test_errors_of_the_channels_turn_the_platen_and_set_no_bit(
    package: ModuleType, part: float, low: float, high: float
) -> None:
    run = rest_at_the_worst_place(package, part)
    assert low <= abs(run["phi"][-400:].mean()) <= high and not run.faults.any()


def test_header_and_datasheet_say_so() -> None:
    notes, further = (" ".join(of) for of in (leadlag.DESIGN.header_notes, leadlag.DESIGN.datasheet_notes))
    assert "to 0.2 % and its offset to 2 mV" in notes and "up to 6 mrad" in notes
    assert "off by 0.5 % and its offset by 5 mV the platen turns by up to 15 mrad" in further
    assert (interface.HALL_GAIN_ERROR, interface.HALL_OFFSET) == (5e-3, 5e-3)
    assert abs(rest_at_the_worst_place(lqg, 1.0)["phi"]).max() > 20e-3
