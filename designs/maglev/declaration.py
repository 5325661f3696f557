"""What both designs of the maglev stage declare alike."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from designs.maglev import (
    commutation,
    fault_campaign,
    fault_handling,
    platen,
    reactions,
    reference_phase,
)
from models import maglev_phases, maglev_stage, papers
from synth import stage
from synth.plant import Plant
from synth.stage import Companion, Drive

# What runs on the machines of a study: not what sets a guide spring off by its tolerance, which a machine already has,
# nor what is shown for comparison.
STUDIED = ("y_*", "[xz]_30", "theta_5", "theta_10", "phi_springs_1", "tracking", "lift_off", "set_down_*")

EQUATIONS = f"F(n) and (n) are equation (n) of {papers.FULFORD}."
START = (
    "The pose at init is that of the first sample in which all sensors are good, and the platen rests in it, as on its "
    f"stop at {platen.GAP[1] * 1e3:g} mm."
)
SET_POINTS = (
    f"A set-point nearer to a stop than {platen.STOP_MARGIN * 1e6:g} um at a motor is out of range. On the stop the "
    "error of an encoder's zero would not vanish, and the internal model would push the platen into the stop until the "
    "currents are at their limit."
)


def design(
    controller: stage.Controller, plant: Plant, folder: Path, limited: Sequence[str] = (), **fields: Any
) -> stage.Stage:
    """Return the design of a controller with its commutation; `fields` are those of `stage.design`.

    `limited` names states of the law that may reach their bounds.
    """
    reach, name = platen.AXES[0].reference, controller.name
    phases = Companion(
        f"{name}_phase",
        partial(commutation.phase_currents, name, plant),
        header_notes=[commutation.FADING, EQUATIONS],
        reference=reference_phase.step,
        label="commutation",
        floor=platen.CURRENT_FLOOR,
    )
    common: dict[str, Any] = {
        "operating_points": {f"{gap * 1e3:.0f} mm": {"y": gap} for gap in (reach.low, 0.025, reach.high)},
        "coordinates": platen.POSE,
        "surrogate_error": platen.SURROGATE_ERROR,
        "start": {"y": 0.025},
        "stops": {name: platen.BOX[name] for name in ("y", "phi", "theta")},
        "velocities": maglev_stage.RATE,
        "wires": platen.WIRES,
        "faults": fault_campaign.FAULTS,
        "header_notes": [reactions.AXES, START, SET_POINTS, fault_handling.UNTESTED, EQUATIONS],
        "reactions": reactions.REACTIONS,
        "limited": [*(f"observer_{n}_g" for n in "xz"), *limited],  # g is the learnt gain of the thrust
        "safe_output": stage.read_safe_output(folder / "safe_output.json"),
        "companions": [phases],
        "drive": Drive(maglev_phases.plant(), (phases,)),
    }
    return stage.design(controller, plant, **(common | fields))
