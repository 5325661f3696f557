"""The internal-model regulator as a Block: F(14)-(17) for one axis, exactly discretised.

    w = K [e, de, xi],   xi' = Phi_d xi + N_d e + E_d (u_limited - u_demanded)

The last term is the anti-windup; an axis without it leaves it out.
"""

from collections.abc import Sequence

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from synth.block import Block, Constant, Exprs, State, Step, build
from synth.errors import SignalError
from synth.signals import Signal, dimension
from synth.synthesise import internal_model
from synth.synthesise.lqr import Gain
from synth.timing import Discrete


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
    |xi|. `anti_windup` is the signal u_limited - u_demanded and E (n,).

    Raises SignalError when the gain's or the bounds' size does not fit the exosystem, or the units of rate and demand
    not the error's.
    """
    _require_units(error, rate, demand)
    excess, E = anti_windup or (None, None)
    model = internal_model.discrete(frequencies, time.period_s, E=E)
    n = len(model.Phi)
    if gain.K.shape != (1, 2 + n) or len(bounds) != n:
        raise SignalError(
            f"regulator '{name}': the gain is {gain.K.shape} and {len(bounds)} bounds are given, "
            f"but the exosystem of order {n} needs (1, {2 + n}) and {n}: design the gain on the augmented plant"
        )
    xi = [f"xi{i + 1}" for i in range(n)]
    terms = _terms(model, xi, excess)

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        signal = {"e": u[error.name], "de": u[rate.name]} | {s: x[s] for s in xi}
        signal |= {"excess": u[excess.name]} if excess else {}
        w = sum((k[f"k_{s}"] * signal[s] for s in ("e", "de", *xi)), start=ca.SX(0))
        next = {s: sum(((k[c] if c else 1) * signal[t] for t, c, _ in terms[s]), start=ca.SX(0)) for s in xi}
        return Step({demand.name: w}, next)

    units = [f"{error.unit} s^{n - i}" for i in range(n)]
    power = {"e": 0} | {s: n - i for i, s in enumerate(xi)}
    gains = zip(("e", "de", *xi), gain.K[0], ("1/s^2", "1/s", *(f"1/s^{n + 2 - i}" for i in range(n))), strict=True)
    constants = [Constant(f"k_{s}", float(v), unit, f"{tag}: gain on {s}") for s, v, unit in gains]
    constants += [
        Constant(c, value, _term_unit(error, excess, power[s], power.get(t)), f"{tag}: {s} from {t}, exact over T")
        for s in xi
        for t, c, value in terms[s]
        if c
    ]
    return build(
        name,
        time,
        law,
        inputs=[error, rate, *([excess] if excess else [])],
        outputs=[demand],
        states=[
            State(Signal(s, unit, -b, b, "internal model"), 0) for s, unit, b in zip(xi, units, bounds, strict=True)
        ],
        constants=constants,
        tag=tag,
    )


def _terms(
    model: internal_model.DiscreteInternalModel, xi: Sequence[str], excess: Signal | None
) -> dict[str, list[tuple[str, str, float]]]:
    """Return for each xi its terms (signal, constant's name or '' for an exact 1, value), zeros left out."""
    sources = [*xi, "e", *(["excess"] if excess else [])]
    matrix = np.hstack([model.Phi, model.N, *([model.E] if excess else [])])
    return {
        s: [(t, "" if v == 1 else f"{s}_{t}", float(v)) for t, v in zip(sources, row, strict=True) if v != 0]
        for s, row in zip(xi, matrix, strict=True)
    }


def _require_units(error: Signal, rate: Signal, demand: Signal) -> None:
    """Refuse a rate that is not in the error's unit per s, or a demand that is not in that per s^2."""
    for signal, per in ((rate, "/s"), (demand, "/s^2")):
        if dimension(signal.unit) != dimension(error.unit + per):
            raise SignalError(
                f"'{signal.name}' is in {signal.unit}, but the error '{error.name}' asks for {error.unit}{per}"
            )


def _term_unit(error: Signal, excess: Signal | None, to: int, source: int | None) -> str:
    """Return the unit of the term into an xi in error s^to from one in error s^source, or from the excess (None)."""
    if source is not None:
        return {0: "1", 1: "s"}.get(to - source) or (f"s^{to - source}" if to > source else f"1/s^{source - to}")
    assert excess is not None
    return f"{error.unit} s^{to}/" + excess.unit.translate({ord(" "): "/", ord("/"): " "})
