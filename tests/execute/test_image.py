"""Calls on an emulated core: words and memory in and out, the stack, and what happens on invalid memory access."""

import casadi as ca
import numpy as np
import pytest

from synth.emit.c import c_text
from synth.errors import CompileError, SignalError, SynthError
from tests import tools
from tests.execute import planted
from tests.execute.planted import assembly

MANY = """#include <stdint.h>
int32_t many(int32_t a, int32_t b, int32_t c, int32_t d, int32_t e, const int32_t *f);
int32_t many(int32_t a, int32_t b, int32_t c, int32_t d, int32_t e, const int32_t *f) {
    return a + 2 * b + 3 * c + 5 * d + 7 * e + 11 * f[1];
}
"""
DEEP = """#include <stdint.h>
uint32_t deep(uint32_t n);
uint32_t __attribute__((noinline)) deep(uint32_t n) {
    volatile uint32_t kept[4] = {n, n, n, n};
    return n == 0u ? kept[0] : deep(n - 1u) + kept[3];
}
"""


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
def test_arguments_on_the_stack_and_in_memory(compiler: str) -> None:
    machine = planted.loaded({"many.c": MANY}, ["many"], compiler=compiler)
    at = machine.place(np.array([9, -4], dtype=np.int32))
    assert machine.call("many", -1, 2, 3, 4, 5, at) == (-1 + 4 + 9 + 20 + 35 - 44) & 0xFFFFFFFF
    rows = np.array([[1, 0, 0, 0, k, at] for k in range(4)])
    assert machine.calls("many", rows).view(np.int32).tolist() == [1 + 7 * k - 44 for k in range(4)]
    assert machine.measure("many", rows).results.view(np.int32).tolist() == [1 + 7 * k - 44 for k in range(4)]


def test_memory_keeps_what_is_written() -> None:
    machine = planted.loaded(assembly("bump", "ldr r1, [r0]; adds r1, #1; str r1, [r0]; mov r0, r1; bx lr"), ["bump"])
    first, second = machine.reserve(5000), machine.reserve(1)
    assert second >= first + 5000 and machine.read(first, 5000) == bytes(5000)
    machine.write(second, b"\x07\0\0\0")
    assert [machine.call("bump", second) for _ in range(3)] == [8, 9, 10]
    assert machine.read(second, 4) == b"\x0a\0\0\0"
    for outside in (0x40, 0x7FFFFFF0, second + 4096):
        with pytest.raises(SynthError, match=f"8 bytes at {outside:#x} are not reserved"):
            machine.read(outside, 8)
        with pytest.raises(SynthError, match=f"1 bytes at {outside:#x} are not reserved"):
            machine.write(outside, b"\0")
    with pytest.raises(SynthError, match="do not fit"):
        machine.reserve(1 << 32)


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
def test_the_deepest_call_gives_the_stack(compiler: str) -> None:
    machine = planted.loaded({"deep.c": DEEP}, ["deep"], compiler=compiler)
    flat, *deeper = (machine.measure("deep", np.array([[n]])).cost.stack_bytes for n in (0, 1, 9))
    frame = deeper[0] - flat
    assert 24 <= frame <= 64 and deeper[1] == flat + 9 * frame  # four words, a return address, what is saved
    assert machine.measure("deep", np.array([[0], [9], [1]])).cost.stack_bytes == deeper[1]
    assert machine.call("deep", 3) == 6


@pytest.mark.parametrize(
    ("body", "taken"),
    [
        ("bx lr", 0),
        ("push {r4, lr}; pop {r4, pc}", 8),
        ("sub sp, #40; add sp, #40; bx lr", 40),  # claimed, though nothing is written
        ("sub sp, #8; str r0, [sp, #4]; vpush {d8}; vpop {d8}; add sp, #8; bx lr", 16),
        ("str r0, [sp, #-24]; bx lr", 24),  # written, though not claimed
    ],
)
def test_stack_that_is_claimed_or_written(body: str, taken: int) -> None:
    assert planted.loaded(assembly("f", body), ["f"]).measure("f", np.array([[1]])).cost.stack_bytes == taken


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("movs r0, #0; ldr r0, [r0]; bx lr", "memory"),
        ("udf #0", "exception|instruction"),
        ("1: push {r0-r7}; b 1b", "memory"),  # the stack overflows
        ("movs r0, #0; bx r0", "memory|instruction"),
    ],
)
def test_invalid_accesses_are_reported(body: str, says: str) -> None:
    machine = planted.loaded(assembly("invalid", body), ["invalid"])
    with pytest.raises(SynthError, match=f"(?i)'invalid' on the emulated cortex-m4f: .*({says}).* at 0x"):
        machine.call("invalid", 1)


def test_code_that_flushes_to_zero_is_refused() -> None:
    body = "vmrs r1, fpscr; orr r1, r1, #0x1000000; vmsr fpscr, r1; bx lr"
    machine = planted.loaded(assembly("flush", body), ["flush"])
    for run in (lambda: machine.call("flush"), lambda: machine.measure("flush", np.array([[0]]))):
        with pytest.raises(SynthError, match="mode bits 0x1000000"):
            run()


def test_subnormals_are_kept() -> None:
    machine = planted.loaded(
        assembly("halve", "vmov s0, r0; vmov.f32 s1, #0.5; vmul.f32 s0, s0, s1; vmov r0, s0; bx lr"), ["halve"]
    )
    assert machine.call("halve", 0x00800000) == 0x00400000  # half of the least normal number
    assert machine.call("halve", 3) == 2  # 1.5 units in the last place go to the even neighbour
    assert machine.call("halve", 1) == 0


def test_missing_functions_are_named() -> None:
    machine = planted.loaded(assembly("f", "bx lr"), ["f"])
    for run in (lambda: machine.call("g"), lambda: machine.measure("g", np.array([[0]]))):
        with pytest.raises(CompileError, match="no function 'g'"):
            run()
    with pytest.raises(CompileError, match="no function 'g'"):
        planted.size(assembly("f", "bx lr"), "g")
    with pytest.raises(SignalError, match="found 0 calls"):
        machine.measure("f", np.zeros((0, 1), dtype=np.int64))


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
def test_c_of_casadi_can_be_measured(compiler: str) -> None:
    """`int f(const double **arg, double **res, long long *iw, double *w, int mem)` over N argument vectors."""
    x, y = ca.SX.sym("x", 3), ca.SX.sym("y")
    f = ca.Function("f", [x, y], [ca.dot(x, x) * y, ca.if_else(y > 0, x[0] - y, x[1] * y)])
    machine = planted.loaded(c_text.functions([f], "f"), ["f"], "cortex-m7", compiler)
    samples = np.random.default_rng(4).normal(size=(20, 4))
    inputs_at, outputs_at = machine.place(samples), machine.reserve(20 * 16)
    rows = []
    for k in range(len(samples)):
        arg = machine.place(np.array([inputs_at + 32 * k, inputs_at + 32 * k + 24], dtype=np.uint32))
        res = machine.place(np.array([outputs_at + 16 * k, outputs_at + 16 * k + 8], dtype=np.uint32))
        rows.append([arg, res, machine.reserve(8 * f.sz_iw()), machine.reserve(8 * f.sz_w()), 0])
    results, cost = machine.measure("f", np.array(rows))
    assert not results.any() and cost.instructions.shape == (20,) and cost.instructions.min() > 10
    values = np.frombuffer(machine.read(outputs_at, 20 * 16)).reshape(20, 2)
    expected = np.array([[float(v) for v in f(s[:3], s[3])] for s in samples])
    assert np.array_equal(values, expected)
