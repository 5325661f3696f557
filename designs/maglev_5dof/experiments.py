"""Experiments of the paper's design: those of the stage with its limits, and the anti-windup (17)."""

from dataclasses import replace
from functools import cache
from math import inf

import numpy as np

from designs.maglev import experiments, platen
from designs.maglev_5dof import control
from models import maglev_stage
from synth.check import Check
from synth.declare.fault_campaign import StudyLimits
from synth.execute import build, host
from synth.simulate.experiment import Experiment
from synth.simulate.rig import Rig

LIMITS = experiments.Limits(
    y=(0.20, 2.2, 4.0),
    xz=(0.25, 2.0, 3.5),
    theta=(0.20, 2.2, 4.0),
    wrong=(0.40, 3.3, 6.0),
    tracking={"y": 50e-6, "x": 1.5e-6, "z": 1.5e-6, "theta": 25e-6},  # m, rad
)
# Largest values on 16 machines, in the order of the limits: 0.217; 0.48, by the guide spring of theta; 5.8 s and, for
# t_enc, never: the errors of the encoders' zeros, 7 um each, and of the motors' places tilt the true platen by more
# than the bands, of which that of t_enc is one count; 0.63 mm, since the feedback linearisation does not know how
# strong the magnets are; 6.2 um and 0.19 mrad, by the zeros of the encoders; 0.032; 1.0 mm by the magnets, from
# 20 mm: only the platen that starts at 18.1 mm touches the stop at 18 mm.
STUDY = StudyLimits(
    0.95,  # all 15 drawn machines
    {
        "y_*: overshoot": 0.25,
        "theta_*: overshoot": 0.5,
        "theta_*: t_s": 7.0,  # s
        "*: t_enc": inf,
        "[xz]_30: gap moves by": 1e-3,  # m
        "tracking: mean |e_[xz]|": 10e-6,  # m
        "tracking: mean |e_theta|": 250e-6,  # rad
        "lift_off: overshoot": 0.05,
        "set_down_*: rises above the start by": 1.5e-3,  # m
    },
    experiments.STUDIED,
)
STROKE = 0.0499  # m, to both sides: a set-point is never on a stop
WINDUP = "x from -49.9 to 49.9 mm at 30 mm gap, {} anti-windup"


@cache
def without_anti_windup(scalar: str) -> host.Controller:
    """Return the controller without anti-windup, compiled in a scalar type by name."""
    kind, controller = np.dtype(scalar).type, control.with_fault_handling(maglev_stage.plant(), anti_windup=False)
    return build.compile_block(controller.block, kind, error=platen.SURROGATE_ERROR[kind])


def _windup(rig: Rig, anti_windup: bool) -> Experiment:
    """Step x by 99.8 mm at a gap of 30 mm with the anti-windup (17), or without it."""
    bare = replace(rig, controller=without_anti_windup(np.dtype(rig.controller.scalar).name))
    about = "without stops along x, so the overshoot is visible"
    without = experiments.response(bare, "x", STROKE, about, -STROKE, gap=0.030)
    if not anti_windup:
        return without
    run = experiments.response(rig, "x", STROKE, about, -STROKE, gap=0.030)
    ratio = run.figures["overshoot"] / without.figures["overshoot"]
    check = Check("overshoot with over overshoot without", ratio, 0.9, "1", "the anti-windup must have an effect here")
    return replace(run, checks=(check, *run.checks))


ALL = (
    *experiments.of(LIMITS),
    *(
        experiments.run(f"windup_{kind}", WINDUP.format(kind), _windup, anti_windup=kind == "with")
        for kind in ("with", "without")
    ),
)
