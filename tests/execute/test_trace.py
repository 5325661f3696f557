"""Counts are known by hand: the functions are written in assembly, instruction by instruction."""

import numpy as np
import pytest

from synth.errors import SynthError
from synth.execute import elf, image, trace
from tests import tools
from tests.execute import planted
from tests.execute.planted import assembly

CLAMP = "cmp r0, #3; ite gt; movgt r0, #10; movle r0, #20; cbz r1, 1f; adds r0, #1; 1: bx lr"
LOOP = "movs r2, #0; 1: adds r2, r2, r0; subs r1, #1; bne 1b; mov r0, r2; bx lr"


def loaded(name: str, body: str, compiler: str = "zig") -> image.Image:
    return planted.loaded(assembly(name, body), [name], compiler=compiler)


def directions(cost: image.Cost) -> list[tuple[str, int, int]]:
    return [(site.text.split()[0].removesuffix(".w"), site.taken, site.not_taken) for site in cost.sites]


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
def test_instructions_predicated_false_count(compiler: str) -> None:
    results, cost = loaded("clamp", CLAMP, compiler).measure("clamp", np.array([[5, 0], [2, 1], [2, 0]]))
    # cmp, ite, both moves, cbz and bx always; adds only where r1 is not 0.
    assert cost.instructions.tolist() == [6, 7, 6] and results.tolist() == [10, 21, 20]
    assert {name: n.tolist() for name, n in cost.by_function.items()} == {"clamp": [6, 7, 6]}


def test_the_record_of_the_emulator_omits_them() -> None:
    """The emulator records 5 of these 6 instructions: its hook runs after the test of the condition."""
    machine = loaded("clamp", CLAMP)
    with trace.attach(machine.engine) as record:
        machine.call("clamp", 5, 0)
        record.end_call()
        taken = record.take()
    assert len(taken.addresses) == 5
    assert trace.reconstruct_path(machine.code, taken).passed.tolist() == [True, True, True, False, True, True]


def test_a_whole_block_of_the_fpu_may_be_skipped() -> None:
    body = "vmov s0, r0; vcmp.f32 s0, #0; vmrs apsr_nzcv, fpscr; itt mi; vnegmi.f32 s0, s0; vaddmi.f32 s0, s0, s0;"
    results, cost = loaded("fold", body + "vmov r0, s0; bx lr").measure("fold", floats(1.5, -1.5))
    assert cost.instructions.tolist() == [8, 8] and results.view(np.float32).tolist() == [1.5, 3.0]
    assert directions(cost) == [("vnegmi.f32", 1, 1)]


def floats(*values: float) -> np.ndarray:
    return np.array(values, dtype=np.float32).view(np.uint32)[:, None].astype(np.int64)


def test_loops_and_calls_count_by_function() -> None:
    sources = assembly("sum", LOOP) | assembly("twice", "push {r4, lr}; bl sum; lsls r0, r0, #1; pop {r4, pc}")
    results, cost = planted.loaded(sources, ["twice"]).measure("twice", np.array([[5, 1], [5, 4]]))
    assert results.tolist() == [10, 40]
    assert {name: n.tolist() for name, n in cost.by_function.items()} == {"sum": [6, 15], "twice": [4, 4]}
    assert directions(cost) == [("bne", 3, 2)]


def test_uncovered_outcomes_are_listed() -> None:
    machine = loaded("clamp", CLAMP)
    cost = machine.measure("clamp", np.array([[5, 0], [6, 0]])).cost
    assert directions(cost) == [("movgt", 2, 0), ("cbz", 2, 0)]
    assert [site.missing for site in cost.missing] == ["not taken", "not taken"]
    where = machine.program.address("clamp")
    assert [site.address - where for site in cost.missing] == [4, 8] and cost.missing[0].function == "clamp"
    both = machine.measure("clamp", np.array([[5, 0], [2, 1]])).cost
    assert not both.missing and len(both.sites) == 2


def test_unreached_decisions_are_missing() -> None:
    body = "cmp r0, #0; beq 1f; cmp r1, #0; beq 1f; movs r0, #1; 1: bx lr"
    cost = loaded("both", body).measure("both", np.array([[0, 0]])).cost
    assert [site.missing for site in cost.sites] == ["not taken", "reached"]


@pytest.mark.parametrize(
    ("body", "decisions"),
    [
        ("cmp r0, r1; itete lt; movlt r0, #1; movge r0, #2; movlt r1, #3; movge r1, #4; bx lr", ["movlt"]),
        ("cmp r0, #1; itt eq; cmpeq r1, #1; moveq r0, #7; bx lr", ["cmpeq", "moveq"]),
        ("cmp r0, #1; beq 1f; bgt 1f; cmp r1, #1; it lt; movlt r0, #3; 1: bx lr", ["beq", "bgt", "movlt"]),
        ("cmp r0, #1; it ne; bxne lr; movs r0, #9; bx lr", ["bxne"]),
        ("cmp r0, #1; it ge; movge r0, #2; it lt; movlt r0, #5; bx lr", ["movge", "movlt"]),
    ],
)
def test_every_condition_is_a_decision_once(body: str, decisions: list[str]) -> None:
    calls = np.array([[a, b] for a in (0, 1, 2) for b in (0, 1, 2)])
    cost = loaded("decide", body).measure("decide", calls).cost
    assert [text for text, *_ in directions(cost)] == decisions and not cost.missing


def test_a_long_record_is_evaluated_in_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    machine, calls = loaded("sum", LOOP), np.array([[3, n] for n in (1, 30, 2, 30, 30, 1, 5)])
    whole = machine.measure("sum", calls).cost
    monkeypatch.setattr(trace.attach.__wrapped__, "__defaults__", (200,))  # two calls of 30 rounds and a bit
    parts = machine.measure("sum", calls).cost
    assert parts.instructions.tolist() == whole.instructions.tolist() == [3 + 3 * n for n in calls[:, 1]]
    assert machine.measure("sum", calls[:4]).cost.instructions.tolist() == whole.instructions[:4].tolist()  # ends full
    assert parts.sites == whole.sites and parts.cycles is not None and whole.cycles is not None
    assert parts.cycles.high.tolist() == whole.cycles.high.tolist()
    with pytest.raises(SynthError, match="303 instructions"):
        machine.measure("sum", np.array([[1, 100]]))


def test_measurement_ends_with_the_call() -> None:
    """Code can be measured after it ran without a recorder, and runs without one after the measurement."""
    machine = loaded("sum", LOOP)
    assert machine.call("sum", 2, 3) == 6
    assert machine.measure("sum", np.array([[2, 3]])).cost.instructions.tolist() == [12]
    with trace.attach(machine.engine) as record:
        pass
    assert machine.call("sum", 2, 3) == 6 and record.take().addresses.size == 0


def test_an_impossible_path_is_refused() -> None:
    code = loaded("sum", LOOP).code
    start = int(code.program.address("sum"))
    for offsets, says in (((0, 4), "not predicated"), ((0, 1), "need an instruction"), ((0, 2, 0), "not predicated")):
        wrong = trace.Record(np.array([start + o for o in offsets], np.uint32), np.array([len(offsets)]))
        with pytest.raises(SynthError, match=says):
            trace.reconstruct_path(code, wrong)


def test_addresses_map_to_functions() -> None:
    program = loaded("sum", LOOP).program
    first = program.functions[[f.name for f in program.functions].index("sum")]
    inside = program.function_at(np.array([first.address, first.address + first.size - 2]))
    assert [program.functions[i].name for i in inside] == ["sum", "sum"]
    assert program.function_at(np.array([0, 1 << 31])).tolist() == [len(program.functions)] * 2
    assert elf.OUTSIDE not in {f.name for f in program.functions}
