"""The lead-lag loops that the report shows: those as printed are the analytic ones, and what its text says of them."""

import numpy as np
import pytest

from designs.planar_6dof.allocation import AXES, HORIZONTAL
from designs.planar_6dof.loops import OpenLoop
from designs.planar_6dof_leadlag import page as loops
from designs.planar_6dof_leadlag.control import TIME
from models import planar_stage
from tests.designs.planar_6dof import analytic

PLANT = planar_stage.plant()
SINGLE = 2e-4  # relative, of constants in single precision where they cancel
Z = np.exp(2j * np.pi * np.geomspace(0.3, 400, 40) * TIME.period_s)


@pytest.fixture(scope="module")
def by_kind() -> dict[tuple[str, str], OpenLoop]:
    return {(o.signal, o.label): o for o in loops.all_loops(PLANT)}


def distance(o: OpenLoop, published: bool, filtered: bool) -> float:
    expected = analytic.loop(PLANT, o.signal, analytic.lead_lag(o.signal, TIME, published), TIME, filtered)(Z)
    return float(np.abs(o.L.response(Z)[:, 0, 0] / expected - 1).max())


def test_every_kind_is_the_analytic_loop(by_kind: dict[tuple[str, str], OpenLoop]) -> None:
    for axis in AXES:
        assert distance(by_kind[axis, "as shipped"], False, True) < SINGLE
        assert distance(by_kind[axis, "as printed"], True, True) < SINGLE
        assert distance(by_kind[axis, "as printed"], False, True) > 0.1
    for axis in HORIZONTAL:
        assert distance(by_kind[axis, "as printed, unfiltered"], True, False) < SINGLE
        assert distance(by_kind[axis, "as printed, unfiltered"], True, True) > 0.1


def test_one_axis_as_printed_is_psi_that_is_not_stable(by_kind: dict[tuple[str, str], OpenLoop]) -> None:
    assert [key for key, o in by_kind.items() if not o.margins.stable] == [("psi", "as printed")]
    assert len(by_kind) == 2 * len(AXES) + len(HORIZONTAL)
    assert max(by_kind[axis, "as shipped"].margins.peak_sensitivity for axis in AXES) < 2.3
    assert by_kind["x", "as printed"].margins.phase_margin < 11
    assert by_kind["x", "as printed, unfiltered"].margins.phase_margin > 60
