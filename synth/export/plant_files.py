"""The plant of a stage as C, for a rehearsal: its equations by CasADi, and tables of what `synth simulate` adds."""

from collections.abc import Mapping, Sequence
from typing import Any

import casadi as ca

from synth.emit.c import c_text
from synth.simulate.rig import Rig

REST_CHANGE = 1e-3  # of a sensor's range: movement at rest; at least that of its resolution and noise


def model(rig: Rig) -> tuple[dict[str, str], dict[str, int]]:
    """Return `{plant_model.c: text}` of the equations, and the sizes of the work vectors."""
    functions = [_dense(f, name) for f, name in ((rig.plant.f, "plant_f"), (rig.plant.h, "plant_h"))]
    sizes = {
        "arg": max(3, *(f.sz_arg() for f in functions)),
        "res": max(f.sz_res() for f in functions),
        "iw": max(1, *(f.sz_iw() for f in functions)),
        "w": max(1, *(f.sz_w() for f in functions)),
    }
    return c_text.functions(functions, "plant_model"), sizes


def _dense(f: ca.Function, name: str) -> ca.Function:
    arguments = f.sx_in()
    return ca.Function(name, arguments, ca.cse([ca.densify(result) for result in f.call(arguments)]))


def tables(rig: Rig, outputs: Sequence[str], sizes: Mapping[str, int]) -> dict[str, Any]:
    """Return what the templates of plant.h and plant.c show: numbers as C, in the order of the plant's signals."""
    stage, plant = rig.stage, rig.plant
    states, measured = [s.name for s in plant.states], [s.name for s in plant.outputs]
    start = {s.name: stage.start.get(s.name, 0.0) for s in plant.states}
    wires = {name: {w: 1.0} if isinstance(w, str) else dict(w) for name, w in rig.connections.items()}
    safe = {a.name: a.safe for a in stage.interface.actuators if a.name in (rig.controller.outputs.names or ())}
    hold = rig.drive_commands(stage.start, safe) if rig.drive else safe
    stops = [(states.index(q), states.index(stage.velocities[q]), *map(_c, ends)) for q, ends in stage.stops.items()]
    sensors = [
        {"source": measured.index(s.of)}
        | {name: _c(value) for name, value in vars(s).items() if name in ("resolution", "noise", "wraps", "low")}
        for s in stage.interface.sensors
    ]
    return {
        "x0": [_c(start[s]) for s in states],
        "inputs": len(plant.inputs),
        "plant_outputs": len(measured),
        "parameters": [_c(v) for v in plant.values] or ["0.0"],
        "substeps": stage.substeps,
        "stops": stops,
        "velocities": [states.index(v) for v in stage.velocities.values()],
        "hold": [_c(hold.get(name, 0.0)) for name in outputs],
        "mixing": [[_c(wires.get(s.name, {}).get(name, 0.0)) for name in outputs] for s in plant.inputs],
        "sensors": sensors,
        "sizes": sizes,
    }


def largest_change_at_rest(low: float, high: float, resolution: float, noise: float) -> float:
    """Return the largest change of a sensor at rest, in its unit."""
    return max(REST_CHANGE * (high - low), 4 * resolution, 8 * noise)


def _c(value: float) -> str:
    return repr(float(value))
