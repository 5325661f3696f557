"""Discrete-time blocks, x[k+1] = f(x[k], u[k]), y[k] = h(x[k], u[k]), with named signals (a Simulink subsystem).

    u --->[ x' = f(x, u, k) ]---> y          k: constants ("gains") that emission rounds to the target's scalar type
          [ y  = h(x, u, k) ]

Everything that runs in the loop is a Block. Each real state has declared bounds, which the step itself enforces: x'
lies in its box for every x in the box and every u.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from typing import TypeVar

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from synth import arguments, show
from synth import law as laws
from synth.errors import SignalError, TimingError
from synth.fault import LATCH_BIT, Failure, Fault, Safety
from synth.signals import Signal, identifier, signal_names
from synth.timing import Discrete

Exprs = Mapping[str, ca.SX]
Certificate = Callable[[float, float], float]
Value = TypeVar("Value")
_DOT = {ca.OP_INPUT, ca.OP_VERTCAT, ca.OP_DOT, ca.OP_OUTPUT}  # the instructions of a dot product


@arguments.checked
@dataclass(frozen=True)
class State:
    """A state of a Block: a signal and its value after `init`; `integer` marks counters and flags."""

    signal: Signal
    initial: float
    integer: bool = False

    def __post_init__(self) -> None:
        low, high = self.signal.low, self.signal.high
        if not low <= self.initial <= high:
            raise SignalError(
                f"state '{self.name}' starts at {self.initial}, outside its bounds {low} .. {high}: start it inside"
            )
        if self.integer and (low < 0 or self.initial != int(self.initial)):
            raise SignalError(
                f"integer state '{self.name}' starts at {self.initial} with the lower bound {low}: "
                "it counts up from 0, so start it at a whole number and bound it by 0 or more"
            )

    @property
    def name(self) -> str:
        """The signal's name."""
        return self.signal.name


@arguments.checked
@dataclass(frozen=True)
class Constant:
    """A constant of the controller, exact until emission rounds it; `source` names the origin of its value.

    A whole number has `of`: words in the names of the counts that it is compared with or given to. `parameters` are
    those of a plant that its value follows from. A number that `is_limit` is no factor and no term.
    """

    name: str
    value: float
    unit: str
    source: str
    of: tuple[str, ...] = ()
    parameters: tuple[str, ...] = ()
    is_limit: bool = False

    def __post_init__(self) -> None:
        identifier("constant", self.name)
        if not np.isfinite(self.value):
            raise SignalError(f"constant '{self.name}' is {self.value}: it must be finite; scale it for its type")
        if self.of and (self.value < 0 or self.value != int(self.value)):
            raise SignalError(f"constant '{self.name}' of a count is {self.value}: give a whole number, 0 or more")


@arguments.checked
@dataclass(frozen=True)
class ComputedSignal:
    """An output or internal signal, the Block that computes it, and the tag of its equation; see `Step`.

    `certificate` says how large a limited signal is before its limit. One that `is_internal` is no output of its Block.
    """

    signal: Signal
    block: str
    tag: str
    certificate: Certificate | None = None
    is_internal: bool = False


@arguments.checked
@show.result
class Block:
    """One discrete step, symbolic. `symbol` holds a scalar SX symbol for each input, state and constant.

    `computed_signals` are pairs of each internal signal or output and its expression. `safety` describes the step after
    a latch. `numbers` are those in the expressions that C names and `notes` sentences that it has, by the name of their
    Block, `labels` the names of expressions, and `functions` those for which the C has one, after the name of their
    Block. `failures` are rows of the datasheet's table, `tunable` states that hold
    constants, which change between steps alone, in `ramp` samples (`stage.tunable`).
    """

    name: str
    tag: str
    time: Discrete
    inputs: tuple[Signal, ...]
    outputs: tuple[Signal, ...]
    states: tuple[State, ...]
    constants: tuple[Constant, ...]
    symbol: Exprs
    output: Exprs
    next: Exprs
    computed_signals: tuple[tuple[ComputedSignal, ca.SX], ...] = ()
    faults: tuple[Fault, ...] = field(default=())
    safety: Safety | None = None
    numbers: tuple[tuple[str, Constant], ...] = ()
    labels: tuple[tuple[str, ca.SX], ...] = ()
    failures: tuple[Failure, ...] = ()
    notes: tuple[tuple[str, str], ...] = ()
    functions: tuple[laws.Function, ...] = ()
    tunable: tuple[str, ...] = ()
    ramp: int = 0

    def __post_init__(self) -> None:
        identifier("block", self.name)
        if not isinstance(self.time, Discrete):
            raise TimingError(f"block '{self.name}' runs in {self.time}: a step needs a period, give timing.Discrete")

    def sheet(self) -> show.Sheet:
        """Return the signals and states with their ranges."""
        groups = {"input": self.inputs, "output": self.outputs, "state": [s.signal for s in self.states]}
        title = f"Block {self.name}, {self.time}: {len(self.constants)} constants"
        return show.Sheet(title, (self.tag,) if self.tag else (), (show.signals(groups),))

    def rounded(self, scalar: type[np.floating]) -> "Block":
        """Return the Block with each constant rounded to `scalar`, the values that the C has.

        Raises SignalError for a constant that becomes 0 or infinite.
        """
        with np.errstate(over="ignore"):  # an overflow is infinite, which a Constant refuses
            constants = tuple(replace(c, value=float(scalar(c.value))) for c in self.constants)
        for c, rounded in zip(self.constants, constants, strict=True):
            if c.value and not rounded.value:
                raise SignalError(f"constant '{c.name}' is {c.value:g}, which is 0 in {np.dtype(scalar)}: scale it")
        held = {*self.tunable}
        states = (replace(s, initial=float(scalar(s.initial))) if s.name in held else s for s in self.states)
        return replace(self, constants=constants, states=tuple(states))

    def renamed(self, names: Mapping[str, str]) -> "Block":
        """Return the Block with inputs and outputs renamed, old name to new; other names stay."""
        inputs = [s.name for s in self.inputs]
        return replace(
            self,
            inputs=tuple(_signal(names, s) for s in self.inputs),
            outputs=tuple(_signal(names, s) for s in self.outputs),
            symbol=_under({n: new for n, new in names.items() if n in inputs}, self.symbol),
            output=_under(names, self.output),
            computed_signals=tuple((replace(n, signal=_signal(names, n.signal)), e) for n, e in self.computed_signals),
            faults=tuple(f.renamed(names) for f in self.faults),
            failures=tuple(f.renamed(names) for f in self.failures),
            safety=self.safety and self.safety.renamed(names),
        )

    @property
    def latches(self) -> bool:
        """Whether one bit of the fault word says that it has latched."""
        return any(f.bit == LATCH_BIT for f in self.faults)

    @property
    def initial(self) -> NDArray[np.float64]:
        """The states after `init`, in order."""
        return np.array([s.initial for s in self.states], dtype=np.float64)

    def function(self, gains: Sequence[str] = ()) -> ca.Function:
        """Return the step as a CasADi function (x, u) -> (x', y), columns in the order of the signals.

        With names of constants in `gains` it is (x, u, k) -> (x', y): k are their values, to differentiate by.

        Raises SignalError for a name that is not a constant of the Block.
        """
        if unknown := [n for n in gains if n not in [c.name for c in self.constants]]:
            known = ", ".join(c.name for c in self.constants) or "none"
            raise SignalError(f"block '{self.name}' has no constant '{unknown[0]}': name some of {known}")
        x, u = self._columns(s.name for s in self.states), self._columns(s.name for s in self.inputs)
        next = ca.vcat([self.next[s.name] for s in self.states])
        y = ca.vcat([self.output[s.name] for s in self.outputs])
        fixed = [c for c in self.constants if c.name not in gains]
        symbols, values = [self.symbol[c.name] for c in fixed], [ca.SX(c.value) for c in fixed]
        next, y = ca.substitute([next, y], symbols, values) if symbols else (next, y)
        k = {"k": self._columns(gains)} if gains else {}
        return ca.Function(self.name, [x, u, *k.values()], [next, y], ["x", "u", *k], ["x_next", "y"])

    def _columns(self, names: Iterable[str]) -> ca.SX:
        return ca.vcat([self.symbol[name] for name in names])


@arguments.checked
@dataclass(frozen=True, eq=False)
class Step:
    """The result of a law: outputs, next values of the states, and further signals with a name.

    `certified` gives for outputs and named signals that are limited to +-h a function (u, e) to how large they are
    before the limit while all inputs are in range, as computed with an error of u relative to the result of each
    operation and of e relative to that of each sine and cosine, infinite where libm computes these. Where that is h or
    less, emission leaves the limit out. `numbers` are values in the expressions with name and unit, `notes` sentences.
    """

    output: Exprs
    next: Exprs = field(default_factory=dict)
    named: Sequence[tuple[Signal, ca.SX]] = ()
    certified: Mapping[str, Certificate] = field(default_factory=dict)
    numbers: Sequence[Constant] = ()
    notes: Sequence[str] = ()


Law = Callable[[Exprs, Exprs, Exprs], Step]


@arguments.checked
def build(
    name: str,
    time: Discrete,
    law: Law,
    *,
    inputs: Sequence[Signal],
    outputs: Sequence[Signal],
    states: Sequence[State] = (),
    constants: Sequence[Constant] = (),
    tag: str = "",
) -> Block:
    """Make a Block from `law(u, x, k) -> Step`, clamping each real state to its declared bounds.

    Raises SignalError for a name that is listed twice, an output or a next state that is missing or not declared, an
    expression with a symbol of another Block, and a law that needs the value of a symbol, as `if` does.
    """
    for group in ((*inputs, *outputs), tuple(s.signal for s in states)):
        signal_names(group)
    private = [s.name for s in states] + [c.name for c in constants]
    read = [*(s.name for s in inputs), *private]
    if twice := [n for k, n in enumerate(read) if n in read[:k]]:
        raise SignalError(
            f"block '{name}': two of its inputs, states and constants are called '{twice[0]}': rename one"
        )
    symbol = {n: ca.SX.sym(n) for n in read}
    u, x, k = (
        _pick(name, "inputs", symbol, inputs),
        _pick(name, "states", symbol, states),
        _pick(name, "constants", symbol, constants),
    )
    step, labels, functions = laws.record(laws.evaluate, f"the law of block '{name}'", law, u, x, k)
    functions = tuple(replace(f, path=f"{name}.{f.path}") for f in functions)
    if not isinstance(step, Step):
        raise SignalError(f"the law of block '{name}' returns {arguments.describe(step)}: return a Step")
    laws.require_names(f"block '{name}': outputs", [s.name for s in outputs], step.output)
    laws.require_names(f"block '{name}': next states", [s.name for s in states], step.next)
    advanced = {s.name: ca.SX(step.next[s.name]) for s in states}
    next = {s.name: advanced[s.name] if s.integer else clip(advanced[s.name], s.signal) for s in states}
    output = {s.name: ca.SX(step.output[s.name]) for s in outputs}
    laws.check_numbers(f"block '{name}'", {**output, **advanced}, symbol.values())
    certified = step.certified.get
    computed = [(ComputedSignal(s, name, tag, certified(s.name), True), ca.SX(expr)) for s, expr in step.named]
    computed += [(ComputedSignal(s, name, tag, certified(s.name)), output[s.name]) for s in outputs]
    laws.check_symbols(f"block '{name}'", [*next.values(), *(e for _, e in computed)], symbol.values())
    declared = tuple(inputs), tuple(outputs), tuple(states), tuple(constants)
    numbers, notes = tuple((name, n) for n in step.numbers), tuple((name, n) for n in step.notes)
    of_functions = [e for f in functions for e in (*f.arguments, *f.results)]
    laws.check_symbols(f"block '{name}'", [*(e for _, e in labels), *of_functions], symbol.values())
    return Block(
        name, tag, time, *declared, symbol, output, next, tuple(computed),
        numbers=numbers, labels=labels, notes=notes, functions=functions,
    )  # fmt: skip


@arguments.checked
def unranged(block: Block) -> Block:
    """Return the Block with outputs of any finite value in single precision.

    Emission then proves no range of these outputs: use it to inspect inner signals on the host, not to drive hardware.
    """
    any_value = float(np.finfo(np.float32).max)
    return replace(block, outputs=tuple(replace(s, low=-any_value, high=any_value) for s in block.outputs))


@arguments.checked
def clip(expr: ca.SX, bounds: Signal) -> ca.SX:
    """Return `expr` limited to the range of `bounds`."""
    return ca.fmax(ca.fmin(expr, bounds.high), bounds.low)


@arguments.checked
def table(name: str, values: Sequence[float]) -> ca.Function:
    """Return index -> value: numbers that a law looks up by a whole index in 0 .. len(values) - 1, an SX expression.

    Emission writes them as an array of constants, and only where it proves that no index leaves it.

    Raises SignalError for a name that C or CasADi does not allow, fewer than two values, or one that is not finite.
    """
    identifier("table", name)
    if not ca.Function.check_name(name):
        raise SignalError(f"table name '{name}' has a meaning in CasADi, or two underscores in a row: rename it")
    if len(values) < 2 or not np.isfinite(values).all():
        raise SignalError(
            f"table '{name}' has {len(values)} values, too few or not all finite: give two or more numbers"
        )
    index = ca.MX.sym("index")
    return ca.Function(name, [index], [ca.MX(ca.DM(list(values)))[index]], {"never_inline": True})


@arguments.checked
def dot(coefficients: Sequence[ca.SX], values: Sequence[ca.SX]) -> ca.SX:
    """Return k_1 x_1 + k_2 x_2 + .. + k_n x_n, rounded from left to right, as one operation of a law.

    Emission writes the rows of constants that a Block multiplies by the same values as one array and a loop. Anything
    else becomes products and sums.

    Raises SignalError for other than two or more coefficients with a value each.
    """
    if len(coefficients) != len(values) or len(values) < 2:
        raise SignalError(
            f"a dot product of {len(coefficients)} coefficients and {len(values)} values: give two or more of each"
        )
    return _dot(len(values))(*coefficients, *values)


@arguments.checked
def is_dot(function: ca.Function) -> bool:
    """Tell whether a function that an expression calls is a dot product."""
    return (
        function.is_a("MXFunction") and {function.instruction_id(k) for k in range(function.n_instructions())} == _DOT
    )


@cache
def _dot(n: int) -> ca.Function:
    symbols = [ca.MX.sym(f"{letter}_{k}") for letter in "kx" for k in range(n)]
    total = ca.dot(ca.vertcat(*symbols[:n]), ca.vertcat(*symbols[n:]))
    return ca.Function(f"dot_{n}", symbols, [total], {"never_inline": True})


def _signal(names: Mapping[str, str], signal: Signal) -> Signal:
    return replace(signal, name=names.get(signal.name, signal.name))


def _under(names: Mapping[str, str], of: Mapping[str, Value]) -> dict[str, Value]:
    """Return values under their new names."""
    return {names.get(name, name): value for name, value in of.items()}


def _pick(name: str, kind: str, symbol: Exprs, signals: Sequence[Signal | State | Constant]) -> Exprs:
    return laws.NamedSymbols(f"among its {kind} block '{name}'", {s.name: symbol[s.name] for s in signals})
