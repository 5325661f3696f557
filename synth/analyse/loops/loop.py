"""Open-loop transfer of a sampled loop at any signal (MATLAB `getLoopTransfer`), with the hold and the delay.

    u_s --> [ controller without s ] --> [ delay ] --> [ hold, plant, sampler ] --> [ controller ] --> y_s

The signal s is one of these:
- a sensor or an actuator;
- a coordinate q = T y of sensors y, cut with E = pinv(T) in front of the controller, y -> (1 - E T) y + E q;
- a signal inside the controller, whose Blocks are then composed with s `cut`: its driver drives ``s_out``, its readers
  read ``s``.

The loop L from s to -s_out has the closed loop 1 + L. `equilibrium.open_loop` linearises plant and controller at rest
and opens the loop there.

A plant x' = A x + B u(t - tau) with its input held over each period T and delayed by tau = (d + f) T, 0 <= f < 1,
receives u[k-d-1] for the first f T of period k and u[k-d] for the remainder:

    x[k+1] = exp(A T) x[k] + exp(A (1-f) T) G(f T) u[k-d-1] + G((1-f) T) u[k-d],      G(t) = int_0^t exp(A s) ds B
    y[k]   = C x[k] + D u[k-d-1]                                                      D u[k-d] where f = 0
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from numbers import Real

import casadi as ca
import flint
import numpy as np

from synth import arguments
from synth.analyse import discretise
from synth.analyse.numerics import derivatives, precise
from synth.analyse.structure import realisation
from synth.block import Block
from synth.errors import ModelError, SignalError, TimingError
from synth.signals import signal_names
from synth.statespace import Array, StateSpace, System, of
from synth.timing import Continuous, Discrete, period

DELAY_ROUNDING = 1e-9  # of a sample: a delay this close to a whole number of samples is rounded to it
KINDS = ("a sensor", "an actuator", "a coordinate")
MAX_DELAY_STATES = 500  # states for the delay: the eigenvalues of the loop cost their cube


@arguments.checked
def cut(blocks: Sequence[Block], signal: str) -> tuple[Block, ...]:
    """Return the Blocks with the driver of `signal` renamed to ``<signal>_out``.

    Raises SignalError when no Block drives it.
    """
    out = f"{signal}_out"
    if not any(signal in signal_names(b.outputs) for b in blocks):
        raise SignalError(f"no Block drives '{signal}': open the loop at a signal that one drives")
    return tuple(b.renamed({signal: out}) if signal in signal_names(b.outputs) else b for b in blocks)


@arguments.checked
def linearise_block(
    block: Block, state: Mapping[str, float], inputs: Mapping[str, float], held: Collection[str] = ()
) -> StateSpace:
    """Return the Block's Jacobians at a state and inputs, by name; a state without a value is at its initial value.

    The model lacks the inputs that are `held` at their values. A state at one of its bounds moves inwards only.

    Raises SignalError for a missing value or an unknown name; ModelError at a kink of a real state or an output.
    """
    known = (*(s.name for s in block.states), *signal_names(block.inputs))
    unknown = [n for n in (*state, *inputs, *held) if n not in known]
    missing = [n for n in signal_names(block.inputs) if n not in inputs]
    if unknown or missing:
        raise SignalError(f"block '{block.name}': not known {unknown or 'none'}, missing {missing or 'none'}")
    x0 = np.array([state.get(s.name, s.initial) for s in block.states], dtype=np.float64)
    u0 = np.array([inputs[n] for n in signal_names(block.inputs)], dtype=np.float64)
    sides = [
        (not s.integer and v > s.signal.low, not s.integer and v < s.signal.high)
        for s, v in zip(block.states, x0.tolist(), strict=True)
    ]
    sides += [(s.name not in held, s.name not in held) for s in block.inputs]
    rows = [f"the next value of '{s.name}'" * (not s.integer) for s in block.states]
    rows += [f"the output '{s.name}'" for s in block.outputs]
    signals = (*(s.signal for s in block.states), *block.inputs)
    A, B, C, D = derivatives.linear_model(f"block '{block.name}'", _step(block), (x0, u0), signals, sides, rows)
    moving = [i for i, s in enumerate(block.inputs) if s.name not in held]
    states, names = tuple(s.name for s in block.states), tuple(block.inputs[i].name for i in moving)
    return StateSpace(A, B[:, moving], C, D[:, moving], states, names, signal_names(block.outputs), block.time)


@lru_cache(maxsize=8)  # a controller is linearised at many points
def _step(block: Block) -> ca.Function:
    return block.function()


@arguments.checked
def sampled(plant: System, period_s: float, delay_s: float = 0.0) -> StateSpace:
    """Return the exact zero-order-hold equivalent of a continuous plant with any input delay `delay_s` >= 0.

    Each whole sample of delay is a state ``<input>_late<k>``; a fraction is one more, ``<input>_held``: u[k-d-1], which
    the hold still outputs at sample k.

    Raises TimingError for a plant that is sampled already, a period that is not positive, or a delay that is negative,
    not finite or needs more than 500 states; ModelError for a mode that overflows double precision within a period,
    and as `precise.round_correctly`.
    """
    time = Discrete(period_s)
    return _sample_with_delay(of(plant), time, _number(delay_s) / time.period_s)


def _number(delay: float) -> float:
    if not isinstance(delay, Real) or isinstance(delay, bool):
        raise TimingError(f"the delay is {delay!r}: give a number")
    return float(delay)


@lru_cache(maxsize=8)  # a loop is opened at many signals
def _sample_with_delay(plant: StateSpace, time: Discrete, samples: float) -> StateSpace:
    T = time.period_s
    if not isinstance(plant.time, Continuous):
        raise TimingError(f"a model in {plant.time} cannot be sampled at {T:g} s: give the continuous model")
    if not (np.isfinite(samples) and samples >= 0):
        raise TimingError(f"the delay is {samples * T:g} s: it must be finite and 0 or more")
    whole, m = round(samples), plant.B.shape[1]
    if whole * max(m, 1) > MAX_DELAY_STATES:
        raise TimingError(
            f"the delay is {samples * T:g} s, {samples:.6g} samples of {T:g} s for each of {m} inputs: at most "
            f"{MAX_DELAY_STATES} states are added for it; take a longer period, or keep the loop continuous "
            "(transfer.with_delay_and_hold)"
        )
    n, fraction = len(plant.A), samples - np.floor(samples)
    if abs(samples - whole) < DELAY_ROUNDING:
        E = _held_response(plant, T, 0.0)
        return discretise.delay_samples(replace(plant, A=E[:, :n], B=E[:, n + m :], time=time), whole)
    return discretise.delay_samples(_sample_with_fraction(plant, time, fraction), int(samples))


def _sample_with_fraction(plant: StateSpace, time: Discrete, fraction: float) -> StateSpace:
    """Return the plant with its inputs held and delayed by a fraction of a period."""
    n, m = plant.B.shape
    E = _held_response(plant, time.period_s, fraction)
    A = np.block([[E[:, : n + m]], [np.zeros((m, n + m))]])
    B = np.vstack([E[:, n + m :], np.eye(m)])
    C, D = np.hstack([plant.C, plant.D]), np.zeros_like(plant.D)
    held = {f"{name}_held": name for name in plant.inputs}
    units = {**plant.units, **{new: plant.units[name] for new, name in held.items() if name in plant.units}}
    return replace(plant, A=A, B=B, C=C, D=D, states=(*plant.states, *held), time=time, units=units)


def _held_response(plant: StateSpace, T: float, fraction: float) -> Array:
    """Return [exp(A T), the effect of u[k-d-1], that of u[k-d]] (n, n + 2 m), rounded once."""
    n, m = plant.B.shape
    before, after = np.zeros((n + 2 * m, n + 2 * m)), np.zeros((n + 2 * m, n + 2 * m))
    before[:n, :n], before[:n, n : n + m] = plant.A, plant.B
    after[:n, :n], after[:n, n + m :] = plant.A, plant.B

    def compute() -> flint.arb_mat:
        first = flint.arb(T) * flint.arb(fraction)
        return (precise.matrix(after) * (flint.arb(T) - first)).exp() * (precise.matrix(before) * first).exp()

    E = precise.round_correctly(compute, f"the exponential over {T:g} s")[:n]
    if not np.isfinite(E).all():
        raise ModelError(
            f"a mode of the plant overflows double precision within {T:g} s: take a shorter period or leave that "
            "mode out of the plant"
        )
    return E


@arguments.checked
def open_loop(
    plant: System,
    controller: System,
    signal: str | Sequence[str],
    sensors: Mapping[str, str],
    actuators: Mapping[str, str | Mapping[str, float]],
    delay: float = 1,
    coordinates: Mapping[str, Mapping[str, float]] | None = None,
) -> StateSpace:
    """Return L from `signal` to minus ``<signal>_out`` for a continuous plant with hold, sampler and controller.

    `sensors[controller input] = plant output`, `actuators[plant input] = controller output`, or a sum of them,
    {controller output: weight}; other inputs stay constant. The loop opens at a controller input that is a sensor,
    at a plant input that is an actuator, or at a signal where the controller was `cut`; at several at once if several
    are named. At an actuator it opens before the delay, and an observer in the controller still receives its command.
    `coordinates` {name: {sensor: weight}} are sums of sensors at which the loop can open as well.

    `delay` is in samples, any number from 0.

    Raises TimingError for a sampled plant, a continuous controller or a delay as `sampled`; ModelError as `sampled`;
    SignalError for an unknown name, a name that is two of sensor, actuator and coordinate, for linearly dependent
    coordinates, or for a plant with direct feedthrough and no delay.
    """
    K = of(controller)
    P = _sample_with_delay(of(plant), Discrete(period(K.time)), _number(delay))
    if (P.D != 0).any():
        direct = [y for y, row in zip(P.outputs, P.D, strict=True) if (row != 0).any()]
        raise SignalError(
            f"the sampled plant has direct feedthrough to '{direct[0]}': give the loop at least one sample of delay"
        )
    signals = arguments.as_name_list("signals to open the loop at", signal)
    S = _wires(K.inputs, P.outputs, sensors)
    U = _wires(P.inputs, K.outputs, actuators)
    wires = _break(signals, P, K, S, U, sensors, actuators, coordinates or {})
    A = np.block([[P.A + P.B @ wires.U @ K.D @ wires.S @ P.C, P.B @ wires.U @ K.C], [K.B @ wires.S @ P.C, K.A]])
    B = np.vstack([P.B @ (wires.U @ K.D @ wires.into_controller + wires.into_plant), K.B @ wires.into_controller])
    C = -np.hstack([wires.of_controller @ K.D @ wires.S @ P.C + wires.of_plant @ P.C, wires.of_controller @ K.C])
    D = -wires.of_controller @ K.D @ wires.into_controller
    states = tuple(f"plant_{s}" for s in P.states) + K.states
    units = {**K.units, **{f"plant_{s}": P.units[s] for s in P.states if s in P.units}}
    outs = tuple(f"{n}_out" for n in signals)
    return realisation.without_unconnected_states(StateSpace(A, B, C, D, states, signals, outs, K.time, units))


@dataclass(frozen=True, eq=False)
class _Break:
    """The remaining wires S and U, where the signals enter plant and controller, and their former drivers."""

    S: Array
    U: Array
    into_controller: Array
    into_plant: Array
    of_controller: Array
    of_plant: Array


def _break(
    signals: Sequence[str],
    P: StateSpace,
    K: StateSpace,
    S: Array,
    U: Array,
    sensors: Collection[str],
    actuators: Collection[str],
    coordinates: Mapping[str, Mapping[str, float]],
) -> _Break:
    """Remove the wires to `signals`."""
    T = _weights(coordinates, K.inputs, signals)
    E = np.linalg.pinv(T)
    wires = _Break(
        S.copy(),
        U.copy(),
        *(np.zeros((len(names), len(signals))) for names in (K.inputs, P.inputs)),
        *(np.zeros((len(signals), len(names))) for names in (K.outputs, P.outputs)),
    )
    for j, name in enumerate(signals):
        if f"{name}_out" in K.outputs:
            wires.into_controller[:, j : j + 1] = _wires(K.inputs, (name,), {name: name})
            wires.of_controller[j] = _wires(("out",), K.outputs, {"out": f"{name}_out"})[0]
            continue
        kinds = [what for what, known in zip(KINDS, (sensors, actuators, coordinates), strict=True) if name in known]
        if len(kinds) != 1:
            what = f"is {' and '.join(kinds)}" if kinds else "is neither a sensor nor an actuator"
            raise SignalError(
                f"the loop cannot open at '{name}', which {what}: name one of "
                f"{', '.join((*sensors, *actuators, *coordinates))}, rename one of two with the same name, or `cut` "
                "the controller at it"
            )
        if name in coordinates:
            row = list(coordinates).index(name)
            wires.into_controller[:, j], wires.of_plant[j] = E[:, row], T[row] @ S
            wires.S[:] -= np.outer(E[:, row], T[row] @ S)
        elif name in sensors:
            i = K.inputs.index(name)
            wires.into_controller[i, j], wires.of_plant[j], wires.S[i] = 1, S[i], 0
        else:
            i = P.inputs.index(name)
            wires.into_plant[i, j], wires.of_controller[j], wires.U[i] = 1, U[i], 0
    return wires


def _weights(coordinates: Mapping[str, Mapping[str, float]], inputs: Sequence[str], signals: Sequence[str]) -> Array:
    """Return the weights (coordinates, inputs); raise SignalError unless the loop can open at `signals`."""
    T = _wires(tuple(coordinates), inputs, coordinates)
    if np.linalg.matrix_rank(T) < len(T):
        raise SignalError(f"the coordinates {', '.join(coordinates)} are linearly dependent: leave one of them out")
    summed = {sensor for name in signals if name in coordinates for sensor in coordinates[name]}
    if both := summed.intersection(signals):
        raise SignalError(f"the loop cannot open at '{min(both)}' and at a coordinate of it at once: leave one out")
    return T


def _wires(into: Sequence[str], source: Sequence[str], wires: Mapping[str, str | Mapping[str, float]]) -> Array:
    """Return the matrix (into, source) of wire weights, 1 for a wire from one signal, 0 without a wire."""
    W = np.zeros((len(into), len(source)))
    for end, start in wires.items():
        for begin, weight in ({start: 1.0} if isinstance(start, str) else start).items():
            for name, known in ((end, into), (begin, source)):
                if name not in known:
                    raise SignalError(f"the wire from '{begin}' to '{end}': '{name}' is not one of {', '.join(known)}")
            W[into.index(end), source.index(begin)] = weight
    return W
