"""Integration of loops in lanes: the order and the steps a sample of the least work that a measured error allows."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from synth.errors import WiringError
from synth.execute import host
from synth.plant import Plant
from synth.simulate import closed_loop, experiments
from synth.simulate.lanes import lanes
from synth.simulate.rig import Rig
from synth.simulate.scenario import Scenario, Trajectory

TIGHT, LARGEST_ERROR = 16, 1e-8  # steps a sample; error of a state, of its range
CANDIDATES = ((1, 3), (1, 4), (1, 5), (2, 4), (2, 5), (4, 5), (8, 5))  # (steps, order), least work first: (order - 1)
RUNGE_KUTTA = ((1, 4), (2, 4), (4, 4), (8, 4))


@dataclass(frozen=True)
class Integration:
    """Steps of a sample period in lanes, the largest error of a state, relative to its range, and the order.

    The order is that of Nystroem's methods; a plant whose accelerations depend on velocities has order 4.
    """

    substeps: int
    error: float
    order: int = 5


@dataclass(frozen=True, eq=False)
class FirstRun:
    """What an experiment simulates first."""

    plant: Plant
    controller: host.Controller
    scenario: Scenario
    disturbed: bool
    drive: tuple[host.Controller, ...]


class _Captured(Exception):
    """The arguments of the first simulation."""


def first_run(rig: Rig, experiment: Any) -> FirstRun | None:
    """Return what an experiment would simulate first, without simulating it; None where it simulates nothing."""

    def capture(
        plant: Plant,
        controller: host.Controller,
        scenario: Scenario,
        disturbance: object = None,
        *,
        drive: tuple[host.Controller, ...] = (),
    ) -> Trajectory:
        raise _Captured(FirstRun(plant, controller, scenario, disturbance is not None, drive))

    try:
        experiments.result(experiment, replace(rig, simulate=capture))
    except _Captured as captured:
        run: FirstRun = captured.args[0]
        return run
    return None


def runs_in_lanes(rig: Rig, experiment: Any) -> bool:
    """Tell whether an experiment first simulates plant, controller and drive of the rig, without a disturbance."""
    run = first_run(rig, experiment)
    if run is None or run.disturbed or run.plant.f is not rig.plant.f:
        return False
    return run.controller is rig.controller and run.drive == rig.drive


def choose(rig: Rig, experiment: Any) -> Integration:
    """Return the least work whose error is at most LARGEST_ERROR, else the most, in the scenario of an experiment.

    The error is measured against TIGHT steps of `closed_loop` with ideal sensors; the rig has the controller in double
    precision, whose rounding the loop does not magnify to the size of this error.

    Raises EmitError and WiringError where the loop cannot run in lanes.
    """

    run = first_run(rig, experiment)
    if run is None:
        raise WiringError(f"experiment '{experiment.name}' simulates nothing: choose the steps in another one")
    if run.plant.f is not rig.plant.f:
        raise WiringError(f"experiment '{experiment.name}' changes the plant: choose the steps in another one")
    plant, controller, scenario = run.plant, run.controller, replace(run.scenario, encoders={}, noise={})
    tight = closed_loop.simulate(plant, controller, replace(scenario, substeps=TIGHT), drive=rig.drive)
    loop = lanes.compile_loop(rig.plant, controller, rig.drive, lanes=1)
    for substeps, order in _candidates(loop):
        (fast,) = loop.simulate([plant], [replace(scenario, substeps=substeps)], order)
        error = np.inf if fast is None else _distance(rig, fast, tight)
        if error <= LARGEST_ERROR:
            break
    return Integration(substeps, error, order)


def _candidates(loop: lanes.LaneLoop) -> Sequence[tuple[int, int]]:
    return CANDIDATES if loop.fast.second_order else RUNGE_KUTTA


def _distance(rig: Rig, first: Trajectory, second: Trajectory) -> float:
    spans = {s.name: s.high - s.low for s in rig.plant.states}
    return max(float(np.abs(first.states[n] - second.states[n]).max() / span) for n, span in spans.items())
