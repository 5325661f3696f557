"""Numbers of a limit that the C names: the ends of the range to which a Block limits a signal."""

from synth.block import Constant
from synth.signals import Signal


def ends(of: Signal) -> list[Constant]:
    """Return ``highest_<signal>`` and ``lowest_<signal>``, which the C has where the range is not about 0."""
    about = "end of its range"
    return [
        Constant(f"{end}_{of.name}", value, of.unit, about, is_limit=True)
        for end, value in (("highest", of.high), ("lowest", of.low))
    ]
