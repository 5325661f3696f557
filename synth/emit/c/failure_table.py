"""Table of failures in the header: one row a failure, its cells wrapped in columns."""

from collections.abc import Sequence
from itertools import zip_longest
from textwrap import wrap

from synth.block import Block
from synth.emit.c.lines import prose
from synth.failure import Failure

COLUMNS = {"what fails": 20, "noticed by, and when": 33, "used instead": 18, "what follows": 37}
_BETWEEN = " | "


def rows(block: Block) -> list[str]:
    """Return the lines of the table of a Block, none for one without failures."""
    if not block.failures:
        return []
    rule = "-+-".join("-" * width for width in COLUMNS.values())
    lines = _row(tuple(COLUMNS))
    for f in block.failures:
        noticed = "; ".join(filter(None, (_bits(block, f), f.noticed)))
        lines += [rule, *_row((f.what, noticed, f.instead, f.reaction))]
    return lines


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


def _row(texts: Sequence[str]) -> list[str]:
    """Return the lines of a row."""
    columns = [wrap(prose(t), width, break_on_hyphens=False) for t, width in zip(texts, COLUMNS.values(), strict=True)]
    return [
        _BETWEEN.join(cell.ljust(width) for cell, width in zip(line, COLUMNS.values(), strict=True)).rstrip()
        for line in zip_longest(*columns, fillvalue="")
    ]
