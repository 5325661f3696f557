"""Code generation as a whole (Embedded Coder): Block in, `{file name: text}` out; only `save` writes to disk."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from synth.base import store
from synth.block import Block
from synth.emit import pipeline
from synth.emit.c import c_text, datasheet, diagnostics, header, manifest
from synth.emit.program.lower import Program
from synth.emit.proof import word_length
from synth.emit.proof.word_length import LinearPart
from synth.show import Sheet


@dataclass(frozen=True)
class EmittedCode:
    """The generated text files, the manifest that describes them, and what else is known of the program.

    `program` is the printed one, `parts` say what the scalar type does to its linear dynamics, and `datasheet` are the
    sections of <name>.md.
    """

    files: Mapping[str, str]
    manifest: Mapping[str, Any]
    program: Program | None = None
    parts: tuple[LinearPart, ...] = ()
    datasheet: tuple[Sheet, ...] = ()


def emit(
    block: Block,
    scalar: type[np.floating],
    gains: Mapping[str, Any] | None = None,
    libm: bool = False,
    error: float | None = None,
    header_notes: Sequence[str] = (),
    datasheet_notes: Sequence[str] = (),
    warning: str = "",
    latency: int = 0,
    gain_error: float = word_length.GAIN_ERROR,
) -> EmittedCode:
    """Return <name>.c, .h, .md, manifest.json and gains.json of a Block in a scalar type.

    Constants are rounded to the scalar type here, once. `gains` is the document for gains.json. Functions of one
    variable become polynomials with a relative error of at most `error`, by default 2e-7 in float32 and 1e-14 in
    float64; with `libm` they remain calls of the C library. `header_notes` and
    `datasheet_notes` are further sentences of <name>.h and <name>.md. A `warning` stands in the first line of both and
    of the manifest, before anything else. The header says that outputs act
    `latency` samples after the measurement.

    For a Block that latches, the manifest documents its safety.

    Raises EmitError for a scalar type or an operation without a form in C, for an operation that is not proved safe
    over the declared ranges, and for a DC gain that rounding to the scalar type changes by more than `gain_error`.
    """
    rounded = block.rounded(scalar)
    made = pipeline.c_source(rounded, scalar, libm, error)
    parts = word_length.linear_parts(made.reduced, block, scalar)
    word_length.require_gains(parts, gain_error, scalar)
    facts = datasheet.Facts(made.of_plant, parts, made.surrogates, np.dtype(scalar).name)
    sheets = datasheet.sheets(rounded, facts, datasheet_notes)
    texts = {
        f"{block.name}.c": "".join(f"{line.text}\n" for line in made.lines),
        f"{block.name}.h": header.header(rounded, made.memory, made.program, header_notes, warning, latency),
        f"{block.name}.md": datasheet.markdown(block.name, sheets, warning),
    }
    observed = diagnostics.manifest_entry(rounded, made.program)
    document = manifest.manifest(rounded, made.memory, texts, made.surrogates, made.lines, made.numbers, observed)
    listed = {c.name: {"value": c.value, "unit": c.unit, "from": c.source} for c in rounded.constants}
    for state in (s for s in rounded.states if s.name in block.tunable):
        s = state.signal
        listed[s.name] = {"value": state.initial, "unit": s.unit, "from": s.about, "low": s.low, "high": s.high}
    texts["manifest.json"] = manifest.dumps(document, warning)
    texts["gains.json"] = manifest.dumps({"constants": listed} | dict(gains or {}))
    return EmittedCode(texts, json.loads(texts["manifest.json"]), made.reduced, parts, sheets)


def with_casadi_c(emitted: EmittedCode, block: Block, error: float | None = None) -> EmittedCode:
    """Return the emitted files of a Block with the step by CasADi's own code generator in <name>.c, header unchanged.

    `error` is that of `emit`. The manifest has neither surrogates nor a trace; test vectors remain those of the emitted
    C.
    """
    scalar: type[np.floating] = np.float32 if emitted.manifest["scalar"] == "float32" else np.float64
    rounded, name = block.rounded(scalar), f"{block.name}.c"
    text = c_text.casadi_source(rounded, pipeline.c_source(rounded, scalar, False, error).memory)
    checksums = {**emitted.manifest["sha256"], name: hashlib.sha256(text.encode()).hexdigest()}
    document = {**emitted.manifest, "surrogates": [], "diagnostics": {}, "trace": {}, "sha256": checksums}
    files = {**emitted.files, name: text, "manifest.json": manifest.dumps(document)}
    return replace(emitted, files=files, manifest=document, program=None)


def save(files: Mapping[str, str], folder: Path) -> None:
    """Write each text to `folder`, which is created if needed; a file that already holds its text is not rewritten.

    An interrupt leaves each file as it was or with its new text.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        path = folder / name
        if not path.exists() or path.read_text() != text:
            store.replace_text(path, text)
