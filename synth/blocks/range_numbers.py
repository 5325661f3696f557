"""Numbers of a limit that the C names: the ends of the range to which a Block limits a signal."""

from synth.block import Constant
from synth.signals import Signal


def ends(of: Signal) -> list[Constant]:
    """Return ``highest_<signal>``, and ``lowest_<signal>`` of a range that is not about 0."""
    highest = Constant(f"highest_{of.name}", of.high, of.unit, "end of its range", is_limit=True)
    lowest = Constant(f"lowest_{of.name}", of.low, of.unit, "end of its range", is_limit=True)
    return [highest] if of.low == -of.high else [highest, lowest]
