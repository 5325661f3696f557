"""The report's part on sensors that fail: what is flagged and when, what is left of the estimate, what is not seen."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from designs.hall_position import drawings
from designs.hall_position.drawings import Map
from designs.hall_position.page_trust import NAMES
from designs.hall_position.trust import endurance, failures
from designs.hall_position.trust.fleet import Kind
from synth.report import figures, page

POINTS, BODIES = 32, 150  # places along a pitch of the maps, bodies of each case
CASES = {"at rest": 0.0, "moving": 0.1}  # part of the speed and the acceleration that a body may have
MAPPED = "one axis"
LARGEST = 1e3  # um, of the maps


def section(of: Mapping[str, Kind]) -> page.Section:
    """Return what becomes of the estimates when a sensor fails."""
    text = page.Text(
        "Both voltages of a sensor dead, or a tenth weak; one of them dead, saturated, no number, or stuck; at rest "
        "and in motion at a tenth of the speed and the acceleration that a body may have; each sensor in turn, with "
        "noise, by model (2). A failure is flagged by a sample that is not valid, a sensor that is left out, or a "
        "fault bit; two sensors are not valid in places anyhow, as the rows without a failure show. 'late' counts "
        f"samples from a residual beyond its bound to the flag, of {failures.SOON} allowed; 'away' are bodies that "
        "were valid further than ten deviations off, which nothing tells.\n\n"
        "What is not flagged: a voltage that is dead where it is 0 anyhow, one that is stuck while the body rests or "
        "hardly moves, and small changes that agree with a place near by. Of three sensors one that is dead, saturated "
        "or no number is left out, and the other two carry on: valid until they lose rank, and from then on not, until "
        "the third is back. Four, placed so that any three tell the place, stay valid when one is lost. One that is "
        "stuck or weak is seldom told from the motion, and the estimate goes astray before its residual does."
    )
    tables = tuple(_table(NAMES[name], kind) for name, kind in of.items())
    maps = tuple(_unseen(name, kind) for name, kind in of.items())
    return page.Section("Failures of sensors", (text, *tables, *maps))


def _table(name: str, kind: Kind) -> page.Table:
    rows: list[tuple[page.Cell, ...]] = []
    for failure in failures.FAILURES:
        for case, part in CASES.items():
            rows.append((failure, case, *_worst(kind, failure, part)))
    columns = ("failure", "body", "out of bound, %", "flagged, %", "late", "named, %", "valid at the end, %", "away, %")
    return page.Table(
        f"A sensor of {name} fails: means over the sensors, of 'late' and 'away' the largest",
        columns,
        tuple(rows),
        digits=3,
    )


def _worst(kind: Kind, failure: str, part: float) -> tuple[page.Cell, ...]:
    most = endurance.limits(kind)
    within = replace(most, speed=part * most.speed, acceleration=part * most.acceleration) if part else None
    sensors = range(1, len(kind.array.positions) + 1)
    found = [failures.tried(kind, failure, sensor, BODIES, within, sensor) for sensor in sensors]
    mean = {n: 100 * float(np.mean([getattr(f, n) for f in found])) for n in ("out", "flagged", "named", "valid")}
    late, away = max(f.late for f in found), 100 * max(f.away for f in found)
    return mean["out"], mean["flagged"], late, mean["named"], mean["valid"], away


def _unseen(name: str, kind: Kind) -> page.Figure:
    shown = []
    for sensor in range(1, len(kind.array.positions) + 1):
        found = failures.unseen(kind, MAPPED, sensor, POINTS)
        share = 100 * float(np.mean(found.unseen))
        values = np.where(found.unseen, 1e6 * found.error, np.nan)
        shown.append(Map(f"sensor {'ABC'[sensor - 1]}: {share:.3g} % unseen", values))
    drawn = drawings.maps(shown, kind.array.pitch, 1.0, LARGEST, columns=len(shown), label="µm")
    caption = (
        f"{NAMES[name]}: where at rest, yaw 0, a sensor of which one voltage is dead is not flagged within "
        f"{failures.SOON} samples, and by how much the estimate errs there; white is flagged."
    )
    return page.Figure(figures.svg(drawn, f"unseen-{name}"), caption)
