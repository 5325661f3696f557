"""Whitened residuals and Jacobian of a measurement model y = h(q) + v, symbolic.

    v ~ N(0, R),   W R W' = s^2 I,   e(q) = W (y - h(q)),   H(q) = W dh/dq      angles: y - h wrapped to half a turn

with W lower triangular and s = 1, or with W = I and s^2 the common variance of independent measurements, which then
needs no multiplication.

A periodic unknown q_i of period T_i also enters h by the cosine and the sine of 2 pi q_i / T_i, an angle and a Phase
a(q) by their own. They are computed once a sample, at the prediction; a trial rotates them.
Chain rule:

    dh/dq_i = dh/dq_i |c,s + sum over angles a of (c dh/ds - s dh/dc) da/dq_i,   c = cos a,  s = sin a

An Implicit model is a residual e(q, y) of which W de/dy is orthogonal; H(q) = -W de/dq. A RotatedMeasurement brings its
H.

Source: Bar-Shalom, Li, Kirubarajan, "Estimation with Applications to Tracking and Navigation", section 3.4 (nonlinear
weighted least squares).

Residuals and Jacobian of a measurement model at a trial, with phasors that are computed once a sample.

    cos(a + b) = cos a cos b - sin a sin b,   sin(a + b) = sin a cos b + cos a sin b

a is an angle at the prediction, whose phasor takes a range reduction; b is how far the trial moves it, a small angle,
whose sine and cosine are polynomials of low degree.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import factorial, inf

import casadi as ca
import numpy as np

from synth import arguments
from synth import law as laws
from synth.block import Certificate, Constant, Exprs, clip
from synth.blocks.estimate import glsdc_model, phasor
from synth.blocks.estimate.glsdc import NamedExpressions, Vector
from synth.blocks.estimate.glsdc_model import Implicit, Measurement, Phase, RotatedMeasurement, Unknown
from synth.blocks.estimate.phasor import Phasor
from synth.errors import SignalError
from synth.law import call, label
from synth.signals import Signal, signal_names
from synth.statespace import Array, readonly

MOST_POWER = 6  # of a polynomial in a sine, in the Jacobian
ROUNDING = 1e-5  # relative, of a variance at its limit


@dataclass(frozen=True, eq=False)
class Model:
    """A measurement model, whitened: `whitening` W (m, m) and `scale` s of the whitened residuals.

    The residuals of the channels in `angles` are wrapped into half the width of their ranges, which is one turn.
    `phase_function` maps (q (n,), cosines and sines of the periodic unknowns, constants) to the phases, and
    `phase_changes` their changes to those of the phases, if these are affine in them; `function` maps
    these, cosines and sines of the phases, and channels, to residuals (m,), H (m, n) and the unit vectors (m, m), by
    columns, along which an error of each channel acts on the whitened residuals.
    """

    channels: tuple[Signal, ...]
    angles: frozenset[str]
    unknowns: tuple[Unknown, ...]
    phases: tuple[Phase, ...]
    whitening: Array
    scale: float
    phase_function: ca.Function
    phase_changes: ca.Function | None
    function: ca.Function
    used: frozenset[str]
    is_implicit: bool

    @property
    def turning(self) -> tuple[Unknown, ...]:
        """The unknowns with a phasor."""
        return tuple(u for u in self.unknowns if u.rate)

    @property
    def prior_weights(self) -> tuple[float, ...]:
        """s^2 over the variance of each prior, 0 for none."""
        return tuple(0.0 if u.prior == inf else (self.scale / u.prior) ** 2 for u in self.unknowns)

    @property
    def floors(self) -> tuple[float, ...]:
        """The least pivots: s^2 / largest_deviation^2."""
        return tuple((self.scale / u.largest_deviation) ** 2 for u in self.unknowns)

    @property
    def weak_from(self) -> tuple[float, ...]:
        """The variances over s^2 from which an unknown is not determined to its largest deviation."""
        return tuple((1 - ROUNDING) / floor for floor in self.floors)

    @property
    def is_diagonal(self) -> bool:
        """Whether the errors of the channels are independent."""
        return not np.tril(self.whitening, -1).any()

    @property
    def sensors(self) -> list[list[int]]:
        """The channels by index, together those whose errors act on the same residuals."""
        acting = self.function.sparsity_out(2)
        groups: list[list[int]] = []
        for j in range(len(self.channels)):
            near = [g for g in groups if any(acting.has_nz(i, j) or acting.has_nz(j, i) for i in g)]
            groups = [*(g for g in groups if g not in near), sorted([*(i for g in near for i in g), j])]
        return sorted(groups)

    def whiten(self, residuals: Sequence[ca.SX]) -> list[ca.SX]:
        """Return W times residuals (m,), those of angles wrapped."""
        differences = []
        for channel, d in zip(self.channels, residuals, strict=True):
            if channel.name in self.angles:
                turn = channel.high - channel.low
                d = ca.if_else(d > turn / 2, d - turn, d)
                d = ca.if_else(d < -turn / 2, d + turn, d)
            differences.append(d)
        return ca.vertsplit(ca.sparsify(ca.DM(self.whitening)) @ ca.vcat(differences))


def model(
    h: Measurement | Implicit | RotatedMeasurement,
    R: Array,
    channels: Sequence[Signal],
    angles: Sequence[str],
    unknowns: Sequence[Unknown],
    phases: Sequence[Phase],
    constants: Sequence[Constant],
) -> Model:
    """Return the whitened model.

    Raises ModelError for a covariance that is not positive definite or too few channels, and SignalError for names that
    are repeated, angles that are not channels, and a function that does not return a value for each channel.
    """
    channels, unknowns, phases = tuple(channels), tuple(unknowns), tuple(phases)
    glsdc_model.check(R, channels, unknowns)
    glsdc_model.check_angles(angles, channels)
    if isinstance(h, RotatedMeasurement):
        glsdc_model.check_pairs(h, R, channels, unknowns)
    of = _symbols(channels, unknowns, phases, constants)
    q, k = laws.NamedSymbols("h: the unknowns", of.known), laws.NamedSymbols("h: the constants", of.k)
    if isinstance(h, RotatedMeasurement):
        _require_values(laws.evaluate("h", h.fixed, q, k), of)
    turns = _turns(phases, of, q, k)
    residuals = _residuals(h, of, q, k)
    whitening, scale = _whitening(R)
    slopes = [_derivative(ca.vcat(turns), u, of) for u in unknowns]
    moving, turning = _fixed_axes(h, of, q, k) if isinstance(h, RotatedMeasurement) else (residuals, {})
    columns = [
        _derivative(moving, u, of) + _by_phases(moving, s, of) + turning.get(u.name, 0)
        for u, s in zip(unknowns, slopes, strict=True)
    ]
    H = -(ca.sparsify(ca.DM(whitening)) @ ca.hcat(columns))
    phase_function = ca.Function("phases", [*of.vectors[:3], of.vectors[5]], [ca.vcat(turns)])
    phase_changes = _phase_changes(ca.vcat(turns), of)
    norms = ca.sparsify(ca.DM(np.diag(1 / np.linalg.norm(whitening, axis=0))))
    directions = ca.sparsify(ca.DM(whitening)) @ ca.jacobian(residuals, ca.vcat(list(of.y.values()))) @ norms
    function = ca.Function("model", of.vectors, [residuals, H, directions])
    used = frozenset(v.name().partition("_")[2] for v in ca.symvar(ca.vertcat(residuals, *turns)))
    arrays = readonly(whitening), scale, phase_function, phase_changes, function
    return Model(channels, frozenset(angles), unknowns, phases, *arrays, used, not callable(h))


@dataclass(frozen=True, eq=False)
class _Symbols:
    """Symbols by name: unknowns q, cosine and sine of the periodic ones and of the phases, constants k, channels y."""

    q: dict[str, ca.SX]
    turns: dict[str, tuple[ca.SX, ca.SX]]
    phases: dict[str, tuple[ca.SX, ca.SX]]
    k: dict[str, ca.SX]
    y: dict[str, ca.SX]

    @property
    def known(self) -> dict[str, ca.SX]:
        """What h sees: unknowns, cosines and sines."""
        phasors = (self.turns | self.phases).items()
        return self.q | {f"{f}_{n}": v for n, pair in phasors for f, v in zip(("cos", "sin"), pair, strict=True)}

    @property
    def vectors(self) -> list[ca.SX]:
        """The arguments of the model's function."""
        pairs = [[pair[i] for pair in group.values()] for group in (self.turns, self.phases) for i in (0, 1)]
        return [ca.vcat(list(each)) for each in (self.q.values(), *pairs, self.k.values(), self.y.values())]


def _symbols(
    channels: Sequence[Signal], unknowns: Sequence[Unknown], phases: Sequence[Phase], constants: Sequence[Constant]
) -> _Symbols:
    def pair(name: str) -> tuple[ca.SX, ca.SX]:
        return ca.SX.sym(f"cos_{name}"), ca.SX.sym(f"sin_{name}")

    return _Symbols(
        {n: ca.SX.sym(n) for n in signal_names([u.signal for u in unknowns])},
        {u.name: pair(u.name) for u in unknowns if u.rate},
        {p.name: pair(p.name) for p in phases},
        {c.name: ca.SX.sym(c.name) for c in constants},
        {n: ca.SX.sym(n) for n in signal_names(channels)},
    )


def _residuals(h: Measurement | Implicit | RotatedMeasurement, of: _Symbols, q: Exprs, k: Exprs) -> ca.SX:
    """Return the residuals (m,): y - h, or those of an Implicit model."""
    y = laws.NamedSymbols("h: the channels", of.y)
    values = laws.evaluate("h", h, q, k) if callable(h) else laws.evaluate("h", h.residual, q, y, k)
    _require_values(values, of)
    exprs = laws.scalars("h", values)
    symbols = [*q.values(), *k.values(), *y.values()]
    laws.check_symbols("h", list(exprs.values()), symbols)
    laws.check_numbers("h", exprs, symbols)
    return ca.vcat([symbol - exprs[n] if callable(h) else exprs[n] for n, symbol in of.y.items()])


def _turns(phases: Sequence[Phase], of: _Symbols, q: Exprs, k: Exprs) -> list[ca.SX]:
    """Return the angles of the phases."""
    turns = {p.name: laws.evaluate(f"phase '{p.name}'", p.angle, q, k) for p in phases}
    exprs = laws.scalars("a phase", turns)
    laws.check_symbols("a phase", list(exprs.values()), [*q.values(), *of.k.values()])
    return list(exprs.values())


def _require_values(values: object, of: _Symbols) -> None:
    if not isinstance(values, Mapping):
        raise SignalError(f"h returns {arguments.describe(values)}: return a mapping of each channel to its value")
    laws.require_names("h", list(of.y), values)


def _fixed_axes(h: RotatedMeasurement, of: _Symbols, q: Exprs, k: Exprs) -> tuple[ca.SX, dict[str, ca.SX]]:
    """Return -f (m,) of a RotatedMeasurement, and what the turn adds to its derivative by the angle."""
    f = laws.evaluate("h", h.fixed, q, k)
    turning = h.turning(f)
    return ca.vcat([-f[n] for n in of.y]), {h.angle: ca.vcat([-turning[n] for n in of.y])}


def _phase_changes(turns: ca.SX, of: _Symbols) -> ca.Function | None:
    """Return the function of `phase_function`'s arguments with changes in place of values, None if it is not affine."""
    moving = ca.vertcat(*of.vectors[:3])
    slopes = ca.jacobian(turns, moving)
    if ca.depends_on(slopes, moving):
        return None
    return ca.Function("changes", [*of.vectors[:3], of.vectors[5]], [slopes @ moving])


def _derivative(of: ca.SX, u: Unknown, symbols: _Symbols) -> ca.SX:
    """Return the derivative of a column by an unknown and by its cosine and sine, with the phases fixed."""
    column = ca.jacobian(of, symbols.q[u.name])
    if u.rate:
        c, s = symbols.turns[u.name]
        column += u.rate * (c * ca.jacobian(of, s) - s * ca.jacobian(of, c))
    return column


def _by_phases(of: ca.SX, slopes: ca.SX, symbols: _Symbols) -> ca.SX:
    """Return the derivative of a column by way of the phases, whose own derivatives are the slopes."""
    pairs = enumerate(symbols.phases.values())
    return sum(((c * _slope(of, s) - s * _slope(of, c)) * slopes[i] for i, (c, s) in pairs), ca.SX(0))


def _slope(of: ca.SX, by: ca.SX) -> ca.SX:
    """Return the derivative of a column by a cosine or a sine; a polynomial in its square takes half the products."""
    column = ca.jacobian(of, by)
    for i in column.sparsity().row():
        column[i] = -_even_polynomial(-column[i], by)  # of y - h, as it stands in h
    return column


def _even_polynomial(of: ca.SX, by: ca.SX) -> ca.SX:
    """Return a polynomial of even powers up to MOST_POWER by Horner's rule in the square, anything else as it is."""
    coefficients, derivative = [], of
    for power in range(MOST_POWER + 1):
        number, product = _factors(ca.substitute(derivative, by, 0))
        coefficients.append(number / factorial(power) * product)
        derivative = ca.jacobian(derivative, by)
    odd = any(not c.is_zero() for c in coefficients[1::2])
    if odd or ca.depends_on(derivative, by) or not derivative.is_zero():
        return of
    value = coefficients[-1]
    for coefficient in reversed(coefficients[:-2:2]):
        value = coefficient + by**2 * value
    return value


def _factors(of: ca.SX) -> tuple[float, ca.SX]:
    """Return an expression as a number times the rest; sums of multiples of one expression are one multiple."""
    if of.is_constant():
        return float(of), ca.SX(1)
    if of.op() not in (ca.OP_MUL, ca.OP_NEG, ca.OP_TWICE, ca.OP_ADD):
        return 1.0, of
    parts = [_factors(of.dep(i)) for i in range(of.n_dep())]
    if of.op() == ca.OP_MUL:
        return parts[0][0] * parts[1][0], parts[0][1] * parts[1][1]
    if of.op() in (ca.OP_NEG, ca.OP_TWICE):
        return parts[0][0] * (2 if of.op() == ca.OP_TWICE else -1), parts[0][1]
    if of.op() == ca.OP_ADD and ca.is_equal(parts[0][1], parts[1][1], 9):
        return parts[0][0] + parts[1][0], parts[0][1]
    return 1.0, of


def _whitening(R: Array) -> tuple[Array, float]:
    """Return W and s with W R W' = s^2 I."""
    variances = R.diagonal()
    if not np.any(R - np.diag(variances)):
        if (variances == variances[0]).all():
            return np.eye(len(R)), float(np.sqrt(variances[0]))
        return np.diag(1 / np.sqrt(variances)), 1.0
    return np.tril(np.linalg.inv(np.linalg.cholesky(R))), 1.0


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
        halvings, name = phasor.halvings(p.largest), f"{p.name}_part"
        one, certificates = call(f"phasor_{p.name}", phasor.by_certified_reduction, limited, halvings, name, named)
        phasors.append(one)
        certified |= certificates
        label(p.name, limited=limited)
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
    values, turns, changes = prediction.values, prediction.turns, None
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
        changes = _limited_phase_changes(of, prediction, values, turns, chords, at)
        for u, value, chord, turn in zip(of.turning, (m[1] for m in moved), chords, turns, strict=True):
            label(u.name, moved=value, chord=chord, turn=turn)
        for p, change in zip(of.phases, changes, strict=True):
            label(p.name, by=change)
    sensors = [
        call(f"sensor_{n}", _linearise_channels, of, channels, prediction, values, turns, changes)
        for n, channels in enumerate(of.sensors, 1)
    ]
    by_channel = {i: (one, k) for one in sensors for k, i in enumerate(one.channels)}
    each = [by_channel[i] for i in range(len(of.channels))]
    return Linearisation(
        of.whiten([one.residuals[k] for one, k in each]),
        [one.rows[k] for one, k in each],
        [one.directions[k] for one, k in each],
    )


@dataclass(frozen=True, eq=False)
class _Channels:
    """Some channels by index: residuals before whitening, rows and directions."""

    channels: Sequence[int]
    residuals: Vector
    rows: Sequence[Vector]
    directions: Sequence[Mapping[int, ca.SX]]


def _linearise_channels(
    of: Model,
    channels: Sequence[int],
    prediction: Prediction,
    values: Vector,
    turns: Sequence[Phasor],
    changes: Vector | None,
) -> _Channels:
    """Return the linearisation of some channels, whose phases have moved by `changes` since the prediction."""
    phasors = prediction.phasors
    if changes is not None:
        phasors = [
            _rotate(start, clip(change, Signal(p.name, "rad", -p.change, p.change)))
            for p, start, change in zip(of.phases, phasors, changes, strict=True)
        ]
    for p, of_phase in zip(of.phases, phasors, strict=True):
        label(p.name, phasor=of_phase)
    pairs = [*_columns(turns), *_columns(phasors)]
    e, H, D = of.function(ca.vcat(list(values)), *pairs, prediction.constants, ca.vcat(list(prediction.measured)))
    rows = [[H[i, j] for j in range(len(of.unknowns))] for i in channels]
    directions = [{i: D[i, j] for i in channels if D.sparsity().has_nz(i, j)} for j in channels]
    return _Channels(channels, [e[i] for i in channels], rows, directions)


def _phases(of: Model, values: Vector, turns: Sequence[Phasor], constants: ca.SX) -> list[ca.SX]:
    phases = of.phase_function(ca.vcat(list(values)), *_columns(turns), constants)
    return [phases[i] for i in range(len(of.phases))]


def _limited_phase_changes(
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
        label(u.name, limited=limited[-1])
    moved = [
        d if u.periodic else end - start
        for u, d, end, start in zip(of.unknowns, at, values, prediction.values, strict=True)
    ]
    changes = of.phase_changes(ca.vcat(moved), *_columns(limited), prediction.constants)
    for u, change in zip(of.unknowns, moved, strict=True):
        label(u.name, moved=change)
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
    label(u.name, chord_sine=sine, half_tangent=half, fall=fall)
    return Phasor(-fall, sine * (start.cosine - half * start.sine))


def _move(start: Phasor, chord: Phasor, u: Unknown, value: ca.SX) -> Phasor:
    return phasor.of(value) if u.angle else Phasor(start.cosine + chord.cosine, start.sine + chord.sine)


def _rotate(start: Phasor, by: ca.SX) -> Phasor:
    return start.times(phasor.of(by))
