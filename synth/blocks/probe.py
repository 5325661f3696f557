"""Probe of a sensor at rest: a doublet pair of acceleration moves the body by more than the resolution.

    +a for n samples, -a for 2 n, +a for n:   the body moves by a (n T)^2 and stands still again, there and back

At rest the reading of a working sensor stays in one count only while nothing moves the body. After `quiet` samples
without a change the probe moves it by `displacement`, with a margin over the resolution that covers the error of the
demand's gain. A code that does not change in the probe either is frozen. A sensor whose code changes is not probed.
Friction F of a mass m allows no motion while a <= F/m: choose n so short that a is above it.

Library: no shipped design uses it. On `maglev_5dof` its motion broke the requirement of one count at rest.

Source: active fault diagnosis; Campbell, Nikoukhah, *Auxiliary Signal Design for Failure Detection*, 2004, chapter 1.
"""

from dataclasses import dataclass

import casadi as ca

from synth import arguments
from synth.block import Block, Exprs, Step, build, clip
from synth.errors import SignalError
from synth.signals import Signal
from synth.timing import Discrete

__all__ = ["Probe", "block"]

ANSWER = 3  # samples from the end of a probe to the last answer: delay, rounding of the sensor, one more


@arguments.checked
@dataclass(frozen=True)
class Probe:
    """Samples without a change before it, samples n of a quarter, and the displacement a (n T)^2."""

    quiet: int
    quarter: int
    displacement: float

    @property
    def samples(self) -> int:
        """Samples without a change after which a sensor is frozen."""
        return self.quiet + 4 * self.quarter + ANSWER


@arguments.checked
def block(time: Discrete, sensor: str, demand: Signal, probe: Probe) -> Block:
    """Return the Block from ``<w>_unprobed`` and ``<sensor>_unchanged`` to the demand w.

    Raises SignalError for samples below 1 or a displacement that is not positive.
    """
    if probe.quiet < 1 or probe.quarter < 1 or not probe.displacement > 0:
        raise SignalError(f"the probe of '{sensor}' is {probe}: give at least 1 sample and a positive displacement")
    a = probe.displacement / (probe.quarter * time.period_s) ** 2

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        w, since = u[f"{demand.name}_unprobed"], u[f"{sensor}_unchanged"] - probe.quiet
        inner = ca.logic_and(since >= probe.quarter, since < 3 * probe.quarter)
        pulse = ca.if_else(since < 4 * probe.quarter, ca.if_else(inner, -a, a), 0.0)
        return Step({demand.name: ca.if_else(u[f"{sensor}_unchanged"] >= probe.quiet, clip(w + pulse, demand), w)})

    unchanged = Signal(f"{sensor}_unchanged", "1", 0, 1e6, "samples without a change of the code")
    plain = Signal(f"{demand.name}_unprobed", demand.unit, demand.low, demand.high, demand.about)
    return build(f"probe_{sensor}", time, law, inputs=[plain, unchanged], outputs=[demand], tag="probe at rest")
