"""Faults of a sensor: those of `failure_experiments` in its first voltage, or in both, which fail together."""

from synth.errors import ModelError
from synth.simulate.faults import failure_experiments
from synth.simulate.faults.failure_experiments import Fault

OFFSET, DRIFT, END = 0.3, 0.02, 5.0  # V, V a sample, V
FAULTS = failure_experiments.faults(OFFSET, DRIFT, END, "voltage", "sensor")
LASTING = tuple(f for f in FAULTS if not failure_experiments.is_frozen(f))  # faults that there may be from init on


def find(fault: str) -> Fault:
    """Return the fault of a name; raise ModelError for an unknown one."""
    if fault not in FAULTS:
        raise ModelError(f"'{fault}' is not a known fault: give one of {', '.join(FAULTS)}")
    return FAULTS[fault]
