"""Anti-windup by back-calculation: feedback of the actuators' excess over the commands.

    x_c' = A x_c + B w + E (u_limited - u),    u = C x_c + D w          (x_c+ in discrete time)

Without saturation the excess is zero. While all actuators are saturated, x_c' = (A - E C) x_c + ..; E must make this
stable. While only some are saturated, the plant takes part, and nothing is certified.

back_calculation   E for the internal model of a servo regulator: all eigenvalues of I (x) Phi - E K_xi keep the
                   frequencies of the modes and decay at one rate a. E is the gain of an observer of xi from u: with
                   F = I (x) Phi + (a / 2) I, which has no decaying mode, E = Z^-1 K_xi' V^-1 and
                   F' Z + Z F = K_xi' V^-1 K_xi (Bass), in the real Jordan form of Phi. In discrete time likewise with
                   F = I (x) Phi exp(a T / 2).
"""

from collections.abc import Sequence
from dataclasses import replace

import flint
import numpy as np

from synth import arguments, show
from synth.analyse.numerics import precise
from synth.analyse.numerics.magnitude import equilibrated
from synth.errors import ModelError, SignalError
from synth.statespace import Array, Complex, StateSpace, readonly
from synth.synthesise.regulation import internal_model, regulator_equations
from synth.synthesise.regulation.servo import Servo
from synth.synthesise.riccati import exact, weights
from synth.timing import Continuous

DEADBEAT_DECAY = 40.0  # a T: exp(-40) is below the rounding error of a pole


@show.result
class AntiWindup:
    """E (k, m), from the excess of each command to the controller's states.

    `controller` has the additional inputs ``<control>_excess``; `eigenvalues` are those of A - E C,
    with E as rounded, computed in ball arithmetic.
    """

    E: Array
    controller: StateSpace
    eigenvalues: Complex

    def sheet(self) -> show.Sheet:
        """Return E and the eigenvalues while all commands are limited."""
        model = self.controller
        excess = model.inputs[len(model.inputs) - self.E.shape[1] :]
        values = ", ".join(show.number(s) for s in self.eigenvalues)
        line = f"With all actuators at their limits the controller has the eigenvalues {values}"
        return show.Sheet("Anti-windup", (line,), (show.matrix("E", self.E, model.labels(model.states), excess),))


@arguments.checked
def back_calculation(regulator: Servo, decay_per_s: float, V: weights.Weight | None = None) -> AntiWindup:
    """Return a servo regulator whose internal model decays at the rate a = `decay_per_s` during saturation.

    V (m, m) weights the commands: a large entry gives the excess of its command less effect. By default the commands
    are weighted by the size of their gains, independent of units. An observer continues with the limited commands. E is
    computed in ball arithmetic and each entry is rounded once, with the same result on every machine.

    Raises SignalError for a rate that is not positive or a V that is not definite; ModelError when the controller
    with limited commands is not stable.
    """
    rate, controls = _decay_rate(decay_per_s), regulator.controls
    weight = None if V is None else weights.definite("V", V, controls)
    E = _gain(regulator, rate, weight)
    no_gain = np.zeros((len(regulator.controller.A) - len(E), len(controls)))
    gain = readonly(np.vstack([E, no_gain]))
    mend = "choose a larger decay_per_s"
    if np.abs(E @ regulator.K_xi).max() > np.abs(regulator.model.Phi).max():
        mend = f"rounding of E decides its decay at {rate:g} 1/s: choose a smaller decay_per_s"
    return _with_excess_inputs(regulator.controller, gain, mend)


def _gain(regulator: Servo, rate: float, V: Array | None) -> Array:
    """Return E (p k, m) in the coordinates xi, each entry rounded once."""
    model, p = regulator.model, len(regulator.regulated)
    k = len(model.Phi)
    V = np.diag(1 / equilibrated(_modal_gains(regulator, rate))[1] ** 2) if V is None else V

    def compute() -> flint.arb_mat:
        C, V_balls, half = precise.matrix(regulator.K_xi), precise.matrix(V), flint.arb(rate) / 2
        form = internal_model.exact(model.modes, model.time)
        Phi = _copies(flint.arb_mat([[form[i, j] for j in range(k)] for i in range(k)]), p)
        weighted = V_balls.solve(C).transpose()
        if isinstance(model.time, Continuous):
            F = Phi + precise.identity(p * k) * half
            return exact.solution(-F, weighted * C, continuous=True).solve(weighted)
        inverse = (Phi * (half * flint.arb(model.time.period_s)).exp()).inv()
        Z = exact.solution(inverse, inverse.transpose() * weighted * C * inverse, continuous=False)
        X = Z.solve(C.transpose())
        return (V_balls + C * X).solve((Phi * X).transpose()).transpose()

    try:
        return precise.round_correctly(compute, "the anti-windup gain")
    except ZeroDivisionError as error:
        if not isinstance(model.time, Continuous) and rate * model.time.period_s > DEADBEAT_DECAY:
            periods = rate * model.time.period_s
            raise ModelError(
                f"the rate of {rate:g} 1/s times the period of {model.time.period_s:g} s is {periods:g}, and the gain "
                f"for it needs more digits than are computed; a decay by exp(-{DEADBEAT_DECAY:g}) in a period is "
                f"deadbeat already: give a decay_per_s of {DEADBEAT_DECAY / model.time.period_s:g} 1/s or less"
            ) from error
        raise ModelError(
            "a mode of the internal model is not observable in the commands, and no E stabilises it: give the "
            "regulator a gain K_xi on each mode"
        ) from error


def _modal_gains(regulator: Servo, rate: float) -> Array:
    """Return K_xi in modal coordinates, each column scaled by the size of its mode."""
    modes, p = regulator.model.modes, len(regulator.regulated)

    def compute() -> flint.arb_mat:
        return precise.matrix(regulator.K_xi) * _copies(regulator_equations.modal_matrix(modes, rate), p)

    C = precise.round_correctly(compute, "the gain on the modes")
    return C / _mode_sizes(C, [mode.order for mode in modes] * p)


def _copies(F: flint.arb_mat, p: int) -> flint.arb_mat:
    """Return I (x) F with p copies."""
    k = F.nrows()
    return flint.arb_mat([[F[i % k, j % k] if i // k == j // k else 0 for j in range(p * k)] for i in range(p * k)])


def _with_excess_inputs(model: StateSpace, gain: Array, mend: str) -> AntiWindup:
    excess = tuple(f"{name.removesuffix('_command')}_excess" for name in model.outputs)
    units = {end: model.unit(name) for end, name in zip(excess, model.outputs, strict=True) if model.unit(name)}
    with_excess = replace(
        model,
        B=np.hstack([model.B, gain]),
        D=np.hstack([model.D, np.zeros((len(excess), len(excess)))]),
        inputs=(*model.inputs, *excess),
        units={**model.units, **units},
    )
    ball = exact.ball
    with precise.precision():
        held_A = ball(model.A) - ball(gain) * ball(model.C)
        values = exact.eigenvalues(held_A)
        pole = exact.exact_unstable_pole(held_A, model.time)
    if pole is not None:
        raise ModelError(
            f"while its commands are held the controller has the eigenvalue {show.number(pole)}, which does not "
            f"decay by more than rounding errors of A - E C, and it winds up: {mend}"
        )
    return AntiWindup(readonly(gain), with_excess, values)


def _mode_sizes(C: Array, orders: Sequence[int]) -> Array:
    """Return a scale for each column of C, equal for all columns of a mode, that makes all modes of similar size."""
    first = np.cumsum([0, *orders[:-1]])
    whole = np.sqrt(np.add.reduceat((C**2).sum(axis=0), first))
    return np.repeat(np.where(whole > 0, whole, 1.0), orders)


def _decay_rate(decay_per_s: float) -> float:
    rate = arguments.real("rate decay_per_s", decay_per_s)
    if rate.ndim or not (np.isfinite(rate) and rate > 0):
        raise SignalError(f"the anti-windup decays at {decay_per_s} 1/s: give a finite rate above 0")
    return float(rate)
