"""The audit of the maglev stage's paper, row by row: printed, recomputed, verdict.

Everything is computed from the parameters of the plant that is given; a verdict is never stored.
"""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from designs.maglev_5dof import audit_loops, audit_model, audit_motor
from designs.maglev_5dof.audit_bench import Bench
from models import maglev_stage
from synth.plant import Plant
from synth.report.audit import Published, Row, published

ROWS: Mapping[str, Callable[[Bench, Published], Row]] = {
    "F-1": lambda b, f: audit_motor.levitation(b.plant, f),
    "F-2": lambda b, f: audit_motor.printed_power(b.plant, f),
    "F-3": lambda b, f: audit_motor.pole_pairs(b.plant, f, b.cells),
    "F-4": lambda b, f: audit_motor.cogging(b.plant, f, b.cells),
    "F-5": lambda b, f: audit_model.dominance_as_printed(b.plant, f),
    "F-5b": lambda b, f: audit_model.dominance(b.plant, f),
    "F-6": lambda b, f: audit_model.order_of_a1(b.plant, f),
    "F-7": lambda b, f: audit_model.invertibility(b.plant, f),
    "F-8": lambda b, f: audit_loops.poles("y", f),
    "F-9": lambda b, f: audit_loops.poles("x", f),
    "F-10": lambda b, f: audit_loops.poles("theta", f),
    "F-11": audit_loops.gap_step,
    "F-12": lambda b, f: audit_loops.tilt_step(f),
    "F-13": lambda b, f: audit_loops.horizontal_step(f),
    "F-14": audit_loops.ellipse,
    "F-15": audit_loops.tracking,
    "F-16": audit_loops.horizontal_errors,
    "F-17": lambda b, f: audit_model.rotational_resolution(b.plant, f),
    "F-18": lambda b, f: audit_model.rotation_range(b.plant, f),
    "F-19": lambda b, f: audit_model.double_integrators(b.plant, f),
}


def rows(plant: Plant | None = None) -> Iterator[Row]:
    """Yield the rows F-1 to F-19 for the stage's parameters, or those of `plant`, each when it is computed."""
    yield from on(Bench(plant or maglev_stage.plant(), printed()))


def on(bench: Bench) -> Iterator[Row]:
    """Yield the rows as recomputed on a bench of given plant, length of runs and fineness of the field."""
    for name, recompute in ROWS.items():
        yield recompute(bench, bench.published[name])


def printed() -> dict[str, Published]:
    """Return what the paper prints, by row."""
    return published(Path(__file__).with_name("published.toml").read_text(encoding="utf-8"))
