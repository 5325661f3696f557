"""Free parameters of the precise design, for `synth tune`: bandwidth and damping of the horizontal axes.

The goals are those of the step of x; on a wrong plant the gap still falls back to its set-point then, so the limit of
its motion is wider here. The search computes margins at one operating point, 9 s of processor time a candidate.
"""

from collections.abc import Mapping
from dataclasses import replace

from designs.maglev_5dof_precise import control
from synth import stage
from synth.declare.tuning import FreeParameter, Tuning
from synth.plant import Plant

AXES = ("x", "z")  # they share their parameters


def tuning(plant: Plant) -> Tuning:
    """Return the free parameters, and the controller that they give."""

    def controller(p: Mapping[str, float]) -> stage.Controller:
        weights = (control.X.weights[0], p["damping"])
        loop = replace(control.X, bandwidth=p["bandwidth"], weights=weights)
        return control.controller(plant, {**control.LOOPS, **dict.fromkeys(AXES, loop)})

    free = (
        FreeParameter("bandwidth", control.X.bandwidth, 250.0, 600.0, "rad/s", "of the observers"),
        FreeParameter("damping", control.X.weights[1], 400.0, 2400.0, "s^2/m^2", "weight of the rate"),
    )
    goals = {"x_30: gap moves by": 1e-4}  # m
    return Tuning(free, controller, ["x_30"], ["25 mm"], goals, {"disk_margin": 0.35})
