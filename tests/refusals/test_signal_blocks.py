"""Refusals of the Blocks between readings, set-points and actuators: filters and unwrapping."""

import numpy as np

from synth.blocks.estimate import unwrap
from synth.blocks.laws import biquad, jerk_limited
from synth.errors import ModelError, SignalError
from synth.signals import Signal
from tests.refusals.table import call, refusals

SIGNAL = [
    *(call(biquad.block, "between 0 and 314.159 rad/s", poles=p) for p in ((0.0, 0.7), (315.0, 0.7), (30.0,))),
    call(biquad.block, "the zeros of the biquad are (30.0, nan): give their", zeros=(30.0, np.nan)),
    call(biquad.block, "the damping of the poles of the biquad is 0: give one above 0", poles=(30.0, 0.0)),
    call(biquad.block, "the damping of the zeros of the biquad is -0.1", zeros=(30.0, -0.1)),
    call(biquad.block, "the gain of the biquad is inf", gain=np.inf),
    *(
        call(unwrap.block, "below half a span, 1.5 m, or a turn is miscounted", **changed)
        for changed in ({"speed": 60.0}, {"speed": 0.0}, {"speed": np.nan}, {"bad_samples": 0})
    ),
    call(jerk_limited.block, "the limit of the velocity of 'name' is 0.0: give", velocity=0.0),
    call(jerk_limited.block, "the limit of the jerk of 'name' is inf: give", jerk=np.inf),
    call(jerk_limited.block, "the jerk 3000 reaches the acceleration 20 within a sample of 0.01 s", jerk=3000.0),
    call(jerk_limited.block, "the acceleration 20 reaches the velocity 0.1 within", velocity=0.1),
    call(jerk_limited.block, "'p' is in rad and 'gap' in m", measured=Signal("p", "rad", -1, 1)),
    call(unwrap.block, "starts over after 0.01: give a span of at least the width", span=0.01),
    call(unwrap.block, "starts over after inf: give a span", span=np.inf),
    call(unwrap.block, "'p' is in rad and 'gap' in m", position=Signal("p", "rad", -10, 10)),
    call(unwrap.block, "give one that contains the reading's, 0.01 .. 0.03", position=Signal("p", "m", 0.02, 10)),
    call(unwrap.block, "and 16777216 spans at most", position=Signal("p", "m", -1e9, 1e9)),
]
MODEL = [
    call(biquad.block, "a mode of them has |z| = 0.9999999", poles=(1e-5, 0.7)),
]

test_a_call_of_a_block_on_signals_raises_a_signal_error = refusals(SignalError, SIGNAL)
test_a_call_of_a_block_on_signals_raises_a_model_error = refusals(ModelError, MODEL)
