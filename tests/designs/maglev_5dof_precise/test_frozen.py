"""Encoders of x and z that freeze at rest, on 17 plants: the probe names them before an end of travel.

Which plants travel far depends on the last digits of the simulation: docs/decisions/maglev_precise.md.
"""

from dataclasses import replace
from functools import partial

from designs.maglev import fault_handling
from designs.maglev_5dof_precise import control
from designs.maglev_5dof_precise.design import DESIGN, PLANT
from synth.app import standard_tasks
from synth.base.progress import silent
from synth.blocks.faults import probe
from synth.simulate.faults import campaign, injections

PLANTS, TRAVEL = 17, 10e-3  # m


def travel_and_time_to_notice(at_rest: probe.Probe) -> tuple[float, float]:
    """Return the largest travel in m and time to notice in s, frozen for good, on all plants."""
    assert DESIGN is not None
    controller = fault_handling.controller(control.NAME, PLANT, partial(control.laws, PLANT), at_rest)
    stage = replace(DESIGN, controller=controller)
    rig = campaign.with_stops(standard_tasks.rig(stage, stage.scalar))
    still = campaign.motion_and_standstill(rig)[0]
    permanent = [f for f in injections.derive(stage) if (f.kind, f.duration) == ("frozen", "permanent")]
    frozen = [f for f in permanent if f.target in ("x", "z")]
    runs = [run for i in range(PLANTS) for run in campaign.run(rig, i, still, silent, frozen)[1]]
    assert len(runs) == 2 * PLANTS and not any(run.wrong_names for run in runs)
    return max(run.excursion[axis] for run in runs for axis in "xz"), max(run.notice_s for run in runs)


def test_an_encoder_that_freezes_at_rest_is_named_in_time() -> None:
    travel, notice = travel_and_time_to_notice(control.PROBE)
    assert travel < TRAVEL and notice < 0.1
