"""Manifest: the C interface as JSON (functions, struct layouts, faults, safety, surrogates, trace, checksums).

Test vectors: recorded inputs and the responses of the emitted C, step by step from `init`, for any test harness.
"""

import hashlib
import json
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.block import LATCH_BIT, Block, Constant, Fault
from synth.emit.c import tuning
from synth.emit.c.lines import Line
from synth.emit.passes.surrogates import Surrogate
from synth.emit.program.layout import Layout, Struct
from synth.errors import EmitError
from synth.fault import Judgement


def manifest(
    block: Block,
    layout: Layout,
    texts: Mapping[str, str],
    surrogates: Sequence[Surrogate],
    source: Sequence[Line],
    numbers: Sequence[Constant] = (),
    diagnostics: Mapping[str, Any] = MappingProxyType({}),
) -> dict[str, Any]:
    """Return the manifest of the emitted `texts` (file name to text) as a JSON document.

    `trace` maps each Block of the composition, with its equation, to the lines of <name>.c that compute it, as ranges
    [first, last] of line numbers from 1. `numbers` are constants of the physics and limits, which no gain document has.
    """
    return {
        "design": block.name,
        "period_s": block.time.period_s,
        "scalar": np.dtype(layout.scalar).name,
        "functions": {"init": f"{block.name}_init", "step": f"{block.name}_step"},
        "structs": {s.kind: _struct(s) for s in layout.structs},
        "faults": [_fault(f) for f in block.faults],
        "safety": _safety(block),
        "numbers": {c.name: {"value": c.value, "unit": c.unit, "from": c.source} for c in numbers},
        "surrogates": [_surrogate(s) for s in surrogates],
        "diagnostics": dict(diagnostics),
        **({"tuning": tuning.manifest_entry(block, layout)} if block.tunable else {}),
        "trace": _trace(source),
        "sha256": {name: hashlib.sha256(text.encode()).hexdigest() for name, text in texts.items()},
    }


def _fault(fault: Fault) -> dict[str, Any]:
    named = {"input": fault.input, "suspect": fault.suspect, "about": fault.about}
    status = {"status": True} if fault.status else {}
    return {"bit": fault.bit, **({k: v for k, v in named.items() if v} or {"latched": True}), **status}


def _struct(struct: Struct) -> dict[str, Any]:
    fields = [
        {"name": f.name, "offset": f.offset, "count": 1, "ctype": f.ctype, "unit": f.unit, "low": f.low, "high": f.high}
        | ({"path": f.path} if f.path != f.name else {})
        for f in struct.fields
    ]
    return {"type": struct.type, "size": struct.size, "fields": fields}


def _surrogate(s: Surrogate) -> dict[str, Any]:
    p = s.polynomial
    return {
        "tag": ", ".join(s.tags),
        "function": s.name,
        "variable": s.variable,
        "low": p.low,
        "high": p.high,
        "degree": p.degree,
        "max_relative_error": p.max_relative_error,
        "checked_values": p.checked_values,
    }


def _trace(source: Sequence[Line]) -> dict[str, list[list[int]]]:
    runs: dict[str, list[list[int]]] = {}
    before = ""
    for number, line in enumerate(source, 1):
        if line.tag and line.tag == before:
            runs[line.tag][-1][1] = number
        elif line.tag:
            runs.setdefault(line.tag, []).append([number, number])
        before = line.tag
    return runs


def _safety(block: Block) -> dict[str, Any] | None:
    if not block.latches:
        return None
    safety = block.safety
    if safety is None:
        raise EmitError(
            f"block '{block.name}' latches (fault bit {LATCH_BIT}) but does not say what it does then: give it a "
            "`safety`, as safety.guard and safe_output.block do"
        )
    return {
        "bad_samples": safety.bad_samples,
        **({"braking": safety.braking} if safety.braking else {}),
        **({"good_samples": safety.good_samples} if safety.good_samples else {}),
        "safe_output": dict(safety.safe_output),
        "slew_per_s": dict(safety.slew_per_s),
        **({"landed_output": dict(safety.landed_output)} if safety.landed_output else {}),
        "safe_output_effect": safety.safe_output_effect,
        **({"judgement": _judgement(safety.judgement)} if safety.judgement else {}),
    }


def _judgement(judgement: Judgement) -> dict[str, Any]:
    measurements = list(judgement.measurements)
    return {"counts": judgement.counts, "at_once": judgement.at_once, "measurements": measurements}


def dumps(document: Mapping[str, Any], warning: str = "") -> str:
    """Return a JSON text with one field or row a line, ending in a newline; a `warning` stands in its first line."""
    text = json.dumps({"warning": warning, **document} if warning else document, indent=1, allow_nan=False)
    text = text.replace("\n ", "", 1) if warning else text
    return _short_rows(text) + "\n"


def _short_rows(text: str) -> str:
    """Join each innermost object or list of an indented JSON text into one line."""
    lines, out = text.split("\n"), []
    k = 0
    while k < len(lines):
        line = lines[k]
        end = k + 1
        if line.rstrip().endswith(("{", "[")):
            while end < len(lines) and not lines[end].rstrip().endswith(("{", "[", "}", "]", "},", "],")):
                end += 1
            if end < len(lines) and lines[end].strip() in ("}", "]", "},", "],") and end > k + 1:
                inner = " ".join(part.strip() for part in lines[k + 1 : end])
                line, k = line + inner + lines[end].strip(), end
        out.append(line)
        k += 1
    return "\n".join(out)


Columns = Mapping[str, NDArray[Any]]


def document(inputs: Columns, outputs: Columns, faults: NDArray[np.uint32]) -> str:
    """Return vectors.json: columns (N,) by name, numbers in the fewest digits that read back in their scalar type."""

    def lists(columns: Columns) -> dict[str, list[float]]:
        return {name: [float(str(v)) for v in column] for name, column in columns.items()}

    return dumps({"inputs": lists(inputs), "outputs": lists(outputs), "faults": [int(f) for f in faults]})


def inputs(text: str) -> dict[str, NDArray[np.float64]]:
    """Return the inputs (N,) by name from the text of vectors.json."""
    return {name: np.array(column, dtype=np.float64) for name, column in json.loads(text)["inputs"].items()}
