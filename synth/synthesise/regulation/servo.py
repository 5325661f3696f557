"""Servo regulators by the internal model principle: state feedback, with or without an observer.

     r (p)
     |
     v -    e      +--------------------------------------+  xi
    (+)----------->| xi' = (I (x) Phi) xi + (I (x) N) e   |------>[K_xi]--+
     ^ +           +--------------------------------------+               |
     |                                                                    v   u (m)
     |                   x, or the estimate x^ of an observer ---->[K_x]-(+)----->[plant]---> y
     +--------------------------------- y ------------------------------------------------+

e = y - r is the error of the regulated outputs, u = K_x x + K_xi xi with the signs inside the gains, K = (K_x, K_xi).
Only the plant needs an observer, as xi is known. The augmented plant is stabilisable if (A, B) is stabilisable, there
are at least as many controls as regulated outputs, and no transmission zero is at a mode of the exosystem. Any K that
stabilises it has e -> 0 for every reference and disturbance of the exosystem, also with a perturbed plant as long as
the loop stays stable (Davison 1976, Francis and Wonham 1976). `lqr` and `lqrd` compute gains. They also serve a
regulator that feeds back e and its derivatives in place of x, as `regulator.block` does for one axis.

A sampled servo controller with its internal model in the coordinates eta of `internal_model.Leapfrog`.

    xi = (I (x) T) eta,     sum+ = sum + e,     p+ = p + c q,     q+ = -p + (1 - c) q + e,     c = 2 - 2 cos(w T)

The states xi of the companion form have the error's unit times s, s^2, .., and their sizes differ by powers of the
frequencies. All states eta have the error's unit and similar size, and so have the gains on them. This form suits code
in single precision. Its transfer function is that of the original controller.

Optimal servo regulators (cf. MATLAB `lqi`): the K of `servo` that minimises int (x'Qx + u'Ru) dt over x and xi.

In discrete time `lqr` minimises the sum. `lqrd` holds the plant's input and the error that drives xi over each period T
and minimises the same integral as in continuous time,

    int_0^T = [x; xi; u; e]' W [x; xi; u; e],   W = int_0^T M(t)' diag(Q, R, 0) M(t) dt,   e = C x + D u at the sample,

with M(t) the exponential of [[A, 0, B, 0], [0, I (x) Phi, 0, I (x) N], [0, 0, 0, 0]] t. The loop of least cost is then
exactly the sampled loop that is implemented.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike

from synth import arguments, show
from synth.analyse import discretise
from synth.analyse.numerics import precise
from synth.errors import ModelError, SignalError
from synth.statespace import Array, Complex, StateSpace, System, of, readonly
from synth.synthesise.feedback import lqr as linear_quadratic
from synth.synthesise.regulation import internal_model, steady_error
from synth.synthesise.regulation.internal_model import Exosystem, InternalModel
from synth.synthesise.regulation.steady_error import SteadyError, with_suffix
from synth.synthesise.riccati import weights
from synth.timing import Continuous, common, period

Names = Sequence[str] | str | None
"""Names of signals; None for all."""


@show.result
class Servo:
    """u = K_x x + K_xi xi for a plant, with its certificate; n states, m controls, p regulated outputs, order k.

    `K` is (m, n + p k), on the plant's states and `InternalModel.state_names`. The inputs of `controller` are the
    measured signals (the states, or with an observer some outputs), ``<output>_error`` and, with an observer, the
    actual values ``<control>_limited``. Its outputs are ``<control>_command``. `steady` certifies e -> 0.
    """

    plant: StateSpace
    model: InternalModel
    regulated: tuple[str, ...]
    controls: tuple[str, ...]
    K: Array
    measured: tuple[str, ...]
    estimator: StateSpace | None

    @property
    def K_x(self) -> Array:
        """The gain (m, n) on the plant's states."""
        return readonly(self.K[:, : len(self.plant.A)])

    @property
    def K_xi(self) -> Array:
        """The gain (m, p k) on the internal model's states."""
        return readonly(self.K[:, len(self.plant.A) :])

    @property
    def states(self) -> tuple[str, ...]:
        """The states that K acts on."""
        return (*self.plant.states, *self.model.state_names(self.regulated))

    @property
    def poles(self) -> Complex:
        """The closed loop's poles, in 1/s or in z."""
        return self.steady.poles

    @cached_property
    def controller(self) -> StateSpace:
        """The controller from the errors and the estimator's inputs to the commands."""
        return _controller(self, self.estimator or _state_measurement(self.plant))

    @cached_property
    def steady(self) -> SteadyError:
        """The steady-state error under the exosystem's signals."""
        return self.steady_error_with(self.plant)

    def closed_loop(self, plant: System | None = None) -> StateSpace:
        """Return the loop, as `steady_error.closed_loop`, with the plant or with another one that has its signals.

        Raises SignalError for a plant without them, TimingError for one in another time.
        """
        other = self.plant if plant is None else of(plant)
        if self.estimator:
            seen = other.select(self.measured, other.inputs)
        elif missing := [name for name in self.measured if name not in other.states]:
            raise SignalError(f"the plant has no state '{missing[0]}', which the regulator feeds back")
        else:
            C = np.eye(len(other.A))[[other.states.index(name) for name in self.measured]]
            seen = replace(other, C=C, D=np.zeros((len(C), len(other.inputs))), outputs=self.measured)
        return steady_error.closed_loop(other, seen, self.regulated, self.controls, self.controller)

    def steady_error_with(self, plant: System) -> SteadyError:
        """Return the steady-state error when the same regulator controls another plant.

        Raises as `closed_loop`.
        """
        loop = self.closed_loop(plant)
        return steady_error.evaluate(loop, with_suffix(self.regulated, "error"), self.model)

    def sheet(self) -> show.Sheet:
        """Return the gains, the poles and the steady-state errors."""
        units = {**self.plant.units, **self.model.units(self.regulated, self.plant.units)}
        columns = tuple(show.with_unit(name, units.get(name, "")) for name in self.states)
        gains = show.feedback(show.matrix("gain", self.K.T, columns, self.plant.labels(self.controls)))
        certificate = self.steady.sheet()
        lines = (f"Poles {', '.join(show.number(s) for s in self.poles)}", *certificate.lines)
        what = f"{', '.join(self.regulated)} by {', '.join(self.controls)}"
        title = f"Servo regulator of {what} in {self.plant.time}"
        return show.Sheet(title, lines, (gains, *certificate.tables))


@arguments.checked
def of_gain(
    system: System, exosystem: Exosystem, K: ArrayLike, *, regulated: Names = None, controls: Names = None
) -> Servo:
    """Return the regulator with any state feedback K (m, n + p k).

    Raises SignalError for a K of another shape or an unknown name, ModelError for an unstable loop; else as
    `internal_model.augmented`.
    """
    plant, acting, model = split_plant(system, exosystem, regulated, controls)
    states = internal_model.augmented(acting, model).states
    gain = arguments.matrix("K", K)
    if gain.shape != (len(acting.inputs), len(states)) or not np.isfinite(gain).all():
        raise SignalError(
            f"K is {gain.shape}: give a finite one of {(len(acting.inputs), len(states))}, {', '.join(acting.inputs)} "
            f"by {', '.join(states)}"
        )
    return _require_stable(Servo(plant, model, acting.outputs, acting.inputs, readonly(gain), plant.states, None))


@arguments.checked
def with_estimator(servo: Servo, estimator: System) -> Servo:
    """Return the regulator with an estimator of the plant's states, u = K_x x^ + K_xi xi.

    The estimator's inputs are the controls (in the loop, their actual values) and measured outputs; its outputs are
    ``<state>_estimate`` or <state>, for each state of the plant.

    Raises SignalError for wrong signals or a direct path from a control to an estimate, TimingError for another time,
    ModelError for a loop that is not stable.
    """
    model = of(estimator)
    plant, u = servo.plant, servo.controls
    common(plant.time, model.time)
    if unknown := [name for name in model.inputs if name not in (*u, *plant.outputs)]:
        raise SignalError(
            f"the estimator's input '{unknown[0]}' is neither a control ({', '.join(u)}) nor an output of the plant"
        )
    kept = [f"{x}_estimate" if f"{x}_estimate" in model.outputs else x for x in plant.states]
    acting = [name for name in model.inputs if name in u]
    if model.select(kept, acting).D.any():
        raise SignalError(
            f"the estimate depends directly on {', '.join(acting)}, which makes an algebraic loop: give an "
            "estimator that uses the controls of the sample before"
        )
    measured = tuple(name for name in model.inputs if name not in u)
    return _require_stable(replace(servo, measured=measured, estimator=model.select(kept, model.inputs)))


@arguments.checked
def split_plant(
    system: System, exosystem: Exosystem, regulated: Names, controls: Names
) -> tuple[StateSpace, StateSpace, InternalModel]:
    """Return the plant, its part from the controls to the regulated outputs, and the internal model in the same time.

    Raises SignalError for an unknown name or no regulated output; else as `internal_model.in_time`.
    """
    plant = of(system)
    ends = plant.outputs if regulated is None else arguments.as_name_list("regulated outputs", regulated)
    if not ends:
        known = ", ".join(plant.outputs) or "none: give the model a C"
        raise SignalError(f"no output is regulated: name one or more; the model's outputs are {known}")
    acting = plant.select(ends, plant.inputs if controls is None else arguments.as_name_list("controls", controls))
    return plant, acting, internal_model.in_time(exosystem, plant.time)


def _require_stable(servo: Servo) -> Servo:
    if servo.steady.unstable_pole is not None:
        raise ModelError(
            f"the servo loop has the pole {show.number(servo.steady.unstable_pole)}, which does not decay: give gains "
            "that stabilise the plant together with the internal model, and an estimator whose error decays"
        )
    return servo


def _controller(servo: Servo, estimator: StateSpace) -> StateSpace:
    plant, model, regulated, controls = servo.plant, servo.model, servo.regulated, servo.controls
    p = len(regulated)
    Phi, N = np.kron(np.eye(p), model.Phi), np.kron(np.eye(p), model.N)
    limited = {u: f"{u}_limited" for u in controls}
    estimator_inputs = [limited.get(name, name) for name in estimator.inputs]
    estimator_states = [f"{name}_estimate" if name in plant.states else name for name in estimator.states]
    A, B = scipy.linalg.block_diag(Phi, estimator.A), scipy.linalg.block_diag(N, estimator.B)
    C = np.hstack([servo.K_xi, servo.K_x @ estimator.C])
    D = np.hstack([np.zeros((len(controls), p)), servo.K_x @ estimator.D])
    units = {f"{x}_estimate": unit for x, unit in plant.units.items()}
    units |= {
        name: estimator.unit(x) for name, x in zip(estimator_states, estimator.states, strict=True) if estimator.unit(x)
    }
    units |= {**plant.units, **model.units(regulated, plant.units)}
    for signals, end in ((regulated, "error"), (controls, "command"), (controls, "limited")):
        units |= {f"{name}_{end}": plant.unit(name) for name in signals if plant.unit(name)}
    states = (*model.state_names(regulated), *estimator_states)
    inputs = (*with_suffix(regulated, "error"), *estimator_inputs)
    return StateSpace(A, B, C, D, states, inputs, with_suffix(controls, "command"), plant.time, units)


def _state_measurement(plant: StateSpace) -> StateSpace:
    n = len(plant.A)
    form = (np.zeros((0, 0)), np.zeros((0, n)), np.zeros((n, 0)), np.eye(n))
    return StateSpace(*form, (), plant.states, plant.states, plant.time)


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


@arguments.checked
def lqr(
    system: System,
    exosystem: Exosystem,
    Q: weights.Weight,
    R: weights.Weight,
    N: ArrayLike | None = None,
    *,
    regulated: Names = None,
    controls: Names = None,
) -> Servo:
    """Return the optimal state feedback of a plant in its own time.

    Q (n + p k, n + p k) weights the plant's states and `InternalModel.state_names`, R (m, m) the controls, N is the
    cross weight. Inputs that are no controls are disturbances. K is the same on every machine.

    Raises SignalError for unknown names; else as `internal_model.augmented` and `riccati.solve`.
    """
    plant, acting, model = split_plant(system, exosystem, regulated, controls)
    whole = internal_model.augmented(acting, model)
    gain = linear_quadratic.lqr(whole, Q, R, N).K
    return of_gain(plant, model, gain, regulated=acting.outputs, controls=acting.inputs)


@arguments.checked
def lqrd(
    system: System,
    exosystem: Exosystem,
    Q: weights.Weight,
    R: weights.Weight,
    period_s: float,
    *,
    regulated: Names = None,
    controls: Names = None,
) -> Servo:
    """Return the optimal state feedback for a continuous plant whose input and error are held over `period_s`.

    Q and R weight the continuous integral, as for `lqr`. The result is in discrete time.

    Raises as `lqr`; TimingError for a sampled plant; ModelError as `discretise.zero_order_hold`.
    """
    plant, acting, model = split_plant(system, exosystem, regulated, controls)
    common(Continuous(), plant.time)
    names = (*acting.states, *model.state_names(acting.outputs))
    Q, R = weights.semidefinite("Q", Q, names), weights.definite("R", R, acting.inputs)
    W = _period_weight(acting, model, scipy.linalg.block_diag(Q, R), period_s)
    plant, acting = (discretise.zero_order_hold(part, period_s) for part in (plant, acting))
    model, k = internal_model.in_time(model, plant.time), len(names)
    whole = internal_model.augmented(acting, model)
    gain = linear_quadratic.lqr(whole, W[:k, :k], W[k:, k:], W[:k, k:]).K
    return of_gain(plant, model, gain, regulated=acting.outputs, controls=acting.inputs)


def _period_weight(acting: StateSpace, model: InternalModel, Q: Array, period_s: float) -> Array:
    """Return the cost of a period as a weight on x, xi and u at its start; Q weights x, xi and u."""
    (n, m), p, k = acting.B.shape, len(acting.outputs), len(model.Phi) * len(acting.outputs)
    A = scipy.linalg.block_diag(acting.A, np.kron(np.eye(p), model.Phi))
    B = scipy.linalg.block_diag(acting.B, np.kron(np.eye(p), model.N))
    F = np.vstack([np.hstack([A, B]), np.zeros((m + p, n + k + m + p))])
    W = discretise.gramian(F, scipy.linalg.block_diag(Q, np.zeros((p, p))), period_s).W
    held = np.vstack([np.eye(n + k + m), np.hstack([acting.C, np.zeros((p, k)), acting.D])])
    gathered = held.T @ W @ held
    return np.asarray((gathered + gathered.T) / 2)
