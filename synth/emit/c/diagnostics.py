"""Diagnostics of a step: internal signals, saturation and the cause of a latch, for a debugger or a log.

The emitted C contains them only where the macro <NAME>_DIAGNOSTICS is defined:

    <name>_diagnostics_t                                    the recorded signals, and four words:
        samples                                             number of steps since the caller cleared the struct
        faults                                              fault word of the last step
        latch_cause                                         fault word of the step that set the latch
        saturated                                           bit k: the k-th limited signal is at its limit
    Without a latch, or without limits, the word of it is absent.
    <name>_step_diagnosed(state, in, out, diagnostics)      the step; it records nothing if `diagnostics` is NULL

The struct belongs to the caller, who sets it to zero together with `init`. Without the macro the C of the step is the
same as without this module, so diagnostics cost neither time nor memory.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from synth.block import LATCH_BIT, Block
from synth.blocks.guard import safety
from synth.emit.c.lines import Line, comment, member, rows
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
    """The recorded signals by node, and the limited signals by node; bit k of `saturated` is for the k-th of these."""

    signals: Mapping[int, Signal]
    limited: Mapping[int, Signal]

    @property
    def is_empty(self) -> bool:
        """Whether a step has no diagnostics."""
        return not (self.signals or self.limited)


NO_DIAGNOSTICS = Diagnostics({}, {})


def of_program(p: Program) -> Diagnostics:
    """Return the diagnostics of a composition: outputs of its Blocks that the step does not return.

    A program of a single Block has none. If two recorded signals have the same name, neither is recorded.
    """
    computed = _computed_signals(p)
    outputs = {k: mark.signal for mark, k in p.marks if mark.signal is computed.get(k) and not mark.is_internal}
    returned = _returned_nodes(p)
    names = [s.name for s in outputs.values()]
    recorded = {
        k: s for k, s in outputs.items() if k not in returned and names.count(s.name) == 1 and s.name not in WORDS
    }
    limited = [(k, s) for k, s in computed.items() if p.nodes[k].op == "clamp"]
    return Diagnostics(recorded, dict(limited[:MAX_LIMITED]))


def _words(block: Block, diagnostics: Diagnostics) -> dict[str, str]:
    """Return what the words say, without those of a latch and of limits where the Block has none."""
    absent = {"latch_cause": not block.latches, "saturated": not diagnostics.limited}
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
    diagnostics = of_program(p)
    if diagnostics.is_empty:
        return []
    bits = ", ".join(f"{bit} {s.name}" for bit, s in enumerate(diagnostics.limited.values()))
    fields = [
        (layout.ctype, s.name, f"{s.unit}: {s.about}" if s.about else s.unit) for s in diagnostics.signals.values()
    ]
    fields += [("uint32_t", name, about) for name, about in _words(block, diagnostics).items()]
    return [
        f"#if defined({macro_name(block)})",
        *comment(
            "Signals and what happened: each signal from the last step that computed it, since a latch or another "
            "branch skips some. Set the struct to zero when you call init."
            + (f" Bits of `saturated`: {bits}." if bits else "")
        ),
        "typedef struct {",
        *(member(ctype, name, about) for ctype, name, about in fields),
        f"}} {block.name}_diagnostics_t;",
        "",
        "/* The step; `diagnostics` may be null. */",
        *rows(f"{prototype(block.name)};"),
        "#endif",
        "",
    ]


def manifest_entry(block: Block, p: Program) -> dict[str, object]:
    """Return the entry of the manifest, empty where the step has no diagnostics."""
    diagnostics = of_program(p)
    if diagnostics.is_empty:
        return {}
    return {
        "macro": macro_name(block),
        "function": f"{block.name}_step_diagnosed",
        "type": f"{block.name}_diagnostics_t",
        "signals": {s.name: s.unit for s in diagnostics.signals.values()},
        "words": list(_words(block, diagnostics)),
        "saturated": [s.name for s in diagnostics.limited.values()],
    }


def definition_head(block: Block, step: str, p: Program) -> list[str]:
    """Return the lines before the body of the step, whose prototype is `step`.

    With the macro the body belongs to the step with diagnostics, and the step itself calls that function with NULL.
    """
    if of_program(p).is_empty:
        return [step]
    call = f"    return {block.name}_step_diagnosed(state, in, out, NULL);"
    with_macro = [step, "{", call, "}", "", prototype(block.name)]
    return [f"#if defined({macro_name(block)})", *with_macro, "#else", step, "#endif"]


def includes(block: Block, p: Program) -> list[str]:
    """Return the lines that include the header that defines NULL."""
    return [] if of_program(p).is_empty else [f"#if defined({macro_name(block)})", "#include <stddef.h>", "#endif"]


def entry_statements(block: Block, p: Program) -> list[str]:
    """Return the statements at the beginning of the step."""
    diagnostics = of_program(p)
    if diagnostics.is_empty:
        return []
    cleared = ["diagnostics->saturated = 0u;"] if diagnostics.limited else []
    return _if_recording(block, ["diagnostics->samples += 1u;", *cleared], "    ")


def exit_statements(block: Block, p: Program, word: str) -> list[str]:
    """Return the statements at the end of the step, whose fault word is the C expression `word`."""
    if of_program(p).is_empty:
        return []
    statements = [f"diagnostics->faults = {word};"]
    if block.latches:
        is_latched = f"({word} & 0x{1 << LATCH_BIT:08x}u) != 0u"
        statements += [f"if ((diagnostics->latch_cause == 0u) && ({is_latched})) {{"]
        statements += [f"    diagnostics->latch_cause = {word};", "}"]
    return _if_recording(block, statements, "    ")


def join(body: Sequence[Line], ending: Sequence[Line]) -> list[Line]:
    """Return the lines of a body and of its ending, as one block where both record at the same depth."""
    last = next((k for k in range(len(body) - 1, -1, -1) if body[k].text.startswith("#if ")), 0)
    records = [line.text for line in body[-3:]] == ["    }", "#endif", ""]
    if records and [*body[last : last + 2]] == [*ending[:2]]:
        return [*body[:-3], *ending[2:]]
    return [*body, *ending]


def record_statements(
    block: Block, values: Sequence[tuple[Signal, str]], limits: Sequence[tuple[int, str]], indent: str
) -> list[str]:
    """Return the statements that record signals, and the bits of signals that are at their limits.

    `values` holds the C expression of each signal, `limits` for each bit the C expression of its condition.
    """
    statements = [f"diagnostics->{s.name} = {value};" for s, value in values]
    statements += [f"diagnostics->saturated |= ({test}) ? 0x{1 << bit:08x}u : 0u;" for bit, test in limits]
    return _if_recording(block, statements, indent) if statements else []


def _if_recording(block: Block, statements: Sequence[str], indent: str) -> list[str]:
    """Return the C that executes statements if the macro is defined and the caller wants diagnostics."""
    body = [f"{indent}    {statement}" for statement in statements]
    return [f"#if defined({macro_name(block)})", f"{indent}if (diagnostics != NULL) {{", *body, f"{indent}}}", "#endif"]
