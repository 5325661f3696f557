"""Random Blocks in dyadic arithmetic, where no scalar type rounds, and the C of many of them in one library.

A value is m 2^-places with |m| 2^-places <= bound; what would need more than BITS bits is not drawn. The Blocks are full
of what a scheduler can get wrong: few conditions for many choices, choices that carry on earlier ones, states that hold,
swap, are read by later signals or go straight to an output, and names that the C needs for itself.
"""

import ctypes
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from synth.block import Block, Constant, Fault, State, Step, build
from synth.compose import compose
from synth.emit.write import Emitted, emit
from synth.execute import compile as compiler
from synth.execute import host
from synth.signals import Signal
from synth.timing import Discrete

TIME = Discrete(1e-3)
SX = ca.SX
BITS = 20
REALS, BOUND, PLACES = ("r", "s", "q"), 8, 3
TOP = 7  # of the counter
AWKWARD = (
    "limit t1 t2 t3 t4 faults min max state in out faults_2 t1_2 sinf fabsf limit_2 r_next n_next y1 j0 "
    "uint32_t init step main rb"
).split()


def signal(name: str, low: float = -1e6, high: float = 1e6) -> Signal:
    return Signal(name, "1", low, high)


@dataclass(frozen=True)
class Value:
    """An expression, the bound of its absolute value, and its binary places."""

    e: SX
    bound: float
    places: int

    @property
    def exact(self) -> bool:
        return self.bound * 2.0**self.places < 2**BITS


@dataclass
class Draw:
    """What has been drawn for one Block so far."""

    rng: np.random.Generator
    x: Mapping[str, SX]
    pool: list[Value]
    spare: list[Value]  # read once at most
    conditions: list[SX] = field(default_factory=list)

    def one(self, count: int) -> int:
        return int(self.rng.integers(count))

    def value(self) -> Value:
        """Return a value, a recent one as often as any."""
        recent = self.rng.random() < 0.4
        return self.pool[-1 - self.one(min(6, len(self.pool)))] if recent else self.pool[self.one(len(self.pool))]

    def condition(self) -> SX:
        """Return a condition, mostly one of the few that are used already."""
        if self.conditions and self.rng.random() < 0.9:
            return self.conditions[self.one(len(self.conditions))]
        a, b = self.value().e, self.value().e
        made = [a < b, a <= b, a == b, a != b, a][self.one(5)]
        self.conditions.append(made)
        return made

    def operation(self) -> Value:
        a, b = self.value(), self.value()
        top, places = max(a.bound, b.bound), max(a.places, b.places)
        kind = self.one(18)
        if kind < 8:
            return Value(ca.if_else(self.condition(), a.e, b.e), top, places)
        if kind == 8:
            return Value(self.logic(), 1, 0)
        return [
            Value(ca.if_else(self.condition(), a.e, 0), a.bound, a.places),
            Value(a.e + b.e, a.bound + b.bound, places),
            Value(a.e - b.e, a.bound + b.bound, places),
            Value(a.e * b.e, a.bound * b.bound, a.places + b.places),
            Value(ca.fmin(a.e, b.e), top, places),
            Value(ca.fmax(ca.fmin(a.e, b.e), -b.e), top, places),
            Value(-a.e, a.bound, a.places),
            Value(ca.fabs(a.e), a.bound, a.places),
            Value(a.e / 4, a.bound / 4, a.places + 2),
        ][kind - 9]

    def group(self) -> list[Value]:
        """Return choices on one condition: one has something to compute, others carry on what there is."""
        c, made = self.condition(), [self.operation() for _ in range(3)]
        arms = [
            (made[0], made[1]),
            (made[2], self.value()),
            *((self.value(), self.value()) for _ in range(self.one(3))),
        ]
        if self.spare and self.rng.random() < 0.3:
            arms.append((self.value(), self.spare.pop()))
        arms = [pair[:: 1 if self.rng.random() < 0.5 else -1] for pair in arms]
        return [
            Value(ca.if_else(c, a.e, b.e), max(a.bound, b.bound), max(a.places, b.places))
            for a, b in (arms[i] for i in self.rng.permutation(len(arms)))
        ]

    def carried(self) -> list[Value]:
        """Return choices that carry on another one, which nothing else reads."""
        c, d, made = self.condition(), self.condition(), [self.operation() for _ in range(6)]
        first = ca.if_else(c, made[0].e, made[1].e)
        other = [lambda: ca.if_else(d, made[2].e, first), lambda: ca.if_else(d, first + made[2].e, self.value().e)]
        top, places = max(v.bound for v in made), max(v.places for v in made)
        return [
            Value(ca.if_else(c, made[3].e, made[4].e), top, places),
            Value(ca.if_else(d, made[5].e, first), top, places),
            Value(other[self.one(2)](), 2 * top + 16, places + 2),
        ]

    def logic(self) -> SX:
        a, b = self.condition(), self.condition()
        made = [ca.logic_and(a, b), ca.logic_or(a, b), ca.logic_not(a)][self.one(3)]
        self.conditions.append(made)
        return made

    def real(self) -> SX:
        """Return a value that a real state can hold; mostly one that needs no limit."""
        while True:
            v = self.value()
            if v.places <= PLACES and (v.bound <= BOUND or self.rng.random() < 0.1):
                return v.e

    def next_real(self, own: SX) -> SX:
        c, d = self.condition(), self.condition()
        return [
            lambda: own,
            lambda: self.x[REALS[self.one(len(REALS))]],
            lambda: ca.if_else(c, own, self.real()),
            lambda: ca.if_else(c, self.real(), own),
            lambda: ca.if_else(c, self.real(), ca.if_else(d, own, self.real())),
            self.real,
            self.real,
        ][self.one(7)]()

    def next_count(self) -> SX:
        n, c = self.x["n"], self.condition()
        whole = next((v.e for v in (self.value() for _ in range(20)) if v.places == 0), n)
        return [
            n,
            ca.fmin(n + 1, TOP),
            ca.fmax(n - 1, 0),
            ca.if_else(c, ca.fmin(n + 1, TOP), 0),
            ca.if_else(c, TOP, ca.if_else(n <= 1, n, n - 1)),
            ca.if_else(c, self.x["f"], n),
            ca.fmax(ca.fmin(whole, TOP), 0),
        ][self.one(7)]

    def next_flag(self) -> SX:
        f, c = self.x["f"], self.condition()
        return [f, c != 0, ca.if_else(c, 1, f), ca.if_else(c, f, 0), ca.logic_not(f)][self.one(5)]


def part(
    rng: np.random.Generator, name: str, inputs: Sequence[Signal], outputs: Sequence[str], named: list[str]
) -> Block:
    """Return a random Block; up to all of `named` become names of intermediate signals."""

    def law(u: Mapping[str, SX], x: Mapping[str, SX], k: Mapping[str, SX]) -> Step:
        pool = [Value(u[s.name], s.high, 2 if s.high == 4 else PLACES) for s in inputs if s.name != "v"]
        pool += [Value(x[n], BOUND, PLACES) for n in REALS] + [Value(x["n"], TOP, 0), Value(x["f"], 1, 0)]
        pool += [Value(SX(v), abs(v), 1) for v in (0.0, 1.0, -0.5, 3.0)] + [Value(v, 2, 2) for v in k.values()]
        d = Draw(rng, x, pool, [Value(e, BOUND, PLACES) for e in (x["g"], u.get("v", x["g"]))])
        d.conditions += [d.value().e < d.value().e for _ in range(d.one(3) + 1)] + [x["f"]]
        for _ in range(d.one(12) + 4):
            kind = d.one(10)
            d.pool += [v for v in (d.group() if kind < 2 else d.carried() if kind < 4 else [d.operation()]) if v.exact]
        made = {n: d.real() for n in outputs} | {f"flag_{name}": d.condition() != 0}
        next = {n: d.next_real(x[n]) for n in REALS} | {"g": d.real(), "n": d.next_count(), "f": d.next_flag()}
        if rng.random() < 0.3:
            next |= {"r": made[outputs[0]]}
        return Step(made, next, [(signal(n), d.value().e) for n in named[: d.one(len(named) + 1)]])

    states = [State(signal(n, -BOUND, BOUND), 0.25 * i) for i, n in enumerate((*REALS, "g"))]
    states += [State(signal("n", 0, TOP), 2, True), State(signal("f", 0, 1), 0, True)]
    outs = [signal(n, -BOUND, BOUND) for n in outputs] + [signal(f"flag_{name}", 0, 1)]
    constants = [Constant("k", 1.25, "1", "test"), Constant("kk", -0.5, "1", "test")]
    return build(name, TIME, law, inputs=inputs, outputs=outs, states=states, constants=constants, tag=f"law of {name}")


def drawn(seed: int) -> Block:
    """Return a random Block: one, or three wired to each other; with two faults."""
    rng = np.random.default_rng(seed)
    names = list(rng.permutation(AWKWARD)) if seed % 3 == 0 else [f"m{i}" for i in range(len(AWKWARD))]
    given = [signal(n, -4, 4) for n in (names[:3] if seed % 2 else ("a", "b", "c"))]
    if seed % 4 < 2:
        block = part(rng, "rb", given, ["y", "z", "w"], names[3:12])
        last = "rb"
    else:
        link = {n: signal(n, -BOUND, BOUND) for n in ("y", "z", "w", "v")}
        first = part(rng, "one", given, ["y", "z"], names[3:7])
        second = part(rng, "two", [*given[:1], link["y"], link["v"]], ["w"], names[7:10])
        third = build("hold", TIME, _hold, inputs=[link["z"]], outputs=[link["v"]], states=[State(link["v"], 1)])
        wired = [(first, second, third)[i] for i in rng.permutation(3)]
        block = compose(
            "rb", wired, inputs=[s.name for s in given], outputs=["w", "y", "z", "v", "flag_one", "flag_two"]
        )
        last = "two"
    first_flag = "flag_one" if last == "two" else "flag_rb"
    faults = (Fault(int(rng.integers(31)), first_flag, None), Fault(31, f"flag_{last}", None))
    return replace(block, name=f"rb{seed}", faults=faults)


def _hold(u: Mapping[str, SX], x: Mapping[str, SX], k: Mapping[str, SX]) -> Step:
    return Step({"v": x["v"]}, {"v": u["z"]})


def samples(block: Block, count: int, seed: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return states (states, count) and inputs (inputs, count) of a drawn Block: all dyadic, often equal."""
    rng = np.random.default_rng(seed)
    rows = []
    for s in block.states:
        step = 1 if s.integer else 2.0**-PLACES
        rows.append(rng.integers(int(s.signal.low / step), int(s.signal.high / step) + 1, count) * step)
    u = rng.integers(-16, 17, (len(block.inputs), count)) / 4
    return np.array(rows).reshape(len(block.states), count), u


@dataclass(frozen=True)
class Advance:
    """What one step makes of each sample: next states and outputs (rows, samples) by name, and the fault words."""

    next: dict[str, NDArray[Any]]
    outputs: dict[str, NDArray[Any]]
    word: NDArray[np.uint32]

    def unlike(self, other: "Advance") -> list[str]:
        """Return what differs: names of next states, of outputs, and "faults"."""
        found = [f"next {n}" for n in self.next if not np.array_equal(self.next[n], other.next[n])]
        found += [n for n in self.outputs if not np.array_equal(self.outputs[n], other.outputs[n])]
        return found + ([] if np.array_equal(self.word, other.word) else ["faults"])


def by_casadi(block: Block, x: NDArray[np.float64], u: NDArray[np.float64]) -> Advance:
    """Evaluate CasADi's function of the Block; the fault word is put together from its flags."""
    next, y = (m.full() for m in block.function()(x, u))
    outputs = {s.name: y[i] for i, s in enumerate(block.outputs)}
    word = np.zeros(x.shape[1], np.uint32)
    for f in block.faults:
        word |= (outputs[f.output] != 0).astype(np.uint32) << np.uint32(f.bit)
    return Advance({s.name: next[i] for i, s in enumerate(block.states)}, outputs, word)


@dataclass(frozen=True)
class Library:
    """The C of several designs, compiled together."""

    library: ctypes.CDLL

    def advance(self, block: Block, made: Emitted, x: NDArray[np.float64], u: NDArray[np.float64]) -> Advance:
        """Take one step of a Block's C from each state."""
        count = x.shape[1]
        state, given, out = (np.zeros(count, host.dtype(r, made.manifest)) for r in ("state", "input", "output"))
        for records, rows, signals in ((state, x, block.states), (given, u, block.inputs)):
            for s, row in zip(signals, rows, strict=True):
                records[s.name] = row
        step = self.library[made.manifest["functions"]["step"]]
        step.restype, step.argtypes = ctypes.c_uint32, [ctypes.c_void_p] * 3
        word = [step(*(a.ctypes.data + k * a.itemsize for a in (state, given, out))) for k in range(count)]
        names = [s.name for s in block.states], [s.name for s in block.outputs]
        columns = ({n: records[n] for n in wanted} for records, wanted in zip((state, out), names, strict=True))
        return Advance(*columns, np.array(word, np.uint32))


def together(made: Sequence[Emitted]) -> Library:
    """Compile the C of designs with names of their own; warnings are errors."""
    files = {name: text for e in made for name, text in host.code(e.files).items()}
    return Library(ctypes.CDLL(str(compiler.shared_library(files, ["-O1", *compiler.STRICT_FLAGS]))))


def wrong(blocks: Sequence[Block], scalar: type[np.floating], count: int = 200) -> dict[str, list[str]]:
    """Emit, compile and step Blocks; return by name what differs from CasADi."""
    made = [emit(b, scalar) for b in blocks]
    library, found = together(made), {}
    for b, e in zip(blocks, made, strict=True):
        x, u = samples(b, count, 1)
        if different := library.advance(b, e, x, u).unlike(by_casadi(b, x, u)):
            found[b.name] = different
    return found


Change = Callable[[str], str]
