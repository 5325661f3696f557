"""Identification of plant parameters from logged data (grey-box identification; MATLAB `greyest`).

    fit_linear       0 = g(signals, theta) + e, g linear in theta: g = Phi theta - y
    fit_equations    the same with a plant's right sides, 0 = f(x, u, theta) - dx/dt, made linear by a product of
                     parameters where necessary; static points have dx/dt = 0
    fit_trajectory   y_k = h(x_k, u_k, theta) + e_k along x' = f(x, u, theta) with inputs held over each period

The first two are equation-error methods: noise of a signal that multiplies a parameter biases it, and such a signal
should be averaged first. The third is an output-error method: a logged state is a measurement like others, and initial
states are estimated, not taken from the log. An unstable plant is simulated over short spans, each with its own initial
states (multiple shooting).

Derivatives are CasADi's, exact. Runge-Kutta steps of fourth order also integrate the sensitivities S = dx/dtheta, with
as many steps as necessary (`trajectory`).
"""

from collections.abc import Mapping, Sequence
from itertools import combinations_with_replacement

import casadi as ca
import numpy as np

from synth import arguments
from synth.base import column_maps
from synth.errors import ModelError, SignalError
from synth.plant import Plant
from synth.signals import Parameter, signal_names
from synth.statespace import Array
from synth.synthesise.identify import gauss_newton, least_squares, trajectory
from synth.synthesise.identify.estimates import Estimate
from synth.synthesise.identify.logs import Log
from synth.synthesise.identify.trajectory import TrajectoryFit

PROBE = 0.37  # relative change of a parameter, to test whether a derivative depends on it
LINEAR = 1e-9  # of the largest entry of a derivative: its tolerated change
ROWS = 50  # rows of the log at which linearity is tested


@arguments.checked
def fit_linear(
    equations: Mapping[str, ca.SX],
    signals: Mapping[str, ca.SX],
    parameters: Sequence[Parameter],
    symbols: Mapping[str, ca.SX],
    log: Log,
    noise: Mapping[str, float] | None = None,
    level: float = 0.95,
) -> Estimate:
    """Estimate parameters from equations that are linear in them and zero except for noise.

    `equations` are expressions by name in the symbols of `signals`, which the log contains, and of `symbols`, one for
    each of the `parameters`. The values of the parameters are used only to test linearity.

    Raises SignalError for another symbol, or a signal that the log does not contain; ModelError naming a parameter in
    which an equation is not linear; else as `least_squares.solve`.
    """
    arguments.distinct("parameters", signal_names(parameters))
    arguments.distinct("equations", tuple(equations))
    if missing := [p.name for p in parameters if p.name not in symbols]:
        raise SignalError(f"parameter '{missing[0]}' has no symbol: give it in `symbols`")
    theta = ca.vcat([symbols[p.name] for p in parameters])
    data = ca.vcat(list(signals.values()))
    g = ca.SX(ca.vcat(list(equations.values())))
    known = {v.name() for v in ca.symvar(ca.vertcat(theta, data))}
    for v in ca.symvar(g):
        if v.name() not in known:
            raise SignalError(f"the equations hold '{v.name()}', which is neither a signal nor one of the parameters")
    return _fit_affine(tuple(equations), g, theta, data, parameters, log.columns(tuple(signals)), (noise, level))


@arguments.checked
def fit_equations(
    plant: Plant,
    log: Log,
    parameters: Sequence[str],
    rates: Mapping[str, str] | None = None,
    noise: Mapping[str, float] | None = None,
    level: float = 0.95,
) -> Estimate:
    """Estimate parameters of a plant from points at which its states and inputs were logged.

    The equations of f that contain one of them are used. `rates` maps a state to the logged signal of its derivative;
    other states are at rest. An equation is named by its state, as in `noise`; multiplied by parameters, it has another
    unit.

    Raises SignalError for an unknown name, a signal that the log does not contain or parameters in no equation;
    ModelError when no product of the parameters makes an equation linear; else as `least_squares.solve`.
    """
    parameters = arguments.distinct("parameters", parameters)
    chosen = [plant.parameter(name) for name in parameters]
    where = [signal_names(plant.parameters).index(name) for name in parameters]
    x, u, p = (
        ca.SX.sym(s, k) for s, k in (("x", len(plant.states)), ("u", len(plant.inputs)), ("p", len(plant.values)))
    )
    f, rates = plant.f(x, u, p), dict(rates or {})
    states = signal_names(plant.states)
    if unknown := [name for name in (*rates, *(noise if isinstance(noise, Mapping) else ())) if name not in states]:
        raise SignalError(f"'{unknown[0]}' is not a state of plant '{plant.name}': it has {', '.join(states)}")
    theta = ca.SX.sym("theta", len(where))
    full = ca.SX(plant.values)
    full[where] = theta
    speed = ca.SX.sym("speed", len(rates))
    f = ca.substitute(f, p, full)
    used = [i for i in range(len(states)) if ca.depends_on(f[i], theta)]
    if not used:
        raise SignalError(f"no equation of plant '{plant.name}' contains {', '.join(parameters)}: choose others")
    moving = {name: speed[k] for k, name in enumerate(rates)}
    g = ca.vcat([f[i] - moving.get(states[i], 0) for i in used])
    every = [*states, *signal_names(plant.inputs), *rates.values()]
    needed = [k for k, v in enumerate(ca.vertsplit(ca.vertcat(x, u, speed))) if ca.depends_on(g, v)]
    data = ca.vertcat(x, u, speed)[needed]
    samples = log.columns([every[k] for k in needed])
    equations = tuple(states[i] for i in used)
    products = [_linearising_product(g[k], theta, data, chosen, samples, name) for k, name in enumerate(equations)]
    used_noise = {n: v for n, v in noise.items() if n in equations} if isinstance(noise, Mapping) else noise
    return _fit_affine(equations, g * ca.vcat(products), theta, data, chosen, samples, (used_noise, level))


@arguments.checked
def fit_trajectory(
    plant: Plant,
    log: Log,
    parameters: Sequence[str],
    measured: Sequence[str],
    span: int | None = None,
    initial: Mapping[str, float] | None = None,
    free: Sequence[str] = (),
    noise: Mapping[str, float] | None = None,
    level: float = 0.95,
    substeps: int = 4,
) -> TrajectoryFit:
    """Estimate parameters of a plant from trajectories, starting from the parameters' values.

    `measured` names the outputs or states in the log to be matched. With a `span` the simulation restarts after at most
    `span` periods: the log is divided into as few equal parts as that takes, and the rows left over, fewer than the
    parts, are not used. All initial states are estimated, with the logged ones as first guess, and reported as
    ``<state>_0`` where there is no span. Without a span, states in `initial` start exactly from these values unless
    they are also in `free`. The fit begins with `substeps` Runge-Kutta steps per period and doubles them until no
    parameter changes.

    Raises SignalError for an unknown name, a signal that the log does not contain or a span below 1; TimingError for a
    log without period; ModelError where no number of steps is sufficient; else as `gauss_newton.minimise`.
    """
    parameters, measured = (
        arguments.distinct("parameters", parameters),
        arguments.distinct("measured signals", measured),
    )
    free = arguments.distinct("free states", free) if free else ()
    chosen = [plant.parameter(name) for name in parameters]
    values = np.array([p.value for p in chosen], dtype=np.float64)
    first = trajectory.problem(plant, log, parameters, measured, span, initial or {}, free, substeps)
    starts = [plant.states[i] for i in first.free]
    labels = (*parameters, *(f"{s.name}_0" for s in starts)) if span is None else parameters
    units = {s.name: s.unit for s in (*plant.states, *plant.outputs)} | {p.name: p.unit for p in chosen}
    units |= {f"{s.name}_0": s.unit for s in starts}

    def problem(steps: int) -> trajectory.Problem:
        return trajectory.problem(plant, log, parameters, measured, span, initial or {}, free, steps)

    def minimise(at: trajectory.Problem, start: Array) -> gauss_newton.Fit:
        return gauss_newton.minimise(at.simulate, at.y, start, labels, measured, noise, level, units)

    start = np.concatenate([values, first.starts.ravel()])
    return trajectory.refine_steps(problem, minimise, start, parameters, substeps)


def _fit_affine(
    equations: tuple[str, ...],
    g: ca.SX,
    theta: ca.SX,
    data: ca.SX,
    parameters: Sequence[Parameter],
    samples: Array,
    confidence: tuple[Mapping[str, float] | None, float],
) -> Estimate:
    """Estimate theta of g = 0; raise ModelError where an equation is not linear in a parameter."""
    for k, name in enumerate(equations):
        if curved := _nonlinear_parameters(g[k], theta, data, parameters, samples):
            raise ModelError(
                f"equation '{name}' is not linear in {', '.join(curved)}: multiply it out, hold one of them, or use "
                "fit_trajectory"
            )
    value, slope = _evaluate(g, theta, data, np.array([p.value for p in parameters], dtype=np.float64), samples)
    y = np.einsum("npk,k->np", slope, [p.value for p in parameters]) - value
    units = {p.name: p.unit for p in parameters}
    near = np.array([p.value for p in parameters], dtype=np.float64)
    return least_squares.solve(slope, y, signal_names(parameters), equations, *confidence, units, near)


def _evaluate(g: ca.SX, theta: ca.SX, data: ca.SX, at: Array, samples: Array) -> tuple[Array, Array]:
    """Return g (N, p) and dg/dtheta (N, p, k) at each row of `samples` (N, d)."""
    p, k = g.numel(), theta.numel()
    both = ca.Function("g", [theta, data], [g, ca.vec(ca.densify(ca.jacobian(g, theta)).T)])
    value, slope = column_maps.map_columns(both, at, samples.T)
    return value.T, slope.T.reshape(len(samples), p, k)


def _nonlinear_parameters(
    g: ca.SX, theta: ca.SX, data: ca.SX, parameters: Sequence[Parameter], samples: Array
) -> list[str]:
    """Return the parameters in which g is not linear: a change of one changes the derivatives of g at some row."""
    rows = samples[np.unique(np.linspace(0, len(samples) - 1, ROWS).astype(int))]
    base = np.array([p.value for p in parameters], dtype=np.float64)
    slope = _evaluate(g, theta, data, base, rows)[1]
    if not np.isfinite(slope).all():
        values = ", ".join(f"{p.name} = {p.value:g}" for p in parameters)
        raise ModelError(
            f"the equations or their derivatives are not finite at {values}: give parameters that divide a value other "
            "than 0, and leave out rows in which a signal does"
        )
    size = np.abs(slope).max(axis=0, initial=0.0)
    nonlinear = []
    for i, p in enumerate(parameters):
        changed = base.copy()
        changed[i] += PROBE * abs(p.value) or PROBE
        if not (np.abs(_evaluate(g, theta, data, changed, rows)[1] - slope) <= LINEAR * size).all():
            nonlinear.append(p.name)
    return nonlinear


def _linearising_product(
    g: ca.SX, theta: ca.SX, data: ca.SX, parameters: Sequence[Parameter], samples: Array, name: str
) -> ca.SX:
    """Return the product of up to two parameters that makes an equation of f linear in all parameters."""
    curved = _nonlinear_parameters(g, theta, data, parameters, samples)
    places = [k for k, p in enumerate(parameters) if p.name in curved]
    for many in (0, 1, 2):
        for some in combinations_with_replacement(places, many):
            product = ca.SX(1)
            for k in some:
                product = product * theta[k]
            if not _nonlinear_parameters(g * product, theta, data, parameters, samples):
                return product
    raise ModelError(
        f"the equation of '{name}' is not linear in {', '.join(curved)}, nor multiplied by one or two of them: hold "
        "one of them, or use fit_trajectory"
    )
