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

HERE = Path(__file__).parent


def design(
    controller: stage.Controller, plant: Plant, folder: Path, limited: Sequence[str] = (), **fields: Any
) -> stage.Stage:
    """Return the design of a controller with its commutation; `fields` are those of `stage.design`.

    `limited` names states of the law that may reach their bounds.
    """
    reach, name = platen.AXES[0].reference, controller.name
    (gaps,) = fault_handling.relations(plant)
    phases = Companion(
        f"{name}_phase",
        partial(commutation.phase_currents, name, plant),
        header_notes=stage.read_notes(
            HERE / "header_phase.md",
            bad_samples=platen.BAD_SAMPLES,
            descent=commutation.DESCENT,
            fade=commutation.FADE,
            paper=papers.FULFORD,
        ),
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
        "header_notes": stage.read_notes(
            HERE / "header.md",
            motors=reactions.MOTORS,
            stop=platen.GAP[1] * 1e3,
        ),
        "datasheet_notes": stage.read_notes(
            HERE / "datasheet.md",
            stop_margin=platen.STOP_MARGIN * 1e6,
            travel=fault_handling.TRAVEL * 1e3,
            frozen=fault_handling.WIDE_FROZEN * 1e3,
            jump=fault_handling.WIDE_JUMP * 1e3,
            noise=fault_handling.SOUND.noise * 1e6,
            offset=fault_handling.SOUND.offset * 1e6,
            parity=gaps.threshold * 1e6,
            noisy=gaps.largest * 1e6,
            quiet=fault_handling.PROBE.quiet,
            paper=papers.FULFORD,
        ),
        "reactions": reactions.REACTIONS,
        "limited": [*(f"observer_{n}_g" for n in "xz"), *limited],  # g is the learnt gain of the thrust
        "safe_output": stage.read_safe_output(folder / "safe_output.json"),
        "companions": [phases],
        "drive": Drive(maglev_phases.plant(), (phases,)),
    }
    return stage.design(controller, plant, **(common | fields))
