"""Reduced-order observer (Luenberger 1971; Gopinath 1971): measured combinations of states are not estimated.

        u ----->+---------+
                |  plant  |---> y ---+--------------------------> x1 = y - D u ---+
        u ----->+---------+          |                                            |    [x1; x2^] = M x^
        |                            v                                            v
        +------------------>[ x3' = F x3 + G x1 + H u ]---> x3 ---(+)-----------> x2^ = x3 + L x1

With the blocks of `reduced_partition` (x+ in discrete time) and the gain L (n - p, p)

    F = A22 - L A12,   G = F L + A21 - L A11,   H = B2 - L B1

the error e = x2 - x2^ of an exact model obeys e' = F e for every u. The observer needs no derivative of y and no future
sample: x2^ uses the y of the same sample, with the direct gain L. An L for which e does not decay is refused; L = -K'
for the state feedback K of the dual pair (A22', A12').

F, G and H are computed from L in ball arithmetic and rounded once; the poles are the exact ones of that F, rounded.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from synth import arguments, show
from synth.analyse.numerics import precise
from synth.errors import ModelError, SignalError
from synth.statespace import Array, Complex, StateSpace, System, readonly
from synth.synthesise.observers import reduced_partition
from synth.synthesise.observers.reduced_partition import Partition
from synth.synthesise.riccati import exact_eigenvalues
from synth.synthesise.riccati.exact_eigenvalues import ball
from synth.timing import Continuous


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
    return _observer(part, gain)


def _observer(part: Partition, gain: Array) -> ReducedObserver:
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
            f"decay, which needs {bound}; take L = -K' for a K that places the poles of A22' + A12' K there"
        )
    return ReducedObserver(part, readonly(gain), F, G, H, from_x1, from_x3, poles)
