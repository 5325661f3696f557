"""Report of the Hall position for a design review: report.md and report.toml with the computed blocks."""

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from designs.hall_position import config
from designs.hall_position.pages import estimator, field
from models.hall_stage import Stage
from synth.emit.write import EmittedCode
from synth.report import captions, page, sections, standard, template
from synth.report.audit import Row
from synth.simulate.experiment import Experiment
from synth.verify.cost import Cost
from synth.verify.evidence import Evidence

ABOUT = (
    f"{config.NAME}: {config.UNPROTECTED} "
    "Absolute position over a Halbach magnet matrix from the voltages of two-axis Hall sensors, after Kawato and Kim: "
    "the field, its model, and the estimator. This page was computed from the magnets' geometry; every figure on it, "
    "those of the studies excepted, was measured on the shipped C, or on the model that the C was derived from."
)
STUDIES = "Studies"


def report(
    files: Mapping[str, EmittedCode],
    evidence: Evidence,
    runs: Sequence[Experiment],
    rows: Sequence[Row],
    cost: Cost | None,
    report_parts: Mapping[str, Any],
) -> str:
    """Return the report as one HTML document; an estimator has no experiments."""
    data = tomllib.loads(Path(__file__).with_name("report.toml").read_text(encoding="utf-8"))
    stage = Stage()
    contents = {**field.blocks(stage), **estimator.blocks(data["meaning"])}
    blocks = captions.with_captions(contents, data["blocks"])
    equations = {f"equations.{e['name']}": page.Equations(tuple(map(tuple, e["rows"]))) for e in data["equations"]}
    parts = [
        standard.audit(rows, ()),
        standard.verification(evidence),
        sections.cost(cost),
        studies(report_parts["studies"]),
        standard.files(files),
    ]
    inputs, outputs = (
        "4 Hall voltages; 6 or 8 with protection levels",
        "X, Y and yaw, their deviations, residual, flags",
    )
    law = ("law", "GLSDC, Fig. 9, five corrections a sample")
    facts = (*standard.facts(config.TIME, np.float32, inputs, outputs), law)
    return template.assemble(config.NAME, ABOUT, facts, parts, {**equations, **blocks})


def studies(results: Mapping[str, Any]) -> page.Section:
    """Return the figures of the studies as they are quoted, with their date and revision, beside their limits."""
    about = (
        "What the estimators do beyond the paper: in random motion without end, with a calibration and with a faulty "
        f"sensor, and in loops that the estimate closes. Not computed with this page: results of {results['date']}, "
        f"revision {results['revision']}, by python -m studies.hall. What they led to is in docs/decisions, "
        "hall_position_protected.md and hall_position_loop.md."
    )
    rows = tuple((f["study"], f["figure"], f["value"], limit(f), f["unit"]) for f in results["figures"])
    table = page.Table("Figures of the studies", ("study", "figure", "value", "limit", "unit"), rows)
    return page.Section(STUDIES, (page.Text(about), page.Folded(f"{len(rows)} figures", (table,))))


def limit(figure: Mapping[str, Any]) -> str:
    """Return the limit of a figure as text."""
    if "at_most" in figure:
        return f"at most {figure['at_most']:.4g}"
    return f"at least {figure['at_least']:.4g}" if "at_least" in figure else "no limit"
