"""Full-order and reduced-order LQG compared by their instruction counts: compensator cores, and whole controllers.

A core maps three errors to three currents, as in (33) and (40), without delay compensation:

    (x, y, phi) less set-points --->[ core ]---> (i_B + i_A)/2, (i_B - i_A)/2, i_C --->[ rows ]---> i_AQ, i_BQ, i_CQ

In the half sum and half difference of the currents of A and B, (26) decouples into three axes, and a core is three
compensators of one error each. Each is realised in modal form, which has the fewest products: the integral and a stable
mode,

    I+ = I + r e,   p+ = lambda p + b e,    i = p + I + d e         lambda real (33), d not 0, or complex (40), d = 0:

In the complex case p and b are complex, and i takes the real part of p. Since |Re lambda| + |Im lambda| < 1, p is
bounded without a limit; the integral is limited.

The full-order regulator uses Kalman filters, Y(36)-(46), of position and rate of one axis:

    x^ = x- + M (q - x-),    x-+ = A x^ + B f    white acceleration of PROCESS_NOISE

`cost_table` counts the instructions of a step on an emulated Cortex-M4F. Both orders get the same recorded inputs,
those of the shipped controller at rest; the cores alone get small errors.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Literal

import casadi as ca
import numpy as np

from designs.planar_6dof import interface, lqg, vertical
from designs.planar_6dof.allocation import HORIZONTAL, LIMIT
from designs.planar_6dof.lqg import CURRENTS, MEASURED, OBSERVER_POLE, STATES, TIME, Axis, Regulate
from designs.planar_6dof.page import REST
from designs.planar_6dof.sensing.sections import READY
from designs.planar_6dof.vertical import MARGIN, POSITIONS
from models import planar_stage
from synth import show
from synth.analyse import discretise
from synth.analyse.loops import interconnect
from synth.block import Block, Constant, Exprs, State
from synth.blocks.laws import linear_block
from synth.composition import compose
from synth.emit import write
from synth.execute import host
from synth.plant import Plant
from synth.report import page
from synth.signals import Signal
from synth.simulate.experiments import Experiment
from synth.statespace import Array, StateSpace, readonly
from synth.synthesise.observers import kalman, reduced_observer
from synth.verify import cost
from synth.verify.agree import Columns

NOISE = {"x": 5e-5, "y": 5e-5, "phi": 1e-3}  # m, rad rms, (9) and (46); that of phi is not printed
PROCESS_NOISE = {"x": 0.3, "y": 0.3, "phi": 3.0}  # m^2/s^3, rad^2/s^3: spectral densities of acceleration
FASTEST = 20.0  # m/s, rad/s: bound of an estimated rate
Order = Literal["reduced", "full"]
ORDERS: tuple[Order, ...] = ("reduced", "full")
STEPS, SKIPPED = 200, 100
ERROR = 1e-6  # m, rad: amplitude of a core's errors
MODES = ("i_y", "i_phi", "i_x")
TO_MODES = readonly([[0.5, 0.5, 0.0], [-0.5, 0.5, 0.0], [0.0, 0.0, 1.0]])
FROM_MODES = readonly([[1, -1, 0], [1, 1, 0], [0, 0, 1]])
INTEGRALS = STATES[3:6]
PLANT = [0, 1, 2, 6, 7, 8]  # indices of the states of (26) among those of (31)
INTEGRAL_LIMIT = 2 * LIMIT  # A
SMALL = 1e-9  # of the largest residue: smaller ones belong to another axis


def compensator() -> reduced_observer.Compensator:
    """Return (33)-(35) at 800 Hz with the integrals of (31), certified by the library."""
    held = discretise.zero_order_hold(lqg.model(integrals=False), TIME.period_s)
    L = np.diag([(1 - OBSERVER_POLE[axis]) / TIME.period_s for axis in HORIZONTAL])
    observer = reduced_observer.from_gain(held, HORIZONTAL, L)
    integrals = interconnect.integrals(held, dict(zip(INTEGRALS, HORIZONTAL, strict=True)))
    return reduced_observer.compensator(observer, gain(), integrals)


def estimator() -> kalman.Estimator:
    """Return the full-order filter (40) of (26), driven by white accelerations."""
    W, V = [PROCESS_NOISE[a] for a in HORIZONTAL], [NOISE[a] ** 2 for a in HORIZONTAL]
    return kalman.kalmd(lqg.model(integrals=False), W, V, TIME.period_s, G=np.eye(6)[:, 3:])


def gain() -> Array:
    """Return K (3, 9) on the states of (26), then on the integrals."""
    return readonly(lqg.gain().K[:, [*PLANT, 3, 4, 5]])


def law(order: Order) -> StateSpace:
    """Return the compensator from the errors x, y, phi to the currents of MODES."""
    if order == "reduced":
        model = compensator().model
        return replace(model, C=readonly(TO_MODES @ model.C), D=readonly(TO_MODES @ model.D), outputs=MODES, units={})
    K, filter = gain(), estimator().predictor()
    on_u, on_q = filter.B[:, :3], filter.B[:, 3:]
    A = np.block([[filter.A + on_u @ K[:, :6], on_u @ K[:, 6:]], [np.zeros((3, 6)), np.eye(3)]])
    B, C = np.vstack([on_q, TIME.period_s * np.eye(3)]), TO_MODES @ K
    return StateSpace(A, B, C, np.zeros((3, 3)), (*filter.states, *INTEGRALS), HORIZONTAL, MODES, TIME)


def block(order: Order) -> Block:
    """Return a core from the errors x, y, phi to i_AQ, i_BQ, i_CQ."""
    whole = law(order)
    parts = [_compensator(whole, axis, mode) for axis, mode in zip(HORIZONTAL, ("i_x", "i_y", "i_phi"), strict=True)]
    rows = StateSpace(np.zeros((0, 0)), np.zeros((0, 3)), np.zeros((3, 0)), FROM_MODES, (), MODES, CURRENTS, TIME)
    modes = {part.outputs[0].name: part.outputs[0] for part in parts}
    most = MARGIN * np.abs(FROM_MODES) @ [modes[name].high for name in MODES]
    outputs = [Signal(name, "A", -high, high) for name, high in zip(CURRENTS, most.tolist(), strict=True)]
    last = linear_block.block("rows", rows, inputs=[modes[name] for name in MODES], outputs=outputs, tag="(26)")
    return compose(f"core_{order}", [*parts, last], inputs=HORIZONTAL, outputs=CURRENTS)


def _compensator(whole: StateSpace, axis: str, mode: str) -> Block:
    """Return the compensator from one error to its current, in modal form."""
    error = replace(POSITIONS[axis], about="less its set-point")
    poles, b, d = _modes(whole, axis, mode)
    stable = int(np.argmin(np.abs(poles)))
    pole, input_gain, integral_gain = poles[stable], b[stable], float(b[np.argmax(np.abs(poles))].real)
    size = MARGIN * (abs(input_gain.real) + abs(input_gain.imag)) * error.high / (1 - abs(pole.real) - abs(pole.imag))
    names: tuple[str, ...]
    if pole.imag:
        A = [[pole.real, -pole.imag, 0], [pole.imag, pole.real, 0], [0, 0, 1]]
        B, C, names = (
            [2 * input_gain.real, 2 * input_gain.imag, integral_gain],
            [1, 0, 1],
            ("real", "imaginary", "integral"),
        )
    else:
        A, B, C, names = [[pole.real, 0], [0, 1]], [input_gain.real, integral_gain], [1, 1], ("real", "integral")
    arrays = (readonly(A), readonly([[v] for v in B]), readonly([C]), readonly([[d]]))
    model = StateSpace(*arrays, names, (axis,), (mode,), TIME)
    bounds = {name: INTEGRAL_LIMIT if name == "integral" else 2 * size for name in names}
    states = [Signal(name, "A", -bounds[name], bounds[name]) for name in names]
    bound = MARGIN * (sum(abs(c) * bounds[name] for c, name in zip(C, names, strict=True)) + abs(d) * error.high)
    output = Signal(mode, "A", -bound, bound)
    return linear_block.block(axis, model, inputs=[error], outputs=[output], states=states, tag="(33), (40), (49)")


def _modes(whole: StateSpace, axis: str, mode: str) -> tuple[Array, Array, float]:
    """Return the observable poles (k,) from an error to its current, their residues b (k,), and d."""
    row, column = whole.outputs.index(mode), whole.inputs.index(axis)
    poles, V = np.linalg.eig(whole.A)
    residues = (whole.C[row] @ V) * np.linalg.solve(V, whole.B[:, column])
    observable = (np.abs(residues) > SMALL * np.abs(residues).max()) & (poles.imag >= 0)
    return poles[observable], residues[observable], float(whole.D[row, column])


def axis_estimator(axis: Axis) -> kalman.Estimator:
    """Return the full-order filter of position and rate, driven by white acceleration."""
    W, V = [PROCESS_NOISE[axis.name]], [NOISE[axis.name] ** 2]
    return kalman.kalmd(lqg.continuous(axis), W, V, TIME.period_s, G=[[0.0], [1.0]])


def full_order(plant: Plant, axis: Axis) -> Block:
    """Return the regulator of one axis with a Kalman filter of its position and rate."""
    kalman_filter, T, q = axis_estimator(axis), TIME.period_s, MEASURED[axis.name]
    per, force = lqg.per_position(axis.name), vertical.DEMAND[axis.name].unit.replace(" ", "/")
    constants = [
        Constant("position_gain", axis.k1, per, "(49): k1"),
        Constant("rate_gain", axis.k2, f"{per} s", "(49): k2"),
        Constant("M_position", float(kalman_filter.M[0, 0]), "1", "(40): M"),
        Constant("M_rate", float(kalman_filter.M[1, 0]), "1/s", "(40): M"),
        Constant("period", T, "s", "T"),
        Constant("B_position", axis.b * T**2 / 2, f"{q.unit}/{force}", "b T^2 / 2"),
        Constant("B_rate", axis.b * T, f"{q.unit}/s/{force}", "b T"),
    ]

    def estimate(u: Exprs, x: Exprs, k: Exprs) -> tuple[ca.SX, dict[str, ca.SX]]:
        innovation = ca.if_else(u[READY.name], u[q.name] - x["position"], 0)
        rate = x["rate"] + k["M_rate"] * innovation
        before = ca.if_else(u[READY.name], x["position"], u[q.name])
        position = before + k["M_position"] * innovation + k["period"] * rate + k["B_position"] * x["achieved"]
        after = {"position": position, "rate": rate + k["B_rate"] * x["achieved"]}
        return k["position_gain"] * (u[q.name] - position) - k["rate_gain"] * after["rate"], after

    predictions = [Signal("position", q.unit, q.low, q.high), Signal("rate", f"{q.unit}/s", -FASTEST, FASTEST)]
    states = [State(replace(s, about="predicted for this sample"), 0.0) for s in predictions]
    most = axis.k1 * 4 * q.high + axis.k2 * (FASTEST + 2 * float(kalman_filter.M[1, 0]) * q.high)
    return lqg.regulator(plant, axis, estimate, states, constants, 1.1 * most)


REGULATORS: Mapping[Order, Regulate] = {"reduced": lqg.reduced_order, "full": full_order}


def cost_table(experiments: Sequence[Experiment]) -> tuple[page.Block, ...]:
    """Return the cost of both orders for each installed compiler; nothing without a standstill to replay."""
    rest = [e.trajectory.measured for e in experiments if e.name == REST]
    rows = [row for measured in rest[:1] for row in _rows(measured)]
    columns = ("step", "order", "states", "operations", "build", "instructions, mean", "instructions, most")
    caption = f"The full order beside the reduced one: {STEPS} steps at rest, Cortex-M4F"
    return (show.Table(caption, columns, tuple(rows)),) if rows else ()


def _rows(measured: Columns) -> Iterator[tuple[show.Cell, ...]]:
    window = slice(SKIPPED, SKIPPED + STEPS)
    at_rest = {name: np.asarray(v)[window] for name, v in measured.items()}
    small_errors = {axis: ERROR * np.sin(np.arange(STEPS) + i) for i, axis in enumerate(HORIZONTAL)}
    for order in ORDERS:
        yield from _count_instructions("core alone, (33) and (40)", order, block(order), small_errors)
    for order in ORDERS:
        yield from _count_instructions(
            "whole controller", order, lqg.controller(planar_stage.plant(), regulate=REGULATORS[order]), at_rest
        )


def _count_instructions(what: str, order: Order, of: Block, inputs: Columns) -> Iterator[tuple[show.Cell, ...]]:
    from synth.verify import meter, steps

    emitted = write.emit(of, np.float32, error=interface.SURROGATE_ERROR[np.float32])
    recorded = steps.record(host.load(emitted.files, emitted.manifest), "at rest", dict(inputs), closed_loop=True)
    assert emitted.program is not None
    arithmetic = sum(cost.of_program(emitted.program).values())
    for row in meter.instructions(emitted, [recorded]):
        (n,) = row.counts
        yield what, order, len(of.states), arithmetic, row.build, float(n.mean()), int(n.max())
