"""ASAP2 description (A2L) of a loop on a microcontroller, for a calibration tool: what it measures and what it tunes.

Source: ASAM MCD-2 MC (ASAP2) 1.6. Addresses are 0 and each object has the name of its symbol, SYMBOL_LINK: a tool such
as `a2ltool loop.a2l --elffile loop.elf --update` fills them in from the debug information of the user's image.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from synth.export import wiring

TYPES = {"float": "FLOAT32_IEEE", "double": "FLOAT64_IEEE", "uint32_t": "ULONG"}
LOOP = "loop"  # the name of the loop_t of example.c
WORD = {"ctype": "uint32_t", "count": 1, "unit": "1", "low": 0.0, "high": 4294967295.0}


@dataclass(frozen=True)
class Symbol:
    """A number in the memory of the loop: the path of its member, and the field of the manifest that says the rest."""

    path: str
    field: Mapping[str, Any]


def text(name: str, steps: Sequence[wiring.Step], manifests: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the A2L of the loop of a stage whose controller is tuned on the machine.

    The tool changes `loop.parameters`, and sets `loop.commit` to 1 when it has finished.
    """
    tuned = manifests[name]["tuning"]["default"]
    parameters = [f for f in manifests[name]["structs"]["parameters"]["fields"] if f["name"] in tuned]
    measured = [
        Symbol(f"{step.short}{suffix}.{f.get('path', f['name'])}", f)
        for step in steps
        for role, suffix in (("input", "_in"), ("output", "_out"), ("state", ""))
        for f in manifests[step.name]["structs"][role]["fields"]
    ]
    words = ("faults", "drive_faults", "samples", "missed", "left", "refused", "taken.check")
    measured += [Symbol(n, WORD) for n in words]
    tunable = [*(Symbol(f"parameters.{f['name']}", f) for f in parameters), Symbol("commit", {**WORD, "high": 1.0})]
    units = sorted({s.field["unit"] for s in (*measured, *tunable)})
    types = sorted({s.field["ctype"] for s in tunable})
    blocks = [
        *(_unit(units, unit) for unit in units),
        *(_block("RECORD_LAYOUT", [f"value_{t}", f"FNC_VALUES 1 {TYPES[t]} COLUMN_DIR DIRECT"]) for t in types),
        *(_characteristic(s, units) for s in tunable),
        *(_measurement(s, units) for s in measured),
    ]
    module = ['MOD_COMMON ""', "  BYTE_ORDER MSB_LAST"]
    lines = [f"/begin {module[0]}", *module[1:], "/end MOD_COMMON", *(line for block in blocks for line in block)]
    body = [f'  /begin MODULE {name} ""', *(f"    {line}" for line in lines), "  /end MODULE"]
    return "\n".join(["ASAP2_VERSION 1 60", f'/begin PROJECT {name} ""', *body, "/end PROJECT", ""])


def _block(keyword: str, lines: Sequence[str]) -> list[str]:
    return [f"/begin {keyword} {lines[0]}", *(f"  {line}" for line in lines[1:]), f"/end {keyword}"]


def _unit(units: Sequence[str], unit: str) -> list[str]:
    return _block("COMPU_METHOD", [f'{_method(units, unit)} ""', f'IDENTICAL "%16.9" "{unit}"'])


def _method(units: Sequence[str], unit: str) -> str:
    return f"unit_{units.index(unit)}"


def _characteristic(symbol: Symbol, units: Sequence[str]) -> list[str]:
    f = symbol.field
    value = f"VALUE 0x0 value_{f['ctype']} 0 {_method(units, f['unit'])} {f['low']!r} {f['high']!r}"
    return _block("CHARACTERISTIC", [f'{symbol.path} ""', value, _link(symbol)])


def _measurement(symbol: Symbol, units: Sequence[str]) -> list[str]:
    f = symbol.field
    value = f"{TYPES[f['ctype']]} {_method(units, f['unit'])} 0 0 {f['low']!r} {f['high']!r}"
    size = [f"MATRIX_DIM {f['count']} 1 1"] if f["count"] > 1 else []
    return _block("MEASUREMENT", [f'{symbol.path} ""', value, "ECU_ADDRESS 0x0", *size, _link(symbol)])


def _link(symbol: Symbol) -> str:
    return f'SYMBOL_LINK "{LOOP}.{symbol.path}" 0'
