"""Missed calls: the fault bit of the count, in a Block, in a declared stage, in closed loop, and a planted defect."""

from collections.abc import Mapping
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from synth import stage, testing
from synth.app import standard_tasks
from synth.base.progress import silent
from synth.block import Block
from synth.blocks.guard import missed_calls
from synth.declare.fault_campaign import FaultCampaign
from synth.declare.stage import Stage
from synth.simulate import faulty
from synth.simulate.faults import campaign
from synth.simulate.faults.injections import Injection
from synth.simulate.rig import Rig
from synth.timing import Discrete
from synth.verify import agree, sampling
from tests import levitator

PID = levitator.design()
Columns = Mapping[str, np.ndarray]
TIME, LIMIT = Discrete(1e-3), 5
BLOCK = missed_calls.block(TIME, missed_calls.signal(LIMIT), 4)
GOOD = (0.0, -0.0, 5e-324, 1.0, 4.5, 5.0)
BAD = (np.nextafter(5.0, 6.0), 6.0, 1e300, -5e-324, -1.0, -1e300, np.inf, -np.inf, np.nan)


def flag(block: Block, count: float) -> int:
    return int(np.asarray(block.function()([], [count])[1]).item())


def without_count(block: Block) -> Block:
    """Return the planted defect: the Block ignores the count."""
    name = f"fault_{missed_calls.MISSED_CALLS}"
    return replace(block, output={**block.output, name: ca.SX(0)})


@pytest.mark.parametrize("count", [*GOOD, *BAD])
def test_the_bit_is_set_above_the_limit_and_for_what_is_no_count(count: float) -> None:
    assert flag(BLOCK, count) == (not 0 <= count <= LIMIT)
    assert flag(without_count(BLOCK), count) == 0


def counting_stage(limit: float = LIMIT) -> Stage:
    """Return the levitator's stage, whose caller counts missed calls."""
    interface = replace(PID.INTERFACE, missed_calls=missed_calls.signal(limit))
    laws = PID.DESIGN.controller.laws
    return replace(
        PID.DESIGN, controller=stage.controller("levitator_pid", PID.TIME, interface, laws), reference=reference
    )


def reference(x: Columns, u: Columns) -> tuple[Columns, Columns, np.ndarray]:
    after, outputs, word = PID.reference.step(x, u)
    too_many = ~((u["missed_calls"] >= 0) & (u["missed_calls"] <= LIMIT))
    return after, outputs, word | (too_many.astype(np.uint32) << 4)


@pytest.fixture(scope="module")
def rig() -> Rig:
    counted = counting_stage()
    short = replace(counted, faults=FaultCampaign(period_s=0.2, settle_s=0.1, watch_s=0.3, durations_s=(0.002, 0.004)))
    return campaign.with_stops(standard_tasks.rig(short, np.float32))


def test_a_stage_declares_the_count_once_and_gets_the_next_free_bit() -> None:
    sensors, points = [stage.Sensor("z"), stage.Sensor("x")], PID.INTERFACE.set_points
    around = {"sensors": sensors, "set_points": points, "actuators": PID.INTERFACE.actuators, "disturbances": ["hum"]}
    assert stage.interface(PID.PLANT, **around).missed_calls is None
    assert stage.interface(PID.PLANT, **around, missed_calls=LIMIT).inputs[-1] == missed_calls.signal(LIMIT)
    assert [f.bit for f in counting_stage().controller.block.faults] == [0, 1, 2, 3, 31, 4]
    assert "missed_calls" not in [s.name for s in PID.DESIGN.controller.block.inputs]


def test_the_witnesses_agree_and_a_controller_that_ignores_the_count_is_caught() -> None:
    block = counting_stage().controller.block
    steps = sampling.edge_steps(block, np.random.default_rng(5), 20_000)
    expected = agree.reference(reference)(*steps)
    bits = (expected.faults >> 4) & 1
    assert 0 < bits.sum() < len(bits)

    def differs(made: Block) -> int:
        observed = agree.casadi(made)(*steps)
        return agree.compare("", ("witness", expected), ("casadi", observed), None, block).faults_differ

    assert not differs(block)
    assert differs(without_count(block))
    assert not testing.undetected_defects(counting_stage())


def test_the_c_counts_any_bit_pattern(rig: Rig) -> None:
    at_rest = {name: np.full(len(GOOD + BAD), value) for name, value in rig.at_rest().items()}
    with np.errstate(over="ignore"):
        counts = np.array(GOOD + BAD).astype(np.float32)
    faults = rig.controller.replay(at_rest | {"missed_calls": counts}).faults
    np.testing.assert_array_equal(faults, np.where((counts >= 0) & (counts <= LIMIT), 0, 1 << 4))


def test_the_simulation_counts_the_calls_and_the_next_one_reports_too_many(rig: Rig) -> None:
    k = np.arange(400)
    missed = ((k >= 100) & (k < 105)) | ((k >= 200) & (k < 206)) | ((k >= 300) & (k % 2 == 0))
    run = rig.run(400 * rig.period_s, missed=missed)
    counts = run.measured["missed_calls"]
    assert (counts[100], counts[105], counts[106], counts[206], counts[301]) == (0, 5, 0, 6, 1)
    np.testing.assert_array_equal(np.flatnonzero(run.faults), [206])
    assert rig.run(0.01).measured["missed_calls"].max() == 0
    np.testing.assert_array_equal(faulty.missed_counts(np.array([True, True, False, True])), [0, 0, 1, 0])


def test_the_campaign_notices_missing_calls_above_the_limit_alone(rig: Rig) -> None:
    in_motion = campaign.motion_and_standstill(rig)[1]
    tolerated, missing, alternate = (
        campaign.run(rig, 0, in_motion, silent, [Injection("calls", "calls", kind, duration)])[1][0]
        for kind, duration in (("missing", "0.002 s"), ("missing", "0.004 s"), ("alternate", "permanent"))
    )
    assert tolerated.notice_s == alternate.notice_s == np.inf and tolerated.effect
    assert missing.notice_s == pytest.approx(0.004) and missing.named and not missing.wrong_names


def test_a_variant_without_the_count_runs_in_the_same_rig(rig: Rig) -> None:
    alone = replace(rig, controller=standard_tasks.compiled_controller(PID.DESIGN, np.float32))
    assert "missed_calls" not in alone.run(0.01, missed=np.zeros(20, bool)).measured
    assert "missed_calls" not in alone.at_rest()
