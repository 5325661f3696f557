"""The five-axis maglev stage of Fulford, Maggiore and Apkarian, from physics to verified C."""

from pathlib import Path
from typing import Any

from designs.maglev import commutation, declaration
from designs.maglev_5dof import control, experiments, gains, reference, verification
from designs.maglev_5dof.paper import rows
from models import maglev_stage


def report(*arguments: Any) -> str:
    """Return the report; what draws it is imported here, since `synth emit` does not need it."""
    from designs.maglev_5dof import page

    return page.report(*arguments)


PLANT = maglev_stage.plant()
PHASES = commutation.phase_currents(control.NAME, PLANT)
DESIGN = declaration.design(
    control.with_fault_handling(PLANT),
    PLANT,
    PHASES,
    Path(__file__).parent,
    reference=reference.with_fault_handling,
    experiments=experiments.ALL,
    study=experiments.STUDY,
    gains=gains.document,
    require={  # degrees and s; a little below the least over the operating points, gap 18 to 31 mm
        "phase_margin": 45.0,
        "gain_margin": 1.65,
        "gain_reduction": 1.55,
        "delay_margin": 3.5e-3,
        "modulus_margin": 0.4,
        "disk_margin": 0.22,
    },
    law_alone=control.controller(PLANT),
    verify=verification.verify,
    audit=rows.rows,
    report=report,
    about=__doc__,
)
