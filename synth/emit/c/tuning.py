"""C of the constants that are tuned on the machine: their struct, its check, and the function that moves them.

typedef struct { .. uint32_t check; } <name>_parameters_t;
extern const <name>_parameters_t <name>_parameters_default;         the declared design
uint32_t <name>_parameters_check(const <name>_parameters_t *parameters);
uint32_t <name>_tune(<name>_state_t *state, const <name>_parameters_t *parameters, uint32_t left);

The check covers the bits of all values and the declaration: half of a change, and a set for other C, do not pass it.
"""

import hashlib
from collections.abc import Sequence
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
    found = seed
    for word in np.frombuffer(np.array(values).astype(np.array(values).dtype.newbyteorder("<")).tobytes(), "<u4"):
        found = ((((found << 5) | (found >> 27)) & 0xFFFFFFFF) ^ int(word)) * FACTOR & 0xFFFFFFFF
    return found


def seed(parameters: Struct) -> int:
    """Return what the check starts from: it follows from type, names and ranges."""
    declared = repr([(parameters.type, *((f.name, f.ctype, f.low, f.high) for f in parameters.fields))])
    return int.from_bytes(hashlib.sha256(declared.encode()).digest()[:4], "little")


def defaults(block: Block, layout: Layout) -> dict[str, float]:
    """Return the declared values by name, in the scalar type."""
    return {s.name: float(layout.scalar(s.initial)) for s in block.states if s.name in block.tunable}


def manifest_entry(block: Block, layout: Layout) -> dict[str, Any]:
    """Return what a program needs to know to tune; nothing for a Block without constants that it may."""
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
    name = block.name
    bits = [f" *   bit {bit.bit_length() - 1}  {about}" for bit, about in REFUSALS.items()]
    return [
        *comment("The declared design, from which init starts."),
        *(f"extern const {name}_parameters_t {name}_parameters_default;", ""),
        *comment("The check that belongs to the values of `parameters`: set it last."),
        *(f"{check_head(name)};", ""),
        "/* Move the constants of the law to `parameters`, which are reached when `left` is 1. Call it between two steps, with",
        f" * `left` = {block.ramp}, {block.ramp - 1}, .. 1: what is proved of the step holds on the way. With 1 at once, as after init.",
        " * It returns 0, or why nothing is changed:",
        *bits,
        " */",
        *(*rows(f"{tune_head(name)};"), ""),
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
    ends = {f.name: ", ".join(literal(v, layout.scalar).c for v in (f.low, f.high)) for f in layout.parameters.fields}
    values, start = defaults(block, layout), seed(layout.parameters)
    found = check([layout.scalar(v) for v in values.values()], start)
    words = layout.scalar(0).itemsize // 4
    return [
        f"const {name}_parameters_t {name}_parameters_default = {{",
        *(f"    .{n} = {literal(v, layout.scalar).c}," for n, v in values.items()),
        *(f"    .check = 0x{found:08x}u,", "};", ""),
        f"static inline uint32_t {name}_mixed(uint32_t check, {t} value)",
        *("{", f"    uint32_t bits[{words}] = {{0u}};", "    (void)memcpy(bits, &value, sizeof bits);"),
        "    uint32_t mixed = check;",
        *(f"    mixed = (((mixed << 5u) | (mixed >> 27u)) ^ bits[{i}]) * 0x{FACTOR:08x}u;" for i in range(words)),
        *("    return mixed;", "}", ""),
        *(check_head(name), "{", f"    uint32_t check = 0x{start:08x}u;"),
        *(f"    check = {name}_mixed(check, parameters->{n});" for n in names),
        *("    return check;", "}", ""),
        f"static inline bool {name}_holds({t} value, {t} low, {t} high)",
        *("{", "    return (value >= low) && (value <= high);", "}", ""),
        *comment("value moved to a target, of which a share remains; rounding does not leave the range"),
        f"static inline {t} {name}_moved({t} value, {t} target, {t} share, {t} low, {t} high)",
        *("{", f"    const {t} moved = target - ((target - value) * share);"),
        f"    const {t} below = (moved < high) ? moved : high;",
        *("    return (below > low) ? below : low;", "}", ""),
        *rows(tune_head(name)),
        "{",
        f"    const {name}_parameters_t to = *parameters; /* what is checked is what is taken */",
        *("    uint32_t refused = 0u;", f"    if (to.check != {name}_parameters_check(&to)) {{"),
        *(f"        refused |= {CHECK}u;", "    }", "    bool within = true;"),
        *(f"    within = within && {name}_holds(to.{n}, {ends[n]});" for n in names),
        *("    if (!within) {", f"        refused |= {RANGE}u;", "    }"),
        *("    if (left == 0u) {", f"        refused |= {LEFT}u;", "    }", "    if (refused == 0u) {"),
        f"        const {t} remaining = ({t})(left - 1u);",
        f"        const {t} share = remaining / ({t})left;",
        *(
            row
            for n in names
            for row in rows(
                f"        state->{paths[n]} = {name}_moved(state->{paths[n]}, to.{n}, share, {ends[n]});"
            )
        ),
        *("    }", "    return refused;", "}", ""),
    ]
