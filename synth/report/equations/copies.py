"""Equations of equal form: shown once, with the names that the others have instead.

Two equations have equal form when renaming the symbols of one, as displayed, gives the other.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import sympy as sp

from synth.report.equations import symbolic
from synth.report.equations.derive import Equation, Group

MIN_OPERATIONS = 4  # operations: shorter equations are shown in full


@dataclass(frozen=True)
class EquationWithCopies:
    """A displayed equation, and the equations of equal form with their replaced names."""

    equation: Equation
    copies: tuple[tuple[Equation, Mapping[str, str]], ...] = ()


@dataclass(frozen=True)
class GroupWithCopies:
    """A displayed group of equations, and the groups of equal form with their replaced names."""

    group: Group
    equations: tuple[EquationWithCopies, ...]
    copies: tuple[tuple[Group, Mapping[str, str]], ...] = ()


def of_groups(groups: Sequence[Group]) -> tuple[GroupWithCopies, ...]:
    """Return the distinct groups, each with the groups of equal form."""
    first: list[tuple[Group, list[tuple[Group, Mapping[str, str]]]]] = []
    for group in groups:
        for source, copies in first:
            if (names := _group_names(source, group)) is not None:
                copies.append((group, names))
                break
        else:
            first.append((group, []))
    return tuple(GroupWithCopies(g, of_equations(g), tuple(copies)) for g, copies in first)


def of_equations(group: Group) -> tuple[EquationWithCopies, ...]:
    """Return the distinct equations of a group, each with the equations of equal form."""
    first: list[tuple[Equation, list[tuple[Equation, Mapping[str, str]]]]] = []
    for equation in group.equations:
        for source, copies in first:
            if sp.count_ops(source.shown) < MIN_OPERATIONS or source.mark != equation.mark:
                continue
            if (names := names_in_place(source, equation)) is not None:
                copies.append((equation, names))
                break
        else:
            first.append((equation, []))
    return tuple(EquationWithCopies(e, tuple(copies)) for e, copies in first)


def names_in_place(source: Equation, other: Equation) -> dict[str, str] | None:
    """Return the renaming that turns the right side of one equation into that of the other, None without one."""
    if source.shape[0] != other.shape[0] or len(source.shape[1]) != len(other.shape[1]):
        return None
    names = dict(zip(source.shape[1], other.shape[1], strict=True))
    changed = {symbolic.symbol(a): symbolic.symbol(b) for a, b in names.items()}
    if source.shown.xreplace(changed) != other.shown:
        return None
    return {a: b for a, b in names.items() if a != b}


def _group_names(source: Group, other: Group) -> dict[str, str] | None:
    """Return the renaming of displayed names that turns one group into the other, None without one."""
    if len(source.equations) != len(other.equations) or source.title == other.title:
        return None
    whole: dict[str, str] = {}
    for a, b in zip(source.equations, other.equations, strict=True):
        names = names_in_place(a, b)
        if names is None or a.mark != b.mark:
            return None
        names = dict(zip(a.shape[1], b.shape[1], strict=True)) | {a.name: b.name}
        if any(whole.get(k, v) != v for k, v in names.items()):
            return None
        whole |= names
    parts = {e.name for e in source.equations if e.signal is None}
    shown = {source.name(a): other.name(b) for a, b in whole.items() if a not in parts}
    return {a: b for a, b in shown.items() if a != b} if len(set(whole.values())) == len(whole) else None
