"""Search for the worst machine of a check within the tolerances, from the worst machine of a sample.

    z_0 = worst row of the sample;   z_k+1 = argmax of the check over z_k and its neighbours, until none is worse

A neighbour has one quantity at another end of its tolerance: -1 or 1. All neighbours run side by side, with the sensor
noise of the first row, so that the search is the same on every machine. It climbs to a machine that no single change
makes worse; the worst case may still be worse: its value is a lower bound, as the sample's.

Stanford diagram (integrity diagram): errors e of an estimate against its protection levels p, with alert limit a.

    p > a, or not valid          unavailable
    |e| <= p <= a                nominal
    p < |e| <= a                 misleading information
    p <= a < |e|                 hazardously misleading information

The diagram shows the number of samples in each region, and counts over |e| and p in steps of a fraction of the limit.
An integrity monitor passes if the fraction of misleading samples is at most the risk that was allocated.

Library: the error and the level come from a Monte Carlo of the user's own stage, as in the how-to of an estimator.

Source: Tossaint et al., "The Stanford-ESA Integrity Diagram: A New Tool for the User Domain SBAS Integrity Assessment",
Navigation 54 (2007).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth import arguments, numeric, show
from synth.errors import DesignError, SignalError
from synth.show import Sheet, Table
from synth.simulate import study
from synth.simulate.rig import Rig
from synth.simulate.study import StudyTable

REGIONS = ("nominal", "misleading", "hazardous", "unavailable")


@show.result
class Diagram:
    """Samples by region, and `counts` (k + 1, k + 1): rows of |e|, columns of p, in steps of limit / k, then beyond.

    Counts are of the valid samples.
    """

    limit: float
    unit: str
    nominal: int
    misleading: int
    hazardous: int
    unavailable: int
    counts: NDArray[np.int64]

    @property
    def samples(self) -> int:
        """Number of all samples."""
        return self.nominal + self.misleading + self.hazardous + self.unavailable

    @property
    def availability(self) -> float:
        """Fraction of the samples that are not unavailable."""
        return 1 - self.unavailable / self.samples

    @property
    def risk(self) -> float:
        """Fraction of the samples that are misleading, hazardously or not."""
        return (self.misleading + self.hazardous) / self.samples

    def sheet(self) -> Sheet:
        """Return the regions, and the counts of error over protection level."""
        regions = tuple((name, str(v := getattr(self, name)), f"{v / self.samples:.5f}") for name in REGIONS)
        k = len(self.counts) - 1
        steps = [f"<= {show.number(self.limit * (i + 1) / k, 3)}" for i in range(k)] + ["beyond"]
        rows = tuple((steps[i], *map(str, self.counts[i])) for i in reversed(range(k + 1)))
        title = f"Stanford diagram of {self.samples} samples, alert limit {show.number(self.limit, 3)} {self.unit}"
        note = "Rows: size of the error. Columns: protection level. Above the diagonal of equal steps: misleading."
        return Sheet(
            title,
            (),
            (Table("", ("region", "samples", "fraction"), regions), Table("", ("error", *steps), rows, note=note)),
        )


@arguments.checked
def diagram(
    errors: ArrayLike, levels: ArrayLike, valid: ArrayLike, limit: float, unit: str = "", steps: int = 5
) -> Diagram:
    """Return the diagram of errors (N,), protection levels (N,) and flags (N,), with the alert `limit` in their unit.

    Raises SignalError for arrays of other shapes, without samples or not finite, ModelError for a limit that is not
    positive or fewer than one step.
    """
    e, p, flags = (
        np.asarray(arguments.real(n, v)) for n, v in (("errors", errors), ("levels", levels), ("flags", valid))
    )
    limit, steps = numeric.positive("the limit", limit), numeric.whole("the steps", steps, 1, 50)
    if (
        e.ndim != 1
        or e.shape != p.shape
        or e.shape != flags.shape
        or not e.size
        or not np.isfinite([e, p, flags]).all()
    ):
        raise SignalError(f"errors {e.shape}, levels {p.shape}, flags {flags.shape}: give finite arrays of one length")
    e, available = np.abs(e), (flags > 0) & (p <= limit)
    misleading = available & (e > p)
    hazardous = misleading & (e > limit)
    rows, columns = (np.minimum(np.ceil(v * steps / limit).astype(int), steps + 1).clip(1) - 1 for v in (e, p))
    counts = np.zeros((steps + 1, steps + 1), np.int64)
    np.add.at(counts, (rows[flags > 0], columns[flags > 0]), 1)
    nominal = int(np.sum(available & ~misleading))
    sizes = nominal, int(np.sum(misleading & ~hazardous)), int(np.sum(hazardous)), int(np.sum(~available))
    return Diagram(limit, unit, *sizes, counts)


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
