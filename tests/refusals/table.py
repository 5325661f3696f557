"""Refused calls as tables: a function, a part of the message, and what differs from a valid call.

The valid call is that of the hostile calls (`tests.hostile`), which replace each argument by each wrong kind of value
and demand an error of ours. A table holds what they cannot ask for: conditions that are mathematics, with the quantity,
what was found, what is needed and the mend.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import pytest

from tests.hostile import search


class Call(NamedTuple):
    """A call with the arguments in which it differs from a valid one, and a part of its message."""

    function: Callable[..., Any]
    part: str
    changed: Mapping[str, Any]


def call(function: Callable[..., Any], part: str, /, **changed: Any) -> Call:
    """Return the row of a table; "..." stands for any text in the part of the message."""
    return Call(function, part, changed)


def name(function: Callable[..., Any]) -> str:
    """Return the name of a function under which it has an example, as `lqr.lqrd`."""
    return f"{function.__module__.rpartition('.')[2]}.{getattr(function, '__qualname__', 'call')}"


def refuse(row: Call) -> None:
    """Call the function; one without an example gets the arguments of the row alone."""
    if row.function not in search.library().values():
        row.function(**row.changed)
    else:
        search.call(row.function, {**search.example(name(row.function), row.function), **row.changed})


def refusals(error: type[Exception], rows: Sequence[Call]) -> Callable[..., None]:
    """Return the test of a table."""

    @pytest.mark.parametrize("row", [pytest.param(row, id=f"{name(row.function)}-{k}") for k, row in enumerate(rows)])
    def test(row: Call) -> None:
        with pytest.raises(error, match=".*".join(map(re.escape, row.part.split("...")))):
            refuse(row)

    return test
