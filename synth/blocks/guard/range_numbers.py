"""Numbers of limits that the C names."""

from synth.block import Constant
from synth.signals import Signal


def limit(name: str, value: float, unit: str, source: str) -> Constant:
    """Return a number that something is compared with or limited to."""
    return Constant(name, value, unit, source, is_limit=True)


def ends(of: Signal) -> list[Constant]:
    """Return ``highest_<signal>``, and ``lowest_<signal>`` of a range that is not about 0."""
    highest = limit(f"highest_{of.name}", of.high, of.unit, "end of its range")
    lowest = limit(f"lowest_{of.name}", of.low, of.unit, "end of its range")
    return [highest] if of.low == -of.high else [highest, lowest]
