"""A safe output with twice the declared slew rate, or another safe value, is detected from the C."""

import numpy as np
import pytest

from benchmarks import axes
from synth.block import Block
from synth.blocks.guard import safe_output, safety
from synth.emit import write
from synth.execute import host
from synth.verify.proofs import contract

SLEW, SAFE = "slews at", "ends from its safe value by"


def planted(monkeypatch: pytest.MonkeyPatch, **wrong: dict[str, float]) -> host.Controller:
    """Return two axes whose C has another safe output than their manifest."""
    right, original = axes.block(2), safe_output.block

    def other(time: object, outputs: object, limits: safety.Safety) -> Block:
        return original(time, outputs, safety.replace(limits, **wrong))  # type: ignore[attr-defined, arg-type]

    if wrong:
        monkeypatch.setattr(axes.safe_output, "block", other)
    made = write.emit(axes.block(2), np.float32)
    claimed = {"safe_output": dict(right.safety.safe_output), "slew_per_s": dict(right.safety.slew_per_s)}
    return host.load(made.files, {**made.manifest, "safety": {**made.manifest["safety"], **claimed}})


def failed(controller: host.Controller) -> set[str]:
    return {c.name.split(" ", 2)[2] for c in contract.verify(controller) if not c.passed}


def test_emitted_c_slews_as_declared(monkeypatch: pytest.MonkeyPatch) -> None:
    checks = contract.verify(planted(monkeypatch))
    assert len(checks) == 4 and all(c.passed for c in checks)
    assert all(c.value > 0.9 * c.limit for c in checks if SLEW in c.name), "the outputs were far from their safe values"


def test_a_doubled_slew_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    assert failed(planted(monkeypatch, slew_per_s={"i1": 100.0, "i2": 50.0})) == {SLEW}


def test_another_safe_value_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    assert failed(planted(monkeypatch, safe_output={"i1": 0.0, "i2": 0.01})) == {SAFE}


def test_a_controller_without_safe_output_has_no_checks() -> None:
    made = write.emit(
        safety.guard(axes.TIME, [safety.GuardedInput(axes.Signal("q", "m", -1, 1), 0.0, True)], 3), np.float64
    )
    assert contract.verify(host.load(made.files, made.manifest)) == ()
