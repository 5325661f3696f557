"""How strongly inputs move and outputs show each mode of a linear model.

The measure of Popov, Belevitch and Hautus for an eigenvalue s is the least singular value of [A - s I, B], or of
[A - s I; C], in scaled units (`staircase.scaled`) with columns of B and rows of C of length 1: 0 out of reach or sight,
1 at best. Of one input alone it is 0, too, where two modes have one eigenvalue.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from synth import show
from synth.analyse import staircase, structure
from synth.statespace import Array, System, of
from synth.timing import Time

WEAK = 1e-3  # a mode whose measure is less counts as weakly reached or seen


@dataclass(frozen=True)
class Coupling:
    """A mode with its measures: `reach` by all inputs, `sight` by all outputs, and by each alone."""

    value: complex
    states: structure.Direction
    reach: float
    sight: float
    by_input: Mapping[str, float]
    by_output: Mapping[str, float]


@show.printed
@dataclass(frozen=True, eq=False, repr=False)
class Couplings:
    """The couplings of each mode, the slowest first."""

    modes: tuple[Coupling, ...]
    time: Time

    @property
    def weakly_reached(self) -> tuple[Coupling, ...]:
        """The modes whose `reach` is below WEAK."""
        return tuple(m for m in self.modes if m.reach < WEAK)

    @property
    def weakly_seen(self) -> tuple[Coupling, ...]:
        """The modes whose `sight` is below WEAK."""
        return tuple(m for m in self.modes if m.sight < WEAK)

    def sheet(self) -> show.Sheet:
        """Return one line for each mode or pair, and sentences on those that are weakly coupled."""
        lines = [
            f"Weakly {how}: mode {structure.pair(m.value)} in {structure.spelled(m.states)}."
            for how, modes in (("reached", self.weakly_reached), ("seen", self.weakly_seen))
            for m in modes
            if m.value.imag >= 0
        ]
        rows = tuple(
            (
                structure.pair(m.value),
                f"{m.reach:.2g}",
                f"{m.sight:.2g}",
                max(m.by_input, key=m.by_input.__getitem__, default=""),
                max(m.by_output, key=m.by_output.__getitem__, default=""),
                structure.spelled(m.states),
            )
            for m in self.modes
            if m.value.imag >= 0
        )
        columns = ("mode", "reach", "sight", "best input", "best output", "states")
        return show.Sheet(f"Couplings of the modes in {self.time}", tuple(lines), (show.Table(columns, rows),))


def couplings(system: System) -> Couplings:
    """Return how strongly inputs move and outputs show each mode of a System.

    Raises SignalError as `statespace.of`.
    """
    model = of(system)
    part = staircase.of_model(model)
    found = []
    for root in structure.poles(model).roots:
        shifted = part.A - root.value / part.rate * np.eye(len(part.A))
        reach, by_input = _measures(shifted, part.B, model.inputs)
        sight, by_output = _measures(shifted.T, part.C.T, model.outputs)
        found.append(Coupling(root.value, root.states, reach, sight, by_input, by_output))
    return Couplings(tuple(found), model.time)


def _measures(shifted: staircase.Complex, B: Array, names: Sequence[str]) -> tuple[float, dict[str, float]]:
    """Return the least singular value of [A - s I, B] for all columns of B, made of length 1, and for each alone."""
    size = np.linalg.norm(B, axis=0)
    unit = B / np.where(size > 0, size, 1.0)

    def least(columns: Array) -> float:
        return float(np.linalg.svd(np.hstack([shifted, columns]), compute_uv=False)[-1])

    return least(unit), {name: least(unit[:, [j]]) for j, name in enumerate(names)}
