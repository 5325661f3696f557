"""Drive: compiled Blocks between a controller and the plant, such as the commutation of a motor.

    sensors, set-points --> controller --> drive 1 --> ... --> drive n --> delay, hold --> plant
            '-------------------^-----------^--------------------^

All Blocks run in one sample, one after another, before the delay. Each input of a Block of the drive is, by its name,
an output of the Block before it or of an earlier one, or else an input of the controller. The outputs of the last Block
are the commands.
"""

import ctypes
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from synth.errors import WiringError
from synth.execute import host
from synth.signals import dimension

Records = NDArray[np.void]

_COUNTS = ("members", "in_size", "out_size")
_MEMBERS = (
    *("members", "source", "stride", "offset", "size"),
    *("step", "state", "in_size", "out_size", "in", "out", "faults"),
)


class DriveBlock(ctypes.Structure):
    """`drive_block_t` of closed_loop.c, with the same members in the same order."""

    _fields_ = [(m, ctypes.c_int64 if m in _COUNTS else ctypes.c_void_p) for m in _MEMBERS]


class Source(NamedTuple):
    """Records of a Block, inputs or outputs, and the fields of its manifest that describe them."""

    records: Records
    fields: Sequence[Any]


class DriveRecords(NamedTuple):
    """The arrays of one Block of the drive over N samples; `connections` are members of `drive_block_t`."""

    name: str
    inputs: Records
    outputs: Records
    faults: NDArray[np.uint32]
    state: Records
    connections: dict[str, NDArray[np.int64]]
    controller: host.Controller

    @property
    def struct(self) -> DriveBlock:
        """The `drive_block_t` of these arrays."""
        arrays = {"state": self.state, "in": self.inputs, "out": self.outputs, "faults": self.faults}
        addresses = {name: a.ctypes.data for name, a in (arrays | self.connections).items()}
        sizes = {"in_size": self.inputs.itemsize, "out_size": self.outputs.itemsize}
        members, step = len(self.connections["size"]), self.controller.step_address
        return DriveBlock(**addresses, **sizes, members=members, step=step)


def connect(
    controller: host.Controller, inputs: Records, outputs: Records, drive: Sequence[host.Controller]
) -> list[DriveRecords]:
    """Return the arrays of the Blocks of a drive behind a controller with these inputs and outputs (N,).

    Raises WiringError for an input that nothing gives, or of another unit, type or scalar type than what gives it.
    """
    sources = [_source(controller, "output", outputs), _source(controller, "input", inputs)]
    connected: list[DriveRecords] = []
    for block in drive:
        read, computed = np.zeros(len(inputs), block.inputs), np.zeros(len(inputs), block.outputs)
        connections = _connect(block, read.dtype, sources)
        name, faults = block.manifest["design"], np.zeros(len(inputs), np.uint32)
        connected.append(DriveRecords(name, read, computed, faults, block.init(), connections, block))
        sources.insert(0, _source(block, "output", computed))
    return connected


def _source(block: host.Controller, role: str, records: Records) -> Source:
    return Source(records, block.manifest["structs"][role]["fields"])


def _connect(
    block: host.Controller, struct: np.dtype[np.void], sources: Sequence[Source]
) -> dict[str, NDArray[np.int64]]:
    """Return for each input of a Block: the address of its source in sample 0, stride, offset and size in bytes."""
    rows = []
    for field in block.manifest["structs"]["input"]["fields"]:
        source, member = _find(block.manifest["design"], field, sources)
        records, size = source.records, struct[field["name"]].itemsize
        rows.append((records.ctypes.data + member["offset"], records.itemsize, field["offset"], size))
    columns = np.array(rows, dtype=np.int64).T.copy()
    return dict(zip(("source", "stride", "offset", "size"), columns, strict=True))


def _find(block: str, field: Any, sources: Sequence[Source]) -> tuple[Source, Any]:
    for source in sources:
        for member in source.fields:
            if member["name"] == field["name"]:
                _require_like(block, field, member)
                return source, member
    known = ", ".join(f["name"] for source in sources for f in source.fields)
    raise WiringError(f"drive '{block}': nothing gives its input '{field['name']}': call it like one of {known}")


def _require_like(block: str, field: Any, member: Any) -> None:
    kinds = [(f["ctype"], f["count"], f["unit"]) for f in (field, member)]
    if kinds[0][:2] != kinds[1][:2] or dimension(field["unit"]) != dimension(member["unit"]):
        input_text, member_text = (f"{count} {ctype} in {unit}" for ctype, count, unit in kinds)
        raise WiringError(
            f"drive '{block}': its input '{field['name']}' is {input_text}, what has this name is {member_text}: "
            "wire like to like, in one scalar type"
        )
