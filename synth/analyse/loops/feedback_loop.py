"""Sensitivity functions of a plant P with a controller K (MATLAB `loopsens`): L, S, T, PS, CS at output and input.

                                       d
                                       |
    r --->(+)-- e -->[ K ]-- u -->(+)<-+
           ^ -                     |
           |                       v ---->[ P ]---+--> y
           |                                      |
           +--------------- (+) <-----------------+
                             ^
                             n

    e = r - y - n,    u = K e,    v = u + d,    y = P v

    at the plant's output                            at its input
    L  = P K               e ->  y                   Li = K P               v -> -u
    S  = (I + P K)^-1      r ->  e                   Si = (I + K P)^-1      d ->  v
    T  = P K (I + P K)^-1  r ->  y                   Ti = K P (I + K P)^-1  d -> -u
    PS = P (I + K P)^-1    d ->  y                   CS = K (I + P K)^-1    r ->  u

S + T = I and Si + Ti = I. A disturbance added to y reaches y through S; the noise n reaches y through -T and u through
-CS. For one input and one output Si = S and Ti = T. All are models in the common time of P and K.

For a plant input ``f`` and output ``q`` the signals have the names r ``q_reference``, n ``q_noise``, e ``q_error``,
d ``f_disturbance``, u ``f_command``, -u ``f_compensation``, v ``f`` and y ``q``; the states get the prefixes
``plant_`` and ``controller_``.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from synth import arguments, show
from synth.analyse.loops import interconnect, transfer
from synth.errors import ModelError, SignalError, TimingError
from synth.signals import dimension
from synth.statespace import StateSpace, System, in_common_time, of
from synth.timing import Continuous, common, period

ARROWS = {
    "L": ("e", "y", "the loop opened at the plant's output"),
    "S": ("r", "e", "sensitivity: the error due to a reference, or the output due to an output disturbance"),
    "T": ("r", "y", "complementary sensitivity: the output due to a reference, or with the other sign to noise"),
    "PS": ("d", "y", "load sensitivity (compliance): the output due to a disturbance at the plant's input"),
    "CS": ("r", "u", "control sensitivity: the command due to a reference, or with the other sign to noise"),
    "Li": ("v", "-u", "the loop opened at the plant's input"),
    "Si": ("d", "v", "input sensitivity: the remaining disturbance at the plant's input"),
    "Ti": ("d", "-u", "input complementary sensitivity: the part of a disturbance that the command cancels"),
}


@show.result
class ClosedLoop:
    """The closed loop of a plant and a controller: `whole` is the model from (r, d, n) to (e, u, v, y).

    `signals` maps r, d, n, e, u, v, y to the names of their entries.
    """

    plant: StateSpace
    controller: StateSpace
    whole: StateSpace
    signals: Mapping[str, tuple[str, ...]]

    @property
    def L(self) -> StateSpace:
        """P K, e -> y."""
        return _series(self.plant, self.controller, self.signals["e"], self.signals["y"])

    @property
    def S(self) -> StateSpace:
        """(I + P K)^-1, r -> e."""
        return self._from("r", "e")

    @property
    def T(self) -> StateSpace:
        """P K (I + P K)^-1, r -> y."""
        return self._from("r", "y")

    @property
    def PS(self) -> StateSpace:
        """P (I + K P)^-1, d -> y."""
        return self._from("d", "y")

    @property
    def CS(self) -> StateSpace:
        """K (I + P K)^-1, r -> u."""
        return self._from("r", "u")

    @property
    def Li(self) -> StateSpace:
        """K P, v -> -u."""
        return self._compensating(_series(self.controller, self.plant, self.signals["v"], self.signals["u"]))

    @property
    def Si(self) -> StateSpace:
        """(I + K P)^-1, d -> v."""
        return self._from("d", "v")

    @property
    def Ti(self) -> StateSpace:
        """K P (I + K P)^-1, d -> -u."""
        model = self._from("d", "u")
        return self._compensating(replace(model, C=0.0 - model.C, D=0.0 - model.D))

    @property
    def both(self) -> StateSpace:
        """[[0, K], [-P, 0]]: the loop opened at the plant's inputs and outputs at once; its channels are v and y."""
        P, K = self.plant, self.controller
        (n, m), (k, p) = P.B.shape, K.B.shape
        A, B = scipy.linalg.block_diag(P.A, K.A), scipy.linalg.block_diag(P.B, K.B)
        C = np.block([[np.zeros((m, n)), K.C], [-P.C, np.zeros((p, k))]])
        D = np.block([[np.zeros((m, m)), K.D], [-P.D, np.zeros((p, p))]])
        names, units = (*P.inputs, *P.outputs), {**K.units, **P.units}
        return StateSpace(A, B, C, D, (*P.states, *K.states), names, names, P.time, units)

    def _compensating(self, model: StateSpace) -> StateSpace:
        return model.renamed({f"{name}_command": f"{name}_compensation" for name in self.signals["v"]})

    @property
    def poles(self) -> NDArray[np.complex128]:
        """The poles of the closed loop, including cancelled ones, in 1/s or in z."""
        return self.whole.poles

    @property
    def stable(self) -> bool:
        """Whether all poles decay, by more than rounding error."""
        return transfer.is_stable(self.poles, self.whole.time)

    def _from(self, start: str, end: str) -> StateSpace:
        return self.whole.select(self.signals[end], self.signals[start])

    def sheet(self) -> show.Sheet:
        """Return the signals by letter, the meaning of each transfer function, and the poles."""
        named = tuple((letter, ", ".join(self.whole.labels(entries))) for letter, entries in self.signals.items())
        arrows = tuple((f"{name}: {what}", f"{start} -> {end}") for name, (start, end, what) in ARROWS.items())
        state = "stable" if self.stable else "NOT STABLE"
        poles = ", ".join(show.number(p) for p in self.poles)
        return show.Sheet(
            f"Closed loop in {self.whole.time}: {state}",
            (f"poles {poles}",),
            (show.Table("", ("signal", "is"), named), show.Table("", ("transfer", "arrow"), arrows)),
        )


@arguments.checked
def close(plant: System, controller: System) -> ClosedLoop:
    """Return the closed loop of a plant (p outputs, m inputs) and a controller (m, p), wired in the order of signals.

    A python-control system without a time base (`dt` None or True, as for static gains) takes that of the other.

    Raises TimingError if one is continuous and the other sampled; SignalError for a plant without inputs or outputs,
    for numbers or units that do not fit, or if the controller drives the plant's inputs by name in another order;
    ModelError if I + P K has no inverse.
    """
    P, K = in_common_time(plant, controller)
    _require_fit(P, K)
    y, v = P.outputs, P.inputs
    signals = {
        **{letter: tuple(f"{name}_{word}" for name in y) for letter, word in (("r", "reference"), ("n", "noise"))},
        "d": tuple(f"{name}_disturbance" for name in v),
        "e": tuple(f"{name}_error" for name in y),
        "u": tuple(f"{name}_command" for name in v),
        "v": tuple(v),
        "y": tuple(y),
    }
    units = _units(P, K, signals)
    P = _rename(P, "plant_", signals["v"], signals["y"], units)
    K = _rename(K, "controller_", signals["e"], signals["u"], units)
    wires = {e: {r: 1.0, q: -1.0, n: -1.0} for e, r, q, n in _rows(signals, "eryn")}
    wires |= {f: {u: 1.0, d: 1.0} for f, u, d in _rows(signals, "vud")}
    outside, inside = (*signals["r"], *signals["d"], *signals["n"]), (*signals["u"], *signals["y"])
    try:
        inner = interconnect.connect([P, K], outside, inside, wires)
    except ModelError as error:
        raise ModelError(
            "I + P K has no inverse: plant and controller have direct feedthrough with a product of -1; "
            "put a delay or a lag into one of them"
        ) from error
    return ClosedLoop(P, K, _with_sums(inner, signals, units), signals)


@arguments.checked
def feedback(forward: System, back: System | None = None) -> StateSpace:
    """Return forward (I + back forward)^-1, the closed loop with negative feedback; `back` is 1 if left out.

    Inputs and outputs keep their names, states get the prefixes of `close`. Raises as `close`; SignalError also for a
    model without `back` whose numbers of inputs and outputs differ.
    """
    P = of(forward)
    n = len(P.outputs)
    if back is None and len(P.inputs) != n:
        raise SignalError(f"a model with {len(P.inputs)} inputs and {n} outputs has no unit feedback: give `back`")
    A, B, C = np.zeros((0, 0)), np.zeros((0, n)), np.zeros((n, 0))
    loop = close(P, StateSpace(A, B, C, np.eye(n), (), P.outputs, P.inputs, P.time) if back is None else back)
    return loop.PS.renamed(dict(zip(loop.signals["d"], P.inputs, strict=True)))


def _require_fit(P: StateSpace, K: StateSpace) -> None:
    if isinstance(P.time, Continuous) and not isinstance(K.time, Continuous):
        raise TimingError(
            f"the plant is in {P.time}, the controller in {K.time}: sample the plant with "
            f"loop.sampled(plant, {period(K.time):g}, delay_s), which is exact for any delay"
        )
    common(P.time, K.time)
    if not (P.inputs and P.outputs):
        raise SignalError(
            f"the plant has {len(P.inputs)} inputs and {len(P.outputs)} outputs, so no loop can be closed: "
            "give it at least one of each"
        )
    if (len(K.inputs), len(K.outputs)) != (len(P.outputs), len(P.inputs)):
        raise SignalError(
            f"the plant goes from {len(P.inputs)} inputs to {len(P.outputs)} outputs, the controller from "
            f"{len(K.inputs)} to {len(K.outputs)}: give the controller an input for each output of the plant"
        )
    if set(K.outputs) == set(P.inputs) and K.outputs != P.inputs:
        raise SignalError(
            f"the controller drives {', '.join(K.outputs)} but the plant takes {', '.join(P.inputs)}: "
            "bring one of them into the other's order with `select`"
        )
    for here, there in (*zip(P.outputs, K.inputs, strict=True), *zip(P.inputs, K.outputs, strict=True)):
        a, b = P.unit(here), K.unit(there)
        if a and b and dimension(a) != dimension(b):
            raise SignalError(f"the plant's '{here}' is in {a}, the controller's '{there}' in {b}: convert one of them")


def _units(P: StateSpace, K: StateSpace, signals: Mapping[str, tuple[str, ...]]) -> dict[str, str]:
    """Return the units of all signals; the terms of a sum have the same unit."""
    outer = [P.unit(a) or K.unit(b) for a, b in zip(P.outputs, K.inputs, strict=True)]
    inner = [P.unit(a) or K.unit(b) for a, b in zip(P.inputs, K.outputs, strict=True)]
    by_letter = [(letter, outer if letter in "rney" else inner) for letter in signals]
    return {
        name: unit for letter, units in by_letter for name, unit in zip(signals[letter], units, strict=True) if unit
    }


def _rename(
    model: StateSpace, prefix: str, inputs: tuple[str, ...], outputs: tuple[str, ...], units: Mapping[str, str]
) -> StateSpace:
    states = {f"{prefix}{name}": model.units.get(name) for name in model.states}
    known = {name: unit for name, unit in states.items() if unit}
    return replace(model, states=tuple(states), inputs=inputs, outputs=outputs, units={**units, **known})


def _rows(signals: Mapping[str, tuple[str, ...]], letters: str) -> Sequence[tuple[str, ...]]:
    return list(zip(*(signals[letter] for letter in letters), strict=True))


def _with_sums(inner: StateSpace, signals: Mapping[str, tuple[str, ...]], units: Mapping[str, str]) -> StateSpace:
    """Return the model with the outputs e = r - y - n and v = u + d as well as u and y."""
    m, p = len(signals["u"]), len(signals["y"])
    r, d, n = np.split(np.eye(2 * p + m), [p, p + m])
    (Cu, Cy), (Du, Dy) = np.split(inner.C, [m]), np.split(inner.D, [m])
    C, D = np.vstack([0.0 - Cy, Cu, Cu, Cy]), np.vstack([r - Dy - n, Du, Du + d, Dy])
    outputs = (*signals["e"], *signals["u"], *signals["v"], *signals["y"])
    return replace(inner, C=C, D=D, outputs=outputs, units={**units, **inner.units})


def _series(second: StateSpace, first: StateSpace, inputs: tuple[str, ...], outputs: tuple[str, ...]) -> StateSpace:
    """Return the series connection second * first."""
    n, k = len(first.A), len(second.A)
    A = np.block([[first.A, np.zeros((n, k))], [second.B @ first.C, second.A]])
    B, C = np.vstack([first.B, second.B @ first.D]), np.hstack([second.D @ first.C, second.C])
    states, units = (*first.states, *second.states), {**first.units, **second.units}
    return StateSpace(A, B, C, second.D @ first.D, states, inputs, outputs, first.time, units)
