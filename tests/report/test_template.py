"""The report of a declared stage: all standard sections, and those of the design in their places."""

from dataclasses import replace
from typing import Any

import pytest

from synth import show
from synth.analyse.loops import robustness
from synth.app import verdicts
from synth.check import Check, Incomplete
from synth.declare.stage import Stage
from synth.report import first_screen, page, standard, template
from synth.report.page import Section
from synth.report.template import Extra, Results
from synth.verify.suite import Evidence
from tests import levitator

STAGE = levitator.design().DESIGN
MARGIN = Check("phase margin", 38.0, 35.0, "degrees", at_least=True)
STEPS = Check("random steps", 0.0, 1e-9, "A")
EVIDENCE = Evidence("levitator_pid", (), (STEPS,), verdicts={standard.LOOPS: (MARGIN,)})
RESULTS = Results({}, EVIDENCE, (), (), None)
OWN = "# Model\nThe moved mass is {{ plant.M }} kg, read every {{ period_ms:g }} ms.\n\n# Bench\n{{ bench }}\n"


def report(monkeypatch: pytest.MonkeyPatch, words: str, **extra: Any) -> str:
    """Return the report without runs and without loops, which take long: the margins are shown all the same."""
    made = (Section(standard.LOOPS),)
    monkeypatch.setattr(template, "design_prose", lambda name: words)
    return page_with(Extra(sections=made, **extra))


def page_with(extra: Extra) -> str:
    return template.report(replace(STAGE, contents=lambda stage, results: extra), RESULTS)


def test_a_declaration_alone_gives_every_standard_section(monkeypatch: pytest.MonkeyPatch) -> None:
    html = report(monkeypatch, "")
    titles = (standard.MODEL, standard.LAW, standard.GAINS, standard.LOOPS, standard.EXPERIMENTS)
    for title in (*titles, standard.VERIFICATION, first_screen.COST, standard.FILES):
        assert f" {title}</h2>" in html, title
    assert "<math" in html and standard.AUDIT not in html
    assert "all 2 requirements kept" in html and html.count("<td>phase margin</td>") == 1


def test_a_loop_that_is_not_stable_is_reported_as_such() -> None:
    """With six times the gain of the coil, the loop of z is not stable in the middle and above."""
    survey = verdicts.survey(replace(STAGE, plant=STAGE.plant.with_parameters(K=120.0), tolerances=()))
    loops = template.loops(survey)
    texts = [block.text for block in loops.blocks if isinstance(block, page.Text)]
    assert "The closed loop is UNSTABLE at mid, high: it has no disk margin there." in texts
    (disks,) = (block for block in loops.blocks if isinstance(block, show.Table))
    assert {row[0] for row in disks.rows} == {"low"}
    (table,) = (block for block in loops.sections[0].blocks if isinstance(block, show.Table))
    assert [row[1] for row in table.rows] == ["stable", "UNSTABLE", "UNSTABLE"]


def test_a_point_without_an_equilibrium_is_named_in_the_report() -> None:
    points = ("low", "mid", "high")
    lost = robustness.Survey((), [robustness.Unsolved(n, robustness.NOMINAL, "'z' still changes") for n in points])
    loops = template.loops(lost)
    texts = [block.text for block in loops.blocks if isinstance(block, page.Text)]
    assert "No equilibrium of the loop was found at mid: 'z' still changes." in texts and not loops.sections


def test_of_the_corners_of_the_tolerances_the_worst_is_shown_beside_the_nominal_plant() -> None:
    survey = verdicts.survey(replace(STAGE, tolerances=("M",), operating_points={"mid": STAGE.operating_points["mid"]}))
    assert survey is not None and len(survey.loops) == 3 * len({loop.signal for loop in survey.loops})
    by_signal = {loop.signal: [other for other in survey.loops if other.signal == loop.signal] for loop in survey.loops}
    worst = [min(each, key=lambda loop: loop.margins.modulus_margin) for each in by_signal.values()]
    corners = [loop for loop in worst if loop.case.values]
    assert corners, "no corner is worse than the nominal plant"
    tables = [block for section in template.loops(survey).sections for block in section.blocks]
    labels = [str(row[0]) for table in tables if isinstance(table, show.Table) for row in table.rows]
    assert [label for label in labels if "M =" in label] == [c.label.partition(", ")[2] for c in corners]


def test_text_and_blocks_of_report_md_are_placed_by_title(monkeypatch: pytest.MonkeyPatch) -> None:
    bench = show.Table("Where it stands", ("floor",), (("granite",),))
    html = report(monkeypatch, OWN, values={"bench": bench}, facts=(("payload", "1 kg"),))
    assert "The moved mass is 1.5 kg, read every 0.5 ms." in html and "<dd>1 kg</dd>" in html
    model, bench_section, law = (html.index(f" {title}</h2>") for title in ("Model", "Bench", "Control law"))
    assert model < bench_section < html.index("granite") < law


def test_units_and_counts_of_experiments_are_those_declared() -> None:
    shown = template.default_style(STAGE)
    assert shown.units["z"] == "m" and shown.levels == {
        s.of: s.resolution for s in STAGE.interface.sensors if s.resolution
    }


def test_a_design_without_report_md_has_no_text() -> None:
    assert template.design_prose("no_such_design") == ""


def test_a_design_adds_to_the_control_law_and_states_the_floor_of_its_witnesses(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    html = report(monkeypatch, "", law=(page.Text("As the paper prints it."),), floor="1 A")
    law, gains = (html.index(f" {title}</h2>") for title in (standard.LAW, standard.GAINS))
    assert law < html.index("As the paper prints it.") < gains and "The floor is 1 A." in html
    text = dict.fromkeys(("shared", STAGE.name), "") | {"shared": "# Model\nOf both designs."}
    monkeypatch.setattr(template, "design_prose", text.__getitem__)
    sections = Extra(sections=(Section(standard.LOOPS, ()),), shared=("shared",))
    assert "Of both designs." in page_with(sections)


def test_sections_may_be_left_out_and_further_ones_stand_before_the_files(monkeypatch: pytest.MonkeyPatch) -> None:
    html = report(monkeypatch, "", omitted=(standard.GAINS, standard.LOOPS))
    assert f" {standard.GAINS}</h2>" not in html
    monkeypatch.setattr(template, "design_prose", lambda name: "")
    html = page_with(Extra(sections=(Section(standard.LOOPS), Section("Bench"))))
    cost, bench, files = (html.index(f" {title}</h2>") for title in (first_screen.COST, "Bench", standard.FILES))
    assert cost < bench < files


def test_contents_that_raise_an_error_are_a_failed_check_and_the_standard_page_stays() -> None:
    def planted(stage: Stage, results: Results) -> Extra:
        raise ZeroDivisionError("planted")

    with pytest.raises(Incomplete) as raised:
        template.report(replace(STAGE, contents=planted), RESULTS)
    assert [c.name for c in raised.value.checks] == ["errors of the contents of the report"]
    assert f" {standard.FILES}</h2>" in raised.value.value
