"""Random Blocks in dyadic arithmetic, where no scalar type rounds: any difference from CasADi is a defect.

A value is m 2^-places with |m| 2^-places <= bound; no value that needs more than BITS bits is drawn. The Blocks contain
many cases that a scheduler can get wrong: few conditions for many choices, choices that start from earlier ones, states
that hold, swap, are read by later signals or feed through to an output, and names that the C reserves.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from synth.block import Block, Constant, Fault, Safety, State, Step, build
from synth.composition import compose
from synth.signals import Signal
from synth.timing import Discrete

TIME = Discrete(1e-3)
SX = ca.SX
BITS = 20
REALS, BOUND, PLACES = ("r", "s", "q"), 8, 3
WIDE = 1024.0  # no output leaves it
TOP = 7  # of the counter
AWKWARD = ["limit", "t1", "t2", "t3", "t4", "faults", "min", "max", "state", "in", "out", "faults_2", "t1_2", "sinf"]
AWKWARD += ["fabsf", "limit_2", "r_next", "n_next", "y1", "j0", "uint32_t", "init", "step", "main", "rb"]


def signal(name: str, low: float = -1e6, high: float = 1e6) -> Signal:
    return Signal(name, "1", low, high)


@dataclass(frozen=True)
class Value:
    """An expression, the bound of its absolute value, and its binary places."""

    e: SX
    bound: float
    places: int

    def exact(self, bits: int = BITS) -> bool:
        return self.bound * 2.0**self.places < 2**bits


@dataclass
class Draw:
    """A generator of random expressions for one Block, with the values and conditions drawn so far."""

    rng: np.random.Generator
    x: Mapping[str, SX]
    pool: list[Value]
    single_use: list[Value]  # read once at most
    conditions: list[SX] = field(default_factory=list)

    def one(self, count: int) -> int:
        return int(self.rng.integers(count))

    def value(self) -> Value:
        """Return a random value; with a probability of 0.4 one of the last six."""
        recent = self.rng.random() < 0.4
        return self.pool[-1 - self.one(min(6, len(self.pool)))] if recent else self.pool[self.one(len(self.pool))]

    def condition(self) -> SX:
        """Return a condition, in most cases one that is already used."""
        if self.conditions and self.rng.random() < 0.9:
            return self.conditions[self.one(len(self.conditions))]
        a, b = self.value().e, self.value().e
        made = [a < b, a <= b, a == b, a != b, a][self.one(5)]
        self.conditions.append(made)
        return made

    def operation(self) -> Value:
        a, b = self.value(), self.value()
        kind = self.one(16)
        if kind < 6:
            return choose(self.condition(), a, b)
        if kind == 6:
            return Value(self.logic(), 1, 0)
        return combine(kind - 7, a, b, self.condition())

    def logic(self) -> SX:
        a, b = self.condition(), self.condition()
        made = [ca.logic_and(a, b), ca.logic_or(a, b), ca.logic_not(a)][self.one(3)]
        self.conditions.append(made)
        return made

    def group(self) -> list[Value]:
        """Return choices on one condition: one computes new values in its arms, others select existing values."""
        c, made = self.condition(), [self.operation() for _ in range(3)]
        arms = [
            (made[0], made[1]),
            (made[2], self.value()),
            *((self.value(), self.value()) for _ in range(self.one(3))),
        ]
        if self.single_use and self.rng.random() < 0.3:
            arms.append((self.value(), self.single_use.pop()))
        return [choose(c, *arms[i][:: 1 if self.rng.random() < 0.5 else -1]) for i in self.rng.permutation(len(arms))]

    def chained(self) -> list[Value]:
        """Return choices that start from another choice, which no other value reads."""
        c, d, made = self.condition(), self.condition(), [self.operation() for _ in range(6)]
        first = choose(c, made[0], made[1])
        last = [choose(d, made[2], first), choose(d, combine(1, first, made[2], d), self.value())]
        return [choose(c, made[3], made[4]), choose(d, made[5], first), last[self.one(2)]]

    def real(self) -> SX:
        """Return a value with the resolution of a real state; in most cases one that needs no limit."""
        while True:
            v = self.value()
            if v.places <= PLACES and (v.bound <= BOUND or self.rng.random() < 0.1):
                return v.e

    def next_real(self, state: SX) -> SX:
        c, d = self.condition(), self.condition()
        return [
            lambda: state,
            lambda: self.x[REALS[self.one(len(REALS))]],
            lambda: ca.if_else(c, state, self.real()),
            lambda: ca.if_else(c, self.real(), state),
            lambda: ca.if_else(c, self.real(), ca.if_else(d, state, self.real())),
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


def choose(c: SX, a: Value, b: Value) -> Value:
    return Value(ca.if_else(c, a.e, b.e), max(a.bound, b.bound), max(a.places, b.places))


def combine(kind: int, a: Value, b: Value, c: SX) -> Value:
    """Return one of nine combinations."""
    top, places = max(a.bound, b.bound), max(a.places, b.places)
    return [
        Value(ca.if_else(c, a.e, 0), a.bound, a.places),
        Value(a.e + b.e, a.bound + b.bound, places),
        Value(a.e - b.e, a.bound + b.bound, places),
        Value(a.e * b.e, a.bound * b.bound, a.places + b.places),
        Value(ca.fmin(a.e, b.e), top, places),
        Value(ca.fmax(ca.fmin(a.e, b.e), -b.e), top, places),
        Value(-a.e, a.bound, a.places),
        Value(ca.fabs(a.e), a.bound, a.places),
        Value(a.e / 4, a.bound / 4, a.places + 2),
    ][kind]


def random_law(
    rng: np.random.Generator, name: str, inputs: Sequence[Signal], outputs: Sequence[str], named: list[str]
) -> Block:
    """Return a random Block; up to all of `named` become names of intermediate signals. An input `v` is read once."""

    def law(u: Mapping[str, SX], x: Mapping[str, SX], k: Mapping[str, SX]) -> Step:
        pool = [Value(u[s.name], s.high, 2 if s.high == 4 else PLACES) for s in inputs if s.name != "v"]
        pool += [Value(x[n], BOUND, PLACES) for n in REALS] + [Value(x["n"], TOP, 0), Value(x["f"], 1, 0)]
        pool += [Value(SX(v), abs(v), 1) for v in (0.0, 1.0, -0.5, 3.0)] + [Value(v, 2, 2) for v in k.values()]
        d = Draw(rng, x, pool, [Value(e, BOUND, PLACES) for e in (x["g"], u.get("v", x["g"]))])
        d.conditions += [d.value().e < d.value().e for _ in range(d.one(3) + 1)] + [x["f"]]
        for _ in range(d.one(12) + 4):
            kind = d.one(10)
            made = d.group() if kind < 2 else d.chained() if kind < 4 else [d.operation()]
            d.pool += [v for v in made if v.exact()]
        y = {n: d.real() for n in outputs} | {f"flag_{name}": d.condition() != 0}
        next = {n: d.next_real(x[n]) for n in REALS} | {"g": d.real(), "n": d.next_count(), "f": d.next_flag()}
        if rng.random() < 0.3:
            next |= {"r": y[outputs[0]]}
        return Step(y, next, [(signal(n), d.value().e) for n in named[: d.one(len(named) + 1)]])

    states = [State(signal(n, -BOUND, BOUND), 0.25 * i) for i, n in enumerate((*REALS, "g"))]
    states += [State(signal("n", 0, TOP), 2, True), State(signal("f", 0, 1), 0, True)]
    outs = [signal(n, -WIDE, WIDE) for n in outputs] + [signal(f"flag_{name}", 0, 1)]
    constants = [Constant("k", 1.25, "1", "test"), Constant("kk", -0.5, "1", "test")]
    return build(name, TIME, law, inputs=inputs, outputs=outs, states=states, constants=constants, tag=f"law of {name}")


def random_block(seed: int) -> Block:
    """Return a random Block with two faults: a single law, or a composition of three."""
    rng = np.random.default_rng(seed)
    names = [str(n) for n in rng.permutation(AWKWARD)] if seed % 3 == 0 else [f"m{i}" for i in range(len(AWKWARD))]
    inputs = [signal(n, -4, 4) for n in (names[:3] if seed % 2 else ("a", "b", "c"))]
    if seed % 4 < 2:
        block, flags = random_law(rng, "rb", inputs, ["y", "z", "w"], names[3:12]), ("flag_rb", "flag_rb")
    else:
        link = {n: signal(n, -BOUND, BOUND) for n in ("y", "z", "w", "v")}
        first = random_law(rng, "one", inputs, ["y", "z"], names[3:7])
        second = random_law(rng, "two", [*inputs[:1], link["y"], link["v"]], ["w"], names[7:10])
        third = build("hold", TIME, _hold, inputs=[link["z"]], outputs=[link["v"]], states=[State(link["v"], 1)])
        wired, flags = [(first, second, third)[i] for i in rng.permutation(3)], ("flag_one", "flag_two")
        block = compose("rb", wired, inputs=[s.name for s in inputs], outputs=["w", "y", "z", "v", *flags])
    faults = (Fault(int(rng.integers(31)), flags[0], None), Fault(31, flags[1], None))
    return replace(block, name=f"rb{seed}", faults=faults, safety=Safety(1, {}, {}, "test"))


def random_holding_block(seed: int) -> Block:
    """Return a random Block whose states hold their values under additional conditions, such as those of its faults.

    The states of a guarded controller do the same once it has latched.
    """
    block, rng = random_block(seed), np.random.default_rng(seed)
    conditions = [block.output[f.output] for f in block.faults]
    conditions += [block.symbol[block.inputs[0].name] < 1, block.symbol[block.states[0].name] < 1]
    next = dict(block.next)
    for name in next:
        for c in rng.permutation(len(conditions))[: rng.integers(4)]:
            arms = block.symbol[name], next[name]
            next[name] = ca.if_else(conditions[c], *arms[:: 1 if rng.random() < 0.7 else -1])
    return replace(block, next=next)


def _hold(u: Mapping[str, SX], x: Mapping[str, SX], k: Mapping[str, SX]) -> Step:
    return Step({"v": x["v"]}, {"v": u["z"]})


def samples(block: Block, count: int, seed: int = 1) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return states (states, count) and inputs (inputs, count) of a Block: dyadic, often equal, ends included."""
    rng = np.random.default_rng(seed)

    def row(s: Signal, step: float) -> NDArray[np.float64]:
        return rng.integers(int(s.low / step), int(s.high / step) + 1, count) * step

    x = [row(s.signal, 1 if s.integer else 2.0**-PLACES) for s in block.states]
    u = [row(s, 0.25) for s in block.inputs]
    return np.array(x).reshape(len(x), count), np.array(u).reshape(len(u), count)
