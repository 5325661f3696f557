"""Sampled-data servo LQG of one axis (MATLAB `lqi` with `kalman`), with the loop's delay and anti-windup.

    r --->(+)--- e ---> [ internal model of the modes ] --- xi --->[ K_xi ]---+
         - ^                                                                  v
           y -------> [ Kalman filter, predicts x(k + d) ] --- x^ ---->[ K_x ]+--- u ---> limit ---> delay, d samples
                                ^-------------- u as limited ------------------------------'

The command is held over each period T and acts d samples after it is computed. K minimises

    int ( sum_s w_s s^2  +  w_u u^2  +  sum_i 2^(f_i > 0) v_i^2 w_y |z_i|^2 ) dt

with the weights w_s of the states, w_y of the output y and w_u of the command, and for each mode of frequency f_i the
oscillator z_i' = j f_i z_i + e (an integrator for f_i = 0). While the loop is fast, e = -k z has the least mean cost
over one period when z_i decays at the rate v_i. A mode is therefore specified by the speed v_i in 1/s at which its
error decays, not by a weight.

u cannot change the cost before it acts. The gain for the delay d is therefore the gain of the undelayed loop, applied
to the state d samples later. The model predicts that state from the estimate and from the commands in the delay line:

    u(k) = K [x; xi](k + d),    [x; xi](k + 1) = [A 0; N C Phi] [x; xi](k) + [B; 0] u(k - d).

Sources: Anderson, Moore, Optimal Control (1989), 4.1, 8.2; Francis, Wonham (1976); Franklin, Powell, Workman (1998), 9.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import flint
import numpy as np

from synth.analyse.loops import loop
from synth.analyse.numerics import precise
from synth.errors import SignalError
from synth.statespace import Array, StateSpace, readonly
from synth.synthesise.nonlinear.feedback_linearisation import Linearisation
from synth.synthesise.observers import kalman as filters
from synth.synthesise.regulation import anti_windup as windup
from synth.synthesise.regulation import internal_model, leapfrog_form, optimal_servo
from synth.synthesise.regulation import servo as servos
from synth.timing import Discrete


@dataclass(frozen=True)
class Kalman:
    """Noise for which a Kalman filter is designed.

    `process` {state: density} is white noise on the state's derivative, in the derivative's unit squared times s, for
    example m^2/s^3 for a speed; `sensor` {output: variance} is that of the samples, in the output's unit squared.
    """

    process: Mapping[str, float]
    sensor: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class Axis:
    """Specification of one axis; `axis.servo` documents each field.

    The input of `model` is an input of the plant or, with an `inverse`, the demand on it.
    """

    model: StateSpace
    inverse: Linearisation | None
    modes: Mapping[float, float]
    weights: Mapping[str, float]
    command_weight: float
    estimator: Kalman
    anti_windup: float
    set_point_weight: float | None

    @property
    def output(self) -> str:
        """The regulated output, which is measured."""
        return self.model.outputs[0]

    @property
    def command(self) -> str:
        """The command, an actuator of the plant or the demand on an inverse."""
        return self.model.inputs[0]


@dataclass(frozen=True, eq=False)
class Regulator:
    """The synthesised axis at a period and a delay in samples.

    `controller` has the inputs ``<output>_error``, ``<command>_limited``, ``<output>``, ``<command>_excess`` and
    ``<output>_reference``, the output ``<command>_command``, and ``<state>_predicted`` of the model's states when the
    command acts. `servo` and `anti_windup` certify it, `undelayed` is the optimal servo from which its gain comes,
    `filter` the Kalman filter, and `feedforward` the gain from the set-point to the command.
    """

    axis: Axis
    time: Discrete
    delay: int
    undelayed: servos.Servo
    servo: servos.Servo
    filter: filters.Estimator
    anti_windup: windup.AntiWindup
    feedforward: float
    controller: StateSpace

    def document(self) -> dict[str, Any]:
        """Return gains, weights, plant, rate and certificate for gains.json, the same on every machine."""
        axis, plant = self.axis, self.axis.model
        certificate = self.filter.certificate
        return {
            "plant": {letter: getattr(plant, letter).tolist() for letter in "ABC"},
            "states": list(self.servo.states),
            "command": axis.command,
            "regulated": axis.output,
            "period_s": self.time.period_s,
            "delay_samples": self.delay,
            "modes_rad_s": list(axis.modes),
            "speeds_per_s": list(axis.modes.values()),
            "weights": dict(axis.weights),
            "weights_of_internal_model": internal_weights(axis.modes, axis.weights[axis.output]).tolist(),
            "command_weight": axis.command_weight,
            "K": [_six_digits(v) for v in self.servo.K[0]],
            "set_point_gain": _six_digits(self.feedforward),
            "process_noise": dict(axis.estimator.process),
            "sensor_noise": dict(axis.estimator.sensor),
            "L": [_six_digits(v) for v in self.filter.L[:, 0]],
            "M": [_six_digits(v) for v in self.filter.M[:, 0]],
            "anti_windup_per_s": axis.anti_windup,
            "E": [_six_digits(v) for v in self.anti_windup.E[: len(self.servo.K_xi[0]), 0]],
            "certificate": {
                "slowest_decay_per_s": _six_digits(self.slowest_decay()),
                "error_dies_out": self.servo.steady.vanishes,
                "kalman_residual_is_small": bool(certificate.defect.max() <= 1e-9 * np.abs(certificate.X).max()),
            },
        }

    def slowest_decay(self) -> float:
        """Return the decay in 1/s of the closed loop's slowest pole."""
        return float(-np.log(np.abs(self.servo.poles).max()) / self.time.period_s)


def _six_digits(value: float) -> float:
    return float(f"{value:.6g}")


def internal_weights(modes: Mapping[float, float], weight: float) -> Array:
    """Return the weight (k, k) on xi for which the error of each mode decays at its speed in 1/s.

    `modes` is {frequency in rad/s: speed}; `weight` is the weight on the output. The oscillators z_i are combinations
    of xi. With p(s) the product of all modes' factors and p_i the product without mode i, the two parts of z_i are
    p_i(d/dt) d/dt xi1 and p_i(d/dt) f_i xi1; an integrator is p_i(d/dt) xi1.

    Raises SignalError as `internal_model.exosystem`.
    """
    k = sum(mode.order for mode in internal_model.exosystem(list(modes)).modes)
    total = [[Fraction(0)] * k for _ in range(k)]
    for f, speed in modes.items():
        others = _product([other for other in modes if other != f])
        rows = [[Fraction(0), *others], [Fraction(f) * c for c in others]] if f else [others]
        factor = (2 if f else 1) * Fraction(speed) ** 2 * Fraction(weight)
        for row in rows:
            full = [*row, *[Fraction(0)] * (k - len(row))]
            total = [[total[i][j] + factor * full[i] * full[j] for j in range(k)] for i in range(k)]
    return readonly([[float(v) for v in line] for line in total])


def _product(frequencies: Sequence[float]) -> list[Fraction]:
    """Return the coefficients, lowest first, of the product over f of s for f = 0 and s^2 + f^2 otherwise."""
    coefficients = [Fraction(1)]
    for f in frequencies:
        factor = [Fraction(f) ** 2, Fraction(0), Fraction(1)] if f else [Fraction(0), Fraction(1)]
        product = [Fraction(0)] * (len(coefficients) + len(factor) - 1)
        for i, a in enumerate(coefficients):
            for j, b in enumerate(factor):
                product[i + j] += a * b
        coefficients = product
    return coefficients


def synthesise(axis: Axis, time: Discrete, delay: int = 1) -> Regulator:
    """Return the axis at a sample period, for a command that acts `delay` whole samples after its measurement.

    All its numbers are the same on every machine.

    Raises SignalError for a delay below 0 or a mode at or above the Nyquist frequency; ModelError as `kalman.kalmd`,
    `optimal_servo.lqrd` and `anti_windup.back_calculation`.
    """
    if delay < 0:
        raise SignalError(f"the delay is {delay} samples: give 0 or more")
    model, T, frequencies = axis.model, time.period_s, list(axis.modes)
    undelayed = optimal_servo.lqrd(model, frequencies, _weight(axis), [axis.command_weight], T)
    held = loop.sampled(model, T, delay * T)
    regulator = servos.of_gain(held, undelayed.model, _gain_for_delay(undelayed, delay))
    filter, form = _filter(axis, held, T)
    observed = servos.with_estimator(regulator, form)
    compensator = windup.back_calculation(observed, axis.anti_windup)
    feedforward = _feedforward(axis, regulator, T)
    controller = _with_reference(leapfrog_form.controller(observed, compensator.controller), axis, feedforward)
    controller = _with_predicted_states(controller, undelayed.plant, form, delay)
    return Regulator(axis, time, delay, undelayed, observed, filter, compensator, feedforward, controller)


def _weight(axis: Axis) -> Array:
    """Return Q on the model's states and xi."""
    model, w = axis.model, axis.weights
    n, k = len(model.states), len(internal_weights(axis.modes, 1.0))
    Q = np.zeros((n + k, n + k))
    Q[:n, :n] = np.diag([w.get(name, 0.0) for name in model.states])
    if axis.output not in model.states:
        Q[:n, :n] += w[axis.output] * model.C.T @ model.C
    Q[n:, n:] = internal_weights(axis.modes, w[axis.output])
    return Q


def _gain_for_delay(undelayed: servos.Servo, delay: int) -> Array:
    """Return K on the states, the delay line (oldest command first) and xi, each entry rounded once."""
    plant, model = undelayed.plant, undelayed.model
    n, k = len(plant.A), len(model.Phi)

    def compute() -> Any:
        A, B = np.zeros((n + k, n + k)), np.vstack([plant.B, model.N @ plant.D])
        A[:n, :n], A[n:, n:] = plant.A, model.Phi
        step, into, row = precise.matrix(A), precise.matrix(B), precise.matrix(undelayed.K)
        driven = precise.matrix(model.N) * precise.matrix(plant.C)
        for i in range(k):
            for j in range(n):
                step[n + i, j] = driven[i, j]
        delay_gains = []
        for _ in range(delay):
            delay_gains.append((row * into)[0, 0])
            row = row * step
        advanced = [row[0, j] for j in range(n + k)]
        return type(row)([[*advanced[:n], *reversed(delay_gains), *advanced[n:]]])

    return precise.round_correctly(compute, "the gain for the delay")


def _filter(axis: Axis, held: StateSpace, period_s: float) -> tuple[filters.Estimator, StateSpace]:
    """Return the Kalman filter, and the estimator of the states and of the delay line."""
    model, process = axis.model, axis.estimator.process
    G = np.eye(len(model.states))[:, [model.states.index(name) for name in process]]
    estimator = filters.kalmd(model, list(process.values()), axis.estimator.sensor, period_s, G=G)
    none = np.zeros((len(held.states) - len(model.states), 1))
    L, M = (readonly(np.vstack([gain, none])) for gain in (estimator.L, estimator.M))
    return estimator, replace(estimator, model=held, L=L, M=M).current()


def _feedforward(axis: Axis, regulator: servos.Servo, period_s: float) -> float:
    """Return the gain from the set-point to the command."""
    model, C, speed = regulator.model, regulator.plant.C, axis.modes.get(0.0)

    def by_part() -> Any:
        c = precise.matrix(C)
        onto_output = (precise.matrix(regulator.K_x) * c.transpose()) * (c * c.transpose()).inv()
        return onto_output * -flint.arb(1.0 if axis.set_point_weight is None else axis.set_point_weight)

    def by_zero() -> Any:
        z = (-flint.arb(speed) * flint.arb(period_s)).exp()
        resolvent = precise.identity(len(model.Phi)) * z - precise.matrix(model.Phi)
        return precise.matrix(regulator.K_xi) * resolvent.solve(precise.matrix(model.N))

    chosen = by_zero if axis.set_point_weight is None and speed is not None else by_part
    return float(precise.round_correctly(chosen, "the gain from the set-point")[0, 0])


def _with_reference(controller: StateSpace, axis: Axis, feedforward: float) -> StateSpace:
    """Return the controller with an additional input ``<output>_reference`` that feeds through to the command."""
    name, unit = f"{axis.output}_reference", axis.model.unit(axis.output)
    B = np.hstack([controller.B, np.zeros((len(controller.states), 1))])
    D = np.hstack([controller.D, [[feedforward]]])
    units = {**controller.units, **({name: unit} if unit else {})}
    return replace(controller, B=B, D=D, inputs=(*controller.inputs, name), units=units)


def _with_predicted_states(controller: StateSpace, plant: StateSpace, form: StateSpace, delay: int) -> StateSpace:
    """Return the controller with additional outputs ``<state>_predicted``: the model's states when its command acts."""
    n = len(plant.states)
    advance = np.linalg.matrix_power(plant.A, delay)
    from_commands = [np.linalg.matrix_power(plant.A, delay - 1 - j) @ plant.B for j in range(delay)]
    prediction = np.hstack([advance, *from_commands])
    C, D = prediction @ form.C, prediction @ form.D
    rows, direct = np.zeros((n, len(controller.states))), np.zeros((n, len(controller.inputs)))
    rows[:, [controller.states.index(name) for name in form.states]] = C
    for j, name in enumerate(form.inputs):
        target = name if name in controller.inputs else f"{name}_limited"
        direct[:, controller.inputs.index(target)] = D[:, j]
    names = tuple(f"{name}_predicted" for name in plant.states)
    units = {end: plant.unit(name) for end, name in zip(names, plant.states, strict=True) if plant.unit(name)}
    return replace(
        controller,
        C=np.vstack([controller.C, rows]),
        D=np.vstack([controller.D, direct]),
        outputs=(*controller.outputs, *names),
        units={**controller.units, **units},
    )
