"""The ensemble behind the loop's limits: available without a failure, and wider limits alone mislead more often."""

import pytest

from studies.hall.loop import four_sensors, limits

pytestmark = pytest.mark.whole

BODIES = 600


def test_the_loops_limits_are_available_and_mislead_less_than_the_wide_ones() -> None:
    none = limits.samples("loop", "none", BODIES)
    assert none.valid.mean() > 0.995 and none.levels[..., :2].max() < four_sensors.POSITION_LIMIT
    wide, loop = (limits.samples(name, limits.WORST, BODIES).outcome() for name in ("wide", "loop"))
    assert loop.valid < wide.valid and loop.wrong <= wide.wrong


def test_the_command_names_each_of_the_limits() -> None:
    text = list(limits.lines(20))
    assert len(text) == 10 and [line.split()[0] for line in text[4::2]] == ["calibrated", "wide", "loop"]
