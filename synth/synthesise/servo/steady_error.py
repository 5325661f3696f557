"""What a loop leaves of an exosystem's signals: the certificate that e -> 0.

            r (p)                 d (one at each input of the plant)
            |                     |
            v -                   v
     y --->(+)---> e             (+)---->[plant]----> y, and what the controller measures
                   |              ^
                   v              | u
     measured -->[   controller   ]

With T(v) = C (v I - A)^-1 B + D the response from r and d to e, the error of all signals t^j exp(s t), j < k, dies out
in a stable loop when the Taylor coefficients T_0 .. T_{k-1} of T vanish at v = s, or at exp(s T) in discrete time. They
are computed in ball arithmetic, so that what is found is what the numbers of the loop leave.

Each is given relative to the signals that make up the error, the largest |C| |x| + |D| that a source of unit size
causes at the modes and at the frequencies of the loop's poles; T_j counts times the distance of the nearest pole to the
power j, the scale on which T changes.
"""

from collections.abc import Sequence
from dataclasses import replace

import flint
import numpy as np

from synth import arguments, show
from synth.analyse import interconnect, precise
from synth.errors import ModelError, SignalError
from synth.statespace import Array, Complex, StateSpace, System, of, readonly
from synth.synthesise.riccati import spectrum
from synth.synthesise.servo import internal_model
from synth.synthesise.servo.minimal_polynomial import Mode
from synth.timing import Continuous, Time, common

VANISHING = 1e-8  # of the signals that make up the error: modes rounded by 1e-16 beside poles that are 1e-8 away


@show.result
class SteadyError:
    """What is left in each error of a signal from each source, for k modes, p errors and q sources.

    `response` (k, p, q) is |T_0| in the signals' units; `leftover` (k, p, q) is relative and the largest over the
    multiplicity, infinite in a loop that is not stable, `lasting` then being a pole that does not decay.
    """

    modes: tuple[Mode, ...]
    errors: tuple[str, ...]
    sources: tuple[str, ...]
    response: Array
    leftover: Array
    poles: Complex
    lasting: complex | None
    time: Time

    @property
    def worst(self) -> float:
        """The largest relative leftover."""
        return float(self.leftover.max(initial=0.0))

    @property
    def vanishes(self) -> bool:
        """Whether the loop is stable and each error dies out under each signal of the exosystem."""
        return self.lasting is None and self.worst <= VANISHING

    def sheet(self) -> show.Sheet:
        """Return the verdict, and the largest leftover over the errors for each source and mode."""
        verdict = f"Each error dies out: {self.worst:.1e} is left at most."
        if not self.vanishes:
            verdict = f"An error STAYS: {self.worst:.1e} is left."
        if self.lasting is not None:
            verdict = f"The loop is NOT STABLE: its pole {show.number(self.lasting)} does not decay."
        modes = tuple(f"{show.number(m.value)}{f', {m.multiplicity} times' * (m.multiplicity > 1)}" for m in self.modes)
        table = show.matrix("source", self.leftover.max(axis=1, initial=0.0).T, self.sources, modes)
        return show.Sheet("Share of the exosystem's signals that is left, at its modes in 1/s", (verdict,), (table,))


@arguments.checked
def evaluate(system: System, errors: Sequence[str] | str, exosystem: internal_model.Exosystem) -> SteadyError:
    """Return what a closed loop leaves, from all its inputs to the outputs `errors`, of the signals of an exosystem.

    A pole that decays by no more than rounding error counts as lasting (`spectrum.lasting`).

    Raises SignalError for an error that is no output, or as `internal_model.of`; ModelError for a pole at a mode.
    """
    model, ends = of(system), arguments.names("errors", errors)
    loop, modes = model.select(ends, model.inputs), internal_model.of(exosystem).modes
    poles, shape = loop.poles, (len(modes), *loop.D.shape)
    if (lasting := spectrum.lasting(loop.A, loop.time)) is not None:
        endless = readonly(np.full(shape, np.inf))
        return SteadyError(modes, ends, loop.inputs, endless, endless, poles, lasting, loop.time)
    exact = [_taylor(loop, mode) for mode in modes]
    frequencies = [*_frequencies(poles, loop.time), *(_point(m.value, loop.time) for m in modes)]
    size = np.max([_terms(loop, complex(v)) for v in frequencies], axis=0)
    size = np.where(size > 0, size, 1.0)
    leftover = [
        np.max([c * _distance(loop, mode) ** j for j, c in enumerate(T)], axis=0) / size
        for mode, T in zip(modes, exact, strict=True)
    ]
    response = readonly([T[0] for T in exact])
    return SteadyError(modes, ends, loop.inputs, response, readonly(leftover), poles, None, loop.time)


@arguments.checked
def closed(
    plant: StateSpace, measured: StateSpace, regulated: Sequence[str], controls: Sequence[str], controller: StateSpace
) -> StateSpace:
    """Return the loop from references and disturbances to ``<output>_error`` and ``<control>_command``.

    `measured` is the plant with the outputs that the controller sees. The controller has the inputs of their names and
    ``<output>_error``, and may have ``<control>_limited``, which is the command here, and others, which stay 0; its
    outputs are ``<control>_command``. The loop's inputs are ``<output>_reference``, ``<control>_disturbance`` and the
    plant's further inputs.

    Raises TimingError for unlike times, SignalError for a name that is not known or stands twice, ModelError for an
    algebraic loop without a solution.
    """
    common(plant.time, controller.time)
    if measured.states != plant.states or not len(controls):
        raise SignalError(
            f"the plant has the states {', '.join(plant.states)}, as measured {', '.join(measured.states)}, and "
            f"{len(controls)} controls: give one plant, and one control or more"
        )
    errors, commands, references = named(regulated, "error"), named(controls, "command"), named(regulated, "reference")
    aimed, seen = plant.select(regulated, plant.inputs), measured.select(measured.outputs, plant.inputs)
    ends = named(regulated, "regulated")
    both = replace(seen, C=np.vstack([seen.C, aimed.C]), D=np.vstack([seen.D, aimed.D]), outputs=(*seen.outputs, *ends))
    p = len(ends)
    nothing = (np.zeros((0, 0)), np.zeros((0, 2 * p)), np.zeros((p, 0)))
    compared = StateSpace(*nothing, np.hstack([np.eye(p), -np.eye(p)]), (), (*ends, *references), errors, plant.time)
    told = {f"{u}_limited": {f"{u}_command": 1.0} for u in controls}
    wires: dict[str, dict[str, float]] = {
        name: told.get(name, {}) for name in controller.inputs if name not in (*seen.outputs, *errors)
    }
    wires |= {u: {f"{u}_command": 1.0, f"{u}_disturbance": 1.0} for u in controls}
    sources = (*references, *(f"{d}_disturbance" if d in controls else d for d in plant.inputs))
    return interconnect.connect((both, controller, compared), sources, (*errors, *commands), wires)


@arguments.checked
def named(signals: Sequence[str], end: str) -> tuple[str, ...]:
    """Return the names with an ending."""
    return tuple(f"{name}_{end}" for name in signals)


def _taylor(loop: StateSpace, mode: Mode) -> list[Array]:
    """Return the sizes (p, q) of the coefficients of T at a mode, as many as its multiplicity."""
    found = []
    with precise.precision():
        A, X, C, D = (flint.acb_mat(spectrum.ball(M)) for M in (loop.A, loop.B, loop.C, loop.D))
        pencil = flint.acb_mat(spectrum.ball(np.eye(len(loop.A)))) * _point(mode.value, loop.time) - A
        for _ in range(mode.multiplicity):
            try:
                X = pencil.solve(X)
            except ZeroDivisionError as error:
                raise ModelError(
                    f"the loop has a pole at the mode {show.number(mode.value)} 1/s of the exosystem: make it stable"
                ) from error
            T = C * X + D
            sizes = [float(abs(T[i, j]).mid()) for i in range(T.nrows()) for j in range(T.ncols())]
            found.append(readonly(np.reshape(sizes, loop.D.shape)))
            X, D = X * flint.acb(-1), D * flint.acb(0)
    return found


def _terms(loop: StateSpace, point: complex) -> Array:
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
