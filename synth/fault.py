"""Fault word: the bits that a step returns, and the safe output after a latch."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from synth import arguments

LATCH_BIT = 31  # of the fault word: it has latched
BRAKING_BIT = 30  # it brakes before the latch


@dataclass(frozen=True)
class Fault:
    """One bit of the word that a step returns: `output` is the flag signal.

    `input` is the input that is out of range, `suspect` the one that contradicts others. `about` is the meaning of a
    bit that concerns no single input. Without any of them the bit reports the latch.
    """

    bit: int
    output: str
    input: str | None = None
    suspect: str | None = None
    about: str = ""

    def renamed(self, names: Mapping[str, str]) -> "Fault":
        """Return the bit with its flag and inputs renamed, old name to new; an input without a bit is not refused."""
        input, suspect = (n if n is None else names.get(n, n) for n in (self.input, self.suspect))
        return replace(self, output=names.get(self.output, self.output), input=input, suspect=suspect)


@arguments.checked
@dataclass(frozen=True)
class Safety:
    """After `bad_samples` samples in a row with a bad measurement the outputs slew to `safe_output`.

    Both mappings have the outputs of a Block as keys; an output in neither stays as computed. `reason` explains
    these values. `braking` of these samples are the last before the latch, in which the step brakes.
    """

    bad_samples: int
    safe_output: Mapping[str, float]
    slew_per_s: Mapping[str, float]
    reason: str
    braking: int = 0
