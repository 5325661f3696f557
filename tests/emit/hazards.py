"""Blocks in dyadic arithmetic, each of which a scheduler, a printer or a folding rule can get wrong in its own way."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import casadi as ca

from synth.block import Block, Constant, Fault, Safety, State, Step, build
from synth.composition import compose
from tests.emit.dyadic import TIME, signal

SX = ca.SX
Exprs = Mapping[str, SX]
Law = Callable[[Exprs, Exprs, Exprs], Step]
GAINS = [Constant("k1", 1.5, "1", "test"), Constant("k2", -2.5, "1", "test"), Constant("k3", 0.75, "1", "test")]


def real(*names: str) -> list[State]:
    return [State(signal(n, -4, 4), 0) for n in names]


def count(name: str = "n") -> list[State]:
    return [State(signal(name, 0, 7), 2, True)]


def make(name: str, law: Law, outputs: str, states: Sequence[State] = (), constants: Sequence[Constant] = ()) -> Block:
    return build(
        name,
        TIME,
        law,
        inputs=[signal(n, -4, 4) for n in "abc"],
        outputs=[signal(n, -1e4, 1e4) for n in outputs.split()],
        states=states,
        constants=constants,
    )


def stored_before_it_is_handed_on(u: Exprs, x: Exprs, k: Exprs) -> Step:
    a, b, c = u["a"], u["b"], u["c"]
    v = ca.if_else(a < b, a * b * c + c * c, a * c * 7 - b)
    y = ca.if_else(a < b, c, x["x"])
    next = ca.if_else(a < b, c * a / 4, a)
    return Step({"n": next, "w": y * y - v, "z": y * 3 + v}, {"x": next})


def stored_by_an_earlier_block() -> Block:
    hold = build(
        "hold",
        TIME,
        lambda u, x, k: Step({"prev": x["x"]}, {"x": u["a"]}),
        inputs=[signal("a", -4, 4)],
        outputs=[signal("prev", -4, 4)],
        states=real("x"),
    )

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        a, b, c = u["a"], u["b"], u["c"]
        v = ca.if_else(a < b, a * b * c + c * c, a * c * 7 - b)
        y = ca.if_else(a < b, c, u["prev"])
        return Step({"z": y * 3 + v, "w": y * y - v})

    use = build(
        "use",
        TIME,
        law,
        inputs=[signal(n, -4, 4) for n in ("a", "b", "c", "prev")],
        outputs=[signal(n, -1e4, 1e4) for n in "zw"],
    )
    return compose("earlier", [hold, use], inputs=list("abc"), outputs=list("zw"))


def _pair(u: Exprs) -> tuple[SX, SX]:
    """Return two choices on a < b; a scheduler that splits them leaves the first as the start of later choices."""
    a, b, c = u["a"], u["b"], u["c"]
    return ca.if_else(a < b, a * b * c + a * 2, b * c * 5 - a), ca.if_else(a < b, a * b + c, c * c + b)


def two_start_from_one(u: Exprs, x: Exprs, k: Exprs) -> Step:
    a, b, c = u["a"], u["b"], u["c"]
    s, other = _pair(u)
    p, q = ca.if_else(b < c, a * b * 7 + c, s), ca.if_else(b < c, a * c * 9 + b, s)
    return Step({"y": p + q + p, "z": q - p, "w": other * 3})


def read_while_it_is_carried_on(u: Exprs, x: Exprs, k: Exprs) -> Step:
    a, b, c = u["a"], u["b"], u["c"]
    s, other = _pair(u)
    p, q = ca.if_else(b < c, a * b * 7 + c, s), ca.if_else(b < c, s * 9 + b * c, a)
    return Step({"y": p + q + p, "z": q - p, "w": other * 3})


def carried_on_as_another_kind(u: Exprs, x: Exprs, k: Exprs) -> Step:
    a, b, c = u["a"], u["b"], u["c"]
    s = ca.if_else(a < b, ca.logic_and(a * b * c + a * 2 < 1, b < 2), b * c * 5 - a < 0)
    p = ca.if_else(b < c, a * b * 7 / 4 + c * a * b, s)
    return Step({"y": p * 3 + a, "w": _pair(u)[1] * 3})


def crossing_choices(u: Exprs, x: Exprs, k: Exprs) -> Step:
    """r depends on p and q on s, with p, q on one condition and r, s on another: as whole groups they are circular."""
    a, b, c = u["a"], u["b"], u["c"]
    p = ca.if_else(a < b, a * c + b * 3, b * c - a * 3)
    s = ca.if_else(b < c, c * 5 - a * b, a * a + c)
    r = ca.if_else(b < c, p * 3 + a * b, p - c * a)
    q = ca.if_else(a < b, s * 3 + b * c, s - b * a)
    return Step({"y": r, "z": q, "w": p + s})


def swapped(u: Exprs, x: Exprs, k: Exprs) -> Step:
    return Step({"y": x["x"] - x["y"]}, {"x": x["y"], "y": x["z"], "z": x["x"]})


def swapped_on_one_side(u: Exprs, x: Exprs, k: Exprs) -> Step:
    go = u["a"] < u["b"]
    return Step({"u": x["x"] * 2}, {"x": ca.if_else(go, x["y"], x["x"]), "y": ca.if_else(go, x["x"], u["c"])})


def read_later(u: Exprs, x: Exprs, k: Exprs) -> Step:
    next = ca.fmax(ca.fmin(u["a"] + u["b"] / 2, 4), -4)
    return Step({"before": x["x"], "after": next, "y": next * 3 + x["x"], "z": x["x"] * u["c"]}, {"x": next})


def held_by_its_own_condition(u: Exprs, x: Exprs, k: Exprs) -> Step:
    return Step(
        {"y": u["a"]}, {"n": ca.if_else(x["n"], x["n"], 3), "x": ca.if_else(x["x"], x["x"], u["a"] * u["b"] / 4)}
    )


def never_read(u: Exprs, x: Exprs, k: Exprs) -> Step:
    return Step({"y": 0.25}, {"x": x["x"]})


def limits_that_may_be_negative(u: Exprs, x: Exprs, k: Exprs) -> Step:
    a, b = u["a"], u["b"]
    return Step(
        {"y": ca.fmax(ca.fmin(a, b), -b), "z": ca.fmax(ca.fmin(a, -1), 1), "w": ca.fmax(ca.fmin(a, k["k2"]), -k["k2"])}
    )


def shared_limits(u: Exprs, x: Exprs, k: Exprs) -> Step:
    h = ca.fabs(u["b"]) + 1
    return Step({"y": ca.fmax(ca.fmin(u["a"] * 2, h), -h), "z": ca.fmax(ca.fmin(u["c"] * 3, h), -h)})


def counts_below_zero(u: Exprs, x: Exprs, k: Exprs) -> Step:
    n = x["n"]
    return Step(
        {"y": ca.if_else(n - 1 < 3, u["a"], u["b"]), "z": -n, "w": ca.fmax(n - 2, u["a"])}, {"n": ca.fmax(n - 1, 0)}
    )


def counts_against_fractions(u: Exprs, x: Exprs, k: Exprs) -> Step:
    n = x["n"]
    y = (
        ca.if_else(n < 2.5, u["a"], u["b"])
        + ca.if_else(n <= -0.5, 1, 2)
        + ca.if_else(n < 0, 1, 2)
        + ca.if_else(n >= 0, 1, 2)
    )
    return Step({"y": y}, {"n": ca.if_else(n < 6.5, n + 1, 0)})


def counts_down(u: Exprs, x: Exprs, k: Exprs) -> Step:
    n = x["n"]
    return Step(
        {"y": n},
        {"n": ca.if_else(u["a"] > 0, ca.if_else(n > 0, n - 1, 0), ca.if_else(u["b"] < n, ca.fmin(n + 1, 7), 5))},
    )


def truths_of_numbers(u: Exprs, x: Exprs, k: Exprs) -> Step:
    a = u["a"]
    return Step(
        {
            "y": 3 - ca.logic_or(a, 0),
            "z": 3 - ca.logic_not(ca.logic_not(a)),
            "w": ca.if_else(a, 1, 0) + ca.logic_and(a, 1),
        }
    )


def three_gains(u: Exprs, x: Exprs, k: Exprs) -> Step:
    return Step({"y": k["k1"] * (k["k2"] * (k["k3"] * u["a"])), "z": k["k2"] * u["b"] + k["k1"] * (k["k2"] * u["b"])})


def gains_about_an_idle_limit(u: Exprs, x: Exprs, k: Exprs) -> Step:
    return Step({"y": k["k1"] * ca.fmax(ca.fmin(k["k2"] * u["a"], 100), -100)})


def nested(depth: int = 40) -> Block:
    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        level, deep, sum = u["c"], x["x"], u["c"]
        for i in range(depth):
            level = ca.if_else(
                u["a"] < (i - depth / 2) / 4, level + u["b"], ca.if_else(u["b"] < i / 16, level - 1, level)
            )
            deep = ca.if_else(u["b"] < (i - depth / 2) / 4, deep, ca.if_else(x["n"] <= i % 7, u["a"], deep))
            sum = ca.if_else(u["a"] * u["b"] < i, sum, sum + level)
        return Step({"y": level, "z": sum}, {"x": deep, "n": ca.if_else(u["a"] < 0, ca.fmin(x["n"] + 1, 7), x["n"])})

    return make("nested", law, "y z", [*real("x"), *count()])


LATCHING = Safety(1, {}, {}, "test")


def flags() -> Block:
    """Return a Block with fault bits that are always set, never set, set twice by one flag, and set sometimes."""

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        wide = ca.logic_not(ca.logic_and(u["a"] >= -1, u["a"] <= 1))
        return Step(
            {"wide": wide, "always": 1, "never": 0, "n": x["n"]}, {"n": ca.if_else(wide, ca.fmin(x["n"] + 1, 7), 0)}
        )

    block = make("flags", law, "wide always never n", count())
    bits = [(0, "wide"), (4, "always"), (5, "never"), (30, "n"), (31, "wide")]
    return replace(block, faults=tuple(Fault(bit, name, None) for bit, name in bits), safety=LATCHING)


def suspects() -> Block:
    """Return a Block with fault bits under a common condition, consecutive and separate, also of numbers."""

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        a, b, c, flag = u["a"], u["b"], u["c"], x["flag"]
        under = {n: ca.logic_and(flag, e) for n, e in (("p", a < 0), ("q", c), ("r", x["n"]))}
        return Step(
            under | {"wide": b > 1, "other": ca.logic_and(a < 0, flag)}, {"flag": a < b, "n": ca.fmin(x["n"], 3)}
        )

    block = make("suspects", law, "p q r wide other", [State(signal("flag", 0, 1), 0, True), *count()])
    bits = [(0, "wide"), (1, "p"), (2, "q"), (7, "r"), (8, "other"), (9, "q"), (31, "wide")]
    return replace(block, faults=tuple(Fault(bit, name) for bit, name in bits), safety=LATCHING)


def constant_word() -> Block:
    block = make("word", lambda u, x, k: Step({"never": 0, "y": u["a"]}), "never y")
    return replace(block, faults=(Fault(3, "never", None),))


BLOCKS = [
    make("handed", stored_before_it_is_handed_on, "n w z", real("x")),
    stored_by_an_earlier_block(),
    make("start", two_start_from_one, "y z w"),
    make("read", read_while_it_is_carried_on, "y z w"),
    make("kind", carried_on_as_another_kind, "y w"),
    make("crossing", crossing_choices, "y z w"),
    make("swapped", swapped, "y", real("x", "y", "z")),
    make("side", swapped_on_one_side, "u", real("x", "y")),
    make("later", read_later, "before after y z", real("x")),
    make("held", held_by_its_own_condition, "y", [*real("x"), *count()]),
    make("never", never_read, "y", real("x")),
    make("negative", limits_that_may_be_negative, "y z w", constants=GAINS),
    make("limits", shared_limits, "y z"),
    make("below", counts_below_zero, "y z w", count()),
    make("fractions", counts_against_fractions, "y", count()),
    make("down", counts_down, "y", count()),
    make("truths", truths_of_numbers, "y z w"),
    make("gains", three_gains, "y z", constants=GAINS),
    make("idle", gains_about_an_idle_limit, "y", constants=GAINS),
    nested(),
    flags(),
    suspects(),
    constant_word(),
]
