"""The LQG loops that the report shows: each kind is the analytic one, (42) is refused, and what its text says."""

import numpy as np
import pytest

from designs.planar_6dof import allocation, lqg
from designs.planar_6dof.allocation import AXES, HORIZONTAL, VERTICAL
from designs.planar_6dof.loops import OpenLoop
from designs.planar_6dof.lqg import TIME
from designs.planar_6dof_lqg import loops
from models import planar_stage
from synth.analyse.loops import disk
from synth.errors import ModelError
from synth.report import bode
from tests.designs.planar_6dof import analytic

PLANT = planar_stage.plant()
SINGLE = 2e-4  # relative, of constants in single precision where they cancel
Z = np.exp(2j * np.pi * np.geomspace(0.3, 350, 40) * TIME.period_s)
K = allocation.force_constant(PLANT)  # N/A, less than (26) has
MADE = {
    "x": K,
    "y": 2 * K,
    "phi": 2 * K * PLANT.parameter("a").value,
}  # per ampere of i_C, (i_A + i_B)/2, (i_B - i_A)/2
LoopsByKind = dict[tuple[str, str], OpenLoop]


@pytest.fixture(scope="module")
def by_kind() -> LoopsByKind:
    return {(o.signal, o.label): o for o in loops.all_loops(PLANT)}


def distance(o: OpenLoop, C: analytic.Transfer) -> float:
    return distance_of_loops(o, analytic.loop(PLANT, o.signal, C, TIME, False))


def distance_of_loops(o: OpenLoop, expected: analytic.Transfer) -> float:
    return float(np.abs(o.L.response(Z)[:, 0, 0] / expected(Z) - 1).max())


def printed(axis: str) -> analytic.Transfer:
    """Return (33) with K of (49): the rate from what is measured now, the last sum of errors, no sample ahead."""
    T, p, gain = TIME.period_s, lqg.OBSERVER_POLE[axis], -lqg.gain().K
    b = {"x": lqg.PER_AMPERE, "y": 2 * lqg.PER_AMPERE, "phi": 2 * lqg.YAW_PER_AMPERE}[axis]
    i, row = lqg.STATES.index(axis), gain[2 if axis == "x" else 1]
    k1, k3, k2, L = row[i], row[3 + i] * T, row[6 + i], (1 - p) / T

    def C(z: np.ndarray) -> np.ndarray:
        # i = -k1 - k2 (x3 + L) - k3 / (z - 1),  z x3 = p x3 - L (1 - p) + (b T - L b T^2/2) i
        fed = (b * T - L * b * T**2 / 2) / (z - p)
        i = (k1 + k2 * (L - L * (1 - p) / (z - p)) + k3 / (z - 1)) / (1 + k2 * fed)
        return i * MADE[axis]

    return C


def test_every_kind_is_the_analytic_loop(by_kind: LoopsByKind) -> None:
    for axis in HORIZONTAL:
        shipped, other = (analytic.optimal(PLANT, axis, w) for w in (lqg.WEIGHTS, lqg.PRINTED_WEIGHTS))
        assert distance(by_kind[axis, loops.SHIPPED], shipped) < SINGLE
        assert distance(by_kind[axis, loops.REWEIGHTED], other) < SINGLE
        paper = analytic.ideal_loop(PLANT, axis, printed(axis), TIME)
        assert distance_of_loops(by_kind[axis, loops.PRINTED], paper) < SINGLE
        assert (
            distance(by_kind[axis, loops.REWEIGHTED], shipped) > 0.1 < distance(by_kind[axis, loops.PRINTED], shipped)
        )
    for axis in VERTICAL:
        assert distance(by_kind[axis, loops.SHIPPED], analytic.lead_lag(axis, TIME)) < SINGLE
        assert distance(by_kind[axis, "as printed"], analytic.lead_lag(axis, TIME, published=True)) < SINGLE


def test_one_axis_as_printed_is_psi_that_is_not_stable(by_kind: LoopsByKind) -> None:
    assert [key for key, o in by_kind.items() if not o.margins.stable] == [("psi", "as printed")]
    assert len(by_kind) == 2 * len(AXES) + len(HORIZONTAL)
    assert max(by_kind[axis, loops.SHIPPED].margins.peak_sensitivity for axis in AXES) < 2.2


def test_the_whole_horizontal_loop() -> None:
    """Prediction and allocation gain margin, the printed weights more; S at the currents tells of motor C's yaw."""
    whole = loops.horizontals(PLANT)
    disks = {label: {cut: disk.of_loop(L) for cut, L in each.items()} for label, each in whole.items()}
    for cut in ("currents", "positions", "both"):
        least = [disks[label][cut].lower for label in (loops.PRINTED, loops.SHIPPED, loops.REWEIGHTED)]
        assert least == sorted(least) and all(d[cut].certified for d in disks.values())
    assert disks[loops.SHIPPED]["positions"].lower == pytest.approx(0.592, abs=2e-3)
    assert disks[loops.SHIPPED]["both"].lower == pytest.approx(0.290, abs=2e-3)
    frequency = np.geomspace(10, 2000, 100)
    peak = {label: bode.singular(each["currents"], frequency).S.max() for label, each in whole.items()}
    assert peak[loops.PRINTED] > 2 * peak[loops.SHIPPED]


def test_the_gain_of_42_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    assert "has the poles -1" in loops.rejection_message() and "does not decay" in loops.rejection_message()
    assert loops.gain_of_42()[0].tolist() == [1600, 0.0006, 0.0006, 1, 0, 0]
    good = np.hstack([240 * np.eye(3), np.zeros((3, 3))])
    monkeypatch.setattr(loops, "gain_of_42", lambda: good)
    with pytest.raises(ModelError, match="was accepted"):
        loops.rejection_message()
