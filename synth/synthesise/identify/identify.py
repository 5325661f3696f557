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
as many steps as necessary.

Simulation of a plant along a log with forward sensitivities by parameters and initial states (output error).

    x_{k+1} = R(x_k, u_k, theta),       S_{k+1} = dR/dx S_k + dR/dtheta
    y_k = h(x_k, u_k, theta),           dy_k/dtheta = dh/dx S_k + dh/dtheta

R is one Runge-Kutta step of fourth order over a part of a period, with u held. The log is divided into disjoint spans
of rows; each starts from its own initial states (multiple shooting).

Library: no design uses it yet; docs/library.md has an example.

Fit of plant parameters to trajectories with a check of the integration error.

The fit is repeated with twice the Runge-Kutta steps, starting from the last result, until no parameter changes by more
than a tenth of its standard error, or 1e-7 of its value; the last fit is the result. Each doubling divides the
fourth-order integration error by about 16.

Library: no design uses it yet; docs/library.md has an example.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations_with_replacement

import casadi as ca
import numpy as np

from synth import arguments, show
from synth.base import column_maps
from synth.errors import ModelError, SignalError
from synth.plant import Plant
from synth.signals import Parameter, signal_names
from synth.statespace import Array
from synth.synthesise.identify import gauss_newton, least_squares
from synth.synthesise.identify.estimates import Estimate
from synth.synthesise.identify.logs import Log

MOST_SUBSTEPS = 10_000  # per period: a plant that needs more is too stiff for explicit steps


@dataclass(frozen=True, eq=False)
class Problem:
    """The measurement y (N, p) in the first N rows of the log, and the data of its simulation.

    `starts` (spans, f) are the first guesses of the f `free` initial states of each span, x0 (n, spans) all initial
    states. `steps` simulates the spans with `substeps` steps per period. With `separate_starts` the derivatives by
    initial states are those of groups in a `least_squares.Jacobian`.
    """

    y: Array
    starts: Array
    steps: ca.Function
    substeps: int
    u: Array
    x0: Array
    free: tuple[int, ...]
    parameters: int
    separate_starts: bool

    def simulate(self, theta: Array) -> tuple[Array, Array | least_squares.Jacobian]:
        """Return the outputs (N, p) and their derivatives.

        `theta` holds the k parameters, then the free initial states span by span.
        """
        k, f, (spans, p) = self.parameters, len(self.free), (len(self.starts), self.y.shape[1])
        x0, S0 = self.x0.copy(), np.zeros((len(self.x0), k + f))
        x0[list(self.free)] = theta[k:].reshape(spans, f).T
        S0[list(self.free), range(k, k + f)] = 1.0
        start = np.vstack([x0, np.tile(S0.ravel(order="F")[:, None], spans)])
        outputs = self.steps(start, self.u, np.tile(theta[:k, None], self.u.shape[1]))[1]
        blocks = np.asarray(ca.DM(outputs)).T[:: self.substeps].reshape(spans, -1, 1 + k + f, p)
        g, J = blocks[:, :, 0].reshape(-1, p), blocks[:, :, 1:].transpose(0, 1, 3, 2)
        if not self.separate_starts:
            return g, J[0]
        return g, least_squares.Jacobian(J[..., :k].reshape(-1, p, k), J[..., k:])


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
    """Return the simulation of a plant along a log; arguments as for `identify.fit_trajectory`."""
    states = signal_names(plant.states)
    _check(plant, measured, span, initial, free, len(log), substeps)
    unfixed = [name for name in states if name not in initial]
    y, u, first = log.columns(measured), log.columns(signal_names(plant.inputs)).T, log.columns(unfixed)
    spans = 1 if span is None else _span_count(len(log), span, len(states), len(measured))
    length = len(log) // spans
    where = tuple(states.index(name) for name in states if name in free or name in unfixed)
    x0 = np.array([first[::length, unfixed.index(n)][:spans] if n in unfixed else [initial[n]] for n in states])
    step = _step(plant, parameters, measured, len(where), log.period() / substeps)
    steps = step.mapaccum(length * substeps)
    steps = steps.map(spans) if spans > 1 else steps
    held = np.repeat(u[:, : spans * length], substeps, axis=1)
    return Problem(
        y[: spans * length], x0[list(where)].T, steps, substeps, held, x0, where, len(parameters), span is not None
    )


def _span_count(rows: int, span: int, states: int, measured: int) -> int:
    """Return the number of equal spans of at most `span` periods that leave fewest rows over.

    Each has a sample at least for every start state.
    """
    least = max(2, -(-states // measured))
    return min(-(-rows // (span + 1)), rows // least)


def _check(
    plant: Plant,
    measured: Sequence[str],
    span: int | None,
    initial: Mapping[str, float],
    free: Sequence[str],
    rows: int,
    substeps: int,
) -> None:
    states, known = signal_names(plant.states), (*signal_names(plant.states), *signal_names(plant.outputs))
    for name in measured:
        if name not in known:
            raise SignalError(f"'{name}' is not an output or state of plant '{plant.name}': it has {', '.join(known)}")
    for name in (*initial, *free):
        if name not in states:
            raise SignalError(f"'{name}' is not a state of plant '{plant.name}': it has {', '.join(states)}")
    for name, value in initial.items():
        if arguments.real(f"initial value of '{name}'", value).shape or not np.isfinite(value):
            raise SignalError(f"the initial value of '{name}' is {value}: give a finite number")
    if span is not None and not 1 <= arguments.whole("span", span) < rows:
        raise SignalError(f"the span is {span} samples: give 1 or more, and fewer than the log's {rows} rows")
    if span is not None and (initial or free):
        raise SignalError(
            "the initial states of spans are all estimated: leave `initial` and `free` out, or leave out the span"
        )
    if span is not None and (span + 1) * len(measured) < len(states):
        raise SignalError(
            f"spans of {span} periods hold {(span + 1) * len(measured)} samples for {len(states)} start states: take "
            "longer ones, or measure more signals"
        )
    if not 1 <= arguments.whole("number of Runge-Kutta steps", substeps) <= MOST_SUBSTEPS:
        raise SignalError(f"{substeps} Runge-Kutta steps a period were asked for: give 1 to {MOST_SUBSTEPS}")


def _step(plant: Plant, parameters: Sequence[str], measured: Sequence[str], free: int, h: float) -> ca.Function:
    """Return (x and S stacked, u, theta) -> (the same after h seconds, y and dy stacked)."""
    n, k = len(plant.states), len(parameters)
    x, u, theta = ca.SX.sym("x", n), ca.SX.sym("u", len(plant.inputs)), ca.SX.sym("theta", k)
    S = ca.SX.sym("S", n, k + free)
    p = ca.SX(plant.values)
    for i, name in enumerate(parameters):
        p[signal_names(plant.parameters).index(name)] = theta[i]
    k1 = plant.f(x, u, p)
    k2 = plant.f(x + h / 2 * k1, u, p)
    k3 = plant.f(x + h / 2 * k2, u, p)
    k4 = plant.f(x + h * k3, u, p)
    after = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    h_all, states, outputs = plant.h(x, u, p), signal_names(plant.states), signal_names(plant.outputs)
    y = ca.vcat([h_all[outputs.index(m)] if m in outputs else x[states.index(m)] for m in measured])
    stacked = []
    for v in (after, y):
        direct = ca.horzcat(ca.jacobian(v, theta), ca.SX.zeros(v.numel(), free))
        stacked.append(ca.vertcat(v, ca.vec(ca.densify(ca.jacobian(v, x) @ S + direct))))
    return ca.Function("step", [ca.vertcat(x, ca.vec(S)), u, theta], stacked)


# Standard errors by which twice the steps may change a parameter: widens an interval of 95 % by 0.5 %.
MAX_PARAMETER_SHIFT = 0.1
RELATIVE_TOLERANCE = 1e-7  # of a parameter: alternative tolerance, as a log without noise has no standard errors
DOUBLINGS = 6  # of the Runge-Kutta steps, before a plant counts as too fast for its sample period


@show.result
class TrajectoryFit:
    """A fit (`gauss_newton.Fit`) with its number of Runge-Kutta steps per period.

    `shift` is the largest change of a parameter, in standard errors, at the last doubling of the steps. `estimate` has
    the parameters and, without spans, the initial states; those of spans are estimated but not reported.
    """

    estimate: Estimate
    steps: int
    optimality: float
    substeps: int
    shift: float

    def sheet(self) -> show.Sheet:
        """Return the sheet of the fit with its integration error."""
        sheet = gauss_newton.Fit(self.estimate, self.estimate.values, self.steps, self.optimality).sheet()
        line = (
            f"{self.substeps} Runge-Kutta steps a period; half as many change a parameter by at most "
            f"{self.shift:.1e} standard errors."
        )
        return replace(sheet, lines=(*sheet.lines, line))


def refine_steps(
    problem: Callable[[int], Problem],
    minimise: Callable[[Problem, Array], gauss_newton.Fit],
    start: Array,
    parameters: Sequence[str],
    substeps: int,
) -> TrajectoryFit:
    """Return the fit of ``problem(substeps)`` by ``minimise(problem, start)`` with enough Runge-Kutta steps.

    Raises ModelError where the integration error of one of the `parameters` does not become negligible.
    """
    fit, steps = minimise(problem(substeps), start), 0
    for _ in range(DOUBLINGS):
        before, steps, substeps = fit, steps + fit.steps, 2 * substeps
        fit = minimise(problem(substeps), before.theta)
        change = np.array([fit.estimate[name] - before.estimate[name] for name in parameters])
        shift = _in_standard_errors(fit, change, parameters)
        negligible = RELATIVE_TOLERANCE * np.abs([fit.estimate[name] for name in parameters])
        if ((shift <= MAX_PARAMETER_SHIFT) | (np.abs(change) <= negligible)).all():
            most = float(shift.max())
            return TrajectoryFit(fit.estimate, steps + fit.steps, fit.optimality, substeps, most)
    worst = int(shift.argmax())
    raise ModelError(
        f"with {substeps} Runge-Kutta steps a period instead of {substeps // 2} '{parameters[worst]}' still changes by "
        f"{shift[worst]:.2g} standard errors: the plant is too fast for the log's period; resample the log, or start "
        "with more substeps"
    )


def _in_standard_errors(fit: gauss_newton.Fit, change: Array, parameters: Sequence[str]) -> Array:
    """Return changes of parameters in standard errors; infinite where an exact parameter changes."""
    errors = dict(zip(fit.estimate.parameters, fit.estimate.errors, strict=True))
    error = np.array([errors[name] for name in parameters])
    return np.where(error > 0, np.abs(change) / np.where(error > 0, error, 1.0), np.where(change == 0, 0.0, np.inf))


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
    first = problem(plant, log, parameters, measured, span, initial or {}, free, substeps)
    starts = [plant.states[i] for i in first.free]
    labels = (*parameters, *(f"{s.name}_0" for s in starts)) if span is None else parameters
    units = {s.name: s.unit for s in (*plant.states, *plant.outputs)} | {p.name: p.unit for p in chosen}
    units |= {f"{s.name}_0": s.unit for s in starts}

    def with_steps(steps: int) -> Problem:
        return problem(plant, log, parameters, measured, span, initial or {}, free, steps)

    def minimise(at: Problem, start: Array) -> gauss_newton.Fit:
        return gauss_newton.minimise(at.simulate, at.y, start, labels, measured, noise, level, units)

    start = np.concatenate([values, first.starts.ravel()])
    return refine_steps(with_steps, minimise, start, parameters, substeps)


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
