"""Declaration of a stage: its sensors, set-points and actuators, the controller between them, and the requirements.

    sensors, set-points --> guard --> errors --> laws --> limits --> safe output --> actuators
                            <name>_held  <name>_error  <name>_demand  <name>_computed  <name>

Data alone; `synth.stage` completes them from the plant's signals and composes the controller.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from string import Formatter
from typing import Any, Protocol

import numpy as np

from synth import show
from synth.block import Block
from synth.declare.companion import Companion, Drive, Gains, Reference
from synth.declare.fault_campaign import FaultCampaign, SafeOutput, StudyLimits
from synth.declare.tuning import Tuning
from synth.errors import DesignError, SignalError
from synth.plant import Plant
from synth.signals import UNBOUNDED, Signal
from synth.timing import Discrete

DISK = "disk_margin"  # of all loops at once, the others of one loop at a time
MARGINS = ("phase_margin", "gain_margin", "gain_reduction", "delay_margin", "modulus_margin", DISK)


@dataclass(frozen=True)
class Sensor:
    """A controller input that reads the plant output `of`; if `of` is left out, the output with the sensor's own name.

    `resolution` and `noise` (standard deviation, white) are in the output's unit. The guard accepts `low` .. `high`,
    by default the output's range. Before the first good sample, and with `held=False` for each bad one, it takes
    `initial`, by default the value nearest to 0. `offset` is the largest error of its zero, `gain_error` the largest
    relative one of its sensitivity, on the machines of studies and fault campaigns. A reading that `wraps` starts over
    after this span, in the output's unit: it lies in `low`, by default 0, to `low` + `wraps`, while the output goes on.
    Operating points then lie in this range; `estimate.unwrap` counts the turns for the law.
    """

    name: str
    of: str = ""
    resolution: float = 0.0
    noise: float = 0.0
    offset: float = 0.0
    gain_error: float = 0.0
    low: float | None = None
    high: float | None = None
    initial: float | None = None
    held: bool = True
    about: str = ""
    wraps: float = 0.0


@dataclass(frozen=True)
class SetPoint:
    """A controller input: the desired value of the plant output or state `of`, in its unit; a bad one never latches."""

    name: str
    of: str
    low: float
    high: float
    initial: float | None = None
    about: str = ""


@dataclass(frozen=True)
class Auxiliary:
    """A controller input that is neither a reading nor a set-point: a payload, a feedforward, the number of a gain set.

    A law reads ``<name>_held``. A bad value never latches; `initial`, by default the value nearest to 0, stands in for
    it, and for what an experiment or a margin does not give. With `of` the input tells the law the plant parameter of
    this name: margins, experiments and machines of a study give it the value of their plant, unless a case or
    conditions give the input itself.
    """

    name: str
    unit: str
    low: float
    high: float
    initial: float | None = None
    about: str = ""
    of: str = ""


@dataclass(frozen=True)
class Actuator:
    """A controller output that drives the plant input `of`, called like it where `of` is left out.

    It is limited to `low` .. `high`, by default the input's range. Once latched it slews by `slew_per_s` to `safe`, or
    to `landed`, if given, while the machine rests on the stop on which it has landed; all in the input's unit.
    """

    name: str
    safe: float
    slew_per_s: float
    of: str = ""
    low: float | None = None
    high: float | None = None
    about: str = ""
    landed: float | None = None


@show.result
class Interface:
    """The interface between plant and laws, as `stage.interface` completes it: every `of`, low and high is set.

    `signals` are those of sensors, set-points, auxiliary inputs and actuators by name. `delay` counts samples between
    measurement and actuation; `disturbances` are plant inputs that no actuator drives. After `bad_samples` in a row
    with a bad sensor, of which `good_samples` make up for one, the actuators go to their safe values, with the
    `safe_output_effect`.
    `suspected` are sensors that a law compares, `missed_calls` the input that counts missing calls, if there is one. A
    law that reads ``brakes`` has `braking` samples more to stop the machine before.
    """

    plant: Plant
    sensors: tuple[Sensor, ...]
    set_points: tuple[SetPoint, ...]
    actuators: tuple[Actuator, ...]
    signals: Mapping[str, Signal]
    disturbances: tuple[str, ...]
    delay: int
    bad_samples: int
    safe_output_effect: str
    suspected: tuple[str, ...] = ()
    missed_calls: Signal | None = None
    braking: int = 0
    good_samples: int = 0
    auxiliaries: tuple[Auxiliary, ...] = ()

    def sheet(self) -> show.Sheet:
        """Return the signals with their ranges."""
        declared = (("sensor", self.sensors), ("set-point", self.set_points), ("auxiliary", self.auxiliaries))
        groups = {role: [self.signals[s.name] for s in each] for role, each in declared} | {"actuator": self.outputs}
        line = f"delay of {self.delay} samples; safe output after {self.bad_samples} bad samples in a row"
        line += f" and {self.braking} more in which it brakes" if self.braking else ""
        return show.Sheet(f"Interface to the plant {self.plant.name}", (line,), (show.signals(groups),))

    @property
    def references(self) -> tuple[SetPoint | Auxiliary, ...]:
        """The inputs that no sensor drives: set-points, then auxiliary ones."""
        return (*self.set_points, *self.auxiliaries)

    @property
    def inputs(self) -> tuple[Signal, ...]:
        """Inputs of the controller: sensors, set-points, auxiliary ones, and the count of missed calls if it is one."""
        declared = (*self.sensors, *self.references)
        return (*(self.signals[s.name] for s in declared), *((self.missed_calls,) if self.missed_calls else ()))

    def constant_inputs(self, plant: Plant) -> dict[str, float]:
        """Return inputs where nothing gives them: auxiliary ones and 0 missed calls.

        An auxiliary input has the value of the parameter that it tells, on this plant, or else its initial value.
        """
        parameters = {p.name: p.value for p in (*self.plant.parameters, *plant.parameters)}
        values = {a.name: parameters[a.of] if a.of else a.initial or 0.0 for a in self.auxiliaries}
        return values | ({self.missed_calls.name: 0.0} if self.missed_calls else {})

    @property
    def outputs(self) -> tuple[Signal, ...]:
        """The actuators' signals."""
        return tuple(self.signals[a.name] for a in self.actuators)

    @property
    def set_point_of(self) -> dict[str, SetPoint]:
        """The set-point of each sensor that has one and does not wrap, in the order of the set-points."""
        return {s.name: p for p in self.set_points for s in self.sensors if p.of in (s.name, s.of) and not s.wraps}

    def held(self, name: str) -> Signal:
        """Return ``<name>_held``, the guard's output for an input; raise SignalError for another name."""
        return replace(self._signal(name), name=f"{name}_held")

    def error(self, of: str) -> Signal:
        """Return ``<of>_error``, set-point less measurement; raise SignalError for a sensor without a set-point."""
        if of not in self.set_point_of:
            known = ", ".join(self.set_point_of) or "none"
            raise SignalError(f"'{of}' is no sensor with a set-point: declare both, or take one of {known}")
        r, y = self._signal(self.set_point_of[of].name), self._signal(of)
        return Signal(f"{of}_error", y.unit, r.low - y.high, r.high - y.low, f"{r.name} less {of}")

    def demand(self, name: str) -> Signal:
        """Return ``<name>_demand``, the output of a law before the actuator's limits: of any size."""
        return replace(self._signal(name), name=f"{name}_demand", low=-UNBOUNDED, high=UNBOUNDED)

    def computed_output(self, name: str) -> Signal:
        """Return ``<name>_computed``: the output of a law that limits its demand itself."""
        return replace(self._signal(name), name=f"{name}_computed")

    def before(self, name: str) -> Signal:
        """Return ``<name>_before``, the actuator's value one sample ago."""
        return replace(self._signal(name), name=f"{name}_before")

    def excess(self, name: str) -> Signal:
        """Return ``<name>_excess``, limited minus demanded, of any size; anti-windup reads it."""
        return replace(self._signal(name), name=f"{name}_excess", low=-UNBOUNDED, high=UNBOUNDED)

    def _signal(self, name: str) -> Signal:
        if name not in self.signals:
            raise SignalError(f"the interface has no '{name}': it has {', '.join(self.signals)}")
        return self.signals[name]


@dataclass(frozen=True, eq=False)
class Law:
    """Blocks between guard or errors and limits; `gains` returns their part of gains.json for a type, under `name`."""

    name: str
    blocks: tuple[Block, ...]
    gains: Gains | None = None


class Synthesis(Protocol):
    """A law that is computed once the rate and the interface are known: `axis.servo` returns one."""

    def law(self, time: Discrete, interface: Interface) -> Law:
        """Return the law at a rate, for an interface with its delay."""
        ...


@dataclass(frozen=True, eq=False)
class Composition:
    """The laws of a controller, all its Blocks in the order of data flow, and the composed Block."""

    laws: tuple[Law, ...]
    parts: tuple[Block, ...]
    block: Block


@show.result
class Controller:
    """A controller, composed at its first use: naming a design computes no gains."""

    name: str
    time: Discrete
    interface: Interface
    compose: Callable[[], Composition]

    def sheet(self) -> show.Sheet:
        """Return the interface; nothing is composed for it."""
        sheet = self.interface.sheet()
        return show.Sheet(f"Controller {self.name}, {self.time}", (f"{sheet.title}, {sheet.lines[0]}",), sheet.tables)

    @cached_property
    def composition(self) -> Composition:
        """The laws, parts and whole, computed once."""
        return self.compose()

    @property
    def laws(self) -> tuple[Law, ...]:
        """The laws between errors and limits."""
        return self.composition.laws

    @property
    def parts(self) -> tuple[Block, ...]:
        """All Blocks, from the guard to the safe output."""
        return self.composition.parts

    @property
    def block(self) -> Block:
        """The whole controller as one Block."""
        return self.composition.block


@show.result
class Stage:
    """A whole stage as declared, before anything is computed from it.

    reference         a step of the independent NumPy witness: (states, inputs) -> (states', outputs, fault words)
    operating_points  plant states by name of the point; `require` are least margins there, `disk_margin` among them
    coordinates       {name: {sensor: weight}}: sums of sensors at which loops are opened, instead of at each sensor
    loops             loops at places (`analyse.loops.robustness.LoopsAt`) of a controller that no sample leaves at rest
    tolerances        plant parameters; the margins are required at all limits of their tolerances, too
    cases             {name: values} of plant parameters and auxiliary inputs, such as payloads: the margins are
                      required in each, and `Conditions(case=name)` runs an experiment in one
    experiments       of `declare.experiments`; `runs` returns further ones, with `name` and `run(rig) -> Experiment`
    scalar            the scalar type of the C; `surrogate_error` is relative, by type, else the emitter's, and
                      `gain_error` the largest relative change of a DC gain of the law by the type
    start             initial plant states of a run, where these are not 0
    stops             (low, high) of positions, which are inelastic; `velocities` are the rates that f does not show
    limited           controller states that may reach their bounds, such as an integral limited on purpose
    wires             plant input: controller output, where these are not the interface's actuators
    stimuli           what drives the verification beyond the standard, by a function (`verify.standard.Stimuli`)
    verify            in place of `verify.standard.verify`, for a law whose comparison needs more than stimuli
    audit             yields the recomputed figures of a publication (`report.audit.Row`)
    contents          what the report has beyond the standard sections (`report.template.Extra`), from the results
    gains             the document of gains.json, else that of the laws
    companions        Blocks that are emitted beside the controller
    law_alone         the controller without its fault handling, whose cost is shown beside
    drive             Blocks between the controller and the plant in experiments, with the plant that they drive
    substeps          Runge-Kutta steps of a sample in simulation
    faults            motion, magnitudes and limits of the fault campaign; `study` limits of a study of tolerances
    safe_output       what the machine does after the latch as measured, which datasheet and manifest state
    header_notes      sentences of the C's header (`read_notes`), `datasheet_notes` of the datasheet beside it
    reactions         what the machine does, by the key of a row of the datasheet's failures
    used_instead      what the law uses for a refused input, by the same keys, where the guard cannot know it
    tuning            free parameters of the law and their goals, for `synth tune`
    warning           the first line of header, manifest and report; `most_instructions` of a step on a Cortex-M4F
    """

    controller: Controller
    plant: Plant
    reference: Reference | None = None
    operating_points: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    require: Mapping[str, float] = field(default_factory=dict)
    coordinates: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    loops: Callable[[Any], Sequence[Any]] | None = None
    tolerances: Sequence[str] = ()
    cases: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    experiments: Sequence[Any] = ()
    runs: Callable[[], Sequence[Any]] | None = None
    about: str = ""
    scalar: type[np.floating] = np.float32
    surrogate_error: Mapping[type[np.floating], float] = field(default_factory=dict)
    gain_error: float = 0.01
    stops: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    velocities: Mapping[str, str] = field(default_factory=dict)
    start: Mapping[str, float] = field(default_factory=dict)
    limited: Sequence[str] = ()
    wires: Mapping[str, str | Mapping[str, float]] = field(default_factory=dict)
    stimuli: Callable[[], Any] | None = None
    verify: Callable[["Stage", Callable[[str], None], bool], Any] | None = None
    audit: Callable[["Stage"], Iterator[Any]] | None = None
    contents: Callable[["Stage", Any], Any] | None = None
    gains: Gains | None = None
    companions: Sequence[Companion] = ()
    law_alone: Controller | None = None
    drive: Drive | None = None
    substeps: int = 4
    faults: FaultCampaign = field(default_factory=FaultCampaign)
    study: StudyLimits = field(default_factory=StudyLimits)
    most_instructions: float = np.inf
    safe_output: SafeOutput | None = None
    header_notes: Sequence[str] = ()
    datasheet_notes: Sequence[str] = ()
    reactions: Mapping[str, str] = field(default_factory=dict)
    used_instead: Mapping[str, str] = field(default_factory=dict)
    tuning: Tuning | None = None
    warning: str = ""

    def sheet(self) -> show.Sheet:
        """Return the controller's interface and the names of the experiments."""
        inner = self.controller.sheet()
        lines = (*inner.lines, f"experiments: {', '.join(e.name for e in self.experiments) or 'none'}")
        return show.Sheet(f"Stage {self.name}, ships in {self.scalar.__name__}", lines, inner.tables)

    @property
    def all_experiments(self) -> Sequence[Any]:
        """The experiments and those of `runs`, which are imported for it, and with them the study can be checked.

        Raises DesignError for a pattern of the study that names none of them.
        """
        if self.runs is None:
            return self.experiments
        every = (*self.experiments, *self.runs())
        self.study.require_experiments([e.name for e in every])
        return every

    @property
    def name(self) -> str:
        """The controller's name, which is that of the design's folder and of its C."""
        return self.controller.name

    @property
    def interface(self) -> Interface:
        """The interface of the controller."""
        return self.controller.interface


def read_notes(path: Path, **values: Any) -> list[str]:
    """Return the paragraphs of a file as sentences of header or datasheet, {name} replaced by the value of a name.

    Raises DesignError for a placeholder without a value, and for a value that has no place.
    """
    template = path.read_text(encoding="utf-8")
    places = {name for _, name, _, _ in Formatter().parse(template) if name is not None}
    if places != set(values):
        raise DesignError(
            f"{path.name}: found values of {sorted(values)}, need those of its placeholders, {sorted(places)}"
        )
    return [" ".join(paragraph.split()) for paragraph in template.format(**values).split("\n\n")]
