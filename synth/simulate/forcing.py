"""Forcing of a simulated loop: disturbances and fixed commands at the inputs of the plant, held over each substep."""

from collections.abc import Mapping

import numpy as np

from synth.errors import SignalError
from synth.signals import Signal
from synth.simulate.scenario import Array, Scenario


def columns(inputs: Mapping[str, Signal], scenario: Scenario, time: Array) -> Array:
    """Return the forcing of each input in each substep, (samples, substeps, inputs), in the units of the inputs.

    Forcing by constants has one row for all samples.
    """
    n, m = len(time), scenario.substeps
    varies = any(callable(course) or np.ndim(course) for course in scenario.forcing.values())
    period = scenario.duration_s / n if n == 1 else time[1]
    moments = time if varies else time[:1]
    middles = moments[:, None] + period * (np.arange(m) + 0.5) / m
    forcing = np.zeros((*middles.shape, len(inputs)))
    for j, (name, signal) in enumerate(inputs.items()):
        course = scenario.forcing.get(name, 0.0)
        try:
            values = np.vectorize(course, otypes=[float])(middles) if callable(course) else np.asarray(course, float)
        except (TypeError, ValueError) as error:
            raise SignalError(
                f"forcing of '{name}' is not a number at some time ({error}): {_remedy(n, signal)}"
            ) from error
        if not callable(course) and values.shape not in ((), (n,)):
            raise SignalError(f"forcing of '{name}' is an array {values.shape}: {_remedy(n, signal)}")
        if not np.isfinite(values).all():
            raise SignalError(f"forcing of '{name}' is not finite: {_remedy(n, signal)}")
        forcing[:, :, j] = values[:, None] if values.shape == (n,) else values
    return forcing


def _remedy(n: int, signal: Signal) -> str:
    return f"give a finite number in {signal.unit}, {n} of them, one a sample, or a function of the time in s"
