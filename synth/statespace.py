"""Linear models: dx/dt = A x + B u, y = C x + D u, or x+ = A x + B u in discrete time, with named signals."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth.errors import SignalError
from synth.timing import Continuous, Discrete, Time

Array = NDArray[np.float64]


def readonly(values: ArrayLike) -> Array:
    """Return a read-only float64 copy."""
    array = np.array(values, dtype=np.float64)
    array.flags.writeable = False
    return array


@dataclass(frozen=True, eq=False)
class StateSpace:
    """A linear model with n states, m inputs and p outputs.

    A is (n, n), B (n, m), C (p, n), D (p, m), in the SI units of the named signals.

    Raises SignalError when shapes and names do not fit or an entry is not finite.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    time: Time

    def __post_init__(self) -> None:
        n, m, p = len(self.states), len(self.inputs), len(self.outputs)
        for letter, shape in {"A": (n, n), "B": (n, m), "C": (p, n), "D": (p, m)}.items():
            value = readonly(getattr(self, letter))
            if value.shape != shape:
                raise SignalError(f"{letter} has shape {value.shape} but the signal names ask for {shape}")
            if not np.isfinite(value).all():
                row, column = np.argwhere(~np.isfinite(value))[0]
                raise SignalError(f"{letter}[{row}, {column}] is {value[row, column]}: all entries must be finite")
            object.__setattr__(self, letter, value)
        for kind, labels in {"state": self.states, "input": self.inputs, "output": self.outputs}.items():
            if len(set(labels)) < len(labels):
                raise SignalError(f"a name stands twice among the {kind}s {', '.join(labels)}: give each its own")

    @property
    def poles(self) -> NDArray[np.complex128]:
        """Eigenvalues of A, sorted by real then imaginary part."""
        return np.sort_complex(np.linalg.eigvals(self.A).astype(np.complex128))

    def response(self, s_or_z: ArrayLike) -> NDArray[np.complex128]:
        """Return C (v I - A)^-1 B + D at each point v of `s_or_z` (k,) as an array (k, p, m)."""
        v = np.atleast_1d(np.asarray(s_or_z, dtype=np.complex128))
        resolvent = np.linalg.solve(
            v[:, None, None] * np.eye(len(self.A)) - self.A, np.broadcast_to(self.B, (len(v), *self.B.shape))
        )
        return np.asarray(self.C @ resolvent + self.D, dtype=np.complex128)

    def channel(self, output: str, input: str) -> "StateSpace":
        """Return the single-input single-output model from `input` to `output`."""
        for name, known in ((output, self.outputs), (input, self.inputs)):
            if name not in known:
                raise SignalError(f"'{name}' is not one of {', '.join(known)}")
        j, i = self.outputs.index(output), self.inputs.index(input)
        C, B, D = self.C[j : j + 1], self.B[:, i : i + 1], self.D[j : j + 1, i : i + 1]
        return StateSpace(self.A, B, C, D, self.states, (input,), (output,), self.time)

    def to_control(self) -> Any:
        """Return the same model as a python-control StateSpace."""
        import control

        dt = self.time.period_s if isinstance(self.time, Discrete) else 0
        return control.ss(
            self.A, self.B, self.C, self.D, dt, states=self.states, inputs=self.inputs, outputs=self.outputs
        )


def from_control(system: Any) -> StateSpace:
    """Return a python-control StateSpace as this package's; raise SignalError when its time base is not given."""
    if system.dt is None or system.dt is True:
        raise SignalError("the python-control system has no sample period: give dt = 0 or a period in seconds")
    time = Discrete(float(system.dt)) if system.dt else Continuous()
    labels = (tuple(system.state_labels), tuple(system.input_labels), tuple(system.output_labels))
    return StateSpace(system.A, system.B, system.C, system.D, *labels, time)
