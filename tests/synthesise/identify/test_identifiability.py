"""Text for undetermined parameter combinations, in relative changes."""

import numpy as np

from synth.synthesise.identify import estimates


def combinations(direction: list[float], near: list[float] | None) -> list[str]:
    """Return the text for a direction (2,) that is the only undetermined one."""
    sigma, V = np.linalg.svd(np.array([[direction[1], -direction[0]]]) * [1.0, 1.0])[1:]
    size = np.abs([direction[1], direction[0]])
    _, sigma, V = np.linalg.svd(np.array([[direction[1], -direction[0]], [0.0, 0.0]]) / size)
    return estimates.undetermined_combinations(sigma, V.T, size, ("a", "b"), None if near is None else np.array(near))


def test_different_units_are_stated_as_proportions() -> None:
    values = [1e-9, 2e9]
    assert combinations(values, values) == ["a and b in proportion"]
    assert combinations([1e-9, -2e9], values) in (["a and 1/b in proportion"], ["1/a and b in proportion"])
    assert combinations([2e-9, 2e9], values) == ["a change of a by +100 % and b by +50 %"]


def test_without_values_the_direction_itself_is_stated() -> None:
    assert combinations([3.0, -4.0], None) == ["0.6 a - 0.8 b"]
    assert combinations([3.0, -4.0], [0.0, 1.0]) == ["0.6 a - 0.8 b"]
