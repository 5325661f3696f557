"""The page shows the cost of a step with its notes, or states that nothing was measured."""

from dataclasses import replace

from synth.report import page, sections
from synth.verify.cost import Cost, Coverage, Memory, SequenceCost, StepCost, Summary

OWN = StepCost(
    generator="synth",
    build="gcc, newlib",
    steps=25,
    issued=Summary(780, 784.0, 790),
    executed=Summary(760, 770.0, 775),
    cycles=(Summary(1200, 1210.0, 1220), Summary(1400, 1440.0, 1450)),
    functions={"stage_step": 784.0},
    memory=Memory(3592, 348, 0, 200, 76, 96),
    doubles=0,
    difference=0.0,
)
CASADI = replace(OWN, generator="casadi", issued=Summary(50_000, 54_880.0, 56_000), functions={"__adddf3": 11_506.0})
COST = Cost(
    design="stage",
    core="cortex-m4f",
    period_s=1e-3,
    compared=(OWN, CASADI),
    sequences=(SequenceCost("tracking", "gcc, newlib", 500, Summary(780, 784.0, 840)),),
    coverage=(
        Coverage("gcc, newlib", 63, ("stage_step at 0x8000: `bne #0x8010` never taken; stage.c:7: if (a < b)",)),
    ),
    operations={"mul": 100, "add": 96, "load state": 50},
    absent=("symforce: not installed; not measured",),
)


def shown(cost: Cost | None) -> str:
    return page.render(page.Report("stage", "about", (sections.cost(cost),)))


def test_the_section_shows_values_and_their_meaning() -> None:
    html = shown(COST)
    for said in ("not cycles", "780 .. 784 .. 790", "70.00", "1210 .. 1440", "__adddf3 11506", "0.5 % of the period"):
        assert said in html, said
    assert "symforce: not installed" in html and "if (a &lt; b)" in html
    assert "instructions per operation, gcc, newlib" in html and ">4.00<" in html.replace(" ", "")


def test_a_missing_measurement_is_stated() -> None:
    assert "Not measured" in shown(None) and "instructions" not in shown(None).lower().split("not measured")[1]
