"""The internal model of an exosystem w' = S w that generates references and disturbances.

    xi' = (I_p (x) Phi) xi + (I_p (x) N) e,     Phi in companion form of the minimal polynomial of S,
                                                N = (0, .., 0, 1)^T

for p regulated outputs: one copy of Phi for each error. By the internal model principle a stable loop with it has
e -> 0 for every reference and disturbance of the exosystem and for every plant for which the loop stays stable. A
single copy for several errors is not sufficient. Constants have the mode 0, ramps a double one, sines +-i w. Modes that
decay need no internal model. Sources: F(14), (15), after Davison (1976) and Francis and Wonham (1976).

Sampled, with e held over each period T, xi+ = exp(Phi T) xi + int_0^T exp(Phi s) ds N e has the modes exp(s T), each
rounded once from the exact value. The error of a plant under zero-order hold is then zero at the samples. Between the
samples a sine leaves a ripple, the response to the steps of u: for a reference of frequency w, the part that the plant
passes at w + 2 pi k / T. A constant leaves no ripple.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import flint
import numpy as np
from numpy.typing import ArrayLike

from synth import arguments, show
from synth.analyse.numerics import precise
from synth.errors import SignalError
from synth.statespace import Array, StateSpace, System, readonly
from synth.statespace import of as model_of
from synth.synthesise.regulation import regulator_equations
from synth.synthesise.regulation.regulator_equations import Mode
from synth.timing import Continuous, Discrete, Time, common

MAX_MULTIPLICITY = 100  # multiplicity of a mode: no signal grows as t^100


@show.result
class InternalModel:
    """One copy, Phi (n, n) and N (n, 1), for an exosystem with `modes` in 1/s, in continuous or discrete `time`."""

    Phi: Array
    N: Array
    modes: tuple[Mode, ...]
    time: Time

    def state_names(self, outputs: Sequence[str]) -> tuple[str, ...]:
        """Return the names of the states: xi1, xi2, .. for one output, else xi1_<output>, .. for each output."""
        ends = [""] if len(outputs) == 1 else [f"_{name}" for name in outputs]
        return tuple(f"xi{k + 1}{end}" for end in ends for k in range(len(self.Phi)))

    def units(self, outputs: Sequence[str], units: Mapping[str, str]) -> dict[str, str]:
        """Return the units of the states, as far as those of the outputs are known.

        The last state is the integral of an output, in its unit times s; each other state is the integral of the next
        one. This also holds in discrete time, where N is about the period in s.
        """
        n, names = len(self.Phi), self.state_names(outputs)
        powers = [f" s^{k}" if k > 1 else " s" for k in range(n, 0, -1)]
        ends = [units.get(name) and units[name] + power for name in outputs for power in powers]
        return {name: end for name, end in zip(names, ends, strict=True) if end}

    def sheet(self) -> show.Sheet:
        """Return the modes."""
        rows = tuple((show.number(m.value), f"{abs(m.value.imag):.5g}", str(m.multiplicity)) for m in self.modes)
        table = show.Table("", ("mode [1/s]", "frequency [rad/s]", "multiplicity"), rows)
        return show.Sheet(f"Internal model of order {len(self.Phi)} for each error, {self.time}", tables=(table,))


Exosystem = InternalModel | Sequence[float] | Mapping[float, int] | Sequence[Sequence[float]] | Array
"""An InternalModel; frequencies in rad/s; {frequency: multiplicity}; or a matrix S (q, q) in 1/s."""


@arguments.checked
def of(exosystem_or_model: Exosystem) -> InternalModel:
    """Return an Exosystem as an InternalModel; frequencies and matrices give a continuous one.

    Raises SignalError as `exosystem` and `from_matrix`.
    """
    if isinstance(exosystem_or_model, InternalModel):
        return exosystem_or_model
    if isinstance(exosystem_or_model, Mapping):
        return exosystem(exosystem_or_model)
    if isinstance(exosystem_or_model, Sequence) and any(
        isinstance(row, Sequence | np.ndarray) for row in exosystem_or_model
    ):
        return from_matrix(arguments.matrix("S", exosystem_or_model))
    if not np.ndim(exosystem_or_model):
        raise SignalError(
            f"{arguments.describe(exosystem_or_model)} is not an exosystem: list frequencies in rad/s, or give a matrix"
        )
    return (
        exosystem(np.asarray(exosystem_or_model).tolist())
        if np.ndim(exosystem_or_model) == 1
        else from_matrix(exosystem_or_model)
    )


@arguments.checked
def exosystem(frequencies: Sequence[float] | Mapping[float, int]) -> InternalModel:
    """Return the continuous model of distinct `frequencies` >= 0 in rad/s; frequency 0 is an integrator.

    {frequency: multiplicity} with multiplicity 2 gives ramps for the frequency 0, else sines with an amplitude
    proportional to t.

    Raises SignalError for no frequency, for a negative, infinite, repeated or non-numeric one, or for a multiplicity
    below 1 or above MAX_MULTIPLICITY.
    """
    if isinstance(frequencies, str) or not isinstance(frequencies, Iterable):
        raise SignalError(f"the exosystem is {frequencies!r}: give frequencies in rad/s as a list")
    w = [float(f) for f in arguments.real("exosystem frequencies", list(frequencies)).ravel()]
    if not w or any(not np.isfinite(f) or f < 0 for f in w) or len(set(w)) < len(w):
        raise SignalError(
            f"exosystem frequencies {w} rad/s: give distinct finite numbers >= 0, at least one; a ramp is {{0: 2}}"
        )
    counts = [*frequencies.values()] if isinstance(frequencies, Mapping) else [1] * len(w)
    for f, count in zip(w, counts, strict=True):
        number = arguments.real(f"multiplicity of {f} rad/s", count)
        if number.ndim or not 1 <= number <= MAX_MULTIPLICITY or number != np.floor(number):
            raise SignalError(
                f"exosystem frequency {f} rad/s has multiplicity {count}: give a whole number of 1 .. "
                f"{MAX_MULTIPLICITY}"
            )
    return _continuous([Mode(complex(0, f), int(count)) for f, count in zip(w, counts, strict=True)])


@arguments.checked
def from_matrix(S: ArrayLike) -> InternalModel:
    """Return the continuous model of an exosystem w' = S w, S (q, q) in 1/s; that of w+ = S_T w has S = log(S_T) / T.

    Raises SignalError as `regulator_equations.roots`, and for a mode that decays.
    """
    modes = regulator_equations.roots(S)
    for mode in modes:
        if mode.value.real < 0:
            raise SignalError(
                f"the exosystem has the mode {show.number(mode.value)} 1/s, which decays and leaves no error in any "
                "stable loop: take it out of S"
            )
    return _continuous(modes)


def _continuous(modes: Sequence[Mode]) -> InternalModel:
    with precise.precision():
        coefficients = [float(c.mid()) for c in regulator_equations.polynomial(modes)]
    n = len(coefficients) - 1
    Phi = np.diag(np.ones(n - 1), 1)
    Phi[-1] = -np.array(coefficients[:-1]) + 0.0
    ordered = sorted(modes, key=lambda m: (abs(m.value), m.value.imag))
    return InternalModel(readonly(Phi), readonly(np.eye(n)[:, -1:]), tuple(ordered), Continuous())


@arguments.checked
def in_time(exosystem: Exosystem, time: Time) -> InternalModel:
    """Return the model in continuous time, or sampled with zero-order hold and the modes exp(s T).

    Raises SignalError as `of` and for a frequency at or above Nyquist; TimingError for a model that is already sampled
    in another time; ModelError as `precise.round_correctly`.
    """
    model = of(exosystem)
    if model.time == time or isinstance(time, Continuous):
        common(time, model.time)
        return model
    common(Continuous(), model.time)
    n, T = len(model.Phi), time.period_s
    _require_below_nyquist([abs(m.value.imag) for m in model.modes], T)

    matrices = precise.round_correctly(lambda: exact(model.modes, time), f"the internal model over {T:g} s")
    return InternalModel(readonly(matrices[:, :n]), readonly(matrices[:, n:]), model.modes, time)


@arguments.checked
def exact(modes: Sequence[Mode], time: Time) -> flint.arb_mat:
    """Return [Phi, N] (n, n + 1) for exact modes in 1/s, in a time and in balls of the precision in force.

    Raises SignalError when there is no mode.
    """
    n = sum(mode.order for mode in modes)
    if not n:
        raise SignalError("the internal model has no modes: give one or more")
    driven = _with_inputs(regulator_equations.polynomial(modes), np.zeros(n))
    if isinstance(time, Discrete):
        driven = (driven * flint.arb(time.period_s)).exp()
    return _columns(driven, n, 0, n + 1)


def _require_below_nyquist(frequencies: Sequence[float], period_s: float) -> None:
    nyquist = np.pi / Discrete(period_s).period_s
    if max(frequencies) >= nyquist:
        raise SignalError(f"exosystem frequency {max(frequencies)} rad/s: it must lie below {nyquist:.6g} rad/s")


@dataclass(frozen=True, eq=False)
class Leapfrog:
    """The sampled internal model in coordinates eta, xi = T eta, with the fewest operations per sample.

        eta_0' = eta_0 + e                                              for the frequency 0
        p' = p + c q,   q' = q - p' + e,   c = 2 - 2 cos(w T)           for each other frequency w

    Each pair has the determinant 1 and the trace 2 - c for every rounded c. Rounding therefore changes w only, and the
    poles stay on the unit circle. `c` (m,) is sorted by frequency, `T` is (n, n); the anti-windup input adds `E` (n, 1)
    to eta_0', p', q' in this order of computation, 0 without anti-windup.
    """

    c: Array
    T: Array
    E: Array


@arguments.checked
def leapfrog(frequencies: Sequence[float], period_s: float, E: ArrayLike | None = None) -> Leapfrog:
    """Return the internal model with e and the anti-windup input E (n,) constant over each period.

    The sampled companion form and the leapfrog form have the same poles and the single input e. T follows from their
    controllability matrices.

    Raises SignalError as `exosystem`, for a frequency at or above Nyquist, and for an E of another size; TimingError
    when the period is not positive.
    """
    modes = exosystem(frequencies).modes
    _require_below_nyquist(frequencies, period_s)
    n = sum(mode.order for mode in modes)
    column = np.zeros(n) if E is None else arguments.real("entries of the anti-windup gain", E).ravel()
    if column.shape != (n,) or not np.isfinite(column).all():
        raise SignalError(
            f"the anti-windup gain has {column.size} entries, the internal model {n} states: give {n} finite numbers"
        )
    w = sorted(float(f) for f in frequencies if f)

    def compute() -> flint.arb_mat:
        held = (_with_inputs(regulator_equations.polynomial(modes), column) * flint.arb(period_s)).exp()
        c = [4 * (flint.arb(f) * flint.arb(period_s) / 2).sin() ** 2 for f in w]
        T = (
            _controllability(_columns(held, n, 0, n), _columns(held, n, n, n + 1))
            * _controllability(*_leapfrog_step(c, n)).inv()
        )
        added = [*T.solve(_columns(held, n, n + 1, n + 2)).entries()]
        for q in range(n - 2 * len(c) + 1, n, 2):
            added[q] += added[q - 1]
        padded = [*c, *[flint.arb(0)] * n]
        return flint.arb_mat([[*(T[i, j] for j in range(n)), added[i], padded[i]] for i in range(n)])

    matrices = precise.round_correctly(compute, f"the internal model over {period_s:g} s")
    return Leapfrog(readonly(matrices[: len(w), n + 1]), readonly(matrices[:, :n]), readonly(matrices[:, n : n + 1]))


@arguments.checked
def augmented(plant: System, exosystem: Exosystem) -> StateSpace:
    """Return a plant with an internal model driven by each of its outputs; all states are outputs.

    The states are the plant's, then `InternalModel.state_names`. A sampled plant gets the sampled internal model.

    Raises as `in_time`; ModelError as `regulator_equations.require_solvable`.
    """
    part = model_of(plant)
    model = in_time(exosystem, part.time)
    regulator_equations.require_solvable(part, model.modes)
    (n, m), p, k = part.B.shape, len(part.outputs), len(model.Phi)
    N = np.kron(np.eye(p), model.N)
    A = np.block([[part.A, np.zeros((n, p * k))], [N @ part.C, np.kron(np.eye(p), model.Phi)]])
    B = np.vstack([part.B, N @ part.D])
    states = part.states + model.state_names(part.outputs)
    units = {**part.units, **model.units(part.outputs, part.units)}
    return StateSpace(A, B, np.eye(n + p * k), np.zeros((n + p * k, m)), states, part.inputs, states, part.time, units)


def _with_inputs(polynomial: flint.arb_poly, E: Array) -> flint.arb_mat:
    """Return [[Phi, N, E], [0, 0, 0]], (n + 2, n + 2), with the exact coefficients of a monic polynomial."""
    n = len(E)
    M = flint.arb_mat(n + 2, n + 2)
    for i in range(n):
        M[n - 1, i] = -polynomial[i]
        M[i, n + 1] = flint.arb(float(E[i]))
    for i in range(n - 1):
        M[i, i + 1] = flint.arb(1)
    M[n - 1, n] = flint.arb(1)
    return M


def _leapfrog_step(c: Sequence[flint.arb], n: int) -> tuple[flint.arb_mat, flint.arb_mat]:
    """Return one sample of the leapfrog form of order n as (A, B)."""
    A, B = precise.identity(n), flint.arb_mat(n, 1)
    first = n - 2 * len(c)
    if first:
        B[0, 0] = flint.arb(1)
    for k, step in enumerate(c):
        p, q = first + 2 * k, first + 2 * k + 1
        A[p, q], A[q, p], A[q, q], B[q, 0] = step, flint.arb(-1), 1 - step, flint.arb(1)
    return A, B


def _controllability(A: flint.arb_mat, B: flint.arb_mat) -> flint.arb_mat:
    """Return (B, A B, .., A^(n-1) B), (n, n)."""
    columns = [B]
    for _ in range(A.nrows() - 1):
        columns.append(A * columns[-1])
    return flint.arb_mat([[c[i, 0] for c in columns] for i in range(A.nrows())])


def _columns(M: flint.arb_mat, rows: int, first: int, last: int) -> flint.arb_mat:
    """Return the columns first .. last - 1 of the upper `rows`."""
    return flint.arb_mat([[M[i, j] for j in range(first, last)] for i in range(rows)])
