"""Where starts lead, and that nothing is valid away from the truth."""

import numpy as np
import pytest

from designs.hall_position import basin, fleet, shipped
from designs.hall_position.fleet import Kind
from synth.execute import host

TWO, THREE = (Kind(shipped.array(name)) for name in (shipped.NAME, shipped.THREE))
YAW = np.radians(4.5)  # within the five degrees that a search assumes
BODIES = 10_000


def test_of_three_sensors_every_start_within_a_sixteenth_of_a_pitch_leads_to_the_truth() -> None:
    found = basin.mapped(THREE, BODIES, YAW)
    near, small = found.off < THREE.array.pitch / 15.9, found.turned < np.radians(7.6)
    assert found.wrong == 0 and found.samples == 60 * BODIES
    assert (found.first[np.ix_(near, small)] == 1).all() and (found.then[:, found.turned < np.radians(5.1)] == 1).all()
    # A sample corrects no more than half the reach, 4 mm, along each axis.
    assert not found.first[found.off > 0.2 * THREE.array.pitch].any()
    assert "then [%]" in str(found)


def test_of_two_sensors_some_lead_elsewhere_and_none_is_valid_there() -> None:
    found = basin.mapped(TWO, BODIES, YAW)
    assert found.wrong == 0 and 0.9 < found.first[0, 0] < 0.99 and 0.9 < found.then[0, 0] < 1


def test_a_map_over_the_pitch_shows_where_starts_must_be_nearer() -> None:
    three, two = basin.over_pitch(THREE, 16), basin.over_pitch(TWO, 16)
    assert three.reach.shape == (16, 16) and three.reach.min() > 3e-3
    # Near singular places the nearest start leads to the other way out.
    assert 0.01 < (two.reach < 1e-3).mean() < 0.3 and np.median(two.reach) > 3e-3
    assert (two.reach <= three.reach.max()).all() and two.X[1] == pytest.approx(0.0508 / 16)


@pytest.mark.parametrize("kind", [TWO, THREE], ids=["two", "three"])
def test_places_that_are_valid_wherever_the_estimate_converges_are_seen(
    kind: Kind, monkeypatch: pytest.MonkeyPatch
) -> None:
    stepped = fleet.stepped

    def careless(kind: Kind, state: host.Records, volts: fleet.Numbers) -> host.Batch:
        batch = stepped(kind, state, volts)
        return batch._replace(outputs=batch.outputs | {"valid": batch.outputs["converged"]})

    monkeypatch.setattr(fleet, "stepped", careless)
    assert basin.mapped(kind, 1000, YAW).wrong > 10
