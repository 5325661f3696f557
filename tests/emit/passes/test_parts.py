"""Blocks that are one program but for names and numbers are one function; any other difference keeps them apart."""

import re
from collections.abc import Callable
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, Constant, State, Step, build
from synth.composition import compose
from synth.emit import pipeline
from synth.emit.c import routine
from synth.emit.passes import parts
from synth.emit.passes.parts import Form, Part
from synth.emit.program.lower import Program
from synth.emit.write import emit
from synth.execute import host
from synth.signals import Signal
from tests.emit.dyadic import TIME

AXES = ("x", "y", "z", "phi", "theta", "psi", "u", "v", "w")  # fewer are shorter without a function
F32 = np.float32
Law = Callable[[ca.SX, dict[str, ca.SX], dict[str, ca.SX]], ca.SX]


def plain(sum: ca.SX, x: dict[str, ca.SX], k: dict[str, ca.SX]) -> ca.SX:
    return k["k"] * sum + x["lag"] * (sum - x["lag"]) + 0.25 * x["lag"]


def axis(name: str, k: float, law: Law, integer: bool = False) -> Block:
    """Return an axis: a lag that is limited, a sum that stays where the limit is passed, and their weighted sum."""

    def step(u: dict[str, ca.SX], x: dict[str, ca.SX], k: dict[str, ca.SX]) -> Step:
        total = x["sum"] + u[f"e_{name}"]
        next = {"lag": ca.fmax(ca.fmin(0.5 * (x["lag"] + u[f"e_{name}"]), 2), -2)}
        next["sum"] = ca.if_else(ca.fabs(total) <= 4, total, x["sum"])
        return Step({f"w_{name}": law(total, x, k)}, next | ({"n": ca.fmin(x["n"] + 1, 7)} if integer else {}))

    states = [State(Signal("lag", "1", -2, 2), 0), State(Signal("sum", "1", -4, 4), 0)]
    states += [State(Signal("n", "1", 0, 7), 0, True)] if integer else []
    w = Signal(f"w_{name}", "1", -99, 99)
    constants = [Constant("k", k, "1", "test")]
    inputs = [Signal(f"e_{name}", "1", -1, 1)]
    return build(f"axis_{name}", TIME, step, inputs=inputs, outputs=[w], states=states, constants=constants)


def composed(laws: dict[str, Law], integer: bool = False) -> Block:
    blocks = [axis(name, 0.5 + i / 8, law, integer) for i, (name, law) in enumerate(laws.items())]
    return compose("axes", blocks, inputs=[f"e_{n}" for n in laws], outputs=[f"w_{n}" for n in laws])


def groups(block: Block) -> list[list[tuple[Part, Form]]]:
    return parts.alike(pipeline.reduce(block.rounded(F32), F32).program)


def test_equal_axes_are_one_function_that_is_called_for_each() -> None:
    text = emit(composed(dict.fromkeys(AXES, plain)), F32).files
    assert text["axes.c"].count("axes_axis(") == 1 + len(AXES) and "axes_axis_state_t axis_y;" in text["axes.h"]
    for name in AXES:
        assert f"axes_axis(&state->axis_{name}, axis_{name}_k, e_{name});" in text["axes.c"]


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_outlined_and_flat_c_have_the_same_bits(scalar: type[np.floating], monkeypatch: pytest.MonkeyPatch) -> None:
    block = composed(dict.fromkeys(AXES, plain))
    outlined = emit(block, scalar)
    monkeypatch.setattr(parts, "alike", lambda p: [])
    flat = emit(block, scalar)
    assert "axes_axis(" in outlined.files["axes.c"] and "axes_axis(" not in flat.files["axes.c"]
    rng = np.random.default_rng(3)
    u = {f"e_{n}": rng.uniform(-1, 1, 300).astype(scalar) for n in AXES}
    ours, theirs = (host.load(e.files, e.manifest).replay(u) for e in (outlined, flat))
    for name in (f"w_{n}" for n in AXES):
        np.testing.assert_array_equal(ours.outputs[name], theirs.outputs[name])


DIFFERENT: dict[str, Law] = {
    "another operation": lambda sum, x, k: k["k"] * sum + x["lag"] * (sum + x["lag"]) + 0.25 * x["lag"],
    "operands in another order": lambda sum, x, k: k["k"] * sum + x["lag"] * (x["lag"] - sum) + 0.25 * x["lag"],
    "a value read twice": lambda sum, x, k: k["k"] * sum + sum * (sum - x["lag"]) + 0.25 * x["lag"],
    "a constant for a number": lambda sum, x, k: k["k"] * sum + x["lag"] * (sum - x["lag"]) + k["k"] * x["lag"],
}


@pytest.mark.parametrize("other", DIFFERENT.values(), ids=DIFFERENT)
def test_blocks_that_differ_are_two_functions(other: Law) -> None:
    assert [len(g) for g in groups(composed({"x": plain, "y": plain}))] == [2]
    assert [len(g) for g in groups(composed({"x": plain, "y": other}))] == [1, 1]


def test_blocks_with_counts_are_one_function_whose_counts_are_whole_numbers() -> None:
    assert [len(g) for g in groups(composed(dict.fromkeys(AXES, plain), integer=True))] == [len(AXES)]
    text = emit(composed(dict.fromkeys(AXES, plain), integer=True), F32).files["axes.c"]
    assert "const uint32_t n = state->n;" in text or "(state->n + 1u)" in text


def monitor(n: str) -> Block:
    """Return a monitor that counts bad readings; its signal decides whether the states of all Blocks are held."""

    def law(u: dict[str, ca.SX], x: dict[str, ca.SX], k: dict[str, ca.SX]) -> Step:
        bad = ca.fabs(u[f"e_{n}"] - x["last"]) > 0.5
        count = ca.if_else(bad, ca.if_else(x["count"] >= 5, x["count"], x["count"] + 1), 0)
        last = ca.if_else(bad, x["last"], 0.5 * (u[f"e_{n}"] + x["last"]))
        return Step({f"bad_{n}": count >= 5, f"held_{n}": last + 0.25 * u[f"e_{n}"]}, {"last": last, "count": count})

    outputs = [Signal(f"bad_{n}", "1", 0, 1), Signal(f"held_{n}", "1", -4, 4)]
    states = [State(Signal("last", "1", -2, 2), 0), State(Signal("count", "1", 0, 5), 0, True)]
    return build(f"{n}_monitor", TIME, law, inputs=[Signal(f"e_{n}", "1", -1, 1)], outputs=outputs, states=states)


def latching() -> Block:
    names = ("x", "y", "z", "u", "v", "w")
    both = build(
        "both", TIME, lambda u, x, k: Step({"bad": sum((u[f"bad_{n}"] for n in names), start=ca.SX(0)) > 0}),
        inputs=[Signal(f"bad_{n}", "1", 0, 1) for n in names], outputs=[Signal("bad", "1", 0, 1)],
    )  # fmt: skip
    held = [f"held_{n}" for n in names]
    made = compose("axes", [*map(monitor, names), both], inputs=[f"e_{n}" for n in names], outputs=[*held, "bad"])
    bad = made.output["bad"]
    return replace(made, next={s: ca.if_else(bad, made.symbol[s], v) for s, v in made.next.items()})


def test_a_block_whose_signal_holds_its_states_keeps_them(monkeypatch: pytest.MonkeyPatch) -> None:
    outlined = emit(latching(), F32)
    text = outlined.files["axes.c"]
    assert "axes_monitor_update(axes_monitor_state_t *state" in text
    monkeypatch.setattr(parts, "alike", lambda p: [])
    flat = emit(latching(), F32)
    rng = np.random.default_rng(4)
    u = {f"e_{n}": np.where(rng.uniform(size=400) < 0.1, rng.uniform(-1, 1, 400), 0).astype(F32) for n in "xyzuvw"}
    u["e_x"][150:157] = 1.0
    ours, theirs = (host.load(e.files, e.manifest).replay(u) for e in (outlined, flat))
    assert ours.outputs["bad"].max() == 1 and ours.outputs["bad"].min() == 0
    for name in ours.outputs:
        np.testing.assert_array_equal(ours.outputs[name], theirs.outputs[name])


def test_a_large_function_is_left_to_a_compiler_that_optimises_for_size(monkeypatch: pytest.MonkeyPatch) -> None:
    text = emit(latching(), F32).files["axes.c"]
    assert "AXES_LARGE" not in text
    monkeypatch.setattr(routine, "LARGE", 5)
    text = emit(replace(latching(), name="sizes"), F32).files["sizes.c"]
    assert "#if defined(__OPTIMIZE_SIZE__)\n#define SIZES_LARGE static inline\n" in text and "\nSIZES_LARGE " in text


def test_a_form_is_the_same_in_another_order_of_results() -> None:
    p = pipeline.reduce(composed({"x": plain, "y": plain}).rounded(F32), F32).program
    ((first, form), _) = groups(composed({"x": plain, "y": plain}))[0]
    kinds = ["real"] * len(p.nodes)
    assert parts.form(p, replace(first, results=first.results[::-1]), kinds).shape == form.shape


def test_a_block_that_needs_what_depends_on_it_is_cut_in_two() -> None:
    """Anti-windup: the next sum reads what a limit, another Block, made of the signal."""

    def law(u: dict[str, ca.SX], x: dict[str, ca.SX], k: dict[str, ca.SX], n: str) -> Step:
        w = k["k"] * u[f"e_{n}"] + x["sum"] + 0.5 * x["sum"] * u[f"e_{n}"]
        total = x["sum"] + u[f"e_{n}"] - 0.25 * u[f"excess_{n}"]
        return Step({f"w_{n}": w}, {"sum": ca.if_else(ca.fabs(total) <= 4, total, x["sum"])})

    def regulator(n: str) -> Block:
        inputs = [Signal(f"e_{n}", "1", -1, 1), Signal(f"excess_{n}", "1", -32, 32)]
        states, constants = [State(Signal("sum", "1", -4, 4), 0)], [Constant("k", 2.0, "1", "test")]
        outputs = [Signal(f"w_{n}", "1", -32, 32)]
        return build(
            f"regulator_{n}", TIME, lambda u, x, k: law(u, x, k, n), inputs=inputs, outputs=outputs, states=states,
            constants=constants,
        )  # fmt: skip

    def limit(n: str) -> Block:
        outputs = [Signal(f"i_{n}", "1", -1, 1), Signal(f"excess_{n}", "1", -32, 32)]
        inside = lambda u, x, k: ca.fmax(ca.fmin(u[f"w_{n}"], 1), -1)  # noqa: E731
        return build(
            f"limit_{n}", TIME,
            lambda u, x, k: Step({f"i_{n}": inside(u, x, k), f"excess_{n}": u[f"w_{n}"] - inside(u, x, k)}),
            inputs=[Signal(f"w_{n}", "1", -32, 32)], outputs=outputs,
        )  # fmt: skip

    blocks = [make(n) for n in ("x", "y") for make in (regulator, limit)]
    block = compose("axes", blocks, inputs=["e_x", "e_y"], outputs=["i_x", "i_y"])
    phases = [part.phase for group in groups(block) for part, _ in group if part.block.startswith("regulator")]
    assert phases == ["output", "output", "update", "update"]
    p = pipeline.reduce(block.rounded(F32), F32).program
    made = routine.outlined(p, {c.name: c.value for c in block.constants}, groups(block))
    order = [n.name for n in made.nodes if n.op == "call"]
    assert order.index("regulator_x_output") < order.index("regulator_x_update")


def probe(name: str) -> Block:
    """Return a Block that counts while a flag is set, which follows from the count itself."""

    def step(u: dict[str, ca.SX], x: dict[str, ca.SX], k: dict[str, ca.SX]) -> Step:
        still = u[f"held_{name}"]
        pushed = u[f"e_{name}"] + 0.5 * x["n"] * still + x["last"] * (still - x["last"])
        n = ca.if_else(still > 0.5, ca.fmin(x["n"] + 1, 7), 0)
        return Step({f"full_{name}": x["n"] >= 7, f"p_{name}": pushed}, {"n": n, "last": u[f"e_{name}"]})

    states = [State(Signal("n", "1", 0, 7), 0), State(Signal("last", "1", -1, 1), 0)]
    outputs = [Signal(f"full_{name}", "1", 0, 1), Signal(f"p_{name}", "1", -99, 99)]
    inputs = [Signal(f"held_{name}", "1", 0, 1), Signal(f"e_{name}", "1", -1, 1)]
    return build(f"probe_{name}", TIME, step, inputs=inputs, outputs=outputs, states=states)


def judge(name: str) -> Block:
    def step(u: dict[str, ca.SX], x: dict[str, ca.SX], k: dict[str, ca.SX]) -> Step:
        return Step({f"held_{name}": ca.if_else(u[f"full_{name}"] > 0.5, 0, ca.fabs(u[f"e_{name}"]))})

    inputs = [Signal(f"full_{name}", "1", 0, 1), Signal(f"e_{name}", "1", -1, 1)]
    return build(f"judge_{name}", TIME, step, inputs=inputs, outputs=[Signal(f"held_{name}", "1", 0, 1)])


def test_a_block_of_whose_signals_one_comes_before_the_rest_is_cut_in_two() -> None:
    blocks = [made for name in AXES for made in (probe(name), judge(name))]
    block = compose("probes", blocks, inputs=[f"e_{n}" for n in AXES], outputs=[f"p_{n}" for n in AXES])
    p = pipeline.reduce(block.rounded(F32), F32).program
    flag = next(k for named, k in p.marks if named.signal.name == "full_x")
    (part,) = (part for part in parts.parts(p) if part.block == "probe_x")
    assert flag not in part.region and set(part.next) == {"probe_x_n", "probe_x_last"}
    assert part.phase == ""
    u = {f"e_{n}": np.random.default_rng(4).uniform(-1, 1, 300).astype(F32) for n in AXES}
    outlined = emit(block, F32)
    assert outlined.files["probes.c"].count("probes_probe(") == 1 + len(AXES)
    ours = host.load(outlined.files, outlined.manifest).replay(u)
    for name in AXES:
        held = last = n = F32(0)
        for k, e in enumerate(u[f"e_{name}"]):
            held = F32(0) if n >= 7 else abs(e)
            assert ours.outputs[f"p_{name}"][k] == pytest.approx(e + 0.5 * n * held + last * (held - last), abs=1e-6)
            n, last = (min(n + F32(1), F32(7)) if held > 0.5 else F32(0)), e


def certified(name: str, bound: float) -> Block:
    """Return a lag whose limits a certificate proves idle, and a demand that is limited to both sides of its bound."""
    shown = Signal("ahead", "1", -bound, bound, "lag")

    def law(u: dict[str, ca.SX], x: dict[str, ca.SX], k: dict[str, ca.SX]) -> Step:
        ahead = ca.fmax(ca.fmin(x["p"] - 0.5 * (x["p"] - u[f"e_{name}"]), bound), -bound)
        w = ca.fmax(ca.fmin(k["k"] * ahead + 0.25 * x["p"], 0.125 * bound), -0.125 * bound)
        return Step({f"w_{name}": w}, {"p": ahead}, [(shown, ahead)], {"ahead": lambda u, e: bound * (1 - 8 * u)})

    return build(
        f"lag_{name}", TIME, law, inputs=[Signal(f"e_{name}", "1", -1, 1)], outputs=[Signal(f"w_{name}", "1", -9, 9)],
        states=[State(Signal("p", "1", -bound, bound), 0)], constants=[Constant("k", 2 + bound, "1", "test")],
    )  # fmt: skip


def test_a_function_has_a_bound_as_one_parameter_and_admits_what_is_certified(monkeypatch: pytest.MonkeyPatch) -> None:
    """What only a comment reads stands in a struct: as an argument a compiler would call it unused."""
    blocks = [certified(name, 2.125 + i / 8) for i, name in enumerate(AXES)]
    block = compose("lags", blocks, inputs=[f"e_{n}" for n in AXES], outputs=[f"w_{n}" for n in AXES])
    outlined = emit(block, F32)
    text = outlined.files["lags.c"]
    assert text.count("lags_lag(") == 1 + len(AXES)
    bound = "parameters->largest_ahead"
    assert f"admit -{bound} <= ahead <= {bound};" in text and "lags_limit((parameters->k" in text and "low" not in text
    monkeypatch.setattr(parts, "alike", lambda p: [])
    flat = emit(block, F32)
    assert "admit -2.125f <= " in flat.files["lags.c"]
    rng = np.random.default_rng(3)
    u = {f"e_{n}": rng.uniform(-1, 1, 300).astype(F32) for n in AXES}
    ours, theirs = (host.load(e.files, e.manifest).replay(u) for e in (outlined, flat))
    for name in (f"w_{n}" for n in AXES):
        np.testing.assert_array_equal(ours.outputs[name], theirs.outputs[name])


def watched() -> Block:
    """Return a watch of many operations whose result another Block reads only while a flag of the watch is set."""

    def watch(u: dict[str, ca.SX], x: dict[str, ca.SX], k: dict[str, ca.SX]) -> Step:
        e, size = u["e"], ca.fabs(u["e"])
        score = ca.sqrt(1 + e**2) * (2 - e) + (e + 0.25) * (e - 0.75) * (size + 1) + size * (e + 3)
        return Step({"far": size > 0.5, "score": score})

    def use(u: dict[str, ca.SX], x: dict[str, ca.SX], k: dict[str, ca.SX]) -> Step:
        return Step({"y": ca.if_else(u["far"], u["score"] * (u["e"] - 0.5) + u["score"], u["e"] * (u["e"] + 2))})

    e, far, score = Signal("e", "1", -1, 1), Signal("far", "1", 0, 1), Signal("score", "1", -99, 99)
    blocks = [
        build("watch", TIME, watch, inputs=[e], outputs=[far, score]),
        build("use", TIME, use, inputs=[e, far, score], outputs=[Signal("y", "1", -999, 999)]),
    ]
    return compose("pair", blocks, inputs=["e"], outputs=["y"])


def differing(block: Block) -> int:
    """Return how many outputs differ from those of the C whose step computes everything itself."""
    made = emit(block, F32)
    u = {"e": np.random.default_rng(5).uniform(-1, 1, 400).astype(F32)}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(parts, "alike", lambda p: [])
        patch.setattr(parts, "with_idle_results", lambda p: p)
        flat = emit(replace(block, name="flat"), F32)
    ours, theirs = (host.load(e.files, e.manifest).replay(u) for e in (made, flat))
    return int(np.count_nonzero(ours.outputs["y"] != theirs.outputs["y"]))


def test_what_others_do_not_read_is_not_computed(monkeypatch: pytest.MonkeyPatch) -> None:
    text = emit(watched(), F32).files["pair.c"]
    assert re.search(r"float score = 0\.0f;\n +if \(far\) \{", text), text
    assert differing(watched()) == 0
    contexts = parts._contexts

    def opposite(p: Program) -> list[frozenset[tuple[int, bool]] | None]:
        return [of and frozenset((k, not holds) for k, holds in of) for of in contexts(p)]

    monkeypatch.setattr(parts, "_contexts", opposite)  # the planted defect: 0 on the side that reads it
    assert differing(replace(watched(), name="opposite")) > 100


def test_a_function_compares_its_own_counts_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """An analyser relates no flag that a function is passed to the count that it follows from."""

    def count(u: dict[str, ca.SX], x: dict[str, ca.SX], k: dict[str, ca.SX]) -> Step:
        full = x["n"] >= 5
        n = ca.if_else(u["held"] > 0.5, ca.if_else(full, x["n"], x["n"] + 1), 0)
        return Step({"full": full, "w": u["held"] * (x["s"] + 1) + x["s"]}, {"n": n, "s": 0.5 * u["held"]})

    def judge(u: dict[str, ca.SX], x: dict[str, ca.SX], k: dict[str, ca.SX]) -> Step:
        return Step({"held": ca.if_else(u["full"], 0, ca.fabs(u["e"]) * (1 - 0.25 * u["e"] ** 2))})

    e, full, held = Signal("e", "1", -1, 1), Signal("full", "1", 0, 1), Signal("held", "1", 0, 1)
    states = [State(Signal("n", "1", 0, 5), 0, True), State(Signal("s", "1", 0, 1), 0)]
    blocks = [
        build("count", TIME, count, inputs=[held], outputs=[full, Signal("w", "1", -9, 9)], states=states),
        build("judge", TIME, judge, inputs=[e, full], outputs=[held]),
    ]
    block = compose("counts", blocks, inputs=["e"], outputs=["w"])

    def function(name: str) -> str:
        text = emit(replace(block, name=name), F32).files[f"{name}.c"]
        return text[text.index(f" {name}_count(") : text.index(f"void {name}_init(")]

    assert "if (n < 5u)" in function("counts") and "bool" not in function("counts")
    monkeypatch.setattr(parts, "_comparisons", lambda *_: frozenset())
    assert "bool" in function("flags")
