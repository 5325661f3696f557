"""Functions that simulate closed loops, run side by side so that their loops run together in lanes.

Each function runs in a thread of its own, one at a time, and calls `simulate` like `closed_loop.simulate`. A call waits
until every other function has called too, or has ended; then the loops of one controller that differ only in their
plants, initial states, references and sensor errors run in lanes, and every call returns.
"""

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Generic, TypeVar

import casadi as ca

from synth.errors import SynthError
from synth.execute import host
from synth.plant import Plant
from synth.simulate import closed_loop
from synth.simulate.integration import Integration
from synth.simulate.lanes import lanes
from synth.simulate.lanes.lane_blocks import Name, Recording
from synth.simulate.rig import Simulate
from synth.simulate.scenario import Scenario, Trajectory

T = TypeVar("T")


@dataclass(frozen=True)
class Result(Generic[T]):
    """The value that a function returned, or the error that it raised."""

    value: T | None = None
    error: Exception | None = None


@dataclass(eq=False)
class _Call:
    """A call that waits: its arguments, and its trajectory or its error once it has been served."""

    plant: Plant
    controller: host.Controller
    scenario: Scenario
    disturbance: ca.Function | None
    drive: tuple[host.Controller, ...]
    trajectory: Trajectory | None = None
    error: Exception | None = None

    @property
    def is_answered(self) -> bool:
        return self.trajectory is not None or self.error is not None


class _Meeting:
    """The calls that wait for each other; `present` counts the functions that have not ended."""

    def __init__(
        self, present: int, nominals: Sequence[Plant], integration: Integration, reads: list[set[Name]]
    ) -> None:
        self.present, self.nominals, self.integration, self.reads = present, nominals, integration, reads
        self.calls: list[_Call] = []
        self.number = 0
        self.changed = threading.Condition()

    def simulate(
        self,
        plant: Plant,
        controller: host.Controller,
        scenario: Scenario,
        disturbance: ca.Function | None = None,
        *,
        drive: tuple[host.Controller, ...] = (),
    ) -> Trajectory:
        call = _Call(plant, controller, scenario, disturbance, drive)
        with self.changed:
            self.calls.append(call)
            self._serve_if_complete()
            while not call.is_answered:
                self.changed.wait()
        if call.error is not None:
            raise call.error
        assert call.trajectory is not None
        return call.trajectory

    def leave(self) -> None:
        with self.changed:
            self.present -= 1
            self._serve_if_complete()

    def _serve_if_complete(self) -> None:
        if self.calls and len(self.calls) == self.present:
            calls, self.calls = self.calls, []
            try:
                _serve(calls, self.nominals, self.integration, self._recording())
            except Exception as error:
                for call in calls:
                    call.error = error
            self.changed.notify_all()

    def _recording(self) -> Recording:
        """Return what the loops of this meeting record: what was read of it before, or else all."""
        self.number += 1
        if self.number > len(self.reads):
            self.reads.append(set())
            return Recording(read=self.reads[-1])
        read = self.reads[self.number - 1]
        return Recording(frozenset(read), read=read)


def run(
    functions: Sequence[Callable[[Simulate], T]],
    nominals: Sequence[Plant],
    integration: Integration,
    reads: list[set[Name]] | None = None,
) -> list[Result[T]]:
    """Run the functions, each with a `simulate`, and return their results in order.

    Loops of plants that differ from one of the `nominals` in their parameters run in lanes, with the steps of the
    `integration`. Other loops run alone, with the substeps of their scenario. `reads` has the columns that the
    functions read of each of their runs, one after another; the next functions of the same kind record only these.
    """
    meeting = _Meeting(len(functions), nominals, integration, [] if reads is None else reads)
    results: list[Result[T]] = [Result() for _ in functions]

    def work(k: int) -> None:
        with meeting.changed:  # one function at a time: what one prepares and keeps, the others find
            try:
                results[k] = Result(functions[k](meeting.simulate))
            except Exception as error:
                results[k] = Result(error=error)
            finally:
                meeting.leave()

    threads = [threading.Thread(target=work, args=(k,), daemon=True) for k in range(len(functions))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return results


def _serve(calls: Sequence[_Call], nominals: Sequence[Plant], integration: Integration, recording: Recording) -> None:
    """Simulate the scenario of every call, in lanes where that is possible."""
    groups: dict[tuple[Plant, host.Controller, tuple[host.Controller, ...], float], list[_Call]] = {}
    for call in calls:
        kind = next((n for n in nominals if n.f is call.plant.f), None)
        if kind is not None and call.disturbance is None:
            groups.setdefault((kind, call.controller, call.drive, call.scenario.duration_s), []).append(call)
    for (nominal, *_), group in groups.items():
        try:
            _serve_in_lanes(group, nominal, integration, recording)
        except SynthError:
            pass  # a scenario that only `closed_loop` simulates, or an error, which it raises for the call alone
        except Exception as error:
            for call in group:
                call.error = error
    for call in calls:
        if not call.is_answered:
            _serve_alone(call)


def _serve_in_lanes(group: Sequence[_Call], nominal: Plant, integration: Integration, recording: Recording) -> None:
    number = 1 if len(group) == 1 else lanes.LANES
    loop = lanes.compile_loop(nominal, group[0].controller, group[0].drive, lanes=number)
    # The same order in every experiment of the same machines: their polynomials are those of the one before.
    calls = sorted(group, key=lambda call: id(call.plant))
    plants, scenarios = (
        [call.plant for call in calls],
        [replace(c.scenario, substeps=integration.substeps) for c in calls],
    )
    for call, trajectory in zip(calls, loop.simulate(plants, scenarios, integration.order, recording), strict=True):
        call.trajectory = trajectory


def _serve_alone(call: _Call) -> None:
    try:
        call.trajectory = closed_loop.simulate(
            call.plant, call.controller, call.scenario, call.disturbance, drive=call.drive
        )
    except Exception as error:
        call.error = error
