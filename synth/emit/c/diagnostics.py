"""Diagnostics of a step, compiled only where <NAME>_DIAGNOSTICS is defined: signals, saturation, cause of a latch.

    <name>_diagnostics_t                                    signals of the composition, and four words:
        samples, faults, latch_cause                        steps; fault word of the last one, of the one that latched
        saturated                                           bit k: the k-th limited signal is at its limit
    <name>_step_diagnosed(state, in, out, diagnostics)      the step; a null pointer costs the tests for it

The struct belongs to the caller, who sets it to zero together with `init`. Without the macro the text of the step is
the one that it would be without diagnostics, so nothing is paid for them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from synth.block import LATCH_BIT, Block
from synth.blocks import safety
from synth.emit.c.layout import Layout
from synth.emit.c.lines import prose
from synth.emit.lower import Program
from synth.signals import Signal

WORDS = {
    "samples": "steps that had this struct",
    "faults": "fault word of the last step",
    "latch_cause": "fault word of the step that latched, 0 before",
    "saturated": "signals at their limits in the last step",
}
WIDTH = 114
_LEAVES = ("input", "state", "constant", "literal", "guard")


@dataclass(frozen=True)
class Diagnostics:
    """By node, the signals that are recorded, and those that are limited, of which the k-th has bit k."""

    signals: Mapping[int, Signal]
    limited: Mapping[int, Signal]


NOTHING = Diagnostics({}, {})


def of_program(p: Program) -> Diagnostics:
    """Return what is recorded: outputs of Blocks that the step does not return; of a single Block nothing."""
    marks: dict[int, Signal] = {}
    for named, k in p.marks if len(p.titles) > 1 else ():
        if named.block not in (safety.GUARD, safety.SAFE_OUTPUT) and p.nodes[k].op not in _LEAVES:
            marks.setdefault(k, named.signal)
    shown = {k: s for named, k in p.marks if (s := marks.get(k)) is named.signal and not named.internal}
    returned = {*p.outputs.values(), *(p.nodes[k].args[-1] for k in p.outputs.values() if p.nodes[k].op == "choose")}
    limited = {k: s for k, s in marks.items() if p.nodes[k].op == "clamp"}
    names = [s.name for s in shown.values()]
    signals = {k: s for k, s in shown.items() if k not in returned and names.count(s.name) == 1 and s.name not in WORDS}
    return Diagnostics(signals, dict(list(limited.items())[:32]))


def macro(block: Block) -> str:
    """Return the name of the macro that turns diagnostics on."""
    return f"{block.name.upper()}_DIAGNOSTICS"


def head(name: str) -> str:
    """Return the declaration of the step with diagnostics."""
    pointers = f"{name}_state_t *state, const {name}_input_t *in, {name}_output_t *out"
    return f"uint32_t {name}_step_diagnosed({pointers},\n    {name}_diagnostics_t *diagnostics)"


def declaration(block: Block, layout: Layout, p: Program) -> list[str]:
    """Return the struct and the function for the header."""
    of = of_program(p)
    if not (of.signals or of.limited):
        return []
    bits = ", ".join(f"{bit} {s.name}" for bit, s in enumerate(of.limited.values()))
    about = "Signals of the last step that was not latched, and what happened since you set this to zero, with init."
    about += f" Bits of `saturated`: {bits}." if bits else ""
    fields = [(layout.ctype, s.name, f"{s.unit}: {s.about}" if s.about else s.unit) for s in of.signals.values()]
    fields += [("uint32_t", name, about) for name, about in WORDS.items()]
    return [
        *(
            f"#if defined({macro(block)})",
            "/* Signals of the last step that was not latched, and what happened. Set it",
        ),
        *(" * to zero when you call init." + (f" Bits of `saturated`: {bits}." if bits else "") + " */").splitlines(),
        *("typedef struct {", *(f"    {t} {n};".ljust(40) + f"/* {prose(about)} */" for t, n, about in fields)),
        *(f"}} {block.name}_diagnostics_t;", "", "/* The step; `diagnostics` may be null. */", f"{head(block.name)};"),
        *("#endif", ""),
    ]


def document(block: Block, p: Program) -> dict[str, object]:
    """Return the entry of the manifest, empty where nothing is recorded."""
    of = of_program(p)
    if not (of.signals or of.limited):
        return {}
    return {
        "macro": macro(block),
        "function": f"{block.name}_step_diagnosed",
        "type": f"{block.name}_diagnostics_t",
        "signals": {s.name: s.unit for s in of.signals.values()},
        "words": list(WORDS),
        "saturated": [s.name for s in of.limited.values()],
    }


def heads(block: Block, step_head: str, p: Program) -> list[str]:
    """Return the heads of the function whose body follows: the step, or the step with diagnostics which it calls."""
    of = of_program(p)
    if not (of.signals or of.limited):
        return [step_head]
    call = f"    return {block.name}_step_diagnosed(state, in, out, NULL);"
    called = [step_head, "{", call, "}", "", *head(block.name).splitlines()]
    return [f"#if defined({macro(block)})", *called, "#else", step_head, "#endif"]


def includes(block: Block, p: Program) -> list[str]:
    """Return the header that defines NULL."""
    of = of_program(p)
    return [f"#if defined({macro(block)})", "#include <stddef.h>", "#endif"] if of.signals or of.limited else []


def start(block: Block, p: Program) -> list[str]:
    """Return the statements at the beginning of the step."""
    return _when(block, p, ["diagnostics->samples += 1u;", "diagnostics->saturated = 0u;"], "    ")


def end(block: Block, p: Program, word: str) -> list[str]:
    """Return the statements at the end of the step, whose fault word is `word`."""
    latched = f"({word} & 0x{1 << LATCH_BIT:08x}u) != 0u"
    rows = [f"diagnostics->faults = {word};"]
    if block.latches:
        rows += [f"if ((diagnostics->latch_cause == 0u) && ({latched})) {{"]
        rows += [f"    diagnostics->latch_cause = {word};", "}"]
    return _when(block, p, rows, "    ")


def records(
    block: Block, values: Sequence[tuple[Signal, str]], limits: Sequence[tuple[int, str]], indent: str
) -> list[str]:
    """Return the statements that record signals by their texts, and the bits whose conditions hold."""
    rows = [f"diagnostics->{s.name} = {text};" for s, text in values]
    rows += [f"diagnostics->saturated |= ({test}) ? 0x{1 << bit:08x}u : 0u;" for bit, test in limits]
    return _guarded(block, rows, indent) if rows else []


def _when(block: Block, p: Program, rows: Sequence[str], indent: str) -> list[str]:
    of = of_program(p)
    return _guarded(block, rows, indent) if of.signals or of.limited else []


def _guarded(block: Block, rows: Sequence[str], indent: str) -> list[str]:
    body = [f"{indent}    {row}" for row in rows]
    return [f"#if defined({macro(block)})", f"{indent}if (diagnostics != NULL) {{", *body, f"{indent}}}", "#endif"]
