"""The LQG cores alone, three errors in and three currents out, as (33) and (40) have them: no delay, no prediction.

    (x, y, phi) less set-points --->[ core ]---> (i_B + i_A)/2, (i_B - i_A)/2, i_C --->[ rows ]---> i_AQ, i_BQ, i_CQ

They are what `control` is built on, and are there to count what the reduced order saves. In the half sum and the half
difference of the currents of A and B, (26) is three axes: no entry stands between them. States are scaled so that an
entry of each is 1.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from designs.planar_6dof.allocation import HORIZONTAL, LIMIT
from designs.planar_6dof.vertical import MARGIN, POSITIONS
from designs.planar_6dof_lqg import control
from designs.planar_6dof_lqg.control import CURRENTS, NOISE, OBSERVER_POLE, PUSHED, STATES, TIME, Order
from synth.analyse import discretise
from synth.block import Block
from synth.compose import compose
from synth.signals import Signal
from synth.statespace import Array, StateSpace, readonly
from synth.synthesise import kalman, linear_block, reduced_compensator, reduced_observer

MODES = ("i_y", "i_phi", "i_x")
TO_MODES = readonly([[0.5, 0.5, 0.0], [-0.5, 0.5, 0.0], [0.0, 0.0, 1.0]])
FROM_MODES = readonly([[1, -1, 0], [1, 1, 0], [0, 0, 1]])
INTEGRALS = STATES[3:6]
PLANT = [0, 1, 2, 6, 7, 8]  # of the states of (31), those of (26)
REACH = 2 * LIMIT  # A, of an integral
ESTIMATE = 1e4  # A, of an estimate times its gain


def plant() -> StateSpace:
    """Return (26), (27), continuous."""
    whole, states = control.model(), tuple(STATES[i] for i in PLANT)
    return replace(whole, A=whole.A[np.ix_(PLANT, PLANT)], B=whole.B[PLANT], C=whole.C[:, PLANT], states=states)


def compensator() -> reduced_compensator.Compensator:
    """Return (33)-(35) at 800 Hz with the integrals of (31), certified by the library."""
    held = discretise.zero_order_hold(plant(), TIME.period_s)
    L = np.diag([(1 - OBSERVER_POLE[axis]) / TIME.period_s for axis in HORIZONTAL])
    observer = reduced_observer.from_gain(held, HORIZONTAL, L)
    integrals = reduced_compensator.integrals(held, dict(zip(INTEGRALS, HORIZONTAL, strict=True)))
    return reduced_compensator.compensator(observer, gain(), integrals)


def estimator() -> kalman.Estimator:
    """Return the full-order filter (40) of (26), pushed by white accelerations."""
    W, V = [PUSHED[a] for a in HORIZONTAL], [NOISE[a] ** 2 for a in HORIZONTAL]
    return kalman.sampled(plant(), W, V, TIME.period_s, G=np.eye(6)[:, 3:], exact=True)


def gain() -> Array:
    """Return K (3, 9) on the states of `plant`, then on the integrals."""
    return readonly(control.gain().K[:, [*PLANT, 3, 4, 5]])


def block(order: Order) -> Block:
    """Return a core from the errors x, y, phi to i_AQ, i_BQ, i_CQ."""
    parts = {"reduced": _reduced, "full": _full}[order]()
    rows = StateSpace(np.zeros((0, 0)), np.zeros((0, 3)), np.zeros((3, 0)), FROM_MODES, (), MODES, CURRENTS, TIME)
    last = linear_block.block("rows", rows, inputs=_currents(MODES), outputs=_currents(CURRENTS), tag="(26)")
    return compose(f"core_{order}", [*parts, last], inputs=HORIZONTAL, outputs=CURRENTS)


def _reduced() -> list[Block]:
    """Return (33): x3 as a current, the integrals as sums of errors."""
    model = compensator().model
    C, D = TO_MODES @ model.C, TO_MODES @ model.D
    sizes = [*np.abs(C[:, :3]).max(axis=0), *np.full(3, 1 / TIME.period_s)]
    law, errors = _scaled(replace(model, C=C, D=D, outputs=MODES), sizes), _errors()
    sums = REACH / np.abs(law.C[:, 3:]).max(axis=0)
    pushed = np.abs(law.A[:3, 3:]) @ sums + np.abs(law.B[:3]) @ [s.high for s in errors]
    states = _states(
        law.states, ["A"] * 3 + [s.unit for s in errors], [*MARGIN * pushed / (1 - law.A.diagonal()[:3]), *sums]
    )
    tag = "(33)-(35), (49)"
    return [linear_block.block("law", law, inputs=errors, outputs=_currents(MODES), states=states, tag=tag)]


def _full() -> list[Block]:
    """Return the law, and the filter (40) whose states the law adds up as they are."""
    K, T, errors = TO_MODES @ gain(), TIME.period_s, _errors()
    sizes, sign = np.abs(K).max(axis=0), np.sign(K)
    filter = _scaled(estimator().predictor(), sizes[:6])
    B = np.hstack([filter.B[:, :3] @ FROM_MODES, filter.B[:, 3:]])
    estimates = tuple(f"{name}_held" for name in filter.states)
    filter = replace(filter, B=B, C=np.eye(6), inputs=(*MODES, *HORIZONTAL), outputs=estimates)
    on_error, nothing = np.diag(T * sizes[6:]), np.zeros((3, 3))
    B, D = np.hstack([np.zeros((3, 6)), on_error]), np.hstack([sign[:, :6], nothing])
    law = StateSpace(np.eye(3), B, sign[:, 6:], D, INTEGRALS, (*estimates, *HORIZONTAL), MODES, TIME)
    sums, kept = _states(INTEGRALS, ["A"] * 3, [REACH] * 3), _currents(filter.states)
    modes, held = _currents(MODES), _currents(estimates)
    return [
        linear_block.block("filter", filter, inputs=[*modes, *errors], outputs=held, states=kept, tag="(40)"),
        linear_block.block("law", law, inputs=[*held, *errors], outputs=modes, states=sums, tag="(49)"),
    ]


def _scaled(model: StateSpace, sizes: ArrayLike) -> StateSpace:
    """Return the model in its states times `sizes`, whose units are then those of a current."""
    s = np.asarray(sizes)
    return replace(model, A=model.A * s[:, None] / s, B=model.B * s[:, None], C=model.C / s, units={})


def _errors() -> list[Signal]:
    return [replace(POSITIONS[axis], about="less its set-point") for axis in HORIZONTAL]


def _currents(names: Sequence[str]) -> list[Signal]:
    return _states(names, ["A"] * len(names), [ESTIMATE] * len(names))


def _states(names: Sequence[str], units: Sequence[str], bounds: Sequence[float]) -> list[Signal]:
    return [Signal(name, unit, -float(b), float(b)) for name, unit, b in zip(names, units, bounds, strict=True)]
