"""Simulated seconds per second of processor time: the maglev loop in CasADi, in the loop of one machine, and in lanes.

    mapaccum     one sample of the loop as a CasADi function, compiled from CasADi's own C, folded by `mapaccum`
    closed_loop  the emitted C and CasADi's C of the plant in a C loop, the simulator of the experiments
    one lane     the fast plant and the controller as programs, one machine
    lanes        the same, 256 machines within their tolerances, side by side

All run the 4-DOF motion with encoders of 10 um and one sample of delay, the controller in single precision but for
CasADi, which has double alone; the runs in lanes end with all figures of the experiment. The first two take 2
Runge-Kutta steps a sample; lanes have the order and steps of least work whose error is at most 1e-8: the largest of any
state, relative to its range, in the same motion with ideal sensors and the controller in double, against 16 steps a
sample. Times are processor times of one thread, medians of alternating turns; a ratio is the median of the ratios
within a turn. What is set up once for a plant is not measured: the C of mapaccum with the plant's parameters, and the
polynomials of the one machine. The polynomials of the 256 machines are fitted in every turn. Bars: one lane 6 times
mapaccum, 256 machines 25 times.
"""

import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from time import process_time
from typing import Any

import casadi as ca
import numpy as np

from designs.maglev import experiments, motions, platen
from designs.maglev_5dof import design
from designs.maglev_5dof.experiments import LIMITS
from synth.app import standard_tasks, study_jobs
from synth.check import Check
from synth.plant import Plant
from synth.signals import signal_names
from synth.simulate import closed_loop, integration, sampling
from synth.simulate.experiments import Experiment
from synth.simulate.integration import Integration
from synth.simulate.lanes import lanes
from synth.simulate.lanes.lane_blocks import Recording
from synth.simulate.rig import Rig
from synth.simulate.scenario import Scenario, Trajectory

DURATION_S, MACHINES, TURNS, SUBSTEPS = 20.0, 256, 5, 2
STAGE = replace(study_jobs.stage_of(design.DESIGN), drive=None)


@dataclass(frozen=True)
class Speed:
    """Simulated seconds per second of one core, and how many times that of `mapaccum`."""

    name: str
    simulated_s: float
    times_mapaccum: float


@dataclass(frozen=True)
class Motion:
    """The 4-DOF motion as the experiment in which the steps of the lanes are chosen."""

    name: str = "motion"

    def run(self, rig: Rig) -> Experiment:
        """Run the motion."""
        trajectory, courses = motions.tracking(rig, True, DURATION_S)
        return Experiment(self.name, "", "", trajectory, (), courses)


class _Captured(Exception):
    """The scenario that an experiment would run."""


def scenario(rig: Rig, duration_s: float) -> Scenario:
    """Return the scenario of the 4-DOF motion."""

    def simulate(plant: Plant, controller: object, scenario: Scenario, *_: object, **__: object) -> Trajectory:
        raise _Captured(scenario)

    try:
        motions.tracking(replace(rig, simulate=simulate), True, duration_s)
    except _Captured as captured:
        motion: Scenario = captured.args[0]
        return motion
    raise AssertionError("the experiment ran no scenario")


def casadi_loop(motion: Scenario, samples: int) -> Callable[[], ca.DM]:
    """Return a call of the compiled loop over all samples, with the states of plant and controller and the commands."""
    plant, block = STAGE.plant, STAGE.controller.block
    x, z = ca.SX.sym("x", len(plant.states)), ca.SX.sym("z", len(block.states))
    waiting, references = ca.SX.sym("c", len(block.outputs)), ca.SX.sym("r", len(motion.references))
    outputs, commands = signal_names(plant.outputs), signal_names(block.outputs)
    u = ca.vcat([waiting[commands.index(str(motion.actuators[name]))] for name in signal_names(plant.inputs)])
    y = plant.h(x, u, plant.values)
    counts = {
        name: platen.RESOLUTION * ca.floor(y[outputs.index(of)] / platen.RESOLUTION + 0.5)
        for name, of in motion.sensors.items()
    }
    wired = counts | {name: references[k] for k, name in enumerate(motion.references)}
    z_next, c_next = block.function()(z, ca.vcat([wired[s.name] for s in block.inputs]))
    h, x_next = 1e-3 / SUBSTEPS, x
    for _ in range(SUBSTEPS):
        k1 = plant.f(x_next, u, plant.values)
        k2 = plant.f(x_next + h / 2 * k1, u, plant.values)
        k3 = plant.f(x_next + h / 2 * k2, u, plant.values)
        k4 = plant.f(x_next + h * k3, u, plant.values)
        x_next += h / 6 * (k1 + 2 * (k2 + k3) + k4)
    state, after = ca.vertcat(x, z, waiting), ca.vertcat(x_next, z_next, c_next)
    options: dict[str, Any] = {"jit": True, "compiler": "shell", "jit_options": {"flags": ["-O3", "-march=native"]}}
    sample = ca.Function("sample", [state, references], [after], {**options, "cse": True})
    folded = sample.mapaccum(samples)
    start = [motion.x0.get(s.name, 0.0) for s in plant.states] + [s.initial for s in block.states]
    start += [motion.hold.get(name, 0.0) for name in commands]
    courses = np.array([np.broadcast_to(c, samples) for c in motion.references.values()])
    return lambda: folded(start, courses)


def measure() -> tuple[list[Speed], Integration]:
    """Return the speeds, of which the first is that of mapaccum, and the steps in lanes with their error."""
    rig = standard_tasks.rig(STAGE, np.float32)
    motion = replace(scenario(rig, DURATION_S), substeps=SUBSTEPS)
    names = sampling.quantities(rig)
    z = sampling.draw(sampling.Sampling(MACHINES, 1), len(names), range(MACHINES))
    plants = [sampling.machine(rig, dict(zip(names, row, strict=True)), 1, k).plant for k, row in enumerate(z)]
    steps = integration.choose(standard_tasks.rig(STAGE, np.float64), Motion())
    alone, many = (
        _figures(lanes.compile_loop(STAGE.plant, rig.controller, lanes=n), motion, steps) for n in (1, lanes.LANES)
    )
    batches = [plants[k : k + lanes.LANES] for k in range(0, MACHINES, lanes.LANES)]
    runs: dict[str, tuple[int, Callable[[], object]]] = {
        "mapaccum": (1, casadi_loop(motion, round(DURATION_S * 1000))),
        "closed_loop": (1, lambda: closed_loop.simulate(STAGE.plant, rig.controller, motion)),
        "one lane": (1, lambda: alone([STAGE.plant])),
        f"lanes, {MACHINES} machines": (MACHINES, lambda: [many(batch) for batch in batches]),
    }
    turns = [
        {name: _simulated_per_second(machines, run) for name, (machines, run) in runs.items()} for _ in range(TURNS + 1)
    ][1:]
    speeds = [
        Speed(
            name,
            float(np.median([turn[name] for turn in turns])),
            float(np.median([turn[name] / turn["mapaccum"] for turn in turns])),
        )
        for name in runs
    ]
    return speeds, steps


def _figures(loop: lanes.LaneLoop, motion: Scenario, steps: Integration) -> Callable[[list[Plant]], object]:
    """Return a call that runs the motion of plants and computes all figures and checks of its experiment.

    The loop records what these figures read, as in a study, where the first batch shows it.
    """
    courses = {axis: np.asarray(motion.references[f"{axis}_ref"]) for axis in platen.COURSES}
    recording, scenario = Recording(), replace(motion, substeps=steps.substeps)

    def run(plants: list[Plant]) -> list[tuple[Mapping[str, float], tuple[Check, ...]]]:
        known = replace(recording, columns=frozenset(recording.read) if recording.read else None)
        trajectories = loop.simulate(plants, [scenario] * len(plants), steps.order, known)
        kept = [t for t in trajectories if t is not None]
        finished = (experiments.tracking_experiment(t, courses, LIMITS.tracking, 10.0, DURATION_S) for t in kept)
        return [(each.figures, each.checks) for each in finished]  # no trajectory, as in a study

    return run


def _simulated_per_second(machines: int, run: Callable[[], object]) -> float:
    start = process_time()
    run()
    return machines * DURATION_S / (process_time() - start)


def main() -> None:
    """Print the speeds and the error."""
    speeds, steps = measure()
    for speed in speeds:
        sys.stdout.write(
            f"{speed.name:24s} {speed.simulated_s:8.0f} simulated s/s   {speed.times_mapaccum:6.2f} times mapaccum\n"
        )
    sys.stdout.write(
        f"lanes: {steps.substeps} step of order {steps.order} a sample, largest error of a state {steps.error:.1e} of "
        f"its range (at most {integration.LARGEST_ERROR:g})\n"
    )


if __name__ == "__main__":
    main()
