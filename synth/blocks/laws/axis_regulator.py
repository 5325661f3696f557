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

Input-output linearising inverse as Blocks, with the effect of the actuators' limits on the demands (anti-windup).

    w ---> [ i = D(x)^-1 (w - a(x)) ] ---> <actuator>_demand ---> limits ---> <actuator>_excess
                                                                                   v
    <w>_limited, <w>_excess  <-----  [ <w>_excess = D(x) <actuator>_excess,  <w>_limited = a(x) + D(x) <actuator> ]

The first Block converts the demands w, the r-th derivatives of the outputs, to actuator commands. The second converts
the limited commands back to the achieved derivatives. x is the plant's state when the actuators act. Its elements are
predicted by the axes that estimate them, and measured otherwise. They are limited to the plant's domain, outside which
the law is not defined. Source: `feedback_linearisation`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import casadi as ca
import flint
import numpy as np

from synth.analyse.loops import loop
from synth.analyse.numerics import nearest_root, precise
from synth.block import Block, Exprs, Step, build, clip
from synth.declare.stage import Interface
from synth.errors import SignalError
from synth.law import label
from synth.signals import UNBOUNDED, Signal
from synth.statespace import Array, StateSpace, readonly
from synth.synthesise.nonlinear.feedback_linearisation import Linearisation
from synth.synthesise.observers import kalman as filters
from synth.synthesise.regulation import anti_windup as windup
from synth.synthesise.regulation import internal_model
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
    `servo.lqrd` and `anti_windup.back_calculation`.
    """
    if delay < 0:
        raise SignalError(f"the delay is {delay} samples: give 0 or more")
    model, T, frequencies = axis.model, time.period_s, list(axis.modes)
    undelayed = servos.lqrd(model, frequencies, _weight(axis), [axis.command_weight], T)
    held = loop.sampled(model, T, delay * T)
    regulator = servos.of_gain(held, undelayed.model, _gain_for_delay(undelayed, delay))
    filter, form = _filter(axis, held, T)
    observed = servos.with_estimator(regulator, form)
    compensator = windup.back_calculation(observed, axis.anti_windup)
    feedforward = _feedforward(axis, regulator, T)
    controller = _with_reference(servos.controller(observed, compensator.controller), axis, feedforward)
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


MARGIN = 1.1  # factor on a bound: room for rounding, and for maxima between the sample points
POINTS, SEED = 256, 11  # number of sample points in the plant's box, in addition to its vertices


@dataclass(frozen=True)
class Command:
    """The names of a command and of its excess, and the signal `limited`, the part of the command that is achieved."""

    name: str
    excess: str
    limited: Signal

    @property
    def signal(self) -> Signal:
        """The command's signal, of any size."""
        return replace(self.limited, name=self.name, low=-UNBOUNDED, high=UNBOUNDED, about="before the limits")

    @property
    def excess_signal(self) -> Signal:
        """The signal of the excess, which is the limited minus the commanded value."""
        return replace(self.limited, name=self.excess, low=-UNBOUNDED, high=UNBOUNDED, about="limited less commanded")


def command(axis: Axis, interface: Interface) -> Command:
    """Return the demand of an axis on the inverse, limited to what the actuators can achieve in the plant's box.

    Raises SignalError for an axis without an inverse.
    """
    unit = axis.model.unit(axis.command) or "1"
    bound = _demand_bound(_inverse(axis), axis.output, interface)
    limited = Signal(f"{axis.command}_limited", unit, -bound, bound, "what the actuators make of the demand")
    return Command(f"{axis.command}_command", f"{axis.command}_excess", limited)


def _inverse(axis: Axis) -> Linearisation:
    if axis.inverse is None:
        raise SignalError(
            f"the axis of '{axis.output}' has no inverse: give it a chain of integrators from a feedback linearisation"
        )
    return axis.inverse


def predicted_states(axis: Axis) -> dict[str, Signal]:
    """Return {plant state: signal of its prediction} for the states that the axis estimates and the inverse needs."""
    if axis.inverse is None:
        return {}
    needed = _states_in_law(axis.inverse)
    return {s.name: replace(s, name=f"{s.name}_predicted") for s in needed if s.name in axis.model.states}


def _states_in_law(inverse: Linearisation) -> list[Signal]:
    """Return the plant's states on which the law, the drift or the decoupling matrix depends."""
    model = inverse.degree.model
    exprs = ca.vertcat(inverse.u, ca.vec(inverse.degree.decoupling), inverse.degree.drift)
    return [model.states[k] for k in nearest_root.signal_indices(exprs, inverse.x, model.states)]


def blocks(time: Discrete, axes: Sequence[Axis], commands: Mapping[str, Command], interface: Interface) -> list[Block]:
    """Return two Blocks: from the commands {output: Command} of the axes to the actuators' demands, and back.

    Raises SignalError for an output without an axis, an input without an actuator, or a state that is neither estimated
    by an axis nor measured.
    """
    inverse = _inverse(axes[0])
    outputs = inverse.degree.outputs
    if missing := [name for name in outputs if name not in commands]:
        raise SignalError(
            f"the feedback linearisation also needs the demand of '{missing[0]}': join the axes of "
            f"{', '.join(outputs)} by axis.decouple"
        )
    state_signals = _StateSignals(inverse, _states(inverse, axes, interface))
    actuators = _actuators(inverse, interface)
    demands = [commands[name].signal for name in outputs]
    actuator_demands = [interface.demand(a) for a in actuators]
    actuator_excess = [interface.excess(a) for a in actuators]
    computed = [interface.computed_output(a) for a in actuators]

    def invert(u: Exprs, x: Exprs, k: Exprs) -> Step:
        w = ca.vertcat(*(u[s.name] for s in demands))
        actuator_values = ca.substitute(state_signals.signals(inverse.u, u), inverse.w, w)
        return Step({s.name: actuator_values[i] for i, s in enumerate(actuator_demands)})

    def achieved_demands(u: Exprs, x: Exprs, k: Exprs) -> Step:
        a, D = (state_signals.signals(e, u) for e in (inverse.degree.drift, inverse.degree.decoupling))
        excess_demands = ca.mtimes(D, ca.vertcat(*(u[s.name] for s in actuator_excess)))
        achieved = a + ca.mtimes(D, ca.vertcat(*(u[s.name] for s in computed)))
        output = {commands[name].excess: excess_demands[i] for i, name in enumerate(outputs)}
        limited = [commands[name].limited for name in outputs]
        label(drift=a, achieved=achieved)
        return Step(output | {s.name: clip(achieved[i], s) for i, s in enumerate(limited)})

    states, name = list(state_signals.states.values()), "_".join(outputs)
    achieved_signals = [s for name in outputs for s in (commands[name].excess_signal, commands[name].limited)]
    tag = f"feedback linearisation of {', '.join(outputs)}"
    return [
        build(f"inverse_{name}", time, invert, inputs=[*states, *demands], outputs=actuator_demands, tag=tag),
        build(
            f"achieved_{name}",
            time,
            achieved_demands,
            inputs=[*states, *actuator_excess, *computed],
            outputs=achieved_signals,
            tag=tag,
        ),
    ]


@dataclass(frozen=True, eq=False)
class _StateSignals:
    """The signals from which the law takes the plant's states, by state."""

    inverse: Linearisation
    states: Mapping[str, Signal]

    def signals(self, expr: ca.SX, u: Exprs) -> ca.SX:
        """Replace the plant's states in an expression by their signals, limited to the plant's domain."""
        domain = self.inverse.degree.model.states
        for symbol, state in zip(ca.vertsplit(self.inverse.x), domain, strict=True):
            if state.name in self.states:
                expr = ca.substitute(expr, symbol, clip(u[self.states[state.name].name], state))
        return expr


def _states(inverse: Linearisation, axes: Sequence[Axis], interface: Interface) -> dict[str, Signal]:
    signals = {name: s for axis in axes for name, s in predicted_states(axis).items()}
    sensors = {s.of: s.name for s in interface.sensors}
    for state in _states_in_law(inverse):
        if state.name not in signals:
            if state.name not in sensors:
                raise SignalError(
                    f"the feedback linearisation needs '{state.name}', which no axis estimates and no sensor measures: "
                    "linearise its output too, or measure it"
                )
            signals[state.name] = interface.held(sensors[state.name])
    return signals


def _actuators(inverse: Linearisation, interface: Interface) -> list[str]:
    actuators = {a.of: a.name for a in interface.actuators}
    if missing := [name for name in inverse.inputs if name not in actuators]:
        raise SignalError(
            f"the feedback linearisation has the input '{missing[0]}', which no actuator drives: "
            "hold it constant, or add an actuator"
        )
    return [actuators[name] for name in inverse.inputs]


def _sample_points(inverse: Linearisation, ranges: Mapping[str, tuple[float, float]]) -> tuple[Array, Array]:
    """Return k points, first the vertices of the box: states (n, k) in their ranges, and values (m, k) in `ranges`."""
    states = inverse.degree.model.states
    signals = [*states, *(Signal(name, "1", low, high) for name, (low, high) in ranges.items())]
    corners = np.array(np.meshgrid(*([0.0, 1.0] for _ in signals))).reshape(len(signals), -1)
    points = np.hstack([nearest_root.within(signals, corners), nearest_root.scatter(signals, POINTS, SEED)])
    return points[: len(states)], points[len(states) :]


def _demand_bound(inverse: Linearisation, output: str, interface: Interface) -> float:
    """Return the largest magnitude of the demanded derivative that the actuators can achieve."""
    signals = {a.of: interface.signals[a.name] for a in interface.actuators}
    degree, i = inverse.degree, inverse.degree.outputs.index(output)
    ranges = [signals.get(s.name, s) for s in degree.model.inputs]
    x, u = _sample_points(inverse, {s.name: (s.low, s.high) for s in ranges})
    symbols = ca.SX.sym("u", len(u))
    achieved = degree.drift[i] + ca.mtimes(degree.decoupling[i, :], symbols)
    function = ca.Function("achieved", [inverse.x, symbols], [ca.densify(achieved)])
    return round_up(MARGIN * float(np.abs(np.asarray(function(x, u))).max()))


def round_up(value: float) -> float:
    """Return a bound rounded up to two digits, so that it is the same on every machine; 1e-30 for a bound of 0."""
    if not value:
        return 1e-30
    scale = 10.0 ** (np.floor(np.log10(value)) - 1)
    return float(f"{np.ceil(value / scale) * scale:.2g}")
