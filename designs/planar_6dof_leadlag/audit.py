"""The audit of the planar positioner's paper, row by row: motors, platen, Hall sensors and lead-lag loops.

The optimal gains and the Kalman filter are in `designs.planar_6dof_lqg.audit`. Everything is computed from the
parameters of the plant that is given and the printed numbers, or from records of the loop that is given; a verdict is
never stored.
"""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from designs.planar_6dof import experiments as shared
from designs.planar_6dof.loop import Loop
from designs.planar_6dof_leadlag import (
    audit_loops,
    audit_motor,
    audit_platen,
    audit_records,
    audit_sensing,
    experiments,
)
from designs.planar_6dof_leadlag.audit_bench import Bench
from models import planar_stage
from synth.report.audit import Published, Row, published

ROWS: Mapping[str, Callable[[Bench, Published], Row]] = {
    "Y-1": audit_motor.area,
    "Y-2": audit_motor.nominal_current,
    "Y-3": audit_motor.voltages,
    "Y-4": audit_motor.geometric_constant,
    "Y-5": audit_motor.per_ampere,
    "Y-6": audit_motor.arm,
    "Y-7": audit_loops.crossover,
    "Y-8": audit_loops.crossover,
    "Y-9": audit_loops.settling,
    "Y-9b": audit_loops.overshoot,
    "Y-16": audit_platen.rate,
    "Y-17": audit_motor.pitch,
    "Y-18": audit_motor.array_width,
    "Y-19": audit_motor.thickness,
    "Y-20": audit_motor.distribution,
    "Y-21": audit_motor.phases,
    "Y-22": audit_platen.motions,
    "Y-23": audit_platen.yaw_of_c,
    "Y-24": audit_platen.inertias,
    "Y-25": audit_platen.springs,
    "Y-26": audit_platen.travel,
    "Y-27": audit_platen.circle,
    "Y-28": audit_platen.control_outputs,
    "Y-29": audit_sensing.spacing,
    "Y-30": audit_sensing.switching,
    "Y-31": audit_sensing.inverse,
    "Y-32": audit_loops.controllers,
    "Y-33": audit_loops.axis_of_figure_8c,
}
RECORD = 200.0  # s, over which an rms is within 0.8 % of what it tends to; over 20 s it is within 2.5 %


def noise(loop: Loop, published: Mapping[str, Published]) -> Row:
    """Y-34: recompute the noise as filtered, which is what the controller acts on.

    It tends to 6.9 um: that it counts as the print's 6 is close, and takes a record of RECORD to say.
    """
    return audit_records.noise(published["Y-34"], shared.filtered_at_rest(loop, RECORD))


def steps(loop: Loop, published: Mapping[str, Published]) -> Row:
    """Y-35: recompute the steps of Fig. 8, as the sensors show them."""
    found = experiments.steps(loop)
    records = {axis: run.response for axis, run in found.items()}
    return audit_records.steps(published, published["Y-35"], found["x"].time, records)


RECORDED: Mapping[str, Callable[[Loop, Mapping[str, Published]], Row]] = {"Y-34": noise, "Y-35": steps}


def rows(loop: Loop) -> Iterator[Row]:
    """Yield the rows, each when it is computed: those of the stage's parameters, then those of the loop's records."""
    published = printed()
    yield from on(Bench(planar_stage.plant(), published))
    for recompute in RECORDED.values():
        yield recompute(loop, published)


def on(bench: Bench) -> Iterator[Row]:
    """Yield the rows as recomputed on a bench of given plant and print."""
    for name, recompute in ROWS.items():
        yield recompute(bench, bench.published[name])


def printed() -> dict[str, Published]:
    """Return what the paper prints, by row."""
    return published(Path(__file__).with_name("published.toml").read_text(encoding="utf-8"))
