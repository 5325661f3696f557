"""Where starts lead, and that nothing is valid away from the truth."""

from typing import Any

import numpy as np
import pytest

from designs.hall_position import shipped
from designs.hall_position.glsdc.parameters import Tuning
from designs.hall_position.trust import basin, fleet
from designs.hall_position.trust.fleet import Kind
from synth.errors import ModelError
from synth.execute import host

TWO, THREE = (Kind(shipped.array(name)) for name in (shipped.NAME, shipped.THREE))
YAW = np.radians(4.5)  # within the five degrees that a search assumes
BODIES = 10_000


def test_of_three_sensors_every_start_within_a_sixteenth_of_a_pitch_leads_to_the_truth() -> None:
    """In a sample those whose yaw is off by up to 2.5 degrees, as it is held to the expected one; later all."""
    found = basin.mapped(THREE, BODIES, YAW)
    near, small = found.off < THREE.array.pitch / 15.9, found.turned < np.radians(2.6)
    assert found.wrong == 0 and found.samples == 60 * BODIES
    assert (found.first[np.ix_(near, small)] == 1).all() and (found.then == 1).all()
    # A sample corrects no more than half the reach, 4 mm, along each axis.
    assert not found.first[found.off > 0.2 * THREE.array.pitch].any()


def test_of_two_sensors_some_lead_elsewhere_and_none_is_valid_there() -> None:
    found = basin.mapped(TWO, BODIES, YAW)
    assert found.wrong == 0 and 0.5 < found.first[0, 0] < 0.7 and 0.9 < found.then.mean() < 1


def test_a_map_over_the_pitch_shows_where_starts_must_be_nearer() -> None:
    loose = Kind(TWO.array, Tuning(firm=1.0))
    three, two, other = (basin.over_pitch(kind, 16) for kind in (THREE, TWO, loose))
    assert three.reach.shape == (16, 16) and three.reach.min() > 3e-3 and two.reach.min() > 3e-3
    # Near singular places the nearest start leads to the other way out, but for the yaw that is held.
    assert 0.01 < (other.reach < 1e-3).mean() < 0.3 and np.median(other.reach) > 3e-3
    assert (other.reach <= three.reach.max()).all() and two.X[1] == pytest.approx(0.0508 / 16)


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


@pytest.mark.parametrize("number", [0, -1, 2.5, None, True])
def test_no_bodies_samples_or_points_are_refused(number: Any) -> None:
    with pytest.raises(ModelError, match="number of bodies is"):
        basin.mapped(THREE, number, YAW, 1)
    with pytest.raises(ModelError, match="number of samples is"):
        basin.mapped(THREE, 1, YAW, number)
    with pytest.raises(ModelError, match="number of points is"):
        basin.over_pitch(THREE, number)


@pytest.mark.parametrize("yaw", [float("nan"), None, "1"])
def test_a_yaw_that_is_none_is_refused(yaw: Any) -> None:
    for asked in (lambda: basin.mapped(THREE, 1, yaw, 1), lambda: basin.over_pitch(THREE, 1, yaw)):
        with pytest.raises(ModelError, match="the yaw is"):
            asked()
    with pytest.raises(ModelError, match=r"the yaw is -0.1 rad"):
        basin.mapped(THREE, 1, -0.1, 1)


@pytest.mark.filterwarnings("error")
def test_where_no_start_was_drawn_there_is_no_share() -> None:
    found = basin.mapped(THREE, 4, YAW, 1)
    assert np.isnan(found.first).sum() >= found.first.size - 4 and np.isfinite(found.first).any()
