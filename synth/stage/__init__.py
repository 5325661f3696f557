"""From the declaration of a stage to its controller and design: what users import."""

from synth.declare.companion import Companion, Drive
from synth.declare.fault_campaign import FaultCampaign, FaultLimit, StudyLimits, read_safe_output
from synth.declare.stage import Actuator, Auxiliary, Controller, Interface, Law, Sensor, SetPoint, Stage, read_notes
from synth.stage.compose import controller, design
from synth.stage.interfaces import guarded_inputs, interface, safe

__all__ = [
    "Actuator", "Auxiliary", "Companion", "Controller", "Drive", "FaultCampaign", "FaultLimit", "Interface", "Law",
    "Sensor", "SetPoint", "Stage", "StudyLimits", "controller", "design", "guarded_inputs", "interface", "read_notes",
    "read_safe_output", "safe",
]  # fmt: skip
