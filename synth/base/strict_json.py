"""Strict JSON (RFC 8259): null for the numbers that JSON does not have, infinities and NaN."""

import json
import math
from collections.abc import Mapping
from typing import Any


def dumps(document: Any) -> str:
    """Return a document as JSON with null for a number that JSON does not have."""
    return json.dumps(_finite(document), indent=1, allow_nan=False)


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {k: _finite(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(v) for v in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
