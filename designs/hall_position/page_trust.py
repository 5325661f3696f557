"""The report's parts on trust: the basin of the shipped C, its cold starts, motion without end, sensors that fail."""

from collections.abc import Mapping

import numpy as np

from designs.hall_position import drawings, drawings_runs, shipped
from designs.hall_position.drawings import Map
from designs.hall_position.trust import basin, cold_start, endurance
from designs.hall_position.trust.fleet import Kind
from synth.report import figures, page

NAMES = {shipped.NAME: "two sensors", shipped.THREE: "three sensors"}
POINTS, BODIES, SAMPLES = 24, 4000, 60  # places along a pitch of the reach, starts drawn, samples of each
YAW = np.radians(2)  # of bodies in these, to either side
STARTS, WAIT, DRIFT = 14, 400, 0.02  # places along a pitch of cold starts, samples, m/s of those that move
MOVING, LONG = 400, 250  # bodies in motion without end, and their samples


def kinds() -> dict[str, Kind]:
    """Return the estimators that ship, by name."""
    return {name: Kind(shipped.array(name), shipped.TUNING, shipped.TIME) for name in NAMES}


def convergence(of: Mapping[str, Kind]) -> page.Section:
    """Return how far a start may be off, by the compiled C."""
    text = page.Text(
        "The C that ships, from starts that are off, on voltages by model (2) with noise. In the first sample its five "
        "corrections lead to the truth, or elsewhere: to another minimum, where residuals are large, or to a place "
        "with the same voltages. The yaw is held to the expected one, so that it is corrected over samples. Later it "
        "has searched. What is found elsewhere must not be valid.\n\n"
        f"Two sensors tell places apart within {np.degrees(shipped.TUNING.turn):.3g}° of the last certain yaw, so that "
        "nothing is valid at more than half of it. Starts here are turned by more; the last table counts what was "
        "valid elsewhere."
    )
    reach = {name: basin.over_pitch(kind, POINTS) for name, kind in of.items()}
    maps = [Map(NAMES[n], 1e3 * r.reach) for n, r in reach.items()]
    pitch = next(iter(of.values())).array.pitch
    drawn = drawings.maps(maps, pitch, 0.0, 1e3 * pitch / 4, columns=2, log=False, label="mm")
    caption = "How far all starts around a place may be off, in mm, so that one sample leads to it, yaw 0."
    found = {name: basin.mapped(kind, BODIES, YAW, SAMPLES) for name, kind in of.items()}
    tables = (table for name, each in found.items() for table in _shares(NAMES[name], each))
    wrong = _wrong({NAMES[n]: (b.samples, b.wrong) for n, b in found.items()})
    return page.Section("Convergence", (text, page.Figure(figures.svg(drawn, "reach"), caption), *tables, wrong))


def _shares(name: str, found: basin.Basin) -> tuple[page.Table, page.Table]:
    columns = ("off by up to, mm", *(f"turned by up to {np.degrees(t):.3g}°" for t in found.turned))
    made = []
    for when, share in (("in the first sample", found.first), (f"after {SAMPLES} samples", found.then)):
        rows = tuple((1e3 * d, *(100 * row).tolist()) for d, row in zip(found.off.tolist(), share, strict=True))
        made.append(page.Table(f"Starts that lead to the truth {when}, %: {name}", columns, rows, digits=3))
    return made[0], made[1]


def _wrong(found: Mapping[str, tuple[int, int]]) -> page.Table:
    rows = tuple((name, samples, wrong) for name, (samples, wrong) in found.items())
    return page.Table("Samples that were valid away from the truth", ("of", "samples", "valid and wrong"), rows)


def cold_starts(of: Mapping[str, Kind]) -> page.Section:
    """Return how long it takes from `init` to a valid estimate."""
    text = page.Text(
        f"After init the place is not known: the search begins at one point after another of a sequence that fills the "
        f"pitch. Bodies are on {STARTS} × {STARTS} places of the pitch at yaws of −2°, 0 and 2°, at rest and moving at "
        f"{1e3 * DRIFT:g} mm/s. Three sensors tell all places apart; two are certain of theirs in a part of the pitch "
        "only, where a body that moves comes to: elsewhere they read the same at another place, within their noise in "
        "some per cent of the pitch and within the bound of residuals in more, or lose rank. An estimate that is not "
        "certain is not valid."
    )
    yaws = np.array([-YAW, 0.0, YAW])
    runs = {}
    for name, kind in of.items():
        for what, speed in (("at rest", 0.0), ("moving", DRIFT)):
            runs[f"{NAMES[name]}, {what}"] = cold_start.run(kind, cold_start.grid(kind, STARTS, yaws), WAIT, speed)
    rows = []
    for name, each in runs.items():
        took = each.took[each.took > 0]
        half, most = (float(np.median(took)), float(took.max())) if took.size else (np.inf, np.inf)
        time = 1e3 * shipped.TIME.period_s
        rows.append((name, 100 * float(each.found.mean()), 100 * each.valid, half * time, most * time, each.wrong))
    columns = ("bodies", "found, %", "valid, %", "half of them after, ms", "last of them after, ms", "valid and wrong")
    table = page.Table(f"Cold starts, {WAIT * shipped.TIME.period_s:g} s", columns, tuple(rows), digits=3)
    curves = {name: each.took for name, each in runs.items()}
    drawn = drawings_runs.waits(curves, WAIT, shipped.TIME.period_s)
    figure = page.Figure(figures.svg(drawn, "cold-starts"), "Share of cold starts that are valid, by the time.")
    return page.Section("Cold start", (text, figure, table))


def motion(of: Mapping[str, Kind]) -> page.Section:
    """Return how fast a body may be, and a run of random motions at these speeds."""
    rows: list[tuple[page.Cell, ...]] = []
    for name, kind in of.items():
        within = endurance.limits(kind)
        found = endurance.run(kind, MOVING, LONG, within)
        shares = 100 * found.valid, 100 * found.lost, found.wrong, 1e6 * found.worst
        rows.append((NAMES[name], within.speed, within.acceleration, found.samples, *shares))
    text = page.Text(
        "A sample expects the last motion, so that the speed is bounded by what corrections may reach and the "
        "acceleration by what a body is taken to make: v = reach / (2 ω T), a = m · follow · surprise s / (α √λ ω T²), "
        f"of which m = {1 - endurance.MARGIN:g} leaves the rest to the noise and the yaw. Random motions go up to "
        "both, at yaws that are declared. The verification below runs ten million samples of them where it is whole."
    )
    columns = ("sensors", "speed, m/s", "acceleration, m/s²", "samples", "valid, %", "bodies lost, %")
    caption = f"Random motion up to the speed and the acceleration, {endurance.FAR} pitches counted"
    return page.Section(
        "Motion", (text, page.Table(caption, (*columns, "valid and wrong", "worst valid, µm"), tuple(rows)))
    )
