"""Servo of one coordinate with internal models, fed by a predictive observer (discrete servo compensator).

    w = k_e (q' - r) + k_de (v' - r_rate) + K_xi xi - c d,    xi+ = Phi xi + N e,    e = q - r limited to +-E

q' and v' are the predictions for the time at which the command acts (`predictor` with `ahead`), d is its estimate of
the disturbance, of which the part c is cancelled at once; the internal models remove what remains at their frequencies.

r_rate is the difference of the set-point over a period, or 0 where that exceeds `fastest`: a set-point that moves no
faster is followed without the lag of a rate feedback, and a step causes no derivative kick.

The limit E keeps large steps out of the internal models: while |e| > E, they move as slowly as for E, so the response
to a step is that of the state feedback, without the slow modes of the internal models (conditional integration).

The internal models are those of `internal_model.Leapfrog`, with xi = T eta. Sources: Davison, Goldenberg, "Robust
control of a general servomechanism problem", Automatica 11 (1975); Franklin, Powell, Workman (1998), 8.5 and 11.2.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from synth import arguments
from synth.block import Block, Constant, Exprs, State, Step, build, clip
from synth.errors import SignalError
from synth.law import label
from synth.signals import Signal, dimension
from synth.synthesise.feedback.lqr import Gain
from synth.synthesise.regulation import internal_model
from synth.timing import Discrete

__all__ = ["Limits", "block"]


@arguments.checked
@dataclass(frozen=True)
class Limits:
    """Limits of the `error` into the internal models, of the set-point's rate (`fastest`), and of |eta| (`memory`).

    A step after which the Euclidean norm of eta exceeds its limit leaves the internal models as they are.
    """

    error: float
    fastest: float
    memory: float


@arguments.checked
def block(
    name: str,
    time: Discrete,
    gain: Gain,
    frequencies: Sequence[float],
    *,
    measured: Signal,
    reference: Signal,
    demand: Signal,
    cancelled: float,
    limits: Limits,
    disturbance: float,
    tag: str = "predictive servo with internal models",
) -> Block:
    """Return the servo from a coordinate q and its set-point r to the demanded acceleration.

    q is `name`; the Block reads `measured`, `reference`, ``<q>_ahead``, ``<q>_rate_ahead`` and ``<q>_disturbance``
    within +-`disturbance`. `gain` is (1, 2 + n) on (e, de, xi) for the exosystem of `frequencies` in rad/s;
    `cancelled` is the part c of the disturbance.

    Raises SignalError for a gain that does not fit the exosystem, units that do not fit, a part outside 0 .. 1, or
    limits that are not positive.
    """
    model = internal_model.leapfrog(frequencies, time.period_s, None)
    n, T = len(model.T), time.period_s
    _check(name, gain, n, measured, reference, demand, cancelled, limits)
    eta = ["sum"] * (n % 2) + [f"{letter}{k + 1}" for k in range(n // 2) for letter in "pq"]

    unit = measured.unit
    numbers = [
        Constant("largest_error", limits.error, unit, "a larger error counts as this in the internal models"),
        Constant("largest_step", limits.fastest * T, unit, "a larger change of the set-point has no rate"),
        Constant("cancelled", cancelled, "1", "part of the disturbance that is cancelled"),
    ]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        r = u[reference.name]
        e = ca.fmax(ca.fmin(u[measured.name] - r, limits.error), -limits.error)
        next = {s: x[s] + e for s in eta[: n % 2]}
        for j in range(1, n // 2 + 1):
            p, q = f"p{j}", f"q{j}"
            next[p] = x[p] + k[f"c{j}"] * x[q]
            next[q] = x[q] - next[p] + e
        moved = r - x["r"]
        step = ca.if_else(ca.fabs(moved) <= limits.fastest * T, moved, 0)
        inside = sum((v**2 for v in next.values()), start=ca.SX(0)) <= limits.memory**2
        next = {s: ca.if_else(inside, v, x[s]) for s, v in next.items()}
        step_feedforward, cancellation = k["k_step"] * step, cancelled * u[f"{name}_disturbance"]
        w = k["k_e"] * (u[f"{name}_ahead"] - r) + k["k_de"] * u[f"{name}_rate_ahead"] - step_feedforward
        w = feedback = sum((k[f"k_{s}"] * x[s] for s in eta), start=w)
        w -= cancellation
        label(e=e, inside=inside, moved=moved, step=step, step_feedforward=step_feedforward, feedback=feedback)
        label(cancellation=cancellation, w=w)
        return Step({demand.name: clip(w, demand)}, {**next, "r": r}, numbers=numbers)

    on_eta = _exact_product(gain, model.T)
    gains = zip(("e", "de", *eta), [*gain.K[0, :2], *on_eta], strict=True)
    constants = [Constant(f"k_{s}", float(v), "1/s" if s == "de" else "1/s^2", f"{tag}: gain on {s}") for s, v in gains]
    constants.append(Constant("k_step", float(gain.K[0, 1]) / T, "1/s^2", f"{tag}: k_de over the period"))
    phases = [f * T for f in sorted(frequencies) if f]
    constants += [
        Constant(f"c{j}", float(c), "1", f"{tag}: 2 - 2 cos(w T), w T = {phase:.6g}")
        for j, (c, phase) in enumerate(zip(model.c, phases, strict=True), 1)
    ]
    bound = limits.memory * (1 + 1e-5)  # with room for rounding
    inputs = [
        measured, reference,
        Signal(f"{name}_ahead", unit, measured.low, measured.high),
        Signal(f"{name}_rate_ahead", f"{unit}/s", -1e3, 1e3),
        Signal(f"{name}_disturbance", f"{unit}/s^2", -disturbance, disturbance),
    ]  # fmt: skip
    states = [State(Signal(s, unit, -bound, bound, "internal model"), 0) for s in eta]
    states.append(_last_set_point(reference))
    return build(
        f"servo_{name}", time, law, inputs=inputs, outputs=[demand], states=states, constants=constants, tag=tag
    )


def _last_set_point(reference: Signal) -> State:
    """Return the state r, wider than the set-point's range: a set-point at its end is no state at its bound."""
    room, nearest = reference.high - reference.low, min(max(0.0, reference.low), reference.high)
    wider = Signal("r", reference.unit, reference.low - room, reference.high + room, "set-point one sample ago")
    return State(wider, nearest)


def _exact_product(gain: Gain, T: NDArray[Any]) -> list[float]:
    """Return K_xi T, each entry rounded once."""
    columns = np.asarray(T).T
    return [float(sum(Fraction(float(k)) * t for k, t in zip(gain.K[0, 2:], c, strict=True))) for c in columns]


def _check(
    name: str, gain: Gain, n: int, measured: Signal, reference: Signal, demand: Signal, cancelled: float, limits: Limits
) -> None:
    if gain.K.shape != (1, 2 + n):
        raise SignalError(
            f"servo '{name}': the gain is {gain.K.shape}, but the exosystem of order {n} needs (1, {2 + n}): design "
            "the gain on the augmented plant"
        )
    for signal, per in ((reference, ""), (demand, "/s^2")):
        if dimension(signal.unit) != dimension(measured.unit + per):
            raise SignalError(
                f"servo '{name}': '{signal.name}' is in {signal.unit}, but '{measured.name}' needs {measured.unit}{per}"
            )
    if not 0 <= cancelled <= 1 or not min(limits.error, limits.fastest, limits.memory) > 0:
        raise SignalError(
            f"servo '{name}' cancels {cancelled} of the disturbance, with {limits}: give a part in 0 .. 1 and positive "
            "limits"
        )
