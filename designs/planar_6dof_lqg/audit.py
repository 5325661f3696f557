"""The audit of the planar positioner's paper, row by row: the optimal gains and the Kalman filter.

Motors, platen, Hall sensors and lead-lag loops are in `designs.planar_6dof_leadlag.audit`, whose printed numbers, (26)
and the sample rates among them, count here too. No row follows from the plant: (26) is taken as printed.
"""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from designs.planar_6dof_leadlag import audit as motors
from designs.planar_6dof_lqg import audit_filter, audit_gains
from designs.planar_6dof_lqg.audit_stage import Prints
from synth.report.audit import Published, Row, published

ROWS: Mapping[str, Callable[[Prints, Published], Row]] = {
    "Y-10": audit_gains.optimal,
    "Y-11": audit_gains.printed_weights,
    "Y-12": audit_gains.kalman_gain,
    "Y-13": audit_filter.bandwidth,
    "Y-14": audit_filter.bandwidth,
    "Y-15": audit_filter.reduction,
    "Y-36": audit_gains.separation,
    "Y-37": audit_gains.observability,
    "Y-38": audit_filter.figure_5,
    "Y-39": audit_filter.recursion,
}
RECORDED = ("Y-40", "Y-41")  # printed, and recomputed by `audit_records` from the whole loop's records


def rows() -> Iterator[Row]:
    """Yield the rows, each when it is computed."""
    yield from on({**motors.printed(), **printed()})


def on(prints: Prints) -> Iterator[Row]:
    """Yield the rows as recomputed from what both published.toml hold."""
    for name, recompute in ROWS.items():
        yield recompute(prints, prints[name])


def printed() -> dict[str, Published]:
    """Return what the paper prints, by row."""
    return published(Path(__file__).with_name("published.toml").read_text(encoding="utf-8"))
