"""The report of the Hall position: what a design review reads, from report.md, report.toml and the computed blocks."""

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from designs.hall_position import shipped
from designs.hall_position.loop import calibration
from designs.hall_position.pages import accuracy, estimator, experiments, field, loops, six, trust
from designs.hall_position.paper.stage import Stage
from synth.emit.write import Emitted
from synth.report import page, prose, sections, standard
from synth.report.audit import Row
from synth.report.prose import Value
from synth.simulate.experiment import Experiment
from synth.verify.cost import Cost
from synth.verify.evidence import Evidence

ABOUT = (
    "Absolute position over a Halbach magnet matrix from the voltages of two-axis Hall sensors, after Kawato and Kim: "
    "the field, its model, the estimator and what it tells where. This page was computed from the magnets' geometry; "
    "every figure on it was measured on the C that ships, or on the model that the C was derived from."
)
FACTS = (("law", "GLSDC, Fig. 9, five corrections a sample"),)
COSTS = "Cost of three sensors and of six degrees of freedom"
LOOP = ("Calibration", standard.EXPERIMENTS, standard.LOOPS)  # parts of the closed loop


def report(
    files: Mapping[str, Emitted],
    evidence: Evidence,
    runs: Sequence[Experiment],
    rows: Sequence[Row],
    cost: Cost | None,
) -> str:
    """Return the whole report as one HTML document, with every experiment that is handed in."""
    data = tomllib.loads(Path(__file__).with_name("report.toml").read_text(encoding="utf-8"))
    text = Path(__file__).with_name("report.md").read_text(encoding="utf-8")
    stage = Stage()
    words = prose.read(text, {**_equations(data), **_blocks(stage, data, runs)})
    computed = {
        standard.EXPERIMENTS: experiments.section(runs, data["beside"]),
        standard.LOOPS: loops.section() if runs else page.Section(standard.LOOPS),
        "Six degrees of freedom": six.section(stage),
        standard.AUDIT: standard.audit(rows, ()),
        standard.VERIFICATION: standard.verification(evidence),
    }
    others = _others(files, cost, stage)
    skipped = {*(() if runs else LOOP), *(() if others else (COSTS,))}
    made = [*computed.values(), sections.cost(cost), *others, standard.files(files)]
    parts = [part for part in words.parts if part.title not in skipped]
    placed = prose.placed([section for section in made if section.title not in skipped], parts)
    inputs, outputs = "4 Hall voltages; 6 with a third sensor", "X, Y and yaw, their deviations, residual, flags"
    facts = (*standard.facts(shipped.TIME, np.float32, inputs, outputs), *FACTS)
    return page.render(page.Report(shipped.NAME, ABOUT, placed, facts))


def _equations(data: Mapping[str, Any]) -> dict[str, Value]:
    return {f"equations.{e['name']}": page.Equations(tuple(map(tuple, e["rows"]))) for e in data["equations"]}


def _blocks(stage: Stage, data: Mapping[str, Any], runs: Sequence[Experiment]) -> dict[str, Value]:
    of = calibration.calibrated().map if runs else None
    return {
        **field.blocks(stage),
        **estimator.blocks(data["meaning"]),
        **accuracy.blocks(stage),
        **trust.blocks(trust.kinds()),
        **experiments.blocks(of, runs),
        **six.blocks(stage),
    }


def _others(files: Mapping[str, Emitted], cost: Cost | None, stage: Stage) -> tuple[page.Section, ...]:
    """Return what the other estimators cost, none where nothing was measured for want of an emulator or a compiler."""
    if cost is None:
        return ()
    from designs.hall_position import costs  # which needs the extra `target`

    return (costs.section(costs.measure(files[shipped.THREE], six.placed(stage, 4))),)
