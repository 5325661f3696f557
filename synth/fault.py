"""Fault word: the bits that a step returns, and the safe output after a latch.

What may fail, as a Block declares it for the table in the datasheet of its C: how it is noticed, and what follows.

Rows come from the Blocks that notice a failure, with the numbers that their laws have. A stage adds its own words by
the key of a row, such as which axis goes on and where the outputs end (`Stage.reactions`), and what its law
uses instead, where the Block that notices cannot know it (`Stage.used_instead`).
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from synth import arguments
from synth.errors import SignalError


@dataclass(frozen=True)
class Failure:
    """A row of the table: what fails, how it is noticed and when, what is used instead, and what the step does.

    `key` names the row for the words of a stage. The row says which bits are set: those of the refused `inputs` and of
    the `suspects`.
    """

    key: str
    what: str
    noticed: str
    instead: str
    reaction: str
    inputs: tuple[str, ...] = ()
    suspects: tuple[str, ...] = ()

    def renamed(self, names: Mapping[str, str]) -> "Failure":
        """Return the row with other names of signals, `names` from the present to the new ones, also in its texts."""

        def text(of: str) -> str:
            return re.sub(r"\w+", lambda word: names.get(word[0], word[0]), of)

        inputs, suspects = (tuple(names.get(n, n) for n in of) for of in (self.inputs, self.suspects))
        what, noticed, instead, reaction = map(text, (self.what, self.noticed, self.instead, self.reaction))
        return Failure(self.key, what, noticed, instead, reaction, inputs, suspects)


def with_reactions(
    failures: Sequence[Failure], reactions: Mapping[str, str], used_instead: Mapping[str, str]
) -> tuple[Failure, ...]:
    """Return the rows with the words of a stage: behind the reactions, and in place of what is used instead.

    Raises SignalError for words of a row that does not exist.
    """
    keys = [f.key for f in failures]
    if unknown := [key for key in (*reactions, *used_instead) if key not in keys]:
        raise SignalError(f"there is no failure '{unknown[0]}': give reactions to {', '.join(keys) or 'none'}")
    return tuple(
        replace(
            f,
            reaction="; ".join(filter(None, (f.reaction, reactions.get(f.key, "")))),
            instead=used_instead.get(f.key, f.instead),
        )
        for f in failures
    )


def enumeration(names: Sequence[str], word: str = "or") -> str:
    """Return names as text, with a word before the last one."""
    return f"{', '.join(names[:-1])} {word} {names[-1]}" if len(names) > 1 else "".join(names)


LATCH_BIT = 31  # of the fault word: it has latched
BRAKING_BIT = 30  # it brakes or lands before the latch


@dataclass(frozen=True)
class Fault:
    """One bit of the word that a step returns: `output` is the flag signal.

    `input` is the input that is out of range, `suspect` the one that contradicts others. `about` is the meaning of a
    bit that concerns no single input, or of one that is more than a range. Without any the bit reports the latch. A
    `status` bit says what the machine does, such as to follow a set-point late, and is no fault: no alarm counts it.
    """

    bit: int
    output: str
    input: str | None = None
    suspect: str | None = None
    about: str = ""
    status: bool = False

    def __post_init__(self) -> None:
        if self.status and (self.input or self.suspect or not self.about):
            raise SignalError(
                f"bit {self.bit} is a status, of input '{self.input}' and suspect '{self.suspect}', about "
                f"'{self.about}': give what it is about, and no input or suspect"
            )

    def renamed(self, names: Mapping[str, str]) -> "Fault":
        """Return the bit with its flag and inputs renamed, old name to new; an input without a bit is not refused."""
        input, suspect = (n if n is None else names.get(n, n) for n in (self.input, self.suspect))
        return replace(self, output=names.get(self.output, self.output), input=input, suspect=suspect)


@dataclass(frozen=True)
class Judgement:
    """A law that replaces and judges readings decides on the latch, by two of its flags.

    The guard counts the samples in which `counts` is 0; `at_once` latches in its sample. A law clears `counts` only in
    a sample with a refused one of the `measurements` or a suspect. It sets `at_once` only after too many such
    samples, as `Safety` counts them, which may have ended before.
    """

    counts: str
    at_once: str
    measurements: tuple[str, ...]


@arguments.checked
@dataclass(frozen=True)
class Safety:
    """After `bad_samples` samples in a row with a bad measurement the outputs slew to `safe_output`.

    Both mappings have the outputs of a Block as keys; an output in neither stays as computed. While the machine
    rests on the stop on which it has landed, those in `landed_output` slew to its values instead. `safe_output_effect`
    is what these values do to the machine. With a `judgement` a law decides which samples count. `braking` of these
    samples are the last before the latch, in which the step brakes. Where `good_samples` make up for a bad one, bad
    samples with fewer good ones between them latch, too; with 0 one good sample makes up for all before it.
    """

    bad_samples: int
    safe_output: Mapping[str, float]
    slew_per_s: Mapping[str, float]
    safe_output_effect: str
    judgement: Judgement | None = None
    braking: int = 0
    good_samples: int = 0
    landed_output: Mapping[str, float] = field(default_factory=dict)

    def renamed(self, names: Mapping[str, str]) -> "Safety":
        """Return the safety with outputs and measurements renamed, old name to new; other names stay."""
        mappings = self.safe_output, self.slew_per_s, self.landed_output
        values, rates, landed = ({names.get(n, n): v for n, v in of.items()} for of in mappings)
        judgement = self.judgement
        if judgement:
            judgement = replace(judgement, measurements=tuple(names.get(n, n) for n in judgement.measurements))
        return replace(self, safe_output=values, slew_per_s=rates, judgement=judgement, landed_output=landed)
