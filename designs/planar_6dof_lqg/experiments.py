"""The LQG controller's experiments, Y section 5.3: steps (Fig. 10) with the spectrum of x, noise, and failures.

The paper states no rise, overshoot or settling of these steps. The sensor noise changes the phase currents of motors A
and B by 0.66 A rms from sample to sample, for which the windings need 18 to 31 V where Table 1 states 6.525 V. The
voltages are therefore not limited here. The standstills with amplifiers show the effect on y and phi.
"""

from dataclasses import replace
from math import pi

import numpy as np

from designs.planar_6dof import experiments as shared
from designs.planar_6dof import failures, finite, loads
from designs.planar_6dof.paper import records
from synth.check import Check
from synth.declare.experiments import Run
from synth.simulate.experiments import Experiment
from synth.simulate.rig import Rig

STEPS = {"x": records.STEP, "y": 50e-6, "phi": 0.3 * pi / 180}  # m, rad, Fig. 10
TITLES = {"x": "x by 50 um", "y": "y by 50 um", "phi": "phi by 0.3 degrees"}
FIGURES = {"x": "Fig. 10(a), (d)", "y": "Fig. 10(b)", "phi": "Fig. 10(c)"}
LARGE = 0.06  # m


def large_step(loop: Rig, name: str) -> Experiment:
    """Return a step of x that saturates the motors; the paper does not show one."""
    experiment = shared.step_experiment(loop, shared.step(loop, "x", LARGE), name, "x by 60 mm", None)
    overshoot = Check("overshoot", experiment.figures["overshoot"], 0.05, "1", "at the motors' limits")
    greatest_yaw = float(np.abs(experiment.trajectory["phi"]).max())
    yaw = Check("greatest yaw", greatest_yaw, 5e-3, "rad", "a fifth of the sensors' range")
    return replace(experiment, checks=(*experiment.checks, overshoot, yaw))


def step_with_spectrum(loop: Rig, name: str) -> Experiment:
    """Return the step of x with the most prominent line of its spectrum."""
    step, line = _STEP_X.make(loop, name), records.of_step(loop)
    about = "above its neighbours, x as measured"
    check = Check("most prominent line", line.above, records.DOMINANT, "dB", about)
    figures = {**step.figures, "most prominent line, Hz": line.frequency}
    return replace(step, figures=figures, checks=(*step.checks, check))


_STEP_X, *_OTHERS = shared.steps(STEPS, {axis: f"{title} ({FIGURES[axis]})" for axis, title in TITLES.items()}, None)
ALL = (
    Run(_STEP_X.name, step_with_spectrum),
    *_OTHERS,
    Run("step_x_large", large_step),
    *shared.STANDSTILLS,
    *failures.ALL,
    *loads.experiments(force_y=20.0),
    *shared.steps(STEPS, TITLES, None, finite.step, "_finite"),
    finite.STANDSTILL,
)
