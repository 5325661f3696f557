"""Small sources for tests of machine code: functions in assembly, and a step without calls of libm."""

from collections.abc import Mapping, Sequence
from typing import Any

from synth.execute import cross, elf
from synth.execute.image import Image, boot

_HEADER = """#include <stdint.h>
typedef REAL real;
typedef struct { real u; real gain; } lag_input_t;
typedef struct { real y; real root; } lag_output_t;
typedef struct { real xi[2]; uint32_t bad; uint32_t ticks; } lag_state_t;
void lag_init(lag_state_t *state);
uint32_t lag_step(lag_state_t *state, const lag_input_t *in, lag_output_t *out);
"""
# Newton's iteration for a root, a filter, a clamp and a guard: products that a fused multiply-add rounds otherwise.
_SOURCE = """#include "lag.h"
static real root(real x) {
    real r = (real)0.5 * ((real)1 + x);
    for (int i = 0; i < 4; i++) r = (real)0.5 * (r + x / r);
    return r;
}
void lag_init(lag_state_t *state) {
    state->xi[0] = (real)0.25;
    state->xi[1] = (real)-0.5;
    state->bad = 0u;
    state->ticks = 7u;
}
uint32_t lag_step(lag_state_t *state, const lag_input_t *in, lag_output_t *out) {
    const int good = in->u >= (real)-2 && in->u <= (real)2;
    const real u = good ? in->u : (real)0;
    const real x = (real)0.9 * state->xi[0] - (real)0.2 * state->xi[1] + u;
    const real y = in->gain * x + (real)0.3 * state->xi[1];
    out->y = y > (real)3 ? (real)3 : y < (real)-3 ? (real)-3 : y;
    out->root = root(x * x);
    state->xi[1] = state->xi[0];
    state->xi[0] = x;
    state->bad += good ? 0u : 1u;
    state->ticks += 1u;
    return state->ticks << 1 | (good ? 0u : 1u);
}
"""


def assembly(name: str, body: str) -> dict[str, str]:
    """Return C of one file that defines the Thumb function `name`; instructions of `body` are separated by `;`."""
    lines = [
        f'.section .text.{name},\\"ax\\",%progbits',
        *(".syntax unified", ".thumb", f".global {name}", f".type {name},%function", ".thumb_func", f"{name}:"),
        *body.split(";"),
        f".size {name}, . - {name}",
    ]
    return {f"{name}.c": "__asm__(" + "\n".join(f'"{line.strip()}\\n"' for line in lines) + ");\n"}


def lag(scalar: str) -> tuple[dict[str, str], dict[str, Any]]:
    """Return sources and manifest of the step in a scalar type."""
    n, real = (4, "float") if scalar == "float32" else (8, "double")
    layout = {
        "input": [("u", 0, 1, real), ("gain", n, 1, real)],
        "output": [("y", 0, 1, real), ("root", n, 1, real)],
        "state": [("xi", 0, 2, real), ("bad", 2 * n, 1, "uint32_t"), ("ticks", 2 * n + 4, 1, "uint32_t")],
    }
    structs = {
        role: {
            "type": f"lag_{role}_t",
            "size": size,
            "fields": [dict(zip(("name", "offset", "count", "ctype"), f, strict=True)) for f in layout[role]],
        }
        for role, size in (("input", 2 * n), ("output", 2 * n), ("state", 2 * n + 8))
    }
    functions = {"init": "lag_init", "step": "lag_step"}
    manifest = {"design": "lag", "period_s": 0.001, "scalar": scalar, "functions": functions, "structs": structs}
    return {"lag.h": _HEADER.replace("REAL", real), "lag.c": _SOURCE}, manifest


def loaded(
    sources: Mapping[str, str], entries: Sequence[str], core: str = "cortex-m4f", compiler: str = "zig"
) -> Image:
    """Build sources for a core and load them into an emulator; `entries` are the roots of the image."""
    program = elf.read(cross.link(sources, entries, core, compiler))
    return boot(program, core, cross.functions(sources, core, compiler))


def size(sources: Mapping[str, str], entry: str, core: str = "cortex-m4f", compiler: str = "zig") -> elf.Size:
    """Return the size of an image with a function as its only root."""
    program = elf.read(cross.link(sources, [entry], core, compiler))
    program.address(entry)
    return program.size()
