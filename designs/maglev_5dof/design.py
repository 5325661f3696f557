"""The five-axis maglev stage of Fulford, Maggiore and Apkarian, from physics to verified C."""

from collections.abc import Iterator, Sequence
from math import inf
from pathlib import Path
from typing import Any

from designs.maglev import declaration
from designs.maglev_5dof import control, gains, reference
from models import maglev_stage
from synth import stage
from synth.declare.fault_campaign import StudyLimits


def runs() -> Sequence[Any]:
    """Return the experiments; they are imported here, since an import of the design simulates nothing."""
    from designs.maglev_5dof import experiments

    return experiments.ALL


def stimuli() -> Any:
    """Return what drives the verification."""
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
    declaration.STUDIED,
)
PLANT = maglev_stage.plant()
DESIGN = declaration.design(
    control.with_fault_handling(PLANT),
    PLANT,
    Path(__file__).parent,
    reference=reference.with_fault_handling,
    runs=runs,
    study=STUDY,
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
