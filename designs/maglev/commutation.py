"""Commutation of the four motors: from direct and quadrature currents and the position to twelve phase currents.

    guard -> advance -> commutation        i_a = sqrt(2) (i_d cos th - i_q sin th), b and c at th -+ 120 degrees

Motors 2 and 4 lie along X, motors 1 and 3 along Z; th = pi s/tau + pi/2. The angle is that of the position at which the
current acts, ADVANCE samples after the measurement; `advance=0` is the commutation at the measured position.

The controller gives the position: the reading, or the prediction while the encoder is refused. After the latch nothing
predicts it, and the controller gives a value out of range, which is refused here.

Currents for a wrong angle are worse than none: a direct current that repels the platen also pushes it sideways, away
from the assumed angle. While the position along an axis is lost, its motors therefore hand their direct currents over
to those of the other axis, which keeps the sum, and fade out in FADE samples. Without any current the magnets pull the
platen up from its upper range. While both positions are lost, the motors that carry therefore keep their angles for
DESCENT samples, in which the safe output of the controller lowers the platen to its stop, and then fade out. Once a
position is known again they fade in as slowly.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import hypot, sqrt

import casadi as ca

from designs.maglev.handover import (
    CURRENT_LIMIT,
    FADE,
    FADE_STEP,
    OF_AXIS,
    TRANSFER,
    next_transfer,
    parts,
    with_taken_over,
)
from designs.maglev.platen import (
    BAD_SAMPLES,
    COMMUTATED,
    CURRENT,
    INTERFACE,
    MOTORS,
    OUTPUTS,
    SAFE_CURRENT,
    TIME,
)
from models import maglev_phases, maglev_stage
from synth.block import Block, Certificate, Constant, Exprs, State, Step, build, clip
from synth.blocks.estimate import advance, phasor
from synth.blocks.estimate.glsdc import NamedExpressions
from synth.blocks.guard import safety
from synth.composition import compose
from synth.fault import Fault
from synth.law import label
from synth.plant import Plant
from synth.signals import Signal, signal_names

ADVANCE = INTERFACE.delay + 0.5  # samples from the measurement to the middle of the time in which its current acts
DESCENT = 80  # samples: the safe output reaches the lower stop from 18.1 mm in 71 samples
ROUNDING = 1e-4  # of PEAK: what rounding and polynomials may add to a phase, see `_phase_bound`
PEAK = sqrt(2) * hypot(CURRENT, CURRENT) * (1 + ROUNDING)  # A, both inputs at their limits
SAMPLED = "of the sample of the currents"
ALONG = {n: replace(INTERFACE.signals[n], about=f"{INTERFACE.signals[n].about}, {SAMPLED}") for n in OF_AXIS}
SPEED = {n: next(s.high for s in maglev_stage.STATES if s.name == f"v{n}") for n in OF_AXIS}  # m/s
UNKNOWN = Signal(
    "unknown",
    "1",
    0,
    DESCENT + FADE,
    "samples with both positions lost, less those with one",
)
PHASES = tuple(replace(s, low=-PEAK, high=PEAK, about=f"{s.about}, instantaneous") for s in maglev_phases.PHASES)
NUMBERS = [
    Constant("gone_samples", DESCENT + FADE, "1", "samples until the currents have faded out", ("unknown",)),
    FADE_STEP,
    CURRENT_LIMIT,
]
HELD = {s.name: replace(s, name=f"{s.name}_held") for s in OUTPUTS}


def positions(samples: float = ADVANCE) -> Block:
    """Return the Block from the guarded positions to those when the currents act; a lost one has its fault bit."""
    along = [advance.Position(s, SPEED[n]) for n, s in ALONG.items()]
    block = advance.block(TIME, along, samples, BAD_SAMPLES)
    faults = [
        Fault(len(HELD) + len(ALONG) + i, advance.lost(s).name, about=_meaning(n))
        for i, (n, s) in enumerate(ALONG.items())
    ]
    return replace(block, faults=tuple(faults))


def _meaning(axis: str) -> str:
    first, second = OF_AXIS[axis]
    return f"{axis}: lost; motors {first} and {second} hand their direct currents over and fade out"


def commutation(plant: Plant, samples: float = ADVANCE) -> Block:
    """Return the Block from the motors' currents and the acting positions to the phase currents (inverse Park)."""
    wave = 2 * plant.parameter("tau").value
    acting, lost = ({n: f(s) for n, s in ALONG.items()} for f in (lambda s: advance.acting(s, samples), advance.lost))

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        named: NamedExpressions = []
        certified: dict[str, Certificate] = dict.fromkeys(signal_names(PHASES), _phase_bound)
        waves: dict[str, phasor.Phasor] = {}
        numbers = [*NUMBERS]
        for n, s in acting.items():
            distance = phasor.within_period(u[s.name], s, wave, n)
            named.append((distance.signal, distance.value))
            certified[distance.signal.name] = distance.certificate
            numbers += distance.numbers
            turned = phasor.by_quarter_angle(
                distance.value, -wave, n, named, sqrt(2)
            )  # th is 90 degrees less its angle
            waves[n] = phasor.Phasor(turned.sine, turned.cosine)
            label(n, wave=waves[n])
        direct, waves, next = _handover(u, x, [u[s.name] for s in lost.values()], waves)
        output: dict[str, ca.SX] = {}
        for j, n in zip(MOTORS, maglev_phases.ALONG, strict=True):
            current = phasor.Phasor(direct[j], u[f"i_q{j}_held"]).times(waves[n])
            half, other = current.cosine / 2, sqrt(3) / 2 * current.sine
            output |= {f"i_a{j}": current.cosine, f"i_b{j}": other - half, f"i_c{j}": -half - other}
            label(str(j), current=current, half=half, other=other)
        label(kept=waves, direct=direct)
        return Step({s.name: clip(output[s.name], s) for s in PHASES}, next, named, certified, numbers)

    return build(
        "commutation",
        TIME,
        law,
        inputs=[*HELD.values(), *acting.values(), *lost.values()],
        outputs=PHASES,
        states=[State(TRANSFER, 0.0), State(UNKNOWN, 0, True)],
        tag="phase currents, inverse Park",
    )


def _handover(
    u: Exprs, x: Exprs, lost: Sequence[ca.SX], waves: Mapping[str, phasor.Phasor]
) -> tuple[dict[int, ca.SX], dict[str, phasor.Phasor], dict[str, ca.SX]]:
    """Return the direct currents to commutate by motor, the phasors times the shares of their motors, and next states.

    While no position is lost, nothing is handed over and nothing has faded, they stay as they are.
    """
    transfer, both = x["transfer"], ca.logic_and(*lost)
    active = ca.logic_or(ca.logic_or(*lost), ca.logic_or(ca.fabs(transfer) > 0, x["unknown"] >= 1))
    next = next_transfer(transfer, lost[0], lost[1], both)
    longer = ca.if_else(x["unknown"] >= DESCENT + FADE, x["unknown"], x["unknown"] + 1)
    known_again = ca.if_else(x["unknown"] >= 1, x["unknown"] - 1, 0)  # what has faded out fades in
    unknown = ca.if_else(both, longer, known_again)
    whole = ca.fmin((DESCENT + FADE - x["unknown"]) / FADE, 1)
    part, kept = parts(next), {}
    before, quadrature = ({j: u[f"i_{axis}{j}_held"] for j in MOTORS} for axis in "dq")
    taken = with_taken_over(before, quadrature, part)
    direct = {j: ca.if_else(active, i, before[j]) for j, i in taken.items()}
    for n, wave in waves.items():
        share = whole * (1 - part[n])
        kept[n] = phasor.Phasor(*(ca.if_else(active, share * v, v) for v in (wave.cosine, wave.sine)))
        label(n, share=share)
    label(whole=whole, part=part, active=active, both=both)
    return direct, kept, {"transfer": ca.if_else(active, next, 0), "unknown": ca.if_else(active, unknown, 0)}


def _phase_bound(u: float, e: float) -> float:
    """Return a bound on a phase current in A, for a relative rounding error u and a relative error e of the sines.

    The doublings make a unit vector of any sine, so e only affects its angle; rounding changes its length by at most
    18 u while 1 - sin^2 >= 0.4. The factor sqrt(2), the share, the product with the currents and the sums add 14 u.
    """
    return sqrt(2) * hypot(CURRENT, CURRENT) * (1 + e) * (1 + 32 * u)


def phase_currents(name: str, plant: Plant, samples: float = ADVANCE) -> Block:
    """Return the Block from the motors' currents and the position to 12 phase currents, behind the controller `name`.

    Bad inputs are held. This Block does not latch; the controller that computes the currents does.
    """
    guarded = [safety.GuardedInput(s, SAFE_CURRENT if s.name.startswith("i_d") else 0.0, False) for s in OUTPUTS]
    guarded += [safety.GuardedInput(s, 0.0, False) for s in ALONG.values()]
    blocks = [safety.guard(TIME, guarded, BAD_SAMPLES), positions(samples), commutation(plant, samples)]
    inputs = signal_names(g.signal for g in guarded)
    block = compose(f"{name}_phase", blocks, inputs=inputs, outputs=signal_names(PHASES))
    return block.renamed({n: s.name for n, s in COMMUTATED.items()})
