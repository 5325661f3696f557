"""A hand-written controller with the contract of emitted C, and defects to plant in it."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

HOVER = Path(__file__).parent / "hover"
INPUTS = {"g1": (0.0125, 0.0365), "g2": (0.0125, 0.0365), "r": (0.018, 0.031)}
OUTPUTS = {"i1": (-4.95, 4.95), "i2": (-4.95, 4.95)}
STATES = {
    "last_g1": (0.0125, 0.0365),
    "last_g2": (0.0125, 0.0365),
    "last_r": (0.018, 0.031),
    "bad_g1": (0, 5),
    "bad_g2": (0, 5),
    "latched": (0, 1),
    "xi": (-0.05, 0.05),
    "v": (-30.0, 30.0),
    "safe_i1": (-4.95, 4.95),
    "safe_i2": (-4.95, 4.95),
}


@pytest.fixture(scope="session")
def files() -> dict[str, str]:
    return {path.name: path.read_text() for path in sorted(HOVER.glob("hover.[ch]"))}


@pytest.fixture(scope="session")
def manifest() -> dict[str, Any]:
    return {
        "design": "hover",
        "scalar": "float32",
        "functions": {"init": "hover_init", "step": "hover_step"},
        "structs": {role: struct(role, bounds) for role, bounds in ROLES.items()},
        "faults": [
            *({"bit": bit, "input": name} for bit, name in enumerate(INPUTS)),
            {"bit": 31, "latched": True},
        ],
    }


@pytest.fixture(scope="session")
def planted(files: dict[str, str]) -> Callable[[str, str], dict[str, str]]:
    """Return the files with one text replaced by another wherever it stands."""

    def plant(old: str, new: str) -> dict[str, str]:
        assert old in files["hover.c"], f"the C no longer holds {old!r}"
        return files | {"hover.c": files["hover.c"].replace(old, new)}

    return plant


ROLES = {"input": INPUTS, "output": OUTPUTS, "state": STATES}


def struct(role: str, bounds: dict[str, tuple[float, float]]) -> dict[str, Any]:
    """A struct whose members are 4 bytes each; bounds are what the C compares with."""
    fields = [
        {
            "name": name,
            "offset": 4 * k,
            "count": 1,
            "ctype": "uint32_t" if isinstance(low, int) else "float",
            "low": float(np.float32(low)),
            "high": float(np.float32(high)),
        }
        for k, (name, (low, high)) in enumerate(bounds.items())
    ]
    return {"type": f"hover_{role}_t", "size": 4 * len(fields), "fields": fields}
