"""Verification tells the sound LQG controller from one with a defect, in its C, its constants or the reference."""

from typing import Any

import pytest

from designs.planar_6dof import reference_control
from designs.planar_6dof.random_steps import Subject
from designs.planar_6dof_lqg import reference
from designs.planar_6dof_lqg.design import subject
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
        (reference, "WEIGHTS", reference.WEIGHTS | {"y": (1e4, 1e9, 1e1)}),
        (reference, "POLE", reference.POLE | {"phi": "0.89"}),
        (reference, "PER_AMPERE", 13.2548),
        (reference, "YAW_PER_AMPERE", -reference.YAW_PER_AMPERE),
        (reference_control, "CENTRES", {m: reference_control.CENTRES[n] for m, n in zip("ABC", "BAC", strict=True)}),
    ],
)
def test_a_wrong_number_in_the_reference_is_reported(
    at: WitnessSteps, monkeypatch: pytest.MonkeyPatch, module: Any, name: str, value: object
) -> None:
    assert hasattr(module, name)
    monkeypatch.setattr(module, name, value)
    reference.axes.cache_clear()
    assert planted.is_detected(at, agree.reference(reference.step))
    monkeypatch.undo()
    reference.axes.cache_clear()
