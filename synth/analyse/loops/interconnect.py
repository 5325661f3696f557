"""Interconnection of linear models by signal name (MATLAB `connect`, python-control `interconnect`).

With all models in parallel, x' = A x + B u, y = C x + D u, and every input a sum of outputs and of external inputs r,

    u = W y + V r,     u = (I - W D)^-1 (W C x + V r).

An input of a model is wired to the output or external input of the same name. Other wires are given as
{input: {signal: factor}}.
"""

from collections.abc import Mapping, Sequence
from numbers import Real

import numpy as np
import scipy.linalg

from synth import arguments
from synth.analyse.numerics import magnitude
from synth.errors import ModelError, SignalError
from synth.signals import dimension
from synth.statespace import Array, StateSpace, System, in_common_time, of
from synth.timing import Continuous, common

Wires = Mapping[str, Mapping[str, float]]


@arguments.checked
def connect(models: Sequence[System], inputs: Sequence[str], outputs: Sequence[str], wires: Wires) -> StateSpace:
    """Return the model from the external `inputs` to some of the models' `outputs`.

    `wires[input]` = {signal: factor} gives an input of a model as a sum of outputs and external inputs. An input
    without a wire takes the signal of the same name, or is 0 if there is none. States keep their names.

    Raises TimingError for different times; SignalError for no models, an unknown or duplicate name, an external input
    that reaches no model, a factor that is not finite or a wire of factor 1 or -1 between different units; ModelError
    for an algebraic loop without a solution.
    """
    parts = in_common_time(*models)
    if not parts:
        raise SignalError("there are no models to connect: give at least one")
    time = common(*(m.time for m in parts))
    u, y, x = (_unique_names(kind, parts) for kind in ("inputs", "outputs", "states"))
    if both := sorted(set(inputs) & set(y)):
        raise SignalError(f"'{both[0]}' is an external input and a model's output: rename one of them")
    units = {name: unit for m in parts for name, unit in m.units.items()}
    sources = (*y, *inputs)
    direct = {name: {name: 1.0} for name in u if name in sources}
    wired = {**direct, **wires}
    M = _matrix(wired, u, sources, units)
    for name in inputs:
        if not any(name in sums for sums in wired.values()):
            raise SignalError(
                f"the external input '{name}' reaches no model: wire it, or give it the name of an input that is in no "
                f"wire: {', '.join(n for n in u if n not in wired) or 'there is none'}"
            )
    W, V = M[:, : len(y)], M[:, len(y) :]
    A, B, C, D = (scipy.linalg.block_diag(*(getattr(m, letter) for m in parts)) for letter in "ABCD")
    A, B, C, D = (v.reshape(s) for v, s in zip((A, B, C, D), _shapes(len(x), len(u), len(y)), strict=True))
    loop = np.eye(len(u)) - W @ D
    if magnitude.is_singular(loop):
        raise ModelError(
            "the models pass signals around a loop at once, without a solution: I - W D is singular; "
            "put a state or a delay into the loop"
        )
    F, G = np.linalg.solve(loop, W @ C), np.linalg.solve(loop, V)
    joined = StateSpace(A + B @ F, B @ G, C + D @ F, D @ G, x, tuple(inputs), y, time, units)
    return joined.select(outputs, inputs)


@arguments.checked
def integrals(system: System, signals: Mapping[str, str]) -> StateSpace:
    """Return integrators z' = y, in discrete time z+ = z + T y, for each {z: name of y} of a model's signals.

    An integral has the unit of its signal times s.

    Raises SignalError for a signal that the model does not have.
    """
    model, k = of(system), len(signals)
    known = (*model.outputs, *model.states, *model.inputs)
    if unknown := [source for source in signals.values() if source not in known]:
        raise SignalError(f"'{unknown[0]}' is no signal of the model: give some of {', '.join(known)}")
    inputs = tuple(dict.fromkeys(signals.values()))
    B = np.array([[float(name == source) for name in inputs] for source in signals.values()]).reshape(k, len(inputs))
    A, rate = (np.zeros((k, k)), 1.0) if isinstance(model.time, Continuous) else (np.eye(k), model.time.period_s)
    units = {name: _times_s(model.unit(source)) for name, source in signals.items() if model.unit(source)}
    units |= {name: model.unit(name) for name in inputs if model.unit(name)}
    names = tuple(signals)
    return StateSpace(A, rate * B, np.eye(k), np.zeros((k, len(inputs))), names, inputs, names, model.time, units)


def _times_s(unit: str) -> str:
    return "s" if unit == "1" else unit.removesuffix("/s") if unit.endswith("/s") else f"{unit} s"


def _unique_names(kind: str, parts: Sequence[StateSpace]) -> tuple[str, ...]:
    names = tuple(name for m in parts for name in getattr(m, kind))
    for name in names:
        if names.count(name) > 1:
            raise SignalError(f"'{name}' is listed {names.count(name)} times among the models' {kind}: rename one")
    return names


def _shapes(n: int, m: int, p: int) -> tuple[tuple[int, int], ...]:
    return (n, n), (n, m), (p, n), (p, m)


def _matrix(wires: Wires, u: Sequence[str], sources: Sequence[str], units: Mapping[str, str]) -> Array:
    M = np.zeros((len(u), len(sources)))
    for end, sums in wires.items():
        if not isinstance(sums, Mapping):
            raise SignalError(f"the wire to '{end}' is {sums!r}: give {{signal: factor}}")
        for start, factor in sums.items():
            for name, known in ((end, u), (start, sources)):
                if name not in known:
                    raise SignalError(f"wire from '{start}' to '{end}': '{name}' is not one of {', '.join(known)}")
            if not isinstance(factor, Real) or not np.isfinite(factor):
                raise SignalError(f"wire from '{start}' to '{end}': the factor is {factor!r}: give a finite number")
            here, there = units.get(end), units.get(start)
            if here and there and abs(factor) == 1 and dimension(here) != dimension(there):
                raise SignalError(f"wire from '{start}' in {there} to '{end}' in {here}: give the factor between them")
            M[u.index(end), sources.index(start)] = factor
    return M
