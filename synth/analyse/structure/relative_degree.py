"""Vector relative degree and decoupling matrix of an input-affine plant, dx/dt = f + G u, y = h + E u.

r_i is the order of the first derivative of y_i that contains an input: L_G L_f^k h_i = 0 for k < r_i - 1, and

    d^r_i y_i / dt^r_i = a_i(x) + D_i(x) u,    a_i = L_f^r_i h_i,    D_i = L_G L_f^(r_i - 1) h_i,

or r_i = 0 with a_i = h_i and D_i = E_i if an input enters y_i itself. D (p, m) is the decoupling matrix, a (p,) the
drift. The degree is defined where D has rank p: D_i must not vanish, nor depend on the other rows. `precise.vanish`
decides which expressions vanish on the whole domain; `singularity.worst` finds single points where D loses rank.

Source: Isidori, Nonlinear Control Systems, 5.1.

Input-affine plants and their Lie derivatives.

    dx/dt = f(x) + G(x) u,    y = h(x) + E(x) u,    x (n,), u (m,), y (p,)

Along a solution a function e(x) changes at the rate L_f e + (L_G e) u with

    L_f e = de/dx f,    L_G e = de/dx G.

Source: Isidori, Nonlinear Control Systems, 4.1 and 5.1.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from synth import arguments, show
from synth.analyse.numerics import nearest_root, precise
from synth.analyse.numerics.nearest_root import Box
from synth.analyse.structure import singularity
from synth.errors import ModelError, SignalError
from synth.plant import Plant
from synth.signals import Signal, signal_names
from synth.statespace import Array


@dataclass(frozen=True, eq=False)
class Affine:
    """The plant called `name` as f (n,), G (n, m), h (p,), E (p, m) in the symbols of `box`: states and parameters.

    Structural zeros of G and E are entries that vanish on the whole domain. `held` has the inputs that are constant.
    """

    name: str
    states: tuple[Signal, ...]
    inputs: tuple[Signal, ...]
    outputs: tuple[Signal, ...]
    box: Box
    f: ca.SX
    G: ca.SX
    h: ca.SX
    E: ca.SX
    held: Mapping[str, float]

    @property
    def x(self) -> ca.SX:
        """The states' symbols (n,)."""
        return self.box.symbols

    def along_drift(self, e: ca.SX) -> ca.SX:
        """Return L_f e for each entry of e (k,)."""
        return ca.cse(ca.jtimes(e, self.x, self.f))  # without cse the length grows as the factorial of the order

    def along_inputs(self, e: ca.SX) -> ca.SX:
        """Return L_G e (k, m) for the entries of e (k,), with structural zeros."""
        return precise.without_zeros(ca.cse(ca.mtimes(ca.jacobian(e, self.x), self.G)), self.box)


@arguments.checked
def affine(plant: Plant, outputs: Sequence[str] | None = None, held: Mapping[str, float] | None = None) -> Affine:
    """Return the plant in affine form, with the named `outputs`, by default all, and the inputs that are not `held`.

    `held` gives the constant values of inputs, by name, in their units.

    Raises SignalError for a name that the plant does not have, ModelError if an equation is not affine in the inputs.
    """
    held = dict(held or {})
    rows = _output_rows(plant, outputs)
    inputs = _free_inputs(plant, held)
    x, u = (ca.vertcat(*(ca.SX.sym(s.name) for s in part)) for part in (plant.states, inputs))
    free = dict(zip(signal_names(inputs), ca.vertsplit(u), strict=True))
    all_inputs = ca.vertcat(*(free[s.name] if s.name in free else ca.SX(held[s.name]) for s in plant.inputs))
    p = ca.vertcat(ca.SX(0, 1), *(ca.SX.sym(s.name) for s in plant.parameters))
    stacked = ca.vertcat(plant.f(x, all_inputs, p), plant.h(x, all_inputs, p)[rows])
    base = ca.SX([float(np.clip(0.0, s.low, s.high)) for s in inputs])
    slopes, level = (ca.substitute(e, u, base) for e in (ca.jacobian(stacked, u), stacked))
    equations = [f"the rate of '{s.name}'" for s in plant.states] + [f"'{plant.outputs[k].name}'" for k in rows]
    box_of_all = Box(ca.vertcat(x, u), (*plant.states, *inputs), p, plant.values)
    _require_affine(plant.name, equations, (stacked, slopes, base), box_of_all)
    of_states = Box(x, plant.states, p, plant.values)
    slopes = precise.without_zeros(slopes, of_states)
    ends = [0, len(plant.states), len(equations)]
    (f, h), (G, E) = ca.vertsplit(level - ca.mtimes(slopes, base), ends), ca.vertsplit(slopes, ends)
    outs = tuple(plant.outputs[k] for k in rows)
    return Affine(plant.name, plant.states, inputs, outs, of_states, f, G, h, E, held)


def _output_rows(plant: Plant, outputs: Sequence[str] | None) -> list[int]:
    known = signal_names(plant.outputs)
    chosen = known if outputs is None else tuple(outputs)
    if unknown := [n for n in chosen if n not in known]:
        raise SignalError(f"plant '{plant.name}' has no output '{unknown[0]}': it has {', '.join(known)}")
    if not chosen or len(set(chosen)) < len(chosen):
        raise SignalError(f"the outputs are ({', '.join(chosen)}): name at least one, and each once")
    return [known.index(n) for n in chosen]


def _free_inputs(plant: Plant, held: Mapping[str, float]) -> tuple[Signal, ...]:
    known = signal_names(plant.inputs)
    if unknown := [n for n in held if n not in known]:
        raise SignalError(f"plant '{plant.name}' has no input '{unknown[0]}' to hold: it has {', '.join(known)}")
    if bad := [n for n, v in held.items() if not np.isfinite(v)]:
        raise SignalError(f"the input '{bad[0]}' is held at {held[bad[0]]}: give a finite value")
    inputs = tuple(s for s in plant.inputs if s.name not in held)
    if not inputs:
        raise SignalError(f"plant '{plant.name}': every input is held: leave at least one free")
    return inputs


def _require_affine(
    plant: str,
    equations: Sequence[str],
    parts: tuple[ca.SX, ca.SX, ca.SX],
    box: Box,
) -> None:
    """Raise ModelError unless e (k,) = e(u with u_j = base_j) + slope_j (u_j - base_j) for every input j."""
    stacked, slopes, base = parts
    m = base.numel()
    u, inputs = box.symbols[-m:], box.signals[-m:]
    nonaffine: dict[str, list[str]] = {}
    for j, input in enumerate(inputs):
        remainder = stacked - ca.substitute(stacked, u[j], base[j]) - slopes[:, j] * (u[j] - base[j])
        for k in np.flatnonzero(~precise.vanish(ca.densify(remainder), box)):
            nonaffine.setdefault(equations[int(k)], []).append(input.name)
    if nonaffine:
        terms = "; ".join(
            f"{equation} in {', '.join(nonaffine[equation])}" for equation in equations if equation in nonaffine
        )
        input_names = ", ".join(s.name for s in inputs if any(s.name in part for part in nonaffine.values()))
        raise ModelError(
            f"plant '{plant}' is not affine in its inputs: {terms}. Make {input_names} states, "
            "with their rates as inputs, declare the whole term as the input and invert it outside, or hold it"
        )


RANK = 1e-9  # of the largest singular value: below it, rows of scaled size count as dependent


@dataclass(frozen=True)
class Rows:
    """The outputs whose rows of D are independent almost everywhere, and the rows on which each other row depends."""

    independent: tuple[str, ...]
    dependent: Mapping[str, tuple[str, ...]]


@show.result
class RelativeDegree:
    """Degrees (p,) of `model`'s outputs, with decoupling matrix D (p, m) and drift a (p,) in the symbols `model.x`.

    `chains` holds y_i and its derivatives below the degree; `rows` lists the independent rows of D.
    """

    model: Affine
    degrees: tuple[int, ...]
    chains: tuple[ca.SX, ...]
    decoupling: ca.SX
    drift: ca.SX
    rows: Rows

    @cached_property
    def worst_rows(self) -> Mapping[str, singularity.WorstCondition]:
        """The point of the domain where each row of D is closest to vanishing, by output.

        Raises ModelError if D is not finite.
        """
        return {name: singularity.worst(self._scaled([i])) for i, name in enumerate(self.outputs)}

    @cached_property
    def worst(self) -> singularity.WorstCondition | None:
        """The point of the domain where D is closest to losing rank p; None if the rank is below p everywhere.

        Raises ModelError if D is not finite.
        """
        return None if self.rows.dependent else singularity.worst(self.scaled)

    @property
    def outputs(self) -> tuple[str, ...]:
        """The outputs' names."""
        return signal_names(self.model.outputs)

    @property
    def scaled(self) -> singularity.Scaled:
        """The decoupling matrix, with columns in half ranges of the inputs and rows divided by their largest norms."""
        return self._scaled(range(len(self.degrees)))

    def _scaled(self, rows: Sequence[int]) -> singularity.Scaled:
        m, labels = self.model, [self.outputs[i] for i in rows]
        return singularity.scaled(self.decoupling[list(rows), :], m.x, m.states, m.inputs, labels)

    @cached_property
    def authority(self) -> Mapping[str, float]:
        """Control authority by output: max |D_i| u over max |a_i|, u the inputs' half ranges; inf without drift.

        Each maximum is over scattered points of the domain.

        Raises ModelError if D or a is not finite.
        """
        points = np.hstack([nearest_root.scatter(self.model.states, precise.POINTS, seed) for seed in precise.SEEDS])
        terms = np.abs(self.model.box.evaluate(ca.densify(ca.horzcat(self.decoupling, self.drift)), points))
        effect = np.einsum("pmk,m->pk", terms[:, :-1], nearest_root.half_widths(self.model.inputs)).max(axis=1)
        drift = terms[:, -1].max(axis=1)
        ratios = [float(r / a) if a else np.inf for r, a in zip(effect, drift, strict=True)]
        return dict(zip(self.outputs, ratios, strict=True))

    def require_constant_rank(self) -> None:
        """Raise ModelError, with point and cause, unless D has rank p on the whole domain."""
        if self.worst is None:
            raise ModelError(f"the relative degree of plant '{self.model.name}' is not defined: {self._dependence()}")
        if self.worst.singular and len(self.degrees) == 1:
            raise ModelError(
                f"the relative degree of '{self.outputs[0]}' is not defined at {self.worst.where}: no input enters "
                f"its derivative {self.degrees[0]} there; shrink the ranges of the signals, or choose another output"
            )
        if self.worst.singular:
            raise ModelError(
                f"the decoupling matrix of ({', '.join(self.outputs)}) is singular in the domain: its condition rises "
                f"to {self.worst.condition:.3g} (at most {singularity.CONDITION_LIMIT:.3g} is needed) at "
                f"{self.worst.where}: shrink the ranges of the signals, or choose other outputs or inputs"
            )

    def _dependence(self) -> str:
        p, m = self.decoupling.shape
        if p > m:
            inputs = ", ".join(signal_names(self.model.inputs))
            return f"{p} outputs ({', '.join(self.outputs)}) meet {m} inputs ({inputs}): choose as many outputs"
        dependences = [f"that of '{name}' on {_quote(others)}" for name, others in self.rows.dependent.items()]
        return (
            f"rows of the decoupling matrix depend on others everywhere, {'; '.join(dependences)}. "
            "Make inputs states of the plant, with their rates as inputs, or choose other outputs"
        )

    def _regularity(self, worst: singularity.WorstCondition) -> str:
        if worst.singular:
            return f"singular at {worst.where}"
        return f"nonsingular in the domain, condition up to {worst.condition:.4g} at {worst.where}"

    def sheet(self) -> show.Sheet:
        """Return the degrees, the point where each row is closest to vanishing, and the matrix's worst condition."""
        n, total = len(self.model.states), sum(self.degrees)
        if self.worst is None:
            lines = [f"not defined: {self._dependence()}"]
        else:
            rest = f"zero dynamics of order {n - total}" if n > total else "no zero dynamics"
            lines = [f"sum {total} of {n} states: {rest}", f"decoupling matrix: {self._regularity(self.worst)}"]
        rows = []
        for signal, r, row in zip(self.model.outputs, self.degrees, range(len(self.degrees)), strict=True):
            worst = self.worst_rows[signal.name]
            entering = [s.name for j, s in enumerate(self.model.inputs) if self.decoupling.sparsity().has_nz(row, j)]
            authority = f"{self.authority[signal.name]:.3g}"
            rows.append((signal.name, str(r), ", ".join(entering), authority, f"{worst.condition:.4g}", worst.where))
        columns = ("output", "degree", "through", "inputs over drift", "largest over least row", "least at")
        table = show.Table("", columns, tuple(rows))
        return show.Sheet(f"Relative degree of '{self.model.name}'", tuple(lines), (table,))


@arguments.checked
def of_plant(
    plant: Plant, outputs: Sequence[str] | None = None, held: Mapping[str, float] | None = None
) -> RelativeDegree:
    """Return the vector relative degree of `outputs`, by default all, for the inputs that are not `held`.

    Raises SignalError and ModelError as `affine`; ModelError if no input affects an output.
    """
    return of_affine(affine(plant, outputs, held))


@arguments.checked
def of_affine(model: Affine) -> RelativeDegree:
    """Return the vector relative degree of a plant in affine form.

    Raises ModelError if no input affects an output, or a derivative is not finite in the domain.
    """
    derivatives = [_chain(model, i) for i in range(len(model.outputs))]
    D, drift = (model.box.with_values(ca.vcat([parts[k] for parts in derivatives])) for k in (1, 2))
    degrees = tuple(chain.numel() for chain, _, _ in derivatives)
    chains = tuple(model.box.with_values(chain) for chain, _, _ in derivatives)
    return RelativeDegree(model, degrees, chains, D, drift, _rows(D, model))


def _chain(model: Affine, i: int) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Return y_i with its derivatives below the degree (r,), the row D_i (1, m) and the drift a_i."""
    chain: list[ca.SX] = []
    row, e = model.E[i, :], model.h[i]
    while not row.nnz() and len(chain) < len(model.states):
        chain.append(e)
        row, e = model.along_inputs(e), model.along_drift(e)
    if not row.nnz():
        raise ModelError(
            f"the relative degree of '{model.outputs[i].name}' in plant '{model.name}' is not defined: none of its "
            f"{len(chain)} derivatives contains an input ({', '.join(signal_names(model.inputs))}): "
            "choose another output"
        )
    return ca.vertcat(ca.SX(0, 1), *chain), row, precise.without_zeros(e, model.box)


def _rows(D: ca.SX, model: Affine) -> Rows:
    outputs = signal_names(model.outputs)
    values, noise = _sample_decoupling(D, model)
    kept: list[int] = []
    dependent: dict[str, tuple[str, ...]] = {}
    for i, name in enumerate(outputs):
        if _has_full_rank(values[:, [*kept, i]], noise[:, [*kept, i]]).any():
            kept.append(i)
        else:
            dependent[name] = tuple(outputs[k] for k in _support(values, kept, i))
    return Rows(tuple(outputs[k] for k in kept), dependent)


def _sample_decoupling(D: ca.SX, model: Affine) -> tuple[Array, Array]:
    """Return D (k, p, m) at scattered points, with rows and columns scaled, and the bounds of its rounding errors."""
    points = np.hstack([nearest_root.scatter(model.states, precise.POINTS, seed) for seed in precise.SEEDS])
    terms = ca.horzcat(ca.densify(D), precise.error_bound(D))
    evaluated = model.box.evaluate(terms, points).transpose(2, 0, 1)
    m = len(model.inputs)
    evaluated = evaluated * np.tile(nearest_root.half_widths(model.inputs), 2)
    size = np.linalg.norm(evaluated[:, :, :m], axis=2, keepdims=True)
    evaluated = evaluated / np.where(size > 0, size, 1.0)
    return evaluated[:, :, :m], precise.LIMIT * evaluated[:, :, m:]


def _has_full_rank(values: Array, noise: Array) -> Array:
    """Tell for each matrix (k, i, m) whether its rows are independent beyond the rounding error of its entries."""
    if values.shape[1] > values.shape[2]:
        return np.zeros(len(values), dtype=bool)
    sigma = np.linalg.svd(values, compute_uv=False)
    return np.asarray(sigma[:, -1] > np.maximum(RANK * sigma[:, 0], np.linalg.norm(noise, axis=(1, 2))))


def _support(values: Array, kept: Sequence[int], i: int) -> list[int]:
    """Return the rows among `kept` whose combination is row i, from points where they are best conditioned."""
    least = np.linalg.svd(values[:, kept], compute_uv=False)[:, -1]
    best = np.argsort(-least, kind="stable")[: len(least) // 4]
    parts = [np.abs(np.linalg.lstsq(values[k][kept].T, values[k, i], rcond=None)[0]) for k in best]
    return [row for row, part in zip(kept, np.max(parts, axis=0), strict=True) if part > np.sqrt(RANK)]


def _quote(outputs: Sequence[str]) -> str:
    return ", ".join(f"'{name}'" for name in outputs)
