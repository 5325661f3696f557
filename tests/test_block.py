"""Composition by name equals stepping the Blocks one by one, and what cannot be wired is refused by name."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, Constant, Exprs, Fault, State, Step, build
from synth.composition import compose
from synth.errors import SignalError, TimingError, WiringError
from synth.signals import Signal
from synth.timing import Discrete

TIME = Discrete(1e-3)


def signal(name: str, unit: str = "1", low: float = -10, high: float = 10) -> Signal:
    return Signal(name, unit, low, high)


def gain(name: str, source: str, target: str, k: float = 2.0, **fields: Any) -> Block:
    """target = k source."""
    made = build(
        name,
        TIME,
        lambda u, x, c: Step({target: c["k"] * u[source]}),
        inputs=[signal(source)],
        outputs=[signal(target)],
        constants=[Constant("k", k, "1", "test")],
    )
    return replace(made, **fields)


def delay(name: str, source: str, target: str) -> Block:
    """target is source one sample ago."""
    return build(
        name,
        TIME,
        lambda u, x, c: Step({target: x["kept"]}, {"kept": u[source]}),
        inputs=[signal(source)],
        outputs=[signal(target)],
        states=[State(signal("kept"), 0.5)],
    )


def network(rng: np.random.Generator, count: int = 4) -> list[Block]:
    """Blocks of two outputs, each a function of any signals before it in a random order: cycles of Blocks, no loop."""
    signals = [f"s{i}" for i in rng.permutation(2 * count)]
    return [_member(rng, b, signals) for b in rng.permutation(count)]


def _member(rng: np.random.Generator, b: int, signals: list[str]) -> Block:
    state_names = [f"s{2 * b}", f"s{2 * b + 1}"]
    inputs = ["open", *(s for s in signals if s not in state_names and rng.random() < 0.7)]
    weight = rng.normal(size=(4, len(inputs) + 2))

    def law(u: Any, x: Any, k: Any) -> Step:
        def mix(row: int, allowed: Sequence[str]) -> ca.SX:
            terms = [w * u[n] for w, n in zip(weight[row], inputs, strict=False) if n in allowed]
            return sum(terms, start=weight[row, -2] * x["p"] + weight[row, -1] * k["c"] * x["q"])

        before = [["open", *signals[: signals.index(s)]] for s in state_names]
        output = {s: ca.tanh(mix(i, before[i])) for i, s in enumerate(state_names)}
        inner = signal(f"inner{b}"), mix(2, inputs)
        return Step(output, {"p": mix(2, inputs), "q": ca.sin(mix(3, inputs))}, [inner])

    return build(
        f"block{b}",
        TIME,
        law,
        inputs=[signal(s) for s in inputs],
        outputs=[signal(s) for s in state_names],
        states=[State(signal("p", low=-0.4, high=0.3), 0.1), State(signal("q"), -0.2)],
        constants=[Constant("c", rng.normal(), "1", "test")],
    )


def one_by_one(blocks: Sequence[Block], u: np.ndarray) -> dict[str, list[float]]:
    """Step each Block by itself; repeat within a sample until every signal has settled."""
    x = {b.name: b.initial for b in blocks}
    seen: dict[str, list[float]] = {s.name: [] for b in blocks for s in b.outputs}
    for sample in u:
        wire = {"open": sample} | dict.fromkeys(seen, 0.0)
        for _ in range(len(seen) + 1):
            results = {b.name: b.function()(x[b.name], [wire[s.name] for s in b.inputs]) for b in blocks}
            for b in blocks:
                wire |= zip((s.name for s in b.outputs), results[b.name][1].full().ravel(), strict=True)
        x = {name: next.full().ravel() for name, (next, _) in results.items()}
        for name, values in seen.items():
            values.append(wire[name])
    return seen


def run(block: Block, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return outputs (N, p) and states (N, n) after each step."""
    f, x, rows, states = block.function(), block.initial, [], []
    for sample in u:
        next, y = f(x, sample)
        x = next.full().ravel()
        rows.append(y.full().ravel())
        states.append(x)
    return np.array(rows), np.array(states)


@pytest.mark.parametrize("seed", range(6))
def test_a_composition_equals_its_blocks_stepped_one_by_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    blocks = network(rng)
    expected = one_by_one(blocks, u := rng.normal(size=12))
    whole = compose("whole", blocks, inputs=["open"], outputs=sorted(expected))
    assert whole.time == TIME and len(whole.states) == 2 * len(blocks)
    computed, states = run(whole, u)
    np.testing.assert_allclose(computed, np.array([expected[s] for s in sorted(expected)]).T, rtol=0, atol=1e-13)
    bounds = np.array([[s.signal.low, s.signal.high] for s in whole.states]).T
    assert (states >= bounds[0]).all() and (states <= bounds[1]).all()
    assert {n.signal.name for n, _ in whole.computed_signals} == {*expected, *(f"inner{b}" for b in range(4))}
    # Composing in two stages, with some outputs hidden in the first, changes nothing.
    again, _ = run(compose("outer", [whole], inputs=["open"], outputs=["s3"]), u)
    np.testing.assert_array_equal(again[:, 0], computed[:, sorted(expected).index("s3")])


def test_every_signal_is_listed_after_those_that_it_needs() -> None:
    chain = [gain("c", "y", "z"), gain("b", "x", "y"), gain("a", "u", "x")]
    whole = compose("chain", chain, inputs=["u"], outputs=["z"])
    assert [n.signal.name for n, _ in whole.computed_signals] == ["x", "y", "z"]
    assert float(whole.function()([], 3)[1]) == 24


def test_copies_of_one_block_keep_their_own_states_and_constants() -> None:
    whole = compose("two", [delay("a", "u", "v"), delay("b", "v", "w")], inputs=["u"], outputs=["w"])
    assert [s.name for s in whole.states] == ["a_kept", "b_kept"]
    np.testing.assert_array_equal(run(whole, np.array([7.0, 8.0, 9.0]))[0][:, 0], [0.5, 0.5, 7.0])


def test_a_cycle_of_blocks_is_no_loop_when_a_state_breaks_it() -> None:
    whole = compose("ring", [gain("a", "x", "y", 0.5), delay("b", "y", "x")], inputs=[], outputs=["y"])
    np.testing.assert_array_equal(run(whole, np.zeros((3, 0)))[0][:, 0], [0.25, 0.125, 0.0625])


def test_a_cycle_of_blocks_is_no_loop_when_the_signals_are_independent() -> None:
    first = build(
        "first",
        TIME,
        lambda u, x, k: Step({"demand": 3 * u["e"], "excess": u["demand_limited"] - 3 * u["e"]}),
        inputs=[signal("e"), signal("demand_limited")],
        outputs=[signal("demand"), signal("excess")],
    )
    limit = gain("limit", "demand", "demand_limited", 0.5)
    whole = compose("loop", [first, limit], inputs=["e"], outputs=["demand_limited", "excess"])
    assert whole.function()([], 2)[1].full().ravel().tolist() == [3, -3]


DRIVER = gain("a", "u", "x")
LOOP = [gain("a", "z", "x"), gain("b", "x", "y"), gain("c", "y", "z")]
METRES = replace(gain("b", "x", "y"), inputs=(signal("x", "m"),))
FAULTY = {"faults": (Fault(3, "x", "u"),)}


@pytest.mark.parametrize(
    ("blocks", "inputs", "outputs", "texts"),
    [
        (LOOP, [], ["z"], ["algebraic loop x <- z <- y <- x", "put a state"]),
        ([gain("a", "x", "x2"), gain("b", "x2", "x")], [], ["x"], ["algebraic loop x2 <- x <- x2"]),
        ([DRIVER, gain("b", "u", "x")], ["u"], ["x"], ["'x' has two drivers, 'a' and 'b'", "rename"]),
        ([DRIVER, METRES], ["u"], ["y"], ["'x' is in 1 in 'a' but in m in 'b'", "convert"]),
        ([METRES, gain("c", "x", "z")], ["x"], ["y"], ["'x' is in m in 'b' but in 1 in 'c'", "convert"]),
        ([DRIVER], [], ["x"], ["'u' is needed by 'a' but no Block drives it", "list it among the inputs of 'w'"]),
        ([DRIVER], ["u", "v"], ["x"], ["input 'v' is needed by no Block", "remove it"]),
        ([DRIVER], ["u", "x"], ["x"], ["input 'x' is driven by 'a'", "remove it"]),
        ([DRIVER], ["u"], ["y"], ["no Block drives output 'y'", "leave it out"]),
        ([DRIVER, gain("a", "u", "y")], ["u"], ["y"], ["'a_k' of block 'a' is also a name in 'a'", "rename"]),
        ([DRIVER, gain("b", "a_k", "y")], ["u", "a_k"], ["y"], ["'a_k' is also a name in block 'a'", "rename"]),
        ([DRIVER, gain("b", "u", "a_k")], ["u"], ["x"], ["'a_k' of block 'a' is also a name in 'b'", "rename"]),
        (
            [gain("a", "u", "x", **FAULTY), gain("b", "u", "y", faults=(Fault(3, "y", "u"),))],
            ["u"],
            ["x"],
            ["fault bit 3 is set by 'a' and by 'b'", "one Block"],
        ),
        ([], [], [], ["there is no Block to wire", "at least one"]),
    ],
)
def test_what_cannot_be_wired_is_refused_by_name(
    blocks: list[Block], inputs: list[str], outputs: list[str], texts: list[str]
) -> None:
    with pytest.raises(WiringError) as caught:
        compose("w", blocks, inputs=inputs, outputs=outputs)
    for text in texts:
        assert text in str(caught.value)


@pytest.mark.parametrize(("inputs", "outputs", "name"), [(["u", "u"], ["x"], "u"), (["u"], ["x", "x"], "x")])
def test_a_signal_is_listed_once(inputs: list[str], outputs: list[str], name: str) -> None:
    with pytest.raises(SignalError, match=f"'{name}' is declared 2 times"):
        compose("w", [DRIVER], inputs=inputs, outputs=outputs)


def test_equal_units_written_otherwise_are_wired() -> None:
    force = replace(gain("a", "u", "x"), outputs=(signal("x", "N"),))
    mass = replace(gain("b", "x", "y"), inputs=(signal("x", "kg m/s^2"),))
    assert compose("w", [force, mass], inputs=["u"], outputs=["y"]).outputs[0].name == "y"


def test_two_periods_are_refused() -> None:
    with pytest.raises(TimingError, match=r"0\.001 s meets discrete time of 0\.002 s"):
        compose("w", [DRIVER, replace(gain("b", "x", "y"), time=Discrete(2e-3))], inputs=["u"], outputs=["y"])


def test_a_flag_that_is_no_output_survives_nesting() -> None:
    inner = compose("inner", [gain("a", "u", "x", **FAULTY), gain("b", "x", "y")], inputs=["u"], outputs=["y"])
    outer = compose("outer", [inner, gain("c", "y", "z")], inputs=["u"], outputs=["z"])
    assert outer.faults == (Fault(3, "x", "u"),) and set(outer.output) == {"z", "x"}
    value = ca.Function("flag", [outer.symbol["u"], outer.symbol["inner_a_k"]], [outer.output["x"]])
    assert float(value(5, 2)) == 10
    with pytest.raises(WiringError, match="flag 'x' of 'inner' is also driven by 'c'"):
        compose("outer", [inner, gain("c", "y", "x")], inputs=["u"], outputs=["x"])


@pytest.mark.parametrize("u", [np.nan, np.inf, -np.inf, 1e300, -1e300, 0.05])
def test_real_states_stay_in_their_bounds_whatever_comes(u: float) -> None:
    made = build(
        "sum",
        TIME,
        lambda u, x, k: Step({"y": x["s"]}, {"s": x["s"] + u["u"]}),
        inputs=[signal("u")],
        outputs=[signal("y")],
        states=[State(signal("s", low=-0.3, high=0.1), 0.0)],
    )
    after = float(made.function()([0.0], u)[0])
    assert after == (0.05 if u == 0.05 else -0.3 if u < 0 else 0.1)


@pytest.mark.parametrize(
    ("low", "high", "initial", "integer", "text"),
    [
        (0, 1, 1.5, False, "'n' starts at 1.5, outside its bounds 0 .. 1: start it inside"),
        (0, 1, np.nan, False, "starts at nan, outside"),
        (-1, 1, 0, True, "with the lower bound -1"),
        (0, 5, 2.5, True, "integer state 'n' starts at 2.5"),
    ],
)
def test_a_state_starts_inside_its_bounds(low: float, high: float, initial: float, integer: bool, text: str) -> None:
    with pytest.raises(SignalError, match=text):
        State(signal("n", low=low, high=high), initial, integer)


STRANGER = ca.SX.sym("stranger")


@pytest.mark.parametrize(
    ("law", "fields", "text"),
    [
        (lambda u, x, k: Step({}, {"n": 0}), {}, r"outputs: missing \['y'\], not declared none"),
        (lambda u, x, k: Step({"y": 0, "z": 0}, {"n": 0}), {}, r"outputs: missing none, not declared \['z'\]"),
        (lambda u, x, k: Step({"y": 0}), {}, r"next states: missing \['n'\]"),
        (lambda u, x, k: Step({"y": u["u"]}, {"n": STRANGER}), {}, "'b' uses 'stranger', which is none of its inputs"),
        (None, {"outputs": [signal("y"), signal("y")]}, "'y' is declared 2 times"),
        (None, {"outputs": [signal("u")]}, "'u' is declared 2 times"),
        (None, {"constants": [Constant("n", 1, "1", "test")]}, "states and constants are called 'n'"),
        (None, {"inputs": [signal("n")]}, "states and constants are called 'n'"),
    ],
)
def test_an_incomplete_block_is_refused(law: Callable[..., Step] | None, fields: dict[str, Any], text: str) -> None:
    declared = {"inputs": [signal("u")], "outputs": [signal("y")], "states": [State(signal("n"), 0)]}
    with pytest.raises(SignalError, match=text):
        build("b", TIME, law or (lambda u, x, k: Step({"y": 0}, {"n": 0})), **declared | fields)


def test_names_and_numbers_that_c_cannot_hold_are_refused() -> None:
    with pytest.raises(SignalError, match="block name 'my block'"):
        gain("my block", "u", "x")
    with pytest.raises(SignalError, match="constant 'k' is inf"):
        Constant("k", np.inf, "1", "test")
    with pytest.raises(SignalError, match="constant 'k' is inf"):
        gain("a", "u", "x", 1e39).rounded(np.float32)


def test_rounding_touches_the_constants_alone() -> None:
    rounded = gain("a", "u", "x", 0.1).rounded(np.float32)
    assert rounded.constants[0].value == float(np.float32(0.1)) != 0.1
    assert float(rounded.function()([], 3.0)[1]) == 3.0 * float(np.float32(0.1))


def test_numbers_may_stand_for_expressions() -> None:
    made = build(
        "still",
        TIME,
        lambda u, x, k: Step({"y": 0.25}, {"r": 20.0, "n": 1}),
        inputs=[signal("u")],
        outputs=[signal("y")],
        states=[State(signal("r"), 0), State(signal("n", low=0), 0, True)],
    )
    next, y = compose("w", [made], inputs=["u"], outputs=["y"]).function()([0, 0], 0)
    assert (next.full().ravel().tolist(), float(y)) == ([10, 1], 0.25)


def test_a_renamed_input_keeps_its_fault_bits() -> None:
    """Without its bit an input is taken for one that never leaves its range, and its guard is folded away."""
    block = replace(delay("d", "a", "kept"), faults=(Fault(0, "kept", input="a"), Fault(1, "kept", suspect="a")))
    assert [(f.input, f.suspect) for f in block.renamed({"a": "b"}).faults] == [("b", None), (None, "b")]


def test_a_renamed_block_steps_as_before_under_its_new_names() -> None:
    """A state keeps its name, even where an output of the same name is renamed."""
    block = replace(delay("d", "a", "kept"), faults=(Fault(0, "kept"),))
    renamed = block.renamed({"a": "b", "kept": "late", "other": "none"})
    assert [s.name for s in (*renamed.inputs, *renamed.outputs)] == ["b", "late"]
    assert [s.name for s in renamed.states] == ["kept"] and renamed.faults[0].output == "late"
    assert [named.signal.name for named, _ in renamed.computed_signals] == ["late"] and {"b", "kept"} == set(
        renamed.symbol
    )
    for before, after in zip(block.function()(2.0, 3.0), renamed.function()(2.0, 3.0), strict=True):
        assert float(before) == float(after)


def test_the_step_as_a_function_of_gains_has_their_derivatives() -> None:
    """With y = a x + b u and x' = x + a b u the derivatives by (b, a) are those of the formulas."""
    a, b = (Constant(n, v, "1", "test") for n, v in (("a", 3.0), ("b", 0.5)))

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        return Step({"y": k["a"] * x["s"] + k["b"] * u["e"]}, {"s": x["s"] + k["a"] * k["b"] * u["e"]})

    made = build(
        "law", Discrete(1.0), law, inputs=[Signal("e", "1", -9, 9)], outputs=[Signal("y", "1", -99, 99)],
        states=[State(Signal("s", "1", -99, 99), 0.0)], constants=[a, b],
    )  # fmt: skip
    f = made.function(["b", "a"])
    assert f.name_in() == ["x", "u", "k"] and f.size1_in("k") == 2
    for mine, fixed in zip(f(2.0, 4.0, [0.5, 3.0]), made.function()(2.0, 4.0), strict=True):
        assert float(mine) == float(fixed)
    k = ca.SX.sym("k", 2)
    slopes = ca.Function("slopes", [k], [ca.jacobian(ca.vcat(f(2.0, 4.0, k)), k)])([0.5, 3.0])
    assert np.array(slopes).tolist() == [[3.0 * 4.0, 0.5 * 4.0], [4.0, 2.0]]
    only_a = made.function(["a"])
    assert float(only_a(2.0, 4.0, 1.0)[1]) == 2.0 + 0.5 * 4.0, "the other constant keeps its value"


def test_a_gain_that_a_block_has_not_is_refused() -> None:
    made = build(
        "none", Discrete(1.0), lambda u, x, k: Step({"y": u["e"]}),
        inputs=[Signal("e", "1", -1, 1)], outputs=[Signal("y", "1", -1, 1)],
    )  # fmt: skip
    with pytest.raises(SignalError, match="block 'none' has no constant 'K': name some of none"):
        made.function(["K"])
