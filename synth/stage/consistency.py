"""What a stage declares must fit its plant and its interface: names, ranges, velocities, stops, drive and companions.

Each check raises SignalError or DesignError where the design is made, before anything is computed or compiled.
"""

import casadi as ca
import numpy as np

from synth import arguments
from synth.declare.stage import MARGINS, Stage
from synth.errors import DesignError, SignalError
from synth.plant import velocities
from synth.signals import signal_names

LONGEST_STEP = 2.0  # times |pole|: Runge and Kutta's method of order 4 diverges from 2.8 on
ADDED_DAMPING = 1e-4, 0.1  # that the method may add to a damping ratio: as such, and of it
MOST_SUBSTEPS = 1024


def require_consistent(stage: Stage) -> None:
    """Raise SignalError or DesignError for a declaration that does not fit the plant, the interface or itself."""
    _require_known_margins(stage)
    _require_known_cases(stage)
    _require_all_coordinates(stage)
    _require_operating_points_in_range(stage)
    _require_reachable_stops(stage)
    _require_set_points_in_range(stage)
    _require_emitted_drive(stage)
    _require_equal_parameters(stage)
    _require_substeps(stage)
    _require_rates(stage)
    _require_known_inertias(stage)
    if not stage.runs:  # else at their first use, which imports them
        stage.study.require_experiments([e.name for e in stage.experiments])
    _require_callable_reference(stage)


def _require_callable_reference(stage: Stage) -> None:
    """Raise DesignError for a reference that is no function. Without one a stage has margins; verification needs it."""
    if stage.reference is not None and not callable(stage.reference):
        raise DesignError(
            f"the reference of design '{stage.name}' is {arguments.describe(stage.reference)}: give its step function, "
            "(states, inputs) -> (states', outputs, fault words)"
        )


def _require_known_margins(stage: Stage) -> None:
    """Raise SignalError for a margin or a parameter of a tolerance that is not known, or a limit that is NaN."""
    if unknown := [name for name in stage.require if name not in MARGINS]:
        raise SignalError(f"require: '{unknown[0]}' is not a margin: name one of {', '.join(MARGINS)}")
    if missing := [name for name, least in stage.require.items() if np.isnan(least)]:
        raise SignalError(f"require: the least {missing[0]} is NaN, which no loop reaches: give a number")
    for name in stage.tolerances:
        stage.plant.parameter(name)


def _require_known_cases(stage: Stage) -> None:
    """Raise SignalError for a case with an unknown name, or a value out of range, and for an experiment in none.

    An auxiliary input with the name of a parameter is refused: a value of it would be that of the input alone.
    """
    ends = {p.name: p.tolerance for p in stage.plant.parameters}
    ranges = {name: end if isinstance(end, tuple) else (-np.inf, np.inf) for name, end in ends.items()}
    if both := [a.name for a in stage.interface.auxiliaries if a.name in ranges]:
        raise SignalError(
            f"'{both[0]}' is an auxiliary input and a parameter of plant '{stage.plant.name}', which a case could not "
            "tell apart: rename one"
        )
    ranges |= {a.name: (a.low, a.high) for a in stage.interface.auxiliaries}
    for case, values in stage.cases.items():
        if not case:
            raise SignalError("a case has no name, by which conditions would choose it: give it one")
        for name, value in values.items():
            if name not in ranges:
                raise SignalError(
                    f"case '{case}' gives '{name}', which is neither a parameter of plant '{stage.plant.name}' nor an "
                    f"auxiliary input: name some of {', '.join(ranges)}"
                )
            low, high = ranges[name]
            if not (low <= value <= high and np.isfinite(value)):
                raise SignalError(
                    f"case '{case}' has {name} = {value:g}, beyond its range of {low:g} .. {high:g}: choose one inside"
                )
        for a in stage.interface.auxiliaries:
            if a.name not in values and not a.low <= (announced := values.get(a.of, a.low)) <= a.high:
                raise SignalError(
                    f"case '{case}' has {a.of} = {announced:g}, which the auxiliary input '{a.name}' of {a.low:g} .. "
                    f"{a.high:g} cannot tell: give the input a wider range, or a value of '{a.name}' in the case"
                )
    for experiment in stage.experiments:
        conditions = getattr(experiment, "conditions", None)
        if conditions is not None and conditions.case and conditions.case not in stage.cases:
            raise SignalError(
                f"{experiment.name} runs in case '{conditions.case}', which is not declared: name one of "
                f"{', '.join(stage.cases) or 'none'}, in `cases` of the stage"
            )


def _require_all_coordinates(stage: Stage) -> None:
    """Raise SignalError for coordinates that name no sensor, or that leave out one with a set-point and no sensor.

    Loops are opened at the coordinates in place of their sensors: one that is left out would have no loop.
    """
    sensors = {s.name: s.of for s in stage.interface.sensors}
    for name, weights in stage.coordinates.items():
        if unknown := [n for n in weights if n not in sensors]:
            raise SignalError(
                f"coordinates: '{name}' is a sum with '{unknown[0]}', which is no sensor: name some of "
                f"{', '.join(sensors)}"
            )
    known = {*stage.coordinates, *sensors.values()}
    for point in stage.interface.set_points if stage.coordinates else ():
        if point.of not in known:
            raise SignalError(
                f"coordinates: '{point.of}', the coordinate of set-point '{point.name}', is missing, so that its loop "
                f"would not be opened: give it as a sum of some of {', '.join(sensors)}"
            )


def _require_operating_points_in_range(stage: Stage) -> None:
    """Raise SignalError for an operating point with an unknown state or input, or beyond the range of one."""
    plant = stage.plant
    known = {s.name: s for s in (*plant.states, *plant.inputs)}
    for point, values in stage.operating_points.items():
        for name, value in values.items():
            if name not in known:
                raise SignalError(
                    f"operating point '{point}': plant '{plant.name}' has no state or input '{name}': name some of "
                    f"{', '.join(known)}"
                )
            s = known[name]
            if not s.low <= value <= s.high:
                raise SignalError(
                    f"operating point '{point}' has {name} = {value:g} {s.unit}, beyond the plant's range of "
                    f"{s.low:g} .. {s.high:g}: choose a value inside"
                )


def _require_reachable_stops(stage: Stage) -> None:
    """Raise SignalError for a stop of no state or without a velocity, or beyond the range of plant or sensors."""
    plant, sensors = stage.plant, stage.interface.sensors
    states = {s.name: s for s in plant.states}
    for q, (low, high) in stage.stops.items():
        if q not in states:
            raise SignalError(f"stops: plant '{plant.name}' has no state '{q}': name some of {', '.join(states)}")
        if q not in stage.velocities:
            raise SignalError(f"'{q}' has stops, but velocities lack it: add the state that is the rate of '{q}'")
        s = states[q]
        if low < s.low or high > s.high:
            raise SignalError(
                f"the stops of '{q}' are at {low:g} and {high:g} {s.unit}, beyond the plant's range of {s.low:g} .. "
                f"{s.high:g}: choose stops inside, or a wider range of '{q}'"
            )
        read = [stage.interface.signals[each.name] for each in sensors if each.of == q and not each.wraps]
        if read and not any(r.low <= low and high <= r.high for r in read):
            raise SignalError(
                f"sensor '{read[0].name}' may be {read[0].low:g} .. {read[0].high:g} {s.unit}, but '{q}' has stops at "
                f"{low:g} and {high:g}, where the guard would refuse its reading: give it a range that contains them"
            )


def _require_set_points_in_range(stage: Stage) -> None:
    """Raise SignalError for a set-point whose range goes beyond that of its sensor, or beyond a stop."""
    interface = stage.interface
    outputs = {s.name: s.of for s in interface.sensors}
    for point in interface.set_points:
        limits, unit = [], interface.signals[point.name].unit
        for sensor in (
            interface.signals[s.name] for s in interface.sensors if point.of in (s.name, s.of) and not s.wraps
        ):
            limits.append((f"the range of its sensor '{sensor.name}'", sensor.low, sensor.high))
        position = outputs.get(point.of, point.of)
        if position in stage.stops:
            limits.append((f"the distance between the stops of '{position}'", *stage.stops[position]))
        for what, low, high in limits:
            if point.low < low or point.high > high:
                raise SignalError(
                    f"set-point '{point.name}' may be {point.low:g} .. {point.high:g} {unit}, beyond {what}, "
                    f"{low:g} .. {high:g}: give it a range inside"
                )


def _require_emitted_drive(stage: Stage) -> None:
    """Raise DesignError for two Blocks of one name, and for a Block of the drive that is not among the companions."""
    names, driven = [c.name for c in stage.companions], stage.drive.companions if stage.drive else ()
    if missing := [c.name for c in driven if c not in stage.companions]:
        raise DesignError(
            f"the drive calls the Block '{missing[0]}', which is not emitted: add its Companion(...) to `companions`"
        )
    if stage.name in names:
        raise DesignError(f"a Block and the controller are both called '{stage.name}': rename the Block")
    if twice := [name for k, name in enumerate(names) if name in names[:k]]:
        raise DesignError(f"two Blocks beside the controller are called '{twice[0]}': rename one")


def _require_equal_parameters(stage: Stage) -> None:
    """Raise DesignError where a parameter of the driven plant differs from that of the plant."""
    driven = {p.name: p for p in stage.drive.plant.parameters} if stage.drive else {}
    for p in stage.plant.parameters:
        if p.name in driven and driven[p.name].value != p.value:
            raise DesignError(
                f"the plant has {p.name} = {p.value:g} {p.unit}, for which the margins are, and the driven plant "
                f"{driven[p.name].value:g}, with which the experiments run: take one source for both"
            )


def _require_substeps(stage: Stage) -> None:
    """Raise DesignError where the Runge-Kutta steps of the simulation are too long for a pole of the plant.

    They diverge at the fastest one, or damp an oscillation: by ln |R(p h)| - Re(p h) in a step h, with the polynomial R
    of the method. The poles are those at the operating points and at the start, without inputs.
    """
    plant = stage.drive.plant if stage.drive else stage.plant
    rates = ca.Function("A", (x := plant.f.mx_in())[:3], [ca.jacobian(plant.f(*x), x[0])])
    u, period_s = np.zeros(len(plant.inputs)), stage.controller.block.time.period_s
    for point in (stage.start, *stage.operating_points.values()):
        A = np.asarray(rates([point.get(s.name, 0.0) for s in plant.states], u, plant.values))
        poles = np.linalg.eigvals(A) if np.isfinite(A).all() else np.zeros(0)
        fastest = float(np.abs(poles).max(initial=0.0))
        needed = int(np.ceil(fastest * period_s / LONGEST_STEP))
        if needed > stage.substeps:
            raise DesignError(
                f"plant '{plant.name}' has a pole of {fastest:.3g} 1/s, and a sample of {period_s:g} s has "
                f"{stage.substeps} Runge-Kutta steps, too few to simulate it: give substeps={needed} or more, or leave "
                f"the pole out of the plant{'; Discrete takes the period in s, not the rate' if period_s >= 1 else ''}"
            )

        for p in poles[np.abs(poles.imag) > np.abs(poles.real)]:
            n = stage.substeps
            while n < MOST_SUBSTEPS and _added_damping(p * period_s / n) > 1:
                n += 1
            if n > stage.substeps:
                raise DesignError(
                    f"plant '{plant.name}' has a mode of {abs(p) / (2 * np.pi):.3g} Hz with a damping ratio of "
                    f"{-p.real / abs(p):.2g}, which {stage.substeps} Runge-Kutta steps in a sample of {period_s:g} s "
                    f"would damp further: give substeps={n} or more, or leave the mode out of the plant"
                )


def _added_damping(step: complex) -> float:
    """Return the damping ratio that the method adds to a pole times the step, over what it may add."""
    growth = abs(1 + step * (1 + step / 2 * (1 + step / 3 * (1 + step / 4))))
    absolute, relative = ADDED_DAMPING
    return abs(np.log(growth) - step.real) / max(absolute * abs(step), relative * abs(step.real))


def _require_rates(stage: Stage) -> None:
    """Raise SignalError for a velocity that is certainly not the rate of its position."""
    plant, rates = stage.plant, velocities(stage.plant)
    states = signal_names(plant.states)
    for q, v in stage.velocities.items():
        if unknown := [name for name in (q, v) if name not in states]:
            known = ", ".join(states)
            raise SignalError(f"velocities: plant '{plant.name}' has no state '{unknown[0]}': name one of {known}")
        if rates.get(q, v) != v:
            raise SignalError(f"velocities: the rate of '{q}' is '{rates[q]}', not '{v}'")
        if not plant.f.jac_sparsity(0, 0).has_nz(states.index(q), states.index(v)):
            raise SignalError(
                f"velocities: the rate of '{q}' does not depend on '{v}': name the state that is its rate"
            )


def _require_known_inertias(stage: Stage) -> None:
    """Raise SignalError for an inertia of the fault campaign without its position or plant parameter."""
    positions = velocities(stage.plant) | dict(stage.velocities)
    for q in stage.faults.inertias:
        if q not in positions:
            known = ", ".join(positions) or "none"
            raise SignalError(f"inertias: '{q}' is not a position with a velocity: name one of {known}")
        for parameter in stage.faults.inertia(q):
            stage.plant.parameter(parameter)
