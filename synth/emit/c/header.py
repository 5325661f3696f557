"""C header of a lowered Block: what a caller must know to compile and to call it; C++ may include it.

First come contract, inputs, outputs, `init` and `step`, then the state, which the caller owns and only they use. What
may fail and where the numbers come from says the datasheet beside it, see `datasheet`.
"""

from collections.abc import Mapping, Sequence
from textwrap import wrap

from synth.block import Block, Fault
from synth.blocks.guard import missed_calls
from synth.blocks.guard import safety as guards
from synth.emit.c import diagnostics, routines, tuning
from synth.emit.c.lines import member, prose, rows
from synth.emit.program.layout import Layout, Struct
from synth.emit.program.lower import Program

WIDTH = 117
FLAGS = "-std=c99 -O2 -ffp-contract=off -fno-math-errno"
LATCHED = "latched until init"
UNSEEN = (
    "The source cannot see options that assume that no value is NaN or infinite, or that reorder sums, by other names, "
    "such as -fno-honor-nans or -funsafe-math-optimizations, nor -ffast-math of the linker: do not use them."
)
REFUSED = "-ffast-math, -ffinite-math-only and floating-point arithmetic in a wider type"


def header(
    block: Block, layout: Layout, program: Program, notes: Sequence[str] = (), warning: str = "", latency: int = 0
) -> str:
    """Return the text of <name>.h, with further sentences on the stage, and a warning before everything else.

    `latency` counts samples from the measurement to the action of the outputs.
    """
    types = routines.state_types(block, program)
    guard = f"{block.name.upper()}_H"
    state, called = layout.state, [s for s in layout.structs if s is not layout.state]
    return "\n".join(
        [
            *_usage(block, layout, program, notes, warning, latency),
            *(f"#ifndef {guard}", f"#define {guard}", "", "#include <stdint.h>", ""),
            *("#ifdef __cplusplus", 'extern "C" {', "#endif", ""),
            *(f"typedef struct {state.tag} {state.type};", ""),
            "\n\n".join(_struct(s, layout) for s in called),
            *("", "/* Put the state to its initial values. The caller owns it. */", f"{init_head(block.name)};", ""),
            *("/* Compute one sample: read `in`, write `out`, advance `state`.", *_faults(block), " */"),
            *(*rows(f"{step_head(block.name)};"), ""),
            *tuning.declaration(block, layout),
            "/* What follows is for init and step alone: the state, by Block. */",
            "\n\n".join([*routines.state_structs(block, program, layout), _state(state, types)]),
            *("", "/* The layout is the same on every target. */", *_size_checks(block, layout), ""),
            *diagnostics.declaration(block, layout, program),
            *("#ifdef __cplusplus", "}", "#endif", "", "#endif", ""),
        ]
    )


def init_head(name: str) -> str:
    """Return the declaration of the function that initialises a state."""
    return f"void {name}_init({name}_state_t *state)"


def step_head(name: str) -> str:
    """Return the declaration of the function that computes a sample."""
    return f"uint32_t {name}_step({name}_state_t *state, const {name}_input_t *in, {name}_output_t *out)"


def _usage(
    block: Block, layout: Layout, program: Program, notes: Sequence[str], warning: str, latency: int
) -> list[str]:
    """Return the comment on how to call the step."""
    name, period = block.name, f"{block.time.period_s:g} s"
    other = f"Nothing but {name}_tune" if block.tunable else "Nothing else"
    at_once = "" if latency else ", and use its outputs at once"
    texts = [
        *([f"{name}: {warning}"] if warning else []),
        f"{name}: one step every {period}, {layout.ctype}. Generated: do not edit. What may fail and what follows: "
        f"{name}.md.",
        f"Call {name}_init once, then {name}_step once every {period} with the inputs of that sample{at_once}. {other} "
        "may change the state.",
        *_latency(block, latency),
        "The three pointers must not be null and must point to objects that do not overlap. One state serves one "
        "machine; steps on different states may run at the same time.",
        *_safe_output(block),
        *_missed_calls(block),
        *notes,
        *_tunable(block),
        f"The gains and numbers in {name}.c hold for one plant and one period: for other masses, geometry or magnets, "
        "or another period, generate the files again. gains.json says where each gain comes from.",
        *_observation(block, program),
        f"Compile with {FLAGS}. With -ffp-contract=fast results differ by rounding. {REFUSED} are refused by #error. "
        f"{UNSEEN}",
    ]
    said = [row for text in texts for row in ("", *wrap(prose(text), WIDTH, break_on_hyphens=False))]
    return [f"/* {said[1]}", *(f" * {row}".rstrip() for row in said[2:]), " */"]


def _tunable(block: Block) -> list[str]:
    """Return how constants change while the law runs, of a Block with such ones."""
    if not block.tunable:
        return []
    return [
        f"{block.name}_tune changes {len(block.tunable)} constants of the law between two steps, within the ranges of "
        f"{block.name}_parameters_t: over all of them the step keeps what is said here."
    ]


def _observation(block: Block, program: Program) -> list[str]:
    """Return what the diagnostics are for, of a composition that has them."""
    entry = diagnostics.manifest_entry(block, program)
    if not entry:
        return []
    shown = "which signals it computed" + (", what is saturated" if entry["saturated"] else "")
    shown += " and why it latched" if block.latches else ""
    return [
        f"With {diagnostics.macro_name(block)} defined, for the .c as well, {block.name}_step_diagnosed also says "
        f"{shown}. Without the macro the diagnostics cost nothing."
    ]


def _latency(block: Block, samples: int) -> list[str]:
    if not samples:
        return []
    count = f"{samples} sample{'s' if samples > 1 else ''}, {samples * block.time.period_s:g} s,"
    return [
        f"Apply the outputs {count} after the inputs of their sample were measured, neither sooner nor later, and "
        "hold them until the next outputs are due. Margins and simulations assume this delay."
    ]


def _missed_calls(block: Block) -> list[str]:
    """Return what a caller must do about missed calls, for a Block that has an input of their number."""
    fault = next((f for f in block.faults if f.input == missed_calls.MISSED_CALLS), None)
    if fault is None:
        return []
    limit = next(s.high for s in block.inputs if s.name == fault.input)
    return [
        f"While calls are missing, the last outputs act. Count them by a timer or an overrun flag, and give their "
        f"number as {fault.input} in the next call. A number above {limit:g} sets bit {fault.bit} of this sample "
        "and neither brakes nor latches: the caller must then stop the motion, by set-points that no longer move or by "
        "the safe output and init at rest."
    ]


def _safe_output(block: Block) -> list[str]:
    safety = block.safety
    if safety is None:
        return []
    rule = guards.rule(safety.bad_samples - safety.braking, safety.good_samples)
    bad = f"When a measurement is refused in {rule},"
    if not safety.safe_output:
        text = safety.safe_output_effect
        effect = f" {text[0].upper()}{text[1:]}." if text else ""
        return [f"{bad} the last of them sets the latch bit until init.{effect}"]
    latches = f"{bad} the step latches in the last of them until init"
    if safety.braking:
        latches = f"{bad} a latch is certain: whatever is measured then, the step brakes the machine in the "
        latches += f"{safety.braking - 1} samples after the last of these, and latches in the next one until init"
    if safety.judgement:
        latches = f"The step latches until init when the readings do not suffice in {rule}, or when a landing is over"
    units = {s.name: s.unit for s in block.outputs}
    ends: dict[tuple[float, float, str], list[str]] = {}
    for name, value in safety.safe_output.items():
        ends.setdefault((value, safety.slew_per_s[name], units[name]), []).append(name)
    slews = "; ".join(f"{', '.join(names)} to {v:g} {u} at {rate:g} {u}/s" for (v, rate, u), names in ends.items())
    values: dict[tuple[float, str], list[str]] = {}
    for name, value in safety.landed_output.items():
        values.setdefault((value, units[name]), []).append(name)
    landed = "; ".join(f"{', '.join(names)} to {v:g} {u}" for (v, u), names in values.items())
    stop = f" While the machine rests on the stop on which it has landed, they move to others, as fast: {landed}."
    return [
        f"{latches}, and the outputs move to the safe output: {slews}.{stop if landed else ''}",
        "Keep calling the step while it is latched, because the outputs move in its calls only. Call init again only "
        "with the machine at rest: the outputs of the first step after it are not slewed.",
    ]


def _faults(block: Block) -> list[str]:
    if not block.faults:
        return [" * It returns 0: the Block guards no input."]
    status = sum(1 << f.bit for f in block.faults if f.status)
    masked = [f" * The bits of a status, 0x{status:08x}, are no faults: mask them before you compare the word with 0."]
    bits = [f"  bit {f.bit:2d}  {_meaning(f)}" for f in sorted(block.faults, key=lambda f: f.bit)]
    said = [f" * {row}" for bit in bits for row in wrap(bit, WIDTH, subsequent_indent=" " * 10)]
    return [" * It returns the fault bits:", *said, *(masked if status else [])]


def _meaning(fault: Fault) -> str:
    if fault.input and fault.about:
        return f"{fault.input}: {fault.about}"
    if fault.input:
        return f"{fault.input}: not finite or outside its range"
    if fault.status:
        return f"status, no fault: {fault.about}"
    suspected = f"{fault.suspect}: contradicts other measurements or its prediction"
    return suspected if fault.suspect else fault.about or LATCHED


def _size_checks(block: Block, layout: Layout) -> list[str]:
    """Return assertions of the sizes: by the keyword of C11, or an array of negative length where it is false."""
    asserted = [f'_Static_assert(sizeof({s.type}) == {s.size}u, "size of {s.type}");' for s in layout.structs]
    arrays = [
        f"extern char {block.name}_{s.kind}_size_is_{s.size}[(sizeof({s.type}) == {s.size}u) ? 1 : -1];"
        for s in layout.structs
    ]
    standard = "#if defined(__STDC_VERSION__) && (__STDC_VERSION__ >= 201112L)"
    return [standard, *asserted, "#else", *arrays, "#endif"]


def _struct(struct: Struct, layout: Layout) -> str:
    exact = struct is layout.parameters  # a value as printed is taken
    members = [member(f.ctype, f.name, f.comment(layout.digits if exact else 6)) for f in struct.fields]
    return "typedef struct {\n" + "\n".join(members) + f"\n}} {struct.type};"


def _state(struct: Struct, types: Mapping[str, str]) -> str:
    members = [
        routines.state_member(f, types) if f.part else member(f.ctype, f.name, f.comment()) for f in struct.fields
    ]
    return f"struct {struct.tag} {{\n" + "\n".join(dict.fromkeys(members)) + "\n};"
