"""Reference of GLSDC in plain NumPy, for any number of unknowns; N bodies advance one sample at a time.

    minimise  |V - h(q + d)|^2 + |S d|^2,    d (n,) in m and rad, S diagonal: the root of the damping

A correction is the least-squares solution of the rows stacked on S, by QR factorisation at each trial. A search starts
at the points of Roberts' sequence.

Source: Kawato and Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors",
section 3.B and Fig. 9.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Columns = Mapping[str, Array]

SLACK = 0.01  # of deviation^2: the rise of the cost allowed for rounding
PATIENCE = 5  # samples
PLASTIC = 1.324717957244746  # g, g^3 = g + 1


@dataclass(frozen=True)
class Setup:
    """The numbers of sensors and algorithm by name, in m, V and rad; each is an attribute."""

    numbers: dict[str, Any]

    def __getattr__(self, name: str) -> Any:
        """Return a number; raise AttributeError for an unknown name."""
        if name not in vars(self).get("numbers", ()):
            raise AttributeError(f"the setup has no '{name}': name one of its numbers")
        return self.numbers[name]


@dataclass(frozen=True)
class Problem:
    """Names of states, residuals (N, m) and rows (N, m, n) at poses (N, n), S, and bounds of d (n,) in m and rad.

    Residuals are those of the first axes of all sensors, then of the second ones. Each of the `blocks` of unknowns is
    solved for together, the later ones first; the earlier ones then fit the limited values. `units` are a state's units
    of each unknown. A cost may rise by `rounding`, relative.
    """

    poses: Sequence[str]
    motions: Sequence[str]
    linearise: Callable[[Array, Array], tuple[Array, Array]]
    damping: Array
    bounds: Array
    units: Array
    blocks: Sequence[slice]
    corrections: int
    deviation: float
    convergence_sigma: float
    scale: float = 1.0
    rounding: float = 0.0

    def threshold(self, cost: Array) -> Array:
        """Return the cost up to which another one counts as lower."""
        return np.asarray((1 + self.rounding) * cost + SLACK * self.deviation**2)


@dataclass(frozen=True)
class Fit:
    """Rows H (N, m, n) at a displacement, damped and factorised by QR: R and z = Q'b (N, n)."""

    at: Array
    H: Array
    squares: Array
    cost: Array
    R: Array
    z: Array


def initial_state(names: Sequence[str]) -> dict[str, Array]:
    """Return the state after init, by name."""
    return {name: np.array([1.0 * (name == "searching")]) for name in names}


def predict(problem: Problem, state: Columns) -> Array:
    """Return the predicted pose (N, n) in m and rad: the last one plus the predicted motion, if there is one."""
    start = np.stack([state[name] for name in problem.poses], axis=1)
    motion = np.stack([state[name] for name in problem.motions], axis=1) if problem.motions else 0.0
    return np.asarray((start + motion) / problem.units)


def descend(problem: Problem, start: Array, volts: Array) -> tuple[list[Fit], Array, Array]:
    """Return the trials, the displacement (N, n) after all corrections, and whether they have converged."""
    trial = fit(problem, start, np.zeros_like(start), volts)
    fits, best, lowest, better = [trial], trial.at, trial.cost, np.ones(len(start), bool)
    for _ in range(problem.corrections - 1):
        at = np.where(better[:, None], correct(problem, trial), (trial.at + best) / 2)
        trial = fit(problem, start, at, volts)
        fits.append(trial)
        better = trial.cost <= problem.threshold(lowest)
        best, lowest = np.where(better[:, None], trial.at, best), np.where(better, trial.cost, lowest)
    converged = better & ((trial.z**2).sum(axis=1) <= (problem.convergence_sigma * problem.deviation) ** 2)
    return fits, np.where(converged[:, None], correct(problem, trial), best), converged


def fit(problem: Problem, start: Array, at: Array, volts: Array) -> Fit:
    """Linearise at a displacement (N, n)."""
    e, H = problem.linearise(start + at, volts)
    Q, R = np.linalg.qr(augment(H, problem.damping))
    b = np.concatenate([e, -problem.damping * at], axis=1)
    return Fit(at, H, (e**2).sum(axis=1), (b**2).sum(axis=1), R, np.einsum("nmi,nm->ni", Q, b))


def augment(H: Array, root: Array) -> Array:
    """Return rows (N, m, n) stacked on the diagonal root (n,) of the damping."""
    return np.concatenate([H, np.broadcast_to(np.diag(root), (len(H), len(root), len(root)))], axis=1)


def correct(problem: Problem, trial: Fit) -> Array:
    """Return the displacement (N, n) after a scaled correction, within the bounds."""
    R, z, end = trial.R, problem.scale * trial.z, trial.at.copy()
    for block in problem.blocks:
        later = end[:, block.stop :] - trial.at[:, block.stop :]
        right = z[:, block] - (R[:, block, block.stop :] @ later[:, :, None])[:, :, 0]
        diagonal = R[:, block, block]
        scalar = diagonal.shape[1] == 1
        step = right / diagonal[:, 0] if scalar else np.linalg.solve(diagonal, right[:, :, None])[:, :, 0]
        end[:, block] = np.clip(trial.at[:, block] + step, -problem.bounds[block], problem.bounds[block])
    return end


def update_motion(problem: Problem, state: Columns, steps: Array, lost: Array) -> dict[str, Array]:
    """Return the predicted motions after `steps` (N, n) in a state's units; 0 where position lock is lost."""
    bounds = problem.bounds * problem.units
    motions = {m: np.clip(state[m] + steps[:, i], -bounds[i], bounds[i]) for i, m in enumerate(problem.motions)}
    return {m: np.where(lost, 0, v) for m, v in motions.items()}


def restart(state: Columns, fault: Array, phases: Columns) -> tuple[dict[str, Array], Array]:
    """Return the next counts, starts and phases, and whether the next sample restarts elsewhere."""
    restarts = fault & (state["residual_faults"] >= PATIENCE - 1)
    next = {"residual_faults": np.where(fault & ~restarts, state["residual_faults"] + 1, 0)}
    for axis, fraction in (("x", 1 / PLASTIC), ("y", 1 / PLASTIC**2)):
        start = wrap(state[f"start_{axis}"] + 2 * pi * (fraction - 1))[0]
        next[f"start_{axis}"] = np.where(restarts, start, state[f"start_{axis}"])
        next[f"phase_{axis}"] = np.where(restarts, start, phases[f"phase_{axis}"])
    return next, restarts


def wrap(angle: Array) -> tuple[Array, Array]:
    """Return angles wrapped to -pi .. pi, and the whole turns that were subtracted."""
    turns = np.where(angle > pi, 1.0, np.where(angle < -pi, -1.0, 0.0))
    return angle - 2 * pi * turns, turns
