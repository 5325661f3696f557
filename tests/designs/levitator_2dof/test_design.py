"""The tests that every stage has: what is committed, the evidence, and planted defects."""

import pytest

from designs.levitator_2dof.design import DESIGN
from synth.declare.stage import Stage
from synth.testing import (
    test_defects_that_are_planted_are_found,
    test_the_c_compiles_without_a_warning,
    test_the_committed_files_are_regenerated_byte_for_byte,
    test_the_evidence_passes,
)

__all__ = [
    "test_defects_that_are_planted_are_found",
    "test_the_c_compiles_without_a_warning",
    "test_the_committed_files_are_regenerated_byte_for_byte",
    "test_the_evidence_passes",
]


@pytest.fixture(scope="session")
def design() -> Stage:
    return DESIGN
