"""Lead-lag compensators by zeros, poles and gain, continuous, and sampled by four methods (MATLAB `c2d`).

    K(s) = k prod (s - z_i) / prod (s - p_i),          real zeros z and poles p, at most as many zeros as poles

Y(21) specifies one by time constants, k (1 + a s) / (1 + b s) (1 + c s) / s, and Y(23) by zeros and poles; PI is
k (1 + c s) / s, PD with its filter k (1 + a s) / (1 + b s). The four methods, with the period T, keep the order:

    tustin      s = (2 / T) (z - 1) / (z + 1)
    prewarped   s = (w / tan(w T / 2)) (z - 1) / (z + 1),      K is exact at the frequency w
    matched     each zero z and pole p at exp(z T) and exp(p T), |K| exact at w
    held        zero-order hold at the input of K, which adds a lag of about T / 2 where K is not smooth

An integrator is mapped to z = 1 by each. With more poles than zeros, tustin, prewarped and matched map the zeros at
infinity to z = -1, and K keeps a direct term. With more zeros than poles K is not proper, and is refused.

Each number is computed in ball arithmetic and rounded once. The model is a series connection of sections
x' = p x + u, y = (p - z) x + u, in the order of the poles, with the gain last.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import flint
import numpy as np

from synth import arguments, show
from synth.analyse import discretise, precise
from synth.errors import ModelError, SignalError, TimingError
from synth.statespace import StateSpace
from synth.synthesise.classical.zeros import balls, evaluate, zeros_and_gain
from synth.timing import Continuous, Discrete, Time

MAX_INTEGRATORS = 10  # of a compensator: with more, a loop has no phase margin at any crossover


@arguments.checked
@show.with_repr
@dataclass(frozen=True, repr=False)
class Compensator:
    """K by gain, zeros and poles, in 1/s, or in z if sampled; `units` are those of input and output.

    Raises SignalError for a gain of 0, a number that is not real and finite, or more zeros than poles.
    """

    gain: float
    zeros: tuple[float, ...]
    poles: tuple[float, ...]
    time: Time = field(default_factory=Continuous)
    input: str = "error"
    output: str = "command"
    units: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for what, values in (("gain", (self.gain,)), ("zeros", self.zeros), ("poles", self.poles)):
            for v in values:
                if isinstance(v, complex) or not np.isfinite(v):
                    raise SignalError(f"the compensator has {v} among its {what}: give real, finite numbers")
        if self.gain == 0:
            raise SignalError("the compensator's gain is 0: give another")
        if len(self.zeros) > len(self.poles):
            raise SignalError(
                f"the compensator has {len(self.zeros)} zeros but {len(self.poles)} poles, which would differentiate "
                "its input without bound: add a filter pole beyond the crossover for each zero too many"
            )

    @property
    def model(self) -> StateSpace:
        """The series connection of sections as a StateSpace with one state for each pole."""
        return _chain(self)

    def sheet(self) -> show.Sheet:
        """Return gain, zeros and poles."""
        variable = "1/s" if isinstance(self.time, Continuous) else "z"
        rows = [("gain", show.number(self.gain, 8))]
        rows += [(f"zero [{variable}]", show.number(v, 8)) for v in self.zeros]
        rows += [(f"pole [{variable}]", show.number(v, 8)) for v in self.poles]
        ends = " to ".join(show.with_unit(name, self.units.get(name, "")) for name in (self.input, self.output))
        equation = show.ratio("K", "s" if variable == "1/s" else "z", self.gain, self.zeros, self.poles)
        table = show.Table(("", "value"), tuple(rows), equation=equation)
        return show.Sheet(f"Compensator in {self.time}, {ends}", (), (table,))


@show.result
class LeadLag:
    """A continuous compensator and its discretisation; `zeros`, `poles` and `gain` are those in z.

    The errors compare the sampled with the continuous compensator at `frequency` in rad/s: |K_d / K| - 1 and
    arg(K_d / K) in degrees, without the hold and the delay after K.
    """

    continuous: Compensator
    discrete: StateSpace
    method: str
    frequency: float
    gain: float
    zeros: tuple[complex, ...]
    poles: tuple[complex, ...]
    gain_error: float
    phase_error: float

    def sheet(self) -> show.Sheet:
        """Return both compensators, side by side, and the errors."""
        rows = [("gain", show.number(self.continuous.gain, 8), show.number(self.gain, 8))]
        for what in ("zero", "pole"):
            continuous, sampled = getattr(self.continuous, f"{what}s"), getattr(self, f"{what}s")
            for k in range(max(len(continuous), len(sampled))):
                left, right = (show.number(v[k], 8) if k < len(v) else "" for v in (continuous, sampled))
                rows.append((what, left, right))
        ends = " to ".join(self.discrete.labels((*self.discrete.inputs, *self.discrete.outputs)))
        line = (
            f"at {show.number(self.frequency)} rad/s ({show.number(self.frequency / (2 * np.pi))} Hz) the sampled one "
            f"has a relative gain error of {self.gain_error:.2e} and a phase error of {self.phase_error:.2e} degrees"
        )
        title = f"Lead-lag, {self.method}, {ends}, {self.discrete.time}"
        equation = show.ratio("K", "z", self.gain, self.zeros, self.poles)
        table = show.Table(("", "continuous [1/s]", "sampled [z]"), tuple(rows), equation=equation)
        return show.Sheet(title, (line,), (table,))


Method = Callable[[Compensator, float, float], LeadLag]
"""`tustin`, `prewarped`, `matched` or `zero_order_hold`: (compensator, period in s, frequency in rad/s) -> LeadLag."""


@arguments.checked
def from_constants(
    gain: float,
    numerator_s: Sequence[float],
    denominator_s: Sequence[float],
    integrators: int = 0,
    *,
    input: str = "error",
    output: str = "command",
    units: Mapping[str, str] | None = None,
) -> Compensator:
    """Return gain prod (1 + a s) / (prod (1 + b s) s^integrators) for the time constants a and b in seconds.

    Raises SignalError for a time constant that is not positive and as `Compensator`.
    """
    if not 0 <= integrators <= MAX_INTEGRATORS:
        raise SignalError(f"{integrators} integrators were asked for: give a number from 0 to {MAX_INTEGRATORS}")
    for v in (*numerator_s, *denominator_s):
        if not (np.isfinite(v) and v > 0):
            raise SignalError(f"the time constant {v} s is not positive and finite: leave the factor out or mend it")
    k = gain * float(np.prod([1.0, *numerator_s])) / float(np.prod([1.0, *denominator_s]))
    poles = (*(-1 / b for b in denominator_s), *(0.0,) * integrators)
    return Compensator(k, tuple(-1 / a for a in numerator_s), poles, Continuous(), input, output, units or {})


@arguments.checked
def tustin(compensator: Compensator, period_s: float, frequency: float) -> LeadLag:
    """Return the discretisation by the trapezoidal rule, with warped frequency: K_d(w) = K((2/T) tan(w T / 2)).

    Raises TimingError for a sampled compensator or when the frequency is not below Nyquist; SignalError for a
    pole at 2/T.
    """
    _check_sampling(compensator, period_s, frequency)
    with precise.precision():
        return _bilinear(compensator, period_s, frequency, flint.arb(2) / flint.arb(period_s), "tustin")


@arguments.checked
def prewarped(compensator: Compensator, period_s: float, frequency: float) -> LeadLag:
    """Return the trapezoidal rule prewarped to be exact at the `frequency` in rad/s; raises as `tustin`."""
    _check_sampling(compensator, period_s, frequency)
    with precise.precision():
        half = flint.arb(frequency) * flint.arb(period_s) / 2
        return _bilinear(compensator, period_s, frequency, flint.arb(frequency) / half.tan(), "prewarped tustin")


@arguments.checked
def matched(compensator: Compensator, period_s: float, frequency: float) -> LeadLag:
    """Return matched zeros and poles, with |K| matched at `frequency` in rad/s and the sign of K at low frequency.

    Raises TimingError as `tustin`; ModelError when the phases there then differ by a right angle or more.
    """
    _check_sampling(compensator, period_s, frequency)
    with precise.precision():
        T = flint.arb(period_s)
        missing = len(compensator.poles) - len(compensator.zeros)
        zeros = [*((flint.arb(z) * T).exp() for z in compensator.zeros), *[flint.arb(-1)] * missing]
        poles = [(flint.arb(p) * T).exp() for p in compensator.poles]
        here = evaluate(flint.arb(1), balls(compensator.zeros), balls(compensator.poles), flint.acb(0, frequency))
        ratio = here / evaluate(flint.arb(1), zeros, poles, flint.acb(0, flint.arb(frequency) * T).exp())
        if not ratio.real > 0:  # s and z = exp(s T) are on the same side of each zero and pole: equal signs
            raise ModelError(
                f"at {frequency:g} rad/s the matched compensator, with the sign of K at low frequency, has a phase "
                f"error of {_phase_error_degrees(ratio):.4g} degrees: match at a lower frequency, shorten the period, "
                "or use `prewarped`"
            )
        gain = flint.arb(compensator.gain) * abs(ratio)
        return _with_errors(
            compensator, _discrete_compensator(compensator, period_s, gain, zeros, poles), "matched", frequency
        )


@arguments.checked
def zero_order_hold(compensator: Compensator, period_s: float, frequency: float) -> LeadLag:
    """Return the exact discretisation with a zero-order hold at the input.

    Raises TimingError as `tustin`; ModelError as `precise.round_correctly`.
    """
    _check_sampling(compensator, period_s, frequency)
    return _with_errors(compensator, discretise.zero_order_hold(compensator.model, period_s), "held", frequency)


def _check_sampling(compensator: Compensator, period_s: float, frequency: float) -> None:
    if not isinstance(compensator.time, Continuous):
        raise TimingError(f"a compensator in {compensator.time} was given to be sampled: give the continuous one")
    Discrete(period_s)
    if not 0 < frequency * period_s < np.pi:
        raise TimingError(
            f"the frequency {frequency:g} rad/s is not between 0 and Nyquist, {np.pi / period_s:.6g} rad/s: "
            "give one between them or a shorter period"
        )


def _bilinear(compensator: Compensator, period_s: float, frequency: float, scale: flint.arb, method: str) -> LeadLag:
    zeros, poles = balls(compensator.zeros), balls(compensator.poles)
    for v in (*zeros, *poles):
        if abs(float((1 - v / scale).mid())) < 1e-9:
            raise SignalError(f"{float(v):g} 1/s is where the rule {method} goes to infinity: move it or the period")
    gain = flint.arb(compensator.gain)
    for z in zeros:
        gain *= scale - z
    for p in poles:
        gain /= scale - p
    z_zeros, z_poles = ([(scale + v) / (scale - v) for v in part] for part in (zeros, poles))
    z_zeros += [flint.arb(-1)] * (len(poles) - len(zeros))
    return _with_errors(
        compensator, _discrete_compensator(compensator, period_s, gain, z_zeros, z_poles), method, frequency
    )


def _discrete_compensator(
    like: Compensator, period_s: float, gain: flint.arb, zeros: Sequence[flint.arb], poles: Sequence[flint.arb]
) -> Compensator:
    g, z, p = (tuple(float(v.mid()) for v in part) for part in ([gain], zeros, poles))
    return Compensator(g[0], z, p, Discrete(period_s), like.input, like.output, like.units)


def _phase_error_degrees(ratio: flint.acb) -> float:
    return abs(float(ratio.arg().mid())) * 180 / np.pi


def _with_errors(compensator: Compensator, sampled: Compensator | StateSpace, method: str, frequency: float) -> LeadLag:
    """Return the discretisation with its errors at the frequency."""
    if isinstance(sampled, Compensator):
        discrete, gain = sampled.model, sampled.gain
        zeros: tuple[complex, ...] = sampled.zeros
        poles: tuple[complex, ...] = sampled.poles
    else:
        discrete, poles = sampled, tuple(np.diag(sampled.A).tolist())
        gain, zeros = zeros_and_gain(sampled)
    z = np.exp(1j * frequency * discrete.time.period_s) if isinstance(discrete.time, Discrete) else np.nan
    ratio = complex(discrete.response(z)[0, 0, 0] / compensator.model.response(1j * frequency)[0, 0, 0])
    errors = (abs(ratio) - 1, float(np.degrees(np.angle(ratio))))
    return LeadLag(compensator, discrete, method, frequency, gain, zeros, poles, *errors)


def _chain(K: Compensator) -> StateSpace:
    """Return the sections in series; the input of a section is c x + d u, in `unit`."""
    n = len(K.poles)
    A, B = np.zeros((n, n)), np.zeros((n, 1))
    c, d, unit = np.zeros(n), 1.0, K.units.get(K.input, "")
    states, units = [], dict(K.units)
    for k, p in enumerate(K.poles):
        A[k], B[k, 0] = c, d
        A[k, k] = p
        states.append(f"{K.output}_section{k + 1}")
        after = f"{unit} s" if unit and isinstance(K.time, Continuous) else unit
        units |= {states[-1]: after} if after else {}
        if k < len(K.zeros):
            c[k] = p - K.zeros[k]
        else:
            c, d, unit = np.eye(n)[k], 0.0, after
    C, D = K.gain * c[None], np.array([[K.gain * d]])
    return StateSpace(A, B, C, D, tuple(states), (K.input,), (K.output,), K.time, units)
