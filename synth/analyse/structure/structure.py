"""Poles, transmission zeros, stabilisability and detectability of a linear model.

A pole s has a right eigenvector, A v = s v. A transmission zero is an s at which the response G(s) is below its normal
rank. With at least as many outputs as inputs, an input u exp(s t) with a suitable initial state x gives no output,

    [[A - s I, B], [C, D]] [x; u] = 0;

with fewer outputs than inputs, w^T G(s) = 0 for some w. (A, B) is stabilisable if w^H B != 0 for each left eigenvector
w^H A = s w^H of each mode s that does not decay; (A, C) is detectable if C v != 0 for each right eigenvector of each
such mode (Popov, Belevitch, Hautus).

Directions and measures are those of the scaled model (`staircase.scaled`) and do not depend on units. The largest
component of a direction is 1; components below a tenth are omitted.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from synth import arguments, show
from synth.analyse.structure import staircase
from synth.errors import ModelError
from synth.statespace import Array, Complex, StateSpace, System, of
from synth.timing import Continuous, Time

DECAY = 1e-12  # of |w|' |A|, w a scaled left eigenvector of length 1: a slower mode counts as not decaying
MAX_LISTED = 8  # components of a direction that a text lists
DOMINANT = 0.1  # of the largest component: smaller ones are omitted

Direction = Mapping[str, complex]


@dataclass(frozen=True)
class Mode:
    """A mode (eigenvalue) with the norm of w^H B or C v, and the components of its direction by state."""

    value: complex
    measure: float
    direction: Direction

    @property
    def states(self) -> tuple[str, ...]:
        """The states that dominate the direction, the largest first."""
        return tuple(self.direction)


@dataclass(frozen=True)
class Root:
    """A pole or zero with its damping, its frequency in Hz, and its direction in states, inputs and outputs.

    In discrete time `value` is in z; damping and frequency are those of s = log(z) / T. At s = 0 the damping is
    undefined (NaN).
    """

    value: complex
    damping: float
    frequency: float
    states: Direction
    inputs: Direction
    outputs: Direction


@show.result
class Poles:
    """The poles of a model, the slowest first, each with the states of its right eigenvector."""

    roots: tuple[Root, ...]
    time: Time

    @property
    def values(self) -> Complex:
        """The poles (n,) in 1/s or in z."""
        return np.array([r.value for r in self.roots], dtype=np.complex128)

    def sheet(self) -> show.Sheet:
        """Return one row for each pole or pair."""
        return show.Sheet(f"Poles in {self.time}: {len(self.roots)}", tables=_tables("pole", self.roots))


@show.result
class Zeros:
    """The finite transmission zeros of a model, the slowest first, and the normal `rank` of its response (p, m).

    The modes `uncontrollable` and `unobservable` cancel in the response and are not transmission zeros. Directions
    are defined if the rank is the lesser of p and m.
    """

    roots: tuple[Root, ...]
    rank: int
    shape: tuple[int, int]
    uncontrollable: tuple[Mode, ...]
    unobservable: tuple[Mode, ...]
    time: Time

    @property
    def values(self) -> Complex:
        """The zeros (k,) in 1/s or in z."""
        return np.array([r.value for r in self.roots], dtype=np.complex128)

    def sheet(self) -> show.Sheet:
        """Return one row for each zero or pair, and lines on degenerate cases."""
        lines = []
        if self.rank < min(self.shape):
            lines.append(
                f"The response has rank {self.rank} at every s though it has {self.shape[0]} outputs and "
                f"{self.shape[1]} inputs: some combination of inputs moves no output; no directions are defined."
            )
        lines += [
            f"Uncontrollable mode {_number(m.value)} in {direction_text(m.direction)}." for m in self.uncontrollable
        ]
        lines += [f"Unobservable mode {_number(m.value)} in {direction_text(m.direction)}." for m in self.unobservable]
        title = f"Transmission zeros in {self.time}: {len(self.roots)}"
        return show.Sheet(title, tuple(lines), _tables("zero", self.roots))


@arguments.checked
def poles(system: System) -> Poles:
    """Return the poles of a System, each with damping, frequency and participating states.

    Raises SignalError as `statespace.of`.
    """
    model = of(system)
    scaled = staircase.of_model(model)
    values, vectors = staircase.modes(scaled.A, np.eye(len(scaled.A)))
    empty = np.zeros((0, len(values)), dtype=np.complex128)
    return Poles(_roots(model, values * scaled.rate, vectors, empty, empty), model.time)


@arguments.checked
def transmission_zeros(system: System) -> Zeros:
    """Return the finite transmission zeros of a System with any numbers of inputs and outputs.

    Raises SignalError as `statespace.of`.
    """
    model = of(system)
    scaled = staircase.of_model(model)
    minimal = staircase.kalman(scaled)
    Z = minimal.kept
    zeros = staircase.zeros(Z.T @ scaled.A @ Z, Z.T @ scaled.B, scaled.C @ Z, scaled.D)
    empty = np.zeros((0, len(zeros.values)), dtype=np.complex128)
    u, y = (zeros.u, empty) if zeros.right else (empty, zeros.u)
    return Zeros(
        _roots(model, zeros.values * scaled.rate, Z @ zeros.x, u, y),
        zeros.rank,
        model.D.shape,
        named_modes(minimal.uncontrollable, scaled.B.T, scaled.rate, model.states),
        named_modes(minimal.unobservable, scaled.C, scaled.rate, model.states),
        model.time,
    )


@arguments.checked
def uncontrollable_modes(A: ArrayLike, B: ArrayLike, states: Sequence[str], time: Time) -> list[Mode]:
    """Return the uncontrollable modes that do not decay; A (n, n), B (n, m).

    Raises SignalError for other shapes or entries that are not finite.
    """
    A, B = arguments.matrix_of_shape("A", A, len(states), len(states)), arguments.matrix_of_shape("B", B, len(states))
    scaled = staircase.scaled(A, B)
    values, w = staircase.uncontrollable_modes(scaled)
    slow = DECAY * np.linalg.norm(np.abs(w).T @ np.abs(scaled.A), axis=1)
    not_decaying = values.real >= -slow if isinstance(time, Continuous) else np.abs(values) * scaled.rate >= 1 - DECAY
    return list(named_modes((values[not_decaying], w[:, not_decaying]), scaled.B.T, scaled.rate, states))


@arguments.checked
def require_stabilisable(A: ArrayLike, B: ArrayLike, states: Sequence[str], inputs: Sequence[str], time: Time) -> None:
    """Raise ModelError for the first uncontrollable mode that does not decay."""
    for mode in uncontrollable_modes(A, B, states, time):
        names = ", ".join(mode.states)
        raise ModelError(
            f"(A, B) is not stabilisable: mode {_number(mode.value)} in {names} has |w^H B| = {mode.measure:.0e} "
            f"for the inputs {', '.join(inputs)}: actuate {names} or take it out of the model{_remark(mode, A, time)}"
        )


@arguments.checked
def require_detectable(A: ArrayLike, C: ArrayLike, states: Sequence[str], what: str, time: Time) -> None:
    """Raise ModelError for the first unobservable mode that does not decay; `what` is the name of C (p, n)."""
    for mode in uncontrollable_modes(arguments.matrix("A", A).T, arguments.matrix("C", C).T, states, time):
        names = ", ".join(mode.states)
        raise ModelError(
            f"({what}, A) is not detectable: mode {_number(mode.value)} in {names} has |C v| = {mode.measure:.0e}: "
            f"weight or measure {names}, or take it out of the model{_remark(mode, A, time)}"
        )


@arguments.checked
def check_stabilisable(system: System) -> None:
    """Raise ModelError for the first uncontrollable mode of a System that does not decay."""
    model = of(system)
    require_stabilisable(model.A, model.B, model.states, model.inputs, model.time)


@arguments.checked
def pair(value: complex) -> str:
    """Return a real root, or a root and its conjugate, as text."""
    return f"{value.real:.5g} +- {abs(value.imag):.5g}i" if value.imag else show.number(value)


def rates(values: Complex, time: Time) -> Complex:
    """Return roots (k,) in s: unchanged in continuous time, otherwise log(z) / T, and -inf for z = 0."""
    if isinstance(time, Continuous):
        return values
    safe = np.where(values == 0, 1.0, values)
    return np.where(values == 0, -np.inf, np.log(safe) / time.period_s)


def direction(vector: Complex, names: Sequence[str]) -> dict[str, complex]:
    """Return the dominant components of a vector (n,) by name, largest first, scaled to 1; none for a zero vector."""
    size = np.abs(vector)
    if not size.max(initial=0.0):
        return {}
    order = [i for i in np.argsort(-np.round(size / size.max(), 6), kind="stable") if size[i] > DOMINANT * size.max()]
    components = np.round(vector / vector[order[0]], 6) + 0.0  # + 0.0: no negative zero
    return {names[i]: complex(components[i]) for i in order}


@arguments.checked
def direction_text(direction: Direction) -> str:
    """Return a direction as text, each component before its name, largest first; a single name without it."""
    if len(direction) == 1:
        return next(iter(direction))
    listed = ", ".join(
        f"{show.number(component, 2)} {name}" for name, component in list(direction.items())[:MAX_LISTED]
    )
    return listed if len(direction) <= MAX_LISTED else f"{listed} and {len(direction) - MAX_LISTED} more"


def named_modes(modes: tuple[Complex, Complex], C: Array, rate: float, states: Sequence[str]) -> tuple[Mode, ...]:
    """Return scaled eigenvalues (k,) with vectors (n, k) as modes; the norm of C v, C (p, n), is the measure."""
    return tuple(
        Mode(complex(s * rate), float(np.linalg.norm(C @ v)), direction(v, states))
        for s, v in zip(modes[0], modes[1].T, strict=True)
    )


def _roots(model: StateSpace, values: Complex, x: Complex, u: Complex, y: Complex) -> tuple[Root, ...]:
    roots = []
    for k, (s, rate) in enumerate(zip(values, rates(values, model.time), strict=True)):
        size = float(np.abs(rate))
        damping = float(0.0 - np.real(rate) / size) if 0 < size < np.inf else (1.0 if size else np.nan)
        along = (direction(v[:, k], names) for v, names in ((x, model.states), (u, model.inputs), (y, model.outputs)))
        roots.append(Root(complex(s), damping, size / (2 * np.pi), *along))
    return tuple(sorted(roots, key=lambda r: (r.frequency, r.value.real, r.value.imag)))


def _tables(kind: str, roots: Sequence[Root]) -> tuple[show.Table, ...]:
    """Return a table of roots, a conjugate pair in one row; no table without roots."""
    columns = ("states", "inputs", "outputs")
    shown = [c for c in columns if any(getattr(r, c) for r in roots)]
    rows = [
        (
            pair(r.value),
            "" if np.isnan(r.damping) else f"{r.damping:.4g}",
            f"{r.frequency:.5g}",
            *(direction_text(getattr(r, c)) for c in shown),
        )
        for r in roots
        if r.value.imag >= 0
    ]
    return (show.Table("", (kind, "damping", "frequency [Hz]", *shown), tuple(rows)),) if rows else ()


def _remark(mode: Mode, A: ArrayLike, time: Time) -> str:
    """Return the direction of a mode in several states as text, and a note if rounding hides the mode."""
    along = f"; its direction is {direction_text(mode.direction)} (scaled)" if len(mode.direction) > 1 else ""
    size, fastest = abs(mode.value), float(np.abs(np.linalg.eigvals(np.asarray(A, dtype=float))).max())
    slow = mode.value.real < 0 or 0 < size <= 10 * staircase.COUPLING * fastest
    hidden = slow if isinstance(time, Continuous) else size < 1
    return f"{along}; this is within rounding of the fastest mode, {fastest:.0e}" if hidden else along


def _number(value: complex) -> str:
    return f"{value.real:.4g}" if abs(value.imag) < 1e-9 else f"{value.real:.4g}{value.imag:+.4g}i"
