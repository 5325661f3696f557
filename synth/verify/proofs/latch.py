"""Test of the fault latch of compiled C: each output slews to its safe value within the declared slew rate.

    latched from sample L on:   |y_k - y_{k-1}| <= s T,      y_k = safe value for all k >= L + (high - low)/(s T)

Before the latch, random inputs over their full ranges drive the outputs away from their safe values. Then every input
becomes NaN.
"""

from math import ceil

import numpy as np

from synth.block import LATCH_BIT
from synth.check import Check
from synth.execute import host
from synth.verify import stimuli

SEED, RUNS, BEFORE = 31, 8, 50  # runs of random inputs, and samples of each before the loss of measurement
MAX_SLEW_SAMPLES = 100_000  # samples of a slew
ROUNDING = 16  # of a change of the output, in units in the last place of its range


def verify(controller: host.Controller) -> tuple[Check, ...]:
    """Return for each output with a safe value its fastest slew after the latch and its final distance from it."""
    safety = controller.manifest.get("safety")
    if not safety or not safety["safe_output"]:
        return ()
    period, rng = controller.period_s, np.random.default_rng(SEED)
    fields = {f["name"]: f for f in controller.manifest["structs"]["output"]["fields"]}
    span = {n: fields[n]["high"] - fields[n]["low"] for n in safety["safe_output"]}
    slews = [ceil(span[n] / (rate * period)) for n, rate in safety["slew_per_s"].items()]
    after = safety["bad_samples"] + min(max(slews), MAX_SLEW_SAMPLES) + 2
    fastest, remaining = dict.fromkeys(span, 0.0), dict.fromkeys(span, 0.0)
    for _ in range(RUNS):
        replay = controller.replay(stimuli.loss_of_measurement(controller, BEFORE, after, rng))
        latched = int(np.argmax(replay.faults >> LATCH_BIT & 1))
        for name, target in safety["safe_output"].items():
            y = np.asarray(replay.outputs[name], dtype=np.float64)
            moves = np.abs(np.diff(y[max(latched - 1, 0) :]))
            fastest[name] = max(fastest[name], float(moves.max()) / period)
            remaining[name] = max(remaining[name], abs(float(y[-1]) - float(controller.scalar(target))))
    eps = float(np.finfo(controller.scalar).eps)
    checks = []
    for name, rate in safety["slew_per_s"].items():
        unit, rounding = fields[name]["unit"], ROUNDING * eps * span[name]
        checks.append(Check(f"latched: {name} slews at", fastest[name], rate + rounding / period, f"{unit}/s"))
        checks.append(Check(f"latched: {name} ends from its safe value by", remaining[name], rounding, unit))
    return tuple(checks)
