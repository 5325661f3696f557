"""Fault campaign of the maglev stage: the 4-DOF tracking as its motion, and what no fault of an encoder may do."""

from math import pi

from designs.maglev import motions, platen
from synth.campaign import FaultCampaign, FaultLimit

GONE = ("not finite", "out of range", "frozen")
LIMITS = (  # one encoder that fails does not harm the machine; docs/decisions/maglev_landing.md states what is not met
    FaultLimit("false_alarms", 0.0),
    *(FaultLimit("impact_y", 0.10, "y?", kind) for kind in (*GONE, "drift")),  # m/s
    *(FaultLimit(f"impact_{q}", 0.10, "y?", kind) for q in ("x", "z", "phi", "theta") for kind in GONE),  # m/s, rad/s
    *(FaultLimit(f"impact_{q}", 0.10, s, kind) for q in ("y", "phi", "theta") for s in "xz" for kind in GONE),
    FaultLimit("impact_y", 0.10, "y? + y?", "both lost"),
    *(FaultLimit(f"impact_{q}", 0.25, "y? + y?", "both lost") for q in ("phi", "theta")),  # 0.10 m/s at the motors
    *(FaultLimit("excursion_y", 40e-6, "y?", kind) for kind in ("not finite", "out of range")),
    FaultLimit("excursion_y", 40e-6, "y?", "frozen", "in motion", "permanent"),
    *(FaultLimit("notice_s", 0.05, s, "frozen", "in motion", "permanent") for s in ("y?", "x", "z")),
    *(FaultLimit("wrong_names", 0.0, s, "frozen", "in motion", "permanent") for s in ("y?", "x", "z")),
    *(FaultLimit("notice_s", 0.5, s, "frozen", "at rest", "permanent") for s in "xz"),
    *(FaultLimit(f"excursion_{s}", 10e-3, s, "frozen", "at rest") for s in "xz"),  # m
    *(FaultLimit(f"excursion_{s}", 1e-3, s, "not finite", "at rest") for s in "xz"),
    *(FaultLimit(f"impact_{s}", 0.0, s, kind) for s in "xz" for kind in GONE),
    FaultLimit("notice_s", 0.051, "calls", "missing", duration="0.05 s"),  # at the next call
)
INERTIAS = {"y": "M_y", "x": "M_x", "z": "M_z", "phi": "I_x", "theta": "I_z"}
FAULTS = FaultCampaign(
    {f"{n}_ref": course for n, course in motions.COURSES.items()},
    2 * pi / platen.OMEGA0,
    watch_s=2.0,
    limits=LIMITS,
    inertias=INERTIAS,
)
