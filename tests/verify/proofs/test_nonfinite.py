"""Infinite and NaN inputs must act as finite inputs out of range; a NaN that passes the guard is detected."""

from collections.abc import Callable
from typing import Any

import pytest

from synth.verify.proofs import contract
from tests import tools

Plant = Callable[[str, str], dict[str, str]]
pytestmark = tools.needs("clang", shows="that infinite and NaN inputs act as finite ones out of range")
GUARD = "(0.0125f <= in->g1) && (in->g1 <= 0.0365f)"


def test_every_special_input_acts_as_a_bad_input(files: dict[str, str], manifest: dict[str, Any]) -> None:
    same = contract.compare(files, manifest)
    assert (same.inputs, same.compared, same.different) == (("g1", "g2", "r"), 3 * 4, ())
    assert all(check.passed for check in same.checks())


@pytest.mark.parametrize(
    ("old", "new", "different"),
    [
        (GUARD, "!((in->g1 < 0.0125f) || (in->g1 > 0.0365f))", ("g1 = nan", "g1 = negative_nan")),
        (GUARD, "(0.0125f <= in->g1) && !(in->g1 > 0.0365f)", ()),
        ("e = (0.5f * (g1 + g2)) - r", "e = (0.5f * (g1 + g2)) - ((in->r < 1.0f) ? r : 0.02f)", ("r = minus_inf",)),
    ],
    ids=["NaN let through", "NaN refused in another way", "used past the guard"],
)
def test_differing_inputs_are_named(
    planted: Plant, manifest: dict[str, Any], old: str, new: str, different: tuple[str, ...]
) -> None:
    same = contract.compare(planted(old, new), manifest)
    assert same.different == different
    assert all(check.passed for check in same.checks()) == (not different)


SCOPES = "load a, !noalias !{0}\ncall @llvm.experimental.noalias.scope.decl(metadata !{1})\nload b, !alias.scope !{0}\n"


def test_scopes_of_aliasing_differ_in_their_numbers_alone() -> None:
    """Each inlined copy of a function that returns a struct has its own; which accesses share one must be the same."""
    first, second, other = (contract._numbered(SCOPES.format(*pair)) for pair in ((156, 160), (162, 157), (9, 9)))
    assert first == second != other
    assert contract._numbered("load a, !tbaa !64") == "load a, !tbaa !64"
