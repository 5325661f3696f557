"""Test vectors: recorded inputs and the responses of the emitted C, step by step from `init`, for any test harness."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.emit.c import manifest

Columns = Mapping[str, NDArray[Any]]


def document(inputs: Columns, outputs: Columns, faults: NDArray[np.uint32]) -> str:
    """Return vectors.json: columns (N,) by name, numbers in the fewest digits that read back in their scalar type."""

    def lists(columns: Columns) -> dict[str, list[float]]:
        return {name: [float(str(v)) for v in column] for name, column in columns.items()}

    return manifest.dumps({"inputs": lists(inputs), "outputs": lists(outputs), "faults": [int(f) for f in faults]})


def inputs(text: str) -> dict[str, NDArray[np.float64]]:
    """Return the inputs (N,) by name from the text of vectors.json."""
    return {name: np.array(column, dtype=np.float64) for name, column in json.loads(text)["inputs"].items()}
