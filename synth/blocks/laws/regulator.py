"""Internal-model regulator (servo compensator) of one axis as a Block: F(14)-(17), exactly discretised.

    w = K (e, de, xi),   xi' = Phi_d xi + N_d e + E_d (u_limited - u_demanded)

in the coordinates of `internal_model.Leapfrog`: xi = T eta, and the gain on eta is K T. The last term is the
anti-windup (back-calculation); it is optional.
"""

from collections.abc import Sequence
from fractions import Fraction

import casadi as ca
from numpy.typing import ArrayLike

from synth import arguments
from synth.block import Block, Constant, Exprs, State, Step, build
from synth.errors import SignalError
from synth.law import label
from synth.signals import Signal, dimension
from synth.statespace import Array
from synth.synthesise.feedback.lqr import Gain
from synth.synthesise.regulation import internal_model
from synth.timing import Discrete


@arguments.checked
def block(
    name: str,
    time: Discrete,
    gain: Gain,
    frequencies: Sequence[float],
    *,
    error: Signal,
    rate: Signal,
    demand: Signal,
    bounds: Sequence[float],
    anti_windup: tuple[Signal, ArrayLike] | None = None,
    tag: str,
) -> Block:
    """Return the regulator of one axis, from the error e = q - q_ref and its rate de to the demand w.

    `gain` is (1, 2 + n) on (e, de, xi) for the exosystem of `frequencies` in rad/s, of order n; `bounds` (n,) limits
    |eta| in the error's unit: a state whose next value would exceed its bound keeps its value. `anti_windup` is the
    signal u_limited - u_demanded and E (n,).

    Raises SignalError when the size of the gain or of the bounds does not fit the exosystem, or the units of rate and
    demand do not fit the error's.
    """
    _require_units(error, rate, demand)
    excess, E = anti_windup or (None, None)
    model = internal_model.leapfrog(frequencies, time.period_s, E)
    n = len(model.T)
    if gain.K.shape != (1, 2 + n) or len(bounds) != n:
        raise SignalError(
            f"regulator '{name}': the gain is {gain.K.shape} and {len(bounds)} bounds are given, "
            f"but the exosystem of order {n} needs (1, {2 + n}) and {n}: design the gain on the augmented plant"
        )
    eta = ["sum"] * (n % 2) + [f"{letter}{k + 1}" for k in range(n // 2) for letter in "pq"]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        added = {s: k[f"{s}_excess"] * u[excess.name] if excess else ca.SX(0) for s in eta}
        next = {s: x[s] + u[error.name] + added[s] for s in eta[: n % 2]}
        for j in range(1, n // 2 + 1):
            p, q = f"p{j}", f"q{j}"
            next[p] = x[p] + k[f"c{j}"] * x[q] + added[p]
            next[q] = x[q] - next[p] + u[error.name] + added[q]
        next = {s: ca.if_else(ca.fabs(v) <= b, v, x[s]) for (s, v), b in zip(next.items(), bounds, strict=True)}
        w = k["k_e"] * u[error.name] + k["k_de"] * u[rate.name]
        label(anti_windup=added, w=w)
        return Step({demand.name: sum((k[f"k_{s}"] * x[s] for s in eta), start=w)}, next, numbers=numbers)

    why = "of the internal model: a larger next value is not taken"
    numbers = [Constant(f"{s}_bound", b, error.unit, why) for s, b in zip(eta, bounds, strict=True)]
    gains = zip(("e", "de", *eta), [*gain.K[0, :2], *_exact_product(gain.K[0, 2:], model.T)], strict=True)
    constants = [Constant(f"k_{s}", float(v), "1/s" if s == "de" else "1/s^2", f"{tag}: gain on {s}") for s, v in gains]
    phases = [f * time.period_s for f in sorted(frequencies) if f]
    constants += [
        Constant(f"c{j}", float(c), "1", f"{tag}: 2 - 2 cos(w T), w T = {phase:.6g}")
        for j, (c, phase) in enumerate(zip(model.c, phases, strict=True), 1)
    ]
    if excess:
        per = f"{error.unit}/" + excess.unit.translate({ord(" "): "/", ord("/"): " "})
        anti_windup_gains = zip(eta, model.E[:, 0], strict=True)
        constants += [
            Constant(f"{s}_excess", float(v), per, f"{tag}: anti-windup into {s}") for s, v in anti_windup_gains
        ]
    return build(
        name,
        time,
        law,
        inputs=[error, rate, *([excess] if excess else [])],
        outputs=[demand],
        states=[State(Signal(s, error.unit, -b, b, "internal model"), 0) for s, b in zip(eta, bounds, strict=True)],
        constants=constants,
        tag=tag,
    )


def _exact_product(K: Array, T: Array) -> list[float]:
    """Return K T, each entry rounded once."""
    exact = [[Fraction(float(v)) for v in row] for row in T.T]
    return [float(sum(Fraction(float(k)) * t for k, t in zip(K, column, strict=True))) for column in exact]


def _require_units(error: Signal, rate: Signal, demand: Signal) -> None:
    """Raise SignalError unless the rate is in the error's unit per s and the demand in that unit per s^2."""
    for signal, per in ((rate, "/s"), (demand, "/s^2")):
        if dimension(signal.unit) != dimension(error.unit + per):
            raise SignalError(
                f"'{signal.name}' is in {signal.unit}, but the error '{error.name}' needs {error.unit}{per}"
            )
