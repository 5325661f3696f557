"""The status bit of late set-points: when it is set, what counts it, what the header says, and planted defects."""

from dataclasses import replace

import numpy as np
import pytest

from synth.block import Block
from synth.blocks.guard import following
from synth.emit.write import emit
from synth.execute import host
from synth.fault import Fault
from synth.signals import Signal
from synth.simulate import closed_loop
from synth.timing import Discrete
from tests import levitator

TIME = Discrete(1e-3)
Q, REFERENCE = Signal("q", "m", -0.1, 0.1), Signal("q_ref", "m", -0.1, 0.1, "set-point of the gap")
AXIS = following.Axis(Q, REFERENCE, 1e-3, 5)
BLOCK = following.block(TIME, [AXIS])
PID = levitator.design()


def late(block: Block, latched: float, brakes: float, q: float, reference: float) -> int:
    return int(np.asarray(block.function()([], [latched, brakes, q, reference])[1]).item())


@pytest.mark.parametrize("error", [0.0, 9.9e-4, -9.9e-4, 1.1e-3, -1.1e-3, 0.1])
def test_the_bit_is_set_beyond_the_largest_error_alone(error: float) -> None:
    assert late(BLOCK, 0, 0, 0.01, 0.01 + error) == (abs(error) > 1e-3)


def test_nothing_is_late_while_it_brakes_or_is_latched() -> None:
    assert late(BLOCK, 0, 0, 0.0, 0.1) == 1
    assert [late(BLOCK, 1, 0, 0.0, 0.1), late(BLOCK, 0, 1, 0.0, 0.1), late(BLOCK, 1, 1, 0.0, 0.1)] == [0, 0, 0]


def with_late_bit(status: bool) -> Block:
    """Return the levitator's controller with a bit 5 that is always set, as a status or, wrongly, as a fault."""
    block = PID.DESIGN.controller.block
    flag = next(f for f in block.faults if f.bit == 31)
    name = "always_late"
    output = {**block.output, name: 1 - block.output[flag.output]}
    return replace(block, output=output, faults=(*block.faults, Fault(5, name, about="late", status=status)))


def test_header_and_manifest_name_the_status_and_its_mask() -> None:
    made = emit(with_late_bit(True), np.float32)
    header = next(text for name, text in made.files.items() if name.endswith(".h"))
    assert " *   bit  5  status, no fault: late" in header and "status, 0x00000020, are no faults" in header
    assert {"bit": 5, "about": "late", "status": True} in made.manifest["faults"]
    plain = emit(with_late_bit(False), np.float32)
    assert not any("status" in text for name, text in plain.files.items() if name.endswith(".h"))


@pytest.mark.parametrize("status", [True, False])
def test_a_trajectory_keeps_a_status_apart_from_faults(status: bool) -> None:
    """The planted defect: the same bit without `status` is a false alarm in every sample."""
    made = emit(with_late_bit(status), np.float32)
    controller = host.load(made.files, made.manifest)
    assert controller.status_mask == (1 << 5 if status else 0)
    words = np.array([1 << 5, 1 << 5 | 1, 1 << 31], np.uint32)
    units = closed_loop.column_units(PID.PLANT, [controller])
    run = closed_loop.trajectory(units, controller.status_mask, np.arange(3.0), _columns(), words, {}, {})
    np.testing.assert_array_equal(run.faults, [0, 1, 1 << 31] if status else words)
    np.testing.assert_array_equal(run.status, [1 << 5, 1 << 5, 0] if status else [0, 0, 0])


def _columns() -> dict[str, dict[str, np.ndarray]]:
    return {name: {} for name in ("states", "outputs", "applied", "measured", "commands")}
