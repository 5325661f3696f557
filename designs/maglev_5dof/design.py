"""The five-axis maglev stage of Fulford, Maggiore and Apkarian, from physics to verified C."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from designs.maglev import commutation, declaration
from designs.maglev_5dof import control, experiments, gains, reference
from models import maglev_stage
from synth import stage


def stimuli() -> Any:
    """Return what drives the verification; it is imported here, since an import of the design runs nothing."""
    from designs.maglev_5dof import verification

    return verification.stimuli()


def audit(of: stage.Stage) -> Iterator[Any]:
    """Yield the recomputed figures of the paper."""
    from designs.maglev_5dof.paper import rows

    return rows.rows(of)


def contents(of: stage.Stage, results: Any) -> Any:
    """Return what the report has beyond the standard sections."""
    from designs.maglev_5dof import page

    return page.contents(of, results)


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
    stimuli=stimuli,
    audit=audit,
    contents=contents,
    about=__doc__,
)
