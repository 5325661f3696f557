"""The five-axis maglev stage of Fulford et al. under a controller of higher precision, from physics to verified C."""

from pathlib import Path
from typing import Any

import numpy as np

from designs.maglev import commutation, declaration, platen
from designs.maglev_5dof_precise import control, experiments, reference, tuning
from models import maglev_stage


def stimuli() -> Any:
    """Return what drives the verification; it is imported here, since an import of the design runs nothing."""
    from designs.maglev_5dof_precise import verification

    return verification.stimuli()


PLANT = maglev_stage.plant()
PHASES = commutation.phase_currents(control.NAME, PLANT)
DESIGN = declaration.design(
    control.controller(PLANT),
    PLANT,
    PHASES,
    Path(__file__).parent,
    reference=reference.with_fault_handling,
    experiments=experiments.ALL,
    study=experiments.STUDY,
    gains=control.gains,
    law_alone=control.law_alone(PLANT),
    stimuli=stimuli,
    require={  # degrees and s; a little below the least over the operating points, gap 18 to 31 mm
        "phase_margin": 39.0,
        "gain_margin": 1.95,
        "gain_reduction": 3.4,
        "delay_margin": 3.9e-3,
        "modulus_margin": 0.48,
        "disk_margin": 0.33,
    },
    surrogate_error=platen.SURROGATE_ERROR | {np.float64: 2e-15},
    limited=["observer_y_fast_d", "observer_y_d"],  # without current a stop takes the demand that the servo raises
    tuning=tuning.tuning(PLANT),
    about=__doc__,
)
