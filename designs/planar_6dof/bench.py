"""Which steps of the planar controllers are measured and replayed.

    closed loops      every experiment, with its noise and failures, and the replay
    travel            through all pitches both ways and all sections, yaw to its ends, far from set-points or near them
    failures          from samples of the travel on: a Hall channel, a sensor, an axis or all wrong in one of six ways
    latches, corners  measurements bad for good while the currents are large; inputs on the ends of their ranges
    faults, edges     every input bad up to the latch; every input on the last number that is accepted and on the next
    random            states and inputs drawn anywhere, and samples of the travel with some states drawn anew
    rare              of many more of these, those that reach the end of a range, and those whose flags few others have

States come from recorded runs or are drawn by the manifest: nothing here knows what a law remembers.
"""

from collections.abc import Callable, Mapping, Sequence
from itertools import product
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from designs.planar_6dof import allocation, interface, sensing
from designs.planar_6dof import loop as loops
from designs.planar_6dof.loop import Array, simulate
from models import hall_calibration, planar_stage
from synth.block import Block
from synth.execute import host
from synth.signals import names
from synth.simulate.experiment import Experiment
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory
from synth.simulate.sensors import Override
from synth.verify import steps
from synth.verify.steps import Steps
from synth.workspace import Bench

FLOOR = 1.0  # A, below which a difference of currents is absolute: a phase is a projection of up to 1.26 A
REPLAY = 10_000  # steps
EACH = 1000  # steps of each experiment at most, spread over all of it
TRAVEL, TURNED = 16_000, 5  # steps; how often each is taken with other states or failures
DRAWN, RARE = 5000, 2500  # steps of each kind
EACH_END, NEAR = 60, 1e-5  # steps for an end of a range, and what is near it, of the range
SHAKEN = 20, 1e-3  # how often, and how much of the range at most
LATCHED = (40, 333, 1111, 2500, 5007)  # samples of the travel at which measurements end
HELD, KEPT = 1000, 20  # steps until the loops stand at their ends, and the first and last of them
PERIODS = {"x": 1370, "y": 1690, "phi": 913, "z": 251, "theta": 317, "psi": 173}  # samples, of the travel
YAWS = (1.0, 0.3, 0.1, 0.03, 0.0)  # of the yaw's range: polynomials make a turned motor's current a little smaller
SEED = 1975
SENSORS = (*planar_stage.HALL, *planar_stage.LASERS)
REACH = {axis: allocation.BOX[axis].high for axis in allocation.AXES}  # m, rad
GROUPS = (
    *((name,) for name in planar_stage.HALL),
    *(tuple(n for n in planar_stage.HALL if n[place] == which) for place, which in ((2, "a"), (2, "b"), (2, "c"))),
    *(tuple(n for n in planar_stage.HALL if n[3] == axis) for axis in "xy"),
    planar_stage.HALL,
)
BOUND = sensing.RESIDUAL * hall_calibration.of(planar_stage.plant()).amplitude  # V, from which on two sensors disagree
Progress = Callable[[str], None]
Columns = dict[str, NDArray[Any]]


def of(block: Callable[[], Block], experiments: Callable[[Rig, Progress], Sequence[Experiment]]) -> Bench:
    """Return what is measured of a design, by its controller and what runs its experiments."""

    def sequences(controller: host.Controller, progress: Progress) -> list[Steps]:
        progress("sequences")
        return [*closed_loops(loops.of(block(), controller), experiments), *excursions(controller)]

    return Bench(block, lambda controller: replay(loops.of(block(), controller)), sequences, FLOOR)


def replay(loop: Rig) -> Columns:
    """Return the controller's inputs (10,000,) on a curve through the pitches, with bad samples and the latch."""
    return dict(_replayed(loop).measured)


def excursions(controller: host.Controller) -> list[Steps]:
    """Return what no closed loop is needed for."""
    rng = np.random.default_rng(SEED)
    way = steps.recorded(controller, "travel", travel(rng))
    far = steps.joined("saturated", [steps.recorded(controller, "", travel(rng, yaw)) for yaw in YAWS])
    wrong = _wrong(controller, way, rng)
    return [
        *(steps.thinned(each, DRAWN) for each in (way, far, *wrong)),
        latches(controller, far.part(slice(0, TRAVEL))),
        corners(controller),
        steps.faulty(controller, at_rest()),
        steps.edges(controller, way),
        steps.in_range(controller, DRAWN // 4),
        steps.drawn(controller, DRAWN),
        *(steps.rare(controller, pool, RARE) for pool in wrong),
        *(steps.at_ends(controller, pool, EACH_END) for pool in wrong[-2:]),
        _extreme(controller, far),
    ]


def _wrong(controller: host.Controller, way: Steps, rng: np.random.Generator) -> list[Steps]:
    """Return failures on the way, in one sample, in two and once named, and both with and without them states anew."""
    many = steps.joined("travel", [way] * TURNED)
    once = failures(many, rng)
    again = Steps("failures, again", steps.taken(controller, once).states, once.inputs)
    named = Steps("failures, named", steps.taken(controller, again).states, once.inputs)
    return [once, again, named, *(steps.anew(controller, pool, f"{pool.name}, states anew") for pool in (many, once))]


def _extreme(controller: host.Controller, far: Steps) -> Steps:
    """Return steps whose currents come to their ends, by rounding even beyond: near ones are shaken until some do."""
    found = steps.at_ends(controller, far, EACH_END, NEAR)
    for _ in range(2):
        found = steps.at_ends(controller, steps.shaken(controller, found, "shaken", *SHAKEN), EACH_END)
    return found


def closed_loops(loop: Rig, run: Callable[[Rig, Progress], Sequence[Experiment]]) -> list[Steps]:
    """Return steps of each experiment under the loop's controller, and of the replay."""
    runs = {e.name: e.trajectory for e in run(loop, lambda _: None)} | {"replay": _replayed(loop)}
    found = [steps.recorded(loop.controller, name, r.measured, closed_loop=True) for name, r in runs.items()]
    return [steps.thinned(each, EACH) for each in found]


def _replayed(loop: Rig) -> Trajectory:
    """Run the replay: bad samples alone and in runs, and a channel that drops to zero until it latches."""
    duration, k = REPLAY * loop.period_s, np.arange(REPLAY)
    angle = 2 * np.pi * k / REPLAY
    wanted = {"x": 0.06 * np.sin(3 * angle), "y": 0.05 * np.sin(2 * angle), "phi": 0.004 * np.sin(5 * angle)}
    wanted |= {"z": 5e-5 * np.sin(7 * angle), "theta": np.where(k % 300 == 7, 1.0, 0.0)}
    bad = {
        "V_by": (k % 250 == 1, np.nan),
        "d2": ((k > 4100) & (k < 4105), np.inf),
        "V_ax": ((k == 6100) | (k > 9500), 0.0),
        "V_cy": ((k >= 7100) & (k < 7103), -6.0),
    }
    overrides = {name: Override(mask, np.full(REPLAY, value)) for name, (mask, value) in bad.items()}
    return simulate(loop, duration, wanted, {}, overrides=overrides)


def seen(pose: Mapping[str, Array]) -> Columns:
    """Return what the sensors read without noise, V and m, at poses (N,) by axis, m and rad."""
    plant = planar_stage.plant()
    x, u, _ = plant.h.sx_in()
    h = ca.Function("h", [x, u], [plant.h(x, u, plant.values)])
    at = {**dict.fromkeys(names(plant.states), np.zeros(len(pose["x"]))), **pose}
    read = np.asarray(h(np.array(list(at.values())), np.zeros((len(names(plant.inputs)), len(pose["x"])))))
    columns = dict(zip(names(plant.outputs), read, strict=True))
    return {name: columns[name] for name in SENSORS}


def at_rest() -> dict[str, float]:
    """Return inputs in the middle of the travel, set-points there."""
    read = seen({axis: np.zeros(1) for axis in allocation.AXES})
    return {name: float(column[0]) for name, column in read.items()} | {f"{axis}_ref": 0.0 for axis in allocation.AXES}


def poses(rng: np.random.Generator, yaw: float = 1.0) -> dict[str, Array]:
    """Return the poses (N,) of a travel, m and rad: sines from the middle that stay at their ends for some time.

    That of the yaw is `yaw` of its range.
    """
    periods = {axis: n * rng.uniform(0.9, 1.1) for axis, n in PERIODS.items()}
    sines = {axis: np.sin(2 * np.pi / n * np.arange(TRAVEL)) for axis, n in periods.items()}
    found = {axis: REACH[axis] * np.clip(1.035 * sine, -1, 1) for axis, sine in sines.items()}
    return found | {"phi": yaw * found["phi"]}


def travel(rng: np.random.Generator, far: float | None = None) -> Columns:
    """Return inputs (N,) along a travel with noise; set-points are off by any order of magnitude, half of them alike.

    With `far`, then a part of the yaw's range, those of z, theta and psi are off by more than the motors can do, and at
    half of the samples all are.
    """
    at, noise = poses(rng, 1.0 if far is None else far), interface.INTERFACE.sensors[0].noise
    columns = seen(at)
    for name in planar_stage.HALL:
        columns[name] = columns[name] + rng.normal(0, noise, TRAVEL)
    together, sizes = rng.uniform(size=TRAVEL) < 0.5, 10.0 ** rng.uniform(-5, 1, (len(REACH), TRAVEL))
    for (axis, high), size in zip(REACH.items(), sizes, strict=True):
        alike = sizes[0] if far is None else 2
        part = alike if far is not None and axis in allocation.VERTICAL else np.where(together, alike, size)
        columns[f"{axis}_ref"] = np.clip(at[axis] + high * part * rng.choice((-1, 1), TRAVEL), -high, high)
    return columns


def failures(sound: Steps, rng: np.random.Generator) -> Steps:
    """Return steps in each of which the Hall voltages of one of GROUPS are wrong, all in the same way."""
    inputs, n = sound.inputs.copy(), len(sound)
    group, way, other = rng.integers(0, len(GROUPS), n), rng.choice((0, 1, 2, 3, 4, 4, 4, 5), n), rng.permutation(n)
    for name in planar_stage.HALL:
        v, sign, high = sound.inputs[name], rng.choice((-1, 1), n), sensing.VOLTAGE
        slightly, any_size = rng.uniform(0.9, 1.1, n) * BOUND, 10.0 ** rng.uniform(-2, 0.5, n)
        ways = (
            np.zeros(n),
            v[other],
            v * (1 + sign * any_size / 3),
            v + sign * any_size,
            v + sign * slightly,
            sign * high,
        )
        failed = np.isin(group, [g for g, names in enumerate(GROUPS) if name in names])
        inputs[name] = np.where(failed, np.clip(np.choose(way, ways), -high, high), v)
    return Steps("failures", sound.states, inputs)


def latches(controller: host.Controller, way: Steps) -> Steps:
    """Record how the currents of the travel are taken away: from some of its samples on no measurement is good."""
    found = []
    for k in LATCHED:
        columns = {name: values[: k + KEPT].copy() for name, values in host.columns(way.inputs).items()}
        for name in SENSORS:
            columns[name][k:] = np.nan
        found.append(steps.recorded(controller, "latches", columns).part(slice(k, None)))
    return steps.joined("latches", found)


def corners(controller: host.Controller) -> Steps:
    """Record inputs held on the ends of their ranges: the first samples and the last ones."""
    found = []
    for hall, laser, set_point, alike in product((0, 1), repeat=4):
        ends = {}
        for i, g in enumerate(interface.INPUTS):
            name = g.signal.name
            end = hall if name in planar_stage.HALL else laser if name in planar_stage.LASERS else set_point
            ends[name] = (g.signal.low, g.signal.high)[end if alike else (end + i) % 2]
        held = steps.recorded(controller, "corners", {name: np.full(HELD, v) for name, v in ends.items()})
        found += [held.part(slice(0, KEPT)), held.part(slice(-KEPT, None))]
    return steps.joined("corners", found)
