"""Worst-case margins of a loop over operating points and parameter tolerances (compare MATLAB `wcmargin`).

    worst over points o and over p in the box |p_i - p_i0| <= tolerance_i |p_i0| of figure(loop(o, p))

At each operating point the search evaluates the centre of the box and all its vertices. It continues from the two worst
with a bounded derivative-free search, because the worst case may lie on an edge or inside. The reported value is
attained at the reported parameters. It is not proved to be the worst in the box.

An unstable loop has no margin left: its figures are 0, 1 for a gain, and inf for the peak sensitivity.
"""

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from synth import arguments, show
from synth.analyse import stability_margins
from synth.analyse.transfer import Loop
from synth.errors import ModelError, SignalError, SynthError
from synth.signals import Parameter
from synth.signals import signal_names as names_of
from synth.statespace import Array

MOST_PARAMETERS = 10  # with a tolerance: 2^10 vertices at each operating point
STEPS = 30  # of each search, for each parameter
SMALL_CHANGE = 1e-6  # of the box, and of the figure: a search stops at smaller changes
INFINITY_SUBSTITUTE = 1e300  # replaces inf, which the search cannot use

LoopOf = Callable[[Mapping[str, float]], Loop]


@arguments.checked
@dataclass(frozen=True)
class Criterion:
    """A scalar figure of a loop, in `unit`; the worst is the largest if `largest`, otherwise the least."""

    name: str
    unit: str
    of: Callable[[Loop], float]
    largest: bool = False


def _margin(
    name: str,
    unit: str,
    margin_of: Callable[[stability_margins.Margins], float],
    if_unstable: float,
    largest: bool = False,
) -> Criterion:
    def figure(loop: Loop) -> float:
        loop_margins = stability_margins.of_loop(loop)
        return margin_of(loop_margins) if loop_margins.stable else if_unstable

    return Criterion(name, unit, figure, largest)


PHASE_MARGIN = _margin("phase margin", "degrees", lambda m: m.phase_margin, 0.0)
GAIN_MARGIN = _margin("gain margin", "1", lambda m: m.gain_margin, 1.0)
GAIN_REDUCTION = _margin("gain reduction margin", "1", lambda m: m.gain_reduction_margin, 1.0, largest=True)
DELAY_MARGIN = _margin("delay margin", "s", lambda m: m.delay_margin, 0.0)
MODULUS_MARGIN = _margin("modulus margin", "1", lambda m: m.modulus_margin, 0.0)
PEAK_SENSITIVITY = _margin("peak sensitivity", "1", lambda m: m.peak_sensitivity, np.inf, largest=True)


@dataclass(frozen=True)
class Point:
    """The figure at one operating point: at the centre, at the worst vertex, and the worst of all.

    `where` has the parameters of the worst.
    """

    name: str
    centre: float
    vertex: float
    worst: float
    where: Mapping[str, float]


@show.result
class WorstCase:
    """The worst `value` of a figure, attained at the operating point `at` with the parameters' values `where`."""

    figure: Criterion
    value: float
    at: str
    where: Mapping[str, float]
    points: tuple[Point, ...]
    parameters: tuple[Parameter, ...]
    evaluations: int

    def sheet(self) -> show.Sheet:
        """Return the worst, the extent of the search, and the values at each operating point."""
        values = ", ".join(f"{p.name} {self.where[p.name]:.6g} {p.unit}" for p in self.parameters)
        unit = "" if self.figure.unit == "1" else f" {self.figure.unit}"
        title = f"Worst {self.figure.name}: {show.number(self.value)}{unit}" + (f" at {self.at}" if self.at else "")
        lines = (
            *((f"with {values}",) if values else ()),
            f"attained, not proved: centre and vertices of {len(self.points)} boxes of {len(self.parameters)} "
            f"parameters, then a search from the two worst of each; {self.evaluations} loops",
        )
        columns = (
            "operating point",
            "centre",
            "worst vertex",
            "worst",
            *(show.with_unit(p.name, p.unit) for p in self.parameters),
        )
        rows = tuple(
            (
                p.name,
                *(show.number(v) for v in (p.centre, p.vertex, p.worst, *(p.where[q.name] for q in self.parameters))),
            )
            for p in self.points
        )
        return show.Sheet(title, lines, (show.Table(columns, rows),))


@arguments.checked
def search(
    loop: LoopOf,
    parameters: Sequence[Parameter],
    figure: Criterion,
    points: Mapping[str, Mapping[str, float]] | None = None,
) -> WorstCase:
    """Return the worst of a figure over the parameters' tolerances at each operating point.

    `loop` gets the values of the parameters and of the operating point, by name; `points` maps the name of an operating
    point to its values, in the units that `loop` takes. A parameter of tolerance 0 stays at its value.

    Raises SignalError for no point, a duplicate name, a tolerance of a value 0, or too many parameters with a
    tolerance; ModelError with the values if the figure is NaN or `loop` fails.
    """
    points = {"": {}} if points is None else points
    _require(parameters, points)
    free = [p for p in parameters if p.tolerance]
    count = 0

    def at(point: Mapping[str, float]) -> Callable[[Array], float]:
        def objective(t: Array) -> float:
            nonlocal count
            count += 1
            value = _value(loop, figure, {**point, **_parameter_values(parameters, free, t)})
            return -value if figure.largest else value

        return objective

    worst_points = [_search_point(name, at(values), parameters, free, figure) for name, values in points.items()]
    worst = (max if figure.largest else min)(worst_points, key=lambda p: p.worst)
    return WorstCase(figure, worst.worst, worst.name, worst.where, tuple(worst_points), tuple(parameters), count)


def _require(parameters: Sequence[Parameter], points: Mapping[str, Mapping[str, float]]) -> None:
    known = names_of(parameters)
    if not points:
        raise SignalError("there is no operating point: give at least one, or leave `points` out")
    for name, values in points.items():
        if both := [v for v in values if v in known]:
            raise SignalError(f"the operating point '{name}' sets '{both[0]}', also a parameter: leave one out")
    for p in parameters:
        if p.tolerance and not p.value:
            raise SignalError(
                f"parameter '{p.name}' is 0 {p.unit} with the relative tolerance {p.tolerance:g}, which spans nothing: "
                "give its range through another parameter"
            )
    count = sum(p.tolerance > 0 for p in parameters)
    if count > MOST_PARAMETERS:
        raise SignalError(
            f"{count} parameters have a tolerance, whose box has 2^{count} vertices: keep {MOST_PARAMETERS} at most, "
            "the others at tolerance 0"
        )


def _parameter_values(parameters: Sequence[Parameter], free: Sequence[Parameter], t: Array) -> dict[str, float]:
    """Return the parameters at t (free,), -1 .. 1 from one end of each tolerance to the other."""
    varied = {p.name: p.value * (1 + p.tolerance * float(s)) for p, s in zip(free, t, strict=True)}
    return {p.name: varied.get(p.name, p.value) for p in parameters}


def _value(loop: LoopOf, figure: Criterion, values: Mapping[str, float]) -> float:
    location = ", ".join(f"{name} = {v:.6g}" for name, v in values.items())
    try:
        value = float(figure.of(loop(values)))
    except SynthError as error:
        raise ModelError(f"no {figure.name} at {location}: {error}") from error
    except Exception as error:  # any error of the user's function: the values make it reproducible
        message = f"{type(error).__name__}: {error}"
        raise ModelError(
            f"no {figure.name} at {location}: {message}; mend the loop or narrow the tolerances"
        ) from error
    if np.isnan(value):
        raise ModelError(f"the {figure.name} is NaN at {location}: mend the loop or narrow the tolerances")
    return value


def _search_point(
    name: str,
    objective: Callable[[Array], float],
    parameters: Sequence[Parameter],
    free: Sequence[Parameter],
    figure: Criterion,
) -> Point:
    """Return the worst at one operating point; a smaller `objective` is worse."""
    n, sign = len(free), -1.0 if figure.largest else 1.0
    corners = [np.array(c) for c in itertools.product((-1.0, 1.0), repeat=n)] if n else []
    evaluated = sorted([(objective(t), k, t) for k, t in enumerate([np.zeros(n), *corners])], key=lambda c: c[:2])
    centre = next(value for value, k, _ in evaluated if k == 0)
    vertex = next((value for value, k, _ in evaluated if k), centre)
    searched = [_simplex_search(objective, t) for value, _, t in evaluated[:2] if n and np.isfinite(value)]
    least, where = min([(evaluated[0][0], evaluated[0][2]), *searched], key=lambda c: c[0])
    return Point(name, sign * centre, sign * vertex, sign * least, _parameter_values(parameters, free, where))


def _simplex_search(objective: Callable[[Array], float], start: Array) -> tuple[float, Array]:
    """Return the minimum from a simplex search from `start` that spans the box.

    The variables are angles a with t = sin(a), which keeps the simplex from collapsing on a side of the box.
    """
    angle = np.arcsin(start)
    simplex = np.vstack([angle, angle + np.diag(np.where(angle == 0, np.pi / 4, -angle))])
    size = abs(min(objective(start), INFINITY_SUBSTITUTE))
    limits = {"maxfev": STEPS * len(start), "xatol": SMALL_CHANGE, "fatol": SMALL_CHANGE * size}
    options = {"initial_simplex": simplex, **limits}
    minimum = minimize(
        lambda a: float(np.clip(objective(np.sin(a)), -INFINITY_SUBSTITUTE, INFINITY_SUBSTITUTE)),
        angle,
        method="Nelder-Mead",
        options=options,
    )
    return float(minimum.fun), np.sin(minimum.x)
