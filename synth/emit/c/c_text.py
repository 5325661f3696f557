"""C99 files of a lowered Block: a header with three structs, and one step function without loops.

    void     <name>_init(<name>_state_t *state);
    uint32_t <name>_step(<name>_state_t *state, const <name>_input_t *in, <name>_output_t *out);   fault bits

The constants are local to the step, their only reader.
"""

from collections.abc import Sequence
from textwrap import wrap

from synth.block import Block, Fault
from synth.emit.c.expressions import constant, literal
from synth.emit.c.kinds import kinds
from synth.emit.c.layout import Layout, Struct
from synth.emit.c.printer import Line, prose
from synth.emit.lower import LIBM, Program
from synth.emit.passes.surrogates import Surrogate


def _meaning(fault: Fault) -> str:
    if fault.input:
        return f"{fault.input}: not finite or outside its range"
    return f"{fault.suspect}: contradicts the others" if fault.suspect else "latched: safe output until init"


def header(block: Block, layout: Layout) -> str:
    """Return the text of <name>.h."""
    guard = f"{block.name.upper()}_H"
    structs = "\n\n".join(_struct(block.name, s) for s in layout.structs)
    checks = "\n".join(
        f"extern char {block.name}_{s.kind}_size_is_{s.size}[(sizeof({s.type}) == {s.size}u) ? 1 : -1];"
        for s in layout.structs
    )
    faults = "\n".join(f" *   bit {f.bit:2d}  {_meaning(f)}" for f in block.faults)
    returned = (
        f" * It returns the fault bits:\n{faults}\n" if faults else " * It returns 0: the Block guards no input.\n"
    )
    return (
        f"/* {block.name}: one step every {block.time.period_s:g} s, {layout.ctype}. Generated: do not edit. */\n"
        f"#ifndef {guard}\n#define {guard}\n\n#include <stdint.h>\n\n{structs}\n\n"
        f"/* The layout is the same on every target. */\n{checks}\n\n"
        "/* Put the state to its initial values. The caller owns it. */\n"
        f"void {block.name}_init({block.name}_state_t *state);\n\n"
        f"/* Compute one sample: read `in`, write `out`, advance `state`.\n{returned} */\n"
        f"{_step_head(block.name)};\n\n#endif\n"
    )


def _struct(name: str, struct: Struct) -> str:
    rows = [f"    {f.ctype} {f.name};".ljust(40) + f"/* {prose(f.comment)} */" for f in struct.fields]
    return "typedef struct {\n" + "\n".join(rows) + f"\n}} {struct.type};"


def _step_head(name: str) -> str:
    return f"uint32_t {name}_step({name}_state_t *state, const {name}_input_t *in, {name}_output_t *out)"


def source(
    block: Block, program: Program, surrogates: Sequence[Surrogate], layout: Layout, body: Sequence[Line]
) -> list[Line]:
    """Return the lines of <name>.c around the `body` of its step."""
    used = {n.op for n in program.nodes}
    parts = [f"/* {block.name}. Generated: do not edit. */", f'#include "{block.name}.h"']
    parts += ["#include <math.h>"] if used & (LIBM | {"clamp"}) else []
    parts += ["#include <stdbool.h>"] if "logical" in kinds(program) else []
    parts += [""]
    for op, sign in (("min", "<"), ("max", ">")):
        if op in used:
            t = layout.ctype
            parts += [f"static inline {t} {op}({t} a, {t} b)", "{", f"    return (a {sign} b) ? a : b;", "}", ""]
    if "clamp" in used:
        t = layout.ctype
        size, zero = "fabsf" if layout.ctype == "float" else "fabs", literal(0.0, layout.scalar).c
        parts += [f"static inline {t} limit({t} x, {t} high)", "{"]
        # for a negative high, max(min(x, high), -high) is -high for every x
        parts += [f"    return ({size}(x) <= high) ? x : ((x < {zero}) ? -high : {size}(high));", "}", ""]
    if any("flag(" in line.text for line in body if "/*" not in line.text):
        parts += ["static inline uint32_t flag(bool holds)", "{", "    uint32_t value = 0u;"]
        parts += ["    if (holds) {", "        value = 1u;", "    }", "    return value;", "}", ""]
    for surrogate in surrogates:
        parts += [*_polynomial(surrogate, layout), ""]
    parts += [*_init(block, layout), "", _step_head(block.name), "{", *_constants(block, program, layout)]
    return [*map(Line, parts), *body, Line("}")]


def _polynomial(s: Surrogate, layout: Layout) -> list[str]:
    """Return the C function that evaluates a surrogate by Horner's rule in t; in t^2 for an odd or even polynomial."""
    p, t = s.polynomial, "t"
    about = f"{s.variable} {'-' if p.centre > 0 else '+'} {abs(p.centre):.9g}" if p.centre else s.variable
    about = f"({about}) * {p.scale:g}" if p.scale != 1 else about
    argument = {"none": f"t = {about}", "odd": f"{s.tag} / x, t = x^2, x = {about}", "even": f"t = x^2, x = {about}"}
    text = literal(p.coefficients[-1], layout.scalar).c
    for c in p.coefficients[-2::-1]:
        text = f"t * ({text})" if "t" in text else f"t * {text}"
        text = f"{literal(c, layout.scalar).c} + ({text})" if c else text
    return [
        f"/* {prose(s.tag)} for {prose(s.variable)} in {p.low:.9g} .. {p.high:.9g}: {argument[p.parity]};",
        f" * relative error at most {p.max_relative_error:.2g}. */",
        f"static inline {layout.ctype} {s.name}({layout.ctype} {t})",
        "{",
        f"    return {text};",
        "}",
    ]


def _table(name: str, values: Sequence[float], layout: Layout) -> list[str]:
    numbers = ", ".join(literal(v, layout.scalar).c for v in values)
    rows = wrap(numbers, 108, initial_indent=" " * 8, subsequent_indent=" " * 8, break_on_hyphens=False)
    return [f"    static const {layout.ctype} {constant(name)}[{len(values)}] = {{", *rows, "    };"]


def _constants(block: Block, program: Program, layout: Layout) -> list[str]:
    read = {n.name for n in program.nodes if n.op == "constant"}
    rows = [
        f"    static const {layout.ctype} {constant(c.name)} = {literal(c.value, layout.scalar).c};".ljust(64)
        + f"/* {c.unit}; {prose(c.source)} */"
        for c in block.constants
        if c.name in read
    ]
    for name in dict.fromkeys(n.name for n in program.nodes if n.op == "table"):
        rows += _table(name, program.tables[name], layout)
    return [*rows, ""] if rows else []


def _init(block: Block, layout: Layout) -> list[str]:
    rows = []
    for s in block.states:
        value = f"{int(s.initial)}u" if s.integer else literal(s.initial, layout.scalar).c
        rows.append(f"    state->{s.name} = {value};")
    rows += [f"    state->{f.name} = 0u;" for f in layout.state.fields if f.name == "reserved"]
    return [f"void {block.name}_init({block.name}_state_t *state)", "{", *rows, "}"]
