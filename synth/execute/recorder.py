"""Instruction trace of an emulated core, recorded by a compiled hook.

The emulator calls its code hook after it has tested the condition of an IT block, so the record lacks instructions that
are predicated false. It contains every conditional branch, taken or not. `trace` restores the missing instructions.

State trajectory of emitted C: x_0 from `init`, x_{k+1} = step(x_k, u_k).
"""

import ctypes
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import resources
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from unicorn import UC_HOOK_CODE, Uc, UcError, arm_const
from unicorn.unicorn_py3.unicorn import uclib

from synth.errors import SynthError
from synth.execute import compile as host_compiler
from synth.execute import host
from synth.execute.host import Records


def states(
    controller: host.Controller, inputs: Mapping[str, ArrayLike], changed: Mapping[str, float] = MappingProxyType({})
) -> Records:
    """Return the states x_0 .. x_N (N + 1,) from `init` with `changed` states, under input columns (N,) or constants.

    Raises SignalError as `host.Controller.init` and `replay`.
    """
    n = host.length(inputs)
    input_records = controller.records(inputs, n)
    states, outputs = np.zeros(n + 1, controller.state), np.zeros((), controller.outputs)
    states[0] = controller.init(changed)
    step = ctypes.CFUNCTYPE(ctypes.c_uint32, *[ctypes.c_void_p] * 3)(controller.step_address)
    state_address, size = states.ctypes.data, states.itemsize
    input_address, width = input_records.ctypes.data, input_records.itemsize
    for k in range(n):
        states[k + 1] = states[k]
        step(state_address + (k + 1) * size, input_address + k * width, outputs.ctypes.data)
    return states


CAPACITY = 1 << 20


class _Recorder(ctypes.Structure):
    """`recorder_t` of recorder.c, member for member."""

    _fields_ = [
        ("capacity", ctypes.c_int64),
        ("count", ctypes.c_int64),
        ("address", ctypes.c_void_p),
        ("read_register", ctypes.c_void_p),
        ("sp", ctypes.c_int32),
        ("lowest_sp", ctypes.c_uint32),
    ]


@dataclass(frozen=True, eq=False)
class Record:
    """R instructions of n calls: their addresses (R,), and the count up to the end of each call (n,)."""

    addresses: NDArray[np.uint32]
    ends: NDArray[np.int64]


class Recorder:
    """A buffer of executed instructions; `end_call` after each call, `take` when `is_filling` and at the end."""

    def __init__(self, capacity: int) -> None:
        self._addresses = np.empty(capacity, np.uint32)
        self._ends: list[int] = []
        self.memory = _Recorder(
            capacity=capacity,
            address=self._addresses.ctypes.data,
            read_register=ctypes.cast(uclib.uc_reg_read, ctypes.c_void_p).value,
            sp=arm_const.UC_ARM_REG_SP,
            lowest_sp=0xFFFFFFFF,
        )

    @property
    def is_filling(self) -> bool:
        """Whether less than half of the buffer is left."""
        return bool(2 * self.memory.count > self.memory.capacity)

    @property
    def lowest_sp(self) -> int:
        """The lowest stack pointer before any recorded instruction."""
        return int(self.memory.lowest_sp)

    def end_call(self) -> None:
        """Mark the end of a call; raise SynthError when it executed more instructions than the buffer holds."""
        if self.memory.count > self.memory.capacity:
            raise SynthError(
                f"one call executed {self.memory.count} instructions, {self.memory.capacity // 2} can be recorded: "
                "measure a smaller function"
            )
        self._ends.append(self.memory.count)

    def take(self) -> Record:
        """Return the record and empty the buffer."""
        n = self.memory.count
        record = Record(self._addresses[:n].copy(), np.array(self._ends, dtype=np.int64))
        self.memory.count, self._ends = 0, []
        return record


@contextmanager
def attach(engine: Uc, capacity: int = CAPACITY) -> Iterator[Recorder]:
    """Record every instruction that the engine executes within the `with` block."""
    recorder, handle = Recorder(capacity), ctypes.c_size_t()
    callback = ctypes.cast(_library().synth_record, ctypes.c_void_p)
    # hook_add of the Python binding accepts only Python functions, which take ten times as long as this one.
    everything = ctypes.c_uint64(1), ctypes.c_uint64(0)
    status = uclib.uc_hook_add(
        engine._uch, ctypes.byref(handle), UC_HOOK_CODE, callback, ctypes.byref(recorder.memory), *everything
    )
    if status:
        raise UcError(status)
    engine.ctl_flush_tb()  # discard code that was translated without the hook
    try:
        yield recorder
    finally:
        uclib.uc_hook_del(engine._uch, handle)
        engine.ctl_flush_tb()


def _library() -> Any:
    text = resources.files("synth.execute").joinpath("recorder.c").read_text(encoding="utf-8")
    return ctypes.CDLL(str(host_compiler.shared_library({"recorder.c": text})))
