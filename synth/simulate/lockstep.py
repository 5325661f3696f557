"""Functions that simulate closed loops, run side by side so that their loops run together in lanes.

Each function runs in a thread of its own and calls `simulate` like `closed_loop.simulate`. A call waits until every
other function has called too, or has ended; then the loops of one controller that differ only in their plants, initial
states, references and sensor errors run in lanes, and every call returns.
"""

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Generic, TypeVar

import casadi as ca

from synth.errors import SynthError
from synth.execute import host
from synth.plant import Plant
from synth.simulate import closed_loop, lanes
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
    trajectory: Trajectory | None = None
    error: Exception | None = None

    @property
    def is_answered(self) -> bool:
        return self.trajectory is not None or self.error is not None


class _Meeting:
    """The calls that wait for each other; `present` counts the functions that have not ended."""

    def __init__(self, present: int, nominal: Plant, substeps: int) -> None:
        self.present, self.nominal, self.substeps = present, nominal, substeps
        self.calls: list[_Call] = []
        self.changed = threading.Condition()

    def simulate(
        self, plant: Plant, controller: host.Controller, scenario: Scenario, disturbance: ca.Function | None = None
    ) -> Trajectory:
        call = _Call(plant, controller, scenario, disturbance)
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
            _serve(calls, self.nominal, self.substeps)
            self.changed.notify_all()


def run(functions: Sequence[Callable[[Simulate], T]], nominal: Plant, substeps: int) -> list[Result[T]]:
    """Run the functions, each with a `simulate`, and return their results in order.

    Loops of plants that differ from the `nominal` one in their parameters run in lanes, with `substeps` in a period.
    Other loops run alone, with the substeps of their scenario.
    """
    meeting = _Meeting(len(functions), nominal, substeps)
    results: list[Result[T]] = [Result() for _ in functions]

    def work(k: int) -> None:
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


def _serve(calls: Sequence[_Call], nominal: Plant, substeps: int) -> None:
    """Simulate the scenario of every call, in lanes where that is possible."""
    groups: dict[tuple[object, ...], list[_Call]] = {}
    for call in calls:
        if call.plant.f is nominal.f and call.disturbance is None:
            groups.setdefault((id(call.controller), call.scenario.duration_s), []).append(call)
    for group in groups.values():
        try:
            _serve_in_lanes(group, nominal, substeps)
        except SynthError:
            pass  # a scenario that only `closed_loop` simulates, or an error, which it raises for the call alone
        except Exception as error:
            for call in group:
                call.error = error
    for call in calls:
        if not call.is_answered:
            _serve_alone(call)


def _serve_in_lanes(group: Sequence[_Call], nominal: Plant, substeps: int) -> None:
    loop = lanes.compile_loop(nominal, group[0].controller, lanes=1 if len(group) == 1 else lanes.LANES)
    scenarios = [replace(call.scenario, substeps=substeps) for call in group]
    for call, trajectory in zip(group, loop.simulate([call.plant for call in group], scenarios), strict=True):
        call.trajectory = trajectory


def _serve_alone(call: _Call) -> None:
    try:
        call.trajectory = closed_loop.simulate(call.plant, call.controller, call.scenario, call.disturbance)
    except Exception as error:
        call.error = error
