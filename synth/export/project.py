"""An export as a whole: the files of a project around the unchanged step, by path; `save` alone writes to disk.

controller/   the emitted steps, unchanged        src/       the loop, the same for every stage, and its tables
vectors/      inputs, outputs, fault words        io_user.c, channels.toml    the user's: written once

For a microcontroller the vectors are C below src/, qemu/ has a board to rehearse on, and board_user.c is the user's.
For LinuxCNC the vectors are C below src/, too, and the components of HAL are on top. MARKER says which design and which
target a folder is of.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np

from synth.base import store
from synth.declare.stage import SetPoint, Stage
from synth.emit.write import EmittedCode
from synth.errors import DesignError, SynthError
from synth.execute import host
from synth.export import a2l, limits, linuxcnc, mcu, plant_files, templates, wiring
from synth.simulate import rig as rigs

TARGETS = ("linux", "mcu", "linuxcnc")
TOP = ("Makefile", "CMakeLists.txt", "README.md", "io_user.c", "channels.toml")
USERS = ("io_user.c", "channels.toml", "board_user.c")  # an export never overwrites them
MARKER = "synth-export.txt"
FULL_SCALE = 10.0  # V: of the channels in a new channels.toml, over the range of a signal


@dataclass(frozen=True)
class Project:
    """The files of an export, texts and binary vectors, by path."""

    files: Mapping[str, str | bytes]

    def save(self, folder: Path) -> list[str]:
        """Write the files below `folder`; return the paths of the user's files that are there and stay as they are.

        Raises SynthError for a folder with files that are no export, or one of another design or target.
        """
        self._require_own(folder)
        kept = [name for name in USERS if (folder / name).exists()]
        for name, content in self.files.items():
            path = folder / name
            if name in kept:
                continue
            path.parent.mkdir(parents=True, exist_ok=True)
            store.replace_bytes(path, content.encode("utf-8") if isinstance(content, str) else content)
        return kept

    def _require_own(self, folder: Path) -> None:
        marker, needed = folder / MARKER, str(self.files[MARKER])
        if marker.exists():
            before = marker.read_text(encoding="utf-8", errors="replace")
            if before != needed:
                raise SynthError(
                    f"{marker}: found an export of '{before.strip()}', need '{needed.strip()}': give another --out"
                )
        elif folder.is_dir() and (names := sorted(path.name for path in folder.iterdir())):
            raise SynthError(
                f"{folder}: found '{names[0]}' and no {MARKER}, need a new or empty folder, or an earlier export: give "
                "another --out"
            )


def project(stage: Stage, emitted: Mapping[str, EmittedCode], target: str) -> Project:
    """Return the project of a stage for a target, from the emitted code of its folders.

    Raises DesignError for another target and for a step that is not among the emitted code, WiringError for an input of
    the drive that nothing gives.
    """
    require_target(target)
    manifests = {folder: code.manifest for folder, code in emitted.items()}
    recorded = replay_vectors(stage, emitted)
    code: dict[str, str | bytes] = {MARKER: f"{stage.name} for {target}\n"}  # first: an interrupted export is one, too
    for name in recorded:
        code |= {f"controller/{file}": text for file, text in host.code(emitted[name].files).items()}
    rig = rigs.of_stage(stage, host.load(emitted[stage.name].files, emitted[stage.name].manifest))
    facts, model = _facts(stage, manifests, rig)
    if target == "mcu":
        facts |= mcu.facts(facts, {name: emitted[name] for name in recorded}, recorded)
        described = {f"{stage.name}.a2l": a2l.text(stage.name, facts["blocks"], manifests)} if facts["tuning"] else {}
        return Project({**code, **described, **{f"qemu/{n}": t for n, t in model.items()}, **mcu.render(facts)})
    sources = {f"src/{n}": t for n, t in model.items()}
    if target == "linuxcnc":
        return Project({**code, **sources, **linuxcnc.render(facts | linuxcnc.facts(stage, facts, emitted, recorded))})
    binary = {f"vectors/{name}.bin": rows.tobytes() for name, rows in recorded.items()}
    return Project({**code, **binary, **sources, **_render(facts)})


def require_target(target: str) -> None:
    """Raise DesignError for a target that there is no project for."""
    if target not in TARGETS:
        raise DesignError(f"the target of the export is '{target}': choose one of {', '.join(TARGETS)}")


def _render(facts: Mapping[str, Any]) -> dict[str, str]:
    """Return the project's own files: templates filled in, and those that are the same for every stage."""
    files = templates.render("linux", facts)
    if facts["tuning"]:
        files |= templates.render("linux/tuning", facts)
    return {name if name in TOP else f"src/{name}": text for name, text in files.items()}


def replay_vectors(stage: Stage, emitted: Mapping[str, EmittedCode]) -> dict[str, host.Records]:
    """Return the vectors of the controller and of each Block of its drive, in the order of a sample.

    Raises DesignError for a Block that is not among the emitted code.
    """
    needed = [stage.name, *(block.name for block in (stage.drive.blocks if stage.drive else ()))]
    if missing := [name for name in needed if name not in emitted]:
        raise DesignError(
            f"design '{stage.name}': its drive '{missing[0]}' is not among what it emits ({', '.join(emitted)}): "
            "declare it as a Companion, too"
        )
    return {name: _vectors(emitted[name]) for name in needed}


def _vectors(code: EmittedCode) -> host.Records:
    """Return the test vectors of a step, (N,) records of input struct `in`, output struct `out`, `faults`.

    Decimal numbers of the document read back as the bits of its scalar type.
    """
    inputs, outputs = (host.dtype(role, code.manifest) for role in ("input", "output"))
    document = json.loads(code.files["vectors.json"])
    n = len(document["faults"])
    before, word = inputs.itemsize + outputs.itemsize, np.dtype(code.manifest["scalar"]).itemsize
    layout = {
        "names": ["in", "out", "faults"],
        "formats": [inputs, outputs, np.uint32],
        "offsets": [0, inputs.itemsize, before],
        "itemsize": -(-(before + 4) // word) * word,  # C fills a struct up to a multiple of its scalar
    }
    rows: Any = np.zeros(n, np.dtype(layout))  # type: ignore[call-overload]
    rows["in"] = host.records(code.manifest, inputs, document["inputs"], n)
    for name, column in document["outputs"].items():
        rows["out"][name] = column
    rows["faults"] = document["faults"]
    return cast(host.Records, rows)


def _facts(
    stage: Stage, manifests: Mapping[str, Mapping[str, Any]], rig: rigs.Rig
) -> tuple[dict[str, Any], dict[str, str]]:
    """Return what the templates show, and the C of the plant."""
    manifest, interface = manifests[stage.name], stage.interface
    period_s, real = manifest["period_s"], "float" if manifest["scalar"] == "float32" else "double"
    read = {f["name"]: f for f in wiring.members(manifest, "input")}
    outputs = wiring.outputs(stage, manifests)
    home = rig.at_rest()
    least = limits.of_stage(stage, rig.positions, home)
    sensors = [
        _signal(read[s.name])
        | {
            "rest": repr(
                plant_files.largest_change_at_rest(read[s.name]["low"], read[s.name]["high"], s.resolution, s.noise)
            )
        }
        for s in interface.sensors
    ]
    names = [s.name for s in interface.sensors]
    set_points = [
        _signal(read[p.name])
        | {"home": repr(home[p.name]), "pose": wiring.pose(stage, p.of, names) if isinstance(p, SetPoint) else ""}
        | {key: repr(value) for key, value in least[p.name]._asdict().items()}
        for p in interface.references  # a client moves them all alike
    ]
    safety = manifest["safety"] or {"safe_output": {}, "slew_per_s": {}}
    safe = [
        {"name": n, "value": repr(float(v)), "step": repr(safety["slew_per_s"][n] * period_s)}
        for n, v in safety["safe_output"].items()
    ]
    blocks = wiring.steps(stage, manifests)
    model, sizes = plant_files.model(rig)
    facts = {
        "name": stage.name,
        "period_s": repr(period_s),
        "period_ns": round(1e9 * period_s),
        "delay": interface.delay,
        "real": real,
        "digits": 9 if real == "float" else 17,
        "missed_calls": interface.missed_calls.name if interface.missed_calls else "",
        "blocks": blocks,
        "controller": blocks[0],
        "tuning": _tuning(manifest),
        "set_points": set_points,
        "outputs": [_signal(f) | {"source": f["source"]} for f in outputs],
        "faults": [_fault(f) for f in manifest["faults"]],
        "safe": safe,
        "safe_is_off": int(not any(safety["safe_output"].values())),
        "rests_off": int("landed_output" in safety and not any(safety["landed_output"].values())),
        "rehearsal": _rehearsal(interface.set_points, home, least),
    }
    tables = plant_files.tables(rig, [f["name"] for f in outputs], sizes)
    facts["sensors"] = [a | b for a, b in zip(sensors, tables.pop("sensors"), strict=True)]
    return facts | tables, model


def _rehearsal(points: Sequence[SetPoint], home: Mapping[str, float], least: Mapping[str, limits.Limits]) -> str:
    """Return the option of a slow sine of the first set-point, within a tenth of its room and of what it can follow."""
    if not points:
        return ""
    p, rate = points[0], 2 * np.pi
    room = min(p.high - home[p.name], home[p.name] - p.low)
    most = min(room, least[p.name].speed / rate, least[p.name].acceleration / rate**2)
    return f"--motion 'sine {p.name} {most / 10:.2g} 1 2' "


def _signal(field: Mapping[str, Any]) -> dict[str, Any]:
    """Return a signal as the templates show it, with the scale of a channel that spans its range."""
    low, high = float(field["low"]), float(field["high"])
    scale = {"scale": f"{(high - low) / 2 / FULL_SCALE:.9g}", "middle": f"{(high + low) / 2:.9g}"}
    return {"name": field["name"], "unit": field["unit"], "low": repr(low), "high": repr(high), **scale}


def _tuning(manifest: Mapping[str, Any]) -> dict[str, Any]:
    """Return what is tuned on the running machine, nothing for a controller without such constants."""
    if "tuning" not in manifest:
        return {}
    parameters = manifest["structs"]["parameters"]["type"]
    return {
        "type": parameters,
        "default": parameters.removesuffix("_t") + "_default",
        "names": list(manifest["tuning"]["default"]),
        **manifest["tuning"]["functions"],
        "calls": manifest["tuning"]["calls"],
        "refused": manifest["tuning"]["refused"],
        "parse": "strtof" if manifest["scalar"] == "float32" else "strtod",
    }


def _fault(fault: Mapping[str, Any]) -> dict[str, Any]:
    text = "latched" if fault.get("latched") else fault.get("input") or fault.get("about", "")
    text = f"{fault['suspect']} suspect" if "suspect" in fault else text
    return {"bit": fault["bit"], "status": int(fault.get("status", False)), "text": text.replace('"', "'")}
