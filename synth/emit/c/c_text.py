"""C99 files of a lowered Block: a header with three structs, a function for each Block, and the step that calls them.

    void     <name>_init(<name>_state_t *state);
    uint32_t <name>_step(<name>_state_t *state, const <name>_input_t *in, <name>_output_t *out);   fault bits

The constants are local to the functions that read them.

CasADi's C code generator (`CodeGenerator`), in double: an oracle for the emitted C, and plant code in simulations.

Each function becomes `int name(const double **arg, double **res, long long *iw, double *w, int mem)`. Arguments and
results hold the nonzeros of CasADi's sparse matrices, column by column. `casadi_source` puts the whole step of a Block
by CasADi behind the header of the emitted C, in its scalar type.
"""

import math
import re
from collections.abc import Mapping, Sequence
from itertools import groupby
from textwrap import wrap

import casadi as ca

from synth.block import Block
from synth.emit.c import diagnostics, routines, tuning
from synth.emit.c.expressions import constant, literal, mask
from synth.emit.c.header import init_head, step_head
from synth.emit.c.lines import Line, comment, opening, prose
from synth.emit.c.printer import Body
from synth.emit.c.routine import calls_by_routine
from synth.emit.passes.guards import guard_function
from synth.emit.passes.surrogates import Surrogate
from synth.emit.program.layout import Layout
from synth.emit.program.lower import Matrix, Program
from synth.emit.program.operations import LIBM
from synth.emit.proof.ranges import kinds
from synth.errors import EmitError


def functions(functions: Sequence[ca.Function], name: str) -> dict[str, str]:
    """Return `{name.c: text}` that exports every function under its own name.

    Raises EmitError when there is no function, when two share a name, or when `name` is not an identifier of C.
    """
    names = [f.name() for f in functions]
    if not re.fullmatch(r"[A-Za-z]\w*", name):
        raise EmitError(f"C file: found the name {name!r}, need an identifier; use letters, digits and underscores")
    if not names or len(set(names)) < len(names):
        raise EmitError(
            f"CasADi functions of '{name}': found {names}, need at least one and no name twice; rename them"
        )
    generator = ca.CodeGenerator(name, {"with_header": False})
    for f in functions:
        generator.add(f)
    return {f"{name}.c": generator.dump()}


def casadi_source(block: Block, layout: Layout) -> str:
    """Return another <name>.c for the same header: the step of a Block with rounded constants by CasADi's generator.

    It calls the C library where the emitted C has polynomials, has every limit of the Block, and no diagnostics.
    """
    name = block.name
    x, u = (ca.vcat([block.symbol[s.name] for s in signals]) for signals in (block.states, block.inputs))
    columns = (
        [block.next[s.name] for s in block.states],
        [block.output[s.name] for s in block.outputs],
        [block.output[f.output] for f in block.faults],
    )
    symbols, values = [block.symbol[c.name] for c in block.constants], [ca.SX(c.value) for c in block.constants]
    results = [ca.densify(ca.vcat(column)) for column in columns]
    results = ca.substitute(results, symbols, values) if symbols else results
    f = ca.Function(f"{name}_casadi", [x, u], ca.cse(results))
    generator = ca.CodeGenerator(f.name(), {"with_header": False, "with_export": False, "casadi_real": layout.ctype})
    generator.add(f)
    paths = {m.name: m.path for m in layout.state.fields}
    sizes = {"x": len(block.states), "u": len(block.inputs), "next": len(block.states), "y": len(block.outputs)}
    sizes |= {"flags": len(block.faults), "w": f.sz_w()}
    body = [f"casadi_real {n}[{max(size, 1)}] = {{0}};" for n, size in sizes.items()]
    body += [f"casadi_int iw[{max(f.sz_iw(), 1)}] = {{0}};"]
    body += [f"const casadi_real *arg[{max(f.sz_arg(), 2)}] = {{x, u}};"]
    body += [f"casadi_real *res[{max(f.sz_res(), 3)}] = {{next, y, flags}};", "uint32_t faults = 0u;"]
    body += [f"x[{i}] = (casadi_real)state->{paths[s.name]};" for i, s in enumerate(block.states)]
    body += [f"u[{i}] = in->{s.name};" for i, s in enumerate(block.inputs)]
    body += [f"(void){f.name()}(arg, res, iw, w, 0);"]
    kinds_of = {s.name: "(uint32_t)" if s.integer else "" for s in block.states}
    body += [f"state->{paths[s.name]} = {kinds_of[s.name]}next[{i}];" for i, s in enumerate(block.states)]
    body += [f"out->{s.name} = y[{i}];" for i, s in enumerate(block.outputs)]
    body += [f"faults |= (flags[{i}] != 0) ? 0x{1 << b.bit:08x}u : 0u;" for i, b in enumerate(block.faults)]
    rows = [
        f"/* {name}: the step by CasADi's code generator, for the header of the emitted C. Generated: do not edit. */",
        *(f'#include "{name}.h"', "#include <float.h>", *_refusals()),
        f"#if defined({name.upper()}_DIAGNOSTICS)",
        f'#error "the C of CasADi has no diagnostics: compile it without {name.upper()}_DIAGNOSTICS"',
        *("#endif", "", generator.dump().strip(), "", *_init(block, layout), ""),
        *(step_head(name), "{", *(f"    {line}" for line in (*body, "return faults;")), "}", ""),
    ]
    return "\n".join(rows)


def source(block: Block, program: Program, surrogates: Sequence[Surrogate], layout: Layout, body: Body) -> list[Line]:
    """Return the lines of <name>.c around the `body` of its step."""
    programs = (program, *(calls[0].routine.program for calls in calls_by_routine(program).values()))
    used = {n.op for q in programs for n in q.nodes}
    parts = [f"/* {block.name}. Generated: do not edit. */"]
    printed = [*body.lines, *(line for side in body.sides for line in side.lines)]
    if any("@ admit" in line.text for line in printed):
        parts += ["/* A comment with `admit` states a bound that the generator has certified, for Frama-C. */"]
    parts += [f'#include "{block.name}.h"', "#include <float.h>"]
    symmetric = any(n.op == "guard" and guard_function(n).endswith("_within") for n in program.nodes)
    parts += ["#include <math.h>"] if symmetric or used & (LIBM | {"clamp"}) else []
    called = routines.functions(block, program, layout)
    compares = any(f"{block.name}_equal(" in line.text for line in (*called, *printed))
    parts += ["#include <stdbool.h>"] if compares or block.tunable or "logical" in kinds(program) else []
    parts += [*(["#include <stddef.h>"] if diagnostics.records(program) else [])]
    parts += [*(["#include <string.h>"] if block.tunable else []), *_refusals()]
    parts += _helpers(block.name, used, layout)
    if any("_flag(" in line.text for line in (*called, *printed) if "/*" not in line.text):
        parts += [f"static inline uint32_t {block.name}_flag(bool holds)", "{", "    uint32_t value = 0u;"]
        parts += ["    if (holds) {", "        value = 1u;", "    }", "    return value;", "}", ""]
    parts += _equal(block.name, layout) if compares else []
    inlines = program.calls or diagnostics.records(program) or any(n.op == "guard" for n in program.nodes)
    parts += _inline(block, program) if inlines else []
    parts += _guards(block, program, layout)
    for name in dict.fromkeys(n.name for q in programs for n in q.nodes if n.op == "table"):
        parts += [*_table(name, program.tables[name], layout), ""]
    names = dict.fromkeys(n.name for q in programs for n in q.nodes if n.op == "product")
    parts += _matrices(block.name, {n: program.matrices[n] for n in names}, layout) if names else []
    for surrogate in surrogates:
        parts += [*_polynomial(surrogate, layout), ""]
    shared = _constants(block, program, layout, body.lines)
    observes = diagnostics.records(program)
    head = step_head(block.name)
    if observes:
        pointers = head.partition("(")[2].removesuffix(")")
        pointers += f", {diagnostics.parameter(block, program)}"
        head = f"{routines.inline(block)} uint32_t {block.name}_body({pointers})"
    step = [*_init(block, layout), "", *tuning.definitions(block, layout), head, "{", *shared]
    step += diagnostics.entry_statements(program)
    ending = diagnostics.exit_statements(block, program, body.lines[-1].text.removeprefix("    return ").rstrip(";"))
    last = ["}", *(["", *diagnostics.steps(block, step_head(block.name))] if observes else [])]
    called += _guard_inputs(block, program, layout)
    for side in body.sides:
        constants = _constants(block, program, layout, side.lines)
        called += [
            *map(Line, [*opening([side.about], ()), side.head, "{", *constants]),
            *side.lines,
            Line("}"),
            Line(""),
        ]
    return [
        *map(Line, parts),
        *called,
        *map(Line, step),
        *body.lines[:-1],
        *map(Line, [*ending, body.lines[-1].text, *last]),
    ]


def _refusals() -> list[str]:
    """Return the directives that refuse what would remove the tests for NaN and infinity, or round elsewhere."""
    finite = "defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && (__FINITE_MATH_ONLY__ > 0))"
    wider = "defined(FLT_EVAL_METHOD) && (FLT_EVAL_METHOD != 0)"
    refused = [
        (finite, "-ffast-math and -ffinite-math-only remove the tests for NaN and infinity: compile without them"),
        (wider, "floating-point arithmetic in a wider type rounds elsewhere: use -msse2 -mfpmath=sse or the like"),
    ]
    return [row for test, text in refused for row in (f"#if {test}", f'#error "{text}"', "#endif")] + [""]


def _helpers(name: str, used: set[str], layout: Layout) -> list[str]:
    """Return the functions of the operations that C has no operator for."""
    t, parts = layout.ctype, []
    for op, sign in (("min", "<"), ("max", ">")):
        if op in used:
            head = f"static inline {t} {name}_{op}({t} a, {t} b)"
            parts += [head, "{", f"    return (a {sign} b) ? a : b;", "}", ""]
    if "clamp" in used:
        size, zero = "fabsf" if t == "float" else "fabs", literal(0.0, layout.scalar).c
        parts += ["/* Return max(min(x, high), -high): x limited to -high .. high, and -high for a negative high. */"]
        parts += [f"static inline {t} {name}_limit({t} x, {t} high)", "{"]
        parts += [f"    return ({size}(x) <= high) ? x : ((x < {zero}) ? -high : {size}(high));", "}", ""]
    if "slew" in used:
        parts += [f"static inline {t} {name}_slew({t} last, {t} target, {t} step)", "{"]
        # From a comparison an analyser learns about a variable, not about a sum that is computed again.
        parts += [f"    const {t} highest = last + step;", f"    const {t} lowest = last - step;"]
        parts += [f"    const {t} below = (target < highest) ? target : highest;"]
        parts += ["    return (below > lowest) ? below : lowest;", "}", ""]
    return parts


def _equal(name: str, layout: Layout) -> list[str]:
    """Return the function that compares two real numbers by one comparison; like ==, it is false for NaN."""
    head = f"static inline bool {name}_equal({layout.ctype} a, {layout.ctype} b)"
    return [head, "{", "    return (a <= b) && !(a < b);", "}", ""]


def _inline(block: Block, program: Program) -> list[str]:
    """Return the macros by which gcc and clang inline: most functions work on a few numbers.

    Where the size of the code counts, a large function is left to the compiler.
    """
    inline, large = routines.inline(block), routines.large(block)
    rows = ["#if defined(__GNUC__)", f"#define {inline} static inline __attribute__((always_inline))"]
    rows += ["#else", f"#define {inline} static inline", "#endif"]
    if any(calls[0].routine.is_large for calls in calls_by_routine(program).values()):
        rows += ["#if defined(__OPTIMIZE_SIZE__)", f"#define {large} static inline"]
        rows += ["#else", f"#define {large} {inline}", "#endif"]
    return rows


def _guards(block: Block, program: Program, layout: Layout) -> list[str]:
    """Return the functions that guard an input, one for each form of range and fallback."""
    lines: list[str] = []
    t = layout.ctype
    forms = {guard_function(n): n for n in program.nodes if n.op == "guard"}
    for name, node in forms.items():
        two = len(node.args) == 5
        test = "(low <= value) && (value <= high)" if two else f"{'fabsf' if t == 'float' else 'fabs'}(value) <= high"
        bounds = f"{t} low, {t} high" if two else f"{t} high"
        kept, source = (f"{t} *last", "*last") if node.name else (f"{t} refused", "refused")
        range, name = "low .. high" if two else "-high .. high", f"{block.name}_{name}"
        about = (
            f"Return a value in {range}{', which `last` becomes' if node.name else ''}; "
            f"for another one or NaN, set its fault bit and return {source}."
        )
        head = f"{routines.inline(block)} {t} {name}({t} value, {bounds}, {kept}, uint32_t bit, uint32_t *faults)"
        lines += [
            *comment(about),
            head,
            *("{", f"    {t} held = value;"),
            *(
                [f"    if ({test}) {{", "        *last = value;", "    } else {"]
                if node.name
                else [f"    if (!({test})) {{"]
            ),
            *(f"        held = {source};", "        *faults |= bit;", "    }", "    return held;", "}", ""),
        ]
    return lines


def _guard_inputs(block: Block, program: Program, layout: Layout) -> list[Line]:
    """Return the function that guards every input."""
    guards = [n for n in program.nodes if n.op == "guard"]
    if not guards:
        return []
    name = block.name
    refused = {n.name for n in (program.nodes[g.args[1]] for g in guards) if n.op == "constant"}
    declared = [
        row for c in block.constants if c.name in refused for row in routines.number(constant(c.name), c, layout)
    ]
    # No copy of the whole struct: it would hold what is refused until the guard replaces it.
    rows = [f"    {name}_input_t accepted;"]
    behind_guards = {program.nodes[g.args[0]].name for g in guards}
    rows += [f"    accepted.{f.name} = in->{f.name};" for f in layout.input.fields if f.name not in behind_guards]
    for g in guards:
        source, fallback, *bounds, _ = (program.nodes[a] for a in g.args)
        kept = f"&state->{program.paths.get(g.name, g.name)}"
        if not g.name:
            kept = constant(fallback.name) if fallback.op == "constant" else literal(fallback.value, layout.scalar).c
        limits = [literal(b.value, layout.scalar).c for b in bounds]
        passed = ", ".join([f"in->{source.name}", *limits, kept, mask(g), "faults"])
        rows.append(f"    accepted.{source.name} = {name}_{guard_function(g)}({passed});")
    pointers = f"const {name}_input_t *in, uint32_t *faults"
    pointers = f"{name}_state_t *state, {pointers}" if any(g.name for g in guards) else pointers
    return [
        *map(Line, comment("Each input in its range, else what is held or refused, with its bit of the fault word.")),
        Line(f"{routines.inline(block)} {name}_input_t {name}_guard_inputs({pointers})"),
        *map(Line, ["{", *declared, *rows, "    return accepted;", "}", ""]),
    ]


def _polynomial(s: Surrogate, layout: Layout) -> list[str]:
    """Return the C function that evaluates a surrogate by Horner's rule in t; in t^2 for an odd or even polynomial."""
    p, t = s.polynomial, "t"
    about = f"x {'-' if p.centre > 0 else '+'} {abs(p.centre):.9g}" if p.centre else "x"
    about = f"({about}) * {p.scale:g}" if p.scale != 1 else about
    values = ", ".join(f"{prose(tag)}{' / x' if p.parity == 'odd' else ''}" for tag in s.tags)
    argument = about if p.parity == "none" else "x^2"
    text = literal(p.coefficients[-1], layout.scalar).c
    for c in p.coefficients[-2::-1]:
        text = f"t * ({text})" if "t" in text else f"t * {text}"
        text = f"{literal(c, layout.scalar).c} + ({text})" if c else text
    return [
        *comment(
            f"{values}; x = {prose(s.variable)} in {p.low:.9g} .. {p.high:.9g}, t = {argument}; "
            f"relative error at most {p.max_relative_error:.2g}."
        ),
        f"static inline {layout.ctype} {s.name}({layout.ctype} {t})",
        "{",
        f"    return {text};",
        "}",
    ]


def _table(name: str, values: Sequence[float], layout: Layout) -> list[str]:
    numbers = ", ".join(literal(v, layout.scalar).c for v in values)
    rows = wrap(numbers, 112, initial_indent="    ", subsequent_indent="    ", break_on_hyphens=False)
    return [f"static const {layout.ctype} {constant(name)}[{len(values)}] = {{", *rows, "};"]


_ROWS = ("first", "second", "third", "fourth")  # that share the loads of what they multiply


def _matrices(block: str, matrices: Mapping[str, Matrix], layout: Layout) -> list[str]:
    """Return the function that multiplies by a matrix, and for each matrix one that has its rows in an array."""
    t, bounds = layout.ctype, [max(len(getattr(M, side)) for M in matrices.values()) for side in ("rows", "columns")]
    parts = [
        *comment(
            "Set y to a matrix of m rows and n columns times x, each row added from left to right. Four rows share the "
            "loads of x."
        ),
        f"static inline void {block}_times(const {t} *matrix, uint32_t m, uint32_t n, const {t} *x, {t} *y)",
        *("{", "    const uint32_t fours = m - (m % 4u);"),
        f"    /*@ loop unroll {bounds[0] // 4}; */",
        *("    for (uint32_t i = 0u; i < fours; i += 4u) {", *_sums(_ROWS, t, bounds[1]), "    }"),
        "    /*@ loop unroll 3; */",
        *("    for (uint32_t i = fours; i < m; i++) {", *_sums(_ROWS[:1], t, bounds[1]), "    }", "}", ""),
    ]
    for name, matrix in matrices.items():
        rows = []
        for row, values in zip(matrix.rows, matrix.values, strict=True):
            numbers = ", ".join(literal(v, layout.scalar).c for v in values)
            rows.append(f"        /* {row} */")
            rows += wrap(f"{numbers},", 112, initial_indent=" " * 8, subsequent_indent=" " * 8, break_on_hyphens=False)
        m, n = len(matrix.rows), len(matrix.columns)
        about = f"A row for each of {', '.join(matrix.rows)}; a column for each of {', '.join(matrix.columns)}."
        parts += [
            *comment(about),
            *(f"static inline void {block}_{name}_times(const {t} *x, {t} *y)", "{"),
            *(f"    static const {t} matrix[{m * n}] = {{", *rows, "    };", ""),
            *(f"    {block}_times(matrix, {m}u, {n}u, x, y);", "}", ""),
        ]
    return parts


def _sums(names: Sequence[str], ctype: str, columns: int) -> list[str]:
    """Return the body of a loop that adds the products of the rows from i on, which have these names."""
    rows = [f"const {ctype} *const {row} = &matrix[(i + {k}u) * n];" for k, row in enumerate(names)]
    rows += [f"{ctype} {row}_sum = {row}[0] * x[0];" for row in names]
    rows += [f"/*@ loop unroll {columns - 1}; */", "for (uint32_t j = 1u; j < n; j++) {"]
    rows += [f"    {row}_sum += {row}[j] * x[j];" for row in names]
    rows += ["}", *(f"y[i + {k}u] = {row}_sum;" for k, row in enumerate(names))]
    return [f"        {row.replace('(i + 0u)', 'i').replace('i + 0u', 'i')}" for row in rows]


def _constants(block: Block, program: Program, layout: Layout, lines: Sequence[Line]) -> list[str]:
    """Return the declarations of the constants that some lines of the step read, before an empty line."""
    operands = {program.nodes[a] for n in program.nodes if n.op != "guard" for a in n.args}
    operands |= {program.nodes[k] for k in program.ends()}
    read = {n.name for n in operands if n.op in ("constant", "literal")}
    read |= {n.name for call in program.calls.values() if call.routine.by_value for n in call.numbers}
    words = {*re.findall(r"\w+", "\n".join(line.text for line in lines))}
    names = {constant(c.name): c for c in block.constants if c.name in read}
    rows = [row for name, c in names.items() if name in words for row in routines.number(name, c, layout)]
    structs = routines.parameters(block, program, layout)
    rows += [f"    {text}" for name, text in structs.items() if name in words]
    return [*rows, ""] if rows else []


def _init(block: Block, layout: Layout) -> list[str]:
    """Return the function that gives each member its initial value; C gives those that are not named 0."""
    texts = {s.name: f"{int(s.initial)}u" if s.integer else literal(s.initial, layout.scalar).c for s in block.states}
    named = {s.name for s in block.states if s.initial or math.copysign(1, s.initial) < 0}
    fields = [f for f in layout.state.fields if f.name in named] or [layout.state.fields[0]]
    rows = []
    for part, members in groupby(fields, lambda f: f.part):
        values = [f".{f.path.removeprefix(f'{part}.')} = {texts.get(f.name, '0u')}" for f in members]
        values = [f".{part} = {{{', '.join(values)}}}"] if part else values
        rows += [f"        {value}," for value in values]
    return [
        *(init_head(block.name), "{"),
        *("    /* A member that is not named is 0. */", f"    *state = ({block.name}_state_t){{", *rows, "    };", "}"),
    ]
