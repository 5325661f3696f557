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
the loop stays stable (Davison 1976, Francis and Wonham 1976). `optimal_servo` computes gains. They also serve a
regulator that feeds back e and its derivatives in place of x, as `regulator.block` does for one axis.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike

from synth import arguments, show
from synth.errors import ModelError, SignalError
from synth.statespace import Array, Complex, StateSpace, System, of, readonly
from synth.synthesise.regulation import internal_model, steady_error
from synth.synthesise.regulation.internal_model import Exosystem, InternalModel
from synth.synthesise.regulation.steady_error import SteadyError, with_suffix
from synth.timing import common

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
