"""The report of the Hall position: what a design review reads, assembled from the computed parts."""

from collections.abc import Mapping, Sequence

from designs.hall_position import (
    page_accuracy,
    page_convergence,
    page_estimator,
    page_experiments,
    page_failures,
    page_field,
    page_loops,
    page_six,
    page_trust,
    shipped,
)
from designs.hall_position.loop import calibration
from designs.hall_position.paper.stage import Stage
from synth.emit.write import Emitted
from synth.report import page, sections
from synth.report.audit import Row
from synth.simulate.experiment import Experiment
from synth.verify.cost import Cost
from synth.verify.evidence import Evidence

ABOUT = (
    "Absolute position over a Halbach magnet matrix from the voltages of two-axis Hall sensors, after Kawato and Kim: "
    "the field, its model, the estimator and what it tells where. This page was computed from the magnets' geometry; "
    "every figure on it was measured on the C that ships, or on the model that the C was derived from."
)
AUDIT = (
    "Verdicts are computed. The sensors' places are not printed: they are taken at ±(3/8, 3/8) pitch about the body's "
    "origin, with the spacing (3), and K-5, K-6, K-9, K-11 and K-13 depend on that."
)


def report(
    files: Mapping[str, Emitted],
    evidence: Evidence,
    experiments: Sequence[Experiment],
    rows: Sequence[Row],
    cost: Cost | None,
) -> str:
    """Return the whole report as one HTML document, with every experiment that is handed in."""
    stage = Stage()
    parts = (
        page_field.field(stage),
        page_field.fit(stage),
        page_estimator.estimator(),
        page_accuracy.accuracy(stage),
        page_accuracy.model_error(stage),
        page_convergence.convergence(stage),
        *_trust(),
        *_loop(experiments),
        page_six.section(stage),
        page.Section("Audit of the paper", (page.Text(AUDIT), sections.audit(rows))),
        _verification(evidence),
        sections.cost(cost),
        *_others(files, cost),
        page.Section("Files", (sections.files(_texts(files)),)),
    )
    facts = (
        ("sample period", f"{shipped.TIME.period_s * 1e3:g} ms"),
        ("scalar type", "float32"),
        ("inputs", "4 Hall voltages; 6 with a third sensor"),
        ("outputs", "X, Y and yaw, their deviations, residual, flags"),
        ("law", "GLSDC, Fig. 9, five corrections a sample"),
    )
    return page.render(page.Report(shipped.NAME, ABOUT, parts, facts))


def _trust() -> tuple[page.Section, ...]:
    """Return the parts on what the shipped C does from any start, in any motion."""
    of = page_trust.kinds()
    return page_trust.convergence(of), page_trust.cold_starts(of), page_trust.motion(of), page_failures.section(of)


def _loop(experiments: Sequence[Experiment]) -> tuple[page.Section, ...]:
    """Return the parts on the closed loop, none where none was run."""
    if not experiments:
        return ()
    source = calibration.calibrated()
    return (
        page_experiments.calibration(source, experiments),
        page_experiments.section(experiments),
        page_loops.section(),
    )


def _others(files: Mapping[str, Emitted], cost: Cost | None) -> tuple[page.Section, ...]:
    """Return what the other estimators cost, none where nothing was measured for want of an emulator or a compiler."""
    if cost is None:
        return ()
    from designs.hall_position import costs, page_costs  # which need the extra `target`

    return (page_costs.section(costs.measure(files[shipped.THREE], page_six.placed(Stage(), 4))),)


def _verification(evidence: Evidence) -> page.Section:
    text = page.Text(
        "reference: NumPy, written from the paper's equations, corrections by an orthogonal factorisation. casadi: "
        "CasADi's evaluation. casadi_c: CasADi's own C, double. c64, c32: the emitted C in double and single "
        "precision. Steps whose errors are magnified over a thousand times are counted, and compared at that times "
        "epsilon."
    )
    checks = page.Checks("Limits", tuple(evidence.checks))
    return page.Section("Verification", (text, sections.agreements(evidence.agreements), checks))


def _texts(files: Mapping[str, Emitted]) -> dict[str, str]:
    return {f"{folder}/{name}": text for folder, found in files.items() for name, text in found.files.items()}
