"""Faults of a sensor: `synth.simulate.faults.channel_faults` of its first voltage, or of both, which fail together."""

from synth.errors import ModelError
from synth.simulate.faults import channel_faults
from synth.simulate.faults.channel_faults import Fault

OFFSET, DRIFT, END = 0.3, 0.02, 5.0  # V, V a sample, V
FAULTS = channel_faults.faults(OFFSET, DRIFT, END, "voltage", "sensor")
LASTING = tuple(f for f in FAULTS if not channel_faults.is_frozen(f))  # faults that there may be from init on


def find(fault: str) -> Fault:
    """Return the fault of a name; raise ModelError for an unknown one."""
    if fault not in FAULTS:
        raise ModelError(f"'{fault}' is not a known fault: give one of {', '.join(FAULTS)}")
    return FAULTS[fault]
