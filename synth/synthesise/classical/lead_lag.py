"""Lead-lag compensators by zeros, poles and gain (MATLAB `zpk`), and their discretisation by the trapezoidal rule.

    K(s) = k prod (s - z_i) / prod (s - p_i),          real zeros z_i and poles p_i, at most as many zeros as poles

A compensator may also be given by time constants, k (1 + a s) / (1 + b s) (1 + c s) / s; PI is k (1 + c s) / s, and PD
with its filter k (1 + a s) / (1 + b s). Either method (`c2d`) returns K_d(z) of the same order for the period T:

    tustin            s = (2 / T) (z - 1) / (z + 1)
    prewarped         s = (w / tan(w T / 2)) (z - 1) / (z + 1),      K_d = K at the frequency w

Both map an integrator to z = 1. If K has more poles than zeros, they map its zeros at infinity to z = -1, and K_d has a
direct term. A K with more zeros than poles is not proper and raises an error.

Each number is computed in ball arithmetic and rounded once. The state-space model is a series connection of sections
x' = p x + u, y = (p - z) x + u, one for each pole in the given order, followed by the gain.

Source: Franklin, Powell, Workman, "Digital Control of Dynamic Systems", chapter 6. Examples of both forms: Yu, Kim,
"Design of Precision Positioner with Hall-effect Sensors and Multivariable Control Methodology", (21) and (23).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import flint
import numpy as np

from synth import arguments, show
from synth.analyse.numerics import precise
from synth.errors import SignalError, TimingError
from synth.statespace import StateSpace
from synth.timing import Continuous, Discrete, Time

MAX_INTEGRATORS = 10  # a loop with more integrators has no phase margin at any crossover


@arguments.checked
@show.with_repr
@dataclass(frozen=True, repr=False)
class Compensator:
    """A compensator K by gain, zeros and poles; these are rates in 1/s, or values of z if `time` is discrete.

    `units` maps the names of input and output to their units.

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
        for quantity, values in (("gain", (self.gain,)), ("zeros", self.zeros), ("poles", self.poles)):
            for v in values:
                if isinstance(v, complex) or not np.isfinite(v):
                    raise SignalError(f"{quantity} of the compensator: found {v}; give real, finite numbers")
        if self.gain == 0:
            raise SignalError("the compensator's gain is 0: give another gain")
        if len(self.zeros) > len(self.poles):
            raise SignalError(
                f"the compensator has {len(self.zeros)} zeros but {len(self.poles)} poles, which would differentiate "
                "its input without bound: for each excess zero, add a filter pole beyond the crossover"
            )

    @property
    def model(self) -> StateSpace:
        """The series connection of sections as a StateSpace with one state for each pole."""
        return _series_connection(self)

    def sheet(self) -> show.Sheet:
        """Return gain, zeros and poles."""
        variable = "1/s" if isinstance(self.time, Continuous) else "z"
        rows = [("gain", show.number(self.gain, 8))]
        rows += [(f"zero [{variable}]", show.number(v, 8)) for v in self.zeros]
        rows += [(f"pole [{variable}]", show.number(v, 8)) for v in self.poles]
        signals = " to ".join(show.with_unit(name, self.units.get(name, "")) for name in (self.input, self.output))
        equation = show.ratio("K", "s" if variable == "1/s" else "z", self.gain, self.zeros, self.poles)
        table = show.Table("", ("", "value"), tuple(rows), equation=equation)
        return show.Sheet(f"Compensator in {self.time}, {signals}", (), (table,))


@show.result
class LeadLag:
    """A continuous compensator K and its discretisation K_d with `zeros`, `poles` and `gain` in z.

    The errors of K_d at `frequency` in rad/s are |K_d / K| - 1 and arg(K_d / K) in degrees, without the hold and the
    delay that follow K_d in a loop.
    """

    continuous: Compensator
    discrete: StateSpace
    method: str
    frequency: float
    gain: float
    zeros: tuple[float, ...]
    poles: tuple[float, ...]
    gain_error: float
    phase_error: float

    def sheet(self) -> show.Sheet:
        """Return both compensators side by side, and the errors."""
        rows = [("gain", show.number(self.continuous.gain, 8), show.number(self.gain, 8))]
        both = (("zero", self.continuous.zeros, self.zeros), ("pole", self.continuous.poles, self.poles))
        for name, continuous, sampled in both:
            for k in range(max(len(continuous), len(sampled))):
                left, right = (show.number(v[k], 8) if k < len(v) else "" for v in (continuous, sampled))
                rows.append((name, left, right))
        signals = " to ".join(self.discrete.labels((*self.discrete.inputs, *self.discrete.outputs)))
        line = (
            f"at {show.number(self.frequency)} rad/s ({show.number(self.frequency / (2 * np.pi))} Hz) the sampled one "
            f"has a relative gain error of {self.gain_error:.2e} and a phase error of {self.phase_error:.2e} degrees"
        )
        title = f"Lead-lag, {self.method}, {signals}, {self.discrete.time}"
        equation = show.ratio("K", "z", self.gain, self.zeros, self.poles)
        table = show.Table("", ("", "continuous [1/s]", "sampled [z]"), tuple(rows), equation=equation)
        return show.Sheet(title, (line,), (table,))


@arguments.checked
def from_time_constants(
    gain: float,
    numerator_constants_s: Sequence[float],
    denominator_constants_s: Sequence[float],
    integrators: int = 0,
    *,
    input: str = "error",
    output: str = "command",
    units: Mapping[str, str] | None = None,
) -> Compensator:
    """Return gain prod (1 + a s) / (prod (1 + b s) s^integrators) for the time constants a and b in seconds.

    a are those of the numerator, b those of the denominator. Raises SignalError for a time constant that is not
    positive, for a number of integrators that is negative or above MAX_INTEGRATORS, and as `Compensator`.
    """
    if not 0 <= integrators <= MAX_INTEGRATORS:
        raise SignalError(
            f"the compensator shall have {integrators} integrators: give a number from 0 to {MAX_INTEGRATORS}"
        )
    for v in (*numerator_constants_s, *denominator_constants_s):
        if not (np.isfinite(v) and v > 0):
            raise SignalError(f"the time constant {v} s is not positive and finite: correct it or leave its factor out")
    k = gain * float(np.prod([1.0, *numerator_constants_s])) / float(np.prod([1.0, *denominator_constants_s]))
    poles = (*(-1 / b for b in denominator_constants_s), *(0.0,) * integrators)
    return Compensator(k, tuple(-1 / a for a in numerator_constants_s), poles, Continuous(), input, output, units or {})


@arguments.checked
def tustin(compensator: Compensator, period_s: float, frequency: float) -> LeadLag:
    """Return the discretisation by the trapezoidal rule, which warps frequencies: K_d(w) = K((2/T) tan(w T / 2)).

    Raises TimingError for a sampled compensator or when the frequency is not below Nyquist; SignalError for a zero or
    pole at 2/T, which is mapped to infinity.
    """
    _check_sampling(compensator, period_s, frequency)
    with precise.precision():
        return _bilinear(compensator, period_s, frequency, flint.arb(2) / flint.arb(period_s), "tustin")


@arguments.checked
def prewarped(compensator: Compensator, period_s: float, frequency: float) -> LeadLag:
    """Return the discretisation by the trapezoidal rule with K_d = K at `frequency` in rad/s; raises as `tustin`."""
    _check_sampling(compensator, period_s, frequency)
    with precise.precision():
        half = flint.arb(frequency) * flint.arb(period_s) / 2
        return _bilinear(compensator, period_s, frequency, flint.arb(frequency) / half.tan(), "prewarped tustin")


def _check_sampling(compensator: Compensator, period_s: float, frequency: float) -> None:
    if not isinstance(compensator.time, Continuous):
        raise TimingError(
            f"the compensator to be sampled is in {compensator.time}, not continuous: give the continuous one"
        )
    Discrete(period_s)
    if not 0 < frequency * period_s < np.pi:
        raise TimingError(
            f"the frequency {frequency:g} rad/s is not between 0 and Nyquist, {np.pi / period_s:.6g} rad/s: "
            "give one between them or a shorter period"
        )


def _bilinear(compensator: Compensator, period_s: float, frequency: float, scale: flint.arb, method: str) -> LeadLag:
    zeros, poles = ([flint.arb(v) for v in roots] for roots in (compensator.zeros, compensator.poles))
    for v in (*zeros, *poles):
        if abs(float((1 - v / scale).mid())) < 1e-9:
            raise SignalError(
                f"{float(v):g} 1/s is mapped to infinity by the method {method}: move it or change the period"
            )
    gain = flint.arb(compensator.gain)
    for z in zeros:
        gain *= scale - z
    for p in poles:
        gain /= scale - p
    z_zeros, z_poles = ([(scale + v) / (scale - v) for v in roots] for roots in (zeros, poles))
    z_zeros += [flint.arb(-1)] * (len(poles) - len(zeros))
    return _with_errors(
        compensator, _discrete_compensator(compensator, period_s, gain, z_zeros, z_poles), method, frequency
    )


def _discrete_compensator(
    K: Compensator, period_s: float, gain: flint.arb, zeros: Sequence[flint.arb], poles: Sequence[flint.arb]
) -> Compensator:
    """Return a discrete compensator with the signals of K."""
    z_zeros, z_poles = (tuple(float(v.mid()) for v in roots) for roots in (zeros, poles))
    return Compensator(float(gain.mid()), z_zeros, z_poles, Discrete(period_s), K.input, K.output, K.units)


def _with_errors(compensator: Compensator, sampled: Compensator, method: str, frequency: float) -> LeadLag:
    """Return the discretisation with its errors at the frequency."""
    discrete = sampled.model
    z = np.exp(1j * frequency * discrete.time.period_s) if isinstance(discrete.time, Discrete) else np.nan
    ratio = complex(discrete.response(z)[0, 0, 0] / compensator.model.response(1j * frequency)[0, 0, 0])
    errors = (abs(ratio) - 1, float(np.degrees(np.angle(ratio))))
    return LeadLag(compensator, discrete, method, frequency, sampled.gain, sampled.zeros, sampled.poles, *errors)


def _series_connection(K: Compensator) -> StateSpace:
    """Return the sections in series.

    While the loop runs, c x + d u is the output of the sections so far and the input of the next one; `unit` is its
    unit.
    """
    n = len(K.poles)
    A, B = np.zeros((n, n)), np.zeros((n, 1))
    c, d, unit = np.zeros(n), 1.0, K.units.get(K.input, "")
    states, units = [], dict(K.units)
    for k, p in enumerate(K.poles):
        A[k], B[k, 0] = c, d
        A[k, k] = p
        states.append(f"{K.output}_section{k + 1}")
        state_unit = f"{unit} s" if unit and isinstance(K.time, Continuous) else unit
        units |= {states[-1]: state_unit} if state_unit else {}
        if k < len(K.zeros):
            c[k] = p - K.zeros[k]
        else:
            c, d, unit = np.eye(n)[k], 0.0, state_unit
    C, D = K.gain * c[None], np.array([[K.gain * d]])
    return StateSpace(A, B, C, D, tuple(states), (K.input,), (K.output,), K.time, units)
