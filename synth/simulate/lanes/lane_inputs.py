"""Controller inputs of loops in lanes: constants, courses that all lanes share, and courses of single lanes.

A sensor writes its input in every sample that is not overridden; the values of an override come as a course.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth.execute import host
from synth.simulate import loop_arrays
from synth.simulate.lanes import lane_memory
from synth.simulate.scenario import Scenario

Arrays = dict[str, NDArray[Any]]


def arrays(controller: host.Controller, scenarios: Sequence[Scenario], n: int) -> Arrays:
    """Return the members of `loop_t` for the inputs over n samples: constants (rows, lanes) and courses.

    Raises SignalError and WiringError as `closed_loop.simulate`.
    """
    rows, scalar = controller.inputs.names or (), controller.scalar
    distinct = {id(scenario): scenario for scenario in scenarios}
    for scenario in distinct.values():
        loop_arrays.require_sources(controller, scenario)
    courses = [_courses(controller, scenarios, name, n) for name in rows]
    constants = lane_memory.zeros((len(rows), len(scenarios)), scalar)
    varying: dict[bool, list[int]] = {True: [], False: []}
    for row, lanes in enumerate(courses):
        if all(len(course) == 1 for course in lanes):
            constants[row] = [course[0] for course in lanes]
        else:
            varying[all(_same_bits(course, lanes[0]) for course in lanes)].append(row)
    common, separate = ([[np.broadcast_to(c, n) for c in courses[row]] for row in varying[k]] for k in (True, False))
    return {
        "in": constants,
        "common_row": np.array(varying[True], dtype=np.int64),
        "separate_row": np.array(varying[False], dtype=np.int64),
        "common": lane_memory.align(np.array([lanes[0] for lanes in common], scalar).reshape(-1, n).T),
        "separate": lane_memory.align(np.array(separate, scalar).reshape(-1, len(scenarios), n).transpose(2, 0, 1)),
    }


def _courses(controller: host.Controller, scenarios: Sequence[Scenario], name: str, n: int) -> list[NDArray[Any]]:
    """Return the samples of an input in each scenario; those of one array, or of one scenario, are one object."""
    keys = [id(s) if name in s.overrides else _key(s.references.get(name)) for s in scenarios]
    by_key = {key: _course(controller, s, name, n) for key, s in dict(zip(keys, scenarios, strict=True)).items()}
    return [by_key[key] for key in keys]


def _key(values: object) -> tuple[type, object]:
    """Return a key that values of the same number and the same array share."""
    return type(values), repr(values) if isinstance(values, float | int) else id(values)


def _course(controller: host.Controller, scenario: Scenario, name: str, n: int) -> NDArray[Any]:
    """Return the samples of an input, (1,) where it is constant."""
    values: ArrayLike = scenario.references.get(name, 0.0)
    override = scenario.overrides.get(name)
    constant = override is None and not np.ndim(values)
    assert controller.inputs.fields is not None
    samples = np.zeros(1 if constant else n, [(name, controller.inputs.fields[name][0])])
    host.fill(samples, name, values)
    if override is not None:
        host.fill(samples, name, override.values, loop_arrays.mask(name, override.mask, n))
    return np.ascontiguousarray(samples[name])


def _same_bits(first: NDArray[Any], second: NDArray[Any]) -> bool:
    return first is second or (first.shape == second.shape and first.tobytes() == second.tobytes())
