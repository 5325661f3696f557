"""Modal controllability and observability: Popov-Belevitch-Hautus (PBH) measures of each mode of a linear model.

The measure of an eigenvalue s is the least singular value of [A - s I, B], or of [A - s I; C], in scaled units
(`staircase.scaled`) with columns of B and rows of C of length 1. It is 0 for an uncontrollable or unobservable mode,
and at most the root of the number of inputs or outputs. The measure of one input alone is also 0 if two modes have the
same eigenvalue.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from scipy.linalg import lapack

from synth import arguments, show
from synth.analyse import staircase, structure
from synth.statespace import Array, Complex, System, of
from synth.timing import Time

CHUNK = 16  # modes in one batch
MAX_SVD_STATES = 60  # states up to which a singular value decomposition is quicker than inverse iteration
BLOCK, STEPS = 4, 60  # of inverse iteration: vectors, and most steps
CONVERGENCE_TOLERANCE = 1e-4  # relative change at the end of inverse iteration
MAX_SQUARABLE = 1e150  # its square is still a double
WEAK_MEASURE = 1e-3  # a mode with a smaller measure counts as weakly controllable or observable

Measures = tuple[float, dict[str, float]]


@dataclass(frozen=True)
class Coupling:
    """A mode with its measures, for all signals and for each: `controllability` and `observability`."""

    value: complex
    states: structure.Direction
    controllability: float
    observability: float
    by_input: Mapping[str, float]
    by_output: Mapping[str, float]


@show.result
class Couplings:
    """The PBH measures of each mode, the slowest first."""

    modes: tuple[Coupling, ...]
    time: Time

    @property
    def weakly_controllable(self) -> tuple[Coupling, ...]:
        """The modes with a controllability measure below WEAK_MEASURE."""
        return tuple(m for m in self.modes if m.controllability < WEAK_MEASURE)

    @property
    def weakly_observable(self) -> tuple[Coupling, ...]:
        """The modes with an observability measure below WEAK_MEASURE."""
        return tuple(m for m in self.modes if m.observability < WEAK_MEASURE)

    def sheet(self) -> show.Sheet:
        """Return one row for each mode or pair, and a line for each weakly coupled one."""
        lines = [
            f"Weakly {how}: mode {structure.pair(m.value)} in {structure.direction_text(m.states)}."
            for how, modes in (("controllable", self.weakly_controllable), ("observable", self.weakly_observable))
            for m in modes
            if m.value.imag >= 0
        ]
        rows = tuple(
            (
                structure.pair(m.value),
                f"{m.controllability:.2g}",
                f"{m.observability:.2g}",
                max(m.by_input, key=m.by_input.__getitem__, default=""),
                max(m.by_output, key=m.by_output.__getitem__, default=""),
                structure.direction_text(m.states),
            )
            for m in self.modes
            if m.value.imag >= 0
        )
        columns = ("mode", "controllability", "observability", "best input", "best output", "states")
        title = f"Modal controllability and observability in {self.time}"
        return show.Sheet(title, tuple(lines), (show.Table(columns, rows),))


@arguments.checked
def modal_measures(system: System) -> Couplings:
    """Return the PBH measures of each mode of a System; raise SignalError as `statespace.of`."""
    model = of(system)
    scaled = staircase.of_model(model)
    roots = structure.poles(model).roots
    values = np.unique([complex(r.value.real, abs(r.value.imag)) / scaled.rate for r in roots])  # one of each pair
    controllability = _measures(scaled.A, scaled.B, model.inputs, values)
    observability = _measures(scaled.A.T, scaled.C.T, model.outputs, values)
    modes = []
    for root in roots:
        s = complex(root.value.real, abs(root.value.imag)) / scaled.rate
        (by_all, by_input), (to_all, by_output) = controllability[s], observability[s]
        modes.append(Coupling(root.value, root.states, by_all, to_all, by_input, by_output))
    return Couplings(tuple(modes), model.time)


def _measures(A: Array, B: Array, names: Sequence[str], values: Complex) -> dict[complex, Measures]:
    """Return for each s the least singular value of [A - s I, B] with unit columns of B, for all and for each.

    One Schur form A' = V T V^H serves all: the singular values are those of [T - s* I; B' V].
    """
    if not len(values):
        return {}
    size = np.linalg.norm(B, axis=0)
    T, V = scipy.linalg.schur(A.T.astype(np.complex128), output="complex")
    rows = (B / np.where(size > 0, size, 1.0)).T @ V
    measures = {}
    for batch in np.array_split(values, -(-len(values) // CHUNK)):
        shifted = T - batch.conj()[:, None, None] * np.eye(len(T))
        with_all, by_signal = shifted, np.zeros((len(names), len(batch)))
        for j in np.flatnonzero(size):
            with_one = _append_row(shifted, rows[j])
            by_signal[j] = [_least_singular_value(R) for R in with_one]
            with_all = with_one if with_all is shifted else _append_row(with_all, rows[j])
        of_all = by_signal.sum(axis=0) if np.count_nonzero(size) < 2 else [_least_singular_value(R) for R in with_all]
        for s, measure, by_each in zip(batch, of_all, by_signal.T, strict=True):
            measures[complex(s)] = (float(measure), {name: float(v) for name, v in zip(names, by_each, strict=True)})
    return measures


def _append_row(T: Complex, row: Complex) -> Complex:
    """Return the triangular factors (k, n, n) of matrices T (k, n, n), upper triangular, with one `row` (n,) below."""
    R, r = T.copy(), np.tile(row, (len(T), 1))
    for j in range(len(row)):
        a, b = R[:, j, j].copy(), r[:, j].copy()
        size = np.hypot(np.abs(a), np.abs(b))
        a, b, size = (v[:, None] for v in (np.where(size > 0, a, 1.0), b, np.where(size > 0, size, 1.0)))
        above, below = R[:, j, j:], r[:, j:]
        R[:, j, j:], r[:, j:] = (a.conj() * above + b.conj() * below) / size, (a * below - b * above) / size
    return R


def _least_singular_value(R: Complex) -> float:
    if len(R) > MAX_SVD_STATES and np.isfinite(sigma := _inverse_iteration(R)):
        return sigma
    return float(np.linalg.svd(R, compute_uv=False)[-1])


def _inverse_iteration(R: Complex) -> float:
    """Return the least singular value by inverse iteration on a block of vectors; NaN where the inverse overflows."""
    diagonal = np.diag(R)
    tiny = np.finfo(float).eps ** 2 * np.abs(R).max()
    R = np.asfortranarray(R + np.diag(np.where(np.abs(diagonal) < tiny, tiny, 0.0)))
    X, sigma = np.random.default_rng(0).normal(size=(len(R), BLOCK)).astype(np.complex128), np.inf
    for _ in range(STEPS):
        Y = lapack.ztrtrs(R, X, trans=2)[0]
        if not np.abs(Y).max() < MAX_SQUARABLE:
            return np.nan
        Z = lapack.ztrtrs(R, np.linalg.qr(Y)[0])[0]
        if not np.abs(Z).max() < MAX_SQUARABLE:
            return np.nan
        last, sigma = sigma, 1.0 / float(np.linalg.norm(Z, 2))
        if last - sigma <= CONVERGENCE_TOLERANCE * sigma:
            return sigma
        X = np.linalg.qr(Z)[0]
    return np.nan
