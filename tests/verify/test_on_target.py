"""Bit-exact comparison of target and host: equal code passes, and each planted defect fails its check."""

import shutil
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

from benchmarks import axes
from synth.check import Check
from synth.emit.write import EmittedCode
from synth.errors import CompileError, DesignError, SignalError
from synth.execute import cross, host, qemu, target
from synth.verify import replays
from tests import tools

SCALARS = {"cortex-m4f": np.float32, "cortex-m7": np.float64}
EMITTED = {core: axes.emit(2, scalar) for core, scalar in SCALARS.items()}
HAS_QEMU = bool(shutil.which("qemu-system-arm") and shutil.which(tools.ARM_GCC))
ERROR = "&state->filter_2, guard_ready, e2)"


def inputs(n: int = 400) -> dict[str, Any]:
    """Both axes swing; the guarded one has bad samples for some time, and permanently at the end."""
    time = np.arange(n) * 1e-3
    q1 = 0.003 * np.sin(40 * time)
    q1[[40, 41, 90]], q1[n - 50 :] = np.nan, np.inf
    return {"q1": q1, "r1": 0.001, "q2": 0.002 * np.sin(50 * time), "r2": 0.0005}


def silent(_: str) -> None:
    """Ignore progress messages."""


def failed(checks: tuple[Check, ...]) -> list[str]:
    return [c.name for c in checks if not c.passed]


@tools.sees_more_with_tools
@pytest.mark.parametrize("core", SCALARS)
def test_target_and_host_are_bit_identical(core: str) -> None:
    messages: list[str] = []
    checks = replays.verify(EMITTED[core], inputs(), core, messages.append)
    assert not failed(checks), checks
    runs = [f"{core}, {compiler}, unicorn" for compiler in cross.available()] + [f"{core}, gcc, QEMU"] * HAS_QEMU
    for run in runs:
        names = [c.name for c in checks if c.name.startswith(f"{run}: ")]
        assert [n.split(": ")[1].split()[0] for n in names] == ["outputs", "states", "fault"]
    assert len(messages) == len(runs)
    singles = [c for c in checks if "double-precision" in c.name]
    assert len(singles) == (len(cross.available()) if core == "cortex-m4f" else 0)
    faults = host.load(EMITTED[core].files, EMITTED[core].manifest).replay(inputs()).faults
    assert {0, 1, 1 << 31 | 1} == set(faults.tolist())  # bad samples and the latch were among the steps


def planted(core: str, change: Callable[[str], str]) -> Callable[..., Any]:
    """Return a `load` that builds changed C for the core; the host keeps the emitted C."""
    load = target.load

    def loaded(files: Mapping[str, str], *arguments: Any) -> target.Target:
        return load(files | {"axes_2.c": change(files["axes_2.c"])}, *arguments)

    return loaded


def last_bit(text: str) -> str:
    """Change what one filter reads in its last place."""
    assert text.count(ERROR) == 1
    return text.replace(ERROR, ERROR.replace("e2", "e2 * 1.0000001f"))


def test_a_changed_literal_breaks_the_identity(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(target, "load", planted("cortex-m4f", last_bit))
    checks = replays.verify(EMITTED["cortex-m4f"], inputs(), "cortex-m4f", silent)
    for compiler in cross.available():
        where = f"cortex-m4f, {compiler}, unicorn"
        broken = [name for name in failed(checks) if name.startswith(where)]
        assert broken == [f"{where}: outputs that differ", f"{where}: states that differ"]
    (states,) = [c for c in checks if c.name == "cortex-m4f, zig, unicorn: states that differ"]
    assert "filter_2_s" in states.about and "filter_1_s" not in states.about


@tools.sees_more_with_tools
def test_another_fault_word_breaks_the_identity(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(target, "load", planted("cortex-m4f", lambda c: c.replace("0x00000001u", "0x00000004u")))
    checks = replays.verify(EMITTED["cortex-m4f"], inputs(), "cortex-m4f", silent)
    assert {n.split(": ")[1] for n in failed(checks)} == {"fault words that differ"}


@tools.needs("qemu-system-arm", tools.ARM_GCC, shows="that a second emulator is compared, too")
def test_the_second_emulator_is_compared_too(monkeypatch: pytest.MonkeyPatch) -> None:
    load = qemu.load
    monkeypatch.setattr(qemu, "load", lambda f, *a: load(f | {"axes_2.c": last_bit(f["axes_2.c"])}, *a))
    checks = replays.verify(EMITTED["cortex-m4f"], inputs(), "cortex-m4f", silent)
    assert {n.split(": ")[0] for n in failed(checks)} == {"cortex-m4f, gcc, QEMU"}


@tools.needs_arm_gcc
def test_contraction_breaks_the_identity(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cross, "FLAGS", (*cross.FLAGS, *cross.CONTRACTED))
    checks = replays.verify(EMITTED["cortex-m4f"], inputs(), "cortex-m4f", silent)
    assert "cortex-m4f, gcc, unicorn: states that differ" in failed(checks)


@tools.sees_more_with_tools
@pytest.mark.parametrize("core", SCALARS)
def test_a_planted_double_is_a_failed_check(core: str) -> None:
    """The Cortex-M7 has doubles in hardware and no such check."""
    made = EMITTED[core]
    text = made.files["axes_2.c"].replace("const float q2 = in->q2;", "const float q2 = (float)(in->q2 * 0.1 * 10.0);")
    checks = replays.verify(EmittedCode(made.files | {"axes_2.c": text}, made.manifest), inputs(), core, silent)
    if core == "cortex-m7":
        assert not failed(checks)
        return
    assert set(failed(checks)) == {f"cortex-m4f, {c}: double-precision symbols" for c in cross.available()}
    assert all("__aeabi_dmul" in c.about for c in checks if not c.passed)


@tools.needs_arm_gcc
@pytest.mark.parametrize(("core", "bound"), [("cortex-m4f", 1e-4), ("cortex-m7", 1e-12)])
def test_drift_is_bounded(core: str, bound: float) -> None:
    """Fused products change the last bits, a few hundred units after 400 steps, but no fault word."""
    drift = replays.drift(EMITTED[core], inputs(), core, 1.0)
    assert (drift.core, drift.compiler, drift.steps, drift.faults) == (core, "gcc", 400, 0)
    assert 0 < drift.worst < bound and drift.output in ("i1", "i2") and 0 <= drift.step < 400


@tools.needs_arm_gcc
def test_drift_detects_a_different_law(monkeypatch: pytest.MonkeyPatch) -> None:
    made = EMITTED["cortex-m4f"]
    before = replays.drift(made, inputs(), "cortex-m4f", 1.0)
    slower = planted("cortex-m4f", lambda c: c.replace(ERROR, ERROR.replace("e2", "0.3f * e2")))
    monkeypatch.setattr(target, "load", slower)
    drift = replays.drift(made, inputs(), "cortex-m4f", 1.0)
    assert drift.output == "i2" and drift.worst > 1e-3 > before.worst


def test_invalid_arguments_are_named() -> None:
    with pytest.raises(DesignError, match="cortex-m7: found C in float32, need float64"):
        replays.verify(EMITTED["cortex-m4f"], inputs(), "cortex-m7", silent)
    with pytest.raises(CompileError, match="core: found 'cortex-m0'"):
        replays.verify(EMITTED["cortex-m4f"], inputs(), "cortex-m0", silent)
    with pytest.raises(SignalError, match=r"missing \['r2'\]"):
        replays.verify(EMITTED["cortex-m4f"], {n: v for n, v in inputs().items() if n != "r2"}, "cortex-m4f", silent)
