"""The two designs of the maglev stage side by side: tracking, steps, margins, current, hunting, yield. No verdicts.

    python -m benchmarks.maglev_comparison [PLANTS]

Nominal values are those of the machine without deviations; the worst are those of PLANTS machines within their
tolerances, a lower bound of the worst case. The margins are the least at the operating points. Hunting is the true
distance from the set-point between 3 and 4 s of a rest at 25 mm, largest less least. `synth cost` has the instructions.
"""

import sys
from collections.abc import Iterator

import numpy as np

from designs.maglev_5dof import design as paper
from designs.maglev_5dof_precise import design as precise
from synth import study_runs
from synth.analyse import robustness
from synth.declaration import Stage
from synth.simulate import study
from synth.simulate.sampling import Sampling
from synth.verify import standard

EXPERIMENTS = ("y_22_29", "x_30", "theta_5", "tracking")
PLANTS = 96
AXES = {"y": 1e6, "x": 1e6, "z": 1e6, "phi": 1e6, "theta": 1e6}  # um, urad
Row = tuple[str, float]


def study_values(stage: Stage, plants: int) -> Iterator[Row]:
    """Yield the nominal and the worst value of every check of the experiments, and the yield."""
    table = study_runs.run(stage, Sampling(plants), EXPERIMENTS, range(plants))
    for name, values in table.checks.items():
        yield f"{name}, {table.units[name]}, nominal", float(values[0])
        yield f"{name}, {table.units[name]}, worst", float(np.nanmax(values))
    share = study.estimate_yield(table)
    yield "yield under the limits of the design", share.share
    yield "yield, low end of 95 %", share.low
    yield "yield, high end of 95 %", share.high


def margins(stage: Stage) -> Iterator[Row]:
    """Yield the least margins of the nominal plant at the operating points."""
    loops = standard.loops(stage)
    opened = robustness.open_loops(loops)
    for name in robustness.REQUIREMENTS:
        yield f"least {name.replace('_', ' ')}", min(loop.margin(name) for loop in opened)
    yield "least disk margin", min(robustness.disk_margins(loops, point)["both"].lower for point in loops.points)


def hunting(stage: Stage) -> Iterator[Row]:
    """Yield how far each coordinate moves at rest between the counts of its encoders."""
    rest = study_runs.rig(stage).run(4.0)
    for axis, scale in AXES.items():
        yield f"hunting of {axis}, um or urad", scale * float(np.ptp(rest[axis][3000:]))


def main(plants: int) -> None:
    """Write both designs side by side."""
    columns = [
        dict(row for part in (study_values(s, plants), hunting(s), margins(s)) for row in part)
        for s in (paper.DESIGN.stage, precise.DESIGN.stage)
        if s is not None
    ]
    lines = [f"{'':60} {'paper':>12} {'precise':>12}    {plants} machines"]
    lines += [f"{name:60} " + " ".join(f"{c.get(name, np.nan):12.5g}" for c in columns) for name in columns[0]]
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else PLANTS)
