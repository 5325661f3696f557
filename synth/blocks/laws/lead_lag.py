"""Lead-lag control of a position with integral action, whose integral follows the achieved demand, as a Block.

K(z) = D (z - z1) (z - z2) / ((z - p) (z - 1)) is a lead filter V and an integral I, whose zero is z2:

    d = w + I,   I+ = z2 I + (1 - z2) d_a,    w = D e + V,   V+ = p V + D (p - z1) e,       e = set-point - position

d_a is the demand that the actuators achieve. While d_a = d this is d = w (z - z2) / (z - 1). At a limit I converges to
d_a with the time constant of the zero. This is anti-windup without a separate limit of the integral.
"""

from dataclasses import dataclass

from synth import arguments
from synth.block import Block, Constant, Exprs, State, Step, build
from synth.errors import SignalError, TimingError
from synth.law import label
from synth.signals import Signal
from synth.synthesise.classical import lead_lag
from synth.timing import Discrete

MARGIN = 1.01  # of the states' ranges over their bounds, more than rounding
AT_ZERO = 1e-12  # a pole this near to 0 in z is 0


@dataclass(frozen=True)
class Loop:
    """The signals of a loop; `scale` is the gain's unit of demand, and `achievable` bounds the achieved demand."""

    position: Signal
    set_point: Signal
    demand: Signal
    achieved: Signal
    scale: float
    achievable: float


@arguments.checked
def pole(K: lead_lag.LeadLag) -> float:
    """Return the pole in z beside the integrator, 0 where it was at 2/T.

    Raises SignalError for a compensator other than two zeros, a stable pole and, last, an integrator, all real.
    """
    real = not any(v.imag for v in (*K.zeros, *K.poles))
    if not (real and len(K.zeros) == len(K.poles) == 2 and K.poles[1] == 1 and abs(K.poles[0]) < 1):
        raise SignalError(
            f"the compensator has zeros {K.zeros} and poles {K.poles} in z: the loop needs two real zeros, a stable "
            "real pole and, last, an integrator, as `lead_lag.tustin` of k (s - z1) (s - z2) / ((s - p) s)"
        )
    p = float(K.poles[0].real)
    return p if abs(p) > AT_ZERO else 0.0


@arguments.checked
def block(name: str, time: Discrete, K: lead_lag.LeadLag, of: Loop, source: str) -> Block:
    """Return the Block of one loop, from the position, the set-point and the achieved demand to the demand.

    K has two zeros, the second one that of the integral, a pole and an integrator, in this order. Both states stay in
    their ranges while the position does and the achieved demand is `achievable`. `source` names the equation.

    Raises SignalError for a compensator as `pole`, for a zero of the integral outside +-1, for a `scale` or an
    `achievable` that is not positive and finite, and as `block.build`; TimingError for a compensator of another period.
    """
    p = pole(K)
    z1, z2 = (float(z.real) for z in K.zeros)
    if K.discrete.time != time:
        raise TimingError(f"the compensator is for {K.discrete.time} and the Block for {time}: discretise it for that")
    if abs(z2) >= 1:
        raise SignalError(f"the zero of the integral is {z2:g} in z: give a compensator with this zero inside +-1")
    for quantity, value in (("scale", of.scale), ("achievable", of.achievable)):
        if not 0 < value < float("inf"):
            raise SignalError(f"{quantity} of the loop: found {value}; give a positive number")
    gain, lead_input = (v / of.scale for v in (K.gain, K.gain * (p - z1)))
    error = max(of.set_point.high - of.position.low, of.position.high - of.set_point.low)
    most = MARGIN * abs(lead_input) * error / (1 - abs(p))
    integral, unit = MARGIN * of.achievable * abs(1 - z2) / (1 - abs(z2)), of.demand.unit
    states = [
        State(Signal("integral", unit, -integral, integral, "integral of the error"), 0.0),
        State(Signal("lead", unit, -most, most, "state of the lead filter"), 0.0),
    ]
    per = f"{unit}/{of.position.unit}"
    constants = [
        Constant("gain", gain, per, f"{source}: gain on the error"),
        Constant("lead_input", lead_input, per, f"{source}: gain times (lead_pole - zero)"),
        *([Constant("lead_pole", p, "1", f"{source}: pole of the lead filter in z")] if p else []),
        Constant("integral_decay", z2, "1", f"{source}: zero of the integral action in the z-domain"),
        Constant("integral_input", 1 - z2, "1", f"{source}: 1 - integral_decay"),
    ]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        error = u[of.set_point.name] - u[of.position.name]
        lead = k["lead_input"] * error + (k["lead_pole"] * x["lead"] if p else 0)
        integral = k["integral_decay"] * x["integral"] + k["integral_input"] * u[of.achieved.name]
        label(error=error)
        return Step(
            {of.demand.name: k["gain"] * error + x["lead"] + x["integral"]}, {"integral": integral, "lead": lead}
        )

    inputs, tag = [of.position, of.set_point, of.achieved], f"lead-lag, {source}"
    return build(name, time, law, inputs=inputs, outputs=[of.demand], states=states, constants=constants, tag=tag)
