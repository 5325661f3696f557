"""prototype"""

from dataclasses import replace
from math import hypot, pi, sqrt

import casadi as ca

from designs.maglev_5dof import control
from designs.maglev_5dof.control import BAD_SAMPLES, CURRENT, INTERFACE, MOTORS, NAME, OUTPUTS, SAFE_CURRENT, TIME
from models import maglev_stage
from synth.block import Block, Exprs, State, Step, build, clip
from synth.blocks import phasor, safety
from synth.composition import compose
from synth.plant import Plant
from synth.signals import Signal, signal_names

ADVANCE = INTERFACE.delay + 0.5
SPEED = 1.0
STRIDE = SPEED * TIME.period_s
PEAK = sqrt(2) * hypot(CURRENT, CURRENT) * (1 + 1e-4)
PHASES = tuple(Signal(f"i_{p}{j}", "A", -PEAK, PEAK, f"phase {p} of motor {j}, instantaneous") for j in MOTORS for p in "abc")
ALONG = tuple(INTERFACE.signals[n] for n in "xz")


def advance() -> Block:
    acting = {s.name: replace(s, name=f"{s.name}_acting", low=s.low - ADVANCE*STRIDE, high=s.high + ADVANCE*STRIDE) for s in ALONG}

    def law(u, x, k):
        output, after = {}, {}
        for s in ALONG:
            limit = Signal("stride", "m", -STRIDE, STRIDE)
            measured, last = u[f"{s.name}_held"], x[f"last_{s.name}"]
            known = x[f"known_{s.name}"]
            stride = ca.if_else(known, clip(measured - last, limit), 0)
            position = ca.if_else(known, last + stride, measured)
            output[f"{s.name}_acting"] = position + ADVANCE * stride
            after[f"last_{s.name}"] = position
            after[f"known_{s.name}"] = ca.if_else(u[f"fault_{s.name}"], known, 1)
        return Step(output, after)
    states = [State(replace(s, name=f"last_{s.name}"), 0.0) for s in ALONG]
    states += [State(Signal(f"known_{s.name}", "1", 0, 1), 0, True) for s in ALONG]
    inputs = [i for s in ALONG for i in (INTERFACE.held(s.name), Signal(f"fault_{s.name}", "1", 0, 1))]
    return build("advance", TIME, law, inputs=inputs, outputs=list(acting.values()), states=states)


def commutation(plant):
    tau = plant.parameter("tau").value
    held = [replace(s, name=f"{s.name}_held") for s in OUTPUTS]
    reach = 0.1 + ADVANCE*STRIDE

    def law(u, x, k):
        named, certified, waves = [], {}, {}
        for n in "xz":
            d = phasor.within_period(u[f"{n}_acting"], reach, 2 * tau, n)
            named.append((d.signal, d.value)); certified[d.signal.name] = d.certificate
            waves[n] = phasor.by_quarter_angle(d.value, 2 * tau, n, named).quarter_turn()
        output = {}
        for j, thrust in enumerate(maglev_stage.QUADRATURE, 1):
            w = waves[thrust[-1]]
            i_d, i_q = u[f"i_d{j}_held"], u[f"i_q{j}_held"]
            alpha = sqrt(2) * (i_d * w.cosine - i_q * w.sine)
            beta = sqrt(1.5) * (i_d * w.sine + i_q * w.cosine)
            half = alpha / 2
            output |= {f"i_a{j}": alpha, f"i_b{j}": beta - half, f"i_c{j}": -half - beta}
        output = {s.name: clip(output[s.name], s) for s in PHASES}
        bound = lambda u, e: sqrt(2)*hypot(CURRENT, CURRENT)*(1+e)*(1+32*u)
        return Step(output, named=named, certified=certified | dict.fromkeys(output, bound))
    acting = [Signal(f"{n}_acting", "m", -reach, reach) for n in "xz"]
    return build("commutation", TIME, law, inputs=[*held, *acting], outputs=PHASES)


def phase_currents(plant):
    guarded = [safety.GuardedInput(s, SAFE_CURRENT if s.name.startswith("i_d") else 0.0, False) for s in (*OUTPUTS, *ALONG)]
    blocks = [safety.guard(TIME, guarded, BAD_SAMPLES), advance(), commutation(plant)]
    return compose(f"{NAME}_phase", blocks, inputs=signal_names(g.signal for g in guarded), outputs=signal_names(PHASES))
