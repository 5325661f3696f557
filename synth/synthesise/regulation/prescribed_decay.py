"""Servo regulators with a prescribed degree of stability for each mode of the internal model (Anderson, Moore).

The plant has an optimal gain u = K x for a weight R on u. The internal model is added mode by mode, each with a decay
rate a in place of weights on xi. With y the states of the loop so far, y' = A y + B v, e = C y + D v, and
eta' = (I (x) J) eta + (I (x) N) e the copies of the next mode +-i w in real Jordan form,

    zeta = eta - M y,   M A - (I (x) J) M = (I (x) N) C:          zeta' = (I (x) J) zeta + b v,   b = (I (x) N) D - M B
    v = -S^-1 b' Y^-1 zeta,   F Y + Y F' = b S^-1 b',             F = I (x) J + (a / 2) I,   S = R

The mode then has the poles -a +-i w, each with its multiplicity, and all other poles of the loop stay. v is optimal for
the previous cost plus a zeta' Y^-1 zeta, with y already in the loop. The final loop minimises the integral of
x'Qx + u'Ru + 2 x'Nu and of one such term for each mode (Anderson, Moore, Optimal Control, 1990, section 3.5; Solheim,
Int. J. Control 15, 1972), and it has the margins of an optimal regulator. In discrete time the poles are
exp((-a +-i w) T) and

    v = -(S + b' P b)^-1 b' P (I (x) J) zeta,   F Y F' - Y = b S^-1 b' exp(a T),   P = exp(a T) Y^-1,
    F = I (x) J exp(a T / 2),   S = R + B'XB, to which each mode adds its b' P b

Everything is computed in ball arithmetic and rounded once: equal K and X give the same result on every machine.

Library: no design uses it yet; docs/library.md has an example.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import flint
import numpy as np

from synth import arguments
from synth.analyse import precise
from synth.errors import ModelError, SignalError
from synth.statespace import StateSpace, System
from synth.synthesise.feedback.lqr import Gain
from synth.synthesise.regulation import internal_model, minimal_polynomial, regulator_equations, servo
from synth.synthesise.regulation.internal_model import InternalModel
from synth.synthesise.regulation.minimal_polynomial import Mode
from synth.synthesise.riccati import kronecker
from synth.timing import Continuous, common

Mat = flint.arb_mat


@arguments.checked
def design(
    system: System,
    gain: Gain,
    decay_per_s: Mapping[float, float],
    *,
    multiplicity: Mapping[float, int] | None = None,
    regulated: servo.Names = None,
) -> servo.Servo:
    """Return the regulator that adds an internal model to the optimal gain of a plant, in the gain's time.

    `decay_per_s` is {frequency in rad/s: decay rate in 1/s}, frequency 0 for constants; `multiplicity` is
    {frequency: count}, e.g. {0.0: 2} for ramps. The poles of the loop are those of the plant with the gain and, for
    each of p regulated outputs and each multiplicity, -rate +-i frequency, or exp(. T) when sampled. The gain's inputs
    are the controls. A plant with delayed inputs has them among its states, as in `loop.sampled`, which the gain of
    `lqr.lqrd` with a delay requires.

    Raises SignalError for a rate that is not positive, a gain for other states or inputs than the plant's, or as
    `internal_model.exosystem`; TimingError for another time; ModelError as `internal_model.augmented` and
    `servo.of_gain`.
    """
    if not isinstance(gain, Gain):
        raise SignalError(f"the gain is a {type(gain).__name__}: give that of lqr.lqr, dlqr or lqrd")
    rates = {w: _rate(w, rate) for w, rate in _by_frequency("decay rates", decay_per_s).items()}
    counts = _by_frequency("multiplicities", {} if multiplicity is None else multiplicity)
    if unknown := [w for w in counts if w not in rates]:
        raise SignalError(f"the frequency {unknown[0]} rad/s has a multiplicity, but no decay rate: give it one")
    exosystem = {w: counts.get(w, 1) for w in rates}
    plant, acting, model = servo.split_plant(system, exosystem, regulated, gain.inputs)
    common(plant.time, gain.time)
    if gain.states != plant.states:
        raise SignalError(
            f"the gain is from {', '.join(gain.states)}, the plant has the states {', '.join(plant.states)}: give the "
            "gain of this plant"
        )
    regulator_equations.require_solvable(acting, model.modes)
    try:
        K = precise.round_correctly(lambda: _gain(acting, model, gain, rates), "the gain on the internal model")
    except ZeroDivisionError as error:
        raise ModelError(
            "a mode of the internal model is a pole of the plant with the gain, or is uncontrollable: give "
            "a gain that stabilises the plant"
        ) from error
    return servo.of_gain(plant, model, K, regulated=acting.outputs, controls=acting.inputs)


def _by_frequency(what: str, entries: object) -> dict[float, Any]:
    if not isinstance(entries, Mapping):
        raise SignalError(f"the {what} are {entries!r}: give a number for each frequency, {{rad/s: number}}")
    return dict(
        zip(arguments.real("exosystem frequencies", list(entries)).ravel().tolist(), entries.values(), strict=True)
    )


def _rate(frequency: float, rate: float) -> float:
    value = arguments.real(f"decay rate of {frequency} rad/s", rate)
    if value.ndim or not (np.isfinite(value) and value > 0):
        raise SignalError(f"the mode of {frequency} rad/s decays at {rate} 1/s: give a finite rate above 0")
    return float(value)


@dataclass(frozen=True, eq=False)
class _Loop:
    """y' = A y + B v, e = C y + D v with u = K y + v, and the weight S on v."""

    A: Mat
    B: Mat
    C: Mat
    D: Mat
    K: Mat
    S: Mat


def _gain(acting: StateSpace, model: InternalModel, gain: Gain, rates: Mapping[float, float]) -> Mat:
    """Return (K_x, K_xi), (m, n + p k), in balls."""
    A, B, C, D, K = (precise.matrix(v) for v in (acting.A, acting.B, acting.C, acting.D, gain.K))
    S, n, p = precise.matrix(gain.R), len(acting.A), len(acting.outputs)
    if not isinstance(acting.time, Continuous):
        S = S + B.transpose() * precise.matrix(gain.certificate.X) * B
    loop = _Loop(A + B * K, B, C + D * K, D, K, S)
    T = minimal_polynomial.modal_matrix(model.modes)
    for mode, J, N in _blocks(model, T):
        loop = _add_mode(loop, J, N, rates[mode.value.imag], acting, p)
    # K acts on (x, p copies of the first mode's eta, p copies of the second's, ..); xi is ordered by copies first.
    order = [(a, i) for a in range(p) for i in range(T.nrows())]
    places: dict[tuple[int, int], int] = {}
    first = n
    for mode, start in zip(model.modes, _first_rows(model.modes), strict=True):
        places |= {(a, start + r): first + a * mode.order + r for a in range(p) for r in range(mode.order)}
        first += p * mode.order
    m = loop.K.nrows()
    modal = Mat([[loop.K[i, places[place]] for place in order] for i in range(m)])
    K_xi = modal * kronecker.block(T.inv(), p)
    return _hstack(_columns(loop.K, 0, n), K_xi)


def _first_rows(modes: tuple[Mode, ...]) -> list[int]:
    return [0, *np.cumsum([mode.order for mode in modes]).tolist()][:-1]


def _blocks(model: InternalModel, T: Mat) -> Iterator[tuple[Mode, Mat, Mat]]:
    """Yield each mode with its block J (order, order) of the real Jordan form and its N (order, 1), in balls."""
    k = T.nrows()
    form = internal_model.exact(model.modes, model.time)
    inverse = T.inv()
    J, N = inverse * _columns(form, 0, k) * T, inverse * _columns(form, k, k + 1)
    for mode, start in zip(model.modes, _first_rows(model.modes), strict=True):
        inside = range(start, start + mode.order)
        yield mode, Mat([[J[i, j] for j in inside] for i in inside]), Mat([[N[i, 0]] for i in inside])


def _add_mode(loop: _Loop, J: Mat, N: Mat, rate: float, acting: StateSpace, p: int) -> _Loop:
    """Return the loop with the copies of one mode added."""
    N = kronecker.block(N, p)
    M = kronecker.sylvester(loop.A, J, N * loop.C)
    b = N * loop.D - M * loop.B
    k, S = _feedback(J, b, loop.S, rate, acting, p)
    gain = _hstack(-(k * M), k)
    q, n, m = N.nrows(), loop.A.nrows(), loop.B.ncols()
    A = _vstack(_hstack(loop.A, Mat(n, q)), _hstack(N * loop.C, kronecker.block(J, p)))
    B, C = _vstack(loop.B, N * loop.D), _hstack(loop.C, Mat(loop.C.nrows(), q))
    return _Loop(A + B * gain, B, C + loop.D * gain, loop.D, _hstack(loop.K, Mat(m, q)) + gain, S)


def _feedback(J: Mat, b: Mat, S: Mat, rate: float, acting: StateSpace, p: int) -> tuple[Mat, Mat]:
    """Return k (m, q) of v = k zeta, and the weight S on the input of the next mode."""
    a, driven = flint.arb(rate), b * S.solve(b.transpose())
    if isinstance(acting.time, Continuous):
        F = J + precise.identity(J.nrows()) * (a / 2)
        return -(S.solve(b.transpose()) * kronecker.lyapunov(F, driven).inv()), S
    grown = (a * flint.arb(acting.time.period_s)).exp()
    P = kronecker.stein(J * grown.sqrt(), driven * grown).inv() * grown
    S = S + b.transpose() * P * b
    return -(S.solve(b.transpose() * P * kronecker.block(J, p))), S


def _columns(M: Mat, first: int, last: int) -> Mat:
    return Mat([[M[i, j] for j in range(first, last)] for i in range(M.nrows())])


def _hstack(M: Mat, N: Mat) -> Mat:
    return Mat([[*(M[i, j] for j in range(M.ncols())), *(N[i, j] for j in range(N.ncols()))] for i in range(M.nrows())])


def _vstack(M: Mat, N: Mat) -> Mat:
    return _hstack(M.transpose(), N.transpose()).transpose()
