"""Report of the Hall position for a design review: report.md and report.toml with the computed blocks."""

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from designs.hall_position import config, costs
from designs.hall_position.loop import calibration
from designs.hall_position.pages import accuracy, estimator, experiments, field, integrity, loops, six, trust
from models.hall_stage import Stage
from synth.emit.write import EmittedCode
from synth.report import captions, page, sections, standard, template
from synth.report.audit import Row
from synth.report.captions import Content
from synth.simulate.experiment import Experiment
from synth.verify.cost import Cost
from synth.verify.evidence import Evidence

ABOUT = (
    f"{config.NAME}: {config.UNPROTECTED} "
    "Absolute position over a Halbach magnet matrix from the voltages of two-axis Hall sensors, after Kawato and Kim: "
    "the field, its model, the estimator and its accuracy over the pitch. This page was computed from the magnets' "
    "geometry; every figure on it was measured on the shipped C, or on the model that the C was derived from."
)


def report(
    files: Mapping[str, EmittedCode],
    evidence: Evidence,
    runs: Sequence[Experiment],
    rows: Sequence[Row],
    cost: Cost | None,
    report_parts: Mapping[str, Any],
) -> str:
    """Return the report as one HTML document, with all experiments in `runs`."""
    data = tomllib.loads(Path(__file__).with_name("report.toml").read_text(encoding="utf-8"))
    stage = Stage()
    blocks = captions.with_captions(_blocks(stage, data, runs, report_parts["integrity"]), data["blocks"])
    equations = {f"equations.{e['name']}": page.Equations(tuple(map(tuple, e["rows"]))) for e in data["equations"]}
    parts = [
        experiments.section(runs, data["published"]),
        loops.section() if runs else page.Section(standard.LOOPS, (experiments.ABSENT,)),
        six.section(stage),
        standard.audit(rows, ()),
        standard.verification(evidence),
        sections.cost(cost),
        costs.section(report_parts["costs"]),
        standard.files(files),
    ]
    inputs, outputs = (
        "4 Hall voltages; 6 or 8 with protection levels",
        "X, Y and yaw, their deviations, residual, flags",
    )
    law = ("law", "GLSDC, Fig. 9, five corrections a sample")
    facts = (*standard.facts(config.TIME, np.float32, inputs, outputs), law)
    return template.assemble(config.NAME, ABOUT, facts, parts, {**equations, **blocks})


def _blocks(
    stage: Stage, data: Mapping[str, Any], runs: Sequence[Experiment], surveyed: Mapping[str, Content]
) -> dict[str, Content]:
    return {
        **field.blocks(stage),
        **estimator.blocks(data["meaning"]),
        **accuracy.blocks(stage),
        **trust.blocks(trust.estimators()),
        **integrity.blocks(),
        **surveyed,
        **experiments.blocks(calibration.calibrated_source().map if runs else None, runs),
        **six.blocks(stage),
    }
