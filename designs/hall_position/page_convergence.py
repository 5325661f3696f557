"""The report's part on corrections alone: from which starts GLSDC finds the place, without damping or memory."""

import numpy as np

from designs.hall_position import drawings_runs
from designs.hall_position.accuracy.layouts import LAYOUTS
from designs.hall_position.drawings import Map
from designs.hall_position.glsdc import parameters
from designs.hall_position.paper import estimate
from designs.hall_position.paper.stage import Array, Stage
from synth.report import figures, page

SIDE, PLACES = 25, 16  # starts along a side, from so many places of the pitch each
WIDE = 0.5  # pitches: the starts' square
CORRECTIONS, SCALE = 60, 0.5
FOUND = 1e-6  # m
NEAR = (0.0625, 0.125, 0.25)  # pitches, of starts that are counted


def convergence(stage: Stage) -> page.Section:
    """Return the basins of two sensors, the yaw known and estimated, and of three."""
    cases = {
        "two sensors, yaw known": (stage.pair, True),
        "two sensors, yaw estimated": (stage.pair, False),
        "three sensors, searched": (stage.array(LAYOUTS[5]), False),
    }
    shares = {name: basin(*case) for name, case in cases.items()}
    text = page.Text(
        "GLSDC as in row K-7 of the audit, many corrections in a row: where they end from a displaced start, the yaw "
        "begun at its true value of 0. Shown is the share of places of the pitch from which they find the body to "
        f"1 µm, with steps of {SCALE:g} of which none may raise the cost; voltages by model (2), without noise. With "
        "the yaw known the basin is nearly the pitch; estimated from two sensors it has holes, and from three it is "
        "all but whole within a quarter pitch. A body that moves with the estimate starts well inside."
    )
    maps = [Map(name, 100 * share) for name, share in shares.items()]
    drawn = drawings_runs.basins(maps, WIDE)
    figure = page.Figure(figures.svg(drawn, "basins"), f"Share of {PLACES} places in %, by where the start is off.")
    return page.Section("Basin of the corrections alone", (text, figure, _table(shares)))


def basin(of: parameters.Array, yaw_known: bool) -> Array:
    """Return the share of places (SIDE, SIDE) at which starts off by (X, Y) lead to the body."""
    off = of.pitch * np.linspace(-WIDE, WIDE, SIDE)
    X, Y = np.meshgrid(off, off, indexing="ij")
    places = of.pitch * np.random.default_rng(0).uniform(0, 1, (2, PLACES))
    q = np.zeros((3, PLACES, SIDE, SIDE))
    q[:2] = places[:, :, None, None]
    start = q + np.array([X, Y, np.zeros_like(X)])[:, None]
    flat, begun = q.reshape(3, -1), start.reshape(3, -1)
    end = estimate.settled(of, estimate.volts(of, flat), begun, SCALE, CORRECTIONS, yaw_known)
    found: Array = (np.hypot(*(end - flat)[:2]) < FOUND).reshape(PLACES, SIDE, SIDE).mean(axis=0)
    return found


def _table(shares: dict[str, Array]) -> page.Table:
    away = WIDE * np.abs(np.linspace(-1, 1, SIDE))
    furthest = np.maximum(away[:, None], away)
    rows: tuple[tuple[page.Cell, ...], ...] = tuple(
        (name, *(100 * float(share[furthest <= near + 1e-9].mean()) for near in NEAR)) for name, share in shares.items()
    )
    columns = ("sensors", *(f"within 1/{1 / near:g} pitch, %" for near in NEAR))
    return page.Table("Starts that lead to the place", columns, rows, digits=3)
