"""Names of signals as a caller gives them: one text, or a list of texts in any form that can be listed."""

from collections.abc import Iterable

from synth.errors import SignalError


def of(what: str, given: object) -> tuple[str, ...]:
    """Return names as a tuple, one text as a tuple of one.

    Raises SignalError, calling them `what`, for what is no list of texts, like a matrix of names.
    """
    if isinstance(given, str):
        return (str(given),)
    found = tuple(given) if isinstance(given, Iterable) else (None,)
    if not all(isinstance(name, str) for name in found):
        raise SignalError(f"the {what} are {given!r}: give names of signals, in one list")
    return tuple(str(name) for name in found)
