"""Directions in which parameters may go are told in their own changes."""

import numpy as np

from synth.synthesise.identify import undetermined


def told(direction: list[float], near: list[float] | None) -> list[str]:
    """Return what is told where a direction (2,) and no other leaves the data as they are."""
    sigma, V = np.linalg.svd(np.array([[direction[1], -direction[0]]]) * [1.0, 1.0])[1:]
    size = np.abs([direction[1], direction[0]])
    _, sigma, V = np.linalg.svd(np.array([[direction[1], -direction[0]], [0.0, 0.0]]) / size)
    return undetermined.combinations(sigma, V.T, size, ("a", "b"), None if near is None else np.array(near))


def test_unlike_units_are_told_as_proportions() -> None:
    values = [1e-9, 2e9]
    assert told(values, values) == ["a and b in proportion"]
    assert told([1e-9, -2e9], values) in (["a and 1/b in proportion"], ["1/a and b in proportion"])
    assert told([2e-9, 2e9], values) == ["a change of a by +100 % and b by +50 %"]


def test_without_values_the_direction_itself_is_told() -> None:
    assert told([3.0, -4.0], None) == ["0.6 a - 0.8 b"]
    assert told([3.0, -4.0], [0.0, 1.0]) == ["0.6 a - 0.8 b"]
