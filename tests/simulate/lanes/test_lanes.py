"""Loops in lanes against the loop of one machine: trajectories, bits of the controller, independence of the lanes."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from designs.maglev import motions
from designs.maglev_5dof import design
from models import maglev_stage
from synth.app import standard_tasks
from synth.errors import WiringError
from synth.plant import Plant
from synth.simulate import closed_loop, sampling
from synth.simulate.lanes import lanes
from synth.simulate.lanes.lane_blocks import Recording
from synth.simulate.rig import Rig
from synth.simulate.scenario import Encoder, InputFault, Override, Scenario, Trajectory
from tests import levitator

pytestmark = pytest.mark.slow

STAGE = replace(design.DESIGN, drive=None)
ERROR = 1e-8  # of a state's range: what a study may differ by from a tight integration


class Captured(Exception):
    """The scenario that an experiment would run."""


def scenario_of(rig: Rig, run: Callable[[Rig], object]) -> Scenario:
    """Return the first scenario that a function of the rig runs."""

    def simulate(plant: Plant, controller: object, scenario: Scenario, *_: object, **__: object) -> Trajectory:
        raise Captured(scenario)

    with pytest.raises(Captured) as caught:
        run(replace(rig, simulate=simulate))
    scenario: Scenario = caught.value.args[0]
    return scenario


def course(rig: Rig, duration_s: float = 2.0) -> Scenario:
    """Return the scenario of the 4-DOF motion."""
    return scenario_of(rig, lambda r: motions.tracking(r, True, duration_s))


def wrong_plants(rig: Rig, n: int) -> list[Plant]:
    names = sampling.quantities(rig)
    z = sampling.draw(sampling.Sampling(n, 3), len(names), range(n))
    return [sampling.machine(rig, dict(zip(names, row, strict=True)), 0, k).plant for k, row in enumerate(z)]


@pytest.fixture(scope="module")
def single() -> Rig:
    return standard_tasks.rig(STAGE, np.float32)


@pytest.fixture(scope="module")
def double() -> Rig:
    return standard_tasks.rig(STAGE, np.float64)


def distance(first: Trajectory, second: Trajectory, samples: slice = slice(None)) -> float:
    """Return the largest difference of the states in the samples, relative to their ranges."""
    spans = {s.name: s.high - s.low for s in maglev_stage.STATES}
    return max(float(np.abs(first.states[n] - second.states[n])[samples].max() / span) for n, span in spans.items())


def test_trajectories_agree_with_a_tight_integration(double: Rig) -> None:
    scenario, plants = replace(course(double), encoders={}), wrong_plants(double, 3)
    loop = lanes.compile_loop(STAGE.plant, double.controller)
    for plant, fast in zip(plants, loop.simulate(plants, [replace(scenario, substeps=1)] * 3), strict=True):
        tight = closed_loop.simulate(plant, double.controller, replace(scenario, substeps=16))
        assert fast is not None and distance(fast, tight) < ERROR
        assert (
            distance(fast, closed_loop.simulate(plants[-1 if plant is plants[0] else 0], double.controller, scenario))
            > ERROR
        )


@pytest.mark.parametrize("rig", ["single", "double"])
def test_the_controller_in_lanes_has_the_bits_of_the_c(rig: str, request: pytest.FixtureRequest) -> None:
    loaded: Rig = request.getfixturevalue(rig)
    plants, n = wrong_plants(loaded, lanes.LANES), 2000
    rng = np.random.default_rng(2)
    hostile = np.array([np.nan, np.inf, -np.inf, 1e30, 0.0])
    overrides = {
        name: Override(rng.uniform(size=n) < 0.002, rng.choice(hostile, n)) for name in ("y1", "y4", "x", "theta_ref")
    }
    scenario = replace(course(loaded), overrides=overrides, substeps=1)
    latched = 0
    for fast in lanes.compile_loop(STAGE.plant, loaded.controller).simulate(plants, [scenario] * len(plants)):
        assert fast is not None
        again = loaded.controller.replay(fast.measured)
        assert np.array_equal(again.faults, fast.faults)
        for name, column in again.outputs.items():
            assert column.tobytes() == fast.commands[name].tobytes(), name
        latched += int(fast.faults[-1] != 0)
        assert np.count_nonzero(fast.faults) > 5
    assert latched in range(lanes.LANES + 1)


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_a_drive_runs_behind_the_controller(scalar: type) -> None:
    rig = standard_tasks.rig(design.DESIGN, scalar)
    plants, scenario = wrong_plants(rig, 3), replace(course(rig, 0.5), encoders={}, substeps=1)
    lost = Override(np.arange(500) > 400, np.full(500, np.nan))
    for case in (scenario, replace(scenario, overrides=dict.fromkeys(("x", "y1", "y2", "y3"), lost))):
        fast = lanes.compile_loop(rig.plant, rig.controller, rig.drive).simulate(plants, [case] * 3)[2]
        assert fast is not None and rig.drive
        exact = closed_loop.simulate(plants[2], rig.controller, replace(case, substeps=16), drive=rig.drive)
        moving = slice(430)  # an impact comes at another moment with another step
        assert distance(fast, exact, moving) < (1e-4 if scalar is np.float32 else ERROR)
        assert np.array_equal(fast.faults, exact.faults)
        (name,) = exact.drive_faults
        assert np.array_equal(fast.drive_faults[name], exact.drive_faults[name])
        signals = {**fast.measured, **fast.commands}
        again = rig.drive[0].replay({n: signals[n] for n in rig.drive[0].inputs.names or ()})
        for phase, column in again.outputs.items():
            assert column.tobytes() == fast.driven[phase].tobytes(), phase
    assert fast.drive_faults[name].any() and fast.faults[-1] >> 31


def test_a_lane_does_not_depend_on_its_neighbours(single: Rig) -> None:
    scenario, plants = replace(course(single, 0.5), substeps=1), wrong_plants(single, 11)
    loop = lanes.compile_loop(STAGE.plant, single.controller)
    together = loop.simulate(plants, [scenario] * 11)
    for k in (0, 7, 10):
        (alone,) = loop.simulate([plants[k]], [scenario])
        both = (together[k], alone)
        assert all(t is not None for t in both)
        assert all(both[0].states[s].tobytes() == both[1].states[s].tobytes() for s in both[0].states)  # type: ignore[union-attr]


def test_a_scenario_without_noise_has_none_beside_one_with_it(single: Rig) -> None:
    silent = replace(course(single, 0.2), substeps=1)
    noisy = replace(silent, noise={"x": np.random.default_rng(7).normal(0.0, 1e-4, 200)})
    loop = lanes.compile_loop(STAGE.plant, single.controller)
    for order in ((noisy, silent), (silent, noisy)):
        both = loop.simulate([STAGE.plant] * 2, order)
        for scenario, together in zip(order, both, strict=True):
            (alone,) = loop.simulate([STAGE.plant], [scenario])
            assert together is not None and alone is not None
            assert together.states["x"].tobytes() == alone.states["x"].tobytes()


def test_a_recording_has_the_bits_of_the_whole_one(single: Rig) -> None:
    lost = {"x": Override(np.arange(500) == 333, np.nan)}
    scenario, plants = replace(course(single, 0.5), substeps=1, overrides=lost), wrong_plants(single, 3)
    loop = lanes.compile_loop(STAGE.plant, single.controller)
    chosen = frozenset({("states", "x"), ("commands", "i_d1"), ("applied", "i_d2")})
    whole, some = (loop.simulate(plants, [scenario] * 3, 5, Recording(c)) for c in (None, chosen))
    rare = loop.simulate(plants, [scenario] * 3, 5, Recording(chosen, every=7))
    for every, few, coarse in zip(whole, some, rare, strict=True):
        assert every is not None and few is not None and coarse is not None
        for group, name in (*chosen, ("outputs", "g1"), ("measured", "theta_ref")):
            column = getattr(every, group)[name]
            assert getattr(few, group)[name].tobytes() == column.tobytes(), "also where it was not recorded"
            assert getattr(coarse, group)[name].tobytes() == column[::7].tobytes()
        assert coarse.time.tolist() == every.time[::7].tolist()
        assert np.bitwise_or.reduce(every.faults[330:337]) == coarse.faults[48] != 0, "no fault between samples is lost"


@pytest.mark.parametrize("order", lanes.ORDERS)
def test_the_error_falls_with_the_order(double: Rig, order: int) -> None:
    scenario = replace(course(double), encoders={})
    loop = lanes.compile_loop(STAGE.plant, double.controller, error=1e-13)
    tight = closed_loop.simulate(STAGE.plant, double.controller, replace(scenario, substeps=16))
    errors = []
    for substeps in (1, 2):
        (fast,) = loop.simulate([STAGE.plant], [replace(scenario, substeps=substeps)], order)
        assert fast is not None
        errors.append(distance(fast, tight))
    assert errors[0] < {3: 3e-7, 4: ERROR, 5: ERROR / 10}[order]
    assert order == 5 or errors[1] < 0.8 * errors[0] / 2 ** (order - 1)


def test_stops_locks_delays_forcing_noise_and_sensor_errors() -> None:
    stage = levitator.design().DESIGN
    rig = standard_tasks.rig(stage, np.float64)
    loop = lanes.compile_loop(stage.plant, rig.controller)
    n, rng = 600, np.random.default_rng(4)
    noise = {"z": rng.normal(0, 1e-6, n), "x": rng.normal(0, 1e-6, n)}
    base = scenario_of(rig, stage.experiments[0].run)
    references = dict.fromkeys(base.references, 0.0)
    base = replace(base, duration_s=0.3, references=references, encoders={}, substeps=4)
    moving = {name: lambda t, k=k: 0.3 * np.sin(40 * t + k) for k, name in enumerate(base.forcing)}
    scenarios = [
        base,
        replace(base, delay=0),
        replace(base, delay=3, x0={"z": 2e-4}),
        replace(base, noise=noise, encoders={"z": Encoder(0.0, 3e-6, 0.01)}),
        replace(base, forcing=moving),
        replace(base, locked=("x",), x0={"z": -1e-4}),
        replace(base, stops={"z": (-1e-5, 1.5e-4)}, x0={"z": 1.2e-4}, references=references | {"z_ref": 3e-4}),
    ]
    for number, scenario in enumerate(scenarios):
        (fast,) = loop.simulate([stage.plant], [scenario])
        exact = closed_loop.simulate(
            stage.plant, rig.controller, replace(scenario, substeps=16 if not scenario.stops else 4)
        )
        assert fast is not None
        for name in exact.states:
            scale = max(np.abs(exact.states[name]).max(), 1e-9)
            assert np.abs(fast.states[name] - exact.states[name]).max() < 1e-6 * scale + 1e-12, (number, name)
        assert fast.impacts.keys() == exact.impacts.keys()
    assert exact.impacts["z"] > 1e-3 and fast.impacts["z"] == pytest.approx(exact.impacts["z"], rel=1e-6)


def test_sensors_in_lanes_count_as_encoders_do() -> None:
    stage = levitator.design().DESIGN
    rig = standard_tasks.rig(stage, np.float64)
    noise = {"z": np.random.default_rng(6).normal(0, 1e-6, 400)}
    encoder = Encoder(1e-6, 3e-6, 0.01)
    scenario = replace(
        scenario_of(rig, stage.experiments[0].run), duration_s=0.2, references={"z_ref": 0.0, "x_ref": 0.0}
    )
    scenario = replace(scenario, encoders={"z": encoder}, noise=noise)
    (fast,) = lanes.compile_loop(stage.plant, rig.controller).simulate([stage.plant], [scenario])
    assert fast is not None and np.ptp(fast.measured["z"]) > 5e-6
    counts = fast.measured["z"] / encoder.resolution
    np.testing.assert_allclose(counts, np.rint(counts), rtol=0, atol=1e-9)
    seen = 1.01 * fast.outputs["z"] + 3e-6 + noise["z"]
    assert np.abs(fast.measured["z"] - seen).max() <= 0.5e-6 + 1e-15
    wrapping = replace(scenario, encoders={"z": replace(encoder, span=4e-6, low=-1e-6)})
    (fast,) = lanes.compile_loop(stage.plant, rig.controller).simulate([stage.plant], [wrapping])
    assert fast is not None and -1.001e-6 < fast.measured["z"].min() < fast.measured["z"].max() < 3.001e-6
    turns = (wrapping.encoders["z"].read(fast.outputs["z"] + noise["z"] / 1.01) - fast.measured["z"]) / 4e-6
    np.testing.assert_allclose(turns, np.rint(turns), rtol=0, atol=1e-6)  # halves of counts may round otherwise


def test_a_lane_that_leaves_the_range_of_the_polynomials_has_no_result(single: Rig) -> None:
    scenario = replace(course(single, 0.3), substeps=1, stops={})
    heavy = STAGE.plant.with_parameters(M_y=40.0)
    loop = lanes.compile_loop(STAGE.plant, single.controller)
    kept, lost = loop.simulate([STAGE.plant, heavy], [scenario] * 2)
    assert kept is not None and lost is None


def test_what_lanes_cannot_run_is_refused(single: Rig) -> None:
    scenario, loop = replace(course(single, 0.1), substeps=1), lanes.compile_loop(STAGE.plant, single.controller)
    with pytest.raises(WiringError, match="scenarios differ in delay"):
        loop.simulate([STAGE.plant] * 2, [scenario, replace(scenario, delay=2)])
    with pytest.raises(WiringError, match="scenarios differ in overridden"):
        override = {"x": Override(np.ones(100, bool), 0.0)}
        loop.simulate([STAGE.plant] * 2, [scenario, replace(scenario, overrides=override)])
    with pytest.raises(WiringError, match="scenarios differ in overridden"):
        loop.simulate([STAGE.plant] * 2, [replace(scenario, overrides=override), scenario])
    with pytest.raises(WiringError, match="lanes simulate no input_faults"):
        loop.simulate([STAGE.plant], [replace(scenario, input_faults={"i_d1": InputFault(0.5, 0.0)})])
    with pytest.raises(WiringError, match="was loaded from C alone"):
        lanes.compile_loop(STAGE.plant, replace(single.controller, source=None))
