"""Reduced-order observer (Luenberger 1971; Gopinath 1971): measured combinations of states are not estimated.

        u ----->+---------+
                |  plant  |---> y ---+--------------------------> x1 = y - D u ---+
        u ----->+---------+          |                                            |    [x1; x2^] = M x^
        |                            v                                            v
        +------------------>[ x3' = F x3 + G x1 + H u ]---> x3 ---(+)-----------> x2^ = x3 + L x1

With the blocks of `reduced_partition` (x+ in discrete time) and the gain L (n - p, p)

    F = A22 - L A12,   G = F L + A21 - L A11,   H = B2 - L B1

the error e = x2 - x2^ of an exact model obeys e' = F e for every u. The observer needs no derivative of y and no future
sample: x2^ uses the y of the same sample, with the direct gain L. L comes

    by_poles     from the desired poles of F: state feedback of the dual pair (A22', A12')
    by_riccati   from the least error covariance for white noise: `reduced_noise`
    deadbeat     from F^k = 0 for the least k, the observability index of (A12, A22): e = 0 after k samples
    from_gain    from the caller; it is refused when e does not decay

F, G and H are computed from L in ball arithmetic and rounded once; the poles are the exact ones of that F, rounded.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from synth import arguments, show
from synth.analyse import precise
from synth.errors import ModelError, SignalError, TimingError
from synth.statespace import Array, Complex, StateSpace, System, readonly
from synth.synthesise.feedback import deadbeat as nilpotent
from synth.synthesise.feedback import pole_placement
from synth.synthesise.observers import reduced_noise, reduced_partition
from synth.synthesise.observers.reduced_partition import Partition
from synth.synthesise.riccati import exact_eigenvalues
from synth.synthesise.riccati.exact_eigenvalues import ball
from synth.timing import Continuous

Certificate = pole_placement.Placement | nilpotent.Deadbeat | reduced_noise.Filter | None


@show.result
class ReducedObserver:
    """L (n - p, p) and the recursion of x3 for a partitioned model; `poles` of F in 1/s or in z.

    x^ = from_x1 x1 + from_x3 x3 with from_x1 (n, p), from_x3 (n, n - p). `certificate` is that of the design method of
    L, None for `from_gain`.
    """

    partition: Partition
    L: Array
    F: Array
    G: Array
    H: Array
    from_x1: Array
    from_x3: Array
    poles: Complex
    certificate: Certificate

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
        """Return the poles, the certificate, L and the recursion."""
        part, model = self.partition, self.model
        lines = (
            f"Poles of the error: {', '.join(show.number(p) for p in self.poles)}",
            f"Condition of the coordinates {part.condition:.3g} (scaled)",
            *(self.certificate.lines() if self.certificate else ()),
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
    not decay; else as `reduced_partition.of_model`.
    """
    part = reduced_partition.of_model(system, measured)
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
    return _observer(part, gain, None)


@arguments.checked
def by_poles(system: System, measured: Sequence[str] | str, poles: Sequence[complex] | ArrayLike) -> ReducedObserver:
    """Return the observer whose error has the desired poles (n - p,), without those of unobservable modes.

    Raises as `pole_placement.place` and `reduced_partition.of_model`.
    """
    part = reduced_partition.of_model(system, measured)
    placement = pole_placement.place(_dual(part), poles)
    return _observer(part, 0.0 - placement.K.T, placement)


@arguments.checked
def by_riccati(system: System, measured: Sequence[str] | str, W: reduced_noise.Weight) -> ReducedObserver:
    """Return the observer of least error covariance for process noise W (n, n) and noise-free measurements.

    W acts on the states: a matrix, a diagonal or {name: entry}; a covariance at each sample, or a density in continuous
    time. For noisy measurements the Kalman filter of full order is optimal (`kalman`).

    Raises as `reduced_noise` and `reduced_partition.of_model`.
    """
    part = reduced_partition.of_model(system, measured)
    design = reduced_noise.steady_filter(part, reduced_noise.partition_noise(part, W))
    return _observer(part, design.L, design)


@arguments.checked
def deadbeat(system: System, measured: Sequence[str] | str) -> ReducedObserver:
    """Return the observer whose error is 0 after the fewest samples.

    Raises TimingError for a continuous model; ModelError when a mode other than 0 is not observable; else as
    `reduced_partition.of_model`.
    """
    part = reduced_partition.of_model(system, measured)
    if isinstance(part.model.time, Continuous):
        raise TimingError(
            "no observer is deadbeat in continuous time: sample the model, or use by_poles with fast ones"
        )
    dual = _dual(part)
    try:
        design = nilpotent.feedback(dual)
    except ModelError as error:
        value, who = nilpotent.largest_uncontrollable_mode(dual)
        raise ModelError(
            f"mode {show.number(value, 4)} in {who} is not 0 and not observable from {', '.join(part.measured)}: no "
            f"gain is deadbeat; measure {who} or use by_poles or by_riccati"
        ) from error
    return _observer(part, 0.0 - design.K.T, design)


def _dual(part: Partition) -> StateSpace:
    """Return the dual pair, whose state feedback u = K x gives L = -K'."""
    n, p = len(part.estimated), len(part.measured)
    nothing = np.zeros((n, p))
    return StateSpace(
        part.A22.T, part.A12.T, np.eye(n), nothing, part.estimated, part.measured, part.estimated, part.model.time
    )


def _observer(part: Partition, gain: Array, certificate: Certificate) -> ReducedObserver:
    blocks = (part.A11, part.A12, part.A21, part.A22, part.B1, part.B2, gain)
    with precise.precision():
        A11, A12, A21, A22, B1, B2, L = (ball(block) for block in blocks)
        exact = A22 - L * A12
        F, G, H = (readonly(precise.rounded(m)) for m in (exact, exact * L + A21 - L * A11, B2 - L * B1))
        poles, inverse = exact_eigenvalues.eigenvalues(ball(F)), ball(part.inverse)
        lasting = exact_eigenvalues.exact_unstable_pole(ball(F), part.model.time)
        columns = inverse * ball(np.vstack([np.eye(len(part.measured)), gain]))
        from_x1, from_x3 = readonly(precise.rounded(columns)), readonly(part.inverse[:, len(part.measured) :])
    if lasting is not None:
        bound = "Re s < 0" if isinstance(part.model.time, Continuous) else "|z| < 1"
        slow = poles[~exact_eigenvalues.decays(poles, part.model.time)]
        listed = ", ".join(show.number(p, 9) for p in (slow if slow.size else [lasting]))
        raise ModelError(
            f"the observer of {', '.join(part.estimated)} with this gain has the poles {listed}: its error does not "
            f"decay, which needs {bound}; place its poles with by_poles or deadbeat in the model's own time"
        )
    return ReducedObserver(part, readonly(gain), F, G, H, from_x1, from_x3, poles, certificate)
