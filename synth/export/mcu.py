"""The files of a project for a microcontroller: what its templates show beside what those of Linux do."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from synth.emit.write import EmittedCode
from synth.execute import host, target
from synth.export import templates

PLANT = ("io.h", "io_plant.c", "plant.c", "plant.h")  # of the Linux project: the simulated plant
MEASURED = 100  # samples of the vectors, for the instructions
TURN_S = 0.25  # of a rehearsal, between two steps of its set-points
SHARE = 0.1  # of the largest step of a set-point
HELLO = 16  # bytes of the answer to it before the name, as serial.c sends it


def render(facts: Mapping[str, Any]) -> dict[str, str]:
    """Return the project's own files by path."""
    files = templates.render("microcontroller", facts)
    for folder in ("src", "qemu"):
        files |= {f"{folder}/{n}": t for n, t in templates.render(f"microcontroller/{folder}", facts).items()}
    return files | {f"qemu/{n}": t for n, t in templates.render("linux", facts, PLANT).items()}


def facts(
    shared: Mapping[str, Any], emitted: Mapping[str, EmittedCode], vectors: Mapping[str, host.Records]
) -> dict[str, Any]:
    """Return the facts beside the `shared` ones: vectors as words of C, instructions, set-points of the rehearsal."""
    core = "cortex-m4f" if shared["real"] == "float" else "cortex-m7"
    structs = [rows.dtype[role].itemsize for rows in vectors.values() for role in ("in", "out")]
    return {
        "core": core,
        "vectors": [words(name, rows) for name, rows in vectors.items()],
        "instructions": sum(_instructions(code, vectors[name], core) for name, code in emitted.items()),
        "content": max(8 + max(structs), HELLO + len(shared["name"])),
        "status": f"0x{sum(1 << f['bit'] for f in shared['faults'] if f['status']):08x}",
        "turn": max(1, round(TURN_S / float(shared["period_s"]))),
        "set_points": [{**p, "away": repr(away(p))} for p in shared["set_points"]],
    }


def away(point: Mapping[str, Any]) -> float:
    """Return where the rehearsal moves a set-point to: away from the nearer end of its range."""
    low, high, home, step = (float(point[key]) for key in ("low", "high", "home", "step"))
    return home + SHARE * (step if high - home >= home - low else -step)


def words(name: str, rows: host.Records) -> dict[str, Any]:
    """Return the rows of vectors, each the words of input and output struct and the fault word, as C."""
    n = len(rows)
    parts = [np.frombuffer(rows[role].tobytes(), "<u4").reshape(n, -1) for role in ("in", "out", "faults")]
    table = np.hstack(parts)
    return {"name": name, "words": table.shape[1], "rows": [", ".join(f"0x{w:x}u" for w in row) for row in table]}


def _instructions(code: EmittedCode, rows: host.Records, core: str) -> int:
    """Return the largest number of instructions of a step over the first vectors, on a simulated core."""
    step = target.load(code.files, code.manifest, core)
    names = rows.dtype["in"].names or ()
    measured = step.measure({name: rows["in"][name][:MEASURED] for name in names})
    return int(measured.cost.instructions.max())
