"""The tests that every design gets: defects that are planted in it are found, and one that is not is named."""

from dataclasses import replace

from synth import testing
from synth.verify import agree
from tests import levitator

PID = levitator.design()


def test_every_planted_defect_is_found() -> None:
    names = [name for name, _ in testing.variants(PID.DESIGN.stage)]
    assert {"sign of pid_z_p", "slew of i2 doubled", "bad_samples", "range of z wider"} <= set(names)
    assert len(names) == len(set(names)) == 19
    assert testing.undetected_defects(PID.DESIGN.stage) == []


def test_a_defect_that_the_reference_shares_is_named() -> None:
    """A reference that was written from the wrong C cannot tell the same defect."""
    wrong = dict(testing.variants(PID.DESIGN.stage))["slew of i2 doubled"]

    def step(x: agree.Columns, u: agree.Columns) -> tuple[agree.Columns, agree.Columns, object]:
        stepped = agree.casadi(wrong)(x, u)
        return stepped.states, stepped.outputs, stepped.faults

    assert testing.undetected_defects(replace(PID.DESIGN.stage, reference=step)) == ["slew of i2 doubled"]
