"""Free parameters of the precise design, for `synth tune`: bandwidths of the observers and weights of the rates.

The experiments are the steps, whose overshoot and settling these parameters decide. The margins are those of the
declaration and the disk margin.
"""

from collections.abc import Mapping
from dataclasses import replace

from designs.maglev_5dof_precise import control
from synth import stage
from synth.plant import Plant
from synth.tuning import Free, Tuning

GROUPS = {"y": ("y",), "xz": ("x", "z"), "theta": ("theta",)}  # axes that share their parameters


def _free(group: str, axis: str) -> tuple[Free, Free]:
    loop = control.LOOPS[axis]
    bandwidth = Free(f"bandwidth_{group}", loop.bandwidth, 200.0, 600.0, "rad/s", "of the observer")
    low, high = 0.3 * loop.weights[1], 3 * loop.weights[1]
    return bandwidth, Free(f"damping_{group}", loop.weights[1], low, high, "s^2/m^2", "weight of the rate")


def tuning(plant: Plant) -> Tuning:
    """Return the free parameters, and the controller that they give."""

    def controller(p: Mapping[str, float]) -> stage.Controller:
        loops = dict(control.LOOPS)
        for group, axes in GROUPS.items():
            for axis in axes:
                loop = control.LOOPS[axis]
                weights = (loop.weights[0], p[f"damping_{group}"])
                loops[axis] = replace(loop, bandwidth=p[f"bandwidth_{group}"], weights=weights)
        return control.controller(plant, loops)

    free = [each for group, axes in GROUPS.items() for each in _free(group, axes[0])]
    return Tuning(free, controller, ["y_22_29", "x_30", "theta_5"], require={"disk_margin": 0.3})
