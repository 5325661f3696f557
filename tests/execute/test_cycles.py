"""Estimates against sums made by hand from the manual's table and from the examples that it prints."""

import numpy as np
import pytest

from synth.errors import SynthError
from synth.execute import cycles, image, trace
from tests.execute.planted import assembly, loaded

# The way back: bx, 1 + P with P of 1 to 3.
BACK_LOW, BACK_HIGH = 2, 4

CORE = {
    "mov r2, r3": (1, 1),
    "mla r2, r3, r3, r3; umull r2, r3, r2, r3": (2, 2),
    "udiv r2, r3, r3": (2, 12),
    "push {r4-r7, lr}; pop {r4-r7, lr}": (12, 12),
    "stm r0, {r1, r2, r3}; ldm r0, {r1, r2, r3}": (8, 8),
    "strd r2, r3, [r0]; ldrd r2, r3, [r0]": (6, 6),
    "b 1f; nop; 1: nop": (3, 5),
    "cmp r0, #0; bne 1f; nop; 1: nop": (4, 6),
    "cmp r0, #0; beq 1f; nop; 1: nop": (4, 4),
    "cbnz r0, 1f; nop; 1: nop": (3, 5),
    "cbz r0, 1f; nop; 1: nop": (3, 3),
}
FPU = {
    "vadd.f32 s0, s1, s2; vmul.f32 s3, s4, s5; vabs.f32 s6, s7; vneg.f32 s8, s9; vcmp.f32 s10, s11": (5, 5),
    "vmrs apsr_nzcv, fpscr": (1, 1),
    "vmla.f32 s0, s1, s2; vfma.f32 s3, s4, s5": (6, 6),
    "vpush {d8, d9}; vpop {d8, d9}": (10, 10),
    "vldr d0, [r0]; nop; vldr s4, [r0]": (3 + 1 + 2, 3 + 1 + 2),
    "vstr d0, [r0]; vstr s4, [r0]": (5, 5),
    "vldm r0, {s0-s2}": (4, 4),
    "vmov r2, r3, d0": (2, 2),
    "vmov s0, r2": (1, 2),
    "vmov.f32 s0, #1.0; vmov.f32 s1, s2": (2, 2),
    "vcvt.f32.s32 s0, s1": (1, 1),
}
# Least cycles; section 3.3.2 prints the totals of the first four pairs. The most takes every load alone.
PAIRS = {
    "ldr r2, [r0]; ldr r3, [r1]": (3, 4),
    "mov r3, r0; movs r2, #0; nop; ldr r2, [r1, r2]; str r2, [r3, #20]": (3 + 3, 3 + 4),
    "mov r3, r0; movs r2, #0; nop; ldr r0, [r1, r2]; str r1, [r3, r2]": (3 + 3, 3 + 4),
    "movs r2, #0; nop; ldr r3, [r0, r2]; ldr r3, [r1]; ldr r3, [r1, #4]": (2 + 4, 2 + 6),
    "str r1, [r0]; ldr r2, [r0]": (1 + 2, 2 + 2),  # nothing is pipelined behind a store
    "movs r2, #0; nop; str r1, [r0, r2]": (2 + 2, 2 + 2),
    "str r0, [r0]; ldr r2, [r0]; ldr r3, [r2]": (1 + 2 + 2, 6),  # the address is what was loaded
    "adds r2, r0, #4; ldr r3, [r2]": (1 + 1 + 2, 1 + 1 + 2),  # the address was just computed
    "adds r2, r0, #4; nop; ldr r3, [r2]": (1 + 1 + 2, 1 + 1 + 2),
    "ldr r2, 2f; b 1f; .align 2; 2: .word 5; 1: nop": (2 + 2 + 1, 3 + 4 + 1),  # a literal may meet the fetch
}
WAITS = {
    "vadd.f32 s0, s1, s2; vadd.f32 s3, s0, s2": (3, 3),  # consumed at once
    "vadd.f32 s0, s1, s2; nop; vadd.f32 s3, s0, s2": (3, 3),
    "vadd.f32 s0, s1, s2; vadd.f32 s3, s1, s2": (2, 2),
    "vmul.f32 s0, s1, s2; vmla.f32 s0, s3, s4": (1 + 3, 1 + 3),  # as the addend, which is taken a cycle later
    "vmul.f32 s0, s1, s2; vmla.f32 s5, s0, s4": (1 + 1 + 3, 1 + 1 + 3),
    "vmul.f32 s0, s1, s2; vstr s0, [r0]": (1 + 1 + 2, 1 + 1 + 2),
    "vmul.f32 s0, s1, s2; vpush {d0}; add sp, #8": (1 + 1 + 3 + 1, 1 + 1 + 3 + 1),
    "vabs.f32 s0, s1; vadd.f32 s2, s0, s0": (2, 2),  # no arithmetic: its result is not late
    "vadd.f32 s0, s1, s2; vadd.f32 s0, s1, s2; nop": (3, 3),  # written again, not read
}
DIVISIONS = {
    "vdiv.f32 s0, s1, s2; nop; nop; nop; vadd.f32 s3, s1, s2": (11 + 3 + 1, 14 + 3 + 1),
    "vdiv.f32 s0, s1, s2; vadd.f32 s3, s0, s2": (14 + 1 + 1, 14 + 1 + 1),
    "vsqrt.f32 s0, s1; nop": (1 + 1, 14 + 1),  # no other instruction of the FPU follows
    "vdiv.f32 s0, s1, s2;" + "nop;" * 20 + "vadd.f32 s3, s1, s2": (1 + 20 + 1, 14 + 20 + 1),
}
# IT behind a narrow instruction may cost nothing, behind a wide one it costs a cycle; what is skipped costs one.
PREDICATED = {
    "cmp r0, #0; it eq; ldreq r2, [r0]": (2, 3),
    "cmp.w r0, #0; it eq; ldreq r2, [r0]": (3, 3),
    "cmp r0, #0; it ne; ldrne r2, [r0]": (3, 4),
    "cmp r0, #0; it ne; bne 1f; nop; 1: nop": (1 + 0 + 2 + 1, 1 + 1 + 4 + 1),
}
ALL = {**CORE, **FPU, **PAIRS, **WAITS, **DIVISIONS, **PREDICATED}


@pytest.fixture(scope="module")
def planted() -> image.Image:
    """Return one image with each body as a separate function."""
    names = [f"f{k}" for k in range(len(ALL))]
    texts = [text for n, body in zip(names, ALL, strict=True) for text in assembly(n, f"{body}; bx lr").values()]
    return loaded({"all.c": "".join(texts)}, names)


@pytest.mark.parametrize("body", ALL)
def test_sums_by_hand(planted: image.Image, body: str) -> None:
    at = planted.reserve(64)
    estimate = planted.measure(f"f{list(ALL).index(body)}", np.array([[at, at + 16]])).cost.cycles
    assert estimate is not None
    assert (estimate.low[0] - BACK_LOW, estimate.high[0] - BACK_HIGH) == ALL[body]


def test_every_call_is_estimated_by_itself() -> None:
    machine = loaded(assembly("f", "1: vadd.f32 s0, s0, s1; subs r0, #1; bne 1b; bx lr"), ["f"])
    cost = machine.measure("f", np.array([[n] for n in (1, 4, 2)])).cost
    assert cost.cycles is not None
    assert cost.cycles.low.tolist() == [2 * n + 2 * (n - 1) + 1 + BACK_LOW for n in (1, 4, 2)]
    assert cost.cycles.high.tolist() == [2 * n + 4 * (n - 1) + 1 + BACK_HIGH for n in (1, 4, 2)]


def path_of(machine: image.Image) -> trace.Trace:
    with trace.attach(machine.engine) as record:
        machine.call("f")
        record.end_call()
        return trace.reconstruct_path(machine.code, record.take())


@pytest.mark.parametrize(
    ("body", "low"),
    [
        ("ldr r2, [r0]; str lr, [sp, #-4]!; ldr pc, [sp], #4", 2 + 1 + (2 + 1)),  # a load last and a load first
        ("it eq; moveq r1, #1; bx lr", 1 + 1 + BACK_LOW),  # nothing before the IT to fold it onto
    ],
)
def test_no_call_depends_on_the_one_before(body: str, low: int) -> None:
    machine = loaded(assembly("f", body), ["f"])
    cost = machine.measure("f", np.array([[machine.reserve(8)]] * 3)).cost
    assert cost.cycles is not None and cost.cycles.low.tolist() == [low] * 3


@pytest.mark.parametrize("line", ["vrintz.f32 s0, s1", "vadd.f64 d0, d1, d2", "vcvt.f64.f32 d0, s1"])
def test_instructions_without_a_row_are_named(line: str) -> None:
    machine = loaded(assembly("f", f".fpu fpv5-d16; {line}; bx lr"), ["f"], core="cortex-m7")
    with pytest.raises(SynthError, match=f"`{line}` at .* has no row"):
        cycles.estimate(cycles.timing(machine.code), path_of(machine))


def test_no_estimate_without_a_published_table() -> None:
    cost = loaded(assembly("f", "nop; bx lr"), ["f"], core="cortex-m7").measure("f", np.array([[0]])).cost
    assert cost.cycles is None and cost.instructions.tolist() == [2]


def test_every_row_names_its_source() -> None:
    names = [name for row in cycles.TABLE for name in row.mnemonics.split()]
    assert len(names) == len(set(names))
    assert all(row.source.startswith("section ") and row.low <= row.high for row in cycles.TABLE)
