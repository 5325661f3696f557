"""The audit of the planar positioner's paper, row by row: the optimal gains and the Kalman filter.

Motors, platen, Hall sensors and lead-lag loops are in `designs.planar_6dof_leadlag.audit`, whose printed numbers, (26)
and the sample rates among them, count here too. No row but those of the loop's records follows from the plant: (26) is
taken as printed.
"""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from designs.planar_6dof import experiments as shared
from designs.planar_6dof.loop import Loop
from designs.planar_6dof_leadlag import audit as motors
from designs.planar_6dof_lqg import audit_filter, audit_gains, audit_records, experiments
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
RECORD = 20.0  # s, of noise


def noise(loop: Loop, published: Prints) -> Row:
    """Y-40: recompute the noise as filtered, as for the lead-lag controller."""
    return audit_records.noise(published["Y-40"], shared.filtered_at_rest(loop, RECORD))


def spectrum(loop: Loop, published: Prints) -> Row:
    """Y-41: recompute the spectrum of the step of x, as measured."""
    return audit_records.spectrum(published["Y-41"], experiments.settled(loop), loop.period_s)


RECORDED: Mapping[str, Callable[[Loop, Prints], Row]] = {"Y-40": noise, "Y-41": spectrum}


def rows(loop: Loop) -> Iterator[Row]:
    """Yield the rows, each when it is computed: those of the printed numbers, then those of the loop's records."""
    published = {**motors.printed(), **printed()}
    yield from on(published)
    for recompute in RECORDED.values():
        yield recompute(loop, published)


def on(prints: Prints) -> Iterator[Row]:
    """Yield the rows as recomputed from what both published.toml hold."""
    for name, recompute in ROWS.items():
        yield recompute(prints, prints[name])


def printed() -> dict[str, Published]:
    """Return what the paper prints, by row."""
    return published(Path(__file__).with_name("published.toml").read_text(encoding="utf-8"))
