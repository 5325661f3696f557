"""What the rows of the audit of Y are computed from: the plant's parameters, the printed numbers, a loop's records.

A row declares each parameter of the plant, "mu0_M0", and each printed number, "Y-4.G", that its figures follow from.
Printed numbers that a row only compares its figures with are not declared.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca

from synth.plant import Plant
from synth.report.audit import Published
from synth.simulate.rig import Rig

MM = 1e-3


@dataclass(frozen=True, eq=False)
class Bench:
    """The plant under audit, and what the paper prints by row."""

    plant: Plant
    published: Mapping[str, Published]

    def printed(self, source: str) -> float:
        """Return a printed number in its printed unit, such as "Y-4.G"."""
        row, name = source.split(".")
        return self.published[row][name].value

    def value(self, name: str) -> float:
        """Return a parameter of the plant, SI."""
        return self.plant.parameter(name).value

    def values(self, **changed: float) -> dict[str, ca.SX]:
        """Return the plant's parameters by name as constant expressions, some of them `changed`."""
        parameters = {p.name: p.value for p in self.plant.parameters} | changed
        return {name: ca.SX(value) for name, value in parameters.items()}


@dataclass(frozen=True, eq=False)
class Recorder:
    """The simulated loop whose records are judged, and what the paper prints by row."""

    loop: Rig
    published: Mapping[str, Published]
