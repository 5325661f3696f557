"""Fault campaign of the maglev stage: the 4-DOF tracking as its motion, and what no fault of an encoder may do."""

from math import pi

from designs.maglev_5dof import control, experiments
from synth.campaign import FaultCampaign, FaultLimit

LIMITS = (  # an encoder that fails does not harm the machine
    FaultLimit("false_alarms", 0.0),
    FaultLimit("impact_y", 0.10, target="[xyz]*"),  # m/s
    FaultLimit("impact_x", 0.10, target="y?"),
    FaultLimit("impact_z", 0.10, target="y?"),
    FaultLimit("impact_phi", 0.10, target="[xyz]*"),  # rad/s
    FaultLimit("impact_theta", 0.10, target="[xyz]*"),
    *(FaultLimit("excursion_y", 40e-6, target="y?", kind=kind) for kind in ("not finite", "out of range")),
    FaultLimit("excursion_y", 40e-6, target="y?", kind="frozen", condition="in motion"),
    FaultLimit("notice_s", 0.05, target="[xyz]*", kind="frozen", condition="in motion", duration="permanent"),
    FaultLimit("wrong_names", 0.0, target="[xyz]*", kind="frozen", condition="in motion"),
    *(FaultLimit(f"excursion_{s}", 1e-3, s, "not finite", "at rest") for s in "xz"),  # m
    *(FaultLimit(f"impact_{s}", 0.0, s, kind) for s in "xz" for kind in ("not finite", "out of range")),
    *(FaultLimit(f"impact_{s}", 0.0, s, "frozen", "in motion") for s in "xz"),
)
INERTIAS = {"y": "M_y", "x": "M_x", "z": "M_z", "phi": "I_x", "theta": "I_z"}
FAULTS = FaultCampaign(
    {f"{n}_ref": course for n, course in experiments.COURSES.items()},
    2 * pi / control.OMEGA0,
    watch_s=2.0,
    limits=LIMITS,
    inertias=INERTIAS,
)
