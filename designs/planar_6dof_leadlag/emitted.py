"""What is committed under generated_c/planar_6dof_leadlag/."""

from typing import Any

import numpy as np

from designs.planar_6dof import allocation, vertical
from designs.planar_6dof import emitted as shared
from designs.planar_6dof_leadlag import control
from models import planar_stage
from synth.emit import write


def emitted(scalar: type[np.floating]) -> dict[str, write.Emitted]:
    """Return the files of planar_6dof_leadlag in a scalar type, by folder."""
    return shared.emitted(control.controller(planar_stage.plant()), scalar, gains())


def gains() -> dict[str, Any]:
    """Return the six compensators with what the paper prints of x, y and phi, and the filters."""
    upright = [vertical.loop(a, vertical.compensator(a, control.TIME), control.TIME) for a in allocation.VERTICAL]
    return {
        "plant": "M q'' = f in x and y, Izz phi'' = m; M z'' = f - Kz z, and so for theta and psi",
        "period_s": control.TIME.period_s,
        "parts_of_the_published_gain": control.PART | vertical.PART,
        "compensators": shared.compensators([*control.loops(), *upright]),
        "filters": shared.filters(control.TIME),
    }
