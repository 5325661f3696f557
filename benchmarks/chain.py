"""Scaling of emission with the order of a dense law: LQG with integrators of n driven masses, n = 4, 8, 16, 24.

    |-- k --[m]-- k --[m]-- .. --[m]-- k --|        m q_i'' = k (q_i-1 - 2 q_i + q_i+1) + f_i,   q measured

The regulator has 3 n states: a Kalman filter's position and velocity of each mass, and the integral of its measurement.
It is one linear Block with some 12 n^2 coefficients, and from 8 masses on with tables of them. `lines` are those of the
C without the arrays of coefficients and the comments that name their rows and columns. The C is compiled with
STRICT_FLAGS, and one step from each of many random states is compared with CasADi's evaluation of the Block.

The guarded regulator has the guard of the measurements before it and the safe output behind it.
"""

import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from time import process_time

import numpy as np

from synth.block import Block
from synth.blocks.guard import safe_output, safety
from synth.blocks.laws import linear_block
from synth.composition import compose
from synth.emit import write
from synth.execute import compile as host_compiler
from synth.execute import host
from synth.signals import Signal
from synth.statespace import StateSpace, readonly
from synth.synthesise.feedback import lqr
from synth.synthesise.observers import kalman, lqg
from synth.timing import Continuous, Discrete
from synth.verify import agree, steps

COUNTS = (4, 8, 16, 24)
TIME = Discrete(1e-3)
MASS, STIFFNESS = 1.0, 400.0  # kg, N/m
WEIGHTS = (1e8, 1e2, 1e9)  # of position, velocity and integral, beside 1 of a force
NOISE = 1e-12  # m^2 s of a measurement, beside 1 N^2 s on each mass
BOUNDS = {"q": 0.01, "v": 1.0, "y": 0.001}  # m, m/s, m s
UNITS = {"q": "m", "v": "m/s", "y": "m s"}
FORCE, SLEW = 20.0, 1000.0  # N, N/s
MARGIN = 1.001  # of a computed force's range over its largest value
BAD_SAMPLES = 5
SAMPLES = 2000  # compared random steps
_TABLES = (
    re.compile(r"/\* A row for each of .*?\*/\n", re.S),
    re.compile(r"    static const \w+ matrix\[\d+\] = \{.*?\n    \};\n", re.S),
)


@dataclass(frozen=True)
class Growth:
    """Emission for n masses: processor seconds to compose and to emit the Block, lines and bytes of C, the comparison.

    `worst` is the worst `disagreement`, in double.
    """

    masses: int
    composed_s: float
    emitted_s: float
    lines: int
    size: int
    worst: float


@cache
def compensator(n: int) -> StateSpace:
    """Return the regulator of n masses, from the positions y to the forces f."""
    none, one = np.zeros((n, n)), np.eye(n)
    spring = STIFFNESS / MASS * (np.eye(n, k=1) + np.eye(n, k=-1) - 2 * one)
    A, B = np.block([[none, one], [spring, none]]), np.vstack([none, one / MASS])
    q, v, f, y = (tuple(f"{letter}{k}" for k in range(1, n + 1)) for letter in "qvfy")
    A, B, C, D = (readonly(M) for M in (A, B, np.hstack([one, none]), none))
    plant = StateSpace(A, B, C, D, (*q, *v), f, y, Continuous())
    gain = lqr.lqrd(lqr.with_integrators(plant, y), np.diag(np.repeat(WEIGHTS, n)), one, TIME.period_s)
    estimator = kalman.kalmd(plant, one, NOISE * one, TIME.period_s, G=B)
    return lqg.current(gain, estimator).compensator.select(f, y)


def block(n: int, measured: str = "", computed: str = "") -> Block:
    """Return the regulator of n masses as one linear Block, with these ends of its inputs' and outputs' names."""
    model = compensator(n)
    states = [Signal(name, UNITS[name[0]], -BOUNDS[name[0]], BOUNDS[name[0]], "estimate") for name in model.states]
    inputs = [Signal(f"{name}{measured}", "m", -BOUNDS["q"], BOUNDS["q"], "position") for name in model.inputs]
    most = MARGIN * np.abs(np.hstack([model.C, model.D])) @ [s.high for s in (*states, *inputs)]
    outputs = [
        Signal(f"{name}{computed}", "N", -high, high, "force")
        for name, high in zip(model.outputs, most.tolist(), strict=True)
    ]
    ends = tuple(s.name for s in inputs), tuple(s.name for s in outputs)
    model = StateSpace(model.A, model.B, model.C, model.D, model.states, ends[0], ends[1], TIME)
    return linear_block.block(f"chain_{n}", model, inputs=inputs, outputs=outputs, states=states, tag="LQG")


def guarded(n: int) -> Block:
    """Return the regulator of n masses behind a guard, with the safe output of its forces."""
    law = block(n, "_held", "_computed")
    position = [Signal(s.name.removesuffix("_held"), s.unit, s.low, s.high, s.about) for s in law.inputs]
    force = [Signal(s.name.removesuffix("_computed"), "N", -FORCE, FORCE, "force") for s in law.outputs]
    names = [s.name for s in force]
    safe = safety.Safety(BAD_SAMPLES, dict.fromkeys(names, 0.0), dict.fromkeys(names, SLEW), "an example")
    parts = [
        safety.guard(TIME, [safety.GuardedInput(s, 0.0, True) for s in position], BAD_SAMPLES),
        law,
        safe_output.block(TIME, force, safe),
    ]
    return safety.frozen(compose(f"guarded_{n}", parts, inputs=[s.name for s in position], outputs=names))


def emit(n: int, scalar: type[np.floating]) -> write.EmittedCode:
    """Return the C of n masses."""
    return write.emit(block(n), scalar)


def lines(text: str) -> int:
    """Return the lines of C beside arrays of coefficients and the comments on these."""
    for pattern in _TABLES:
        text = pattern.sub("", text)
    return text.count("\n")


def measure_growth(n: int) -> Growth:
    """Compose, emit, compile strictly and compare n masses.

    Raises CompileError when the compiler warns.
    """
    compensator(n)
    start = process_time()
    controller = block(n)
    composed = process_time()
    single = write.emit(controller, np.float32)
    done = process_time()
    text = single.files[f"{controller.name}.c"]
    host_compiler.check(host.code(single.files))
    worst = disagreement(controller, write.emit(controller, np.float64))
    return Growth(n, composed - start, done - composed, lines(text), len(text), worst)


def disagreement(controller_block: Block, double: write.EmittedCode) -> float:
    """Return the worst difference of the float64 C from CasADi's evaluation over random steps.

    Differences of outputs are relative to max(1 N, |f|), those of next states to their ranges.
    """
    controller = host.load(double.files, double.manifest)
    x = host.columns(steps.random_steps(controller, SAMPLES).states)
    u = host.columns(steps.in_range(controller, SAMPLES).inputs)
    expected, computed = agree.casadi(controller_block.rounded(np.float64))(x, u), agree.emitted_c(controller)(x, u)
    agreement = agree.compare("random steps", ("casadi", expected), ("c64", computed), 1.0, controller_block)
    return max(agreement.worst, agreement.state_worst)


def table() -> Iterator[str]:
    """Yield the table's lines, each when it has been measured."""
    names = ("masses", "states", "compose, s", "emit, s", "lines", "C, bytes", "worst")
    yield "  ".join(names)
    for n in COUNTS:
        g = measure_growth(n)
        cells = (str(n), str(3 * n), f"{g.composed_s:.2f}", f"{g.emitted_s:.2f}", str(g.lines), str(g.size))
        yield "  ".join(c.rjust(len(name)) for c, name in zip((*cells, f"{g.worst:.1e}"), names, strict=True))


if __name__ == "__main__":
    for line in table():
        sys.stdout.write(f"{line}\n")
        sys.stdout.flush()
