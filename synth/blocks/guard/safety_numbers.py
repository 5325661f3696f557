"""Numbers of a guard that the C names: samples until the latch."""

from synth.block import Constant
from synth.blocks.guard import bad_samples
from synth.fault import BRAKING_BIT

MAY_LATCH_FROM = 2  # samples left, of a guard that brakes, before one that may latch


def about_left(braking: int) -> str:
    """Return what the count until the latch counts."""
    certain = f"; at {braking} and below each sample counts as bad" if braking else ""
    return f"samples with a bad measurement until it latches{certain}"


def latch(bad: int, braking: int, good_samples: int) -> list[Constant]:
    """Return the numbers of samples that the C names, for a latch after `bad` ones and those of `braking`."""
    about = "bad samples in a row until it latches"
    if not braking:
        return bad_samples.numbers("latch_samples", bad, good_samples, about)
    total = bad + braking
    about = f"{bad} bad samples in a row, and {braking} that count as bad whatever is measured, until it latches"
    certain = (
        f"of the {total}, left in the sample that first sets bit {BRAKING_BIT}; fewer are left in those that brake"
    )
    brakes = f"of the {total}, left in the first sample that brakes; from it on each one counts as bad"
    return [
        *bad_samples.numbers("latch_samples", total, good_samples, about),
        Constant("latch_certain_from", braking + 1, "1", certain, ("left",)),
        Constant("braking_from", braking, "1", brakes, ("left",)),
        Constant(
            "may_latch_from", MAY_LATCH_FROM, "1", f"of the {total}, left in the sample before the latch", ("left",)
        ),
    ]
