"""Page of a tuning: proposed values beside the declared ones, goals, margins, certificate, and the Pareto front."""

from synth import show
from synth.declare.stage import Stage
from synth.declare.tuning import BenchMargins, Candidate, Goal, Tuned, Tuning
from synth.report import page
from synth.report.page import Checks, Section
from synth.show import Table

TITLE = "Tuning"
ABOUT = (
    "A search over the free parameters of the law, on machines within their tolerances. The ratio of a goal is the "
    "worst value over its limit, or the required margin over the least one: at most 1 where the goal is reached."
)


def tables(tuning: Tuning, tuned: Tuned) -> tuple[Table, ...]:
    """Return the tables of the parameters, of the goals, of the margins of the proposal, and of the Pareto front."""
    declared, proposal = tuned.baseline, tuned.proposal
    values = tuple(
        (f.name, f.unit, f.low, f.high, declared.values[f.name], proposal.values[f.name], f.about) for f in tuning.free
    )
    before = {goal.name: goal for goal in declared.goals}
    goals = tuple(_goal(before.get(goal.name), goal) for goal in proposal.goals)
    margins = tuple((name.replace("_", " "), value) for name, value in tuned.certificate.margins.items())
    names = tuple(f.name for f in tuning.free)
    front = tuple((c.performance, c.robustness, *(c.values[name] for name in names)) for c in tuned.front)
    return (
        Table("Free parameters", ("parameter", "unit", "low", "high", "declared", "proposed", "what"), values),
        Table("Goals", ("goal", "unit", "limit", "declared", "proposed", "ratio declared", "ratio proposed"), goals),
        *((Table("Margins of the proposal over the tolerances", ("margin", "least"), margins),) if margins else ()),
        Table("Pareto front", ("ratio of the experiments", "ratio of the margins", *names), front),
    )


def _goal(before: Goal | None, goal: Goal) -> tuple[show.Cell, ...]:
    name = f"least {goal.name.replace('_', ' ')}" if goal.is_margin else goal.name
    old, ratio = (before.value, before.ratio) if before else ("", "")
    return name, goal.unit, goal.limit, old, goal.value, ratio, goal.ratio


BENCH = "Tuned on the machine"


def bench_sheet(stage: Stage, over_bench: BenchMargins) -> show.Sheet:
    """Return the margins of what was tried on the bench of a stage, and where the least ones occur."""
    names, required = tuple(over_bench.tried[0].values), stage.require
    margins = tuple(over_bench.tried[0].margins)
    heads = tuple(m.replace("_", " ") for m in margins)
    rows: list[tuple[show.Cell, ...]] = [
        (*([""] * (len(names) - 1)), "required", *(required.get(m, "") for m in margins), "")
    ]
    for t in over_bench.tried:
        rows.append((*t.values.values(), *t.margins.values(), ", ".join(t.missed).replace("_", " ") or "none"))
    least: list[tuple[show.Cell, ...]] = [
        (head, over_bench.least[m].margins[m], *over_bench.least[m].values.values())
        for head, m in zip(heads, margins, strict=True)
    ]
    kept = [t.values for t in over_bench.tried if not t.missed]
    where = (
        ", ".join(f"{n} {min(v[n] for v in kept):.6g} .. {max(v[n] for v in kept):.6g}" for n in names) if kept else ""
    )
    lines = [
        f"All that is required holds at {len(kept)} of {len(over_bench.tried)} places that were tried"
        + (f", within {where}." if kept else "."),
        "The least margins are found by search; the C keeps its ranges at every value, by proof. No limit: a set that "
        "misses what is required is not written.",
    ]
    tables = [show.Table("Margins on the bench", (*names, *heads, "missed"), tuple(rows))]
    tables += (
        [show.Table("Least margins", ("margin", "least", *names), tuple(least))] if len(over_bench.tried) > 1 else []
    )
    return show.Sheet(f"{stage.name} on the bench", tuple(lines), tuple(tables))


def bench_section(stage: Stage, over_bench: BenchMargins) -> Section:
    """Return the section of a report on the bench of its stage."""
    sheet = bench_sheet(stage, over_bench)
    return Section(BENCH, (page.Text("\n\n".join(sheet.lines)), *sheet.tables))


def notes(tuned: Tuned) -> list[str]:
    """Return what was searched and what the result is, as sentences."""
    plan, proposal = tuned.plan, tuned.proposal
    end = "reaches every goal" if proposal.worst <= 1 else f"misses {_unmet_goals(proposal)}"
    return [
        f"{tuned.candidates} candidates on {plan.plants} machines each, seed {plan.seed}. The proposal {end}; its "
        f"largest ratio is {proposal.worst:.4g}, that of the declared law {tuned.baseline.worst:.4g}.",
        "It is a proposal: the declaration keeps its values until it is edited, and `synth build` then certifies them.",
        "The worst value of a sample is a lower bound of the worst case: study the edited design on more machines.",
    ]


def _unmet_goals(candidate: Candidate) -> str:
    names = [goal.name for goal in candidate.goals if goal.ratio > 1]
    return candidate.error or f"{len(names)} of {len(candidate.goals)} goals: {', '.join(names)}"


def section(tuning: Tuning, tuned: Tuned) -> Section:
    """Return the section: what was searched, the tables, the chart of the Pareto front, and the certificate."""
    text = page.Text("\n\n".join([ABOUT, *notes(tuned)]))
    chart = page.Figure(_front(tuned), "Pareto front: no candidate betters one ratio without worsening the other")
    checks = Checks("Certificate of the proposal", tuned.certificate.checks)
    return Section(TITLE, (text, *tables(tuning, tuned), chart, checks))


def _front(tuned: Tuned) -> str:
    from synth.report import figures, maps
    from synth.report.maps import Chart, Line

    def points(candidates: tuple[Candidate, ...], label: str, marker: str) -> Line:
        style = {"ls": "", "marker": marker}
        return Line([c.performance for c in candidates], [c.robustness for c in candidates], label, style)

    lines = [
        points(tuned.front, "front", "o"),
        points((tuned.baseline,), "declared", "s"),
        points((tuned.proposal,), "proposed", "x"),
    ]
    chart = Chart(lines, "largest ratio of the experiments", "largest ratio of the margins", levels=(1.0,))
    return figures.svg(maps.draw([chart], 3.0), "front")


def page_text(name: str, tuning: Tuning, tuned: Tuned) -> str:
    """Return a page with the section alone, as HTML."""
    return page.render(page.Report(name, f"Tuning over {tuned.candidates} candidates", (section(tuning, tuned),)))
