"""Verification tells the sound LQG controller from one with a defect, in its C, its constants or the reference."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from designs.planar_6dof import random_steps, reference_control
from designs.planar_6dof_lqg import design, reference
from synth.verify import agree
from tests.designs.planar_6dof import planted
from tests.designs.planar_6dof.planted import WitnessSteps


@pytest.fixture(scope="module")
def at() -> WitnessSteps:
    return planted.witness_steps(design.subject())


def test_the_sound_reference_is_no_defect(at: WitnessSteps) -> None:
    assert not planted.is_detected(at, agree.reference(reference.step))
    assert not planted.is_detected(at, agree.casadi(at.subject.block))


def test_steps_that_are_mostly_at_the_limits() -> None:
    subject = replace(design.subject(), size=3.0)
    at = planted.witness_steps(subject, edges=0)
    assert np.mean(random_steps.is_saturated(at.c64.outputs)) > 0.9
    assert not planted.is_detected(at, agree.reference(reference.step))
    assert not planted.is_detected(at, agree.casadi(subject.block))


def test_every_constant_counts(at: WitnessSteps) -> None:
    few = planted.thinned(at, 9)
    assert [name for name, witness in planted.constants(few, 1.05) if not planted.is_detected(few, witness)] == []


def test_a_wrong_sign_in_the_c_is_reported(at: WitnessSteps) -> None:
    missed = [line for line, witness in planted.mutants(at, 24) if not planted.is_detected(at, witness)]
    assert missed == []


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
