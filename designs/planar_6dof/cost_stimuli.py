"""Stimuli for measuring the planar controllers, in addition to the standard ones of `synth.verify.stimuli`.

travel      through all pitches and sections in both directions, over the whole yaw range, with small and large errors
saturated   the same with demands beyond the current limits, at large and small yaws
failures    from states of the travel: a Hall channel, a sensor, an axis or all channels wrong in one of six ways,
            in one sample, in two in a row (again), and after the fault is isolated (named)
braking     from states of the travel, with any number of bad samples behind it
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from designs.planar_6dof import allocation, interface
from designs.planar_6dof.loop import Array
from designs.planar_6dof.sensing import calibration, contradictions
from designs.planar_6dof.sensing import sections as sensing
from models import planar_stage
from synth.execute import host
from synth.verify import steps
from synth.verify.sampling import Columns
from synth.verify.steps import Steps

FLOOR = 1.0  # A, below which differences of currents count absolutely: a phase is a projection of up to 1.26 A
TRAVEL = 16_000  # steps
PERIODS = {"x": 1370, "y": 1690, "phi": 913, "z": 251, "theta": 317, "psi": 173}  # samples of a period of the travel
YAWS = (1.0, 0.3, 0.1, 0.03, 0.0)  # of the yaw's range: the polynomials reduce the current of a motor at a yaw a little
SEED = 1975
HALF_RANGE = {axis: allocation.BOX[axis].high for axis in allocation.AXES}  # m, rad
HALL = planar_stage.HALL
GROUPS = (
    *((name,) for name in HALL),
    *(tuple(n for n in HALL if n[place] == which) for place, which in ((2, "a"), (2, "b"), (2, "c"))),
    *(tuple(n for n in HALL if n[3] == axis) for axis in "xy"),
    HALL,
)
BOUND = contradictions.RESIDUAL_BOUND * calibration.of(planar_stage.plant()).amplitude  # V, of a residual


def stimuli(controller: host.Controller) -> list[Steps]:
    """Return the travel, the saturated travel, and the failures from states of the travel."""
    rng = np.random.default_rng(SEED)
    along = _record(controller, "travel", rng)
    saturated = steps.concatenate("saturated", [_record(controller, "", rng, yaw) for yaw in YAWS])
    once = failures(along, rng)
    again = Steps("failures again", steps.evaluate(controller, once).states, once.inputs)
    isolated = Steps("failures named", steps.evaluate(controller, again).states, once.inputs)
    return [along, saturated, once, again, isolated, _braking(along, rng)]


def _record(controller: host.Controller, name: str, rng: np.random.Generator, yaw_share: float | None = None) -> Steps:
    """Return the steps of a travel, with predictions that agree with it.

    The recorded demands do not move the platen, so a controller that predicts from them would refuse the voltages.
    """
    pose = poses(rng, 1.0 if yaw_share is None else yaw_share)
    recorded = steps.record(controller, name, travel(rng, pose, yaw_share))
    states, pitch = recorded.states.copy(), planar_stage.plant().parameter("l").value
    healthy = {"guard_latched": 0, "guard_ready": 1, "guard_left": states["guard_left"].max()}
    healthy |= {"sensing_contradiction_left": 0, "sensing_contradiction_confirmed": 0}
    consistent = {f"reckoning_{axis}_position": pose[axis] for axis in allocation.HORIZONTAL}
    consistent |= {f"sensing_offset_{axis}": pitch * np.round(pose[axis] / pitch) for axis in "xy"}
    consistent["sensing_phi_raw"] = pose["phi"]
    if "filter_x_p" in (states.dtype.names or ()):
        consistent |= {f"filter_{axis}_p": pose[axis] for axis in allocation.HORIZONTAL}
    for field, values in {**healthy, **consistent}.items():
        states[field][1:] = values if np.ndim(values) == 0 else np.asarray(values)[1:]
    return replace(recorded, states=states)


def _braking(sound: Steps, rng: np.random.Generator) -> Steps:
    """Return steps of the travel in which too many bad samples have been counted, at any number of those left."""
    states = sound.states.copy()
    states["guard_left"] = rng.integers(1, int(states["guard_left"].max()) + 1, len(sound))
    return Steps("braking", states, sound.inputs)


def sensor_values(pose: Mapping[str, Array]) -> Columns:
    """Return the sensor values without noise, V and m, at poses (N,) by axis, m and rad."""
    columns = planar_stage.plant().output_values(pose)
    return {name: columns[name] for name in interface.SENSORS}


def poses(rng: np.random.Generator, yaw: float = 1.0) -> dict[str, Array]:
    """Return the poses (N,) of a travel, m and rad: clipped sines from the middle.

    The amplitude of the yaw is `yaw` times its range.
    """
    periods = {axis: n * rng.uniform(0.9, 1.1) for axis, n in PERIODS.items()}
    sines = {axis: np.sin(2 * np.pi / n * np.arange(TRAVEL)) for axis, n in periods.items()}
    columns = {axis: HALF_RANGE[axis] * np.clip(1.035 * sine, -1, 1) for axis, sine in sines.items()}
    return columns | {"phi": yaw * columns["phi"]}


def travel(rng: np.random.Generator, pose: Mapping[str, Array], yaw_share: float | None = None) -> Columns:
    """Return noisy inputs (N,) along poses (N,); errors have random orders of magnitude, half equal in all axes.

    With `yaw_share`, a part of the yaw's range, the errors of z, theta and psi exceed what the motors can achieve, and
    in half of the samples those of all axes do.
    """
    noise = interface.INTERFACE.sensors[0].noise
    columns = sensor_values(pose)
    for name in HALL:
        columns[name] = columns[name] + rng.normal(0, noise, TRAVEL)
    all_alike, sizes = rng.uniform(size=TRAVEL) < 0.5, 10.0 ** rng.uniform(-5, 1, (len(HALF_RANGE), TRAVEL))
    for (axis, high), size in zip(HALF_RANGE.items(), sizes, strict=True):
        common_size = sizes[0] if yaw_share is None else 2
        error_size = (
            common_size
            if yaw_share is not None and axis in allocation.VERTICAL
            else np.where(all_alike, common_size, size)
        )
        columns[f"{axis}_ref"] = np.clip(pose[axis] + high * error_size * rng.choice((-1, 1), TRAVEL), -high, high)
    return columns


def failures(sound: Steps, rng: np.random.Generator) -> Steps:
    """Return steps in each of which the Hall voltages of one of GROUPS fail in the same way."""
    inputs, n, high = sound.inputs.copy(), len(sound), sensing.VOLTAGE
    group, way, other = rng.integers(0, len(GROUPS), n), rng.choice((0, 1, 2, 3, 4, 4, 4, 5), n), rng.permutation(n)
    for name in HALL:
        v, sign = sound.inputs[name], rng.choice((-1, 1), n)
        slightly, any_size = rng.uniform(0.9, 1.1, n) * BOUND, sign * 10.0 ** rng.uniform(-2, 0.5, n)
        ways = (np.zeros(n), v[other], v * (1 + any_size / 3), v + any_size, v + sign * slightly, sign * high)
        failed = np.isin(group, [g for g, names in enumerate(GROUPS) if name in names])
        inputs[name] = np.where(failed, np.clip(np.choose(way, ways), -high, high), v)
    return Steps("failures", sound.states, inputs)
