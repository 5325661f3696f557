"""The witnesses of the lead-lag controller agree, in every step that is drawn or replayed."""

import pytest

from designs.planar_6dof import verification as shared
from designs.planar_6dof_leadlag import control, design
from synth.verify import standard
from tests.designs.planar_6dof import planted

REPLAY, STEPS = 2.0, 40_000  # s; `synth verify` replays 60, and draws 100,000


def test_every_check_passes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(standard, "RANDOM_STEPS", STEPS)
    monkeypatch.setattr(shared, "QUICK_REPLAY", REPLAY)
    messages: list[str] = []
    evidence = standard.verify(design.DESIGN, messages.append, False)
    assert [c for c in evidence.checks if not c.passed] == []
    assert evidence.design == control.NAME and messages
    planted.require_witnesses(evidence, {f"replay of {REPLAY:g} s": 2000, "random steps": STEPS})
