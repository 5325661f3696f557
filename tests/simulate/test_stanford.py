"""Stanford diagram: regions and counts of samples that lie where each of them should."""

from typing import Any

import numpy as np
import pytest

from synth.errors import ModelError, SignalError
from synth.simulate import worst_case

ERRORS = [0.1, -0.6, 1.2, 0.3, 0.2, 0.2]
LEVELS = [0.5, 0.5, 0.8, 1.5, 0.5, 1.0]
VALID = [1, 1, 1, 1, 0, 1]


def test_each_sample_lies_in_its_region() -> None:
    of = worst_case.diagram(ERRORS, LEVELS, VALID, limit=1.0, unit="m")
    assert (of.nominal, of.misleading, of.hazardous, of.unavailable) == (2, 1, 1, 2)
    assert of.samples == 6 and of.risk == pytest.approx(2 / 6) and of.availability == pytest.approx(4 / 6)


def test_the_counts_are_those_of_the_valid_samples() -> None:
    counts = worst_case.diagram(ERRORS, LEVELS, VALID, limit=1.0, steps=2).counts
    assert counts.tolist() == [[1, 1, 1], [1, 0, 0], [0, 1, 0]]


def test_an_error_at_its_level_is_nominal_and_one_beyond_is_not() -> None:
    assert worst_case.diagram([0.5], [0.5], [1], limit=1.0).misleading == 0
    assert worst_case.diagram([np.nextafter(0.5, 1)], [0.5], [1], limit=1.0).misleading == 1


def test_the_diagram_shows_its_regions() -> None:
    text = repr(worst_case.diagram(ERRORS, LEVELS, VALID, limit=1.0, unit="m"))
    assert "6 samples, alert limit 1 m" in text and "hazardous" in text


@pytest.mark.parametrize(
    ("changed", "error"),
    [
        ({"errors": [0.1]}, SignalError),
        ({"errors": [[0.1]]}, SignalError),
        ({"levels": [np.nan] * 6}, SignalError),
        ({"limit": 0.0}, ModelError),
        ({"steps": 0}, ModelError),
        ({"valid": "yes"}, SignalError),
    ],
)
def test_samples_that_do_not_fit_are_refused(changed: dict[str, Any], error: type[Exception]) -> None:
    with pytest.raises(error):
        worst_case.diagram(**({"errors": ERRORS, "levels": LEVELS, "valid": VALID, "limit": 1.0} | changed))
