"""The planar positioner of Yu and Kim under its lead-lag controller at 1 kHz, from physics to verified C."""

from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any

from designs.planar_6dof import artefacts, assembly, vertical
from designs.planar_6dof.interface import Subject
from designs.planar_6dof_leadlag import control, reference
from models import planar_stage
from synth import stage


@cache
def subject() -> Subject:
    """Return the controller, its NumPy reference implementation, and the sizes of its random steps."""
    return Subject(control.controller(planar_stage.plant()), reference.step, size=0.3, step=0.06)


def gains() -> dict[str, Any]:
    """Return the six compensators, the gains as fractions of the published ones, and the filters."""
    return {
        "plant": "M q'' = f in x and y, Izz phi'' = m; M z'' = f - Kz z, and so for theta and psi",
        "period_s": control.TIME.period_s,
        "parts_of_the_published_gain": control.GAIN_SHARE | vertical.GAIN_SHARE,
        "compensators": artefacts.compensators(control.loops()),
        "filters": artefacts.filters(control.TIME),
    }


def runs() -> Sequence[Any]:
    """Return the experiments; they are imported here, since an import of the design simulates nothing."""
    from designs.planar_6dof_leadlag import experiments

    return experiments.ALL


def contents(of: stage.Stage, results: Any) -> Any:
    """Return what the report has beyond the standard sections; `synth emit` does without what draws it."""
    from designs.planar_6dof_leadlag import page

    return page.contents(of, results)


def audit_rows(shipped: Any) -> Iterator[Any]:
    """Yield the rows of the audit for the shipped loop, a `Rig`."""

    from designs.planar_6dof.paper import rows

    return rows.leadlag(shipped)


REQUIRE = {  # degrees and s; a little below the least in the middle and over a pitch
    "phase_margin": 36.0,
    "gain_margin": 2.9,
    "gain_reduction": 8.5,
    "delay_margin": 2.2e-3,
    "modulus_margin": 0.44,
    "disk_margin": 0.25,
}
DESIGN = assembly.design(
    control.NAME, control.TIME, subject, gains, runs, audit_rows, contents, ["circle"], require=REQUIRE
)
