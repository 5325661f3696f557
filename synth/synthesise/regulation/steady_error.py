"""The steady-state error of a loop under an exosystem's signals: the certificate that e -> 0.

            r (p)                 d (one at each input of the plant)
            |                     |
            v -                   v
     y --->(+)---> e             (+)---->[plant]----> y, and the measured signals
                   |              ^
                   v              | u
     measured -->[   controller   ]

With T(v) = C (v I - A)^-1 B + D the response from r and d to e, the error of all signals t^j exp(s t), j < k, tends to
zero in a stable loop when the Taylor coefficients T_0 .. T_{k-1} of T are zero at v = s, or at exp(s T) in discrete
time. They are computed in ball arithmetic and contain no rounding error beyond that of the loop's matrices.

Each is relative to the signals that make up the error: the largest |C| |x| + |D| that a source of unit size causes at
the modes and at the frequencies of the loop's poles. T_j is multiplied by the j-th power of the distance to the nearest
pole, the scale on which T changes.
"""

from collections.abc import Sequence
from dataclasses import replace

import flint
import numpy as np

from synth import arguments, show
from synth.analyse.loops import interconnect
from synth.analyse.numerics import precise
from synth.errors import ModelError, SignalError
from synth.statespace import Array, Complex, StateSpace, System, of, readonly
from synth.synthesise.regulation import internal_model
from synth.synthesise.regulation.regulator_equations import Mode
from synth.synthesise.riccati import exact
from synth.timing import Continuous, Time, common

ERROR_ROUNDING = 1e-8  # of the signals that make up the error: modes rounded by 1e-16 at a distance of 1e-8 from poles


@show.result
class SteadyError:
    """The steady-state error for k modes, in p errors from q sources.

    `response` (k, p, q) is |T_0| in the signals' units; `relative_error` (k, p, q) is the largest relative one over the
    multiplicity. In a loop that is not stable it is infinite, and `unstable_pole` is a pole that does not decay.
    """

    modes: tuple[Mode, ...]
    errors: tuple[str, ...]
    sources: tuple[str, ...]
    response: Array
    relative_error: Array
    poles: Complex
    unstable_pole: complex | None
    time: Time

    @property
    def worst(self) -> float:
        """The largest relative error."""
        return float(self.relative_error.max(initial=0.0))

    @property
    def vanishes(self) -> bool:
        """Whether the loop is stable and each error tends to zero under each signal of the exosystem."""
        return self.unstable_pole is None and self.worst <= ERROR_ROUNDING

    def sheet(self) -> show.Sheet:
        """Return the verdict, and the largest relative error over the outputs for each source and mode."""
        verdict = f"Each error dies out: {self.worst:.1e} is left at most."
        if not self.vanishes:
            verdict = f"An error STAYS: {self.worst:.1e} is left."
        if self.unstable_pole is not None:
            verdict = f"The loop is NOT STABLE: its pole {show.number(self.unstable_pole)} does not decay."
        modes = tuple(f"{show.number(m.value)}{f', {m.multiplicity} times' * (m.multiplicity > 1)}" for m in self.modes)
        table = show.matrix("source", self.relative_error.max(axis=1, initial=0.0).T, self.sources, modes)
        return show.Sheet("Share of the exosystem's signals that is left, at its modes in 1/s", (verdict,), (table,))


@arguments.checked
def evaluate(system: System, errors: Sequence[str] | str, exosystem: internal_model.Exosystem) -> SteadyError:
    """Return the steady-state errors of a closed loop, from all its inputs to the outputs `errors`, for an exosystem.

    A pole that decays by no more than rounding error counts as unstable (`exact.unstable_pole`).

    Raises SignalError for an error that is no output, or as `internal_model.of`; ModelError for a pole at a mode.
    """
    model, names = of(system), arguments.as_name_list("errors", errors)
    loop, modes = model.select(names, model.inputs), internal_model.of(exosystem).modes
    poles, shape = loop.poles, (len(modes), *loop.D.shape)
    if (pole := exact.unstable_pole(loop.A, loop.time)) is not None:
        infinite = readonly(np.full(shape, np.inf))
        return SteadyError(modes, names, loop.inputs, infinite, infinite, poles, pole, loop.time)
    series = [_taylor(loop, mode) for mode in modes]
    frequencies = [*_frequencies(poles, loop.time), *(_point(m.value, loop.time) for m in modes)]
    size = np.max([_signal_size(loop, complex(v)) for v in frequencies], axis=0)
    size = np.where(size > 0, size, 1.0)
    relative_error = [
        np.max([c * _distance(loop, mode) ** j for j, c in enumerate(T)], axis=0) / size
        for mode, T in zip(modes, series, strict=True)
    ]
    response = readonly([T[0] for T in series])
    return SteadyError(modes, names, loop.inputs, response, readonly(relative_error), poles, None, loop.time)


@arguments.checked
def closed_loop(
    plant: StateSpace, measured: StateSpace, regulated: Sequence[str], controls: Sequence[str], controller: StateSpace
) -> StateSpace:
    """Return the loop from references and disturbances to ``<output>_error`` and ``<control>_command``.

    `measured` is the plant with the controller's measured outputs. The inputs of the controller are these outputs,
    ``<output>_error``, optionally ``<control>_limited``, which equals the command here, and others, which stay 0; its
    outputs are ``<control>_command``. The loop's inputs are ``<output>_reference``, ``<control>_disturbance`` and the
    other inputs of the plant.

    Raises TimingError for different times, SignalError for an unknown or duplicate name, ModelError for an algebraic
    loop without a solution.
    """
    common(plant.time, controller.time)
    if measured.states != plant.states or not len(controls):
        raise SignalError(
            f"the plant has the states {', '.join(plant.states)}, as measured {', '.join(measured.states)}, and "
            f"{len(controls)} controls: give one plant, and one control or more"
        )
    errors, commands, references = (
        with_suffix(regulated, "error"),
        with_suffix(controls, "command"),
        with_suffix(regulated, "reference"),
    )
    regulated_part, measured_part = (
        plant.select(regulated, plant.inputs),
        measured.select(measured.outputs, plant.inputs),
    )
    ends = with_suffix(regulated, "regulated")
    both = replace(
        measured_part,
        C=np.vstack([measured_part.C, regulated_part.C]),
        D=np.vstack([measured_part.D, regulated_part.D]),
        outputs=(*measured_part.outputs, *ends),
    )
    p = len(ends)
    nothing = (np.zeros((0, 0)), np.zeros((0, 2 * p)), np.zeros((p, 0)))
    compared = StateSpace(*nothing, np.hstack([np.eye(p), -np.eye(p)]), (), (*ends, *references), errors, plant.time)
    limited = {f"{u}_limited": {f"{u}_command": 1.0} for u in controls}
    wires: dict[str, dict[str, float]] = {
        name: limited.get(name, {}) for name in controller.inputs if name not in (*measured_part.outputs, *errors)
    }
    wires |= {u: {f"{u}_command": 1.0, f"{u}_disturbance": 1.0} for u in controls}
    sources = (*references, *(f"{d}_disturbance" if d in controls else d for d in plant.inputs))
    return interconnect.connect((both, controller, compared), sources, (*errors, *commands), wires)


@arguments.checked
def with_suffix(signals: Sequence[str], end: str) -> tuple[str, ...]:
    """Return the names with a suffix."""
    return tuple(f"{name}_{end}" for name in signals)


def _taylor(loop: StateSpace, mode: Mode) -> list[Array]:
    """Return |T_j| (p, q) at a mode for j below its multiplicity."""
    coefficients = []
    with precise.precision():
        A, X, C, D = (flint.acb_mat(exact.ball(M)) for M in (loop.A, loop.B, loop.C, loop.D))
        pencil = flint.acb_mat(exact.ball(np.eye(len(loop.A)))) * _point(mode.value, loop.time) - A
        for _ in range(mode.multiplicity):
            try:
                X = pencil.solve(X)
            except ZeroDivisionError as error:
                raise ModelError(
                    f"the loop has a pole at the mode {show.number(mode.value)} 1/s of the exosystem: make it stable"
                ) from error
            T = C * X + D
            sizes = [float(abs(T[i, j]).mid()) for i in range(T.nrows()) for j in range(T.ncols())]
            coefficients.append(readonly(np.reshape(sizes, loop.D.shape)))
            X, D = X * flint.acb(-1), D * flint.acb(0)
    return coefficients


def _signal_size(loop: StateSpace, point: complex) -> Array:
    X = np.linalg.solve(point * np.eye(len(loop.A)) - loop.A, loop.B.astype(np.complex128))
    return np.asarray(np.abs(loop.C) @ np.abs(X) + np.abs(loop.D), dtype=np.float64)


def _distance(loop: StateSpace, mode: Mode) -> float:
    return float(np.abs(loop.poles - complex(_point(mode.value, loop.time))).min(initial=np.inf))


def _frequencies(poles: Complex, time: Time) -> Complex:
    if isinstance(time, Continuous):
        return 1j * np.abs(poles)
    with np.errstate(divide="ignore"):
        return np.exp(1j * np.minimum(np.abs(np.log(poles.astype(np.complex128))), np.pi))


def _point(s: complex, time: Time) -> flint.acb:
    ball = flint.acb(s.real, s.imag)
    return ball if isinstance(time, Continuous) else (ball * flint.arb(time.period_s)).exp()
