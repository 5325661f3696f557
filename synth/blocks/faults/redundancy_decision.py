"""Decision thresholds of sensor fault detection (FDIA): the samples, gates and travels of `redundancy`, with names."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import inf, sqrt

from synth import arguments
from synth.analyse.structure.parity import Relation
from synth.block import Constant
from synth.blocks.faults import isolation
from synth.blocks.faults.isolation import FRESH, STILL
from synth.blocks.guard import range_numbers
from synth.errors import SignalError
from synth.signals import Signal

DOUBTS = 10  # changes of a code that agree until its prediction is believed, at first and after missing calls


@arguments.checked
@dataclass(frozen=True)
class Decision:
    """Samples in a row until a sensor is excluded or all are suspects, the gate of frozen sensors, and `tolerated`.

    `gate` is in the unit of each sensor without a group, by name. With `at_rest` a `probe` moves such a sensor at rest,
    and needs so many samples without a change counted; 0 is for no probe. Such a sensor is free to move while its
    reading is inside `travel`; at an end, a stop may hold it. A reading further than `jump` from its prediction has
    jumped (`jump_gate`); without one no jump is looked for. Where the distance from its prediction has grown since
    the last change of the code by more than `wide_frozen` or `wide_jump`, the sensor is frozen or has jumped without an
    earlier agreement; without these it is not.
    """

    gate: Mapping[str, float]
    travel: Mapping[str, tuple[float, float]]
    persistent: int = 3
    undecided: int = 10
    at_rest: int = 0
    tolerated: int = 2
    jump: Mapping[str, float] = field(default_factory=dict)
    wide_jump: Mapping[str, float] = field(default_factory=dict)
    wide_frozen: Mapping[str, float] = field(default_factory=dict)

    def longest(self, single: bool) -> int:
        """Return the largest count of samples without a change, of a sensor of a group or of a `single` one."""
        return max(self.at_rest if single else 0, STILL)

    def require(self, name: str) -> None:
        """Raise SignalError unless a sensor without a relation has a gate, a travel, and no other gate below it."""
        if not self.gate.get(name, 0) > 0 or name not in self.travel:
            raise SignalError(f"sensor '{name}' is in no relation and has no gate or travel: give both")
        if self.jump.get(name, self.gate[name]) < self.gate[name]:
            jump, gate = self.jump[name], self.gate[name]
            raise SignalError(f"a jump of '{name}' is above {jump}, its gate {gate}: give no less")
        least = self.jump.get(name, self.gate[name])
        for of, wide in (("jumps", self.wide_jump), ("frozen codes", self.wide_frozen)):
            if wide.get(name, least) < least:
                raise SignalError(f"the wide gate for {of} of '{name}' is {wide[name]}, its gate {least}: give no less")

    def numbers(self, signals: Mapping[str, Signal], relations: Sequence[Relation]) -> list[Constant]:
        """Return the numbers of the groups that the C names."""
        units = (signals[next(iter(r.weights))].unit for r in relations)
        numbers = [n for i, unit in enumerate(units) for n in isolation.numbers(unit, i, relations[i].threshold)]
        groups = dict.fromkeys(len(r.weights) - 1 for r in relations)
        others = (
            Constant(f"all_but_one_of_{n + 1}", n, "1", "sensors of a group but one", ("moving",)) for n in groups
        )
        return [
            *numbers, *self._counts(),
            *(n for r in relations for name in r.weights for n in range_numbers.ends(signals[name])),
            Constant("undecided_from", self.undecided - 1, "1", "contradictions before all are suspects",
                     ("contradictions",)),
            Constant("most_contradictions", self.undecided, "1", "contradictions that are counted",
                     ("contradictions",)),
            Constant("tolerated_missing", self.tolerated, "1", "readings of a group that may be missing", ("missing",)),
            *others,
        ]  # fmt: skip

    def numbers_of_monitor(self, sensor: Signal) -> list[Constant]:
        """Return the numbers of the monitor of a sensor that the C names."""
        n, unit, at = sensor.name, sensor.unit, "end of the travel, where a stop may hold it"
        far = "from the prediction: no acceleration of the machine explains it"
        numbers = [Constant("gate", self.gate[n], unit, "predicted motion in which a working code changes")]
        numbers += [Constant("jump", self.jump[n], unit, far)] if n in self.jump else []
        grown = "growth of the distance to the prediction that needs no earlier agreement: of a code that"
        numbers += [Constant("wide_jump", self.wide_jump[n], unit, f"{grown} changes")] if n in self.wide_jump else []
        frozen = f"{grown} stands still"
        numbers += [Constant("wide_frozen", self.wide_frozen[n], unit, frozen)] if n in self.wide_frozen else []
        ends = zip(("low", "high"), self.travel[n], strict=True)
        return [
            *numbers, *(Constant(f"travel_{of}", v, unit, at) for of, v in ends), *self._counts(),
            Constant("most_unchanged", self.longest(True), "1", "samples without a change that are counted",
                     ("still", "unchanged")),
            Constant("doubted_changes", DOUBTS, "1", "changes of the code until its prediction is believed",
                     ("doubts",)),
        ]  # fmt: skip

    def _counts(self) -> list[Constant]:
        still, wrong, before = (
            ("still", "unchanged"),
            ("contradictions", "jumps"),
            "contradictions or jumps before the last",
        )
        return [
            Constant(
                "repeated_samples", FRESH, "1", "samples without a change of the code: fewer, and it moves", still
            ),
            Constant("still_samples", STILL, "1", "samples without a change of the code: it stands still", still),
            Constant("excluded_from", self.persistent - 1, "1", before, wrong),
        ]


@arguments.checked
def jump_gate(gate: float, acceleration: float, resolution: float, period: float) -> float:
    """Return the largest innovation of a sound sensor one sample after it was inside its `gate`.

    The acceleration differs from the prediction by at most `acceleration`, e. Such an error needs sqrt(2 gate / e) to
    leave the gate, and the rate is then wrong by sqrt(2 gate e); in the sample that follows it adds T times this and
    e T^2 / 2, and rounding may add a count.

    Raises SignalError for a negative or infinite value.
    """
    values = {"gate": gate, "acceleration": acceleration, "resolution": resolution, "period": period}
    for name, value in values.items():
        if not 0 <= value < inf:
            raise SignalError(f"gate of jumps: the {name} is {value}: give a finite number of at least 0")
    return gate + period * sqrt(2 * gate * acceleration) + acceleration * period**2 / 2 + resolution
