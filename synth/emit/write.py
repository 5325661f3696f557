"""Emission as a whole: Block in, `{file name: text}` out; one function touches the disk."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from synth import store
from synth.block import Block
from synth.emit import pipeline
from synth.emit.c import c_text, layout, manifest
from synth.emit.lower import Program


@dataclass(frozen=True)
class Emitted:
    """The emitted text files, the manifest that describes them, and the program that was printed, where it is known."""

    files: Mapping[str, str]
    manifest: Mapping[str, Any]
    program: Program | None = None


def emit(
    block: Block,
    scalar: type[np.floating],
    gains: Mapping[str, Any] | None = None,
    libm: bool = False,
    error: float | None = None,
) -> Emitted:
    """Return <name>.c, <name>.h, manifest.json and gains.json of a Block in a scalar type.

    Constants are rounded to the scalar type here, once. `gains` is the document that becomes gains.json. Functions of
    one variable become polynomials with a relative `error` of at most 2e-7 in float32 and 1e-14 in float64 when it is
    left out, unless `libm` is to compute them.

    The manifest tells the safety that the Block carries, where it latches.

    Raises EmitError for a scalar type or an operation without a form in C, and for an operation that is not proved safe
    over the declared ranges.
    """
    shipped = block.rounded(scalar)
    memory = layout.layout(shipped, scalar)
    printed = pipeline.reduce(shipped, scalar, libm, error)
    source = pipeline.source(printed, memory)
    texts = {
        f"{block.name}.c": "".join(f"{line.text}\n" for line in source),
        f"{block.name}.h": c_text.header(shipped, memory),
    }
    document = manifest.manifest(shipped, memory, texts, printed.surrogates, source)
    shipped_gains = {
        "constants": {c.name: {"value": c.value, "unit": c.unit, "from": c.source} for c in shipped.constants}
    }
    texts["manifest.json"] = manifest.dumps(document)
    texts["gains.json"] = manifest.dumps(shipped_gains | dict(gains or {}))
    return Emitted(texts, json.loads(texts["manifest.json"]), printed.program)


def save(files: Mapping[str, str], folder: Path) -> None:
    """Write each text to `folder`, which is made if need be; a file that holds the text already is left alone.

    An interrupt leaves each file as it was or with its new text.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        path = folder / name
        if not path.exists() or path.read_text() != text:
            store.replace_text(path, text)
