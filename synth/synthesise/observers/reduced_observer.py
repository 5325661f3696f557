"""Reduced-order observer (Luenberger 1971; Gopinath 1971): measured combinations of states are not estimated.

        u ----->+---------+
                |  plant  |---> y ---+--------------------------> x1 = y - D u ---+
        u ----->+---------+          |                                            |    [x1; x2^] = M x^
        |                            v                                            v
        +------------------>[ x3' = F x3 + G x1 + H u ]---> x3 ---(+)-----------> x2^ = x3 + L x1

With the blocks of the `Partition` (x+ in discrete time) and the gain L (n - p, p)

    F = A22 - L A12,   G = F L + A21 - L A11,   H = B2 - L B1

the error e = x2 - x2^ of an exact model obeys e' = F e for every u. The observer needs no derivative of y and no future
sample: x2^ uses the y of the same sample, with the direct gain L. An L for which e does not decay is refused; L = -K'
for the state feedback K of the dual pair (A22', A12').

F, G and H are computed from L in ball arithmetic and rounded once; the poles are the exact ones of that F, rounded.

Partition of a model into measured and unmeasured coordinates, for reduced-order observers.

    x1 = y - D u = C x,   x2 = E x,   [x1; x2] = M x

    x1' = A11 x1 + A12 x2 + B1 u
    x2' = A21 x1 + A22 x2 + B2 u          (x+ in discrete time)

y (p,) are the measured signals, C (p, n) their rows, of full rank. E selects the n - p states that are not pivots of a
QR decomposition of the scaled C, which keeps M well conditioned. Where a measured signal is a state, M only reorders.
The blocks are computed in ball arithmetic and rounded once.

Compensators with a reduced-order observer: u = K (x^, z) (the sign is inside K), Y(33)-(35).

     d --->(+)--->[ plant ]---> y --->(+)<--- n
            ^                          |
            |                          v
            +---<---[ K ]<--- x^ ---[ observer: x^ = from_x1 (y - D u) + from_x3 x3 ]
            |         ^                |
            |         +------ z ---[ computed: z' = Az z + Bz q,  q some of y, x^ and u ]
            +--> u, to the observer and to the computed states

u uses the y of the same sample; `discretise.delay_samples` adds a sample of delay to the plant. The states z are
computed, not estimated: integrals of measured signals, or any other model. If they were counted as measured, L would
use them as exact measurements. With e = x2 - x2^, d = n = 0 and the plant with z driven by the true x, (A, B) of
`augmented`,

    [x; z]' = (A + B K) [x; z] + R e,     e' = F e,

so the poles of the loop are those of the regulator and of the observer. `separation` is the deviation of the actual
loop, connected by signal names, from this form: its largest entry relative to that of the loop, in scaled units.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import flint
import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike

from synth import arguments, show
from synth.analyse.loops import interconnect
from synth.analyse.numerics import magnitude, precise
from synth.analyse.structure import staircase, structure
from synth.errors import ModelError, SignalError
from synth.statespace import Array, Complex, StateSpace, System, of, readonly
from synth.synthesise.riccati import exact
from synth.synthesise.riccati.exact import ball
from synth.timing import Continuous, common

# Of the largest coefficient of a dependence between outputs: an output with a smaller one is not named.
MIN_NAMED_COEFFICIENT = 0.1


@dataclass(frozen=True, eq=False)
class Partition:
    """The blocks A11 (p, p), A12, A21, A22 and B1 (p, m), B2; M and its inverse (n, n); D (p, m) of the measured y.

    `condition` is that of M in scaled units.
    """

    model: StateSpace
    measured: tuple[str, ...]
    estimated: tuple[str, ...]
    A11: Array
    A12: Array
    A21: Array
    A22: Array
    B1: Array
    B2: Array
    D: Array
    M: Array
    inverse: Array
    condition: float


def of_model(system: System, measured: Sequence[str] | str) -> Partition:
    """Return a model partitioned by its measured signals: outputs, or states whose name no output has.

    Raises SignalError for an unknown or duplicate name, or for none; ModelError when measured signals are linearly
    dependent, when nothing is left to estimate, as in a model without states, or naming a mode that is not detectable.
    """
    model = of(system)
    if not model.states:
        raise ModelError("the model has no states: nothing is left to estimate")
    names = arguments.as_name_list("measured signals", measured)
    C, D = measurement_rows(model, names)
    indices, condition = _choose_estimated_states(model, names, C)
    M = np.vstack([C, np.eye(len(model.A))[indices]])
    estimated = tuple(model.states[i] for i in indices)
    p = len(names)
    A, B, inverse = (readonly(block) for block in _similarity(model, M))
    A11, A12, A21, A22 = A[:p, :p], A[:p, p:], A[p:, :p], A[p:, p:]
    B1, B2, M = B[:p], B[p:], readonly(M)
    partition = Partition(model, names, estimated, A11, A12, A21, A22, B1, B2, readonly(D), M, inverse, condition)
    _require_detectable(partition)
    return partition


def measurement_rows(model: StateSpace, measured: Sequence[str] | str) -> tuple[Array, Array]:
    """Return C (p, n) and D (p, m) of the measured signals.

    Raises SignalError for an unknown or duplicate name, or for none.
    """
    names = arguments.as_name_list("measured signals", measured)
    if not names or len(set(names)) < len(names):
        raise SignalError(f"the measured signals are {', '.join(names) or 'none'}: name one or more, each once")
    n, m = model.B.shape
    rows_by_name = dict(zip(model.states, np.hstack([np.eye(n), np.zeros((n, m))]), strict=True))
    rows_by_name |= dict(zip(model.outputs, np.hstack([model.C, model.D]), strict=True))
    for name in names:
        if name not in rows_by_name:
            known = ", ".join(dict.fromkeys((*model.outputs, *model.states)))
            raise SignalError(f"the measured signal '{name}' is neither output nor state: take one of {known}")
    both = np.array([rows_by_name[name] for name in names])
    return both[:, :n], both[:, n:]


def _choose_estimated_states(model: StateSpace, names: tuple[str, ...], C: Array) -> tuple[list[int], float]:
    """Return the indices of the states to estimate, in the model's order, and the condition of [C; E], scaled."""
    p, n = C.shape
    part = staircase.scaled(model.A, C=C)
    scaled = part.C / np.maximum(np.linalg.norm(part.C, axis=1, keepdims=True), np.finfo(float).tiny)
    U, sigma, _ = np.linalg.svd(scaled)
    if rank := p - int((sigma > staircase.COUPLING * sigma[0]).sum()):
        share = np.linalg.norm(U[:, p - rank :], axis=1)
        who = [name for name, s in zip(names, share, strict=True) if s > MIN_NAMED_COEFFICIENT * share.max()]
        raise ModelError(_dependence_message(who))
    if p == n:
        raise ModelError(
            f"{', '.join(names)} determine all of {', '.join(model.states)}: nothing is left to estimate; "
            "solve y = C x + D u for x"
        )
    pivots = scipy.linalg.qr(scaled, mode="r", pivoting=True)[1]
    indices = sorted(int(i) for i in pivots[p:])
    return indices, float(np.linalg.cond(np.vstack([scaled, np.eye(n)[indices]])))


def _dependence_message(who: Sequence[str]) -> str:
    if len(who) == 1:
        return f"the measured signal {who[0]} shows no state: its row of C is 0; leave it out"
    return f"the measured signals {', '.join(who)} depend on each other: their rows of C do; leave one of them out"


def _similarity(model: StateSpace, M: Array) -> tuple[Array, Array, Array]:
    """Return M A M^-1, M B and M^-1, each entry rounded once."""

    def inverse() -> flint.arb_mat:
        return ball(M).inv()

    A = precise.round_correctly(lambda: ball(M) * ball(model.A) * inverse(), "the partitioned A")
    B = precise.round_correctly(lambda: ball(M) * ball(model.B), "the partitioned B")
    return A, B, precise.round_correctly(inverse, "the inverse of [C; E]")


def _require_detectable(part: Partition) -> None:
    for mode in structure.uncontrollable_modes(part.A22.T, part.A12.T, part.estimated, part.model.time):
        raise ModelError(
            f"(A12, A22) is not detectable: mode {show.number(mode.value, 4)} in {', '.join(mode.states)} has "
            f"|A12 v| = {mode.measure:.0e} for the measured {', '.join(part.measured)}: measure "
            f"{', '.join(mode.states)} or take it out of the model"
        )


@show.result
class ReducedObserver:
    """L (n - p, p) and the recursion of x3 for a partitioned model; `poles` of F in 1/s or in z.

    x^ = from_x1 x1 + from_x3 x3 with from_x1 (n, p), from_x3 (n, n - p).
    """

    partition: Partition
    L: Array
    F: Array
    G: Array
    H: Array
    from_x1: Array
    from_x3: Array
    poles: Complex

    @property
    def model(self) -> StateSpace:
        """The model that is observed."""
        return self.partition.model

    @property
    def measured_signals(self) -> tuple[str, ...]:
        """The names of y."""
        return self.partition.measured

    @property
    def estimated_states(self) -> tuple[str, ...]:
        """The names of x2."""
        return self.partition.estimated

    def state_space(self) -> StateSpace:
        """Return the observer from y and u to ``<state>_estimate`` of all states; its states are ``<state>_x3``."""
        part, model, C = self.partition, self.model, self.from_x1
        B, D = np.hstack([self.G, self.H - self.G @ part.D]), np.hstack([C, -C @ part.D])
        states, outputs = tuple(f"{x}_x3" for x in self.estimated_states), tuple(f"{x}_estimate" for x in model.states)
        kinds = [(f"{x}_{kind}", model.unit(x)) for x in model.states for kind in ("x3", "estimate")]
        units = {**model.units, **{name: unit for name, unit in kinds if unit}}
        return StateSpace(
            self.F, B, self.from_x3, D, states, (*self.measured_signals, *model.inputs), outputs, model.time, units
        )

    def sheet(self) -> show.Sheet:
        """Return the poles, L and the recursion."""
        part, model = self.partition, self.model
        lines = (
            f"Poles of the error: {', '.join(show.number(p) for p in self.poles)}",
            f"Condition of the coordinates {part.condition:.3g} (scaled)",
        )
        L = show.matrix("L", self.L, model.labels(self.estimated_states), self.measured_signals)
        rows, columns = (f"next {x}_x3" for x in self.estimated_states), (f"{x}_x3" for x in self.estimated_states)
        if isinstance(model.time, Continuous):
            rows = (f"d/dt {x}_x3" for x in self.estimated_states)
        recursion = np.hstack([self.F, self.G, self.H])
        x3 = show.matrix("", recursion, tuple(rows), (*columns, *self.measured_signals, *model.inputs))
        estimated, measured = ", ".join(self.estimated_states), ", ".join(self.measured_signals)
        title = f"Reduced-order observer of {estimated} from {measured}, {model.time}"
        return show.Sheet(title, lines, (L, x3))


@arguments.checked
def from_gain(system: System, measured: Sequence[str] | str, L: ArrayLike) -> ReducedObserver:
    """Return the observer with a given gain L (n - p, p), rows in the order of the estimated states.

    Raises SignalError when L has the wrong shape or is not finite; ModelError naming the poles of an error that does
    not decay; else as `of_model`.
    """
    part = of_model(system, measured)
    gain, shape = arguments.matrix("L", L), (len(part.estimated), len(part.measured))
    if gain.shape != shape:
        raise SignalError(
            f"the gain L is {gain.shape}: {', '.join(part.estimated)} from {', '.join(part.measured)} need {shape}"
        )
    if not np.isfinite(gain).all():
        i, j = np.argwhere(~np.isfinite(gain))[0]
        raise SignalError(
            f"the gain L has {gain[i, j]} for {part.estimated[i]} from {part.measured[j]}: give finite numbers"
        )
    return _observer(part, gain)


def _observer(part: Partition, gain: Array) -> ReducedObserver:
    blocks = (part.A11, part.A12, part.A21, part.A22, part.B1, part.B2, gain)
    with precise.precision():
        A11, A12, A21, A22, B1, B2, L = (ball(block) for block in blocks)
        F_balls = A22 - L * A12
        F, G, H = (readonly(precise.rounded(m)) for m in (F_balls, F_balls * L + A21 - L * A11, B2 - L * B1))
        poles, inverse = exact.eigenvalues(ball(F)), ball(part.inverse)
        lasting = exact.exact_unstable_pole(ball(F), part.model.time)
        columns = inverse * ball(np.vstack([np.eye(len(part.measured)), gain]))
        from_x1, from_x3 = readonly(precise.rounded(columns)), readonly(part.inverse[:, len(part.measured) :])
    if lasting is not None:
        bound = "Re s < 0" if isinstance(part.model.time, Continuous) else "|z| < 1"
        slow = poles[~exact.decays(poles, part.model.time)]
        listed = ", ".join(show.number(p, 9) for p in (slow if slow.size else [lasting]))
        raise ModelError(
            f"the observer of {', '.join(part.estimated)} with this gain has the poles {listed}: its error does not "
            f"decay, which needs {bound}; take L = -K' for a K that places the poles of A22' + A12' K there"
        )
    return ReducedObserver(part, readonly(gain), F, G, H, from_x1, from_x3, poles)


@show.result
class Compensator:
    """K (m, n + k) on the states and on the computed states, with the compensator as a `model` from y to u.

    `loop` goes from ``<input>_disturbance`` and ``<measured>_noise`` to y and u. `regulator` holds the poles of
    A + B K, `poles` those of the loop, in 1/s or in z.
    """

    observer: ReducedObserver
    computed: StateSpace
    K: Array
    model: StateSpace
    loop: StateSpace
    regulator: Complex
    poles: Complex
    separation: float

    def sheet(self) -> show.Sheet:
        """Return the poles, how far they separate, K and the compensator's matrices."""
        plant = self.observer.model
        lines = (
            f"Poles of the regulator: {', '.join(show.number(p) for p in self.regulator)}",
            f"Poles of the observer: {', '.join(show.number(p) for p in self.observer.poles)}",
            f"The loop separates into them to {self.separation:.1e} of its largest entry",
        )
        states = (*plant.states, *self.computed.states)
        gain = show.feedback(show.matrix("K", self.K, plant.labels(plant.inputs), states))
        tables = (gain, *self.model.sheet().tables)
        title = f"Compensator from {', '.join(self.model.inputs)} to {', '.join(self.model.outputs)}"
        return show.Sheet(f"{title}, {plant.time}", lines, tables)


@arguments.checked
def augmented(observer: ReducedObserver, computed: System) -> StateSpace:
    """Return the plant with the computed states appended, driven by the true x: the model to design K on.

    Raises TimingError for different times; SignalError when an input of `computed` is neither measured nor an input of
    the plant nor ``<state>_estimate``, or for a duplicate state name.
    """
    model, part, computed_model = observer.model, observer.partition, of(computed)
    time = common(model.time, computed_model.time)
    y, x, u = _input_selection(part, computed_model)
    C, D = measurement_rows(model, part.measured)
    n, k = len(model.states), len(computed_model.states)
    A = np.block([[model.A, np.zeros((n, k))], [computed_model.B @ (y @ C + x), computed_model.A]])
    B = np.vstack([model.B, computed_model.B @ (y @ D + u)])
    states = (*model.states, *computed_model.states)
    units = {**computed_model.units, **model.units}
    return StateSpace(A, B, np.eye(n + k), np.zeros((n + k, B.shape[1])), states, model.inputs, states, time, units)


@arguments.checked
def compensator(observer: ReducedObserver, K: ArrayLike, computed: System | None = None) -> Compensator:
    """Return u = K (x^, z) with K (m, n + k) on the plant's states, then on those of `computed`.

    Raises SignalError when K has the wrong shape or is not finite; ModelError naming the poles when A + B K is not
    stable, or when the algebraic loop of u through D has no solution; else as `augmented`.
    """
    computed_model = interconnect.integrals(observer.model, {}) if computed is None else of(computed)
    plant = augmented(observer, computed_model)
    gain, shape = arguments.matrix("K", K), plant.B.T.shape
    if gain.shape != shape or not np.isfinite(gain).all():
        raise SignalError(
            f"the gain K is {gain.shape}: {', '.join(plant.inputs)} from {', '.join(plant.states)} need a finite one "
            f"of {shape}"
        )
    with precise.precision():
        regulated = ball(plant.A) + ball(plant.B) * ball(gain)
        regulator = exact.eigenvalues(regulated)
    decaying = exact.decays(regulator, plant.time)
    if not decaying.all():
        raise ModelError(
            f"u = K x leaves the poles {', '.join(show.number(p, 9) for p in regulator[~decaying])}, which do not "
            "decay: design K on reduced_compensator.augmented in the same time, with the sign inside K"
        )
    model = _model(observer, computed_model, gain)
    loop = _loop(observer.partition, model)
    with precise.precision():
        poles = exact.eigenvalues(ball(loop.A))
    separation = _separation(observer, loop.A, precise.rounded(regulated))
    return Compensator(observer, computed_model, readonly(gain), model, loop, regulator, poles, separation)


def _input_selection(part: Partition, computed: StateSpace) -> tuple[Array, Array, Array]:
    """Return the matrices (k, p), (k, n), (k, m) that select the inputs of `computed` from y, x^ and u."""
    estimates = tuple(f"{x}_estimate" for x in part.model.states)
    sources = (*part.measured, *estimates, *part.model.inputs)
    for name in computed.inputs:
        if name not in sources:
            raise SignalError(
                f"'{name}', an input of the computed states, is not known to the compensator: take one of "
                f"{', '.join(sources)}"
            )
    picks = np.eye(len(sources))[[sources.index(name) for name in computed.inputs]]
    p, n = len(part.measured), len(estimates)
    return picks[:, :p], picks[:, p : p + n], picks[:, p + n :]


def _model(observer: ReducedObserver, computed_model: StateSpace, K: Array) -> StateSpace:
    """Return the compensator; each signal is a matrix on (x3, z, y) in ball arithmetic, rounded once."""
    part, model = observer.partition, observer.model
    q, k, n, p = len(part.estimated), len(computed_model.states), len(model.states), len(part.measured)
    columns = np.eye(q + k + p)
    with precise.precision():
        x3, z, y = ball(columns[:q]), ball(columns[q : q + k]), ball(columns[q + k :])
        Kx, Kz, D, from_x1, from_x3 = (
            ball(m) for m in (K[:, :n], K[:, n:], part.D, observer.from_x1, observer.from_x3)
        )
        u = _solve_algebraic_loop(ball(np.eye(len(K))) + Kx * from_x1 * D, Kx * (from_x1 * y + from_x3 * x3) + Kz * z)
        x1 = y - D * u
        estimate = from_x1 * x1 + from_x3 * x3
        from_y, from_x, from_u = (ball(m) for m in _input_selection(part, computed_model))
        computed_input = from_y * y + from_x * estimate + from_u * u
        next = (
            ball(observer.F) * x3 + ball(observer.G) * x1 + ball(observer.H) * u,
            ball(computed_model.A) * z + ball(computed_model.B) * computed_input,
        )
        next_states, out = np.vstack([precise.rounded(m) for m in next]), precise.rounded(u)
    states = (*(f"{x}_x3" for x in part.estimated), *computed_model.states)
    units = {
        **computed_model.units,
        **model.units,
        **{f"{x}_x3": model.unit(x) for x in part.estimated if model.unit(x)},
    }
    width = q + k
    return StateSpace(
        next_states[:, :width], next_states[:, width:], out[:, :width], out[:, width:],
        states, part.measured, model.inputs, model.time, units,
    )  # fmt: skip


def _solve_algebraic_loop(loop: flint.arb_mat, right: flint.arb_mat) -> flint.arb_mat:
    if magnitude.is_singular(precise.rounded(loop)):
        raise ModelError(
            "the algebraic loop of u through D and K has no solution: I + K from_x1 D is singular; put a sample "
            "of delay into the plant (discretise.delay_samples)"
        )
    return loop.solve(right)


def _loop(part: Partition, model: StateSpace) -> StateSpace:
    plant = part.model
    C, D = measurement_rows(plant, part.measured)
    units = {**plant.units, **model.units}
    measured = StateSpace(plant.A, plant.B, C, D, plant.states, plant.inputs, part.measured, plant.time, units)
    disturbed_inputs = {u: {u: 1.0, f"{u}_disturbance": 1.0} for u in plant.inputs}
    noisy_outputs = {y: {y: 1.0, f"{y}_noise": 1.0} for y in part.measured}
    external = (*(f"{u}_disturbance" for u in plant.inputs), *(f"{y}_noise" for y in part.measured))
    return interconnect.connect(
        [measured, model], external, (*part.measured, *plant.inputs), {**disturbed_inputs, **noisy_outputs}
    )


def _separation(observer: ReducedObserver, A: Array, regulated: Array) -> float:
    """Compare the loop in (x, z, e), e = x2 - x2^, with [[A + B K, .], [0, F]]."""
    part = observer.partition
    p, q, n, k = len(part.measured), len(part.estimated), len(part.model.states), len(regulated) - len(part.M)
    error = part.M[p:] - observer.L @ part.M[:p]  # e = error x - x3
    transform = np.block(
        [
            [np.eye(n), np.zeros((n, q + k))],
            [np.zeros((k, n + q)), np.eye(k)],
            [error, -np.eye(q), np.zeros((q, k))],
        ]
    )
    actual = transform @ A @ np.linalg.inv(transform)
    expected = actual.copy()
    expected[: n + k, : n + k], expected[n + k :, : n + k], expected[n + k :, n + k :] = regulated, 0.0, observer.F
    x = staircase.scaled(expected).x
    deviation, whole = ((m * x / x[:, None]) for m in (actual - expected, expected))
    return float(np.abs(deviation).max() / np.abs(whole).max())
