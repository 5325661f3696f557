"""Standard report of a declared stage: all sections from the declaration, merged with the text of the design.

A design adds content in two ways: by report.md in its folder, see `prose`, and by an `Extra`, with values and blocks
for report.md and sections that replace standard ones, follow them, or leave them out.
"""

import importlib.util
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from synth import show
from synth.analyse.loops import robustness
from synth.analyse.loops.robustness import Survey
from synth.check import Check, Incomplete, of_error
from synth.declare.stage import Stage
from synth.emit.write import EmittedCode
from synth.report import first_screen, page, prose, sections, standard, tuning
from synth.report.audit import Row
from synth.report.equations.derive import NamedTerms
from synth.report.page import Section
from synth.report.prose import Value
from synth.report.sections import Shown
from synth.simulate.experiments import Experiment
from synth.verify.cost import Cost
from synth.verify.suite import Evidence

FLOOR = "the largest magnitude in the output's range"


@dataclass(frozen=True, eq=False)
class Extra:
    """Additions of a design to the standard report.

    `values` are further placeholders of report.md; `sections` replace standard sections of the same title, and others
    follow them; those with the titles `omitted` are left out. `terms` names expressions of the physics, see
    `derive.plant`; `facts` follow the standard ones; `shown` replaces the presentation of experiments that follows from
    the declaration. `law` are blocks below the equations of the control law; `cost(runs)` returns blocks below the
    measured cost. The text of the `shared` design packages comes first. `floor` states the value below which a
    difference of witnesses is relative to it.
    """

    values: Mapping[str, Value] = field(default_factory=dict)
    sections: Sequence[Section] = ()
    omitted: Sequence[str] = ()
    terms: NamedTerms | None = None
    facts: Sequence[tuple[str, str]] = ()
    shown: Shown | None = None
    law: Sequence[page.Block] = ()
    cost: Callable[[Sequence[Experiment]], Sequence[page.Block]] = lambda runs: ()
    shared: Sequence[str] = ()
    floor: str = FLOOR


@dataclass(frozen=True, eq=False)
class Results:
    """What a report shows: the emitted files by folder, evidence, experiments, rows of the audit, and the cost."""

    files: Mapping[str, EmittedCode]
    evidence: Evidence
    runs: Sequence[Experiment]
    rows: Sequence[Row]
    cost: Cost | None


def report(stage: Stage, results: Results) -> str:
    """Return the report of a stage as one HTML document, with the contents that it declares.

    Raises DesignError for an unknown placeholder, and Incomplete with the page where sections raise errors.
    """
    failed, extra = list[Check](), Extra()
    try:
        extra = stage.contents(stage, results) if stage.contents else extra
    except Exception as error:
        failed.append(of_error("the contents of the report", error))
    files, evidence, runs, rows, cost = results.files, results.evidence, results.runs, results.rows, results.cost
    makers = {
        **_declared_sections(stage, gains(stage.name, files), evidence, extra),
        standard.EXPERIMENTS: lambda: standard.experiments(runs, extra.shown or default_style(stage)),
        **({first_screen.STUDY: partial(sections.study_of_tolerances, evidence.study)} if evidence.study else {}),
        **({first_screen.FAULTS: partial(sections.fault_campaign, evidence.faults)} if evidence.faults else {}),
        **({standard.AUDIT: lambda: standard.audit(rows)} if rows else {}),
        standard.VERIFICATION: lambda: standard.verification(evidence, extra.floor),
        first_screen.COST: lambda: _with_blocks(sections.cost(cost), extra.cost(runs) if cost else ()),
        standard.DATASHEET: lambda: standard.datasheets(files),
        standard.FILES: lambda: standard.files(files),
    }
    replaced = {s.title: s for s in extra.sections}
    titles = [t for t in dict.fromkeys((*makers, *replaced)) if t != standard.FILES and t not in extra.omitted]
    parts = []
    for title in (*titles, standard.FILES):
        try:
            section = replaced[title] if title in replaced else makers[title]()
        except Exception as error:
            failed.append(of_error(f"the section {title}", error))
            section = Section(title, (page.Checks("Errors", (failed[-1],)),))
        checks = tuple(evidence.verdicts.get(title, ()))
        verdicts = (page.Checks("Requirements", checks),) if checks else ()
        parts.append(replace(section, blocks=(*verdicts, *section.blocks)))
    known = {**values(stage, rows), **extra.values}
    about = f"{stage.name}: {stage.warning} {stage.about}" if stage.warning else stage.about
    html = assemble(stage.name, about, (*facts(stage), *extra.facts), parts, known, extra.shared)
    if failed:
        raise Incomplete(html, failed)
    return html


def of_checks(name: str, checks: Sequence[Check]) -> str:
    """Return a page of checks alone as one HTML document, for a design whose report cannot be drawn."""
    about = "The report could not be drawn. These are the checks of the build."
    return page.render(page.Report(name, about, (Section("Checks", (page.Checks("Checks", tuple(checks)),)),)))


def _with_blocks(section: Section, blocks: Sequence[page.Block]) -> Section:
    return replace(section, blocks=(*section.blocks, *blocks))


def assemble(
    name: str,
    about: str,
    facts: Sequence[tuple[str, str]],
    parts: Sequence[Section],
    values: Mapping[str, Value] | None = None,
    shared: Sequence[str] = (),
) -> str:
    """Return a page of sections as one HTML document, merged with the text of the design's report.md.

    The text of the `shared` design packages comes first. Text before the first title becomes the summary.

    Raises DesignError as `prose.parse`.
    """
    words = prose.parse("\n\n".join(design_prose(folder) for folder in (*shared, name)), values or {})
    summary = (Section("Summary", words.blocks),) if words.blocks else ()
    merged = prose.merge(parts, words.parts)
    return page.render(page.Report(name, about, (*summary, *merged), tuple(facts)))


def _declared_sections(
    stage: Stage, gains: Mapping[str, Any], evidence: Evidence, extra: Extra
) -> dict[str, Callable[[], Section]]:
    """Return what makes the sections that follow from the declaration, by title."""
    block = stage.controller.block.rounded(stage.scalar)
    return {
        standard.MODEL: lambda: standard.model(stage.plant, extra.terms),
        standard.LAW: lambda: standard.law(block, extra.law),
        standard.GAINS: lambda: standard.gains(gains),
        standard.LOOPS: lambda: loops(evidence.loops),
        **({tuning.BENCH: partial(tuning.bench_section, stage, evidence.bench)} if evidence.bench else {}),
    }


def gains(name: str, files: Mapping[str, EmittedCode]) -> Mapping[str, Any]:
    """Return the entry `design` of the emitted gains.json, empty if there is none."""
    emitted = files[name].files if name in files else {}
    return dict(json.loads(emitted["gains.json"]).get("design", {})) if "gains.json" in emitted else {}


def facts(stage: Stage) -> tuple[tuple[str, str], ...]:
    """Return the facts at the top of the report of a stage."""
    interface, signals = stage.interface, stage.interface.signals
    roles = (("sensors", interface.sensors), ("set-points", interface.set_points), ("auxiliary", interface.auxiliaries))
    inputs = "; ".join(f"{role} {', '.join(s.name for s in each)}" for role, each in roles if each)
    outputs = ", ".join(f"{a.name} in {signals[a.name].unit}" for a in interface.actuators)
    shown = outputs or standard.list_signals(stage.controller.block.outputs)
    delay = f"{interface.delay} sample{'s' if interface.delay != 1 else ''} from measurement to actuation"
    return (*standard.facts(stage.controller.time, stage.scalar, inputs, shown), ("delay", delay))


def loops(survey: Survey | None) -> Section:
    """Return the loops of the nominal plant, and of all the worst at each signal, with disk margins likewise."""
    if survey is None:
        return Section(standard.LOOPS, (page.Text("No operating points are declared; there are no loops to show."),))
    unstable = dict.fromkeys(loop.point for loop in survey.loops if not loop.margins.stable)
    notes = [f"The closed loop is UNSTABLE at {', '.join(unstable)}: it has no disk margin there."] if unstable else []
    notes += [f"No equilibrium of the loop was found {u.label}: {u.reason}." for u in survey.unsolved]
    worst: dict[str, robustness.OpenLoop] = {}
    for loop in sorted(survey.loops, key=lambda loop: loop.margin("modulus_margin")):
        worst.setdefault(loop.signal, loop)
    shown = [loop for loop in survey.loops if loop.case == robustness.NOMINAL or loop is worst[loop.signal]]
    return standard.loops(shown, (page.Text(standard.OPENED), *map(page.Text, notes), *disks(survey)))


def disks(survey: Survey) -> tuple[show.Table, ...]:
    """Return the table of the disk margins at the points of the nominal plant, and of all the least."""
    nominal = {loop.point for loop in survey.loops if loop.case == robustness.NOMINAL}
    least = min(survey.disks, key=lambda place: survey.disks[place]["both"].lower, default="")
    shown = {place: each for place, each in survey.disks.items() if place in nominal or place == least}
    return (sections.disks(shown),) if shown else ()


def default_style(stage: Stage) -> Shown:
    """Return the presentation of the experiments of a stage: units and resolutions as declared."""
    plant = stage.plant
    signals = [*plant.states, *plant.inputs, *plant.outputs, *stage.interface.signals.values()]
    levels = {name: s.resolution for s in stage.interface.sensors if s.resolution for name in (s.name, s.of)}
    return Shown({s.name: s.unit for s in signals}, levels)


def values(stage: Stage, rows: Sequence[Row]) -> dict[str, Value]:
    """Return the placeholders of report.md that every stage has."""
    interface, period = stage.interface, stage.controller.time.period_s
    known: dict[str, Value] = {
        "name": stage.name,
        "period_ms": 1e3 * period,
        "rate_hz": 1 / period,
        "scalar": np.dtype(stage.scalar).name,
        "delay": interface.delay,
        "bad_samples": interface.bad_samples,
        "safe_output_effect": interface.safe_output_effect,
    }
    known |= {f"plant.{p.name}": p.value for p in stage.plant.parameters}
    return known | {f"audit.{row.id}": row.published.text for row in rows}


def design_prose(name: str) -> str:
    """Return the text of a design's report.md, empty if it has none."""
    package = importlib.util.find_spec(f"designs.{name}") if importlib.util.find_spec("designs") else None
    for folder in (package.submodule_search_locations or ()) if package else ():
        if (path := Path(folder) / "report.md").is_file():
            return path.read_text(encoding="utf-8")
    return ""
