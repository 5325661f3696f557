"""Compensators with a reduced-order observer: u = K (x^, z) (the sign is inside K), Y(33)-(35).

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

import flint
import numpy as np
from numpy.typing import ArrayLike

from synth import arguments, show
from synth.analyse.loops import interconnect
from synth.analyse.numerics import equilibrate, precise
from synth.analyse.structure import staircase
from synth.errors import ModelError, SignalError
from synth.statespace import Array, Complex, StateSpace, System, of, readonly
from synth.synthesise.observers.reduced_observer import ReducedObserver
from synth.synthesise.observers.reduced_partition import Partition, measurement_rows
from synth.synthesise.riccati import exact_eigenvalues
from synth.synthesise.riccati.exact_eigenvalues import ball
from synth.timing import common


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
        regulator = exact_eigenvalues.eigenvalues(regulated)
    decaying = exact_eigenvalues.decays(regulator, plant.time)
    if not decaying.all():
        raise ModelError(
            f"u = K x leaves the poles {', '.join(show.number(p, 9) for p in regulator[~decaying])}, which do not "
            "decay: design K on reduced_compensator.augmented in the same time, with the sign inside K"
        )
    model = _model(observer, computed_model, gain)
    loop = _loop(observer.partition, model)
    with precise.precision():
        poles = exact_eigenvalues.eigenvalues(ball(loop.A))
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
    if equilibrate.is_singular(precise.rounded(loop)):
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
