"""Text of what a step calls: structs of the Blocks' states, results and parameters, and their functions.

typedef struct { .. } <name>_<part>_state_t;                        in the header, a member of the state
typedef struct { .. } <name>_<part>_parameters_t;                   the step has one for each Block
static inline <type> <name>_<part>(..state.., ..parameters.., ..)   called once a Block
"""

from collections.abc import Mapping, Sequence
from textwrap import wrap

import numpy as np

from synth.block import Block, Constant
from synth.emit.c import diagnostics, printer
from synth.emit.c import routine as calls
from synth.emit.c.expressions import Text, literal
from synth.emit.c.lines import Line, comment, member, opening, prose
from synth.emit.c.routine import Call, Routine
from synth.emit.program import words
from synth.emit.program.layout import Layout, Member
from synth.emit.program.lower import Node, Program

WIDTH = 116
ROLES = {
    "low": "minus the upper end of a limit",
    "high": "upper end of a limit",
    "least_": "certified bound",
    "largest_": "certified bound",
}


def inline(block: Block) -> str:
    """Return the macro that begins a function."""
    return f"{block.name.upper()}_INLINE"


def large(block: Block) -> str:
    """Return the macro that begins a large function."""
    return f"{block.name.upper()}_LARGE"


def state_types(block: Block, p: Program) -> dict[str, str]:
    """Return by Block of the composition the type of its struct of states."""
    types: dict[str, str] = {}
    for blocks in calls.forms(p).values():
        part = words.common(blocks) or blocks[0]
        name, n = part, 2
        while f"{block.name}_{name}_state_t" in types.values():
            name, n = f"{part}_{n}", n + 1
        types |= dict.fromkeys(blocks, f"{block.name}_{name}_state_t")
    return types


def state_structs(block: Block, p: Program, layout: Layout) -> list[str]:
    """Return the typedefs of the Blocks' states, each once."""
    types = state_types(block, p)
    first = {kind: part for part, kind in reversed(types.items())}
    texts = []
    for kind, part in first.items():
        of_type = [f for f in layout.state.fields if types.get(f.part) == kind]
        rows = [_state_row(f, of_type) for f in of_type if f.part == part]
        texts.append("typedef struct {\n" + "\n".join(rows) + f"\n}} {kind};")
    return texts


def _state_row(f: Member, of_type: Sequence[Member]) -> str:
    """Return a member of a Block's struct, with its range where all Blocks of the type have the same."""
    name = f.path.split(".")[1]
    members = [m for m in of_type if m.path.split(".")[1] == name]
    units = dict.fromkeys(m.unit for m in members)
    about = f.comment() if len({(m.unit, m.low, m.high) for m in members}) == 1 else f"{' or '.join(units)}: {f.about}"
    return member(f.ctype, name, about)


def functions(block: Block, p: Program, layout: Layout) -> list[Line]:
    """Return the types, the parameters and the functions of all routines."""
    lines: list[Line] = []
    explained: set[str] = set()
    inside = {
        name: p.titles.get(call.block, call.block)
        for call in p.calls.values()
        for name in calls.calls_by_routine(call.routine.program)
    }
    for used in calls.calls_by_routine(p).values():
        routine = used[0].routine
        constants = {c.name: c for c in block.constants}
        if routine.parameters and not routine.by_value:
            lines += map(Line, _parameters(block, routine, used, constants, layout))
        if len(routine.results) > 1:
            rows = [f"    {_ctype(r.kind, layout)} {r.name};" for r in routine.members]
            lines += map(Line, ["typedef struct {", *rows, f"}} {block.name}_{routine.name}_t;", ""])
        titles = [p.titles.get(c.block, c.block) for c in used]
        tags = dict.fromkeys(about for t in titles if (about := t.partition(": ")[2]))
        said = ": ".join(filter(None, [", ".join(c.block for c in used), "; ".join(tags)]))
        text = wrap(prose(said), WIDTH - 2)
        first = used[0].block if used[0].block not in explained else ""
        explained |= {c.block for c in used}
        lines += map(Line, opening(text, p.notes.get(first, ())))
        lines += [*map(Line, _head(block, routine, used[0].block, p, layout)), Line("{")]
        passed = [f"    {text}" for text in parameters(block, routine.program, layout).values()]
        lines += map(Line, [*passed, *([""] if passed else [])])
        lines += map(Line, _common_constants(routine, constants, layout))
        tag = prose(inside.get(routine.name, titles[0]))  # what a function of a law computes is its Block's
        lines += [*printer.routine(block, routine, tag, layout.scalar), Line("}"), Line("")]
    return lines


def _ctype(kind: str, layout: Layout) -> str:
    return {"logical": "bool", "integer": "uint32_t"}.get(kind, layout.ctype)


def _parameters(
    block: Block, routine: Routine, used: Sequence[Call], constants: Mapping[str, Constant], layout: Layout
) -> list[str]:
    """Return the struct of what differs from Block to Block."""
    kind = f"{block.name}_{routine.name}_parameters_t"
    rows = ["typedef struct {"]
    for name, node in zip(routine.parameters, used[0].numbers, strict=True):
        about = constants.get(node.name)
        role = next((text for word, text in ROLES.items() if name.startswith(word)), "")
        rows += member(layout.ctype, name, f"{about.unit}; {about.source}" if about else role).splitlines()
    rows.append(f"}} {kind};")
    return [*rows, ""]


def parameters(block: Block, p: Program, layout: Layout) -> dict[str, str]:
    """Return by name the declarations of the numbers that the calls pass in a struct."""
    constants = {c.name: c for c in block.constants}
    structs = {}
    for call in (c for c in p.calls.values() if c.routine.parameters and not c.routine.by_value):
        values = [
            f".{name} = {_value(node, constants, layout.scalar)}"
            for name, node in zip(call.routine.parameters, call.numbers, strict=True)
        ]
        kind = f"{block.name}_{call.routine.name}_parameters_t"
        structs[call.parameters] = f"static const {kind} {call.parameters} = {{{', '.join(values)}}};"
    return structs


def _value(node: Node, constants: Mapping[str, Constant], scalar: type[np.floating]) -> str:
    sign = -1.0 if node.value < 0 else 1.0
    return literal(sign * constants[node.name].value if node.op == "constant" else node.value, scalar).c


def _head(block: Block, routine: Routine, part: str, p: Program, layout: Layout) -> list[str]:
    state = ""
    if routine.states:
        state = f"{state_types(block, p)[part]} *state"
    state = f"const {state}" if state and not routine.program.next else state
    parameters = f"const {block.name}_{routine.name}_parameters_t *parameters" if routine.parameters else ""
    if routine.by_value:
        parameters = ", ".join(f"{layout.ctype} {name}" for name in routine.parameters)
    members = routine.program.members
    passed = [
        f"const {block.name}_{routine.structs[members[a.name][0]]}_t *{members[a.name][0]}"
        if a.name in members
        else f"{_ctype(a.kind, layout)} {a.name}"
        for a in routine.arguments
    ]
    kinds = [r.kind for r in routine.results]
    returned = f"{block.name}_{routine.name}_t" if len(kinds) > 1 else _ctype(kinds[0], layout) if kinds else "void"
    arguments = ", ".join(
        filter(None, [state, parameters, *dict.fromkeys(passed), diagnostics.parameter(block, routine.program)])
    )
    head = f"{large(block) if routine.is_large else inline(block)} {returned} {block.name}_{routine.name}({arguments})"
    return [head]


def _common_constants(routine: Routine, constants: Mapping[str, Constant], layout: Layout) -> list[str]:
    rows = [row for local, name in routine.constants.items() for row in number(local, constants[name], layout)]
    return [*rows, ""] if rows else []


def number(name: str, constant: Constant, layout: Layout, indent: str = "    ") -> list[str]:
    """Return the declaration of a constant, with its unit and source beside it, or above it where they are long.

    A source that is the name in words is left out.
    """
    value = Text(f"{int(constant.value)}u") if constant.of else literal(constant.value, layout.scalar)
    text = f"{indent}static const {'uint32_t' if constant.of else layout.ctype} {name} = {value.c};"
    in_words = constant.source.rpartition(": ")[2].replace(" ", "_")
    about = constant.unit if in_words == name else f"{constant.unit}; {prose(constant.source)}"
    rows = [f"{text.ljust(63)} /* {about} */", f"{text} /* {about} */"]
    fitting = [row for row in rows if len(row) <= WIDTH + 4]
    return fitting[:1] or [*comment(about, indent), text]


def state_member(f: Member, types: Mapping[str, str]) -> str:
    """Return the member of the state for a Block's struct."""
    return f"    {types[f.part]} {f.part};"
