"""Emission as a whole: Block in, `{file name: text}` out; one function touches the disk."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from synth.block import Block
from synth.emit import c_text, layout, lower, manifest
from synth.synthesise.safety import Safety


@dataclass(frozen=True)
class Emitted:
    """The emitted text files and the manifest that describes them."""

    files: Mapping[str, str]
    manifest: Mapping[str, Any]


def emit(
    block: Block, scalar: type[np.floating], safety: Safety | None = None, gains: Mapping[str, Any] | None = None
) -> Emitted:
    """Return <name>.c, <name>.h, manifest.json and gains.json of a Block in a scalar type.

    Constants are rounded to the scalar type here, once. `gains` is the document that becomes gains.json.

    Raises EmitError for a scalar type or an operation without a form in C.
    """
    shipped = block.rounded(scalar)
    memory = layout.layout(shipped, scalar)
    program = lower.program(shipped)
    texts = {
        f"{block.name}.c": c_text.source(shipped, program, memory),
        f"{block.name}.h": c_text.header(shipped, memory),
    }
    document = manifest.manifest(shipped, memory, safety, texts)
    shipped_gains = {
        "constants": {c.name: {"value": c.value, "unit": c.unit, "from": c.source} for c in shipped.constants}
    }
    texts["manifest.json"] = manifest.dumps(document)
    texts["gains.json"] = manifest.dumps(shipped_gains | dict(gains or {}))
    return Emitted(texts, json.loads(texts["manifest.json"]))


def save(files: Mapping[str, str], folder: Path) -> None:
    """Write each text to `folder`, which is made if need be; a file that holds the text already is left alone."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        path = folder / name
        if not path.exists() or path.read_text() != text:
            path.write_text(text)
