"""A rig under effects that the model of its plant lacks: the plant with further states, inputs and parameters.

`declare.effects` has the equations. Sizes are parameters of the extended plant, so that one compiled loop serves every
size and every machine; what varies over time enters through further inputs. The controller knows none of it.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import count
from typing import Any

import casadi as ca
import numpy as np

from synth import arguments
from synth.declare.effects import (
    RAMP_S,
    RAMP_SHARE,
    Amplifiers,
    Cable,
    Changed,
    Course,
    CurrentLoops,
    Effect,
    Floor,
    Force,
    Mode,
    Readings,
)
from synth.declare.stage import Sensor
from synth.errors import DesignError
from synth.plant import Plant, velocities
from synth.signals import Parameter, Signal
from synth.simulate import conditions
from synth.simulate.rig import Rig
from synth.simulate.scenario import Array

LINES = 64  # of the spectrum of a floor
LEAST_LAG = 0.02  # of a period: a shorter lag is none
SOURCE = "unmodelled"


def with_effects(rig: Rig, effects: Sequence[Effect]) -> Rig:
    """Return the rig under effects.

    Raises DesignError for what is no effect, for an unknown position or sensor, and for a force on a position without
    an inertia.
    """
    for effect in effects:
        if not isinstance(effect, Effect):
            raise DesignError(f"{arguments.describe(effect)} is no effect: give those of synth.declare.effects")
        if isinstance(effect, Changed):
            rig = replace(rig, plant=effect.plant(rig.plant, effect.share))
        if isinstance(effect, Readings):
            rig = _with_readings(rig, effect)
    plant, driven = rig.plant, [s for s in rig.plant.inputs if s.name in rig.connections]
    names = [s.name for s in plant.states]
    rates = velocities(plant) | dict(rig.stage.velocities)
    x, u, p = (ca.SX.sym(letter, n) for letter, n in zip("xup", map(plant.f.size1_in, range(3)), strict=True))
    states, inputs, parameters = list(plant.states), list(plant.inputs), list(plant.parameters)
    further: dict[str, list[ca.SX]] = {"x": [], "dx": [], "u": [], "p": []}
    courses: dict[str, Any] = {}

    def free_name(name: str, number: int) -> str:
        taken = {s.name for s in (*states, *inputs, *plant.outputs)} | {s.name for s in parameters}
        return next(n for k in count(number) if (n := f"{name}_{k}") not in taken)

    def size(name: str, value: float) -> ca.SX:
        parameters.append(Parameter(free_name(name, len(parameters)), value, "1", 0.0, SOURCE))
        further["p"].append(ca.SX.sym(parameters[-1].name))
        return further["p"][-1]

    def acting(name: str, course: Any) -> ca.SX:
        inputs.append(Signal(free_name(name, len(inputs)), "1", -1e9, 1e9))
        courses[inputs[-1].name] = course
        further["u"].append(ca.SX.sym(inputs[-1].name))
        return further["u"][-1]

    def state(name: str) -> ca.SX:
        states.append(Signal(free_name(name, len(states)), "1", -1e9, 1e9))
        further["x"].append(ca.SX.sym(states[-1].name))
        return further["x"][-1]

    def position(of: str) -> tuple[int, int]:
        if of not in rates or of not in names:
            raise DesignError(
                f"an effect acts on '{of}', which is no position with a rate: name one of {', '.join(rates) or 'none'}"
            )
        return names.index(of), names.index(rates[of])

    def inertia(of: str) -> ca.SX:
        if of not in rig.stage.faults.inertias:
            raise DesignError(
                f"a force acts on '{of}', whose inertia is not known: give FaultCampaign(inertias={{'{of}': ...}})"
            )
        known = [q.name for q in plant.parameters]
        return sum((p[known.index(name)] for name in rig.stage.faults.inertia(of)), start=ca.SX(0))

    # From the commands to the inputs of the plant: amplifiers, then the lags of the current loops.
    through, lagging = ca.SX(u), {}
    signs = np.random.default_rng(rig.seed).choice([-1.0, 1.0], (2, len(driven)))
    for effect in effects:
        if isinstance(effect, Amplifiers):
            for s, s_gain, s_offset in zip(driven, *signs.tolist(), strict=True):
                i = plant.inputs.index(s)
                gain, offset = size("gain", s_gain * effect.gain), size("offset", s_offset * effect.offset)
                through[i] = (1 + gain) * through[i] + offset
    lags = [e.lag_s for e in effects if isinstance(e, CurrentLoops) and e.lag_s > LEAST_LAG * rig.period_s]
    for lag_s in lags:
        tau = size("lag", lag_s)
        for s in driven:
            i, lagged = plant.inputs.index(s), state(s.name)
            further["dx"].append((through[i] - lagged) / tau)
            through[i], lagging[states[-1].name] = lagged, s.name
    dx, read = plant.f(x, through, p), ca.SX(x)

    # Forces on the positions, then the modes that their accelerations excite, then what sensors make of it.
    for effect in effects:
        if isinstance(effect, Force):
            v = position(effect.of)[1]
            dx[v] += acting("force", _risen(effect.course, effect.share)) / inertia(effect.of)
        elif isinstance(effect, Cable):
            q, v = position(effect.of)
            pull = size("stiffness", effect.stiffness) * x[q] + size("preload", effect.preload)
            dx[v] -= acting("cable", _risen(1.0, 1.0)) * pull / inertia(effect.of)
        elif isinstance(effect, Floor):
            if not 0 <= effect.low_hz < effect.high_hz <= 0.5 / rig.period_s:
                raise DesignError(
                    f"a floor moves from {effect.low_hz:g} to {effect.high_hz:g} Hz: give a band up to half of the "
                    f"rate, {0.5 / rig.period_s:g} Hz"
                )
            for k, of in enumerate(effect.of):
                dx[position(of)[1]] += acting("floor", _spectrum(effect, rig.seed, k))
    for effect in effects:
        if isinstance(effect, Mode):
            q, v = position(effect.of)
            w, e, rate = 2 * np.pi * effect.frequency_hz, state("mode"), state("mode_rate")
            excited = size("participation", effect.participation) * dx[v]
            further["dx"] += [rate, excited - 2 * effect.damping * w * rate - w**2 * e]
            read[q] += e
    y = plant.h(read, through, p)
    for effect in effects:
        if isinstance(effect, Readings) and effect.ripple:
            for s in _sensors(rig, effect):
                i = [o.name for o in plant.outputs].index(s.of)
                y[i] += size("ripple", effect.ripple) * ca.sin(2 * np.pi / effect.pitch * y[i])
    symbols = [ca.vertcat(base, *further[letter]) for letter, base in (("x", x), ("u", u), ("p", p))]
    extended = Plant(
        plant.name,
        tuple(states),
        tuple(inputs),
        plant.outputs,
        tuple(parameters),
        ca.Function("f", symbols, [ca.vertcat(dx, *further["dx"])]),
        ca.Function("h", symbols, [y]),
    )
    longest_s = [*lags, *(_longest_step(e) for e in effects if isinstance(e, Mode))]
    substeps = max(rig.stage.substeps, int(np.ceil(rig.period_s / min(longest_s, default=np.inf))))
    stage = replace(rig.stage, substeps=substeps, velocities=rates)
    return replace(rig, plant=extended, stage=stage, lagging=lagging, forcing={**rig.forcing, **courses})


def _longest_step(mode: Mode) -> float:
    """Return the step of Runge and Kutta's method in s that adds at most a tenth, or 1e-4, to the damping ratio.

    It damps an undamped mode in a step h by (w h)^6 / 144, as a damping ratio of (w h)^5 / 144 does.
    """
    angle = min(1.0, (144 * max(1e-4, 0.1 * mode.damping)) ** 0.2) / max(1.0, 2 * mode.damping)
    return float(angle / (2 * np.pi * mode.frequency_hz))


def _sensors(rig: Rig, effect: Readings) -> list[Sensor]:
    """Return the sensors of the errors of readings; raise DesignError for an unknown one."""
    sensors = {s.name: s for s in rig.stage.interface.sensors}
    if unknown := [name for name in effect.of if name not in sensors]:
        raise DesignError(f"an effect acts on the sensor '{unknown[0]}': name some of {', '.join(sensors)}")
    return [sensors[name] for name in (effect.of or sensors)]


def _with_readings(rig: Rig, effect: Readings) -> Rig:
    """Return the rig with the gain errors and the noise of an effect, beside those that its sensors have."""
    wrong = {s.name for s in _sensors(rig, effect)}
    noisier = tuple(
        replace(s, noise=float(np.hypot(s.noise, effect.noise))) if s.name in wrong else s
        for s in rig.stage.interface.sensors
    )
    gains = {name: (1 + rig.gain_errors.get(name, 0.0)) * (1 + effect.gain_error) - 1 for name in sorted(wrong)}
    return replace(rig, gain_errors={**rig.gain_errors, **gains}).with_interface(sensors=noisier)


def _risen(course: Course, share: float) -> Course:
    """Return a share of a course that rises from 0."""

    def risen(time: Array) -> Array:
        return share * _rise(time) * conditions.values(course, time)

    return risen


def _rise(time: Array) -> Array:
    """Return the rise r of forces over all times (N,) of a run."""
    rise_s = min(RAMP_S, RAMP_SHARE * len(time) * np.ptp(time[:2]))
    return np.asarray(np.minimum(time, rise_s) / (rise_s or 1.0))


def _spectrum(floor: Floor, seed: int, k: int) -> Course:
    """Return the acceleration of a floor along its position k: LINES sines with random phases, evenly over the band."""
    rng = np.random.default_rng([seed, k])
    width = (floor.high_hz - floor.low_hz) / LINES
    frequencies = floor.low_hz + width * (np.arange(LINES) + rng.uniform(size=LINES))
    phases, amplitude = rng.uniform(0.0, 2 * np.pi, LINES), floor.rms * np.sqrt(2 / LINES)

    def acceleration(time: Array) -> Array:
        lines = (np.sin(2 * np.pi * f * time + phase) for f, phase in zip(frequencies, phases, strict=True))
        return np.asarray(amplitude * _rise(time) * sum(lines))

    return acceleration
