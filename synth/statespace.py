"""Linear models: dx/dt = A x + B u, y = C x + D u, or x+ = A x + B u in discrete time, with named signals.

Wherever the package takes a model it takes a System: a StateSpace, plain arrays or a python-control system; `of` reads
it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth import show
from synth.errors import SignalError
from synth.signals import dimension
from synth.timing import Continuous, Discrete, Time

Array = NDArray[np.float64]


def readonly(values: ArrayLike) -> Array:
    """Return a read-only float64 copy."""
    array = np.array(values, dtype=np.float64)
    array.flags.writeable = False
    return array


@show.printed
@dataclass(frozen=True, eq=False, repr=False)
class StateSpace:
    """A linear model with n states, m inputs and p outputs.

    A is (n, n), B (n, m), C (p, n), D (p, m), in the SI units of the named signals; `units` maps names to units, as far
    as they are known. An output that has the name of a state has its unit.

    Raises SignalError when shapes and names do not fit, an entry is not finite or a unit cannot be read.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    time: Time
    units: Mapping[str, str] = field(default_factory=dict)

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
        for unit in self.units.values():
            dimension(unit)
        known = {name: self.units[name] for name in (*self.states, *self.inputs, *self.outputs) if name in self.units}
        object.__setattr__(self, "units", known)

    def unit(self, name: str) -> str:
        """Return the unit of a signal, "" where it is not known."""
        return self.units.get(name, "")

    def labels(self, names: Sequence[str]) -> tuple[str, ...]:
        """Return each name with its unit."""
        return tuple(show.named(name, self.unit(name)) for name in names)

    def sheet(self) -> show.Sheet:
        """Return the four matrices as one table: states and outputs down, states and inputs across."""
        after = "d/dt" if isinstance(self.time, Continuous) else "next"
        rows = [*(f"{after} {label}" for label in self.labels(self.states)), *self.labels(self.outputs)]
        table = show.matrix(
            "", np.block([[self.A, self.B], [self.C, self.D]]), rows, (*self.states, *self.labels(self.inputs))
        )
        size = f"{len(self.states)} states, {len(self.inputs)} inputs, {len(self.outputs)} outputs"
        return show.Sheet(f"Linear model in {self.time}: {size}", tables=(table,))

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
        return self.select((output,), (input,))

    def select(self, outputs: Sequence[str], inputs: Sequence[str]) -> "StateSpace":
        """Return the model from some of its inputs to some of its outputs, in the order given; all states stay.

        Raises SignalError for a name that is not known.
        """
        j, i = _places(outputs, self.outputs), _places(inputs, self.inputs)
        B, C, D = self.B[:, i], self.C[j], self.D[np.ix_(j, i)]
        return replace(self, B=B, C=C, D=D, inputs=tuple(inputs), outputs=tuple(outputs))

    def renamed(self, names: Mapping[str, str]) -> "StateSpace":
        """Return the model with signals renamed, old name to new; one that is not in `names` keeps its own."""
        states, inputs, outputs = (
            tuple(names.get(n, n) for n in part) for part in (self.states, self.inputs, self.outputs)
        )
        units = {names.get(n, n): unit for n, unit in self.units.items()}
        return replace(self, states=states, inputs=inputs, outputs=outputs, units=units)

    def to_control(self) -> Any:
        """Return the same model as a python-control StateSpace."""
        import control

        dt = self.time.period_s if isinstance(self.time, Discrete) else 0
        return control.ss(
            self.A, self.B, self.C, self.D, dt, states=self.states, inputs=self.inputs, outputs=self.outputs
        )


System = StateSpace | Sequence[Any] | Any
"""A StateSpace; arrays (A, B), (A, B, C) or (A, B, C, D), a Time after them, or as in SciPy (A, B, C, D, dt); or a
state-space model or transfer function of python-control."""


def of(system: System) -> StateSpace:
    """Return a System as a StateSpace; arrays get the names x1.., u1.., y1.., C is I and D is 0 where left out.

    Arrays without a Time are continuous; a `dt` of 0 says continuous, else it is the period in seconds.

    Raises SignalError when it cannot be read, shapes do not fit, an entry is not finite or the time base is missing.
    """
    if isinstance(system, StateSpace):
        return system
    if isinstance(system, tuple | list):
        return _from_arrays(system)
    if all(hasattr(system, name) for name in ("A", "B", "C", "D", "dt")):
        return from_control(system)
    if all(hasattr(system, name) for name in ("num", "den", "dt")):
        import control

        try:
            return from_control(control.ss(system))
        except (control.ControlMIMONotImplemented, ValueError) as error:
            raise SignalError(f"the transfer function has no state-space form ({error}): give A, B, C, D") from error
    raise SignalError(
        f"a {type(system).__name__} is no linear model: give a StateSpace, arrays (A, B, C, D) or a python-control "
        "system"
    )


def _from_arrays(arrays: Sequence[Any]) -> StateSpace:
    given, time = list(arrays), _given_time(arrays)
    if len(given) == 5 or (given and isinstance(given[-1], Continuous | Discrete)):
        given.pop()
    if len(given) not in (2, 3, 4):
        raise SignalError(f"{len(given)} arrays make no linear model: give (A, B), (A, B, C) or (A, B, C, D)")
    A, B, *rest = (two_dimensional(name, value) for name, value in zip("ABCD", given, strict=False))
    states, inputs = _numbered("x", len(A)), _numbered("u", B.shape[1])
    C = rest[0] if rest else np.eye(len(A))
    D = rest[1] if len(rest) > 1 else np.zeros((len(C), B.shape[1]))
    return StateSpace(A, B, C, D, states, inputs, _numbered("y", len(C)) if rest else states, time)


def _given_time(arrays: Sequence[Any]) -> Time:
    last = arrays[-1] if arrays else None
    if isinstance(last, Continuous | Discrete):
        return last
    if len(arrays) < 5:
        return Continuous()
    if last is None or last is True or np.ndim(last):
        raise SignalError(f"the sample period is {last}: give 0 for continuous time or a period in seconds")
    return Discrete(float(last)) if last else Continuous()


def _numbered(letter: str, count: int) -> tuple[str, ...]:
    return tuple(f"{letter}{k + 1}" for k in range(count))


def two_dimensional(name: str, values: ArrayLike) -> Array:
    """Return a matrix as float64, a scalar as (1, 1); raise SignalError, calling it `name`, when it is no matrix."""
    try:
        if np.iscomplexobj(values):
            raise ValueError("it is complex")
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise SignalError(f"{name} is no array of real numbers ({error}): give a matrix") from error
    array = array.reshape(1, 1) if array.ndim == 0 else array
    if array.ndim != 2:
        raise SignalError(f"{name} has shape {array.shape}: give a matrix with two dimensions")
    return array


def _places(names: Sequence[str], known: Sequence[str]) -> list[int]:
    for name in names:
        if name not in known:
            raise SignalError(f"'{name}' is not one of {', '.join(known)}")
    return [known.index(name) for name in names]


def from_control(system: Any) -> StateSpace:
    """Return a python-control StateSpace as this package's; raise SignalError when its time base is not given."""
    if system.dt is None or system.dt is True:
        raise SignalError("the python-control system has no sample period: give dt = 0 or a period in seconds")
    time = Discrete(float(system.dt)) if system.dt else Continuous()
    labels = (tuple(system.state_labels), tuple(system.input_labels), tuple(system.output_labels))
    return StateSpace(system.A, system.B, system.C, system.D, *labels, time)
