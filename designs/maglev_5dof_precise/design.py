"""The five-axis maglev stage of Fulford et al. under a controller of higher precision, from physics to verified C."""

from pathlib import Path

import numpy as np

from designs.maglev import commutation, declaration, platen
from designs.maglev_5dof_precise import control, experiments, reference, tuning, verification
from models import maglev_stage

PLANT = maglev_stage.plant()
PHASES = commutation.phase_currents(control.NAME, PLANT)
DESIGN = declaration.design(
    control.controller(PLANT),
    PLANT,
    PHASES,
    Path(__file__).parent,
    reference=reference.with_fault_handling,
    experiments=experiments.ALL,
    gains=control.gains,
    law_alone=control.law_alone(PLANT),
    verify=verification.verify,
    require={"delay_margin": 3e-3},
    surrogate_error=platen.SURROGATE_ERROR | {np.float64: 2e-15},
    limited=["observer_y_fast_d", "observer_y_d"],  # without current a stop takes the demand that the servo raises
    tuning=tuning.tuning(PLANT),
    about=__doc__,
)
