"""Currents that stay while calls are missing: how near the platen comes to a stop, whatever law computed them.

A law knows the plant and its state exactly and keeps the platen on the course of the 4-DOF tracking. In the sample
before the calls are missing its six currents therefore give the accelerations of the course: five equations, so one
number is free, the split

    s = (i_d1 + i_d3) - (i_d2 + i_d4)

The twelve phase currents then stay for the missed calls and the sample that the next call needs. After that all four
motors get their largest direct current, which drives the platen away from the nearer stop of y, until it turns round.
The largest distance to the stops over all s is a bound of every law that follows the course; below 0 it is a contact.

    python -m studies.maglev.held_currents        the table of docs/decisions/maglev_landing.md
"""

import sys
from dataclasses import dataclass
from functools import cache, cached_property
from math import pi

import casadi as ca
import numpy as np
from scipy.optimize import least_squares

from designs.maglev import platen
from models import maglev_phases, maglev_stage, windings
from synth.plant import Plant
from synth.simulate.faults import campaign
from synth.statespace import Array

STATES = [s.name for s in maglev_stage.STATES]
POSITIONS = list(maglev_stage.RATE)
Y, RATE_OF_Y, THETA = (STATES.index(n) for n in ("y", "vy", "theta"))
PERIOD_S, STOPPING = platen.TIME.period_s, 40  # samples within which the largest current turns the platen round
SPLITS = tuple(float(s) for s in range(-12, 13, 2))  # A; beyond them a motor exceeds its limit
PHASES = np.arange(24) / 24  # of the course's period, from its turning point at the smallest gap


@dataclass(frozen=True, eq=False)
class Hold:
    """Distances to the stops in m and rad, below 0 after a contact, and the split in A of these currents."""

    y: float
    theta: float
    split: float

    @property
    def least(self) -> float:
        """The smaller distance, m or rad: the ends of y and theta have like sizes."""
        return min(self.y, self.theta)


@dataclass(frozen=True, eq=False)
class Machine:
    """A plant of the stage under currents in rotating and in phase coordinates, by classical Runge-Kutta steps."""

    plant: Plant

    @cached_property
    def phases(self) -> Plant:
        """The same machine with its phase currents as inputs."""
        return maglev_phases.plant().with_parameters(**{p.name: p.value for p in self.plant.parameters})

    @cached_property
    def rates(self) -> ca.Function:
        """The derivative of the state under i_d1..i_d4, u_x, u_z."""
        x, u = ca.SX.sym("x", len(STATES)), ca.SX.sym("u", len(maglev_stage.INPUTS))
        return ca.Function("rates", [x, u], [self.plant.f(x, u, self.plant.values)])

    @cached_property
    def held(self) -> ca.Function:
        """The next state under phase currents that stay."""
        return _step(self.phases)

    @cached_property
    def driven(self) -> ca.Function:
        """The next state under direct and thrust currents at the true angle."""
        return _step(self.plant)

    def currents(self, x: Array, acceleration: Array, split: float, guess: Array) -> Array | None:
        """Return the six currents that accelerate the platen so, None if a motor exceeds its limit."""
        of = [STATES.index(maglev_stage.RATE[q]) for q in POSITIONS]

        def error(i: Array) -> Array:
            reached = np.asarray(self.rates(x, i)).ravel()[of]
            return np.r_[reached - acceleration, i[0] + i[2] - i[1] - i[3] - split]

        solved = least_squares(error, guess, xtol=1e-12, ftol=1e-12)
        i = np.asarray(solved.x)
        largest = max(np.hypot(i[j], i[5 if along == "z" else 4]) for j, along in enumerate(maglev_phases.ALONG))
        return i if solved.cost < 1e-12 and largest <= maglev_stage.PEAK else None

    def hold(self, x: Array, i: Array, samples: int) -> tuple[float, float]:
        """Return the least distances of y and theta to their stops while currents stay, and until y turns round."""
        path = _path(self.held, x, self._phase_currents(x, i), samples)
        theta = platen.BOX["theta"][1] - np.abs(path[:, THETA]).max()
        inward = 1.0 if path[-1, RATE_OF_Y] < 0 else -1.0
        full = np.r_[np.full(4, inward * maglev_stage.PEAK), 0.0, 0.0]
        stopping = _path(self.driven, path[-1], full, STOPPING)
        reversal = np.flatnonzero(inward * stopping[:, RATE_OF_Y] >= 0)
        y = np.r_[path[:, Y], stopping[: reversal[0] + 1 if len(reversal) else None, Y]]
        low, high = platen.BOX["y"]
        return float(min(y.min() - low, high - y.max())), float(theta)

    def _phase_currents(self, x: Array, i: Array) -> Array:
        state, phases = dict(zip(STATES, x, strict=True)), list[ca.SX]()
        for j, along in enumerate(maglev_phases.ALONG):
            angle = windings.electrical_angle(ca.SX(state[along]), ca.SX(self.plant.parameter("tau").value))
            phases += windings.phase_currents(ca.SX(i[j]), ca.SX(i[5 if along == "z" else 4]), angle).values()
        return np.array(ca.DM(ca.vcat(phases))).ravel()

    def bound(self, phase: float, missed: int, acceleration_y: float = 0.0) -> Hold:
        """Return the best hold over all splits at a phase of the course, with an error of the acceleration of y."""
        x, acceleration = course(phase)
        acceleration[0] += acceleration_y
        holds = []
        for direction in (SPLITS[len(SPLITS) // 2 :], SPLITS[len(SPLITS) // 2 - 1 :: -1]):
            guess = np.r_[np.ones(4), 0.0, 0.0]
            for split in direction:
                i = self.currents(x, acceleration, split, guess)
                if i is None:
                    break
                guess = i
                holds.append(Hold(*self.hold(x, i, missed + 1), split))
        return max(holds, key=lambda h: h.least)


def course(phase: float) -> tuple[Array, Array]:
    """Return state and accelerations on the course of the 4-DOF tracking at a phase of its period in 0 .. 1."""
    x, acceleration = dict.fromkeys(STATES, 0.0), dict.fromkeys(POSITIONS, 0.0)
    for q, sine in platen.COURSES.items():
        angle = 2 * pi * phase + sine.phase
        x[q] = sine.offset + sine.amplitude * np.sin(angle)
        x[maglev_stage.RATE[q]] = sine.amplitude * sine.frequency * np.cos(angle)
        acceleration[q] = -sine.amplitude * sine.frequency**2 * np.sin(angle)
    return np.array(list(x.values())), np.array(list(acceleration.values()))


@cache
def machine(number: int) -> Machine:
    """Return a plant of the fault campaign, by its number."""
    return Machine(campaign.plant_number(maglev_stage.plant(), number))


def _step(plant: Plant) -> ca.Function:
    x, u, T = ca.SX.sym("x", len(STATES)), ca.SX.sym("u", len(plant.inputs)), PERIOD_S
    f = ca.Function("f", [x, u], [plant.f(x, u, plant.values)])
    k1 = f(x, u)
    k2 = f(x + T / 2 * k1, u)
    k3 = f(x + T / 2 * k2, u)
    k4 = f(x + T * k3, u)
    return ca.Function("step", [x, u], [x + T / 6 * (k1 + 2 * k2 + 2 * k3 + k4)])


def _path(step: ca.Function, x: Array, u: Array, samples: int) -> Array:
    """Return the states (samples + 1, 10) under constant inputs."""
    later = np.asarray(step.mapaccum(samples)(x, np.repeat(u[:, None], samples, 1)))
    return np.vstack([x, later.T])


if __name__ == "__main__":
    for number in range(17):
        rows = {missed: [machine(number).bound(phase, missed) for phase in PHASES] for missed in (40, 60)}
        text = []
        for missed, holds in rows.items():
            k = int(np.argmin([h.least for h in holds]))
            text.append(f"{missed}: {1e3 * holds[k].least:6.2f} at {PHASES[k]:.3f}")
        sys.stdout.write(f"plant {number:2}  least distance in mm after missed calls  {'   '.join(text)}\n")
        sys.stdout.flush()
