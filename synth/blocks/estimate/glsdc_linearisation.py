"""Residuals and Jacobian of a measurement model at a trial, with phasors that are computed once a sample.

    cos(a + b) = cos a cos b - sin a sin b,   sin(a + b) = sin a cos b + cos a sin b

a is an angle at the prediction, whose phasor takes a range reduction; b is how far the trial moves it, a small angle,
whose sine and cosine are polynomials of low degree.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from synth.block import Certificate, clip
from synth.blocks.estimate import phasor
from synth.blocks.estimate.glsdc import NamedExpressions, Vector
from synth.blocks.estimate.glsdc_jacobian import Model
from synth.blocks.estimate.glsdc_model import Unknown
from synth.blocks.estimate.phasor import Phasor
from synth.signals import Signal

ANY = Phasor(ca.SX(1), ca.SX(0))  # of an angle that the model does not use


@dataclass(frozen=True, eq=False)
class Prediction:
    """The predicted unknowns (n,) in their ranges, the phases, the phasors of both, and the held channels.

    `certified` are the certificates of the phasors' limits.
    """

    values: Vector
    phases: Vector
    turns: Sequence[Phasor]
    phasors: Sequence[Phasor]
    measured: Vector
    constants: ca.SX
    certified: Mapping[str, Certificate]


def predict(of: Model, values: Vector, measured: Vector, constants: ca.SX, named: NamedExpressions) -> Prediction:
    """Return the prediction of a sample; `named` receives the parts of the phasors."""
    turns = [
        _unknown_phasor(u, value, u.name in of.used, named)
        for u, value in zip(of.unknowns, values, strict=True)
        if u.rate
    ]
    phases = _phases(of, values, turns, constants)
    phasors: list[Phasor] = []
    certified: dict[str, Certificate] = {}
    for p, a in zip(of.phases, phases, strict=True):
        limited = clip(a, Signal(p.name, "rad", -p.largest, p.largest))
        one, certificates = phasor.by_certified_reduction(limited, phasor.halvings(p.largest), f"{p.name}_part", named)
        phasors.append(one)
        certified |= certificates
    return Prediction(values, phases, turns, phasors, measured, constants, certified)


def _unknown_phasor(u: Unknown, value: ca.SX, used: bool, named: NamedExpressions) -> Phasor:
    """Return the phasor of an unknown; names keep functions of an angle's cosine from becoming functions of it."""
    if not used:
        return ANY
    if u.angle:
        turn = phasor.of(value)
        named += [(Signal(f"cos_{u.name}", "1", -1, 1), turn.cosine), (Signal(f"sin_{u.name}", "1", -1, 1), turn.sine)]
        return turn
    halvings = phasor.halvings(u.rate * max(abs(u.signal.low), abs(u.signal.high)))
    return phasor.by_range_reduction(u.rate * value, halvings, f"{u.name}_part", named)


@dataclass(frozen=True, eq=False)
class Linearisation:
    """Whitened residuals (m,), Jacobian rows (m, n), and the unit vector (m,) along which each channel acts.

    Of such a vector there are the entries that are not 0, by their rows.
    """

    residuals: Vector
    rows: Sequence[Vector]
    directions: Sequence[Mapping[int, ca.SX]]


def linearise(of: Model, prediction: Prediction, at: Vector) -> Linearisation:
    """Return the linearisation at a displacement (n,) from the prediction."""
    values, turns, phasors = prediction.values, prediction.turns, prediction.phasors
    if any(not d.is_zero() for d in at):
        values = [
            start + d if u.periodic else clip(start + d, u.signal)
            for u, start, d in zip(of.unknowns, values, at, strict=True)
        ]
        moved = [(u, value, d) for u, value, d in zip(of.unknowns, values, at, strict=True) if u.rate]
        chords = [ANY if start is ANY else _chord(start, *by) for start, by in zip(turns, moved, strict=True)]
        turns = [
            start if start is ANY else _move(start, chord, u, value)
            for start, chord, (u, value, _) in zip(turns, chords, moved, strict=True)
        ]
        changes = _phase_changes(of, prediction, values, turns, chords, at)
        phasors = [
            _rotate(start, clip(change, Signal(p.name, "rad", -p.change, p.change)))
            for p, start, change in zip(of.phases, phasors, changes, strict=True)
        ]
    pairs = [*_columns(turns), *_columns(phasors)]
    e, H, D = of.function(ca.vcat(list(values)), *pairs, prediction.constants, ca.vcat(list(prediction.measured)))
    channels = range(len(of.channels))
    rows = [[H[i, j] for j in range(len(of.unknowns))] for i in channels]
    directions = [{i: D[i, j] for i in channels if D.sparsity().has_nz(i, j)} for j in channels]
    return Linearisation(of.whiten([e[i] for i in channels]), rows, directions)


def _phases(of: Model, values: Vector, turns: Sequence[Phasor], constants: ca.SX) -> list[ca.SX]:
    phases = of.phase_function(ca.vcat(list(values)), *_columns(turns), constants)
    return [phases[i] for i in range(len(of.phases))]


def _phase_changes(
    of: Model,
    prediction: Prediction,
    values: Vector,
    turns: Sequence[Phasor],
    chords: Sequence[Phasor],
    at: Vector,
) -> list[ca.SX]:
    """Return how far the phases move; of affine ones from limited changes of phasors, which bound them."""
    if of.phase_changes is None:
        phases = _phases(of, values, turns, prediction.constants)
        return [a - before for a, before in zip(phases, prediction.phases, strict=True)]
    limited = []
    for u, chord in zip(of.turning, chords, strict=True):
        most = Signal("chord", "1", -u.rate * u.step, u.rate * u.step)
        limited.append(ANY if chord is ANY else Phasor(clip(chord.cosine, most), clip(chord.sine, most)))
    moved = [
        d if u.periodic else end - start
        for u, d, end, start in zip(of.unknowns, at, values, prediction.values, strict=True)
    ]
    changes = of.phase_changes(ca.vcat(moved), *_columns(limited), prediction.constants)
    return [changes[i] for i in range(len(of.phases))]


def _columns(phasors: Sequence[Phasor]) -> tuple[ca.SX, ca.SX]:
    return ca.vcat([p.cosine for p in phasors]), ca.vcat([p.sine for p in phasors])


def _chord(start: Phasor, u: Unknown, value: ca.SX, by: ca.SX) -> Phasor:
    """Return how far a phasor moves; of a rotation, 1 - cos b = sin b tan(b / 2) without a difference of cosines."""
    if u.angle:
        turn = phasor.of(value)
        return Phasor(turn.cosine - start.cosine, turn.sine - start.sine)
    sine, half = ca.sin(u.rate * by), ca.tan(u.rate * by / 2)
    fall = sine * (half * start.cosine + start.sine)
    return Phasor(-fall, sine * (start.cosine - half * start.sine))


def _move(start: Phasor, chord: Phasor, u: Unknown, value: ca.SX) -> Phasor:
    return phasor.of(value) if u.angle else Phasor(start.cosine + chord.cosine, start.sine + chord.sine)


def _rotate(start: Phasor, by: ca.SX) -> Phasor:
    return start.times(phasor.of(by))
