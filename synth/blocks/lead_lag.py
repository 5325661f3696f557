"""Lead-lag control of a position with integral action, whose integral follows the achieved demand, as a Block.

K(z) = D (z - z1) (z - z2) / ((z - p) (z - 1)) is a lead filter V and an integral I, whose zero is z2:

    d = w + I,   I+ = z2 I + (1 - z2) d_a,    w = D e + V,   V+ = p V + D (p - z1) e,       e = set-point - position

d_a is the demand that the actuators achieve. While d_a = d this is d = w (z - z2) / (z - 1). At a limit I converges to
d_a with the time constant of the zero. This is anti-windup without a separate limit of the integral.
"""

from dataclasses import dataclass

from synth.block import Block, Constant, Exprs, State, Step, build
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


def pole(K: lead_lag.LeadLag) -> float:
    """Return the pole in z beside the integrator, 0 where it was at 2/T."""
    p = float(K.poles[0].real)
    return p if abs(p) > AT_ZERO else 0.0


def block(name: str, time: Discrete, K: lead_lag.LeadLag, of: Loop, source: str) -> Block:
    """Return the Block of one loop, from the position, the set-point and the achieved demand to the demand.

    K has two zeros, the second one that of the integral, a pole and an integrator, in this order. Both states stay in
    their ranges while the position does and the achieved demand is `achievable`. `source` names the equation.
    """
    (z1, z2), p = (float(z.real) for z in K.zeros), pole(K)
    gain, lead_input = (v / of.scale for v in (K.gain, K.gain * (p - z1)))
    most = MARGIN * abs(lead_input) * (of.position.high + of.set_point.high) / (1 - abs(p))
    integral, unit = MARGIN * of.achievable, of.demand.unit
    states = [
        State(Signal("integral", unit, -integral, integral, "integral of the error"), 0.0),
        State(Signal("lead", unit, -most, most, "state of the lead filter"), 0.0),
    ]
    per = f"{unit}/{of.position.unit}"
    constants = [
        Constant("gain", gain, per, f"{source}: gain on the error"),
        Constant("lead_input", lead_input, per, f"{source}: gain times (lead_pole - zero)"),
        *([Constant("lead_pole", p, "1", f"{source}: pole of the lead filter in z")] if p else []),
        Constant("integral_decay", z2, "1", f"{source}: zero of the integral action in z"),
        Constant("integral_input", 1 - z2, "1", f"{source}: 1 - integral_decay"),
    ]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        error = u[of.set_point.name] - u[of.position.name]
        lead = k["lead_input"] * error + (k["lead_pole"] * x["lead"] if p else 0)
        integral = k["integral_decay"] * x["integral"] + k["integral_input"] * u[of.achieved.name]
        return Step(
            {of.demand.name: k["gain"] * error + x["lead"] + x["integral"]}, {"integral": integral, "lead": lead}
        )

    inputs, tag = [of.position, of.set_point, of.achieved], f"lead-lag, {source}"
    return build(name, time, law, inputs=inputs, outputs=[of.demand], states=states, constants=constants, tag=tag)
