"""Cost of a step: all generators over the same steps, counts known by hand, and defects that the counts reveal."""

import json
from collections.abc import Sequence
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from benchmarks import axes
from synth.block import Block, State, Step, build
from synth.emit import write
from synth.emit.approx.polynomial import Polynomial
from synth.emit.program.lower import Node, Program
from synth.emit.write import EmittedCode
from synth.errors import CompileError, EmitError, SignalError
from synth.execute import compile as host_compiler
from synth.execute import cross, host, image
from synth.signals import Signal
from synth.timing import Discrete
from synth.verify import cost, meter, steps
from synth.verify.cost import Cost, Memory, StepCost, Summary
from synth.verify.meter import CallLayout, Candidate
from synth.verify.steps import Steps
from tests import tools
from tests.execute.planted import assembly

MADE = axes.block(2)
EMITTED = axes.emit(2, np.float32)
BUILDS = {b.compiler: b for b in reversed(meter.BUILDS)}  # without contraction
CLAMP = "cmp r0, #3; ite gt; movgt r0, #10; movle r0, #20; cbz r1, 1f; adds r0, #1; 1: bx lr"


def silent(_: str) -> None:
    """Ignore progress messages."""


@pytest.fixture(scope="module")
def controller() -> host.Controller:
    return host.load(EMITTED.files, EMITTED.manifest)


@pytest.fixture(scope="module")
def sequences(controller: host.Controller) -> list[Steps]:
    time = np.arange(400) * 1e-3
    moved = {"q1": 0.01 * np.sin(30 * time), "r1": 0.0, "q2": 0.02 * np.sin(30 * time), "r2": 0.001}
    faults = steps.fault_steps(controller, dict.fromkeys(("q1", "q2", "r1", "r2"), 0.01))
    loop = steps.record(controller, "loop", moved, closed_loop=True)
    return [loop, replace(faults, closed_loop=True), steps.random_steps(controller, 3000)]


@pytest.fixture(scope="module")
def design_cost(sequences: list[Steps]) -> Cost:
    return meter.measure(EMITTED, MADE, sequences, silent, common=40)


def of(design_cost: Cost, generator: str) -> list[StepCost]:
    return [f for f in design_cost.compared if f.generator == generator]


@tools.sees_more_with_tools
def test_every_generator_computes_the_same_step(design_cost: Cost) -> None:
    assert {(f.generator, f.build) for f in design_cost.compared} == {
        (g, b.name) for g in (cost.SYNTH, meter.CASADI, meter.CASADI_FLOAT) for b in meter.builds()
    }
    for f in design_cost.compared:
        # The emitted C is the host's to the bit unless contracted. The others round otherwise, in sums of terms up
        # to ten times the range, and w's own limits are a thousand times it.
        assert f.difference <= (0 if f.generator == cost.SYNTH and "contracted" not in f.build else 1e-5)


@tools.sees_more_with_tools
def test_double_arithmetic_is_detected_and_measured(design_cost: Cost) -> None:
    for ours, plain, shimmed in zip(*(of(design_cost, g) for g in ("synth", "casadi", "casadi, float")), strict=True):
        assert ours.doubles == shimmed.doubles == 0
        # This Block calls fmin and fmax alone, which clang narrows by itself.
        assert plain.doubles > 0 or "zig" in plain.build
        assert ours.issued.mean < shimmed.issued.mean < plain.issued.mean
        assert design_cost.ratio(ours) == 1 and design_cost.ratio(plain) == plain.issued.mean / ours.issued.mean


@tools.sees_more_with_tools
def test_bytes_are_those_of_the_structs(design_cost: Cost) -> None:
    sizes = {role: EMITTED.manifest["structs"][role]["size"] for role in ("state", "input", "output")}
    for f in design_cost.compared:
        m = f.memory
        twice = 2 if f.generator != "synth" else 1  # x and x'
        assert (m.state, m.signals) == (twice * 4 * len(MADE.states), sizes["input"] + sizes["output"])
        assert m.working == m.state + m.signals + m.stack + m.data and m.code > 100 and m.stack >= 0
    assert sizes["state"] == 4 * len(MADE.states)


@tools.sees_more_with_tools
def test_counts_are_consistent(design_cost: Cost, sequences: Sequence[Steps]) -> None:
    for f in design_cost.compared:
        assert f.steps == 40 and f.executed.mean <= f.issued.mean and f.executed.most <= f.issued.most
        assert f.issued.least <= f.issued.mean <= f.issued.most <= f.cycles[1].most
        assert sum(f.functions.values()) <= f.issued.mean + 1e-9
    for m in design_cost.sequences:
        assert m.steps == next(len(s) for s in sequences if s.name == m.name)
    whole = [m for m in design_cost.sequences if m.build == meter.builds()[0].name]
    assert design_cost.most[meter.builds()[0].name] == max(m.issued.most for m in whole)


@tools.sees_more_with_tools
def test_common_steps_have_no_fault(design_cost: Cost) -> None:
    """A latched step is cheap only for the emitted C and would distort the ratio."""
    latched = min(m.issued.least for m in design_cost.sequences if m.name == "faults")
    assert all(f.issued.least > latched + 20 for f in of(design_cost, "synth"))


@tools.sees_more_with_tools
def test_all_decisions_are_covered(design_cost: Cost) -> None:
    assert [c.build for c in design_cost.coverage] == [b.name for b in meter.builds()]
    assert all(c.decisions == c.both > 10 for c in design_cost.coverage), design_cost.coverage


def test_the_document_is_strict_json_with_units_and_notes(design_cost: Cost) -> None:
    document = json.loads(json.dumps(design_cost.document(), allow_nan=False))
    assert "not cycles" in document["note"] and document["core"] == "cortex-m4f"
    assert len(document["ratios"]) == len(design_cost.compared) and set(document["shares"]) == set(document["most"])
    shown = [row for t in cost.tables(design_cost) for row in t.rows]
    assert all(isinstance(cell, str) for row in shown for cell in row)
    assert all(len(row) == len(t.columns) for t in cost.tables(design_cost) for row in t.rows)
    assert [line.split(":")[0] for line in design_cost.absent] == list(meter.UNSUPPORTED)


def test_a_brief_cost_is_that_of_one_toolchain_on_every_machine() -> None:
    moved = {"q1": 0.01 * np.sin(np.arange(40) * 0.03), "r1": 0.0, "q2": 0.0, "r2": 0.001}
    brief = meter.brief(EMITTED, MADE, moved)
    assert [(c.generator, c.build, c.difference) for c in brief.compared] == [("synth", "zig, musl", 0.0)]
    assert list(brief.most) == ["zig, musl"] and brief.absent == (meter.NOT_COMPARED,)


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
def test_an_uncovered_branch_is_reported_with_its_line(
    compiler: str, controller: host.Controller, sequences: list[Steps]
) -> None:
    """Without faults the branches of fault handling and latch are uncovered, each reported with its line of C."""
    emitted, build = meter.emitted_source(EMITTED), BUILDS[compiler]
    lost = meter.coverage(emitted, meter.run(emitted, sequences[0], build), build)
    assert lost.both < lost.decisions and len(lost.missing) == lost.decisions - lost.both
    assert any("latched" in line and "axes_2.c:" in line for line in lost.missing)


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
def test_an_unreachable_branch_is_reported(compiler: str, sequences: list[Steps]) -> None:
    text = EMITTED.files["axes_2.c"].replace(
        "    return faults;", "    if (in->q1 == 0.0123456f) { state->guard.ready = 7u; }\n    return faults;"
    )
    planted = meter.emitted_source(EmittedCode(EMITTED.files | {"axes_2.c": text}, EMITTED.manifest))
    everything = steps.concatenate("all", sequences)
    lost = meter.coverage(planted, meter.run(planted, everything, BUILDS[compiler]), BUILDS[compiler])
    # A compiler may branch around what is planted or to it.
    assert lost.missing and all("taken; axes_2.c:" in line for line in lost.missing)
    assert all("q1 == 0.0123456f" in line for line in lost.missing)


def test_a_different_control_law_is_reported_as_a_difference(
    controller: host.Controller, sequences: list[Steps]
) -> None:
    """Planted defect: a baseline that computes something else must not count as cheaper."""
    text = meter.casadi(MADE, shimmed=True).files["axes_2_casadi.c"]
    assert "1.0000000000000001e-01f" in text  # amperes per m/s^2
    wrong = text.replace("1.0000000000000001e-01f", "1.1e-01f")
    planted = replace(meter.casadi(MADE, shimmed=True), files={"axes_2_casadi.c": wrong})
    build = meter.builds()[-1]
    assert meter.step_cost(planted, steps.thinned(sequences[0], 20), build, controller).difference > 1e-4


@pytest.mark.parametrize("build", tools.BUILDS)
def test_instructions_predicated_false_are_not_counted_as_executed(build: meter.Build) -> None:
    """cmp, ite, one of two moves, cbz, bx; and adds where r1 is not 0."""

    def lay_out(machine: image.Image, sequence: Steps) -> CallLayout:
        return CallLayout(np.array([[5, 0], [2, 1], [2, 0]]), dict)

    candidate = Candidate("clamp", assembly("clamp", CLAMP), "clamp", 0, 0, lay_out)
    none = Steps("none", np.zeros(3, [("x", "f4")]), np.zeros(3, [("u", "f4")]))
    assert meter.count_instructions(candidate, none, build).tolist() == [5, 6, 5]
    assert meter.run(candidate, none, build).cost.instructions.tolist() == [6, 7, 6]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a00=1.6799999999999999e-02;", "a00=1.6799999999999999e-02f;"),
        ("a=(0.5*b)-2.;", "a=(0.5f*b)-2.f;"),
        ("a=3e-7+x1.y;", "a=3e-7f+x1.y;"),
        ("if (res[0]!=0) res[0][12]=a1e3;", "if (res[0]!=0) res[0][12]=a1e3;"),
        ("#if __STDC_VERSION__ < 199901L", "#if __STDC_VERSION__ < 199901L"),
    ],
)
def test_literals_become_float(text: str, expected: str) -> None:
    assert meter.with_float_shim(f"#include <math.h>\n{text}\n").endswith(f"\n{expected}\n")


def functions_of_libm() -> Block:
    """A Block that calls every function of libm that the shim renames and CasADi prints."""

    def law(u: dict[str, ca.SX], x: dict[str, ca.SX], k: dict[str, ca.SX]) -> Step:
        a = u["a"]
        named = (ca.sin, ca.cos, ca.tan, ca.asin, ca.acos, ca.atan, ca.sinh, ca.cosh, ca.tanh, ca.asinh, ca.acosh)
        named += (ca.atanh, ca.exp, ca.log, ca.sqrt, ca.fabs, ca.floor, ca.ceil, ca.erf, ca.log1p, ca.expm1)
        pairs = ca.atan2(a, 0.3) + a**1.7 + ca.fmod(a, 0.2) + ca.hypot(a, 0.1) + ca.copysign(a, -1)
        return Step({"y": sum((f(a) for f in named), start=pairs + ca.fmin(a, 0.5) + ca.fmax(a, 0.1))})

    a, y = Signal("a", "1", 0.1, 0.9), Signal("y", "1", -99, 99)
    return build("libm", Discrete(1e-3), law, inputs=[a], outputs=[y], states=[], constants=[])


def test_the_shim_is_single_precision_everywhere() -> None:
    """Planted defect: the unmodified C of CasADi contains double calls and promotions."""
    plain, shimmed = (meter.casadi(functions_of_libm(), shimmed=s).files for s in (False, True))
    assert cross.double_symbols(shimmed) == () and len(cross.double_symbols(plain)) > 20
    strict = ("-std=c99", "-Wdouble-promotion", "-Wfloat-conversion", "-Werror")
    host_compiler.check(shimmed, strict)
    with pytest.raises(CompileError, match="float-conversion"):
        host_compiler.check(plain, strict)
    with pytest.raises(EmitError, match=r"found no `#include <math.h>`"):
        meter.with_float_shim("float f(float x);\n")


def test_operations_are_counted_by_kind() -> None:
    nodes = (
        Node("input", name="a"),
        Node("state", name="x"),
        Node("constant", name="k"),
        Node("literal", value=2.0),
        Node("mul", (0, 2)),
        Node("sq", (4,)),
        Node("polynomial", (5,), name="p"),
        Node("clamp", (6, 3)),
        Node("lt", (7, 3)),
        Node("choose", (8, 7, 1)),
    )
    p = Polynomial(-1, 1, 0, 1, "none", (1.0, 0.0, 3.0, 4.0), np.float32)  # three products, two sums
    program = Program(nodes, (), {"y": 9}, {"x": 9, "held": 1}, polynomials={"p": p})
    counted = {"mul": 5, "add": 2, "limit": 1, "compare": 1, "choice": 1, "load constant": 2, "load input": 1}
    assert cost.of_program(program) == counted | {"load state": 1, "store": 3}
    held = replace(program, next={"x": 1})  # what a state keeps is not stored
    assert cost.of_program(held)["store"] == 1


def test_operations_of_a_block() -> None:
    counted = cost.of_block(MADE, np.float32)
    four = cost.of_block(axes.block(4), np.float32)
    assert counted["limit"] == 2 and four["limit"] == 4  # one current each
    assert four["mul"] - counted["mul"] == counted["mul"] > 10  # the guard of the first axis multiplies nothing


def test_shares_and_ratios_by_hand() -> None:
    emitted = StepCost(
        "synth", "gcc", 1, Summary(840, 840.0, 840), Summary(1, 1, 1), (), {}, Memory(1, 2, 0, 8, 4, 16), 0, 0
    )
    other = replace(emitted, generator="casadi", issued=Summary(8400, 8400.0, 8400))
    measured = tuple(cost.SequenceCost(n, "gcc", 1, Summary(1, 1, most)) for n, most in (("a", 900), ("b", 1680)))
    design_cost = Cost(
        "d", "core", 1e-3, (emitted, other), measured, (), {"mul": 3, "add": 4, "load state": 9, "choice": 2}, ()
    )
    assert (
        design_cost.share(168.0) == pytest.approx(1e-3)
        and design_cost.ratio(other) == 10
        and design_cost.most == {"gcc": 1680}
    )
    assert design_cost.arithmetic == 7 and emitted.memory.working == 28
    assert design_cost.document()["instructions_per_operation"] == {"gcc": 120}


def test_no_closed_loop_is_named(sequences: list[Steps]) -> None:
    with pytest.raises(SignalError, match="closed loops"):
        meter.measure(EMITTED, MADE, sequences[2:], silent)


def test_sequences_without_steps_and_with_one_name_are_refused(
    controller: host.Controller, sequences: list[Steps]
) -> None:
    loop, _, drawn = sequences
    bad = np.flatnonzero(steps.evaluate(controller, drawn).faults)[:5]
    for message, refused in (
        ("'axes_2': found no steps in the sequence 'drawn', need", [loop, replace(drawn.part(slice(0)), name="drawn")]),
        ("in the sequence 'closed loops without faults', need", [replace(drawn.part(bad), closed_loop=True)]),
        ("several sequences named 'loop', need", [loop, drawn, loop]),
    ):
        with pytest.raises(SignalError, match=message):
            meter.measure(EMITTED, MADE, refused, silent)


def test_a_state_of_the_block_is_one_of_casadi() -> None:
    """CasADi stores counters and flags as floats, in the order of the Block."""

    def law(u: dict[str, ca.SX], x: dict[str, ca.SX], k: dict[str, ca.SX]) -> Step:
        count = ca.fmin(x["count"] + 1, 9)
        return Step({"y": 0.1 * x["count"] + x["slow"] + u["a"]}, {"slow": 0.5 * x["slow"], "count": count})

    a, y, slow = Signal("a", "1", -1, 1), Signal("y", "1", -9, 9), Signal("slow", "1", -1, 1)
    states = [State(Signal("count", "1", 0, 9), 0, integer=True), State(slow, 0.5)]
    made = build("mixed", Discrete(1e-3), law, inputs=[a], outputs=[y], states=states, constants=[])
    emitted = write.emit(made, np.float32)
    controller = host.load(emitted.files, emitted.manifest)
    loop = steps.record(controller, "loop", {"a": np.linspace(-1, 1, 12)}, closed_loop=True)
    last = meter.builds()[-1]
    for shimmed in (False, True):
        assert meter.step_cost(meter.casadi(made, shimmed), loop, last, controller).difference < 1e-6
