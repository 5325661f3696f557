"""Layouts by their protection levels: the C agrees, the layout that ships is better than others, and a search."""

import numpy as np
import pytest

from designs.hall_position.protected import config
from studies.hall.protected import layout, trust

pytestmark = pytest.mark.whole

PROTOTYPE = ((-0.239, 0.1), (0.425, -0.226), (0.115, 0.447))


@pytest.mark.parametrize("name", config.PLACES)
def test_the_levels_are_those_of_the_c(name: str) -> None:
    """In the field of the model the C and these levels differ by the linearisation about another pose only."""
    tuning = config.TUNINGS[name]
    samples = trust.run(tuning, "own", "none", 800, name=name)
    share = layout.availability(config.PLACES[name], tuning)
    assert samples.valid.mean() == pytest.approx(share, abs=0.03)


def test_three_sensors_are_better_than_the_prototype_and_at_its_own_limits_worse() -> None:
    ships, other = (layout.availability(p, config.CALIBRATED_THREE) for p in (config.PLACES[config.THREE], PROTOTYPE))
    assert ships > 0.85 > other
    assert layout.availability(PROTOTYPE, config.CALIBRATED) == pytest.approx(0.41, abs=0.02)


def test_an_undetectable_fault_has_no_level() -> None:
    """Without the third sensor two at one place are left, which do not determine a pose."""
    twins = np.array([(0.1, 0.1), (0.1, 0.1), (-0.2, 0.3)])
    assert layout.availability(twins, config.CALIBRATED_THREE, 100) == 0


def test_the_command_prints_what_ships_and_what_it_finds(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(layout, "PERTURBATIONS", 2)
    monkeypatch.setattr(layout, "FINE", 50)
    monkeypatch.setattr(layout, "COARSE", 50)
    layout.main(3, 6)
    lines = capsys.readouterr().out.splitlines()
    assert [line.split(":")[0] for line in lines] == ["ships", "found"]
    assert all("% of the poses" in line for line in lines)
