"""Section on the fault campaign of a stage: worst rows, magnitudes, notes, limits, and every row collapsed."""

from synth import show
from synth.report import page
from synth.report.page import Section
from synth.simulate.faults import fault_table
from synth.simulate.faults.fault_table import Campaign

TITLE = "What faults do to the machine"
ABOUT = (
    "Each fault of the interface is injected into the closed loop of compiled C and full plant, at rest and in motion, "
    "and compared with the healthy run. Excursion: largest distance from the healthy run. Impact: fastest on a stop "
    "that the healthy run does not have. Noticed, latched: slowest time from the onset. Tolerated: longest duration "
    "without harm when the controller never latches. Named: runs in which the fault bits name the faulty inputs. No "
    "effect: runs that do not differ from the healthy run."
)


def section(result: Campaign) -> Section:
    """Return the section: of each kind of fault the target that ends worst, and all of them in a collapsed table."""
    plants = "the nominal plant" if result.plants == 1 else f"{result.plants} plants"
    caption = f"Faults, worst of their targets on {plants}"
    table = show.Table(caption, *fault_table.table(result, fault_table.worst_targets(result)))
    every = show.Table("Faults of every target", *fault_table.table(result, result.rows))
    checks = (page.Checks("Limits of faults", result.checks),) if result.checks else ()
    notes = page.Text("\n\n".join(f"{note[0].upper()}{note[1:]}." for note in fault_table.notes(result)))
    folded = page.Folded("Every fault", (every,))
    return Section(TITLE, (page.Text(ABOUT), table, *_magnitudes(result), notes, *checks, folded))


def _magnitudes(result: Campaign) -> tuple[show.Table, ...]:
    rows = fault_table.magnitude_cells(result, False)
    caption = (
        "Smallest magnitude, as a fraction of the range, above which every fault is noticed, and above which every one "
        "ends in an impact"
    )
    return (show.Table(caption, fault_table.MAGNITUDE_COLUMNS, rows),) if rows else ()
