"""How the emitted steps of a stage follow one another in a sample: what each member of their structs comes from."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from synth.declare.stage import Stage
from synth.errors import WiringError

CONTROLLER = "controller"
TOLERANCE = 1e-9  # of weights of sensors


@dataclass(frozen=True)
class Wire:
    """A member of the input struct of a step, and the member of another struct that gives it."""

    to: str
    source: str


@dataclass(frozen=True)
class Step:
    """An emitted step: its name, the name of its structs in the project, and its wires."""

    name: str
    short: str
    wires: tuple[Wire, ...] = ()


def members(manifest: Mapping[str, Any], role: str) -> list[Mapping[str, Any]]:
    """Return the members of the input or output struct of a step."""
    return list(manifest["structs"][role]["fields"])


def steps(stage: Stage, manifests: Mapping[str, Mapping[str, Any]]) -> list[Step]:
    """Return the controller and the Blocks of its drive, in the order of a sample.

    Each input of a Block is, by name, an output of an earlier one or of the controller, or else an input of it. Raises
    WiringError for an input that nothing gives.
    """
    known = {f["name"]: f"{CONTROLLER}_in.{f['name']}" for f in members(manifests[stage.name], "input")}
    known |= {f["name"]: f"{CONTROLLER}_out.{f['name']}" for f in members(manifests[stage.name], "output")}
    ordered = [Step(stage.name, CONTROLLER)]
    for k, block in enumerate(stage.drive.blocks if stage.drive else (), 1):
        read = [f["name"] for f in members(manifests[block.name], "input")]
        if missing := [name for name in read if name not in known]:
            raise WiringError(
                f"drive '{block.name}': nothing gives its input '{missing[0]}': call it like one of {', '.join(known)}"
            )
        ordered.append(Step(block.name, f"drive{k}", tuple(Wire(name, known[name]) for name in read)))
        known |= {f["name"]: f"drive{k}_out.{f['name']}" for f in members(manifests[block.name], "output")}
    return ordered


def outputs(stage: Stage, manifests: Mapping[str, Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Return what the hardware takes: the outputs of the last Block of the drive, or else the actuators.

    A stage without actuators, such as an estimator, gives all its outputs.
    """
    last = steps(stage, manifests)[-1]
    fields = members(manifests[last.name], "output")
    driven = {a.name for a in stage.interface.actuators}
    taken = [f for f in fields if last.short != CONTROLLER or f["name"] in driven] or fields
    return [{**f, "source": f"{last.short}_out.{f['name']}"} for f in taken]


def pose(stage: Stage, of: str, sensors: Sequence[str]) -> str:
    """Return the C expression of a coordinate at rest, "" where no sensor and no sum of sensors shows it.

    A sum is a declared one, or follows from the sensors that are linear in the states: y = J x + c, q = w (y - c) with
    w J = e_q.
    """
    read = {s.of: s.name for s in stage.interface.sensors} | {s.name: s.name for s in stage.interface.sensors}
    weights, offset = ({read[of]: 1.0}, 0.0) if of in read else (dict(stage.coordinates.get(of, {})), 0.0)
    if not weights:
        weights, offset = _linear_sum(stage, of)
    terms = [f"({w!r} * sensors[{sensors.index(name)}])" for name, w in weights.items()]
    return " + ".join([*terms, *([repr(offset)] if offset else [])])


def _linear_sum(stage: Stage, state: str) -> tuple[dict[str, float], float]:
    plant, names = stage.plant, [s.name for s in stage.plant.states]
    outputs = [s.name for s in plant.outputs]
    x = ca.SX.sym("x", len(names))
    h = plant.h(x, ca.SX.zeros(len(plant.inputs)), plant.values)
    rows = {s.name: ca.jacobian(h[outputs.index(s.of)], x) for s in stage.interface.sensors}
    linear = [name for name, row in rows.items() if row.is_constant()]
    if state not in names or not linear:
        return {}, 0.0
    J = np.array([np.asarray(ca.DM(rows[name])).ravel() for name in linear])
    unit = np.eye(len(names))[names.index(state)]
    w = np.linalg.lstsq(J.T, unit, rcond=None)[0]
    if np.abs(J.T @ w - unit).max() > TOLERANCE:
        return {}, 0.0
    at_zero = plant.output_values({})
    offset = -sum(
        k * float(at_zero[s.of][0])
        for s in stage.interface.sensors
        for n, k in zip(linear, w, strict=True)
        if n == s.name
    )
    return {name: float(k) for name, k in zip(linear, w, strict=True) if abs(k) > TOLERANCE}, float(offset)
