"""A sampled servo controller with its internal model in the coordinates eta of `internal_model.Leapfrog`.

    xi = (I (x) T) eta,     sum+ = sum + e,     p+ = p + c q,     q+ = -p + (1 - c) q + e,     c = 2 - 2 cos(w T)

The states xi of the companion form have the error's unit times s, s^2, .., and their sizes differ by powers of the
frequencies. All states eta have the error's unit and similar size, and so have the gains on them. This form suits code
in single precision. Its transfer function is that of the original controller.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from synth import arguments
from synth.analyse.numerics import precise
from synth.errors import SignalError
from synth.statespace import Array, StateSpace, System, of
from synth.synthesise.regulation import internal_model
from synth.synthesise.regulation.servo import Servo
from synth.timing import common, period

SUM = "sum"  # the state of the frequency 0


@arguments.checked
def controller(regulator: Servo, system: System | None = None) -> StateSpace:
    """Return the controller of a sampled regulator in eta, or `system`, which is that controller with anti-windup.

    The states are ``sum`` for the frequency 0 and ``p<k>``, ``q<k>`` by rising frequency, for each output in turn, with
    the suffix ``_<output>`` where several are regulated; the other states of the controller follow unchanged.

    Raises TimingError for a continuous regulator or different times; SignalError for an internal model with a growing
    or multiple mode, a frequency as `internal_model.leapfrog`, or a system without the regulator's xi.
    """
    model, outputs = regulator.model, regulator.regulated
    T, old = period(model.time), regulator.model.state_names(regulator.regulated)
    source = regulator.controller if system is None else of(system)
    common(model.time, source.time)
    if any(mode.multiplicity > 1 or mode.value.real for mode in model.modes):
        raise SignalError(
            "the internal model has a mode that grows or counts more than once: the leapfrog form is for constants and "
            "sines, each once"
        )
    if source.states[: len(old)] != old:
        raise SignalError(
            f"the controller has the states {', '.join(source.states)}: give one that begins with {', '.join(old)}"
        )
    form = internal_model.leapfrog([mode.value.imag for mode in model.modes], T)
    return _transform(source, form, outputs, len(old))


def _transform(source: StateSpace, form: internal_model.Leapfrog, outputs: Sequence[str], k: int) -> StateSpace:
    p, n = len(outputs), len(form.T)
    A, B, C = source.A.copy(), source.B.copy(), source.C.copy()
    phi, drive = _leapfrog_step(form.c, n)
    A[:k, :k] = np.kron(np.eye(p), phi)
    T_balls = precise.matrix(np.kron(np.eye(p), form.T))
    if B.size:
        B[:k] = precise.round_correctly(
            lambda: T_balls.solve(precise.matrix(source.B[:k])), "what drives the internal model"
        )
    errors = [source.inputs.index(f"{y}_error") for y in outputs]
    B[:k, errors] = np.kron(np.eye(p), drive)
    C[:, :k] = precise.round_correctly(
        lambda: precise.matrix(source.C[:, :k]) * T_balls, "the gain on the internal model"
    )
    names = [SUM] * (n % 2) + [f"{letter}{j + 1}" for j in range(n // 2) for letter in "pq"]
    states = tuple(name if p == 1 else f"{name}_{y}" for y in outputs for name in names)
    units = {state: source.unit(f"{outputs[i // n]}_error") for i, state in enumerate(states)}
    units = {**source.units, **{state: unit for state, unit in units.items() if unit}}
    return replace(source, A=A, B=B, C=C, states=(*states, *source.states[k:]), units=units)


def _leapfrog_step(c: Array, n: int) -> tuple[Array, Array]:
    """Return eta+ = phi eta + drive e, (n, n) and (n, 1)."""
    phi, drive = np.eye(n), np.zeros((n, 1))
    drive[: n % 2] = 1.0
    for j, step in enumerate(c):
        q = n % 2 + 2 * j + 1
        phi[q - 1, q], phi[q, q - 1], phi[q, q], drive[q] = step, -1.0, 1 - step, 1.0
    return phi, drive
