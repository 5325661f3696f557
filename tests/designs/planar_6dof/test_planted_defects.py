"""What verification must detect in both planar designs: in the C, the constants, and at the limits of the motors."""

from dataclasses import replace

import numpy as np
import pytest

from designs.planar_6dof import random_steps
from designs.planar_6dof.random_steps import Subject
from designs.planar_6dof_leadlag import design as leadlag
from designs.planar_6dof_lqg import design as lqg
from synth.verify import agree
from tests.designs.planar_6dof import planted
from tests.designs.planar_6dof.planted import WitnessSteps

SUBJECTS = {"leadlag": leadlag.subject, "lqg": lqg.subject}


@pytest.fixture(scope="module", params=SUBJECTS)
def design(request: pytest.FixtureRequest) -> Subject:
    return SUBJECTS[request.param]()


@pytest.fixture(scope="module")
def at(design: Subject) -> WitnessSteps:
    return planted.witness_steps(design)


def test_the_sound_reference_is_no_defect(at: WitnessSteps) -> None:
    assert not planted.is_detected(at, agree.reference(at.subject.reference))
    assert not planted.is_detected(at, agree.casadi(at.subject.block))


def test_steps_that_are_mostly_at_the_limits(design: Subject) -> None:
    subject = replace(design, size=3.0)
    at = planted.witness_steps(subject, edges=0)
    assert np.mean(random_steps.is_saturated(at.c64.outputs)) > 0.9
    assert not planted.is_detected(at, agree.reference(subject.reference))
    assert not planted.is_detected(at, agree.casadi(subject.block))


def test_every_constant_counts(at: WitnessSteps) -> None:
    few = planted.thinned(at, 9)
    assert [name for name, witness in planted.constants(few, 1.05) if not planted.is_detected(few, witness)] == []


def test_a_wrong_sign_in_the_c_is_reported(at: WitnessSteps) -> None:
    missed = [line for line, witness in planted.mutants(at, 24) if not planted.is_detected(at, witness)]
    assert missed == []


def test_without_optimisation_the_sound_c_is_no_defect(at: WitnessSteps) -> None:
    """So a difference after a wrong sign comes from the sign."""
    assert not planted.is_detected(at, agree.emitted_c(planted.unoptimised(at.emitted)))
