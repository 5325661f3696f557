"""The files of a project for LinuxCNC: components of HAL around the emitted steps, the plant and the vectors."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from synth.declare.stage import Stage
from synth.emit.write import EmittedCode
from synth.errors import DesignError
from synth.execute import host
from synth.export import mcu, templates, wiring

SHARED = (  # of the Linux project: the wiring of the stage, whether it rests, its simulated plant
    "stage.c", "stage.h", "rest.c", "rest.h", "io.h", "io_plant.c", "plant.c", "plant.h",
)  # fmt: skip
LONGEST = 47  # characters of a name in HAL
NAMES = (  # of the components' own pins, and what HAL makes of their functions
    "enable", "running", "amplifiers", "wrong_period", "limits", "fault_word", "drive_fault_word", "rest_time",
    "replay", "samples", "differing", "first", "feed.time", "compare.time", "write_outputs.time", "read_sensors.time",
)  # fmt: skip


def render(facts: Mapping[str, Any]) -> dict[str, str]:
    """Return the project's own files by path."""
    name = facts["name"]
    named = {"component.comp": f"{name}.comp", "stage.hal": f"{name}.hal"}
    named |= {"follow.h": "src/follow.h"} | {f"{kind}.comp": f"{name}_{kind}.comp" for kind in ("plant", "replay")}
    files = {named.get(file, file): text for file, text in templates.render("linuxcnc", facts).items()}
    sources = templates.render("linux", facts, SHARED)
    sources |= templates.render("microcontroller/src", facts, ("vectors.c", "vectors.h"))
    return files | {f"src/{file}": text for file, text in sources.items()}


def facts(
    stage: Stage, shared: Mapping[str, Any], emitted: Mapping[str, EmittedCode], vectors: Mapping[str, host.Records]
) -> dict[str, Any]:
    """Return the facts beside the `shared` ones: pins, vectors of a whole sample as words of C, moves of the rehearsal.

    Raises DesignError for a delay of more than one sample, which the order of functions in a thread cannot give, and
    for names that HAL does not take.
    """
    if shared["delay"] > 1:
        raise DesignError(
            f"design '{stage.name}': found a delay of {shared['delay']} samples, HAL gives 0 or 1 by the order of "
            "functions: declare such a delay, or export to linux"
        )
    rows = _whole_samples(stage, emitted, vectors)
    kinds = {s["name"]: "sensor" for s in shared["sensors"]} | {s["name"]: "set-point" for s in shared["set_points"]}
    in_pins = [
        _pin(f, kinds.get(f["name"], "calls that were missed")) | {"is_sensor": kinds.get(f["name"]) == "sensor"}
        for f in _members(emitted, stage.name, "input")
    ]
    out_pins = [
        _pin(field, "output") | {"source": f"{step.short}_out.{field['name']}", "block": step.name}
        for step in shared["blocks"]
        for field in _members(emitted, step.name, "output")
    ]
    faults = [f | {"pin": _fault_pin(f)} for f in shared["faults"]]
    used = [f"{p['name']}_used" for p in shared["set_points"]]
    require_names(stage.name, [*NAMES, *(p["name"] for p in in_pins + out_pins), *used, *(f["pin"] for f in faults)])
    roles = ("sensors", "set_points", "outputs")
    return {
        "component": hal_name(stage.name),
        "in_pins": in_pins,
        "out_pins": out_pins,
        "faults": faults,
        "vectors": [mcu.words(name, of_step) for name, of_step in rows.items()],
        "replay_s": f"{len(rows[stage.name]) * float(shared['period_s']) + 1:.1f}",
        "moves": [f"sets {hal_name(p['name'])} {mcu.away(p)!r}" for p in shared["set_points"]],
        **{role: [s | {"hal": hal_name(s["name"])} for s in shared[role]] for role in roles},
    }


def require_names(design: str, names: Sequence[str]) -> None:
    """Raise DesignError where two of the `names` of a component's pins are one in HAL, or where one is too long."""
    counts = Counter(map(hal_name, names))
    if twice := [name for name, count in counts.items() if count > 1]:
        raise DesignError(f"design '{design}': found two pins '{twice[0]}', need different names: rename that signal")
    longest = f"{hal_name(design)}-replay.{max(counts, key=len)}"
    if len(longest) > LONGEST:
        raise DesignError(
            f"design '{design}': found names of up to {len(longest)} characters, such as '{longest}', HAL takes "
            f"{LONGEST}: shorten the name of the design or of the signal"
        )


def _whole_samples(
    stage: Stage, emitted: Mapping[str, EmittedCode], vectors: Mapping[str, host.Records]
) -> dict[str, host.Records]:
    """Return the vectors of the controller, and of what follows it in the same samples: the host computes that."""
    rows = {stage.name: vectors[stage.name]}
    first, *following = wiring.steps(stage, {name: code.manifest for name, code in emitted.items()})
    structs = {f"{first.short}_{role}": rows[stage.name][role] for role in ("in", "out")}
    for step in following:
        code, sources = emitted[step.name], [wire.source.split(".") for wire in step.wires]
        of_step = np.zeros(len(rows[stage.name]), vectors[step.name].dtype)
        for wire, (struct, member) in zip(step.wires, sources, strict=True):
            of_step["in"][wire.to] = structs[struct][member]
        run = host.load(code.files, code.manifest).replay({w.to: of_step["in"][w.to] for w in step.wires})
        for name, column in run.outputs.items():
            of_step["out"][name] = column
        of_step["faults"] = run.faults
        structs[f"{step.short}_out"] = of_step["out"]
        rows[step.name] = of_step
    return rows


def _members(emitted: Mapping[str, EmittedCode], step: str, role: str) -> list[Mapping[str, Any]]:
    return wiring.members(emitted[step].manifest, role)


def _pin(field: Mapping[str, Any], kind: str) -> dict[str, Any]:
    text = f"{field['unit']}, {field['low']:.7g} to {field['high']:.7g}: {kind}"
    return {"name": field["name"], "hal": hal_name(field["name"]), "text": text}


def _fault_pin(fault: Mapping[str, Any]) -> str:
    """Return the name of a fault's pin: `latched`, `fault_z` or `fault_z_suspect`, and its bit where it has a text."""
    words: Sequence[str] = fault["text"].split()
    if fault["text"] == "latched":
        return "latched"
    return f"fault_{'_'.join(words)}" if 0 < len(words) <= 2 else f"fault_bit{fault['bit']}"


def hal_name(name: str) -> str:
    """Return what halcompile makes of a name of C."""
    return name.replace("_", "-").rstrip("-")
