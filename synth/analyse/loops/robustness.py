"""Stability margins at each actuator and sensor, over operating points and parameter tolerances.

           *--->[ delay, hold, plant, sampler ]---*         For each operating point and each set of parameters: find
           ^                                      v         the equilibrium of the loop, linearise it, and open it at
           +----[ controller as generated ]<------+         one * at a time, the others closed: L, with 1 + L closed.

The constants of the controller are rounded to its scalar type. Only the parameters of the plant vary; the controller
keeps its nominal model. MATLAB: `getLoopTransfer` over `ureal` vertices, `allmargin`.

Sets of parameter values at the ends of their tolerances: the corners of a box (MATLAB: `ureal` vertices).
"""

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from synth import arguments
from synth.analyse import operating_points
from synth.analyse.loops import disk, equilibrium, stability_margins, transfer
from synth.analyse.loops.equilibrium import Equilibrium, SampledLoop, Wires
from synth.analyse.loops.stability_margins import Margins
from synth.analyse.operating_points import OperatingPoint
from synth.check import Check
from synth.declare.stage import Controller, Interface, Stage
from synth.errors import ModelError, NoEquilibriumError, SignalError
from synth.plant import Plant
from synth.signals import signal_names
from synth.statespace import StateSpace
from synth.timing import Discrete, period

MAX_CORNERS = 1024  # an equilibrium is solved for each of them at each operating point


@dataclass(frozen=True)
class Case:
    """Values of parameters that differ from the nominal ones, and of auxiliary inputs; `name` of a declared case."""

    values: Mapping[str, float] = field(default_factory=dict)
    name: str = ""

    @property
    def text(self) -> str:
        """The name and the values as text, each after a comma; empty for the nominal plant."""
        parts = (*filter(None, (self.name,)), *(f"{name} = {value:.5g}" for name, value in self.values.items()))
        return "".join(f", {part}" for part in parts)


@arguments.checked
def corners(plant: Plant, parameters: Sequence[str]) -> list[Case]:
    """Return all combinations of some parameters at the ends of their tolerances: 2^k for k of them.

    Raises SignalError for an unknown parameter, one without a tolerance, or more than MAX_CORNERS corners.
    """
    ends = [_ends(plant, name) for name in parameters]
    if 2 ** len(ends) > MAX_CORNERS:
        raise SignalError(
            f"{len(ends)} parameters have 2^{len(ends)} corners, at most {MAX_CORNERS} are allowed: name fewer"
        )
    return [Case(dict(zip(parameters, values, strict=True))) for values in itertools.product(*ends)] if ends else []


def _ends(plant: Plant, name: str) -> tuple[float, float]:
    p = plant.parameter(name)
    if not p.varies:
        raise SignalError(
            f"parameter '{name}' is {p.value} {p.unit} with the tolerance {p.tolerance}: neither may be 0; set them, "
            f"or give both ends in {p.unit}"
        )
    return p.at(-1.0), p.at(1.0)


NOMINAL = Case()
AT_ONCE = "both"  # the group of all actuators and sensors
DEAD_BEAT = 1e-6  # of |z|: a smaller pole is a delay

Groups = Mapping[str, Sequence[str]]  # signals that vary at once, by name of the group


@dataclass(frozen=True)
class _Requirement:
    """A margin: its unit, its value for an unstable loop, and the function that reads it."""

    unit: str
    if_unstable: float
    of: Callable[[Margins], float]


REQUIREMENTS: Mapping[str, _Requirement] = {
    "phase_margin": _Requirement("degrees", 0.0, lambda m: m.phase_margin),
    "gain_margin": _Requirement("1", 1.0, lambda m: m.gain_margin),
    "gain_reduction": _Requirement(
        "1", 1.0, lambda m: 1 / m.gain_reduction_margin if m.gain_reduction_margin else np.inf
    ),
    "delay_margin": _Requirement("s", 0.0, lambda m: m.delay_margin),
    "modulus_margin": _Requirement("1", 0.0, lambda m: m.modulus_margin),
}


@dataclass(frozen=True, eq=False)
class OpenLoop:
    """The loop opened at `signal`, at an operating point and with some parameters changed, and its margins."""

    point: str
    case: Case
    signal: str
    L: StateSpace
    margins: Margins

    @property
    def label(self) -> str:
        """The signal, the operating point and the case, as text."""
        return f"at {self.signal}, {self.point}{self.case.text}"

    def margin(self, name: str) -> float:
        """Return one of REQUIREMENTS; an unstable loop has no margin left."""
        requirement = REQUIREMENTS[name]
        return float(requirement.of(self.margins)) if self.margins.stable else requirement.if_unstable


@dataclass(frozen=True)
class Unsolved:
    """An operating point, with some parameters changed, without an equilibrium of the loop, and the reason."""

    point: str
    case: Case
    reason: str

    @property
    def label(self) -> str:
        """The operating point and the case, as text."""
        return f"at {self.point}{self.case.text}"


@dataclass(frozen=True, eq=False)
class AtRest:
    """The equilibrium of the loop at an operating point in a case; without one, the reason."""

    point: str
    case: Case
    equilibrium: Equilibrium | None
    reason: str = ""

    @property
    def label(self) -> str:
        """The operating point and the case, as text."""
        return f"{self.point}{self.case.text}"


@dataclass(frozen=True, eq=False)
class LoopsAt:
    """The loops of a stage at a place, of a stage that opens them itself: `open` returns L (p, p) opened at p signals.

    The loops are opened at each of the `signals`, and for the disk margin at all of `at_once`.
    """

    place: str
    signals: Sequence[str]
    at_once: Sequence[str]
    open: Callable[[Sequence[str]], StateSpace]


@dataclass(frozen=True, eq=False)
class ClosedLoop:
    """The poles z (n,) of a closed loop sampled each `period_s`; without any, `reason` says why it has no equilibrium.

    With s = ln(z) / T the slowest time constant is that of max Re s, and the damping of a pole is -Re s / |s|.
    """

    place: str
    poles: NDArray[np.complex128]
    period_s: float
    reason: str = ""

    @property
    def is_stable(self) -> bool:
        """Whether there is an equilibrium to which the loop returns."""
        return not self.reason and transfer.is_stable(self.poles, Discrete(self.period_s))

    @property
    def slowest_s(self) -> float:
        """The largest time constant in s, inf where a pole does not decay."""
        decay = -float(self._rates.real.max(initial=-np.inf))
        return 1 / decay if decay > 0 else np.inf

    @property
    def least_damping(self) -> tuple[float, float]:
        """The damping of the least damped pole, negative where it grows, and its frequency |s| / 2 pi in Hz."""
        s = self._rates
        damping = -s.real / np.abs(s)
        k = int(np.argmin(damping)) if len(s) else -1
        return (float(damping[k]), float(np.abs(s[k]) / (2 * np.pi))) if len(s) else (1.0, np.inf)

    @property
    def _rates(self) -> NDArray[np.complex128]:
        z = self.poles[np.abs(self.poles) > DEAD_BEAT]
        return np.asarray(np.log(z) / self.period_s)


@dataclass(frozen=True, eq=False)
class Survey:
    """The loops at all operating points and cases, and those points and cases that have no equilibrium.

    `disks` has the disk margins where all loops are stable, by point and case, then by the name of the group of signals
    that vary at once: at all points of the nominal plant, and the least of the other cases where it is less.
    """

    loops: Sequence[OpenLoop]
    unsolved: Sequence[Unsolved]
    disks: Mapping[str, Mapping[str, disk.DiskMargin]] = field(default_factory=dict)

    @property
    def lost(self) -> list[str]:
        """The points without an equilibrium and the loops that are not stable: they have no margins."""
        unstable = [loop.label for loop in self.loops if not loop.margins.stable]
        return [*(f"{u.label}: {u.reason}" for u in self.unsolved), *unstable]


@dataclass(frozen=True, eq=False)
class Loops:
    """The closed loop of a stage, its interface, its operating points and sets of parameter values.

    `points` holds plant states by name of the point; the other states are 0. `cases` are sets of parameter values; the
    set NOMINAL changes none.
    """

    closed: SampledLoop
    interface: Interface
    points: Mapping[str, Mapping[str, float]]
    cases: Sequence[Case] = field(default=(NOMINAL,))

    @property
    def actuators(self) -> tuple[str, ...]:
        """The plant's inputs that the controller drives."""
        return tuple(self.closed.actuators)

    @property
    def sensors(self) -> tuple[str, ...]:
        """The controller's inputs that sensors drive."""
        return tuple(self.closed.sensors)

    @property
    def signals(self) -> tuple[str, ...]:
        """All actuators and sensors; with coordinates, these and the sensors outside them."""
        coordinates = self.closed.coordinates
        taken = {sensor for weights in coordinates.values() for sensor in weights}
        others = [sensor for sensor in self.sensors if sensor not in taken]
        return (*coordinates, *others) if coordinates else (*self.actuators, *others)

    @property
    def groups(self) -> Groups:
        """The groups of signals that vary at once for the disk margins."""
        return {"actuators": self.actuators, "sensors": self.sensors, AT_ONCE: (*self.actuators, *self.sensors)}


@arguments.checked
def of_controller(
    controller: Controller,
    plant: Plant,
    points: Mapping[str, Mapping[str, float]],
    cases: Sequence[Case] = (NOMINAL,),
    scalar: type[np.floating] = np.float32,
    actuators: Wires | None = None,
    coordinates: Mapping[str, Mapping[str, float]] | None = None,
) -> Loops:
    """Return the loops of a composed controller, its constants rounded to `scalar`, around a plant.

    `actuators` are the wires from the controller's outputs to the plant's inputs, by default those of the interface;
    `coordinates` {name: {sensor: weight}} are sums of sensors at which the loops open instead.

    Raises SignalError for no operating point, or as `equilibrium.SampledLoop`.
    """
    if not points or not cases:
        raise SignalError(
            "there are no operating points or no cases: give at least one of each, for example the middle of the range"
        )
    interface = controller.interface
    wires = {a.of: a.name for a in interface.actuators} if actuators is None else actuators
    sensors = {s.name: s.of for s in interface.sensors}
    closed = SampledLoop(plant, controller.block.rounded(scalar), sensors, wires, interface.delay, coordinates or {})
    return Loops(closed, interface, dict(points), tuple(cases))


@arguments.checked
def of_stage(stage: Stage) -> Loops:
    """Return the loops of a stage at its operating points, with constants rounded as in the emitted C."""
    return of_controller(
        stage.controller,
        stage.plant,
        stage.operating_points,
        scalar=stage.scalar,
        actuators=stage.wires or None,
        coordinates=stage.coordinates,
    )


@arguments.checked
def equilibrium_at(loops: Loops, point: str, case: Case = NOMINAL, near: OperatingPoint | None = None) -> Equilibrium:
    """Return the equilibrium of the loop at an operating point, with the parameters and auxiliary inputs of a case.

    `near` is one in another case, from which the plant's trim is continued.

    Raises SignalError for an unknown point or parameter; ModelError as `trim_with_free_states` and
    `equilibrium.solve`.
    """
    if point not in loops.points:
        raise SignalError(f"there is no operating point '{point}': choose one of {', '.join(loops.points)}")
    closed, auxiliaries = loops.closed, [a.name for a in loops.interface.auxiliaries]
    parameters = {name: value for name, value in case.values.items() if name not in auxiliaries}
    plant = closed.plant.with_parameters(**parameters)
    try:
        trimmed = operating_points.trim_with_free_states(plant, dict(loops.points[point]), list(loops.actuators), near)
    except ModelError as error:
        raise ModelError(f"operating point '{point}'{case.text}: {error}") from error
    outputs = np.asarray(plant.h(trimmed.x, trimmed.u, trimmed.p)).ravel().tolist()
    values = dict(zip(trimmed.states, trimmed.x.tolist(), strict=True))
    values |= zip(signal_names(plant.outputs), outputs, strict=True)
    values |= {sensor: values[output] for sensor, output in closed.sensors.items()}
    references = {s.name: values[s.of] for s in loops.interface.set_points}
    constants = loops.interface.constant_inputs(plant)
    references |= {name: case.values.get(name, value) for name, value in constants.items()}
    return equilibrium.solve(closed, references, trimmed)


@arguments.checked
def equilibria(loops: Loops) -> list[AtRest]:
    """Return the equilibria at the operating points in the first case, then at each point in the others.

    The whole search for a trim is made once a point, and continued in the other cases.

    Raises as `equilibrium_at`, but no NoEquilibriumError.
    """
    first, *others = loops.cases
    nearest: dict[str, OperatingPoint] = {}
    rests: list[AtRest] = []
    for point, case in (*((p, first) for p in loops.points), *itertools.product(loops.points, others)):
        try:
            at_rest = equilibrium_at(loops, point, case, nearest.get(point))
        except NoEquilibriumError as error:
            rests.append(AtRest(point, case, None, str(error)))
        else:
            nearest.setdefault(point, at_rest.point)
            rests.append(AtRest(point, case, at_rest))
    return rests


@arguments.checked
def closed_loops(loops: Loops, at_rest: Sequence[AtRest] | None = None) -> list[ClosedLoop]:
    """Return the closed loop at each of the equilibria, by default `equilibria`; much sooner than `survey`.

    Raises as `open_loops`, but no NoEquilibriumError.
    """
    period_s = period(loops.closed.controller.time)
    return [
        ClosedLoop(
            rest.label,
            _closed_poles(equilibrium.open_loop(rest.equilibrium, list(loops.actuators)))
            if rest.equilibrium
            else np.zeros(0, np.complex128),
            period_s,
            rest.reason,
        )
        for rest in (equilibria(loops) if at_rest is None else at_rest)
    ]


@arguments.checked
def closed_loops_at(places: Sequence[LoopsAt]) -> list[ClosedLoop]:
    """Return the closed loop at each place of a stage that opens its loops itself; raise as `LoopsAt.open`."""
    opened = ((at.place, at.open(at.at_once)) for at in places)
    return [ClosedLoop(place, _closed_poles(L), period(L.time)) for place, L in opened]


def _closed_poles(L: StateSpace) -> NDArray[np.complex128]:
    """Return the zeros of det(I + L), L (p, p) opened at so many signals that every axis is in a loop."""
    poles = np.linalg.eigvals(L.A - L.B @ np.linalg.solve(np.eye(len(L.D)) + L.D, L.C))
    return poles.astype(np.complex128)


@arguments.checked
def open_loops(loops: Loops, signals: Sequence[str] | None = None) -> list[OpenLoop]:
    """Return the loop at each operating point and case, opened at each of `signals`, by default `Loops.signals`.

    Raises SignalError for an unknown signal; ModelError with the operating point if it has no equilibrium or margins.
    """
    chosen = loops.signals if signals is None else signals
    equilibria = ((p, c, equilibrium_at(loops, p, c)) for p, c in itertools.product(loops.points, loops.cases))
    return [_open(point, case, signal, at_rest) for point, case, at_rest in equilibria for signal in chosen]


@arguments.checked
def survey(loops: Loops, at_rest: Sequence[AtRest] | None = None) -> Survey:
    """Return the loops opened at each of the equilibria, by default `equilibria`, and the points and cases without one.

    An unstable loop may have no equilibrium that can be found, since its samples do not lead to one. Where all loops
    are stable, the disk margins of the nominal plant are computed for all groups, and of the other cases the one whose
    disk margin of AT_ONCE is the least of all.

    Raises as `open_loops`, but no NoEquilibriumError.
    """
    opened: list[OpenLoop] = []
    unsolved: list[Unsolved] = []
    disks: dict[str, Mapping[str, disk.DiskMargin]] = {}
    varied: dict[str, StateSpace] = {}
    for rest in equilibria(loops) if at_rest is None else at_rest:
        if rest.equilibrium is None:
            unsolved.append(Unsolved(rest.point, rest.case, rest.reason))
            continue
        here = [_open(rest.point, rest.case, signal, rest.equilibrium) for signal in loops.signals]
        opened += here
        if not all(loop.margins.stable for loop in here):
            continue
        if rest.case == NOMINAL:
            disks[rest.label] = _disks(rest.equilibrium, loops.groups)
        else:
            varied[rest.label] = equilibrium.open_loop(rest.equilibrium, list(loops.groups[AT_ONCE]))
    nominal = min((each[AT_ONCE].lower for each in disks.values()), default=np.inf)
    if nominal and (least := disk.least(list(varied.values()), nominal)):
        disks[list(varied)[least[0]]] = {AT_ONCE: least[1]}
    return Survey(opened, unsolved, disks)


def _open(point: str, case: Case, signal: str, at_rest: Equilibrium) -> OpenLoop:
    L = equilibrium.open_loop(at_rest, signal)
    return OpenLoop(point, case, signal, L, _margins(L, signal, point))


def _margins(L: StateSpace, signal: str, point: str) -> Margins:
    try:
        return stability_margins.of_loop(L)
    except ModelError as error:
        raise ModelError(f"the loop opened at {signal} at the operating point '{point}': {error}") from error


@arguments.checked
def disk_margins(loops: Loops, point: str, case: Case = NOMINAL) -> dict[str, disk.DiskMargin]:
    """Return the disk margins with all ``actuators``, all ``sensors`` or ``both`` varied at once, as `disk.of_loop`."""
    return _disks(equilibrium_at(loops, point, case), loops.groups)


def _disks(at_rest: Equilibrium, groups: Groups) -> dict[str, disk.DiskMargin]:
    return {name: disk.of_loop(equilibrium.open_loop(at_rest, list(signals))) for name, signals in groups.items()}


@arguments.checked
def checks(loops: Sequence[OpenLoop], require: Mapping[str, float], unsolved: Sequence[Unsolved] = ()) -> list[Check]:
    """Return for each required margin the least of the loops, beside what is required.

    Where a loop is not stable, or has no equilibrium, no margin is left.

    `require` {name: least} takes the names of REQUIREMENTS: phase_margin in degrees, gain_margin and gain_reduction as
    factors above 1, delay_margin in s, modulus_margin; -inf requires nothing.

    Raises SignalError for another name, a margin that is NaN, or no loop.
    """
    if undefined := [name for name, least in require.items() if np.isnan(least)]:
        raise SignalError(f"the required {undefined[0]} is NaN: give a number, or -inf to require nothing")
    if unknown := [name for name in require if name not in REQUIREMENTS]:
        raise SignalError(f"'{unknown[0]}' is not a known margin: choose one of {', '.join(REQUIREMENTS)}")
    if not loops and not unsolved:
        raise SignalError("there is no loop to check: open at least one")
    return [_check(loops, name, least, unsolved) for name, least in require.items()]


def _check(loops: Sequence[OpenLoop], name: str, least: float, unsolved: Sequence[Unsolved]) -> Check:
    requirement = REQUIREMENTS[name]
    if unsolved:
        others = f", the first of {len(unsolved)} such cases" if len(unsolved) > 1 else ""
        value, about = requirement.if_unstable, f"no equilibrium {unsolved[0].label}{others}: {unsolved[0].reason}"
    else:
        worst = min(loops, key=lambda loop: loop.margin(name))
        value, stable = worst.margin(name), "" if worst.margins.stable else ", not stable"
        about = f"the least of {len(loops)} loops, {worst.label}{stable}"
    return Check(name.replace("_", " "), value, least, requirement.unit, about, at_least=True)
