"""Failures that a guard notices, as rows of the header's table."""

from collections.abc import Sequence
from typing import Protocol

from synth.failure import Failure, enumeration
from synth.signals import Signal

REFUSED = "not finite or outside its range"
INITIAL = "always its initial value"


class Guarded(Protocol):
    """An input of the guard, as `safety.GuardedInput` is."""

    @property
    def signal(self) -> Signal:
        """Its name, unit and range."""
        ...

    @property
    def initial(self) -> float:
        """Its value before the first good one."""
        ...

    @property
    def measurement(self) -> bool:
        """Whether it causes a latch."""
        ...

    @property
    def held(self) -> bool:
        """Whether its last good value replaces it."""
        ...


def of_guard(
    inputs: Sequence[Guarded], too_many: str, suspected: Sequence[str], redundant: bool, braking: int
) -> tuple[Failure, ...]:
    """Return the rows of measurements, of those that may be suspects, and of the other inputs.

    Behind a `redundant` guard another Block replaces measurements as soon as all were good in one sample. `too_many`
    says how many bad samples latch.
    """
    latches = f"brakes for {braking - 1} samples, then latches" if braking else "latches"
    together = f"{too_many}, of any of them: {latches}"
    rows = []
    for held in (True, False):
        names = [g.signal.name for g in inputs if g.measurement and g.held == held]
        what, key = f"{enumeration(names)} {REFUSED}", "refused" if held else "refused_not_held"
        if redundant:
            what, key = f"{what}, before all were good in one sample", "refused_at_first"
        reaction = f"the law goes on; {together}"
        instead = "what the others or a prediction say" if redundant else _instead(held)
        rows += [Failure(key, what, "in that sample", instead, reaction, tuple(names))] if names else []
    if suspected and not redundant:
        what = f"{enumeration(suspected)} contradicts the others"
        reaction = f"counts as refused: {together}"
        rows.append(Failure("suspected", what, "from the next sample on", "nothing", reaction, (), tuple(suspected)))
    for held in (True, False):
        names = [g.signal.name for g in inputs if not g.measurement and g.held == held]
        what, key = f"{enumeration(names)} {REFUSED}", "set_point" if held else "set_point_not_held"
        reaction = "the law goes on; never latches"
        rows += [Failure(key, what, "in that sample", _instead(held), reaction, tuple(names))] if names else []
    return tuple(rows)


def _instead(held: bool) -> str:
    return "its last good value" if held else INITIAL
