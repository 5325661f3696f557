"""Signal chain of a Hall sensor: amplifier, anti-aliasing filter, noise and converter.

    B --> sensitivity --> amplifier --> filter w_c --> + --> converter --> number
                                            noise -----^

The filter is of first order, V_f' = w_c (V - V_f). The noise is that of V_f, and white before the filter: samples a
period T apart have the correlation exp(-w_c T), 0.208 at 800 Hz. At a speed v the filter lags by v / w_c, 0.8 um per
mm/s. The order of the filter and the converter are not printed. 16 bits over +-5 V have a step of 0.15 mV and an error
of 0.04 mV rms, beside the noise of 1 mV.

Source: Kawato, Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors", section
2.C.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import exp, pi, sqrt

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy import signal

from synth.analyse.loops.interconnect import connect
from synth.errors import ModelError
from synth.statespace import StateSpace, readonly
from synth.timing import Discrete

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Chain:
    """From flux density to numbers; raise ModelError unless all values are positive; the noise may be 0."""

    sensitivity: float = 0.4  # V/T: with 0.1, a noise of 1 mV would be 10 um, more than the paper claims
    amplifier: float = 21.0
    corner: float = 200.0  # Hz
    noise: float = 1e-3  # V rms, behind the filter
    bits: int = 16
    span: float = 5.0  # V to either side

    def __post_init__(self) -> None:
        for name in ("sensitivity", "amplifier", "corner", "bits", "span"):
            if not 0 < getattr(self, name) < float("inf"):
                raise ModelError(f"{name} of the chain is {getattr(self, name)}: it must be finite and positive")
        if not 0 <= self.noise < float("inf"):
            raise ModelError(f"noise of the chain is {self.noise} V: it must be finite and not negative")

    @property
    def gain(self) -> float:
        """Return the sensitivity of sensor and amplifier, V/T."""
        return self.sensitivity * self.amplifier

    @property
    def step(self) -> float:
        """Return the converter's step, V."""
        return 2 * self.span / 2**self.bits


def slope(chain: Chain, held: ca.SX, volts: ca.SX) -> ca.SX:
    """Return V_f' in V/s, for V_f = `held` and V = `volts`."""
    return 2 * pi * chain.corner * (volts - held)


def with_filter(model: StateSpace, outputs: Sequence[str], chain: Chain) -> StateSpace:
    """Return a model with the filter added to some of its outputs."""
    w, I = 2 * pi * chain.corner, np.eye(len(outputs))
    late = {name: f"{name}_filtered" for name in outputs}
    states = tuple(f"{name}_lag" for name in outputs)
    lag = StateSpace(-w * I, w * I, I, 0 * I, states, tuple(outputs), tuple(late.values()), model.time)
    joined = connect([model, lag], model.inputs, [late.get(name, name) for name in model.outputs], {})
    return replace(joined, outputs=model.outputs, units={})


def correlation(chain: Chain, time: Discrete) -> float:
    """Return exp(-w_c T)."""
    return exp(-2 * pi * chain.corner * time.period_s)


def noise(chain: Chain, time: Discrete, shape: tuple[int, int], seed: int) -> Array:
    """Return the noise (channels, N) in V of samples, stationary from the first on."""
    kept = correlation(chain, time)
    white = np.random.default_rng(seed).standard_normal(shape)
    white[:, 1:] *= sqrt(1 - kept**2)
    return readonly(chain.noise * signal.lfilter([1.0], [1.0, -kept], white, axis=1))
