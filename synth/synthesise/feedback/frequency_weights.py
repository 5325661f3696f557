"""Frequency-shaped LQR: weights that depend on frequency, by filters on named signals.

    u --+--->[ plant ]---+--- x, y             min int (z'Qz z + x'Qx x + u'R u) dt,     z = W(s) (x, y, u)
        |                |
        +--->[ filters W ]<---                 u = K (x, w),  w the filters' states
                 |
                 z

By Parseval z'Qz z weights the filtered signals by |W(i omega)|^2. The inputs of a filter are states, outputs or inputs
of the plant, by name; its outputs z are weighted by name. The result is the dynamic controller from x to u, which
contains the filters. Source: Gupta, Frequency-shaped cost functionals (1980); Anderson, Moore, Optimal Control (1990),
chapter 9.

Library: no design uses it yet; docs/library.md has an example.
"""

from collections.abc import Sequence

import numpy as np
import scipy.linalg

from synth import arguments, show
from synth.errors import SignalError
from synth.statespace import Array, StateSpace, System, of
from synth.synthesise.feedback import lqr, weights
from synth.timing import common


@show.result
class FrequencyShapedGain:
    """The gain on (x, w) and the controller from x to u with the states w, in the gain's time."""

    gain: lqr.Gain
    controller: StateSpace

    def sheet(self) -> show.Sheet:
        """Return the gain's tables and the controller's."""
        gain, controller = self.gain.sheet(), self.controller.sheet()
        title = f"Frequency-weighted gain in {self.gain.time}: {len(self.controller.states)} states of filters"
        return show.Sheet(title, gain.lines, (*gain.tables, *controller.tables))


@arguments.checked
def frequency_shaped_lqr(
    system: System,
    filters: Sequence[System],
    Qz: weights.Weight,
    R: weights.Weight,
    Qx: weights.Weight | None = None,
    period_s: float | None = None,
    exact: bool = False,
) -> FrequencyShapedGain:
    """Return the gain and controller for weights Qz (k, k) on the filters' outputs, R (m, m) on u, Qx (n, n) on x.

    With `period_s` a continuous model's input is held over each period, the cost is the continuous one and the
    controller is sampled; else everything is in the model's own time.

    Raises SignalError for a filter input that is no signal of the plant or is ambiguous, a duplicate name, or weights
    of the wrong shape; TimingError for different times; ModelError as `riccati.solve`.
    """
    plant, joined = of(system), augmented(system, filters)
    extra = np.zeros((len(joined.states),) * 2)
    n = len(plant.states)
    if Qx is not None:
        extra[:n, :n] = weights.semidefinite("Qx", Qx, plant.states)
    output_weights = weights.output_weights(joined, Qz, R)
    Q = output_weights.Q + extra
    if period_s is None:
        gain, model = lqr.lqr(joined, Q, output_weights.R, output_weights.N, exact), joined
    else:
        gain = lqr.lqrd(joined, Q, output_weights.R, period_s, output_weights.N, exact)
        model = lqr.sampled_cost(joined, Q, output_weights.R, period_s, output_weights.N, exact).model
    return FrequencyShapedGain(gain, _controller(model, gain, n))


@arguments.checked
def augmented(system: System, filters: Sequence[System]) -> StateSpace:
    """Return plant and filters as one model: states (x, w), the plant's inputs, the filters' outputs z.

    Raises as `frequency_shaped_lqr`.
    """
    plant, parts = of(system), [of(f) for f in filters]
    if not parts:
        raise SignalError("no filter was given: use lqr.lqr for weights that do not depend on frequency")
    time = common(plant.time, *(part.time for part in parts))
    E, F = (
        np.vstack(rows) for rows in zip(*(_signal_rows(plant, u) for part in parts for u in part.inputs), strict=True)
    )
    A, B, C, D = (scipy.linalg.block_diag(*(getattr(part, letter) for part in parts)) for letter in "ABCD")
    n, k = len(plant.states), sum(len(part.states) for part in parts)
    A, B, C = A.reshape(k, k), B.reshape(k, len(E)), C.reshape(len(D), k)  # where a filter has no state
    return StateSpace(
        A=np.block([[plant.A, np.zeros((n, k))], [B @ E, A]]),
        B=np.vstack([plant.B, B @ F]),
        C=np.hstack([D @ E, C]),
        D=D @ F,
        states=(*plant.states, *(name for part in parts for name in part.states)),
        inputs=plant.inputs,
        outputs=tuple(name for part in parts for name in part.outputs),
        time=time,
        units={name: unit for part in (*parts, plant) for name, unit in part.units.items()},
    )


def _signal_rows(plant: StateSpace, name: str) -> tuple[Array, Array]:
    """Return the rows E (n,), F (m,) with which a state, output or input is E x + F u."""
    n, m = plant.B.shape
    rows = {
        "a state": (plant.states, np.eye(n, n + m)),
        "an output": (plant.outputs, np.hstack([plant.C, plant.D])),
        "an input": (plant.inputs, np.eye(m, n + m, n)),
    }
    matches = {kind: M[names.index(name)] for kind, (names, M) in rows.items() if name in names}
    if not matches:
        known = ", ".join(dict.fromkeys((*plant.states, *plant.outputs, *plant.inputs)))
        raise SignalError(f"a filter weights '{name}', which is not a signal of the plant: it has {known}")
    first, *others = matches.values()
    if any((first != other).any() for other in others):
        raise SignalError(
            f"a filter weights '{name}', which is {' and '.join(matches)} of the plant, and these differ: give each "
            "its own name"
        )
    return first[:n], first[n:]


def _controller(model: StateSpace, gain: lqr.Gain, n: int) -> StateSpace:
    """Return w' = A_w w + A_wx x + B_w u with u = K (x, w), from x to u; the plant has n states."""
    closed = model.A[n:] + model.B[n:] @ gain.K
    return StateSpace(
        A=closed[:, n:],
        B=closed[:, :n],
        C=gain.K[:, n:],
        D=gain.K[:, :n],
        states=model.states[n:],
        inputs=model.states[:n],
        outputs=model.inputs,
        time=model.time,
        units=model.units,
    )
