"""State-space models with named signals (`control.ss`, MATLAB `ss`).

    continuous   dx/dt = A x + B u,  y = C x + D u            discrete   x[k+1] = A x[k] + B u[k]

Every function for models takes a System: a StateSpace, plain arrays or a python-control system; `of` reads it.

Conversion of plain arrays and of models of python-control and scipy.signal to A, B, C, D, names and time.
"""

import copy
from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth import arguments, resolvent, show
from synth.errors import ModelError, SignalError, TimingError
from synth.signals import dimension
from synth.timing import Continuous, Discrete, Time, period

Array = NDArray[np.float64]
Names = tuple[str, ...]
StateSpaceFields = tuple[Array, Array, Array, Array, Names, Names, Names, Time]
"""A, B, C, D, states, inputs, outputs, time."""


@arguments.checked
def coefficients(system: Any) -> tuple[Array, Array] | None:
    """Return numerator and denominator of a scalar transfer function, highest powers first; None for another System."""
    if not all(hasattr(system, name) for name in ("num", "den", "dt")):
        return None
    b, a = (v[0][0] if isinstance(v, list) else v for v in (system.num, system.den))
    return arguments.matrix("numerator", [b])[0], arguments.matrix("denominator", [a])[0]


def from_fractions(system: Any) -> StateSpaceFields:
    """Return python-control's transfer functions, each in companion form, without pole-zero cancellation."""
    p, m = len(system.num), len(system.num[0])
    parts = [[_companion(system.num[i][j], system.den[i][j]) for j in range(m)] for i in range(p)]
    order = sum(len(part[0]) for row in parts for part in row)
    A, B, C, D = np.zeros((order, order)), np.zeros((order, m)), np.zeros((p, order)), np.zeros((p, m))
    first = 0
    for i, j in np.ndindex(p, m):
        a, b, c, D[i, j] = parts[i][j]
        states = slice(first, first + len(a))
        A[states, states], B[states, j], C[i, states] = a, b, c
        first = states.stop
    labels = (tuple(system.input_labels), tuple(system.output_labels))
    return A, B, C, D, _numbered_names("x", order), *labels, time_of(system.dt)


def _companion(numerator: Any, denominator: Any) -> tuple[Array, Array, Array, float]:
    """Return A (n, n), B (n,), C (n,) and D of numerator over denominator, highest powers first."""
    quotient = [arguments.matrix(name, [v])[0] for name, v in (("numerator", numerator), ("denominator", denominator))]
    if not all(np.isfinite(v).all() for v in quotient):
        raise SignalError(
            f"the transfer function {quotient[0]} / {quotient[1]} is not finite: give finite coefficients"
        )
    b, a = (np.trim_zeros(v, "f") for v in quotient)
    if not len(a) or len(b) > len(a):
        raise SignalError(
            f"the transfer function {quotient[0]} / {quotient[1]} has no state-space form: its denominator must "
            "not be 0, and its degree must be at least that of the numerator"
        )
    n = len(a) - 1
    exact = [[Fraction(float(v)) for v in part] for part in (a, np.concatenate([np.zeros(len(a) - len(b)), b]))]
    a, b = ([v / exact[0][0] for v in part] for part in exact)
    A = np.eye(n, k=-1)
    A[:1] = [-float(v) for v in a[1:]]
    C = np.array([float(v - b[0] * u) for v, u in zip(b[1:], a[1:], strict=True)])
    return A, np.eye(n, 1)[:, 0], C, float(b[0])


def from_scipy(system: Any) -> StateSpaceFields:
    """Return a system of scipy.signal; those in continuous time have no `dt`, or None for it."""
    try:
        model = system.to_ss()
    except ValueError as error:
        raise SignalError(f"the scipy.signal system has no state-space form ({error}): give A, B, C, D") from error
    dt = getattr(model, "dt", None)
    return from_arrays((model.A, model.B, model.C, model.D, 0 if dt is None else dt))


def from_arrays(arrays: Sequence[Any]) -> StateSpaceFields:
    """Return arrays (A, B), (A, B, C) or (A, B, C, D), with or without a time after them."""
    matrices, time = list(arrays), _time_argument(arrays)
    if len(matrices) == 5 or (matrices and isinstance(matrices[-1], Continuous | Discrete)):
        matrices.pop()
    if len(matrices) not in (2, 3, 4):
        raise SignalError(f"{len(matrices)} arrays make no linear model: give (A, B), (A, B, C) or (A, B, C, D)")
    A, B, *rest = (arguments.matrix(name, value) for name, value in zip("ABCD", matrices, strict=False))
    states, inputs = _numbered_names("x", len(A)), _numbered_names("u", B.shape[1])
    C = rest[0] if rest else np.eye(len(A))
    D = rest[1] if len(rest) > 1 else np.zeros((len(C), B.shape[1]))
    return A, B, C, D, states, inputs, _numbered_names("y", len(C)) if rest else states, time


def _time_argument(arrays: Sequence[Any]) -> Time:
    last = arrays[-1] if arrays else None
    if isinstance(last, Continuous | Discrete):
        return last
    if len(arrays) < 5:
        return Continuous()
    return time_of(last)


def time_of(dt: Any) -> Time:
    """Return the Time of a `dt`: 0 is continuous, another number a period in seconds."""
    value = dt.item() if isinstance(dt, np.ndarray | np.generic) and dt.size == 1 and not np.ndim(dt) else dt
    if not isinstance(value, int | float) or value is True:
        raise SignalError(f"there is no sample period, dt is {dt!r}: give 0 for continuous time or a period in seconds")
    return Discrete(float(value)) if value else Continuous()


def _numbered_names(letter: str, count: int) -> tuple[str, ...]:
    return tuple(f"{letter}{k + 1}" for k in range(count))


Complex = NDArray[np.complex128]


def readonly(values: ArrayLike) -> Array:
    """Return a read-only float64 copy; raise SignalError when the values are not an array of numbers."""
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise SignalError(
            f"{arguments.describe(values)} is not an array of real numbers ({error}): give one"
        ) from error
    array.flags.writeable = False
    return array


@arguments.checked
@show.result
class StateSpace:
    """A linear model with n states, m inputs and p outputs.

    A is (n, n), B (n, m), C (p, n), D (p, m), in the SI units of the named signals; `units` maps names to known
    units. An output that has the name of a state has its unit.

    Raises SignalError when shapes and names do not fit, an entry is not a finite real number, a unit cannot be read or
    `time` is not a Time.
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
        if not isinstance(self.time, Continuous | Discrete):
            raise SignalError(f"the time is {self.time!r}: give Continuous() or Discrete(period in seconds)")
        n, m, p = len(self.states), len(self.inputs), len(self.outputs)
        for letter, shape in {"A": (n, n), "B": (n, m), "C": (p, n), "D": (p, m)}.items():
            value = readonly(arguments.real(f"entries of {letter}", getattr(self, letter)))
            if value.shape != shape:
                raise SignalError(f"{letter} has shape {value.shape} but the signal names require {shape}")
            if not np.isfinite(value).all():
                row, column = np.argwhere(~np.isfinite(value))[0]
                of = (self.states if letter in "AB" else self.outputs)[row]
                by = (self.states if letter in "AC" else self.inputs)[column]
                raise SignalError(
                    f"{letter}[{row}, {column}] is {value[row, column]}, that of '{of}' by '{by}': all entries must be "
                    "finite; linearise where the model has finite slopes"
                )
            object.__setattr__(self, letter, value)
        for kind, labels in {"state": self.states, "input": self.inputs, "output": self.outputs}.items():
            if len(set(labels)) < len(labels):
                raise SignalError(f"a name is listed twice among the {kind}s {', '.join(labels)}: give each its own")
        for unit in self.units.values():
            dimension(unit)
        known = {name: self.units[name] for name in (*self.states, *self.inputs, *self.outputs) if name in self.units}
        object.__setattr__(self, "units", known)

    def unit(self, name: str) -> str:
        """Return the unit of a signal, "" where it is unknown."""
        return self.units.get(name, "")

    def labels(self, names: Sequence[str]) -> tuple[str, ...]:
        """Return each name with its unit."""
        return tuple(show.with_unit(name, self.unit(name)) for name in names)

    def sheet(self) -> show.Sheet:
        """Return the four matrices as one table: states and outputs down, states and inputs across."""
        continuous = isinstance(self.time, Continuous)
        prefix = "d/dt" if continuous else "next"
        rows = [*(f"{prefix} {label}" for label in self.labels(self.states)), *self.labels(self.outputs)]
        table = show.matrix(
            "", np.block([[self.A, self.B], [self.C, self.D]]), rows, (*self.states, *self.labels(self.inputs))
        )
        size = f"{len(self.states)} states, {len(self.inputs)} inputs, {len(self.outputs)} outputs"
        derivative = r"\dot{x} = A x + B u" if continuous else r"x_{k+1} = A x_k + B u_k"
        output = r"y = C x + D u" if continuous else r"y_k = C x_k + D u_k"
        table = replace(table, equation=rf"{derivative},\quad {output}")
        return show.Sheet(f"Linear model in {self.time}: {size}", tables=(table,))

    @property
    def poles(self) -> Complex:
        """Eigenvalues of A, sorted by real then imaginary part."""
        return np.sort_complex(np.linalg.eigvals(self.A).astype(np.complex128))

    def response(self, s_or_z: ArrayLike) -> Complex:
        """Return C (v I - A)^-1 B + D at each point v of `s_or_z` (k,) as an array (k, p, m).

        Values beyond what a double holds are not finite.

        Raises SignalError when the points are not a list of finite numbers; ModelError naming a pole among them.
        """
        try:
            v = np.atleast_1d(np.asarray(s_or_z, dtype=np.complex128))
        except (TypeError, ValueError) as error:
            raise SignalError(f"the points are not numbers ({error}): give a list of them") from error
        if v.ndim != 1:
            raise SignalError(f"the points have shape {v.shape}: give a list, as by points.ravel()")
        if not np.isfinite(v).all():
            point = show.number(v[~np.isfinite(v)][0])
            raise SignalError(f"a point is {point}: give finite ones; at infinity the response is D")
        try:
            with np.errstate(all="ignore"):
                return resolvent.response(self.A, self.B, self.C, self.D, v)
        except np.linalg.LinAlgError as error:
            pole = show.number(resolvent.singular(self.A, v))
            raise ModelError(f"the response has no value at {pole}, a pole: leave it out") from error

    def channel(self, output: str, input: str) -> "StateSpace":
        """Return the single-input single-output model from `input` to `output`."""
        return self.select((output,), (input,))

    def select(self, outputs: Sequence[str], inputs: Sequence[str]) -> "StateSpace":
        """Return the model from some of its inputs to some of its outputs, in the order given; all states stay.

        Raises SignalError for a name that is not known.
        """
        j, i = _indices(outputs, self.outputs), _indices(inputs, self.inputs)
        B, C, D = self.B[:, i], self.C[j], self.D[np.ix_(j, i)]
        return replace(self, B=B, C=C, D=D, inputs=tuple(inputs), outputs=tuple(outputs))

    def renamed(self, names: Mapping[str, str]) -> "StateSpace":
        """Return the model with signals renamed, old name to new; other names stay."""
        states, inputs, outputs = (
            tuple(names.get(n, n) for n in part) for part in (self.states, self.inputs, self.outputs)
        )
        units = {names.get(n, n): unit for n, unit in self.units.items()}
        return replace(self, states=states, inputs=inputs, outputs=outputs, units=units)

    def to_control(self) -> Any:
        """Return the same model as a python-control StateSpace.

        Raises SignalError for states without inputs or outputs, which python-control does not support.
        """
        import control

        dt = self.time.period_s if isinstance(self.time, Discrete) else 0
        labels = {"states": self.states, "inputs": self.inputs, "outputs": self.outputs}
        try:
            return control.ss(self.A, self.B, self.C, self.D, dt, **labels)
        except control.ControlDimension as error:
            raise SignalError(
                f"python-control takes no model with {len(self.inputs)} inputs and {len(self.outputs)} outputs "
                f"({error}): give it at least one of each"
            ) from error


System = StateSpace | Sequence[Any] | Any
"""A StateSpace; arrays (A, B), (A, B, C) or (A, B, C, D), a Time after them, or as in SciPy (A, B, C, D, dt); or a
state-space model or transfer function of python-control or of scipy.signal."""


@arguments.checked
def of(system: System) -> StateSpace:
    """Return a System as a StateSpace; arrays get the names x1.., u1.., y1.., C is I and D is 0 where left out.

    Arrays without a Time are continuous; a `dt` of 0 says continuous, else it is the period in seconds. SciPy's own
    systems without a `dt` are continuous.

    Raises SignalError when it cannot be read, shapes do not fit, an entry is not finite or the time base is missing;
    TimingError when the period is not positive.
    """
    if isinstance(system, StateSpace):
        return system
    if isinstance(system, tuple | list):
        return StateSpace(*from_arrays(system))
    if all(hasattr(system, name) for name in ("to_ss", "to_tf", "to_zpk")):
        return StateSpace(*from_scipy(system))
    if all(hasattr(system, name) for name in ("A", "B", "C", "D", "dt")):
        return from_control(system)
    if all(hasattr(system, name) for name in ("num", "den", "dt")):
        return StateSpace(*from_fractions(system))
    raise SignalError(
        f"a {type(system).__name__} is not a linear model: give a StateSpace, arrays (A, B, C, D) or a system of "
        "python-control or scipy.signal"
    )


@arguments.checked
def in_common_time(*systems: System) -> tuple[StateSpace, ...]:
    """Return Systems for a connection as StateSpaces with a common time.

    A python-control system with `dt` None takes the time of the others. One with `dt` True is sampled with an unknown
    period and takes theirs.

    Raises as `of`, which reads all systems where none has a time; TimingError for a `dt` of True beside continuous
    models.
    """
    known = [of(system) for system in systems if not _lacks_period(system)]
    if not known:
        return tuple(of(system) for system in systems)
    time, remaining = known[0].time, iter(known)
    return tuple(_in_time(system, time) if _lacks_period(system) else next(remaining) for system in systems)


def _lacks_period(system: System) -> bool:
    """Return whether a system of python-control lacks a time or a period."""
    dt = getattr(system, "dt", 0)
    return hasattr(system, "ninputs") and (dt is None or dt is True)


def _in_time(system: Any, time: Time) -> StateSpace:
    if system.dt and isinstance(time, Continuous):
        raise TimingError(f"a sampled system (dt is True) meets {time}: sample the other, or give it its period")
    known = copy.copy(system)
    known.dt = period(time) if isinstance(time, Discrete) else 0
    return of(known)


def _indices(names: Sequence[str], known: Sequence[str]) -> list[int]:
    for name in names:
        if name not in known:
            raise SignalError(f"'{name}' is not one of {', '.join(known)}")
    return [known.index(name) for name in names]


@arguments.checked
def from_control(system: Any) -> StateSpace:
    """Return a python-control StateSpace as this package's; raise SignalError when its time base is not given."""
    if not all(hasattr(system, name) for name in ("A", "B", "C", "D", "dt", "state_labels")):
        raise SignalError(f"{arguments.describe(system)} is not a StateSpace of python-control: give one, or use `of`")
    time = time_of(system.dt)
    labels = (tuple(system.state_labels), tuple(system.input_labels), tuple(system.output_labels))
    return StateSpace(system.A, system.B, system.C, system.D, *labels, time)
