"""Numbers of guard and safe output that the C names: samples until the latch, safe values, changes in a sample."""

from collections.abc import Mapping, Sequence
from itertools import takewhile

from synth.block import Constant, Safety
from synth.blocks import bad_samples
from synth.fault import BRAKING_BIT
from synth.signals import Signal
from synth.timing import Discrete


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
    ]


def slew(time: Discrete, outputs: Sequence[Signal], safety: Safety) -> list[Constant]:
    """Return the safe values and the largest changes in a sample, each once under a name of its outputs."""
    values, rates = (_by_value(outputs, of) for of in (safety.safe_output, safety.slew_per_s))
    return [
        *(Constant(f"safe_{_together(group)}", v, group[0].unit, "safe output") for v, group in values.items()),
        *(
            Constant(
                "slew_step" if len(rates) == 1 else f"slew_{_together(group)}",
                rate * time.period_s,
                group[0].unit,
                f"{rate:g} {group[0].unit}/s times {time.period_s:g} s",
            )
            for rate, group in rates.items()
        ),
    ]


def _by_value(outputs: Sequence[Signal], of: Mapping[str, float]) -> dict[float, list[Signal]]:
    groups: dict[float, list[Signal]] = {}
    for s in outputs:
        groups.setdefault(of[s.name], []).append(s)
    return groups


def _together(group: Sequence[Signal]) -> str:
    """Return the beginning that the names of several signals share, else the first name."""
    alike = takewhile(lambda letters: len(set(letters)) == 1, zip(*(s.name for s in group), strict=False))
    shared = "".join(letters[0] for letters in alike).rstrip("_0123456789")
    return shared if shared and len(group) > 1 else group[0].name
