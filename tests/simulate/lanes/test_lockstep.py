"""Functions in lockstep: their results in order, their errors, and loops that cannot run in lanes."""

import time
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import casadi as ca
import numpy as np
import pytest

from synth.app import standard_tasks
from synth.simulate.integration import Integration
from synth.simulate.lanes import lanes, lockstep
from synth.simulate.rig import Rig, Simulate
from tests import levitator

pytestmark = pytest.mark.slow
PID = levitator.design()
STEPS = Integration(4, 0.0)
Function = Callable[[Simulate], float]


@pytest.fixture(scope="module")
def rig() -> Rig:
    return standard_tasks.rig(PID.DESIGN, np.float64)


def peak(rig: Rig, mass: float, duration_s: float = 0.05, times: int = 1) -> Function:
    """Return a function that measures how far z moves from a start, over one or more runs."""

    def run(simulate: Simulate) -> float:
        machine = replace(rig, plant=rig.plant.with_parameters(M=mass), simulate=simulate)
        return max(float(np.abs(machine.run(duration_s, {"z": 1e-4})["z"]).max()) for _ in range(times))

    return run


def test_results_are_those_of_single_runs_in_order(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    batches: list[int] = []
    simulate = lanes.LaneLoop.simulate

    def counted(self: lanes.LaneLoop, plants: list, scenarios: list, *options: object) -> list:
        batches.append(len(plants))
        return simulate(self, plants, scenarios, *options)  # type: ignore[arg-type]

    monkeypatch.setattr(lanes.LaneLoop, "simulate", counted)
    masses = [1.2, 1.1, 1.3, 1.25]
    functions = [peak(rig, m, times=2 if m == 1.1 else 1) for m in masses]
    alone = [f(rig.simulate) for f in functions]
    results = lockstep.run(functions, [rig.plant], STEPS)
    np.testing.assert_allclose([r.value for r in results], alone, rtol=1e-7)
    assert batches == [4, 1], "all functions together, then the second run of one"


def test_runs_of_different_durations_meet_too(rig: Rig) -> None:
    results = lockstep.run([peak(rig, 1.2, 0.05), peak(rig, 1.2, 0.1)], [rig.plant], STEPS)
    assert all(r.error is None for r in results) and results[1].value >= results[0].value > 0  # type: ignore[operator]


def test_an_error_stays_with_its_function(rig: Rig) -> None:
    def broken(simulate: Simulate) -> float:
        raise ZeroDivisionError("planted")

    def unknown(simulate: Simulate) -> float:
        return float(replace(rig, simulate=simulate).run(0.05, {"no_state": 1.0})["z"][0])

    results = lockstep.run([peak(rig, 1.2), broken, unknown], [rig.plant], STEPS)
    assert results[0].error is None and results[0].value is not None
    assert isinstance(results[1].error, ZeroDivisionError)
    assert "no_state" in str(results[2].error)


def test_an_error_of_the_server_reaches_every_function(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError("planted")

    monkeypatch.setattr(lockstep, "_serve", broken)
    results = lockstep.run([peak(rig, 1.2), peak(rig, 1.3)], [rig.plant], STEPS)
    assert [type(r.error) for r in results] == [ZeroDivisionError] * 2


def test_what_cannot_run_in_lanes_runs_alone(rig: Rig) -> None:
    x, t = ca.SX.sym("x", len(rig.plant.states)), ca.SX.sym("t")
    pushed = replace(rig, disturbance=ca.Function("d", [x, t], [ca.SX.ones(len(rig.plant.states)) * 0.1]))
    functions = [peak(pushed, 1.2), peak(pushed, 1.3), peak(rig, 1.2)]
    alone = [f(rig.simulate) for f in functions]
    results = [r.value for r in lockstep.run(functions, [rig.plant], STEPS)]
    assert results[:2] == alone[:2] and results[2] == pytest.approx(alone[2], rel=1e-7)


def test_a_plant_of_a_second_form_runs_in_lanes_too(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    f = rig.plant.f
    second = replace(rig.plant, f=ca.Function("f", f.sx_in(), f.call(f.sx_in())))
    monkeypatch.setattr(lockstep, "_serve_alone", lambda call: pytest.fail("runs alone"))
    functions = [peak(rig, 1.2), peak(replace(rig, plant=second), 1.2)]
    first, other = lockstep.run(functions, [rig.plant, second], STEPS)
    assert first.value == other.value


def test_the_next_functions_record_what_these_read(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    reads: list[set[tuple[str, str]]] = []
    first = lockstep.run([peak(rig, 1.2, times=2)], [rig.plant], STEPS, reads)
    assert reads == [{("states", "z")}] * 2
    assert lockstep.run([peak(rig, 1.2, times=2)], [rig.plant], STEPS, reads) == first
    runs: list[int] = []
    call = lanes.lane_blocks.call
    monkeypatch.setattr(lanes.lane_blocks, "call", lambda *a: (runs.append(a[1]["wides"]), call(*a))[1])
    reads = [{("states", "x")}] * 2
    assert lockstep.run([peak(rig, 1.2)], [rig.plant], STEPS, reads) == lockstep.run(
        [peak(rig, 1.2)], [rig.plant], STEPS
    )
    everything = len(rig.plant.states) + len(rig.plant.outputs) + len(rig.plant.inputs)
    assert runs == [1, everything, everything], "a column that is missing costs one more run, which records all"


def test_a_plant_of_other_equations_runs_alone(rig: Rig) -> None:
    other = levitator.design().DESIGN.plant
    rebuilt = replace(rig, plant=replace(other, f=ca.Function("f", other.f.sx_in(), other.f.call(other.f.sx_in()))))
    (results,) = lockstep.run([peak(rebuilt, 1.2)], [rig.plant], STEPS)
    assert results.value == peak(rebuilt, 1.2)(rig.simulate)


def test_the_functions_run_one_at_a_time(rig: Rig) -> None:
    made: list[int] = []

    @cache
    def prepare() -> int:
        made.append(1)
        time.sleep(0.02)  # another thread would come here meanwhile
        return 1

    def function(simulate: Simulate) -> float:
        return prepare() * peak(rig, 3.0)(simulate)

    results = lockstep.run([function] * 4, [rig.plant], STEPS)
    assert all(r.error is None for r in results) and len(made) == 1
