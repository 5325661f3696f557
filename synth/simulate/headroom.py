"""Headroom of a controller's states: how near each came to its bound in a run.

    r = max over k of |x_k - m| / h,    m and h the middle and half the width of the state's declared range

A state that stands at its bound is not what the law computed any more, and no witness of the C can tell: all of them
limit it alike. So recorded inputs are replayed through the C in double precision, and r < 1 must hold of every state
of the laws but those that are limited on purpose. The guard's states, the last outputs and whole numbers are left out.
"""

from collections.abc import Collection, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from synth.check import Check
from synth.execute import host, recording
from synth.simulate.experiment import Experiment

LARGEST = 1 - 1e-6
NAME = "largest |state| / bound"
_GUARD_PREFIXES = ("guard_", "safe_output_")
_REAL = ("float", "double")


def ratios(controller: host.Controller, inputs: Mapping[str, ArrayLike]) -> dict[str, float]:
    """Return r by state of the laws, under input columns (N,) from `init`.

    Raises SignalError as `host.Controller.replay`.
    """
    states = recording.states(controller, inputs)
    fields = controller.manifest["structs"]["state"]["fields"]
    laws = [f for f in fields if f["ctype"] in _REAL and not f["name"].startswith(_GUARD_PREFIXES)]
    return {f["name"]: _ratio(states[f["name"]].astype(np.float64), f["low"], f["high"]) for f in laws}


def _ratio(values: np.ndarray, low: float, high: float) -> float:
    middle, half = (low + high) / 2, (high - low) / 2
    return float(np.max(np.abs(values - middle)) / half)


def judged(experiment: Experiment, controller: host.Controller, limited: Collection[str] = ()) -> Experiment:
    """Return an experiment with its largest r as a figure, and a check that no state stood at its bound.

    `limited` are states that may; `controller` is the C in double precision.
    """
    peaks = ratios(controller, experiment.trajectory.measured)
    if not peaks:
        return experiment
    free = {name: r for name, r in peaks.items() if name not in limited}
    largest = max(peaks, key=lambda name: peaks[name])
    figures = {**experiment.figures, f"{NAME} ({largest})": peaks[largest]}
    if not free:
        return replace(experiment, figures=figures)
    worst = max(free, key=lambda name: free[name])
    about = f"{worst}: at its bound a state is not what the law computes; widen the bound, or declare it `limited`"
    return replace(
        experiment, figures=figures, checks=(*experiment.checks, Check(NAME, free[worst], LARGEST, "1", about))
    )
