"""A sensor fails: what is flagged and when, what goes on, and what nobody can see."""

import numpy as np
import pytest

from designs.hall_position import failures, fisher, fleet, layout_search, shipped
from designs.hall_position.endurance import Limits
from designs.hall_position.failures import FAILURES, SOON
from designs.hall_position.fleet import Kind
from designs.hall_position.parameters import Tuning
from synth.execute import host

THREE = Kind(shipped.array(shipped.THREE))
# The field as well known as the noise lets residuals tell, ten deviations.
FOUR = Kind(layout_search.placed(shipped.array(), layout_search.SPARE), Tuning(residual=0.01))
MOVING = Limits(0.5, 5.0)
BODIES = 500


def test_the_layout_leaves_any_three_of_four_sensors_with_no_singular_place() -> None:
    at = layout_search.poses(FOUR.array, np.radians(5), (40, 5))
    task = layout_search.Task(sensors=4, spare=True)
    for left in layout_search.remaining(task, layout_search.SPARE):
        deviations = fisher.deviations(layout_search.placed(FOUR.array, left), at)
        assert layout_search.cost(deviations, task.lever) < 11e-6


@pytest.mark.parametrize("within", [None, MOVING], ids=["at rest", "moving"])
@pytest.mark.parametrize("failure", FAILURES)
def test_a_residual_out_of_its_bound_is_flagged_at_once(failure: str, within: Limits | None) -> None:
    for kind in (THREE, FOUR):
        found = failures.tried(kind, failure, 2, BODIES, within)
        assert found.late == 0 <= SOON
        assert found.out > 0.6 or (failure, within) == ("stuck", None) or failure == "no number"


@pytest.mark.parametrize("failure", ["dead", "saturated", "no number"])
@pytest.mark.parametrize("sensor", [1, 2, 3, 4])
def test_of_four_sensors_any_one_may_be_lost(failure: str, sensor: int) -> None:
    """Within 10 deviations all of them, and rms as far as these say."""
    for within in (None, MOVING):
        found = failures.tried(FOUR, failure, sensor, BODIES, within)
        assert found.flagged == 1 and found.lost == 0 and found.valid > 0.99
        assert 0.9 < found.error < 1.1 and found.away < 0.005 and found.worst < 1.5e-4
        assert found.named == (failure != "no number")


@pytest.mark.parametrize("failure", ["dead", "saturated"])
@pytest.mark.parametrize("sensor", [1, 2, 3])
def test_of_three_sensors_it_is_named_and_four_voltages_go_on_until_they_lose_rank(failure: str, sensor: int) -> None:
    found = failures.tried(THREE, failure, sensor, BODIES, None)
    assert found.named > 0.98 and found.lost < 0.02 and found.valid > (0.5 if sensor == 2 else 0.9)
    assert found.away < 0.02 and found.worst < 1.5e-3
    assert "named [%]" in str(found)


def test_what_is_not_seen_does_little_harm() -> None:
    """One axis that is dead where it reads next to nothing, and whatever is stuck at rest."""
    dead, stuck = (failures.unseen(FOUR, name, 1, 32) for name in ("one axis", "stuck"))
    assert stuck.unseen.all() and stuck.error.max() < 2e-5
    assert 0 < dead.unseen.mean() < 0.1 and dead.error.max() < 1e-4
    at = dead.X[:, np.newaxis] + FOUR.array.positions[0][0]
    read = np.broadcast_to(fisher.field(FOUR.array, FOUR.array.wave_number * at), dead.unseen.shape)
    assert np.abs(read[dead.unseen > 0]).max() < 0.05  # V: a true zero
    assert not failures.unseen(FOUR, "saturated", 1, 24).unseen.any()


def test_an_estimate_without_flags_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    stepped = fleet.stepped

    def blind(kind: Kind, state: host.Records, volts: fleet.Numbers) -> host.Batch:
        """Goes on with all sensors and is always valid."""
        state["estimator_without"] = 0
        batch = stepped(kind, state, volts)
        always = np.ones(len(state))
        return batch._replace(outputs=batch.outputs | {"valid": always, "without": 0 * always}, faults=0 * batch.faults)

    monkeypatch.setattr(fleet, "stepped", blind)
    found = failures.tried(FOUR, "dead", 1, BODIES, MOVING)
    assert found.late > SOON and found.flagged == 0 and found.away > 0.5
