"""Each fault changes the channels that it names, of the body's own group, and no other."""

import numpy as np
import pytest

from synth.simulate.faults import failure_experiments
from synth.simulate.faults.failure_experiments import GroupFailure

N, GROUPS, CHANNELS = 6, 3, 2
FAULTS = failure_experiments.faults(offset=0.5, drift=0.1, end=9.0)
RNG = np.random.default_rng(0)
Y, KEPT = RNG.standard_normal((N, GROUPS, CHANNELS)), RNG.standard_normal((N, CHANNELS))
GROUP, CHANNEL = np.arange(N) % GROUPS, np.arange(N) % CHANNELS


def corrupted(name: str, since: int = 4) -> np.ndarray:
    y = Y.copy()
    GroupFailure(FAULTS[name], GROUP, CHANNEL, KEPT).corrupt(y, since)
    return y


@pytest.mark.parametrize("name", FAULTS)
def test_only_the_failing_channels_change(name: str) -> None:
    changed = corrupted(name) != Y
    others = np.ones_like(changed)
    others[np.arange(N), GROUP] = False
    assert not changed[others].any()
    count = 0 if name == "none" else CHANNELS if "group" in name else 1
    assert (changed.sum(axis=(1, 2)) == count).all()
    if count == 1:
        assert changed[np.arange(N), GROUP, CHANNEL].all()


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("dead channel", 0 * Y),
        ("saturated", 0 * Y + 9.0),
        ("offset", Y + 0.5),
        ("drift", Y + 0.4),
        ("halved group", Y / 2),
        ("stuck channel", np.broadcast_to(KEPT[:, None], Y.shape)),
        ("frozen group", np.broadcast_to(KEPT[:, None], Y.shape)),
    ],
)
def test_the_values_are_those_of_the_fault(name: str, expected: np.ndarray) -> None:
    each = np.arange(N), GROUP, CHANNEL
    assert (corrupted(name)[each] == expected[each]).all()


def test_only_frozen_ones_keep_the_last_values() -> None:
    assert [n for n in FAULTS if failure_experiments.is_frozen(n)] == ["frozen channel", "frozen group"]
