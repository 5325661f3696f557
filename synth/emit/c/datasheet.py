"""Datasheet <name>.md beside the C of a Block: what may fail and what follows, and where its numbers come from.

The header says what a caller must know to compile and to call; this is what its reader looks up, from the same data.
What is measured on the C (margins, cost, experiments) stands in the report of the stage, which shows this as well.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from synth.block import Block, Constant
from synth.blocks.guard import safety as guards
from synth.emit.passes.surrogates import Surrogate
from synth.emit.proof import word_length
from synth.emit.proof.word_length import LinearPart
from synth.fault import Failure
from synth.show import Sheet, Table
from synth.signals import Signal

PROVED = (
    "Proved at emission, for all states inside their bounds and all inputs, of guarded ones every bit pattern: no "
    "division by zero, no root of a negative number, no argument outside a function's domain; every output is finite "
    "and inside its range, and every next state inside its bounds."
)


@dataclass(frozen=True)
class Facts:
    """What the passes know of a Block that it does not say itself.

    `numbers` are the named constants of the physics before rounding, `parts` its linear dynamics in the scalar type.
    """

    numbers: Sequence[Constant]
    parts: Sequence[LinearPart]
    surrogates: Sequence[Surrogate]
    scalar: str


def sheets(block: Block, facts: Facts, notes: Sequence[str] = ()) -> tuple[Sheet, ...]:
    """Return the sections of the datasheet, without those that have nothing to say; `notes` are further sentences."""
    effect = block.safety.safe_output_effect.split("; ") if block.safety else []
    every = (
        Sheet("What may fail, and what follows", tuple(_replacements(block)), tuple(_failures(block))),
        Sheet("What the safe output does to the machine", tuple(filter(None, effect))),
        Sheet("Notes", tuple(notes)),
        Sheet("Constants and parameters", tables=tuple(_by_parameter(facts.numbers))),
        Sheet("Constants that are tuned on the machine", tables=tuple(_tunable(block))),
        Sheet(
            f"Proofs, rounding to {facts.scalar}, and polynomials in place of functions",
            (PROVED, *word_length.summary(facts.parts, facts.scalar)),
            tuple(_polynomials(facts.surrogates)),
        ),
    )
    return tuple(sheet for sheet in every if sheet.lines or sheet.tables)


def markdown(name: str, parts: Sequence[Sheet], warning: str = "") -> str:
    """Return the text of <name>.md; a `warning` stands before everything else."""
    first = [f"# {name}: {warning}" if warning else f"# {name}", f"What `{name}.h` leaves out. Generated: do not edit."]
    for sheet in parts:
        first += [f"## {sheet.title}", *("\n".join(f"- {line}" for line in sheet.lines),), *map(_rows, sheet.tables)]
    return "\n\n".join(filter(None, first)) + "\n"


def _rows(table: Table) -> str:
    """Return a table as Markdown."""
    every = (table.columns, ("---",) * len(table.columns), *table.rows)
    return "\n".join(f"| {' | '.join(str(cell).replace('|', '&#124;') for cell in row)} |" for row in every)


def _failures(block: Block) -> list[Table]:
    rows = [
        (f.what, "; ".join(filter(None, (_bits(block, f), f.noticed))), f.instead, f.reaction) for f in block.failures
    ]
    columns = ("what fails", "noticed by, and when", "used instead", "what follows")
    return [Table("Failures", columns, tuple(rows))] if rows else []


def _bits(block: Block, failure: Failure) -> str:
    """Return the bits of the fault word that a failure sets."""
    bits = [
        *(f.bit for f in block.faults if f.input in failure.inputs),
        *(f.bit for f in block.faults if f.suspect in failure.suspects),
    ]
    runs: list[list[int]] = []
    for bit in sorted(bits):
        if runs and bit == runs[-1][-1] + 1:
            runs[-1].append(bit)
        else:
            runs.append([bit])
    texts = [f"{run[0]} to {run[-1]}" if len(run) > 2 else ", ".join(map(str, run)) for run in runs]
    return f"{'bit' if len(bits) == 1 else 'bits'} {', '.join(texts)}" if bits else ""


def _by_parameter(numbers: Sequence[Constant]) -> list[Table]:
    """Return which named constants follow from which parameters of the plant; gains and bounds may follow as well."""
    names: dict[str, list[str]] = {}
    for number in numbers:
        for parameter in number.parameters:
            names.setdefault(parameter, []).append(number.name)
    groups: dict[tuple[str, ...], list[str]] = {}
    for parameter, constants in names.items():
        groups.setdefault(tuple(sorted(constants)), []).append(parameter)
    rows = tuple((", ".join(sorted(of)), ", ".join(constants)) for constants, of in sorted(groups.items()))
    return [Table("Constants by parameter", ("parameters of the plant", "constants that follow"), rows)] if rows else []


def _tunable(block: Block) -> list[Table]:
    tunable = [s for s in block.states if s.name in block.tunable]
    rows = [(s.name, s.signal.unit, *(f"{v:.6g}" for v in (s.initial, s.signal.low, s.signal.high))) for s in tunable]
    return [Table("Tunable", ("constant", "unit", "declared", "from", "to"), tuple(rows))] if rows else []


def _polynomials(surrogates: Sequence[Surrogate]) -> list[Table]:
    columns = ("function", "of", "from", "to", "degree", "largest relative error")
    rows = [
        (s.name, s.variable, *(f"{v:.4g}" for v in (p.low, p.high)), str(p.degree), f"{p.max_relative_error:.2g}")
        for s in surrogates
        for p in (s.polynomial,)
    ]
    return [Table("Polynomials", columns, tuple(dict.fromkeys(rows)))] if rows else []


def _replacements(block: Block) -> list[str]:
    """Return what the step takes in place of a refused input."""
    initial = {s.name: s.initial for s in block.states} | {c.name: c.value for c in block.constants}
    signals = {s.name: s for s in block.inputs}
    guarded = {f.output.removeprefix("fault_"): signals[f.input] for f in block.faults if f.input}
    replaced = block.safety.judgement.measurements if block.safety and block.safety.judgement else ()
    guarded = {n: s for n, s in guarded.items() if s.name not in replaced}
    last, fixed = (
        {s: initial[name] for n, s in guarded.items() if (name := f"{guards.GUARD}_{of}_{n}") in initial}
        for of in ("last", "refused")
    )
    elsewhere = {n for f in block.failures if f.instead != guards.INITIAL for n in f.inputs}
    fixed = {s: value for s, value in fixed.items() if s.name not in elsewhere}  # else the table says what is used
    texts = [f"by its last good value, and before its first good value by {_values(last)}"] if last else []
    texts += [f"{'always ' if last else ''}by {_values(fixed)}"] if fixed else []
    if not texts:
        return []
    others = "; a refused measurement is replaced by what the others or a prediction say, from the first sample on"
    return [f"A refused input is replaced {', or '.join(texts)}{others if replaced else ''}."]


def _values(initial: Mapping[Signal, float]) -> str:
    """Return values with the names of their inputs, those of one value together."""
    groups: dict[str, list[str]] = {}
    for signal, value in initial.items():
        groups.setdefault(f"{value:g} {signal.unit}".removesuffix(" 1"), []).append(signal.name)
    return ", ".join(f"{value} ({', '.join(names)})" for value, names in groups.items())
