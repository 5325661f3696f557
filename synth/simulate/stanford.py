"""Stanford diagram (integrity diagram): errors e of an estimate against its protection levels p, with alert limit a.

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

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth import arguments, numeric, show
from synth.errors import SignalError
from synth.show import Sheet, Table

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
            title, (), (Table(("region", "samples", "fraction"), regions), Table(("error", *steps), rows, note=note))
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
