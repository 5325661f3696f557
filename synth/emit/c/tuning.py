"""C of the constants that are tuned on the machine: their struct, its check, and the function that moves them.

typedef struct { .. uint32_t check; } <name>_parameters_t;
extern const <name>_parameters_t <name>_parameters_default;         the declared design
uint32_t <name>_parameters_check(const <name>_parameters_t *parameters);
uint32_t <name>_tune(<name>_state_t *state, const <name>_parameters_t *parameters, uint32_t left);

The check covers the bits of all values and the declaration: half of a change, and a set for other C, do not pass it.
"""

import hashlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from synth.block import Block
from synth.emit.c.expressions import literal
from synth.emit.c.lines import comment, rows
from synth.emit.program.layout import Layout, Struct

FACTOR = 0x9E3779B1  # odd, near 2^32 over the golden ratio: each bit of a word spreads over those above
CHECK, RANGE, LEFT = 1, 2, 4  # bits of what `tune` refuses
REFUSALS = {
    CHECK: "the check does not fit the values: half of a change, or parameters of other C",
    RANGE: "a value is not finite, or outside its range",
    LEFT: "no call is left",
}


def check(values: Sequence[np.floating], seed: int) -> int:
    """Return the check of values in their scalar type."""
    total = seed
    for word in np.array(values).view("<u4").tolist():
        mixed = (total ^ word) * FACTOR
        total = (mixed >> 32) ^ (mixed & 0xFFFFFFFF)
    return total


def seed(parameters: Struct) -> int:
    """Return what the check starts from: it follows from type, names and ranges."""
    declared = repr([(parameters.type, *((f.name, f.ctype, f.low, f.high) for f in parameters.fields))])
    return int.from_bytes(hashlib.sha256(declared.encode()).digest()[:4], "little")


def defaults(block: Block, layout: Layout) -> dict[str, float]:
    """Return the declared values by name, in the scalar type."""
    return {s.name: float(layout.scalar(s.initial)) for s in block.states if s.name in block.tunable}


def manifest_entry(block: Block, layout: Layout) -> dict[str, Any]:
    """Return what a program needs to know to tune; nothing for a Block without constants that may change."""
    if layout.parameters is None:
        return {}
    return {
        "functions": {"tune": f"{block.name}_tune", "check": f"{block.name}_parameters_check"},
        "calls": block.ramp,
        "seed": seed(layout.parameters),
        "default": defaults(block, layout),
        "refused": {str(bit): about for bit, about in REFUSALS.items()},
    }


def declaration(block: Block, layout: Layout) -> list[str]:
    """Return what the header says of tuning; nothing for a Block without constants that may change."""
    if layout.parameters is None:
        return []
    name, n = block.name, block.ramp
    bits = [f" *   bit {bit.bit_length() - 1}  {about}" for bit, about in REFUSALS.items()]
    return [
        *comment("The declared design, from which init starts."),
        *(f"extern const {name}_parameters_t {name}_parameters_default;", ""),
        *comment("The check that belongs to the values of `parameters`: set it last."),
        *(f"{check_head(name)};", ""),
        "/* Move the constants of the law to `parameters`, which do not change during the call: one call between two",
        f" * steps, `left` = {n}, {n - 1}, .. 1. With 1 they are reached. It returns 0, or why nothing is changed:",
        *(*bits, " */", *rows(f"{tune_head(name)};"), ""),
    ]


def check_head(name: str) -> str:
    """Return the declaration of the function that computes the check."""
    return f"uint32_t {name}_parameters_check(const {name}_parameters_t *parameters)"


def tune_head(name: str) -> str:
    """Return the declaration of the function that moves the constants."""
    return f"uint32_t {name}_tune({name}_state_t *state, const {name}_parameters_t *parameters, uint32_t left)"


def definitions(block: Block, layout: Layout) -> list[str]:
    """Return the default and the functions; nothing for a Block without constants that may change."""
    if layout.parameters is None:
        return []
    name, t, names = block.name, layout.ctype, block.tunable
    paths = {f.name: f.path for f in layout.state.fields}
    start, words = seed(layout.parameters), layout.scalar(0).itemsize // 4
    fields = [f for f in layout.parameters.fields if f.name in names]
    values, one = defaults(block, layout), literal(1.0, layout.scalar).c
    default_check = check([layout.scalar(v) for v in values.values()], start)

    def numbers(of: Mapping[str, float], indent: str) -> list[str]:
        return [f"{indent}.{n} = {literal(v, layout.scalar).c}," for n, v in of.items()]

    lines = [f"const {name}_parameters_t {name}_parameters_default = {{", *numbers(values, "    ")]
    lines += [f"    .check = 0x{default_check:08x}u,", "};", ""]
    lines += [f"static inline uint32_t {name}_mixed(uint32_t check, {t} value)", "{"]
    lines += [
        f"    static const uint32_t spread = 0x{FACTOR:08x}u;",
        "    static const uint32_t half = 32u;",
        "",
        f"    uint32_t bits[{words}] = {{0u}};",
    ]
    lines += ["    (void)memcpy((uint8_t *)bits, (const uint8_t *)&value, sizeof bits);", "    uint64_t mixed = check;"]
    for i in range(words):
        lines += [f"    mixed = (mixed ^ bits[{i}]) * spread;", "    mixed = (mixed >> half) ^ (mixed & 0xffffffffu);"]
    lines += ["    return (uint32_t)mixed;", "}", ""]
    lines += [f"static inline uint32_t {name}_checked(const {name}_parameters_t *parameters)"]
    lines += ["{", f"    uint32_t check = 0x{start:08x}u;"]
    lines += [f"    check = {name}_mixed(check, parameters->{n});" for n in names]
    lines += ["    return check;", "}", ""]
    lines += [check_head(name), "{", f"    return {name}_checked(parameters);", "}", ""]
    lines += [f"static inline bool {name}_holds({t} value, {t} low, {t} high)"]
    lines += ["{", "    return (value >= low) && (value <= high);", "}", ""]
    lines += comment("The value moved by a part of the way to a target; rounding does not leave the range.")
    lines += [f"static inline {t} {name}_moved({t} value, {t} target, {t} part, {t} low, {t} high)", "{"]
    lines += [f"    const {t} moved = (target * part) + (value * ({one} - part));"]
    lines += [
        f"    const {t} below = (moved < high) ? moved : high;",
        "    return (below > low) ? below : low;",
        "}",
        "",
    ]
    lines += [*rows(tune_head(name)), "{"]
    for end in ("low", "high"):
        lines += [f"    static const {name}_parameters_t {end} = {{"]
        lines += [*numbers({f.name: getattr(f, end) for f in fields}, "        "), "    };"]
    lines += ["", *comment("One copy: what is checked is what is taken.", "    ")]
    lines += [f"    const {name}_parameters_t to = *parameters;", "    uint32_t refused = 0u;"]
    lines += [f"    if (to.check != {name}_checked(&to)) {{", f"        refused |= 0x{CHECK:08x}u;", "    }"]
    lines += ["    bool within = true;"]
    lines += [f"    within = within && {name}_holds(to.{n}, low.{n}, high.{n});" for n in names]
    lines += ["    if (!within) {", f"        refused |= 0x{RANGE:08x}u;", "    }"]
    lines += ["    if (left == 0u) {", f"        refused |= 0x{LEFT:08x}u;", "    }", "    if (refused == 0u) {"]
    lines += [
        "        const uint32_t calls = (left > 0u) ? left : 1u;",
        f"        const {t} part = {one} / ({t})calls;",
    ]
    for n in names:
        state = f"state->{paths[n]}"
        lines += [f"        {state} = {name}_moved({state}, to.{n}, part, low.{n}, high.{n});"]
    return [*lines, "    }", "    return refused;", "}", ""]
