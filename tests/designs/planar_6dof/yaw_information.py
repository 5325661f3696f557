"""What five sound Hall voltages say about the yaw after one has failed: Fisher information, and unequal sensors.

With J (5, 4) the derivatives of the voltages with respect to x, y, yaw and their common amplitude, the yaw is row . V
for the row of the pseudo-inverse of J, the estimate of least variance. Noise of s volts leaves s |row|. Sensors whose
sensitivities differ by g from each other shift it by sum |row_i g V_i| at most, which changes as the platen moves.

    python -m tests.designs.planar_6dof.yaw_information      the figures of docs/decisions/planar_faults.md
"""

import sys
from dataclasses import dataclass
from itertools import product

import casadi as ca
import numpy as np

from designs.planar_6dof import loop as loops
from designs.planar_6dof_lqg.design import subject
from models import planar_stage
from synth.fault import BRAKING_BIT, LATCH_BIT
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory
from synth.statespace import Array
from tests.designs.planar_6dof.faulty_runs import COAST, FAILS, STUCK_DURATION, rates, run, stuck_value

CHANNEL, SPEED, DIRECTION = "V_ay", 0.08, 5 / 3 * np.pi  # the run with the largest yaw rate of 540 on the nominal stage
UNEQUAL = 0.02  # of the sensitivity: what RESIDUAL_BOUND of the contradictions allows for
WINDOW = 24  # samples before braking begins, as many as it takes


@dataclass(frozen=True, eq=False)
class Failure:
    """A channel that sticks: the run, and the samples of the failure, of braking and of the latch."""

    run: Trajectory
    failure: int
    braking: int
    latch: int

    def left(self, period_s: float) -> float:
        """Return the yaw rate half a second after the latch, rad/s."""
        return float(rates(self.run)[1][self.latch + round(COAST / period_s)])


def stick(rig: Rig) -> Failure:
    """Run the failure with the largest yaw rate that is left."""
    speed = {"x": SPEED * np.cos(DIRECTION), "y": SPEED * np.sin(DIRECTION)}
    first = round(FAILS / rig.period_s)
    stuck = run(rig, CHANNEL, 10_000, stuck_value(rig, CHANNEL, speed, STUCK_DURATION), speed, STUCK_DURATION)
    braking, latch = (int(np.argmax(stuck.faults >> bit & 1)) for bit in (BRAKING_BIT, LATCH_BIT))
    return Failure(stuck, first, braking, latch)


def yaw_rows(rig: Rig, trajectory: Trajectory, channels: tuple[str, ...]) -> tuple[Array, Array]:
    """Return the rows (N, n) that estimate the yaw from these channels, and their voltages (N, n)."""
    plant, names = rig.plant, [s.name for s in rig.plant.states]
    x, u, p = plant.h.sx_in()
    outputs = [s.name for s in plant.outputs]
    voltages = ca.vertcat(*(plant.h(x, u, p)[outputs.index(name)] for name in channels))
    position = x[[names.index(axis) for axis in ("x", "y", "phi")]]
    model = ca.Function("model", [x, p], [ca.jacobian(voltages, position), voltages])
    rows, values = [], []
    for state in np.array([trajectory[name] for name in names]).T:
        J, V = (np.asarray(v) for v in model(state, plant.values))
        rows.append(np.linalg.pinv(np.hstack([J, V]))[2])
        values.append(V.ravel())
    return np.array(rows), np.array(values)


@dataclass(frozen=True)
class YawInformation:
    """Of the samples from the failure to braking: the yaw in rad and the yaw rate in rad/s that five channels leave.

    `noise` and `unequal` are the largest standard deviation and shift of the yaw; `rate_noise` and `rate_unequal` those
    of the slope of a line through the last WINDOW samples.
    """

    rotation: float
    noise: float
    unequal: float
    rate_noise: float
    rate_unequal: float


def information(rig: Rig, failed: Failure) -> YawInformation:
    """Return what a law could know that knows at once which channel failed."""
    sound = tuple(name for name in planar_stage.HALL if name != CHANNEL)
    rows, values = yaw_rows(rig, failed.run, sound)
    sigma = next(s.noise for s in rig.stage.interface.sensors if s.name in sound)
    until = slice(failed.failure, failed.braking)
    last = slice(failed.braking - WINDOW, failed.braking)
    centred = (np.arange(WINDOW) - (WINDOW - 1) / 2) * rig.period_s
    slope = centred / np.sum(centred**2)  # of a line through equally spaced samples
    patterns = np.array(list(product((-UNEQUAL, UNEQUAL), repeat=len(sound))))
    shifts = (rows * values)[last] @ patterns.T
    rotation = np.ptp(failed.run["phi"][until])
    return YawInformation(
        float(rotation),
        float(sigma * np.linalg.norm(rows[until], axis=1).max()),
        float(UNEQUAL * np.abs(rows * values)[until].sum(axis=1).max()),
        float(sigma * np.sqrt(np.sum(slope**2 * np.sum(rows[last] ** 2, axis=1)))),
        float(np.abs(slope @ shifts).max()),
    )


if __name__ == "__main__":
    stage = loops.of(subject().block)
    failed = stick(stage)
    known = information(stage, failed)
    sys.stdout.write(
        f"{CHANNEL} sticks at {SPEED:g} m/s: brakes after {failed.braking - failed.failure} samples, latches after "
        f"{failed.latch - failed.failure}, {failed.left(stage.period_s):.3f} rad/s are left\n"
        f"the platen turns by {1e3 * known.rotation:.0f} mrad; five channels: noise {1e3 * known.noise:.1f} mrad a "
        f"sample and {known.rate_noise:.2f} rad/s, sensitivities that differ by {UNEQUAL:.0%}: "
        f"{1e3 * known.unequal:.0f} mrad and {known.rate_unequal:.2f} rad/s\n"
    )
