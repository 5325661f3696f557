"""Headroom of the states of a controller: the largest ratio of each state to its bound in a run.

    r = max over k of |x_k - m| / h,    m and h the centre and half width of the declared range of the state

A state at its bound is saturated: it no longer has the value that the control law computes. A comparison of
implementations cannot detect this, because all of them saturate in the same way. Recorded inputs are therefore replayed
through the C in double precision, and r < 1 must hold for every state of the control laws, except for those that are
limited on purpose. States of the input guard, stored outputs and integers are ignored.
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
    """Return r of each state of the control laws, under input columns (N,) from `init`.

    Raises SignalError as `host.Controller.replay`.
    """
    states = recording.states(controller, inputs)
    fields = controller.manifest["structs"]["state"]["fields"]
    laws = [f for f in fields if f["ctype"] in _REAL and not f["name"].startswith(_GUARD_PREFIXES)]
    return {f["name"]: _ratio(states[f["name"]].astype(np.float64), f["low"], f["high"]) for f in laws}


def _ratio(values: np.ndarray, low: float, high: float) -> float:
    middle, half = (low + high) / 2, (high - low) / 2
    return float(np.max(np.abs(values - middle)) / half)


def with_headroom(
    experiment: Experiment,
    controller: host.Controller,
    limited: Collection[str] = (),
    constants: Mapping[str, float] | None = None,
) -> Experiment:
    """Return an experiment with its largest r as a measured value, and a check that no state reached its bound.

    `limited` names states that may reach it; `controller` is the C in double precision. `constants` are its inputs that
    the controller of the experiment may not read.
    """
    peaks = ratios(controller, {**(constants or {}), **experiment.trajectory.measured})
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
