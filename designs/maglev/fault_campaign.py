"""Fault campaign of the maglev stage: the 4-DOF tracking as its motion, and what no fault of an encoder may do."""

from math import pi

from designs.maglev import platen
from synth.declare.fault_campaign import FaultCampaign, FaultLimit

# The platen is level in the tracking where it is nearest to the magnets, and symmetry hides what a tilt shows.
TILTED_POINT = {"y_ref": 0.0185, "x_ref": 0.02, "z_ref": -0.02, "phi_ref": 0.5e-3, "theta_ref": 3e-3}  # m, rad
LEVEL, TILTED = ("at rest", "in motion"), "at rest, tilted at 18.5 mm"
ENCODERS = ("y?", "x", "z")
# rad/s, 0.12 m/s at the motors: phi of the precise design, which swings on while the platen lies on its lower stop
SWINGS = 0.30
GONE = ("not finite", "out of range", "frozen")
LIMITS = (  # one encoder that fails does not harm the machine; docs/decisions/maglev_landing.md states what is not met
    FaultLimit("false_alarms", 0.0),
    FaultLimit("healthy_impact", 0.05),  # m/s, rad/s: it starts half a millimetre from its upper stop at 18.5 mm
    *(FaultLimit("impact_y", 0.10, "y?", kind) for kind in (*GONE, "drift")),  # m/s
    *(FaultLimit(f"impact_{q}", 0.10, "y?", kind) for q in ("x", "z", "theta") for kind in GONE),  # m/s, rad/s
    *(FaultLimit(f"impact_{q}", 0.10, s, kind) for q in ("y", "theta") for s in "xz" for kind in GONE),
    *(FaultLimit("impact_phi", 0.10, s, kind, on) for s in ENCODERS for kind in GONE for on in LEVEL),
    *(FaultLimit("impact_phi", SWINGS, s, kind, TILTED) for s in ENCODERS for kind in GONE),
    *(FaultLimit("impact_y", 0.10, "y? + y?", "both lost", on) for on in LEVEL),
    FaultLimit("impact_y", 0.30, "y? + y?", "both lost", TILTED),
    FaultLimit("impact_theta", 0.25, "y? + y?", "both lost"),  # 0.10 m/s at the motors
    *(FaultLimit("impact_phi", 0.25, "y? + y?", "both lost", on) for on in LEVEL),
    FaultLimit("impact_phi", SWINGS, "y? + y?", "both lost", TILTED),
    *(FaultLimit("excursion_y", 40e-6, "y?", kind) for kind in ("not finite", "out of range")),
    FaultLimit("excursion_y", 40e-6, "y?", "frozen", "in motion", "permanent"),
    *(FaultLimit("notice_s", 0.05, s, "frozen", "in motion", "permanent") for s in ENCODERS),
    *(FaultLimit("wrong_names", 0.0, s, "frozen", "in motion", "permanent") for s in ENCODERS),
    *(FaultLimit("notice_s", 0.5, s, "frozen", "at rest", "permanent") for s in "xz"),
    *(FaultLimit(f"excursion_{s}", 10e-3, s, "frozen", "at rest") for s in "xz"),  # m
    *(FaultLimit(f"excursion_{s}", 1e-3, s, "not finite", "at rest") for s in "xz"),
    *(FaultLimit(f"impact_{s}", 0.0, s, kind, on) for s in "xz" for kind in GONE for on in LEVEL),
    *(FaultLimit(f"impact_{s}", 0.05, s, kind, TILTED) for s in "xz" for kind in GONE),  # m/s
    *(FaultLimit("notice_s", 0.5, s, "frozen", TILTED, "permanent") for s in "xz"),
    FaultLimit("notice_s", 0.051, "calls", "missing", duration="0.05 s"),  # at the next call
)
INERTIAS = {"y": "M_y", "x": "M_x", "z": "M_z", "phi": "I_x", "theta": "I_z"}
FAULTS = FaultCampaign(
    {f"{n}_ref": course for n, course in platen.COURSES.items()},
    {"tilted at 18.5 mm": TILTED_POINT},
    2 * pi / platen.OMEGA0,
    watch_s=2.0,
    limits=LIMITS,
    inertias=INERTIAS,
)
