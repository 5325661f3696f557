"""The five-axis maglev stage of Fulford, Maggiore and Apkarian, from physics to verified C."""

from pathlib import Path
from typing import Any

from designs.maglev_5dof import (
    commutation,
    control,
    experiments,
    fault_campaign,
    fault_handling,
    gains,
    reference_faults,
    verification,
)
from designs.maglev_5dof.paper import rows
from models import maglev_phases, maglev_stage, papers
from synth import stage
from synth.stage import Companion, Drive


def report(*arguments: Any) -> str:
    """Return the report; what draws it is imported here, since `synth emit` does not need it."""
    from designs.maglev_5dof import page

    return page.report(*arguments)


PLANT = maglev_stage.plant()
PHASES = commutation.phase_currents(PLANT)
DESIGN = stage.design(
    fault_handling.controller(PLANT),
    PLANT,
    reference=reference_faults.step,
    experiments=experiments.ALL,
    operating_points={f"{gap:g} mm": {"y": gap * 1e-3} for gap in (18, 25, 31)},
    coordinates=control.POSE,
    surrogate_error=control.SURROGATE_ERROR,
    start={"y": 0.025},
    stops={name: control.BOX[name] for name in ("y", "phi", "theta")},
    velocities=maglev_stage.RATE,
    wires=experiments.WIRES,
    faults=fault_campaign.FAULTS,
    header_notes=[f"F(n) and (n) are equation (n) of {papers.FULFORD}."],
    limited=[f"observer_{n}_g" for n in "xz"],  # the learnt gain of the thrust
    safe_output=stage.read_safe_output(Path(__file__).with_name("safe_output.json")),
    recording=verification.vectors,
    gains=gains.document,
    companions=[Companion(PHASES)],
    law_alone=control.controller(PLANT),
    drive=Drive(maglev_phases.plant(), (PHASES,)),
    verify=verification.verify,
    audit=rows.rows,
    report=report,
    about=__doc__,
)
