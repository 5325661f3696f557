"""Tables of gains.json: control laws with the same entries share a table, one column per law.

{"y": {"K": [1, 2], "certificate": {"residual": 1e-9}}, "x": {...}}   ->   entry                    y      x
                                                                           K                        1, 2   ...
                                                                           certificate:
                                                                               residual                 1e-9   ...
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from synth.report.notation import number
from synth.show import Cell, Table

DIGITS = 6
_COMPLEX = re.compile(r"[-+.0-9ei]*[0-9]i?")
MAX_LAWS = 5  # largest number of laws in one table
MAX_LIST_LENGTH = 2  # largest list on one line in a table of several laws


def tables(document: Mapping[str, Any]) -> tuple[Table, ...]:
    """Return the tables of a document: entries of the whole design first, then the laws."""
    laws = {label: dict(_entries(law)) for label, law in _laws(document)}
    whole = {name: value for name, value in document.items() if not isinstance(value, Mapping)}
    rows = tuple((name, _cell(value)) for name, value in _entries(whole))
    first = (Table("Gains", ("entry", "value"), rows),) if rows else ()
    return (*first, *(table for group in _alike(laws) for table in _tables(group)))


def _laws(document: Mapping[str, Any]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Yield the laws with their names; a group of laws is expanded. The plant parameters are not a law."""
    for name, law in document.items():
        if not isinstance(law, Mapping) or name == "parameters":
            continue
        if law and all(isinstance(value, Mapping) for value in law.values()):
            yield from ((inner if inner == name else f"{name}, {inner}", value) for inner, value in law.items())
        else:
            yield name, law


def _alike(laws: Mapping[str, Mapping[str, Any]]) -> Iterator[dict[str, Mapping[str, Any]]]:
    """Yield groups of up to MAX_LAWS laws with the same entries."""
    waiting = dict(laws)
    while waiting:
        entries = set(next(iter(waiting.values())))
        group = [name for name, law in waiting.items() if set(law) == entries][:MAX_LAWS]
        yield {name: waiting.pop(name) for name in group}


def _tables(laws: Mapping[str, Mapping[str, Any]]) -> Iterator[Table]:
    """Yield a table of the entries that are equal in all laws, and one of the others with a column per law."""
    first, names = next(iter(laws.values())), ", ".join(laws)
    alike = [entry for entry in first if len(laws) > 1 and all(law[entry] == first[entry] for law in laws.values())]
    if alike:
        yield Table(
            f"Gains of {names}: the same for all", ("entry", "value"), tuple((e, _cell(first[e])) for e in alike)
        )
    rows: list[tuple[Cell, ...]] = []
    for entry in (e for e in first if e not in alike):
        rows.append((entry, *(_cell(law[entry], len(laws) > 1) for law in laws.values())))
    if rows:
        yield Table(f"Gains of {names}", ("entry", *laws), tuple(rows), DIGITS)


def _entries(law: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the entries with readable names; the name of a nested entry follows that of its parent."""
    for name, value in law.items():
        words = f"{above}{name.replace('_', ' ')}"
        if isinstance(value, Mapping):
            yield from _entries(value, f"{words}:\n")
        else:
            yield words, value


def _cell(value: Any, narrow: bool = False) -> str:
    """Return a value as text: a matrix by rows; in a `narrow` column a longer list has one entry per line."""
    if isinstance(value, str):
        return value.replace("-", "−") if _COMPLEX.fullmatch(value) else value
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "none"}[value]
    if isinstance(value, Sequence):
        nested = any(isinstance(v, Sequence) and not isinstance(v, str) for v in value)
        return ("\n" if nested or (narrow and len(value) > MAX_LIST_LENGTH) else ", ").join(_cell(v) for v in value)
    return number(value, DIGITS)
