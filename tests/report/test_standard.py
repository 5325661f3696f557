"""Standard sections: tables of gains, loops by signal, experiments with the headroom of their states."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from synth import show
from synth.analyse.loops import stability_margins
from synth.check import Check
from synth.report import page, sections, standard
from synth.report.sections import Shown
from synth.simulate.experiments import Experiment
from synth.statespace import StateSpace, readonly
from synth.timing import Continuous, Discrete
from synth.verify.agree import Agreement
from synth.verify.suite import Evidence

LAW = {"K": [1.0, -2.5], "weights": {"x": 10.0}, "certified": True, "A": [[0.0, 1.0], [2.0, 3.0]]}
DOCUMENT = {
    "plant": "levitator",
    "period_s": 1e-3,
    "parameters": {"M": {"value": 1.5}},
    "z": {"z": LAW},
    "x": {"x": {**LAW, "K": [3.0, 4.0, 5.0]}},
    "filter": {"pole": 3.0},
}


@dataclass(frozen=True, eq=False)
class Opened:
    signal: str
    label: str
    L: StateSpace
    margins: stability_margins.Margins


def open_loop(signal: str, gain: float) -> Opened:
    A, B, C, D = (readonly(m) for m in ([[-1.0, 0], [1, -10]], [[gain], [0]], [[0, 1.0]], [[0.0]]))
    L = StateSpace(A, B, C, D, ("a", "b"), ("u",), ("y",), Continuous())
    return Opened(signal, f"at {signal}, {gain:g}", L, stability_margins.of_loop(L))


def test_laws_with_the_same_entries_share_a_table() -> None:
    first, alike, laws, other = sections.gains_tables(DOCUMENT)
    assert [row[0] for row in first.rows] == ["plant", "period s"]
    assert laws.columns == ("entry", "z", "x") and other.columns == ("entry", "filter")
    assert laws.rows == (("K", "1, −2.5", "3\n4\n5"),)
    assert dict(alike.rows) == {"weights:\nx": "10", "certified": "yes", "A": "0, 1\n2, 3"}


def test_loops_are_drawn_by_signal_and_the_worst_where_there_are_many() -> None:
    loops = [open_loop("i1", 10.0 + k) for k in range(8)] + [open_loop("z", 20.0)]
    section = standard.loops(loops, [page.Text("first")])
    assert [s.title for s in section.sections] == ["Loop of i1", "Loop of z"]
    assert section.blocks == (page.Text("first"),)
    figure, table = section.sections[0].blocks
    assert isinstance(table, show.Table) and len(table.rows) == 8 and table.rows[0][0] == "10"
    assert isinstance(figure, page.Figure) and "6 loops with the least modulus margins" in figure.caption


def test_experiments_show_the_headroom_of_states(run: Callable[..., Experiment]) -> None:
    bounded = replace(run(), figures={"largest |state| / bound (axis_sum)": 0.41, "overshoot": 0.1})
    shown = Shown({"y": "m", "theta": "rad"}, {"y": 1e-5}, {"tracking": "Fig. 7"}, {"tracking": (page.Text("more"),)})
    section = standard.experiments([bounded], shown)
    table = section.blocks[0]
    assert isinstance(table, show.Table) and table.rows == (("Tracking", "axis_sum", 0.41),)
    assert section.sections[0].blocks[-1] == page.Text("more") and "Fig. 7" in section.sections[0].blocks[0].published  # type: ignore[union-attr]


def test_the_verification_shows_its_checks_and_its_floor() -> None:
    checks = (Check("random steps", 0.0, 1e-9, "A"), Check("edge steps", 0.0, 1e-9, "A"))
    section = standard.verification(Evidence("two", list[Agreement](), checks), "1 A")
    assert (*section.checks(),) == checks
    assert isinstance(section.blocks[0], page.Text) and "The floor is 1 A." in section.blocks[0].text


def test_the_facts_are_those_of_the_declaration() -> None:
    assert standard.facts(Discrete(5e-4), np.float32, "z", "i")[:2] == (
        ("sample period", "0.5 ms"),
        ("scalar type", "float32"),
    )
