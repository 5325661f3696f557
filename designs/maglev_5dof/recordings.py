"""Recorded closed loops: the test vectors, and the runs that the witnesses replay."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from designs.maglev_5dof import control, experiments
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory, sample_times
from synth.simulate.sensors import Override

STEPS = 1000
BAD = slice(700, 703)  # samples of the test vectors at which the x encoder reads out of range
BAD_SET_POINT = slice(800, 810)


def vectors(rig: Rig) -> Mapping[str, Any]:
    """Return a lift-off from the stop with moves in x, z and theta, three bad encoder samples and a bad set-point."""
    time = sample_times(STEPS * control.TIME.period_s, control.TIME.period_s)
    wave = np.sin(control.OMEGA0 * time)
    references = {"y_ref": 0.031 - 0.006 * time, "x_ref": 0.005 * wave, "z_ref": -0.005 * wave}
    references["theta_ref"] = 0.001 * wave
    references["y_ref"][BAD_SET_POINT] = 0.05
    mask = np.zeros(STEPS, dtype=bool)
    mask[BAD] = True
    bad = Override(mask, np.full(STEPS, 0.2))
    return rig.run(time[-1] + control.TIME.period_s, {"y": 0.031}, references, overrides={"x": bad}).measured


def phases(inputs: Mapping[str, Any], outputs: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the inputs of the commutation that follows the controller."""
    return dict(outputs) | {n: inputs[n] for n in ("x", "z")}


def replays(rig: Rig, replay_s: float) -> dict[str, Trajectory]:
    """Run the 4-DOF tracking with encoders, a saturated step, and faults up to the latch."""
    return {
        f"replay of {replay_s:g} s": experiments.tracking(rig, True, replay_s)[0],
        "replay of a saturated step": experiments.step(rig, "x", -0.05, 0.05, gap=0.030, after=2.0).trajectory,
        "replay of faults": rig.run(2.0, overrides=_bad_samples()),
    }


def _bad_samples() -> dict[str, Override]:
    """Single bad samples of y2 and a set-point, four in a row of x, and in the end z for ever, which latches."""
    time = sample_times(2.0, control.TIME.period_s)
    masks = {"y2": time % 0.25 < 1e-9, "x_ref": time % 0.3 < 1e-9, "x": (time > 0.8) & (time < 0.8045), "z": time > 1.5}
    return {name: Override(mask, np.full(len(time), np.nan)) for name, mask in masks.items()}
