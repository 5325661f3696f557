"""Scaling of emission with the number of axes: n axes in one Block, n = 1, 2, 4 .. 64.

    q_k - r_k --->[ filter_k ]---> e_k, de_k --->[ regulator_k ]---> w_k --->[ m_k w_k, limits ]---> i_k

Each axis is a derivative filter, an internal-model regulator and a limited current. All currents slew to a safe output
together. The fault word has 31 bits for inputs, too few for 64 axes, so only the first axis is guarded at every n. The
inputs of the others are assumed to be in their declared ranges. The C is compiled with STRICT_FLAGS, and one step from
each of many random states is compared with CasADi's evaluation of the Block.
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from time import process_time

import numpy as np

from synth.block import Block, Exprs, Step, build, clip
from synth.blocks.guard import safe_output, safety
from synth.blocks.laws import derivative_filter, regulator
from synth.composition import compose
from synth.emit import write
from synth.execute import compile as host_compiler
from synth.execute import host
from synth.signals import Signal
from synth.statespace import StateSpace, readonly
from synth.synthesise.feedback import lqr
from synth.synthesise.regulation import internal_model
from synth.timing import Continuous, Discrete
from synth.verify import agree, steps

COUNTS = (1, 2, 4, 8, 16, 32, 64)
TIME = Discrete(1e-3)
FREQUENCIES = (0.0, 30.0)  # rad/s
BANDWIDTH = 1000.0  # rad/s
WEIGHTS = (1500.0, 1500.0, 4.5e8, 2.25e6, 2.25e6)
BOUNDS = (600.0, 250.0, 500.0)  # m, of the internal model
STROKE, REACH, CURRENT = 0.1, 0.05, 5.0  # m, m, A
PER_ACCELERATION = 0.1  # A s^2/m
BAD_SAMPLES = 5
SAMPLES = 2000  # compared random steps
NEAR = 1e-3  # of a state's range: there the currents are not limited


@dataclass(frozen=True)
class Growth:
    """Emission of n axes: processor seconds to compose and to emit the Block, bytes and lines of C, the comparison.

    `worst` is the worst `disagreement`, in double.
    """

    axes: int
    composed_s: float
    emitted_s: float
    size: int
    lines: int
    worst: float


def block(n: int) -> Block:
    """Return the controller of n axes."""
    position = [Signal(f"q{k}", "m", -STROKE, STROKE, "position") for k in range(1, n + 1)]
    set_point = [Signal(f"r{k}", "m", -REACH, REACH, "set-point") for k in range(1, n + 1)]
    current = [Signal(f"i{k}", "A", -CURRENT, CURRENT, "current") for k in range(1, n + 1)]
    guarded = [safety.GuardedInput(position[0], 0.0, True), safety.GuardedInput(set_point[0], 0.0, False)]
    axes = [b for k in range(1, n + 1) for b in _axis(k)]
    parts = [safety.guard(TIME, guarded, BAD_SAMPLES), *axes, safe_output.block(TIME, current, safe(n))]
    inputs = [s.name for pair in zip(position, set_point, strict=True) for s in pair]
    return safety.frozen(compose(f"axes_{n}", parts, inputs=inputs, outputs=[s.name for s in current]))


def safe(n: int) -> safety.Safety:
    """Return the safe output of n currents after several bad samples of the first position."""
    names = [f"i{k}" for k in range(1, n + 1)]
    return safety.Safety(BAD_SAMPLES, dict.fromkeys(names, 0.0), dict.fromkeys(names, 50.0), "an example")


def emit(n: int, scalar: type[np.floating]) -> write.EmittedCode:
    """Return the C of n axes."""
    return write.emit(block(n), scalar)


def _axis(k: int) -> tuple[Block, ...]:
    """Return error, filter, regulator and limited current of one axis."""
    held = "_held" if k == 1 else ""
    q, r = Signal(f"q{k}{held}", "m", -STROKE, STROKE), Signal(f"r{k}{held}", "m", -REACH, REACH)
    error = Signal(f"e{k}", "m", q.low - r.high, q.high - r.low)
    fastest = (error.high - error.low) / TIME.period_s
    rate, demand = Signal(f"de{k}", "m/s", -fastest, fastest), Signal(f"w{k}", "m/s^2", -1e4, 1e4)
    computed = Signal(f"i{k}_computed", "A", -CURRENT, CURRENT)

    def difference(u: Exprs, x: Exprs, c: Exprs) -> Step:
        return Step({error.name: u[q.name] - u[r.name]})

    def limit(u: Exprs, x: Exprs, c: Exprs) -> Step:
        return Step({computed.name: clip(PER_ACCELERATION * u[demand.name], computed)})

    return (
        build(f"error_{k}", TIME, difference, inputs=[q, r], outputs=[error], tag="error"),
        derivative_filter.block(f"filter_{k}", TIME, error, rate, BANDWIDTH),
        regulator.block(
            f"regulator_{k}",
            TIME,
            _gain(),
            FREQUENCIES,
            error=error,
            rate=rate,
            demand=demand,
            bounds=BOUNDS,
            tag="internal model",
        ),
        build(f"current_{k}", TIME, limit, inputs=[demand], outputs=[computed], tag="limit"),
    )


@cache
def _gain() -> lqr.Gain:
    A, B, C, D = (readonly(m) for m in ([[0, 1], [0, 0]], [[0], [1]], [[1, 0]], [[0]]))
    integrator = StateSpace(A, B, C, D, ("e", "de"), ("w",), ("e",), Continuous())
    return lqr.lqr(internal_model.augmented(integrator, FREQUENCIES), np.diag(WEIGHTS), np.eye(1))


def measure_growth(n: int) -> Growth:
    """Compose, emit, compile strictly and compare n axes.

    Raises CompileError when the compiler warns.
    """
    start = process_time()
    controller = block(n)
    composed = process_time()
    single = write.emit(controller, np.float32)
    done = process_time()
    text = single.files[f"{controller.name}.c"]
    host_compiler.check(host.code(single.files))
    worst = disagreement(controller, write.emit(controller, np.float64))
    return Growth(n, composed - start, done - composed, len(text), text.count("\n"), worst)


def disagreement(controller_block: Block, double: write.EmittedCode) -> float:
    """Return the worst difference of the float64 C from CasADi's evaluation over random steps.

    Differences of outputs are relative to max(1 A, |i|), those of next states to their ranges.
    """
    controller = host.load(double.files, double.manifest)
    x = host.columns(steps.random_steps(controller, SAMPLES).states)
    for s in controller_block.states:
        if s.name.startswith(("filter", "regulator")):
            x[s.name][::2] *= NEAR  # elsewhere the limits hide differences
    # Only the first axis has a guard that keeps its inputs in range.
    u = host.columns(steps.in_range(controller, SAMPLES).inputs)
    expected, computed = agree.casadi(controller_block.rounded(np.float64))(x, u), agree.emitted_c(controller)(x, u)
    agreement = agree.compare("random steps", ("casadi", expected), ("c64", computed), 1.0, controller_block)
    return max(agreement.worst, agreement.state_worst)


def table() -> Iterator[str]:
    """Yield the table's lines, each when it has been measured."""
    names = ("axes", "compose, s", "emit, s", "s an axis", "C, bytes", "bytes an axis", "lines", "an axis", "worst")
    yield "  ".join(names)
    for n in COUNTS:
        g = measure_growth(n)
        cells = (
            *(str(n), f"{g.composed_s:.2f}", f"{g.emitted_s:.2f}", f"{g.emitted_s / n:.3f}"),
            *(str(g.size), f"{g.size / n:.0f}", str(g.lines), f"{g.lines / n:.1f}", f"{g.worst:.1e}"),
        )
        yield "  ".join(cell.rjust(len(name)) for cell, name in zip(cells, names, strict=True))


if __name__ == "__main__":
    for line in table():
        sys.stdout.write(f"{line}\n")
        sys.stdout.flush()
