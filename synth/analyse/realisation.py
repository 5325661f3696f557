"""Minimal realisation: the same response C (s I - A)^-1 B + D with the least number of states.

In scaled coordinates x = X x~ an orthonormal Z (n, k) spans what inputs reach and outputs show (Kalman), and

    (Z' A~ Z, Z' B~, C~ Z, D)

has the response of (A, B, C, D). A state that lies in the span stays as it is, with its name and unit; the others are
replaced by fewer new ones, orthonormal combinations in scaled units.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from synth import arguments, show
from synth.analyse import staircase, structure
from synth.errors import ModelError
from synth.statespace import Array, StateSpace, System, of
from synth.timing import Continuous

SAME = 1e-8  # of the response at a point: a part that is left out for its coupling below COUPLING changes it by less
CUTS = (1e-8, 1e-9, 1e-10, staircase.COUPLING)  # tried in turn: but for the last, what they leave out is in rounding
ROUNDING = 10 * np.finfo(float).eps  # of |C| |(s I - A)^-1| |B|, times the condition of s I - A
CLEAR = 100.0  # of the largest coupling left out: when the least one kept is not above this, the order is uncertain
POINTS = 12  # points at which the two responses are compared


@dataclass(frozen=True)
class Fewer:
    """A lesser number of states and the relative change of the response that comes with it."""

    order: int
    difference: float


@show.result
class Minimal:
    """The minimal `model`, the modes that left it, and the largest difference of the responses.

    No input moved the modes `unmoved`, no output showed those `unseen`; directions are in the states of the model as it
    was. `removed` are the states that are no longer there, `added` those that were not there before. `difference` is
    relative, over points from below the slowest to above the fastest pole. `gap` holds the least coupling that was kept
    and the largest that was left out, of 1 at best: the order is certain when they lie far apart. `fewer` is an order
    that hardly changes the response, yet by more than rounding explains.
    """

    model: StateSpace
    unmoved: tuple[structure.Mode, ...]
    unseen: tuple[structure.Mode, ...]
    removed: tuple[str, ...]
    added: tuple[str, ...]
    difference: float
    gap: staircase.Gap
    fewer: Fewer | None

    def sheet(self) -> show.Sheet:
        """Return the counts, the new states and a line for each mode that left."""
        lines = [f"States: {', '.join(self.model.states) or 'none'}; the responses differ by {self.difference:.1e}."]
        if self.gap.left:
            doubt = "" if self.gap.ratio > CLEAR else "; they lie so close that the order is uncertain"
            lines.append(f"Least coupling kept {self.gap.kept:.0e}, largest left out {self.gap.left:.0e}{doubt}.")
        if self.fewer:
            lines.append(
                f"{self.fewer.order} states change the response by {self.fewer.difference:.0e}: more than rounding "
                "explains, so that the others were kept; they may be surplus."
            )
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


@arguments.checked
def minimal(system: System) -> Minimal:
    """Return a System without the parts that no input moves or no output shows.

    Raises SignalError as `statespace.of` and `staircase.scaled`; ModelError when the response of what is left differs.
    """
    model = of(system)
    part = staircase.of_model(model)
    fewer: list[Fewer] = []
    for cut in CUTS:
        found = staircase.kalman(part, cut)
        left, added = _kept(model, part, found.kept)
        apart = _compare(model, left, part)
        if apart.in_rounding:
            break
        fewer.append(Fewer(len(left.A), apart.relative))
    near = [f for f in fewer if f.order < len(left.A) and f.difference <= SAME]
    if apart.relative > SAME:
        raise ModelError(
            f"the minimal realisation changes the response by {apart.relative:.1e} of its size: a part of the model is "
            f"coupled by no more than {staircase.COUPLING:.0e} yet acts; take it out of the model or couple it"
        )
    unmoved = structure.named_modes(found.unreached, part.B.T, part.rate, model.states)
    unseen = structure.named_modes(found.unseen, part.C, part.rate, model.states)
    removed = tuple(name for name in model.states if name not in left.states)
    return Minimal(left, unmoved, unseen, removed, added, apart.relative, found.gap, near[0] if near else None)


def _kept(model: StateSpace, part: staircase.Scaled, kept: Array) -> tuple[StateSpace, tuple[str, ...]]:
    """Return the model on an orthonormal basis `kept` (n, k) of scaled states, and the names that are new."""
    Z = kept[:, np.argsort([_place(z) for z in kept.T], kind="stable")]
    names, added = _names(model, Z)
    size = np.array([1.0 if name in added else part.x[_place(z)] for name, z in zip(names, Z.T, strict=True)])
    into, out = size[:, None] * Z.T / part.x, part.x[:, None] * Z / size
    return replace(model, A=into @ model.A @ out, B=into @ model.B, C=model.C @ out, states=names), added


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


@dataclass(frozen=True, eq=False)
class _Difference:
    """How far two responses lie `apart` (k,) at some points, their `size` (k,), and what `rounding` (k,) may do."""

    apart: Array
    size: Array
    rounding: Array

    @property
    def in_rounding(self) -> bool:
        """Tell whether there are points and rounding explains the difference at each."""
        return bool(len(self.apart) and (self.apart <= self.rounding).all())

    @property
    def relative(self) -> float:
        """The largest difference over the size, which is known no better than to its rounding."""
        size = np.maximum(self.size, self.rounding / SAME)
        return float((self.apart / np.where(size > 0, size, 1.0)).max(initial=0.0))


def _compare(one: StateSpace, other: StateSpace, part: staircase.Scaled) -> _Difference:
    """Compare two responses in the scaled inputs and outputs of `one`, of which `part` is the scaled model.

    The points lie on a ray that leaves s = 0 to the right, from below the slowest to above the fastest pole; those at
    which rounding alone moves the response of `one` by a tenth of SAME are left out.
    """
    v = _points(one)
    shifted = (v / part.rate)[:, None, None] * np.eye(len(part.A)) - part.A
    sigma = np.linalg.svd(shifted, compute_uv=False) if len(part.A) else np.ones((len(v), 1))
    good = sigma[:, 0] * np.finfo(float).eps < 0.1 * SAME * sigma[:, -1]
    v, most, least = v[good], sigma[good, 0], sigma[good, -1]
    a, b = (part.u * _response(model, v) / part.y[:, None] for model in (one, other))
    through = np.linalg.norm(part.C) * np.linalg.norm(part.B) / least
    apart, size = (np.abs(M).max(axis=(1, 2), initial=0.0) for M in (a - b, a))
    return _Difference(apart, size, ROUNDING * most / least * through)


def _points(model: StateSpace) -> NDArray[np.complex128]:
    rates = np.abs(structure.rates(model.poles, model.time))
    least = 2.0**-staircase.LARGEST  # slower is an integrator, faster a delay
    known = rates[(rates > least) & (rates < 1 / least)]
    low, high = (0.1 * known.min(), 10 * known.max()) if len(known) else (1.0, 1.0)
    s = np.geomspace(low, high, POINTS) * np.exp(0.7j)
    return np.asarray(s if isinstance(model.time, Continuous) else np.exp(s * model.time.period_s))


def _response(model: StateSpace, points: NDArray[np.complex128]) -> NDArray[np.complex128]:
    part = staircase.of_model(model)
    A, B, C = part.A * part.rate, part.B * part.rate / part.u, part.C * part.y[:, None]
    return replace(model, A=A, B=B, C=C).response(points)


@arguments.checked
def connected(model: StateSpace) -> StateSpace:
    """Return the model without the states that no input reaches or that reach no output, told by zeros of A, B, C.

    The response is the same function.
    """
    moves = model.A != 0
    reached, seen = (model.B != 0).any(axis=1), (model.C != 0).any(axis=0)
    for _ in range(len(model.A)):
        reached, seen = reached | moves[:, reached].any(axis=1), seen | moves[seen].any(axis=0)
    keep = np.flatnonzero(reached & seen)
    states = tuple(model.states[i] for i in keep)
    return replace(model, A=model.A[np.ix_(keep, keep)], B=model.B[keep], C=model.C[:, keep], states=states)
