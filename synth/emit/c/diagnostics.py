"""Diagnostics of a step: internal signals, saturation and the cause of a latch, for a debugger or a log.

The step of the emitted C is a function that takes them, and each function of a Block records what it computes there:

    <name>_diagnostics_t                                    the recorded signals, and four words:
        samples                                             number of steps since the caller cleared the struct
        faults                                              fault word of the last step
        latch_cause                                         fault word of the step that set the latch
        saturated                                           bit k: the k-th limited signal is at its limit
    Without a latch, or without limits, the word of it is absent.
    <name>_step_diagnosed(state, in, out, diagnostics)      the step; it records nothing if `diagnostics` is NULL

The struct belongs to the caller, who sets it to zero together with `init`. <name>_step_diagnosed exists only where the
macro <NAME>_DIAGNOSTICS is defined. <name>_step passes a null pointer to functions that are all inlined, so diagnostics
cost neither time nor memory.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from synth.block import LATCH_BIT, Block
from synth.blocks.guard import safety
from synth.emit.c.lines import comment, member, rows
from synth.emit.program.layout import Layout
from synth.emit.program.lower import Program
from synth.signals import Signal

WORDS = {
    "samples": "steps that had this struct",
    "faults": "fault word of the last step",
    "latch_cause": "fault word of the step that latched, 0 before",
    "saturated": "signals at their limits in the last step",
}
MAX_LIMITED = 32  # bits of `saturated`
_LEAVES = ("input", "state", "constant", "literal", "guard")  # operations of nodes that compute nothing


@dataclass(frozen=True)
class Diagnostics:
    """What one function records: signals by node, and by node of a limited signal its bit of `saturated`."""

    signals: Mapping[int, Signal]
    limited: Mapping[int, int]


def signals(p: Program) -> tuple[tuple[Signal, ...], tuple[Signal, ...]]:
    """Return the recorded and the limited signals of a composition: what its Blocks output and the step does not.

    A program of a single Block has none. If two recorded signals have the same name, neither is recorded.
    """
    computed = _computed_signals(p)
    outputs = {k: mark.signal for mark, k in p.marks if mark.signal is computed.get(k) and not mark.is_internal}
    returned = _returned_nodes(p)
    names = [s.name for s in outputs.values()]
    recorded = [s for k, s in outputs.items() if k not in returned and names.count(s.name) == 1 and s.name not in WORDS]
    limited = [s for k, s in computed.items() if p.nodes[k].op == "clamp"]
    return tuple(recorded), tuple(limited[:MAX_LIMITED])


def of_program(p: Program) -> Diagnostics:
    """Return what the function of a program records itself, without what those record that it calls."""
    called = [call.routine.program for call in p.calls.values()]
    inside = {name for q in called if records(q) for name, _ in _nodes_by_name(q)}
    named = {name: k for name, k in reversed(_nodes_by_name(p)) if name not in inside}
    recorded = {named[s.name]: s for s in p.recorded if s.name in named}
    limits = {named[s.name]: bit for bit, s in enumerate(p.limited) if s.name in named}
    return Diagnostics(recorded, {k: bit for k, bit in limits.items() if p.nodes[k].op == "clamp"})


def _nodes_by_name(p: Program) -> list[tuple[str, int]]:
    return [*((mark.signal.name, k) for mark, k in p.marks), *p.returns.items()]


def records(p: Program) -> bool:
    """Tell whether the function of a program, or one that it calls, has something to record."""
    return bool(p.recorded or p.limited)


def _words(block: Block, p: Program) -> dict[str, str]:
    """Return what the words say, without those of a latch and of limits where the Block has none."""
    absent = {"latch_cause": not block.latches, "saturated": not p.limited}
    return {name: about for name, about in WORDS.items() if not absent.get(name)}


def _computed_signals(p: Program) -> dict[int, Signal]:
    """Return by node the first signal that a law of a composition computes there; guard and safe output are no laws."""
    computed: dict[int, Signal] = {}
    for mark, k in p.marks if len(p.titles) > 1 else ():
        if mark.block not in (safety.GUARD, safety.SAFE_OUTPUT) and p.nodes[k].op not in _LEAVES:
            computed.setdefault(k, mark.signal)
    return computed


def _returned_nodes(p: Program) -> set[int]:
    """Return the nodes of the outputs, and of the last alternative of an output that is a choice."""
    outputs = [p.nodes[k] for k in p.outputs.values()]
    return {*p.outputs.values(), *(node.args[-1] for node in outputs if node.op == "choose")}


def macro_name(block: Block) -> str:
    """Return the name of the macro that turns diagnostics on."""
    return f"{block.name.upper()}_DIAGNOSTICS"


def prototype(name: str) -> str:
    """Return the prototype of the step with diagnostics, without the semicolon."""
    pointers = f"{name}_state_t *state, const {name}_input_t *in, {name}_output_t *out"
    return f"uint32_t {name}_step_diagnosed({pointers}, {name}_diagnostics_t *diagnostics)"


def declaration(block: Block, layout: Layout, p: Program) -> list[str]:
    """Return the struct and the prototype for the header."""
    if not records(p):
        return []
    bits = ", ".join(f"{bit} {s.name}" for bit, s in enumerate(p.limited))
    fields = [(layout.ctype, s.name, f"{s.unit}: {s.about}" if s.about else s.unit) for s in p.recorded]
    fields += [("uint32_t", name, about) for name, about in _words(block, p).items()]
    return [
        *comment(
            "Signals and what happened: each signal from the last step that computed it, since a latch or another "
            "branch skips some. Set the struct to zero when you call init."
            + (f" Bits of `saturated`: {bits}." if bits else "")
        ),
        "typedef struct {",
        *(member(ctype, name, about) for ctype, name, about in fields),
        f"}} {block.name}_diagnostics_t;",
        "",
        f"#if defined({macro_name(block)})",
        "/* The step; `diagnostics` may be null. */",
        *rows(f"{prototype(block.name)};"),
        "#endif",
        "",
    ]


def manifest_entry(block: Block, p: Program) -> dict[str, object]:
    """Return the entry of the manifest, empty where the step has no diagnostics."""
    if not records(p):
        return {}
    return {
        "macro": macro_name(block),
        "function": f"{block.name}_step_diagnosed",
        "type": f"{block.name}_diagnostics_t",
        "signals": {s.name: s.unit for s in p.recorded},
        "words": list(_words(block, p)),
        "saturated": [s.name for s in p.limited],
    }


def parameter(block: Block, p: Program) -> str:
    """Return the parameter of a function that records, "" for another one."""
    return f"{block.name}_diagnostics_t *diagnostics" if records(p) else ""


def steps(block: Block, step: str) -> list[str]:
    """Return the functions that a caller calls, whose work is that of <name>_body; `step` is a prototype."""
    call = f"    return {block.name}_body(state, in, out, {{}});"
    diagnosed = [
        f"#if defined({macro_name(block)})",
        *rows(prototype(block.name)),
        "{",
        call.format("diagnostics"),
        "}",
    ]
    return [*rows(step), "{", call.format("NULL"), "}", "", *diagnosed, "#endif"]


def entry_statements(p: Program) -> list[str]:
    """Return the statements at the beginning of the step."""
    if not records(p):
        return []
    cleared = ["diagnostics->saturated = 0u;"] if p.limited else []
    return _if_recording(["diagnostics->samples += 1u;", *cleared], "    ")


def exit_statements(block: Block, p: Program, word: str) -> list[str]:
    """Return the statements at the end of the step, whose fault word is the C expression `word`."""
    if not records(p):
        return []
    statements = [f"diagnostics->faults = {word};"]
    if block.latches:
        is_latched = f"({word} & 0x{1 << LATCH_BIT:08x}u) != 0u"
        statements += [f"if ((diagnostics->latch_cause == 0u) && ({is_latched})) {{"]
        statements += [f"    diagnostics->latch_cause = {word};", "}"]
    return _if_recording(statements, "    ")


def record_statements(
    values: Sequence[tuple[Signal, str]], limits: Sequence[tuple[int, str]], indent: str
) -> list[str]:
    """Return the statements that record signals, and the bits of signals that are at their limits.

    `values` holds the C expression of each signal, `limits` for each bit the C expression of its condition.
    """
    statements = [f"diagnostics->{s.name} = {value};" for s, value in values]
    statements += [f"diagnostics->saturated |= ({test}) ? 0x{1 << bit:08x}u : 0u;" for bit, test in limits]
    return _if_recording(statements, indent) if statements else []


def _if_recording(statements: Sequence[str], indent: str) -> list[str]:
    """Return the C that executes statements if the caller wants diagnostics."""
    return [f"{indent}if (diagnostics != NULL) {{", *(f"{indent}    {row}" for row in statements), f"{indent}}}"]
