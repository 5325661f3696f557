"""The printed C, compiled and stepped, against CasADi's own evaluation of the Block: equal, to the last bit.

The Blocks' arithmetic is dyadic, so that neither folding nor single precision rounds anything.
"""

import re
from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, Constant, State, Step, build
from synth.emit import pipeline
from synth.emit.c import expressions, routines
from synth.emit.c import locals as variables
from synth.emit.passes import fold, schedule
from synth.emit.program import layout, lower
from synth.emit.program.lower import Node, Program
from synth.emit.proof import ranges as carriers
from synth.emit.write import emit
from synth.execute import compile as compiler
from synth.execute import host
from tests.emit import dyadic, hazards, one_step
from tests.emit.dyadic import TIME, signal

pytestmark = pytest.mark.slow

F32, F64 = np.float32, np.float64
SEEDS = range(24)
BATCH = 10  # Blocks in one library, where a planted defect is looked for


@pytest.mark.parametrize("scalar", [F32, F64])
def test_hazards_compute_what_casadi_computes(scalar: type[np.floating]) -> None:
    assert not one_step.differing_from_casadi(hazards.BLOCKS, scalar, 600)


@pytest.mark.parametrize("scalar", [F32, F64])
def test_random_blocks_compute_what_casadi_computes(scalar: type[np.floating]) -> None:
    assert not one_step.differing_from_casadi([dyadic.random_block(seed) for seed in SEEDS], scalar)


def test_random_blocks_replayed_from_init_follow_casadi() -> None:
    for block in (dyadic.random_block(1), dyadic.random_block(2), dyadic.random_block(6)):
        made, f, x = emit(block, F32), block.function(), block.initial
        controller = host.load(made.files, made.manifest)
        state, (_, u) = controller.init(), dyadic.samples(block, 60)
        for sample in u.T:
            next, y = f(x, sample)
            x = next.full().ravel()
            replay = controller.step(state, {s.name: v for s, v in zip(block.inputs, sample, strict=True)})
            assert [replay.outputs[s.name] for s in block.outputs] == list(y.full().ravel())
            assert [state[s.name] for s in block.states] == list(x)


def test_zig_reports_no_warning() -> None:
    blocks = [*hazards.BLOCKS[:8], hazards.flags(), *(dyadic.random_block(seed) for seed in range(4))]
    includes = []
    files: dict[str, str] = {}
    for i, block in enumerate(blocks):
        code = host.code(emit(block, F32 if i % 2 else F64).files)
        files |= {name: text for name, text in code.items() if name.endswith(".h")}
        # Static functions of many designs in one unit: each under names of its own.
        renamed = [f"#define {f} {f}_{i}\n" for f in ("min", "max", "limit", "flag")]
        undone = [f"#undef {f}\n" for f in ("min", "max", "limit", "flag")]
        includes += [*renamed, code[f"{block.name}.c"], *undone]
    compiler.check(files | {"all.c": "".join(includes)}, compiler=compiler.zig_compiler())


# --- planted defects ---


def leads(users: Any, ends: set[int], start: int, choices: set[int], inside: set[int]) -> bool:
    """Share a variable as soon as nothing outside the `if` reads it."""
    return start not in ends and (inside | choices).issuperset(users[start])


def every_load(p: Program, block: Sequence[Any]) -> list[int]:
    """Treat every load of a state as one that may be read where it is assigned."""
    return [k for k, node in enumerate(p.nodes) if node.op == "state"]


PLANTED: list[tuple[Any, str, Callable[..., Any]]] = [
    (variables, "_leads_only_to", leads),
    (variables, "_direct_loads", every_load),
    (carriers, "_only_in_counters", lambda p: set(range(len(p.nodes)))),
    (carriers, "is_whole", lambda node: True),
    (fold, "_truth", lambda f, a: a),
    (routines, "literal", lambda value, scalar: expressions.literal(round(value, 1), scalar)),
]


@pytest.mark.parametrize(("owner", "name", "defect"), PLANTED, ids=[name for _, name, _ in PLANTED])
def test_a_planted_defect_is_found(
    owner: Any, name: str, defect: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(owner, name, defect)
    # Without what else would refuse such C.
    monkeypatch.setattr(carriers, "require_whole", lambda program, proved: None)
    monkeypatch.setattr(compiler, "STRICT_FLAGS", ("-std=c99",))
    batches = (hazards.BLOCKS[k : k + BATCH] for k in range(0, len(hazards.BLOCKS), BATCH))
    assert any(one_step.differing_from_casadi(batch, F64, 300) for batch in batches)  # up to the first that finds it


def test_a_planted_change_of_the_c_is_found() -> None:
    for seed in (1, 4):
        block = dyadic.random_block(seed)
        made, (x, u) = emit(block, F64), dyadic.samples(block, 300)
        expected = one_step.by_casadi(block, x, u)
        conditions = re.findall(r"if \((?!!)(.+)\) \{", made.files[f"{block.name}.c"])
        assert conditions
        for condition in conditions[:3]:
            library = one_step.compile_together(
                [made], lambda text, c=condition: text.replace(f"if ({c}) {{", f"if (!({c})) {{", 1)
            )
            assert one_step.by_c(library, block, made, x, u).differences(expected)


# --- what the text says ---


def text(block: Block, scalar: type[np.floating] = F32) -> str:
    """Return the body of the step."""
    code = emit(block, scalar).files[f"{block.name}.c"]
    return code[code.index(f"{block.name}_step(") :]


def test_a_choice_reuses_the_variable_of_another_one() -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        bad = [u[n] > 1 for n in "abc"]
        late = x["late"]
        for c, n in zip(bad, ("p", "q", "r"), strict=True):
            late = ca.if_else(c, ca.if_else(x[n] <= 1, 1, late), late)
        counts = {n: ca.if_else(c, ca.fmax(x[n] - 1, 0), 5) for c, n in zip(bad, ("p", "q", "r"), strict=True)}
        return Step({"y": late}, counts | {"late": late})

    states = [*hazards.count("p"), *hazards.count("q"), *hazards.count("r"), State(signal("late", 0, 1), 0, True)]
    block = hazards.make("chain", law, "y", states)
    assert not one_step.differing_from_casadi([block], F32)
    assert len(re.findall(r"^    uint32_t \w+ = late;$", text(block), re.M)) == 1


def composed() -> Block:
    """Return a Block that stores a flag of a compound condition and chooses between sums."""

    def law(u: Any, x: Any, k: Any) -> Step:
        a, b, c = u["a"], u["b"], u["c"]
        bad = ca.logic_or(ca.logic_and(a < b, c > 1), x["bad"])
        return Step(
            {"y": ca.if_else(a < b, a - 0.5, c), "z": ca.if_else(c > 0, b, ca.if_else(bad, 1, 0))}, {"bad": bad}
        )

    return hazards.make("composed", law, "y z", [State(signal("bad", 0, 1), 0, True)])


def test_misra_casts_of_flags_and_compound_arms(monkeypatch: pytest.MonkeyPatch) -> None:
    """MISRA C rules 10.6 and 12.1, the latter as interpreted by cppcheck."""
    block, arm = composed(), r"\? \([^()]* - [^()]*\) :"
    assert not one_step.differing_from_casadi([block], F32)
    code = emit(block, F32).files["composed.c"]
    assert "static inline uint32_t composed_flag(bool holds)" in code and "state->bad = composed_flag(" in code
    assert not re.search(arm, code)
    monkeypatch.setattr(schedule, "_COMPOSED", frozenset())
    assert not re.search(arm, emit(block, F32).files["composed.c"])
    monkeypatch.setattr(expressions.Text, "is_bare", False)
    assert re.search(arm, emit(block, F32).files["composed.c"])


def test_a_choice_between_a_count_and_a_flag_is_a_count() -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        return Step({"y": u["a"]}, {"n": ca.if_else(u["a"] < u["b"], x["n"], ca.if_else(u["c"] < 1, u["a"] < 2, 5))})

    block = hazards.make("mixed", law, "y", hazards.count())
    assert not one_step.differing_from_casadi([block], F32)
    assert "(uint32_t)" not in text(block) and "flag(" in text(block)
    whole = Program(
        (
            Node("state", name="n"),
            Node("input", name="a"),
            Node("lt", (1, 1)),
            Node("choose", (2, 0, 2)),
            Node("choose", (2, 3, 1)),
        ),
        (),
        {},
        {},
        frozenset("n"),
    )
    assert carriers.kinds(whole)[3:] == ["integer", "real"]


def test_bits_of_the_word_are_set_one_by_one() -> None:
    code = text(hazards.flags())
    assert re.search(r"0x00000010u", code) and "0x00000020u" not in code
    assert re.search(r"return faults;\n\}\n$", code)


def test_a_title_is_printed_where_the_block_changes() -> None:
    titles = re.findall(r"/\* (\w+)(?: \*/)?\n", text(hazards.stored_by_an_earlier_block()))
    assert titles == ["hold"]  # the other one has a function


def test_lines_after_a_branch_belong_to_the_block_before_it() -> None:
    """The last tag of one side does not apply to the other side."""
    block = hazards.stored_by_an_earlier_block()
    rounded = block.rounded(F64)
    reduced = pipeline.reduce(rounded, F64)
    lines = pipeline.source(reduced, layout.layout(rounded, F64))
    tags = {line.text.strip(): line.tag for line in lines}
    assert tags["state->hold_x = a;"] == "hold" and tags["} else {"] == "use" and tags["out->z = z;"] == "use"


@pytest.mark.parametrize("scalar", [F32, F64])
def test_constants_may_have_names_that_the_c_reserves(scalar: type[np.floating]) -> None:
    names = [
        "min",
        "max",
        "limit",
        "flag",
        "fabs",
        "fabsf",
        "state",
        "in",
        "out",
        "faults",
        "uint32_t",
        "bool",
        "t1",
        "y",
        "min_",
    ]

    def law(u: Any, x: Any, k: Any) -> Step:
        total = sum(k[n] * u["p"] for n in names)
        y = (
            ca.fmax(ca.fmin(total, u["q"]), -u["q"])
            + ca.fmax(ca.fmin(u["p"], 2), u["q"])
            + ca.logic_and(u["p"] < 1, u["q"])
        )
        return Step({"y": y}, {"n": ca.fmin(x["n"] + 1, 7)})

    block = build(
        "named",
        TIME,
        law,
        inputs=[signal("p", -4, 4), signal("q", -4, 4)],
        outputs=[signal("y")],
        states=hazards.count(),
        constants=[Constant(n, 0.5**i, "1", "test") for i, n in enumerate(names)],
    )
    assert not one_step.differing_from_casadi([block], scalar, rtol=2.0**-20)


# --- kinds ---


def kinds(law: Callable[..., Step], states: Sequence[State] = ()) -> dict[str, str]:
    program = fold.folded(lower.program(hazards.make("kinds", law, "y", [*states, *hazards.count()])))
    kind_of = carriers.kinds(program)
    return {"y": kind_of[program.outputs["y"]]} | {f"next {n}": kind_of[k] for n, k in program.next.items()}


@pytest.mark.parametrize(
    ("e", "kind"),
    [
        (lambda u, n: n, "integer"),
        (lambda u, n: n + 1, "integer"),
        (lambda u, n: n + 0.5, "real"),
        (lambda u, n: n - 1, "real"),
        (lambda u, n: -n, "real"),
        (lambda u, n: 2 * n, "real"),
        (lambda u, n: n <= 3, "logical"),
        (lambda u, n: ca.if_else(u["a"] < 1, n, 3), "integer"),
        (lambda u, n: ca.if_else(u["a"] < 1, n, -3), "real"),
        (lambda u, n: ca.if_else(u["a"] < 1, n, n - 1), "real"),
        (lambda u, n: ca.if_else(u["a"] < 1, 0, 1), "logical"),
        (lambda u, n: ca.if_else(u["a"] < 1, u["b"] < 1, 1), "logical"),
        (lambda u, n: ca.if_else(u["a"] < 1, u["b"], 1), "real"),
        (lambda u, n: u["a"], "real"),
    ],
)
def test_the_kind_of_a_value_follows_from_its_expression(e: Callable[..., ca.SX], kind: str) -> None:
    assert kinds(lambda u, x, k: Step({"y": e(u, x["n"])}, {"n": x["n"]}))["y"] == kind


def test_a_difference_is_an_integer_if_only_an_integer_state_uses_it() -> None:
    def down(u: Any, x: Any, k: Any) -> Step:
        return Step({"y": u["a"]}, {"n": ca.if_else(x["n"] > 0, x["n"] - 1, 7)})

    def read(u: Any, x: Any, k: Any) -> Step:
        return Step({"y": 2 * (x["n"] - 1)}, {"n": ca.if_else(x["n"] > 0, x["n"] - 1, 7)})

    assert kinds(down)["next n"] == "integer" and kinds(read)["next n"] == "real"


def test_numbers_beyond_32_bits_are_not_integers() -> None:
    for value in (2.0**32, -1.0, 0.5, np.inf):
        nodes = (Node("state", name="n"), Node("literal", value=value), Node("add", (0, 1)))
        assert carriers.kinds(Program(nodes, (), {"y": 2}, {"n": 0}, frozenset({"n"})))[2] == "real"
