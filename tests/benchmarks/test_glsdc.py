"""Cost and Stanford diagram of beacon problems; a planted fault larger than the declared noise must show."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks import beacons, glsdc
from synth.blocks.estimate.glsdc_solution import Iteration
from synth.execute import cross
from synth.simulate import worst_case


def test_the_monitors_are_those_that_the_redundancy_allows() -> None:
    assert set(glsdc.monitors(beacons.ranges(2))) == {"none"}
    assert set(glsdc.monitors(beacons.ranges(3))) == {"none", "test"}
    assert set(glsdc.monitors(beacons.ranges(4))) == {"none", "test", "exclusion"}


def test_a_sample_of_ranges_costs_what_it_did() -> None:
    of = beacons.ranges(4)
    counted = {
        name: glsdc.count_instructions(beacons.block(of, monitor, iteration=Iteration(2)), of)
        for name, monitor in glsdc.monitors(of).items()
    }
    most = 1000 if "gcc" in cross.available() else 1200  # of zig
    assert counted["none"] < 550 and counted["none"] < counted["test"] < counted["exclusion"] < most


@pytest.mark.parametrize("monitor", ["test", "exclusion"])
def test_faults_of_every_size_mislead_no_more_than_allocated(monitor: str) -> None:
    of = beacons.ranges(6)
    integrity = replace(glsdc.monitors(of)[monitor], risk=1e-2)
    t = glsdc.trial(of, integrity, 5000)
    for i in range(2):
        diagram = worst_case.diagram(t.errors[:, i], t.levels[:, i], t.valid, limit=0.3)
        assert diagram.risk <= 1e-2 and diagram.availability > (0.9 if monitor == "exclusion" else 0.25)
        assert worst_case.diagram(t.errors[:, i], t.levels[:, i] / 4, t.valid, limit=0.3).risk > 1e-2


def test_every_body_has_a_fault_in_one_channel() -> None:
    of, rng = beacons.ranges(5), np.random.default_rng(1)
    q = beacons.draw(of, 1000, rng)
    y = glsdc.measurements(of, q, np.full(1000, 50.0), rng)
    faulty = np.abs(y - beacons.values(of, q)) > 25 * of.sigma
    assert (faulty.sum(axis=1) == 1).all() and faulty.any(axis=0).all()
