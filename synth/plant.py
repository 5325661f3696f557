"""Symbolic nonlinear plants, dx/dt = f(x, u, p), y = h(x, u, p), valid in a box of states and inputs."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth import arguments, law, show
from synth.base import column_maps
from synth.block import Constant
from synth.errors import SignalError
from synth.signals import Parameter, Signal, dimension, per_second, signal_names

Symbols = Mapping[str, ca.SX]
Formula = Callable[[Symbols], ca.SX]
Physics = Callable[[Symbols, Symbols, Symbols], tuple[Mapping[str, ca.SX], Mapping[str, ca.SX]]]


@arguments.checked
@show.result
class Plant:
    """A continuous nonlinear model; the signals' ranges are its domain.

    `f` and `h` are CasADi functions of (x, u, p) with columns in the order of the signals.
    """

    name: str
    states: tuple[Signal, ...]
    inputs: tuple[Signal, ...]
    outputs: tuple[Signal, ...]
    parameters: tuple[Parameter, ...]
    f: ca.Function
    h: ca.Function

    def sheet(self) -> show.Sheet:
        """Return the signals with their ranges, and the parameters."""
        groups = {"state": self.states, "input": self.inputs, "output": self.outputs}
        rows = ((p.name, show.number(p.value), p.unit, p.tolerance_text, p.source) for p in self.parameters)
        parameters = show.Table("", ("parameter", "value", "unit", "tolerance", "source"), tuple(rows))
        tables = (show.signals(groups), *([parameters] if self.parameters else []))
        return show.Sheet(f"Plant {self.name}: dx/dt = f(x, u, p), y = h(x, u, p)", tables=tables)

    @property
    def values(self) -> NDArray[np.float64]:
        """The parameters' values, in order."""
        return np.array([p.value for p in self.parameters])

    def parameter(self, name: str) -> Parameter:
        """Return the parameter called `name`."""
        for p in self.parameters:
            if p.name == name:
                return p
        raise SignalError(
            f"plant '{self.name}' has no parameter '{name}': it has {', '.join(signal_names(self.parameters))}"
        )

    def constant(self, name: str, unit: str = "", formula: Formula | None = None, source: str = "") -> Constant:
        """Return a number of a law with a name for the C, for `block.Step`: a parameter, or a `formula` of parameters.

        Without a `source`, the formula and the values of its parameters are the source of its value.

        Raises SignalError for a formula that needs more than the parameters.
        """
        if formula is None:
            p = self.parameter(name)
            return Constant(name, p.value, p.unit, p.source, parameters=(name,))
        symbol = {p.name: ca.SX.sym(p.name) for p in self.parameters}
        expr = ca.SX(law.evaluate(f"the formula of '{name}'", formula, symbol))
        read = [p for p in self.parameters if ca.depends_on(expr, symbol[p.name])]
        value = float(ca.Function("value", list(symbol.values()), [expr])(*self.values))
        values = ", ".join(f"{p.name} = {p.value:g} {p.unit}" for p in read)
        return Constant(name, value, unit, source or f"{_text(expr)}, {values}", (), tuple(p.name for p in read))

    def with_parameters(self, **values: float) -> "Plant":
        """Return the plant with some parameters' values replaced."""
        for name in values:
            self.parameter(name)
        changed = {p.name: value for p in self.parameters if (value := values.get(p.name, p.value)) != p.value}
        if not changed:
            return self
        parameters = (replace(p, value=changed[p.name]) if p.name in changed else p for p in self.parameters)
        return replace(self, parameters=tuple(parameters))

    def output_values(self, values: Mapping[str, ArrayLike]) -> dict[str, NDArray[np.float64]]:
        """Return the outputs (N,) by name at `values` of states and inputs, (N,) or constants; others are 0.

        Raises SignalError for a name that is neither a state nor an input.
        """
        names = [s.name for s in (*self.states, *self.inputs)]
        if unknown := [name for name in values if name not in names]:
            raise SignalError(f"plant '{self.name}' has no state or input '{unknown[0]}': it has {', '.join(names)}")
        columns = np.broadcast_arrays(*(np.atleast_1d(values.get(name, 0.0)) for name in names))
        x, u = np.split(np.array(columns, dtype=np.float64), [len(self.states)])
        (y,) = column_maps.map_columns(self.h, x, u, self.values)
        return dict(zip((s.name for s in self.outputs), y, strict=True))


@arguments.checked
def velocities(plant: Plant) -> dict[str, str]:
    """Return the velocity of each position: the state that is its derivative in the model."""
    x, u, p = (ca.SX.sym(name, n) for name, n in zip("xup", map(plant.f.size1_in, range(3)), strict=True))
    f, states = ca.vertsplit(plant.f(x, u, p)), [s.name for s in plant.states]
    pairs = ((i, j) for i in range(len(states)) for j in range(len(states)) if ca.is_equal(f[i], x[j]))
    return {states[i]: states[j] for i, j in pairs}


def _text(expr: ca.SX) -> str:
    """Return a formula as text; CasADi prints (x/(2.*y)) for x / (2 y)."""
    text = re.sub(r"(\d)\.(?!\d)", r"\1", str(expr)).replace("*", " ")
    return re.sub(r"(?<=\S)/(?=\S)", " / ", text[1:-1] if text.startswith("(") else text)


@arguments.checked
def symbols(signals: Sequence[Signal | Parameter]) -> dict[str, ca.SX]:
    """Return one scalar SX symbol for each signal, by name."""
    return {name: ca.SX.sym(name) for name in signal_names(signals)}


@arguments.checked
def build(
    name: str,
    states: Sequence[Signal],
    inputs: Sequence[Signal],
    outputs: Sequence[Signal],
    parameters: Sequence[Parameter],
    physics: Physics,
) -> Plant:
    """Make a Plant from `physics(x, u, p) -> (derivatives by state, outputs by name)`.

    Raises SignalError when a derivative or output is missing or unknown, when an output has the name of a state but
    is another quantity, when a parameter has the name of a signal, or when a state that is the derivative of another
    has not its unit per s.
    """
    for signal in (s.name for s in (*states, *inputs, *outputs) if s.name in signal_names(parameters)):
        raise SignalError(f"plant '{name}': '{signal}' names a parameter and a signal: give the parameter another name")
    x, u, p = symbols(states), symbols(inputs), symbols(parameters)
    kinds = zip(("states", "inputs", "parameters"), (x, u, p), strict=True)
    named = (law.NamedSymbols(f"among its {kind} plant '{name}'", s) for kind, s in kinds)
    derivative, output = _pair(name, law.evaluate(f"the physics of plant '{name}'", physics, *named))
    law.require_names(f"plant '{name}': derivatives", signal_names(states), derivative)
    law.require_names(f"plant '{name}': outputs", signal_names(outputs), output)
    _require_true_states(name, x, output)
    args = [ca.vcat(list(s.values())) for s in (x, u, p)]
    f = ca.Function("f", args, [ca.vcat([derivative[s.name] for s in states])], ["x", "u", "p"], ["dx"])
    for exprs in (derivative, output):
        law.check_numbers(f"plant '{name}'", exprs, args)
    h = ca.Function("h", args, [ca.vcat([output[s.name] for s in outputs])], ["x", "u", "p"], ["y"])
    plant = Plant(name, tuple(states), tuple(inputs), tuple(outputs), tuple(parameters), f, h)
    unit = {s.name: s.unit for s in states}
    for position, rate in velocities(plant).items():
        if rate != position and dimension(unit[rate]) != dimension(needed := per_second(unit[position])):
            raise SignalError(
                f"plant '{name}': the derivative of '{position}' [{unit[position]}] is '{rate}', which is declared in "
                f"{unit[rate]}: it needs {needed}"
            )
    return plant


def _require_true_states(name: str, states: Mapping[str, ca.SX], outputs: Mapping[str, ca.SX]) -> None:
    """Raise SignalError for an output that is called like a state and is not that state, such as a biased reading."""
    for signal in (n for n in outputs if n in states and not ca.is_equal(ca.SX(outputs[n]), states[n])):
        raise SignalError(
            f"output '{signal}' of plant '{name}' is not the state '{signal}' but another quantity: give it a name of "
            f"its own, for example '{signal}_read', and name that in the sensor, Sensor('{signal}', of='{signal}_read')"
        )


def _pair(name: str, values: object) -> tuple[Mapping[str, ca.SX], Mapping[str, ca.SX]]:
    if isinstance(values, tuple) and len(values) == 2 and all(isinstance(part, Mapping) for part in values):
        return values
    raise SignalError(
        f"the physics of plant '{name}' returns {arguments.describe(values)}: return two mappings, the derivatives by "
        "state and the outputs by name"
    )
