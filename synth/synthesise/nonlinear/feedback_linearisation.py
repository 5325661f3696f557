"""Input-output feedback linearisation: u for which the r-th derivatives of the outputs equal the demands w.

For a plant with relative degrees r_i, decoupling matrix D(x) and drift a(x) (see `relative_degree`),

    d^r_i y_i / dt^r_i = a_i + D_i u,      u = D^-1 (w - a)    gives    d^r_i y_i / dt^r_i = w_i,

p chains of integrators, and n - sum r states that are not observable from the outputs (see `zero_dynamics`):

    w ---->[ u = D^-1 (w - a) ]---- u ---->[ plant ]----> y
                    ^                          |
                    +------------- x ----------+

With more inputs than outputs and a weight W, u0 the inputs at the operating point (0 without one),

    u = u0 + N (D N)^-1 (w - a - D u0),    N = W^-1 D^T,

has the least (u - u0)' W (u - u0). Inverses are written out by cofactors. Sources: F(11)-(13); Isidori, 5.2-5.3.

Symbolic inverse of a matrix by cofactors, without pivoting and without structurally zero terms.

    M^-1 b = adj(M) b / det M,    adj(M)_ij = (-1)^(i + j) det(M without row j and column i)

Each minor is computed once, and the number of products grows as n^2 2^n, not as n!.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import reduce

import casadi as ca
import numpy as np

from synth import arguments, law, show
from synth.analyse.numerics import nearest_root, precise
from synth.analyse.numerics.nearest_root import Box
from synth.analyse.operating_points import OperatingPoint
from synth.analyse.structure import relative_degree, zero_dynamics
from synth.analyse.structure.relative_degree import RelativeDegree
from synth.analyse.structure.zero_dynamics import ZeroDynamics
from synth.check import Check
from synth.errors import ModelError, SignalError
from synth.plant import Plant
from synth.signals import per_second, signal_names
from synth.statespace import Array, StateSpace
from synth.synthesise.riccati import weights
from synth.timing import Continuous

Places = tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Solution:
    """M^-1 b (n, k) and det M."""

    value: ca.SX
    determinant: ca.SX


def solve(M: ca.SX, b: ca.SX) -> Solution:
    """Return the solution of M y = b for a square M (n, n) and b (n, k); it is not finite where M is singular."""
    n = M.size1()
    minors = _Minors(M)
    everything = tuple(range(n))
    cofactors = ca.SX(n, n)
    for i in everything:
        for j in everything:
            minor = minors.of(_without(everything, j), _without(everything, i))
            if not minor.is_zero():
                cofactors[i, j] = (-1) ** (i + j) * minor
    determinant = minors.of(everything, everything)
    return Solution(ca.mtimes(cofactors, b) / determinant, determinant)


@dataclass(frozen=True, eq=False)
class _Minors:
    M: ca.SX
    minors: dict[tuple[Places, Places], ca.SX] = field(default_factory=dict)

    def of(self, rows: Places, columns: Places) -> ca.SX:
        """Return the determinant of the matrix of these rows and columns, by its first row."""
        if not rows:
            return ca.SX(1)
        if (rows, columns) not in self.minors:
            total = ca.SX(0)
            for place, column in enumerate(columns):
                entry = self.M[rows[0], column]
                if not entry.is_zero():
                    total += (-1) ** place * entry * self.of(rows[1:], _without(columns, column))
            self.minors[rows, columns] = total
        return self.minors[rows, columns]


def _without(places: Places, place: int) -> Places:
    return tuple(p for p in places if p != place)


SEED = 7  # differs from the seeds of the relative degree
CANCELLATION = 2.0**26  # of the demands' size: the largest terms that may cancel, half of the digits

AUTHORITY = 1e-12  # of the drift: a smaller effect of the inputs is the rounding error of a constant


@dataclass(frozen=True, eq=False)
class Law:
    """The decoupling law: `drift` a (n,), `decoupling` D (n, n), its determinant, and `inputs` u by name."""

    drift: ca.SX
    decoupling: ca.SX
    determinant: ca.SX
    inputs: dict[str, ca.SX]


@show.result
class Linearisation:
    """The law `u` (m,) of the states `x` (n,) and the demands `w` (p,), in symbols, with plant and relative degree.

    w_i is the r_i-th derivative of output i, in the output's unit per s^r_i. `determinant` is that of D, or of D N.
    `zeros` is None without an operating point.
    """

    plant: Plant
    degree: RelativeDegree
    x: ca.SX
    w: ca.SX
    u: ca.SX
    determinant: ca.SX
    zeros: ZeroDynamics | None

    @property
    def inputs(self) -> dict[str, ca.SX]:
        """The law by input."""
        return dict(zip(signal_names(self.degree.model.inputs), ca.vertsplit(self.u), strict=True))

    @property
    def law(self) -> ca.Function:
        """The law as a function (x, w) -> u."""
        return ca.Function("law", [self.x, self.w], [ca.densify(self.u)], ["x", "w"], ["u"])

    def chain(self, output: str) -> "Chain":
        """Return the chain of integrators from a demand ``w_<output>`` to an output of the linearised plant.

        Its states are the output and its derivatives. A derivative that is a state of the plant has that name, else
        ``<output>_d<k>``.

        Raises SignalError for an output that is not linearised, or that depends directly on the inputs.
        """
        if output not in self.degree.outputs:
            raise SignalError(f"'{output}' is not linearised: choose one of {', '.join(self.degree.outputs)}")
        i = self.degree.outputs.index(output)
        if not (r := self.degree.degrees[i]):
            raise SignalError(f"'{output}' depends directly on the inputs, without an integrator: give it no axis")
        states, demand, unit = _chain_states(self, i), f"w_{output}", self.degree.model.outputs[i].unit
        units = {output: unit}
        for name in (*states, demand):
            units[name], unit = unit, per_second(unit)
        matrices = np.eye(r, k=1), np.eye(r)[:, -1:], np.eye(r)[:1], np.zeros((1, 1))
        return Chain(StateSpace(*matrices, states, (demand,), (output,), Continuous(), units), self)

    def check(self, points: int = 64) -> Check:
        """Substitute the law at scattered points and compare d^r y/dt^r with the demands.

        The derivatives are taken along the plant's f and h with constant inputs, independently of the drift, D and the
        affine form. The demands at a point are the outputs' derivatives at another one. The figure is the largest
        difference relative to the rounding error of its terms, which is bounded by 1e-6 of the demands.

        Raises ModelError where the model is not finite.
        """
        states, inputs = self.degree.model.states, self.degree.model.inputs
        u = ca.SX.sym("u", len(inputs))
        reached = _derivatives(self, u)
        domain = Box(ca.vertcat(self.x, u), (*states, *inputs))
        at = nearest_root.scatter(domain.signals, points, SEED)
        demands = np.roll(domain.evaluate(reached, at)[:, 0, :], 1, axis=1)
        inputs_sent, error_u = _evaluate_law(self, at[: len(states)], demands)
        parts = ca.horzcat(reached, precise.error_bound(reached), ca.jacobian(reached, u))
        values = domain.evaluate(parts, np.vstack([at[: len(states)], inputs_sent]))
        size = values[:, 1] + np.einsum("pmk,mk->pk", np.abs(values[:, 2:]), error_u) + np.abs(demands)
        most = CANCELLATION * np.abs(demands).max(axis=1, keepdims=True)
        figure = float((np.abs(values[:, 0] - demands) / (precise.LIMIT * np.minimum(size, most))).max())
        about = f"d^r y/dt^r against the demands at {points} scattered points, law substituted"
        return Check(f"normal form of '{self.plant.name}'", figure, 1.0, "1", about)

    def sheet(self) -> show.Sheet:
        """Return the degrees, the conditioning, the zero dynamics and the check of the normal form."""
        degree, check = self.degree.sheet(), self.check()
        zeros = self.zeros.sheet() if self.zeros else None
        lines = [
            f"inputs {', '.join(self.inputs)}; demands {', '.join(self._demands())}",
            *degree.lines,
            f"normal form: {'holds' if check.passed else 'DOES NOT HOLD'}, {check.value:.2g} of the rounding error",
        ]
        if zeros:
            lines += [zeros.title, *zeros.lines]
        tables = (*degree.tables, *(zeros.tables if zeros else ()))
        return show.Sheet(f"Feedback linearisation of '{self.plant.name}'", tuple(lines), tables)

    def _demands(self) -> list[str]:
        labels = []
        for signal, r in zip(self.degree.model.outputs, self.degree.degrees, strict=True):
            unit = reduce(lambda unit, _: per_second(unit), range(r), signal.unit)
            times = {0: signal.name, 1: f"d {signal.name}/dt"}.get(r, f"d^{r} {signal.name}/dt^{r}")
            labels.append(show.with_unit(times, unit))
        return labels


@dataclass(frozen=True, eq=False)
class Chain:
    """The integrators of one output as a continuous model from its demand, and the linearising law."""

    model: StateSpace
    law: Linearisation


def _chain_states(linearisation: Linearisation, i: int) -> tuple[str, ...]:
    known, states = ca.vertsplit(linearisation.x), signal_names(linearisation.degree.model.states)
    labels = []
    for k, e in enumerate(ca.vertsplit(linearisation.degree.chains[i])):
        same = [name for x, name in zip(known, states, strict=True) if ca.is_equal(e, x, 2)]
        labels.append(same[0] if same else f"{linearisation.degree.outputs[i]}_d{k}")
    return tuple(labels)


@arguments.checked
def of_plant(
    plant: Plant,
    outputs: Sequence[str] | None = None,
    held: Mapping[str, float] | None = None,
    *,
    point: OperatingPoint | None = None,
    weight: weights.Weight | None = None,
) -> Linearisation:
    """Return the law that linearises the plant from demands on the named `outputs`, all when left out.

    `held` gives constant inputs, `point` the equilibrium for the zero dynamics, `weight` W the weight of the inputs if
    there are more of them than outputs.

    Raises SignalError for names and weights; ModelError when the plant is not affine in its inputs, has no defined
    relative degree somewhere in its domain, has inputs whose effect on an output over their ranges is less than 1e-12
    of the drift, or has more inputs than outputs and no weight; else as `zero_dynamics.at_point`.
    """
    degree = relative_degree.of_plant(plant, outputs, held)
    degree.require_constant_rank()
    _require_authority(degree)
    W = _weight(degree, weight)
    solved, w = _decoupling_law(degree, W, point)
    zeros = zero_dynamics.at_point(plant, degree, point, W) if point is not None else None
    return Linearisation(plant, degree, degree.model.x, w, solved.value, solved.determinant, zeros)


def _require_authority(degree: RelativeDegree) -> None:
    for (name, authority), r in zip(degree.authority.items(), degree.degrees, strict=True):
        if authority < AUTHORITY:
            raise ModelError(
                f"over their ranges the inputs change derivative {r} of '{name}' by {authority:.2g} of the drift's "
                f"share (at least {AUTHORITY:g} is needed): such a coefficient is the rounding error of constants "
                "folded before they reached the model; write it as the zero that it is, or widen the inputs' ranges"
            )


def _weight(degree: RelativeDegree, weight: weights.Weight | None) -> Array | None:
    inputs = signal_names(degree.model.inputs)
    p, m = degree.decoupling.shape
    if weight is not None:
        return weights.definite("input weight", weight, inputs)
    if m > p:
        raise ModelError(
            f"{m} inputs ({', '.join(inputs)}) serve {p} outputs ({', '.join(degree.outputs)}): hold {m - p} of them, "
            "or give a weight by which the inputs share the work"
        )
    return None


def _decoupling_law(
    degree: RelativeDegree, weight: Array | None, point: OperatingPoint | None
) -> tuple[Solution, ca.SX]:
    D, a = degree.decoupling, degree.drift
    w = ca.vertcat(*(ca.SX.sym(f"w_{name}") for name in degree.outputs))
    if weight is None or D.size1() == D.size2():
        return solve(D, w - a), w
    u0 = ca.SX([0.0 if point is None else point[s.name] for s in degree.model.inputs])
    N = ca.mtimes(ca.SX(np.linalg.inv(weight)), D.T)
    solved = solve(ca.mtimes(D, N), w - a - ca.mtimes(D, u0))
    return Solution(u0 + ca.mtimes(N, solved.value), solved.determinant), w


def _derivatives(law: Linearisation, u: ca.SX) -> ca.SX:
    """Return d^r_i y_i / dt^r_i (p,) along the plant's f for constant inputs."""
    plant, model = law.plant, law.degree.model
    sent = dict(zip(signal_names(model.inputs), ca.vertsplit(u), strict=True))
    everything = ca.vertcat(*(sent[s.name] if s.name in sent else ca.SX(model.held[s.name]) for s in plant.inputs))
    f, h = (function(law.x, everything, plant.values) for function in (plant.f, plant.h))
    derivatives = []
    for name, r in zip(law.degree.outputs, law.degree.degrees, strict=True):
        e = h[signal_names(plant.outputs).index(name)]
        for _ in range(r):
            e = ca.cse(ca.jtimes(e, law.x, f))
        derivatives.append(e)
    return ca.densify(ca.vertcat(*derivatives))


def _evaluate_law(law: Linearisation, x: Array, w: Array) -> tuple[Array, Array]:
    """Return the inputs (m, k) of the law and the bound of their rounding errors."""
    function = ca.Function("u", [law.x, law.w], [ca.densify(law.u), precise.error_bound(law.u)])
    sent, error = (np.asarray(v) for v in function(x, w))
    nearest_root.require_finite("the law", sent, law.degree.model.states, x)
    return sent, error


@arguments.checked
def linearise(acceleration: Sequence[ca.SX], inputs: Mapping[str, ca.SX], w: Sequence[ca.SX]) -> Law:
    """Solve `acceleration` (n expressions) = `w` (n) for the n `inputs` (name to symbol).

    Raises ModelError when the numbers of inputs and accelerations differ or are 0, when the model is not affine in an
    input, or when the decoupling matrix is singular at each of some random points, with symbols of 0.1 to 1. Singular
    points inside the domain are not checked here.
    """
    if not inputs:
        raise ModelError("there are no inputs: name at least one, with an acceleration for each")
    u, q = law.column("the inputs", inputs, inputs), ca.vcat(list(acceleration))
    if u.numel() != q.numel() or q.numel() != len(w):
        raise ModelError(
            f"{q.numel()} accelerations and {len(w)} demands meet {u.numel()} inputs ({', '.join(inputs)}): "
            "static feedback linearisation needs as many of each; combine or drop inputs"
        )
    D = ca.simplify(ca.jacobian(q, u))
    for name, symbol in inputs.items():
        if ca.depends_on(D, symbol) and not _vanishes(ca.jacobian(ca.vec(D), symbol)):
            raise ModelError(f"the model is not affine in '{name}': drop or invert the terms of higher order first")
    drift, D = (ca.substitute(e, u, ca.SX.zeros(u.numel())) for e in (q, D))
    solved = solve(D, ca.vcat(list(w)) - drift)
    if _vanishes(solved.determinant):
        raise ModelError(
            f"the decoupling matrix of ({', '.join(inputs)}) is singular everywhere, as sampled with symbols of 0.1 to "
            "1: choose other inputs"
        )
    return Law(drift, D, solved.determinant, dict(zip(inputs, ca.vertsplit(solved.value), strict=True)))


def _vanishes(expression: ca.SX) -> bool:
    """Tell whether an expression is rounding error wherever it is sampled."""
    symbols, entries = ca.symvar(expression), ca.densify(ca.vec(expression))
    at = ca.Function("at", [ca.vcat(symbols)], [entries, precise.error_bound(entries)])
    points = np.random.default_rng(1).uniform(0.1, 1.0, (8, len(symbols)))
    pairs = ((np.asarray(value), np.asarray(error)) for value, error in map(at, points))
    return all((np.abs(value) <= precise.LIMIT * error).all() for value, error in pairs)
