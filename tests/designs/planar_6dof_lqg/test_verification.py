"""The witnesses of the LQG controller agree, in every step that is drawn or replayed."""

from designs.planar_6dof import verification as shared
from designs.planar_6dof_lqg import control, verification
from tests.designs.planar_6dof import planted

REPLAY = 2.0  # s; `synth verify` replays 60


def test_every_check_passes() -> None:
    told: list[str] = []
    evidence = verification.verify(told.append, REPLAY)
    assert [c for c in evidence.checks if not c.passed] == []
    assert evidence.design == control.NAME and told
    planted.require_witnesses(evidence, {f"replay of {REPLAY:g} s": 1600, "random steps": shared.RANDOM_STEPS})
