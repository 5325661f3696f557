"""Simulation rig: the plant of a stage with its compiled controller, sensors, delay and stops.

plant --> sensors (noise, resolution) --> compiled controller --> drive --> delay --> hold --> plant
"""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from typing import Any, Protocol

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from synth.analyse.loops import robustness
from synth.declare.effects import Course
from synth.declare.stage import Stage
from synth.errors import ModelError
from synth.execute import host
from synth.plant import Plant, velocities
from synth.signals import signal_names
from synth.simulate import closed_loop, conditions, faulty
from synth.simulate import drive as drives
from synth.simulate.scenario import Array, Encoder, Scenario, Trajectory, sample_times
from synth.statespace import StateSpace

Wires = Mapping[str, str | Mapping[str, float]]
Values = tuple[tuple[str, float], ...]
DITHER = 1e-4  # of the declared noise, of an ideal sensor
RESTS_AT = 1e-6  # of a signal's range: a run that starts as near as this starts where it was asked to
UNDAMPED = 1 - 1e-9  # |z| of an oscillator that does not decay


class Simulate(Protocol):
    """A simulator of scenarios, as `closed_loop.simulate`."""

    def __call__(
        self,
        plant: Plant,
        controller: host.Controller,
        scenario: Scenario,
        disturbance: ca.Function | None = None,
        *,
        drive: tuple[host.Controller, ...] = (),
    ) -> Trajectory:
        """Run the scenario."""
        ...


def of_stage(stage: Stage, controller: host.Controller) -> "Rig":
    """Return the plant of a stage under a compiled controller, through the drive that the stage declares."""
    if stage.drive is None:
        return Rig(stage, stage.plant, controller)
    return Rig(stage, stage.drive.plant, controller, drive=_compile_drive(stage, np.dtype(controller.scalar).name))


@lru_cache(maxsize=8)
def _compile_drive(stage: Stage, scalar: str) -> tuple[host.Controller, ...]:
    kind, blocks = np.float32 if scalar == "float32" else np.float64, stage.drive.blocks if stage.drive else ()
    return tuple(host.compile_block(block, kind, error=stage.surrogate_error.get(kind)) for block in blocks)


@lru_cache(maxsize=64)  # the experiments of a machine share the plant, and with it its polynomials in lanes
def _with_parameters_of(plant: Plant, other: Plant) -> Plant:
    """Return the other plant with the values of the plant's parameters."""
    return other.with_parameters(**{p.name: p.value for p in plant.parameters})


@lru_cache(maxsize=64)  # most machines of a study have the same positions and set-points at their start
def _first_drive_commands(
    controller: host.Controller,
    drive: tuple[host.Controller, ...],
    inputs: tuple[tuple[str, float], ...],
    safe: tuple[tuple[str, float], ...],
) -> dict[str, float]:
    """Return the outputs of the last Block of a drive for first inputs of a controller with these safe outputs.

    Raises WiringError as `drive.connect`.
    """
    drives.connect(controller, np.zeros(1, controller.inputs), np.zeros(1, controller.outputs), drive)
    known: dict[str, Any] = dict(inputs)
    first = controller.step(controller.init(), {name: known[name] for name in controller.inputs.names or ()})
    known |= first.outputs | dict(safe)
    for block in drive:
        commands = block.step(block.init(), {name: known[name] for name in block.inputs.names or ()}).outputs
        known |= commands
    return {name: float(value) for name, value in commands.items()}


@lru_cache(maxsize=64)  # all machines of a study start there
def _equilibrium(stage: Stage, start: Values, case: Values) -> tuple[dict[str, float], ...]:
    """Return the plant's states, the controller's and its outputs at the stable equilibrium of the declared loop.

    There are none where it has no such equilibrium, to which no run would come. On a kink of the plant, where there are
    no poles, it counts as stable.
    """
    point, of_case = {"start": dict(start)}, robustness.Case(dict(case))
    loops = replace(robustness.of_stage(replace(stage, operating_points=point)), cases=(of_case,))
    try:
        rest = robustness.equilibrium_at(loops, "start", of_case)
    except ModelError:
        return ()
    with suppress(ModelError):
        if _oscillates(rest.controller) or not all(loop.is_stable for loop in robustness.closed_loops(loops)):
            return ()
    block = rest.closed.controller
    at = [
        [values[s.name] for s in signals]
        for values, signals in ((rest.state, block.states), (rest.inputs, block.inputs))
    ]
    outputs = np.asarray(block.function()(*at)[1]).ravel().tolist()
    x = dict(zip(rest.point.states, rest.point.x.tolist(), strict=True))
    return x, dict(rest.state), dict(zip(signal_names(block.outputs), outputs, strict=True))


def _oscillates(law: StateSpace) -> bool:
    """Tell whether a law has an oscillator: undamped states that no input reaches, and which the loop's poles lack."""
    free = ~(law.B != 0).any(axis=1)
    for _ in law.A:
        free &= ~(law.A[:, ~free] != 0).any(axis=1)
    z = np.linalg.eigvals(law.A[np.ix_(free, free)])
    return bool(((np.abs(z) > UNDAMPED) & (np.abs(z - 1) > 1 - UNDAMPED)).any())


@dataclass(frozen=True, eq=False)
class Rig:
    """The plant of a stage under a compiled controller; `plant` may differ from the declared plant.

    `quantised` False removes the resolution of the sensors; `noise` scales their declared noise, generated from `seed`;
    `actuators` replaces the connections from controller outputs to plant inputs; `disturbance(x, t)` is added to dx/dt.
    `drive` are the compiled Blocks behind the controller; `plant` is then the plant that they drive.
    `offsets` are errors of the sensors' zeros, in their units, `gain_errors` relative ones of their sensitivities.
    `forcing` are courses of the plant's inputs beside the disturbances; each state in `lagging` {state: input} follows
    an input, and starts at its first value. `simulate` runs a scenario.
    """

    stage: Stage
    plant: Plant
    controller: host.Controller
    quantised: bool = True
    noise: float = 1.0
    seed: int = 0
    actuators: Wires = field(default_factory=dict)
    disturbance: ca.Function | None = None
    drive: tuple[host.Controller, ...] = ()
    offsets: Mapping[str, float] = field(default_factory=dict)
    gain_errors: Mapping[str, float] = field(default_factory=dict)
    forcing: Mapping[str, Course] = field(default_factory=dict)
    lagging: Mapping[str, str] = field(default_factory=dict)
    simulate: Simulate = closed_loop.simulate

    @property
    def period_s(self) -> float:
        """The sample period."""
        return self.controller.period_s

    @property
    def connections(self) -> Wires:
        """The controller output, or weighted outputs, of each plant input that an actuator drives.

        With a drive it is the output of the drive that is called like the plant input.
        """
        if self.drive and not self.actuators:
            others = {*self.stage.interface.disturbances, *self.forcing}
            return {s.name: s.name for s in self.plant.inputs if s.name not in others}
        return self.actuators or self.stage.wires or {a.of: a.name for a in self.stage.interface.actuators}

    @property
    def ideal(self) -> "Rig":
        """The same rig with ideal sensors: without quantisation, and with at most DITHER of the declared noise.

        Without any noise the sensors of a machine at rest repeat their readings, as frozen ones do.
        """
        return replace(self, quantised=False, noise=min(self.noise, DITHER))

    @property
    def without_drive(self) -> "Rig":
        """The same rig in which the controller's outputs act on the plant of the stage directly."""
        if not self.drive:
            return self
        return replace(self, plant=_with_parameters_of(self.plant, self.stage.plant), drive=())

    def with_interface(self, **fields: Any) -> "Rig":
        """Return the same rig with some fields of its interface replaced; the controller is unchanged."""
        controller = self.stage.controller
        declared = replace(controller, interface=replace(controller.interface, **fields))
        return replace(self, stage=replace(self.stage, controller=declared))

    def run(
        self,
        duration_s: float,
        start: Mapping[str, float] | None = None,
        references: Mapping[str, ArrayLike] | None = None,
        **options: Any,
    ) -> Trajectory:
        """Simulate from rest at `start` (plant states; others start as declared by the stage) under set-points by name.

        A set-point is a constant or (N,); a missing one stays at the initial position, or as near as its range allows.
        `options` are further fields of `Scenario`. A controller that reads the number of missed calls gets that of
        `missed`.

        Raises SignalError and WiringError as `closed_loop.simulate`.
        """
        scenario = self._scenario(duration_s, start or {}, references or {}, options)
        return self.simulate(self.plant, self.controller, scenario, self.disturbance, drive=self.drive)

    def begun(
        self, samples: int, duration_s: float, start: Mapping[str, float], references: Mapping[str, ArrayLike]
    ) -> "Rig":
        """Return a rig that has run the first samples of `run`: its runs compute the others alone.

        They must have the same duration, start and set-points, and options that change nothing in these samples.
        Raises as `run`.
        """
        scenario = self._scenario(duration_s, start, references, {})
        prefix = closed_loop.begin(self.plant, self.controller, scenario, samples, self.disturbance, drive=self.drive)
        return replace(self, simulate=partial(closed_loop.simulate, prefix=prefix))

    def _scenario(
        self,
        duration_s: float,
        start: Mapping[str, float],
        references: Mapping[str, ArrayLike],
        options: Mapping[str, Any],
    ) -> Scenario:
        """Return the scenario of `run`."""
        interface, start = self.stage.interface, {**self.stage.start, **start}
        n = len(time := sample_times(duration_s, self.period_s))
        constants: dict[str, Any] = dict(self.constant_inputs)
        missed, calls = options.get("missed"), interface.missed_calls
        if missed is not None and calls and calls.name in constants:
            constants[calls.name] = faulty.missed_counts(missed)
        fields: dict[str, Any] = {
            "sensors": {s.name: s.of for s in interface.sensors},
            "actuators": self.connections,
            "references": constants | self.set_points_at(start) | dict(references),
            "encoders": self._encoders(),
            "noise": self.sensor_noise(n),
            "hold": self._first_commands(start),
            "forcing": dict.fromkeys(interface.disturbances, 0.0),
            "velocities": self.stage.velocities,
            "stops": self.stage.stops,
            "delay": interface.delay,
            "substeps": self.stage.substeps,
        }
        fields |= options
        if self.forcing:
            fields["forcing"] = fields["forcing"] | {u: conditions.values(c, time) for u, c in self.forcing.items()}
        for state, name in self.lagging.items():
            wire = self.connections[name]
            weights = {wire: 1.0} if isinstance(wire, str) else wire
            start[state] = sum(weight * fields["hold"].get(c, 0.0) for c, weight in weights.items())
        return Scenario(duration_s, start, **fields)

    def unrest(self, start: Mapping[str, float]) -> str:
        """Return why the loop has no equilibrium at `start`, empty where it may have one.

        It may where it is still, off its stops, with set-points in range and each sensor that wraps in its first turn.
        A stage that opens its loops itself has a controller that no sample leaves at rest.
        """
        states, rates = {**self.stage.start, **start}, velocities(self.plant) | dict(self.stage.velocities)
        moves = any(states.get(v, 0.0) for v in rates.values())
        outputs, wrapping = self.plant.output_values(states), (s for s in self.stage.interface.sensors if s.wraps)
        turned = any(not 0 <= outputs[s.of][0] - (s.low or 0.0) < s.wraps for s in wrapping)
        reasons = {
            "on a stop": not self.is_free(start),
            "in motion": moves,
            "out of the range of a set-point": self._positions_at(start) != self.set_points_at(start),
            "beyond the first turn of a sensor": turned,
            "under a law that no sample leaves at rest": bool(self.stage.loops),
        }
        return next((reason for reason, holds in reasons.items() if holds), "")

    def is_free(self, start: Mapping[str, float]) -> bool:
        """Tell whether the machine is on no stop at `start`."""
        states = {**self.stage.start, **start}
        return all(low < states.get(q, 0.0) < high for q, (low, high) in self.stage.stops.items())

    def at_equilibrium(self, start: Mapping[str, float], case: Mapping[str, float]) -> dict[str, Any]:
        """Return options of `run` under which the declared loop is in equilibrium, with the plant at or near `start`.

        They are the plant's states, those of the controller and the commands before the first sample. A position that
        nothing gives is that of its set-point, else 0; other states, such as currents, are as the equilibrium needs
        them. A `case` gives parameters and auxiliary inputs. A machine that differs from the declared one starts there,
        too.

        Without a stable equilibrium there, off the stops, they are `start`, where the machine is switched on.
        """
        asked = self.set_points_at(start)
        held = dict.fromkeys(self.stage.stops, 0.0) | {q: asked[name] for name, q in self.positions.items()}
        at = {q: value for q, value in held.items() if q in self._states} | {**self.stage.start, **start}
        rest = _equilibrium(self.stage, tuple(at.items()), tuple(case.items()))
        if not (rest and self.is_free(rest[0])):
            return {"start": start}
        states, controller, commands = rest
        read, written = (struct.names or () for struct in (self.controller.state, self.controller.outputs))
        hold = {name: value for name, value in commands.items() if name in written}
        return {
            "start": {name: value for name, value in states.items() if name in self._states},
            "state": {name: value for name, value in controller.items() if name in read},
            "hold": self.drive_commands(states, hold) if self.drive else hold,
        }

    def displacement(self, asked: Mapping[str, float], start: Mapping[str, float]) -> str:
        """Return as text the states and positions of a `start` that differ from what was asked for.

        A difference counts from a sensor's resolution on, and from RESTS_AT of the range of the signal.
        """
        known = {s.name: s for s in (*self.plant.outputs, *self.plant.states)}
        counts = {name: s.resolution for s in self.stage.interface.sensors for name in (s.name, s.of)}
        positions = self.positions
        places = [
            {positions[name]: value for name, value in self._positions_at(at).items()}
            | {name: value for name, value in at.items() if name in asked}
            for at in (asked, start)
        ]
        least = {q: max(counts.get(q, 0.0), RESTS_AT * (known[q].high - known[q].low)) for q in places[0]}
        moved = (q for q, value in places[0].items() if abs(places[1][q] - value) > least[q])
        return "".join(f", {q} = {places[1][q]:.4g} {known[q].unit}" for q in moved)

    def _first_commands(self, start: Mapping[str, float]) -> dict[str, float]:
        """Return the commands before the first sample: the safe values, through the drive at the initial position."""
        outputs = self.controller.outputs.names or ()
        safe = {a.name: a.safe for a in self.stage.interface.actuators if a.name in outputs}
        return self.drive_commands(start, safe) if self.drive else safe

    def drive_commands(self, start: Mapping[str, float], commands: Mapping[str, float]) -> dict[str, float]:
        """Return the outputs of the drive for these outputs of the controller, at rest at `start`.

        What else the drive reads of the controller is that of a first sample at rest there.
        """
        known: dict[str, Any] = self._ideal_readings(start)
        known |= self.set_points_at(start) | self.constant_inputs
        return _first_drive_commands(self.controller, self.drive, tuple(known.items()), tuple(commands.items()))

    @property
    def positions(self) -> dict[str, str]:
        """The plant state that each set-point controls, or the output behind its sensor where it names no state."""
        interface = self.stage.interface
        sensors = {s.name: s.of for s in interface.sensors if s.name not in self._states}
        return {s.name: sensors.get(s.of, s.of) for s in interface.set_points}

    @property
    def _states(self) -> set[str]:
        return {s.name for s in self.plant.states}

    def at_rest(self) -> dict[str, float]:
        """Return the controller inputs at the initial state of the stage, with zero plant inputs."""
        start = self.stage.start
        return self._ideal_readings(start) | self.set_points_at(start) | self.constant_inputs

    def set_points_at(self, start: Mapping[str, float]) -> dict[str, float]:
        """Return the set-points of a stage that rests at `start`, the nearest allowed where it rests on a stop.

        States that `start` lacks are those of the stage's start; the set-point of a state in neither has its `initial`
        value.
        """
        points = {s.name: s for s in self.stage.interface.set_points}
        return {n: float(np.clip(r, points[n].low, points[n].high)) for n, r in self._positions_at(start).items()}

    def _positions_at(self, start: Mapping[str, float]) -> dict[str, float]:
        """Return the set-points of `set_points_at` without the limits of their ranges."""
        states = {**self.stage.start, **start}
        outputs = self.plant.output_values(states).items()
        at = {name: float(y[0]) for name, y in outputs if name not in self._states} | states
        positions = self.positions
        return {s.name: at.get(positions[s.name], s.initial or 0.0) for s in self.stage.interface.set_points}

    @property
    def constant_inputs(self) -> dict[str, float]:
        """Those of the interface that the controller reads: that of an experiment may be a variant."""
        read = self.controller.inputs.names or ()
        constants = self.stage.interface.constant_inputs(self.plant)
        return {name: value for name, value in constants.items() if name in read}

    def _encoders(self) -> dict[str, Encoder]:
        encoders = {
            s.name: Encoder(
                s.resolution if self.quantised else 0.0,
                self.offsets.get(s.name, 0.0),
                self.gain_errors.get(s.name, 0.0),
                *((s.wraps, s.low) if s.wraps and s.low is not None else ()),
            )
            for s in self.stage.interface.sensors
        }
        return {name: encoder for name, encoder in encoders.items() if encoder != Encoder()}

    def _ideal_readings(self, start: Mapping[str, float]) -> dict[str, float]:
        """Return what the sensors show at rest at `start`, without errors."""
        outputs, ideal = self.plant.output_values(start), replace(self, quantised=False, offsets={}, gain_errors={})
        encoders = ideal._encoders()
        sensors = self.stage.interface.sensors
        return {s.name: float(encoders.get(s.name, Encoder()).read(outputs[s.of][0])) for s in sensors}

    def sensor_noise(self, n: int) -> dict[str, Array]:
        """Return n samples of noise for each noisy sensor; a shorter record is the beginning of a longer one."""
        sensors = self.stage.interface.sensors
        if not self.noise or not any(s.noise for s in sensors):
            return {}
        noise = np.random.default_rng(self.seed).standard_normal((n, len(sensors))).T
        return {s.name: self.noise * s.noise * row for s, row in zip(sensors, noise, strict=True) if s.noise}
