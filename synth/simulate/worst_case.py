"""Search for the worst machine of a check within the tolerances, from the worst machine of a sample.

    z_0 = worst row of the sample;   z_k+1 = argmax of the check over z_k and its neighbours, until none is worse

A neighbour has one quantity at another end of its tolerance: -1 or 1. All neighbours run side by side, with the sensor
noise of the first row, so that the search is the same on every machine. It climbs to a machine that no single change
makes worse; the worst case may still be worse: its value is a lower bound, as the sample's.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.errors import DesignError
from synth.simulate import study
from synth.simulate.rig import Rig
from synth.simulate.study import StudyTable

Array = NDArray[np.float64]

ROUNDS = 8  # at most; each has two machines for each quantity


@dataclass(frozen=True)
class WorstCase:
    """The worst machine of a search: the value of the check there, its deviations z by quantity, and the machines run.

    `sampled` is the largest value of the sample, of its row `row`. `converged` tells that no neighbour is worse.
    """

    check: str
    sampled: float
    value: float
    row: int
    z: Mapping[str, float]
    machines: int
    converged: bool


def search(rig: Rig, experiments: Sequence[Any], seed: int, table: StudyTable, check: str) -> WorstCase:
    """Return the worst machine for a check or figure, called "experiment: name", of the table of a sample.

    Raises DesignError for a name that the table does not have, and for one without a value in any row.
    """
    columns = {**table.figures, **table.checks}
    if check not in columns or np.isnan(columns[check]).all():
        raise DesignError(f"no value is called '{check}' in the study: choose from {', '.join(columns) or 'none'}")
    selected = [e for e in experiments if check.startswith(f"{e.name}: ")]
    k = int(np.nanargmax(columns[check]))
    row, names = int(table.rows[k]), tuple(table.z)
    z, value = np.array([table.z[name][k] for name in names]), float(columns[check][k])
    worst = WorstCase(check, value, value, row, dict(zip(names, z.tolist(), strict=True)), 0, False)
    for _ in range(ROUNDS):
        near = neighbours(z)
        tried = study.run_machines(rig, selected, near, seed, [row] * len(near), table.integration)
        values = {**tried.figures, **tried.checks}.get(check, np.full(len(near), np.nan))
        best = int(np.nanargmax(np.append(worst.value, values))) - 1
        worst = replace(worst, machines=worst.machines + len(near), converged=best < 0)
        if worst.converged:
            break
        z = near[best]
        worst = replace(worst, value=float(values[best]), z=dict(zip(names, z.tolist(), strict=True)))
    return worst


def neighbours(z: Array) -> Array:
    """Return the machines (n, quantities) that differ from z in one quantity, which is at -1 or 1."""
    changes = [(k, end) for k in range(len(z)) for end in (-1.0, 1.0) if z[k] != end]
    near = np.tile(z, (len(changes), 1))
    for row, (k, end) in zip(near, changes, strict=True):
        row[k] = end
    return near


def notes(worst: WorstCase) -> list[str]:
    """Return what the search did, as sentences."""
    deviations = ", ".join(f"{name} {z:+.3f}" for name, z in worst.z.items())
    end = "no change of one quantity makes it worse" if worst.converged else "the search ended before it converged"
    return [
        f"Search from row {worst.row} over {worst.machines} machines: {worst.check} {worst.sampled:.6g} in the sample, "
        f"{worst.value:.6g} at the worst; {end}. This is a lower bound of the worst case too.",
        f"Deviations there, in tolerances: {deviations}.",
    ]
