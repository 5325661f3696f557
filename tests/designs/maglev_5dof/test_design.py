"""What every design gets: what is committed, and planted defects. `test_verification` has the evidence, over the whole
replay, which begins with the short one.
"""

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
