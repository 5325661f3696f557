"""The section on faults in the report and the evidence: rows, magnitudes, notes and limits; a planted limit fails."""

from dataclasses import replace

from synth.declare.fault_campaign import FaultCampaign, FaultLimit
from synth.report import page, sections
from synth.simulate.faults import fault_table
from synth.simulate.faults.campaign import FaultRun, HealthyRun, Sweep
from synth.simulate.faults.injections import Injection
from synth.simulate.rig import Rig
from synth.verify.suite import Evidence
from tests import levitator

POSITIONS = ("z", "x")
LATE = Sweep("sensor", "z", "not finite", "permanent", "at rest", None, None, 1e-3)
GAP = Sweep("sensor", "z", "offset", "permanent", "at rest", 0.25, 0.125, float("inf"))


def run(kind: str, latch_s: float, impact: float) -> FaultRun:
    zero, hit = dict.fromkeys(POSITIONS, 0.0), {"z": impact, "x": 0.0}
    fault = Injection("sensor", "z", kind, "permanent")
    return FaultRun(fault, "at rest", 0, 0.1, hit, hit, {"z": 2.0}, hit, zero, latch_s, latch_s, latch_s < 1, (), True)


def campaign(*limits: FaultLimit) -> fault_table.Campaign:
    stage = levitator.design().DESIGN
    rig = Rig(replace(stage, faults=FaultCampaign(limits=limits)), stage.plant, None)  # type: ignore[arg-type]
    runs = [run("not finite", 2e-3, 0.04), run("offset", float("inf"), 0.0)]
    control = [run("not finite", float("inf"), 0.05)]
    return fault_table.campaign(rig, 1, [HealthyRun("at rest", 0, 0, {"z": 0.0})], runs, control, [LATE, GAP])


def render(result: fault_table.Campaign) -> str:
    return page.render(page.Report("stage", "about", (sections.fault_campaign(result),)))


def test_the_section_has_impact_energy_times_magnitudes_and_the_control() -> None:
    html = render(campaign())
    for text in (
        "0.04 m/s z, 2 J",
        "2 ms",
        "1 ms, too late",
        "25 %",
        "12.5 %",
        "worst of their targets on the nominal",
    ):
        assert text in html, text
    assert "of 1 runs that latch, 1 run into a stop when the controller never latches" in html


def test_a_planted_limit_fails_in_the_section_and_in_the_evidence() -> None:
    limits = FaultLimit("latch_s", 1e-3, kind="not finite"), FaultLimit("impact_z", 0.045, kind="not finite")
    result = campaign(*limits)
    assert [c.passed for c in result.checks] == [False, True, True, True]
    assert "failed" in render(result)
    document = Evidence("stage", (), (), result).document()
    assert document["faults"]["rows"][0]["impacts"]["z"] == 0.04
    assert "faults" not in Evidence("stage", (), ()).document()


def test_a_limit_that_the_control_keeps_does_not_count_as_tested() -> None:
    """An impact of 0.05 m/s without the latch keeps 0.06 m/s: such a limit cannot tell whether there is a detector."""
    result = campaign(FaultLimit("impact_z", 0.06, kind="not finite"))
    (failed,) = (c for c in result.checks if not c.passed)
    assert failed.name == fault_table.CONTROL_LIMITS
    assert "allows 0.06 m/s, and reaches 0.05 without the latch and 0.04 with it: give a limit between" in failed.about


def test_the_excursion_is_that_of_a_position_with_a_set_point() -> None:
    """A mode of the machine's base has a small range, and would hide what the stage does."""
    row = replace(campaign().rows[0], excursion={"z": 1e-3, "x": 1e-5})
    moved = [fault_table.cells(replace(campaign(), regulated=names), row)[3] for names in (("z", "x"), ("x",))]
    assert moved == ["0.001 m z", "1e-05 m x"]
