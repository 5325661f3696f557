"""What may fail, as a Block declares it for the table in the C's header: how it is noticed, and what follows.

Rows come from the Blocks that notice a failure, with the numbers that their laws have. A stage adds its own words by
the key of a row, such as which axis goes on and where the outputs end (`Stage.reactions`), and what its law
uses instead, where the Block that notices cannot know it (`Stage.used_instead`).
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

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
