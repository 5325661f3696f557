"""What the rows of the audit of Y are computed from: the plant's parameters, the printed numbers, functions.

A row that is a function declares each parameter of the plant, "mu0_M0", and each printed number, "Y-4.G", that its
figures follow from. Printed numbers that a row only compares its figures with are not declared.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca

from synth.plant import Plant
from synth.report.audit import Published

UNITS = {"mm": 1e-3, "um": 1e-6, "inch": 25.4e-3}  # in m
MM = UNITS["mm"]


def constants(p: Mapping[str, float]) -> dict[str, ca.SX]:
    """Return numbers by name as the constant expressions that models take."""
    return {name: ca.SX(value) for name, value in p.items()}


@dataclass(frozen=True, eq=False)
class Bench:
    """The plant under audit, what the paper prints by row, and functions for the formulas of rows."""

    plant: Plant
    published: Mapping[str, Published]
    functions: Mapping[str, Any]

    @property
    def parameters(self) -> dict[str, float]:
        """The plant's parameters by name, SI."""
        return {p.name: p.value for p in self.plant.parameters}

    def printed(self, source: str) -> float:
        """Return a printed number in its printed unit, such as "Y-4.G"."""
        row, name = source.split(".")
        return self.published[row][name].value

    def values(self, **changed: float) -> dict[str, ca.SX]:
        """Return the plant's parameters by name as constant expressions, some of them `changed`."""
        return constants(self.parameters | changed)
