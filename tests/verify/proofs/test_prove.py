"""All proofs together: they pass on correct C, report progress, and each defect fails the affected checks."""

from collections.abc import Callable
from typing import Any

import pytest

from synth.verify.proofs import prove
from tests import tools

Plant = Callable[[str, str], dict[str, str]]
pytestmark = tools.needs(*tools.PROVERS, shows="that all proofs pass on correct C and fail on a planted defect")


@pytest.fixture(autouse=True)
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(prove, "SUBSET_STEPS", 20_000)
    monkeypatch.setattr(prove, "WHOLE_STEPS", 40_000)


@pytest.mark.parametrize(("whole", "steps"), [(False, 20_000), (True, 40_000)])
def test_sound_c_passes_at_either_depth(
    files: dict[str, str], manifest: dict[str, Any], whole: bool, steps: int
) -> None:
    messages: list[str] = []
    checks = prove.prove(files | {"gains.json": "{}"}, manifest, whole, messages.append)
    assert all(check.passed for check in checks)
    reported_steps = ["Eva", "partial evaluation", "fuzzing", "cppcheck --addon=misra", "latch"]
    assert [line.split(":")[0] for line in messages] == reported_steps
    assert any(f"{steps} steps" in check.about for check in checks if check.name == "fuzzing: findings")


def test_a_defect_fails_the_checks_that_it_affects(planted: Plant, manifest: dict[str, Any]) -> None:
    checks = prove.prove(planted("clamped(scale * i1, -4.95f, 4.95f)", "2.0f * i1"), manifest, False, lambda _: None)
    assert {check.name for check in checks if not check.passed} >= {"Eva: claims not proved", "fuzzing: findings"}
    assert all(check.passed for check in checks if "not finite" in check.name or "misra" in check.name)
