"""What every design gets: what is committed, and planted defects. `test_verification` has the evidence, over the whole
replay, which begins with the short one.
"""

import importlib

import pytest

from synth.report import standard
from synth.testing import (
    test_defects_that_are_planted_are_found,
    test_the_c_compiles_without_a_warning,
    test_the_committed_files_are_regenerated_byte_for_byte,
)

__all__ = [
    "test_defects_that_are_planted_are_found",
    "test_the_c_compiles_without_a_warning",
    "test_the_committed_files_are_regenerated_byte_for_byte",
]


@pytest.mark.parametrize("name", ["maglev_5dof", "maglev_5dof_precise"])
def test_the_equations_of_the_law_are_shown(name: str) -> None:
    """The section checks each equation against the Block, and fails for a signal without a value."""
    stage = importlib.import_module(f"designs.{name}.design").DESIGN
    assert standard.law(stage.controller.block).title == standard.LAW
