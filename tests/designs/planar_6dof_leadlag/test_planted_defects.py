"""Verification tells the sound lead-lag controller from one with a defect, in its C, its constants or the reference."""

from fractions import Fraction
from typing import Any

import pytest

from designs.planar_6dof import reference_control, reference_sensing
from designs.planar_6dof.random_steps import Subject
from designs.planar_6dof_leadlag import reference
from designs.planar_6dof_leadlag.design import subject
from synth.verify import agree
from tests.designs.planar_6dof import planted
from tests.designs.planar_6dof.planted import WitnessSteps
from tests.designs.planar_6dof.planted_cases import *  # noqa: F403


@pytest.fixture(scope="module")
def design() -> Subject:
    return subject()


@pytest.mark.parametrize(
    ("module", "name", "value"),
    [
        (reference, "GAIN", reference.GAIN | {"x": "-15000"}),
        (reference, "GAIN_SHARE", reference.GAIN_SHARE | {"phi": "0.51"}),
        (reference, "RESET", Fraction("0.1001")),
        (reference_control, "VERTICAL", reference_control.VERTICAL | {"psi": ("1100", "80.0414", "604.199", "0.15")}),
        (reference_control, "CENTRES", {m: reference_control.CENTRES[n] for m, n in zip("ABC", "BAC", strict=True)}),
        (reference_control, "QUADRATURE", 0.96 * reference_control.LIMIT),
        (reference_control, "GAMMA", reference_control.GAMMA * (1 + 1e-9)),
        (reference_control, "BAD_SAMPLES", 4),
        (reference_control, "SLEW", 125.0),
        (reference_sensing, "PITCH", reference_sensing.PITCH * (1 + 1e-9)),
        (reference_sensing, "EXCESS_BOUND", 0.149),
        (reference_sensing, "RESIDUAL_BOUND", 0.081),
        (reference_sensing, "MEMORY", 2.0),
        (reference_sensing, "MAX_RAW_YAW", 0.0249),
        (reference_sensing, "COUNT", 3),
        (reference_sensing, "FASTEST", reference_sensing.FASTEST | {"phi": 6.9}),
        (reference_control, "BRAKING", 23),
        (reference_control, "REMAINING", 0.51),
        (reference_control, "INERTIAS", reference_control.INERTIAS | {"phi": 0.00221}),
        (reference, "BANDWIDTH", reference.BANDWIDTH | {"phi": 8.01}),
    ],
)
def test_a_wrong_number_in_the_reference_is_reported(
    at: WitnessSteps, monkeypatch: pytest.MonkeyPatch, module: Any, name: str, value: object
) -> None:
    assert hasattr(module, name)
    monkeypatch.setattr(module, name, value)
    fresh()
    assert planted.is_detected(at, agree.reference(reference.step))
    monkeypatch.undo()
    fresh()


def fresh() -> None:
    """Forget the numbers that the reference has computed."""
    for cached in (
        reference.compensators,
        reference_sensing.constants,
        reference_control.vertical,
        reference_control.scales,
    ):
        cached.cache_clear()


def test_a_wrong_section_in_the_reference_is_reported(at: WitnessSteps, monkeypatch: pytest.MonkeyPatch) -> None:
    """The other sensor's section is entered at |s| > 1.01 |c|, where both of them tell the position nearly as well."""
    place = reference_sensing.Pair.place.fget
    assert place is not None

    def late(self: reference_sensing.Pair) -> Any:
        return place(reference_sensing.Pair(self.s / 1.01, self.c, self.k))

    monkeypatch.setattr(reference_sensing.Pair, "place", property(late))
    assert planted.is_detected(at, agree.reference(reference.step))
