"""Minimal realisation: the same response C (s I - A)^-1 B + D with the least number of states.

In scaled coordinates x = X x~ an orthonormal Z (n, k) spans what inputs reach and outputs show (Kalman), and

    (Z' A~ Z, Z' B~, C~ Z, D)

has the response of (A, B, C, D). A state that lies in the span stays as it is, with its name and unit; the others are
replaced by fewer new ones, orthonormal combinations in scaled units.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from synth import show
from synth.analyse import staircase, structure
from synth.errors import ModelError
from synth.statespace import Array, StateSpace, System, of
from synth.timing import Continuous

SAME = 1e-8  # of the response at a point: a part that is left out for its coupling below COUPLING changes it by less
POINTS = 12  # points at which the two responses are compared


@show.printed
@dataclass(frozen=True, eq=False, repr=False)
class Minimal:
    """The minimal `model`, the modes that left it, and the largest difference of the responses.

    No input moved the modes `unmoved`, no output showed those `unseen`; directions are in the states of the model as it
    was. `removed` are the states that are no longer there, `added` those that were not there before. `difference` is
    relative, over points from below the slowest to above the fastest pole.
    """

    model: StateSpace
    unmoved: tuple[structure.Mode, ...]
    unseen: tuple[structure.Mode, ...]
    removed: tuple[str, ...]
    added: tuple[str, ...]
    difference: float

    def sheet(self) -> show.Sheet:
        """Return the counts, the new states and a line for each mode that left."""
        lines = [f"States: {', '.join(self.model.states) or 'none'}; the responses differ by {self.difference:.1e}."]
        if self.removed:
            lines.append(f"Gone: {', '.join(self.removed)}.")
        if self.added:
            lines.append(f"New, combinations of those that are gone: {', '.join(self.added)}.")
        kinds = (("no input moves it", self.unmoved), ("no output shows it", self.unseen))
        rows = tuple(
            (structure.pair(m.value), structure.spelled(m.direction), why)
            for why, modes in kinds
            for m in modes
            if m.value.imag >= 0
        )
        tables = (show.Table(("mode removed", "states", "why"), rows),) if rows else ()
        before = len(self.model.states) + len(self.unmoved) + len(self.unseen)
        return show.Sheet(f"Minimal model: {len(self.model.states)} of {before} states", tuple(lines), tables)


def minimal(system: System) -> Minimal:
    """Return a System without the parts that no input moves or no output shows.

    Raises SignalError as `statespace.of`; ModelError when the response of what is left differs.
    """
    model = of(system)
    part = staircase.of_model(model)
    found = staircase.kalman(part)
    Z = found.kept[:, np.argsort([_place(z) for z in found.kept.T], kind="stable")]
    names, added = _names(model, Z)
    size = np.array([1.0 if name in added else part.x[_place(z)] for name, z in zip(names, Z.T, strict=True)])
    into, out = size[:, None] * Z.T / part.x, part.x[:, None] * Z / size
    left = replace(model, A=into @ model.A @ out, B=into @ model.B, C=model.C @ out, states=names)
    difference = _difference(model, left)
    if difference > SAME:
        raise ModelError(
            f"the minimal realisation changes the response by {difference:.1e} of its size: a part of the model is "
            f"coupled by no more than {staircase.COUPLING:.0e} yet acts; take it out of the model or couple it"
        )
    unmoved = structure.named_modes(found.unreached, part.B.T, part.rate, model.states)
    unseen = structure.named_modes(found.unseen, part.C, part.rate, model.states)
    removed = tuple(name for name in model.states if name not in names)
    return Minimal(left, unmoved, unseen, removed, added, difference)


def _place(column: Array) -> int:
    """Return the place of the one state that a column of Z stands for, their number where it stands for several."""
    states = np.flatnonzero(column)
    return int(states[0]) if len(states) == 1 else len(column)


def _names(model: StateSpace, Z: Array) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the names of the columns of Z and, of these, the new ones."""
    taken = {*model.states, *model.inputs, *model.outputs}
    fresh = (name for k in range(1, len(taken) + len(Z) + 1) if (name := f"part{k}") not in taken)
    places = [_place(z) for z in Z.T]
    names = tuple(model.states[k] if k < len(Z) else next(fresh) for k in places)
    return names, tuple(name for name, k in zip(names, places, strict=True) if k == len(Z))


def _difference(one: StateSpace, other: StateSpace) -> float:
    """Return the largest difference of two responses over their size at a point, in scaled inputs and outputs.

    The points lie on a ray that leaves s = 0 to the right, from below the slowest to above the fastest pole; those at
    which rounding alone moves the response of `one` by a tenth of SAME are left out.
    """
    rates = np.abs(structure.rates(one.poles, one.time))
    known = rates[(rates > 0) & (rates < np.inf)]
    low, high = (0.1 * known.min(), 10 * known.max()) if len(known) else (1.0, 1.0)
    s = np.geomspace(low, high, POINTS) * np.exp(0.7j)
    v = s if isinstance(one.time, Continuous) else np.exp(s * one.time.period_s)
    part = staircase.of_model(one)
    if len(part.A):
        condition = np.linalg.cond((v / part.rate)[:, None, None] * np.eye(len(part.A)) - part.A)
        v = v[condition * np.finfo(float).eps < 0.1 * SAME]
    a, b = (part.u * _response(model, v) / part.y[:, None] for model in (one, other))
    size = np.abs(a).max(axis=(1, 2), initial=0.0)
    apart = np.abs(a - b).max(axis=(1, 2), initial=0.0)
    return float((apart / np.where(size > 0, size, 1.0)).max(initial=0.0))


def _response(model: StateSpace, points: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Return the response (k, p, m), computed in scaled states."""
    part = staircase.of_model(model)
    A, B, C = part.A * part.rate, part.B * part.rate / part.u, part.C * part.y[:, None]
    return replace(model, A=A, B=B, C=C).response(points)
