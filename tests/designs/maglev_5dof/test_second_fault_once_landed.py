"""A second encoder that freezes once the platen has landed, or while it lands, does not lift it from its stop."""

import numpy as np
import pytest

from designs.maglev_5dof.design import DESIGN
from designs.maglev_5dof_precise.design import DESIGN as PRECISE
from synth.app import standard_tasks
from synth.simulate.faults import campaign
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory, sample_times
from tests.designs.maglev_5dof.test_fault_campaign import with_defect

pytestmark = pytest.mark.slow

LOST, DURATION, AT = 100, 2.5, 0.01  # sample, s, m
LOWER_STOP = 0.031  # m
RIGS = {d.name: campaign.with_stops(standard_tasks.rig(d, d.scalar)) for d in (DESIGN, PRECISE)}


def frozen_after_loss(rig: Rig, lost: str, frozen: str, after: int) -> Trajectory:
    """Return a run from rest in which one encoder is lost and the other one freezes so many samples later."""
    k = np.arange(len(sample_times(DURATION, rig.period_s)))
    noise = {lost: np.where(k < LOST, 0.0, 1.0)}  # m, out of its range
    references = {f"{n}_ref": np.full(len(k), AT) for n in "xz"}
    lags = {frozen: np.clip(k - LOST - after + 1, 0, None)}
    return rig.run(DURATION, dict.fromkeys("xz", AT), references, noise=noise, lags=lags)


def lifts(run: Trajectory) -> bool:
    """Return whether the platen leaves its stop after it has been there, by more than 1 mm."""
    y = run.states["y"]
    return bool(np.min(y[np.argmax(y > LOWER_STOP - 1e-5) :]) < LOWER_STOP - 1e-3)


@pytest.mark.parametrize("name", RIGS)
@pytest.mark.parametrize(("lost", "frozen"), ["xz", "zx"])
@pytest.mark.parametrize("after", [10, 300, 1000])
def test_an_encoder_that_freezes_without_the_other_one_leaves_the_platen_on_its_stop(
    name: str, lost: str, frozen: str, after: int
) -> None:
    run = frozen_after_loss(RIGS[name], lost, frozen, after)
    assert run.states["y"][-1] > LOWER_STOP - 1e-5 and not lifts(run)
    assert run.impacts["y"] < 0.05 and max(run.impacts[n] for n in "xz") == 0  # m/s
    assert max(abs(run.commands[f"i_d{j}"][-1]) for j in (1, 2, 3, 4)) == 0


def test_with_repelling_current_on_the_stop_the_platen_is_lifted() -> None:
    """The planted defect: the safe output of a latch in flight once landed, too."""
    planted = with_defect(RIGS[DESIGN.name], "(rests) ? 0.0f : safe_i_d", "safe_i_d")
    assert lifts(frozen_after_loss(planted, "x", "z", 1000))
