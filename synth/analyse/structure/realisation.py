"""Minimal realisation (MATLAB `minreal`): the same response C (s I - A)^-1 B + D with the least number of states.

In scaled coordinates x = X x~, an orthonormal Z (n, k) spans the controllable and observable part (Kalman), and

    (Z' A~ Z, Z' B~, C~ Z, D)

has the response of (A, B, C, D). A state in the span of Z stays, with its name and unit. Fewer new states replace the
others: orthonormal combinations of them in scaled units.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from synth import arguments, show
from synth.analyse.structure import staircase, structure
from synth.errors import ModelError
from synth.statespace import Array, StateSpace, System, of
from synth.timing import Continuous

RESPONSE_TOLERANCE = 1e-8  # relative: removal of a part with coupling below COUPLING changes it by less
THRESHOLDS = (1e-8, 1e-9, 1e-10, staircase.COUPLING)  # smaller couplings count as 0; tried until only rounding is left
ROUNDING = 10 * np.finfo(float).eps  # of |C| |(s I - A)^-1| |B|, times the condition of s I - A
MIN_GAP_RATIO = 100.0  # of the smallest coupling kept to the largest neglected: below it the order is uncertain
POINTS = 12  # points at which the two responses are compared


@dataclass(frozen=True)
class LowerOrder:
    """A lower order and the relative change of the response that it causes."""

    order: int
    difference: float


@show.result
class Minimal:
    """The minimal `model`, the removed modes, and the largest difference of the responses.

    `uncontrollable` and `unobservable` are the removed modes; directions are in the original states.
    `removed` are the states that were removed, `added` the new ones. `difference` is relative, over points from below
    the slowest to above the fastest pole. `gap` holds the smallest coupling kept, 1 at best, and the largest neglected:
    the order is certain if they are far apart. `lower_order` is one that changes the response little, but by more than
    rounding explains.
    """

    model: StateSpace
    uncontrollable: tuple[structure.Mode, ...]
    unobservable: tuple[structure.Mode, ...]
    removed: tuple[str, ...]
    added: tuple[str, ...]
    difference: float
    gap: staircase.Gap
    lower_order: LowerOrder | None

    def sheet(self) -> show.Sheet:
        """Return the counts, the new states and a row for each removed mode."""
        lines = [f"States: {', '.join(self.model.states) or 'none'}; the responses differ by {self.difference:.1e}."]
        if self.gap.neglected:
            doubt = "" if self.gap.ratio > MIN_GAP_RATIO else "; they lie so close that the order is uncertain"
            lines.append(f"Least coupling kept {self.gap.kept:.0e}, largest neglected {self.gap.neglected:.0e}{doubt}.")
        if self.lower_order:
            order, change = self.lower_order.order, self.lower_order.difference
            lines.append(
                f"{order} states change the response by {change:.0e}: more than rounding explains. "
                "The others are kept; they may be superfluous."
            )
        if self.removed:
            lines.append(f"Removed: {', '.join(self.removed)}.")
        if self.added:
            lines.append(f"New, combinations of those removed: {', '.join(self.added)}.")
        kinds = (("uncontrollable", self.uncontrollable), ("unobservable", self.unobservable))
        rows = tuple(
            (structure.pair(m.value), structure.direction_text(m.direction), why)
            for why, modes in kinds
            for m in modes
            if m.value.imag >= 0
        )
        tables = (show.Table("", ("mode removed", "states", "why"), rows),) if rows else ()
        before = len(self.model.states) + len(self.uncontrollable) + len(self.unobservable)
        return show.Sheet(f"Minimal model: {len(self.model.states)} of {before} states", tuple(lines), tables)


@arguments.checked
def minimal(system: System) -> Minimal:
    """Return a System without its uncontrollable and unobservable parts.

    Raises SignalError as `statespace.of` and `staircase.scaled`; ModelError if the response changes.
    """
    model = of(system)
    scaled = staircase.of_model(model)
    lower_orders: list[LowerOrder] = []
    for threshold in THRESHOLDS:
        decomposition = staircase.kalman(scaled, threshold)
        reduced, added = _project(model, scaled, decomposition.kept)
        difference = _compare(model, reduced, scaled)
        if difference.is_rounding:
            break
        lower_orders.append(LowerOrder(len(reduced.A), difference.relative))
    candidates = [f for f in lower_orders if f.order < len(reduced.A) and f.difference <= RESPONSE_TOLERANCE]
    if difference.relative > RESPONSE_TOLERANCE:
        raise ModelError(
            f"the minimal realisation changes the response by {difference.relative:.1e} of its size: a part of the "
            f"model has a coupling of no more than {staircase.COUPLING:.0e} yet acts; take it out of the model or "
            "couple it"
        )
    uncontrollable = structure.named_modes(decomposition.uncontrollable, scaled.B.T, scaled.rate, model.states)
    unobservable = structure.named_modes(decomposition.unobservable, scaled.C, scaled.rate, model.states)
    removed = tuple(name for name in model.states if name not in reduced.states)
    return Minimal(
        reduced,
        uncontrollable,
        unobservable,
        removed,
        added,
        difference.relative,
        decomposition.gap,
        candidates[0] if candidates else None,
    )


def _project(model: StateSpace, scaled: staircase.Scaled, kept: Array) -> tuple[StateSpace, tuple[str, ...]]:
    """Return the model on an orthonormal basis `kept` (n, k) of scaled states, and the names that are new."""
    Z = kept[:, np.argsort([_single_state(z) for z in kept.T], kind="stable")]
    names, added = _state_names(model, Z)
    size = np.array([1.0 if name in added else scaled.x[_single_state(z)] for name, z in zip(names, Z.T, strict=True)])
    to_reduced, to_full = size[:, None] * Z.T / scaled.x, scaled.x[:, None] * Z / size
    return replace(
        model, A=to_reduced @ model.A @ to_full, B=to_reduced @ model.B, C=model.C @ to_full, states=names
    ), added


def _single_state(column: Array) -> int:
    """Return the index of the only state in a column of Z, or the number of states if it combines several."""
    states = np.flatnonzero(column)
    return int(states[0]) if len(states) == 1 else len(column)


def _state_names(model: StateSpace, Z: Array) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the names of the columns of Z and, of these, the new ones."""
    taken = {*model.states, *model.inputs, *model.outputs}
    fresh = (name for k in range(1, len(taken) + len(Z) + 1) if (name := f"part{k}") not in taken)
    places = [_single_state(z) for z in Z.T]
    names = tuple(model.states[k] if k < len(Z) else next(fresh) for k in places)
    return names, tuple(name for name, k in zip(names, places, strict=True) if k == len(Z))


@dataclass(frozen=True, eq=False)
class _Difference:
    """The `error` (k,) of two responses, their `size` (k,) and the effect of `rounding` (k,), at points."""

    error: Array
    size: Array
    rounding: Array

    @property
    def is_rounding(self) -> bool:
        """Whether there are points and rounding explains the difference at each."""
        return bool(len(self.error) and (self.error <= self.rounding).all())

    @property
    def relative(self) -> float:
        """The largest difference over the size; the size is at least the rounding over RESPONSE_TOLERANCE."""
        size = np.maximum(self.size, self.rounding / RESPONSE_TOLERANCE)
        return float((self.error / np.where(size > 0, size, 1.0)).max(initial=0.0))


def _compare(original: StateSpace, reduced: StateSpace, scaled: staircase.Scaled) -> _Difference:
    """Compare two responses in the scaled inputs and outputs of `original`, whose scaled model is `scaled`.

    The points lie on a ray from s = 0 into the right half-plane, from below the slowest to above the fastest pole.
    Points where rounding alone changes the response of `original` by a tenth of RESPONSE_TOLERANCE are omitted.
    """
    v = _points(original)
    shifted = (v / scaled.rate)[:, None, None] * np.eye(len(scaled.A)) - scaled.A
    sigma = np.linalg.svd(shifted, compute_uv=False) if len(scaled.A) else np.ones((len(v), 1))
    resolved = sigma[:, 0] * np.finfo(float).eps < 0.1 * RESPONSE_TOLERANCE * sigma[:, -1]
    v, largest, smallest = v[resolved], sigma[resolved, 0], sigma[resolved, -1]
    a, b = (scaled.u * _response(model, v) / scaled.y[:, None] for model in (original, reduced))
    gain = np.linalg.norm(scaled.C) * np.linalg.norm(scaled.B) / smallest
    error, size = (np.abs(M).max(axis=(1, 2), initial=0.0) for M in (a - b, a))
    return _Difference(error, size, ROUNDING * largest / smallest * gain)


def _points(model: StateSpace) -> NDArray[np.complex128]:
    rates = np.abs(structure.rates(model.poles, model.time))
    smallest = 2.0**-staircase.LARGEST  # a slower mode is an integrator, a faster one a delay
    finite = rates[(rates > smallest) & (rates < 1 / smallest)]
    low, high = (0.1 * finite.min(), 10 * finite.max()) if len(finite) else (1.0, 1.0)
    s = np.geomspace(low, high, POINTS) * np.exp(0.7j)
    return np.asarray(s if isinstance(model.time, Continuous) else np.exp(s * model.time.period_s))


def _response(model: StateSpace, points: NDArray[np.complex128]) -> NDArray[np.complex128]:
    scaled = staircase.of_model(model)
    A, B, C = scaled.A * scaled.rate, scaled.B * scaled.rate / scaled.u, scaled.C * scaled.y[:, None]
    return replace(model, A=A, B=B, C=C).response(points)


@arguments.checked
def without_unconnected_states(model: StateSpace) -> StateSpace:
    """Return the model without structurally uncontrollable or unobservable states, from the zeros of A, B, C.

    The response stays the same.
    """
    couplings = model.A != 0
    controlled, observed = (model.B != 0).any(axis=1), (model.C != 0).any(axis=0)
    for _ in range(len(model.A)):
        controlled = controlled | couplings[:, controlled].any(axis=1)
        observed = observed | couplings[observed].any(axis=0)
    keep = np.flatnonzero(controlled & observed)
    states = tuple(model.states[i] for i in keep)
    return replace(model, A=model.A[np.ix_(keep, keep)], B=model.B[keep], C=model.C[:, keep], states=states)
