"""A plant's trajectories through a log, with their derivatives by parameters and initial states.

    x_{k+1} = R(x_k, u_k, theta),       S_{k+1} = dR/dx S_k + dR/dtheta
    y_k = h(x_k, u_k, theta),           dy_k/dtheta = dh/dx S_k + dh/dtheta

R is a number of Runge-Kutta steps of fourth order over one period, with u held.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from synth.errors import SignalError
from synth.plant import Plant
from synth.signals import names
from synth.statespace import Array
from synth.synthesise.logs import Log


@dataclass(frozen=True, eq=False)
class Problem:
    """What was measured, y (N, p), and what a simulation needs; `initial` are the start values of the free states."""

    y: Array
    initial: Array
    steps: ca.Function
    spans: int
    length: int
    u: Array
    x0: Array
    S0: Array
    free: tuple[int, ...]
    skip: int

    def simulate(self, theta: Array) -> tuple[Array, Array]:
        """Return the outputs (N, p) and their derivatives (N, p, k) for parameters and free initial states (k,)."""
        k, p = len(theta), self.y.shape[1]
        x0 = self.x0.copy()
        x0[list(self.free)] = theta[k - len(self.free) :, None]
        start = np.vstack([x0, np.tile(self.S0.ravel(order="F")[:, None], self.spans)])
        y = np.asarray(ca.DM(self.steps(start, self.u, np.tile(theta[:, None], self.spans * self.length))[1]))
        y = y.T.reshape(self.spans, self.length, (1 + k) * p)[:, self.skip :].reshape(-1, (1 + k) * p)
        return y[:, :p], y[:, p:].reshape(-1, k, p).transpose(0, 2, 1)


def problem(
    plant: Plant,
    log: Log,
    parameters: Sequence[str],
    measured: Sequence[str],
    span: int | None,
    initial: Mapping[str, float],
    free: Sequence[str],
    substeps: int,
) -> Problem:
    """Return the simulations of a plant that match a log; arguments as for `identify.fit_trajectory`."""
    states, outputs = names(plant.states), names(plant.outputs)
    _check(plant, measured, span, initial, free, len(log), substeps)
    u = log.columns(names(plant.inputs)).T
    y = log.columns(measured)
    unfixed = [name for name in states if name not in initial]
    first = log.columns(unfixed)
    step = _step(plant, parameters, measured, outputs, free, log.period() / substeps, substeps)
    k = len(parameters) + len(free)
    S0 = np.zeros((len(states), k))
    where = tuple(states.index(name) for name in free)
    S0[list(where), range(len(parameters), k)] = 1.0
    if span is None:
        spans, length, skip = 1, len(log), 0
        known = dict(zip(unfixed, first[0], strict=True)) | dict(initial)
        x0 = np.array([[known[name]] for name in states])
    else:
        spans, length, skip = (len(log) - 1) // span, span + 1, 1
        rows = np.add.outer(span * np.arange(spans), np.arange(length))
        x0 = first[rows[:, 0]].T
        u, y = u[:, rows.ravel()], y[rows[:, 1:].ravel()]
    steps = step.mapaccum(length).map(spans) if spans > 1 else step.mapaccum(length)
    return Problem(y, x0[list(where), 0], steps, spans, length, u, x0, S0, where, skip)


def _check(
    plant: Plant,
    measured: Sequence[str],
    span: int | None,
    initial: Mapping[str, float],
    free: Sequence[str],
    rows: int,
    substeps: int,
) -> None:
    states, known = names(plant.states), (*names(plant.states), *names(plant.outputs))
    for name in measured:
        if name not in known:
            raise SignalError(f"'{name}' is no output or state of plant '{plant.name}': it has {', '.join(known)}")
    for name in (*initial, *free):
        if name not in states:
            raise SignalError(f"'{name}' is no state of plant '{plant.name}': it has {', '.join(states)}")
    if not measured:
        raise SignalError("nothing is measured: name the outputs or states of the log to match")
    if span is not None and not 1 <= span < rows:
        raise SignalError(f"the span is {span} samples: give 1 or more, and fewer than the log's {rows} rows")
    if span is not None and (initial or free):
        raise SignalError("spans start from the logged states: leave `initial` and `free` out, or leave out the span")
    if substeps < 1:
        raise SignalError(f"{substeps} Runge-Kutta steps a period were asked for: give 1 or more")


def _step(
    plant: Plant,
    parameters: Sequence[str],
    measured: Sequence[str],
    outputs: Sequence[str],
    free: Sequence[str],
    h: float,
    substeps: int,
) -> ca.Function:
    """Return (x and S stacked, u, theta) -> (the same a period later, y and dy stacked)."""
    n, k = len(plant.states), len(parameters) + len(free)
    x, u, theta = ca.SX.sym("x", n), ca.SX.sym("u", len(plant.inputs)), ca.SX.sym("theta", k)
    S = ca.SX.sym("S", n, k)
    p = ca.SX(plant.values)
    for i, name in enumerate(parameters):
        p[names(plant.parameters).index(name)] = theta[i]
    after = x
    for _ in range(substeps):
        k1 = plant.f(after, u, p)
        k2 = plant.f(after + h / 2 * k1, u, p)
        k3 = plant.f(after + h / 2 * k2, u, p)
        k4 = plant.f(after + h * k3, u, p)
        after = after + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    h_all = plant.h(x, u, p)
    states = names(plant.states)
    y = ca.vcat([h_all[outputs.index(m)] if m in outputs else x[states.index(m)] for m in measured])
    dx, dy = (ca.jacobian(v, x) @ S + ca.jacobian(v, theta) for v in (after, y))
    stacked = [ca.vertcat(v, ca.vec(ca.densify(dv))) for v, dv in ((after, dx), (y, dy))]
    return ca.Function("step", [ca.vertcat(x, ca.vec(S)), u, theta], stacked)
