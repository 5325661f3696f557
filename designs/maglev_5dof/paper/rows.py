"""Audit of the maglev stage's paper, row by row: printed, recomputed, verdict.

Everything is computed from the parameters of the given plant. No verdict is stored.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from designs.maglev import platen
from designs.maglev_5dof.paper import closed_loop_runs, platen_figures
from designs.maglev_5dof.paper.closed_loop_runs import BY_GROUP, AuditSetup
from synth.declare.stage import Stage
from synth.report import audit
from synth.report.audit import Published, Row, Scope

FORMULAS = (closed_loop_runs, platen_figures)  # formulas may use all names of these modules


def rows(stage: Stage) -> Iterator[Row]:
    """Yield the rows F-1 to F-22 for the stage's parameters, each when it is computed."""
    return audit.rows(scope(AuditSetup(stage, stage.plant), published_rows()))


def scope(setup: AuditSetup, prints: Mapping[str, Published]) -> Scope:
    """Return the scope of the formulas; `setup` and `plant` take the parameters that a row depends on."""
    functions = {name: value for module in FORMULAS for name, value in vars(module).items()}
    functions |= {"setup": lambda **_: setup, "plant": lambda **_: setup.plant, "cells": setup.cells}
    functions |= {"mm": 1e-3, "I_rated": platen.RATED}
    return Scope({p.name: p.value for p in setup.plant.parameters}, functions, prints)


def published_rows() -> dict[str, Published]:
    """Return what the paper prints, by row, with the groups of parameters before each row's formulas."""
    prints = audit.read_rows(Path(__file__).parent).items()
    return {id: replace(p, computed={**BY_GROUP, **p.computed}) for id, p in prints}
