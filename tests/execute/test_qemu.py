"""A second emulator, with M-class cores and start-up code, must give the same bits as the first and as the host."""

import json
from pathlib import Path

import numpy as np
import pytest

from synth.errors import CompileError, DesignError, SignalError, SynthError
from synth.execute import host, qemu, target
from tests import tools
from tests.execute.planted import lag
from tests.execute.test_target import MAGLEV, SCALARS, require_same_bits, samples

installed = tools.needs("qemu-system-arm", tools.ARM_GCC, shows="the bits of an M-class core with start-up code")


@installed
@pytest.mark.parametrize("core", SCALARS)
def test_host_and_both_emulators_give_the_same_bits(core: str) -> None:
    files, manifest = lag(SCALARS[core])
    inputs = samples(1000, SCALARS[core])
    board = qemu.load(files, manifest, core)
    expected = host.load(files, manifest).replay(inputs)
    require_same_bits(board.replay(inputs), expected)
    require_same_bits(target.load(files, manifest, core, "gcc").replay(inputs), expected)
    assert board.init().tobytes() == host.load(files, manifest).init().tobytes()


@installed
def test_a_contracted_product_is_seen() -> None:
    files, manifest = lag("float32")
    inputs = samples(200, "float32")
    fused = qemu.load(files, manifest, flags=["-ffp-contract=fast"]).replay(inputs)
    with pytest.raises(AssertionError):
        require_same_bits(fused, host.load(files, manifest).replay(inputs))


@installed
def test_both_emulators_agree_on_a_design_with_its_libm() -> None:
    """Both emulators run the libm of the same compiler, so even the last bits are equal."""
    files = {path.name: path.read_text() for path in MAGLEV.glob("*.[ch]")}
    manifest = json.loads((MAGLEV / "manifest.json").read_text())
    inputs = json.loads((MAGLEV / "vectors.json").read_text())["inputs"]
    replay = qemu.load(files, manifest).replay(inputs)
    require_same_bits(replay, target.load(files, manifest, "cortex-m4f", "gcc").replay(inputs))


@installed
def test_replay_in_two_parts_leaves_the_given_state() -> None:
    files, manifest = lag("float32")
    board, inputs = qemu.load(files, manifest), samples(30, "float32")
    whole, first = board.replay(inputs), board.replay({n: v[:11] for n, v in inputs.items()})
    before = first.state.tobytes()
    second = board.replay({n: v[11:] for n, v in inputs.items()}, first.state)
    assert np.array_equal(whole.outputs["y"], np.concatenate([first.outputs["y"], second.outputs["y"]]))
    assert first.state.tobytes() == before and second.state.tobytes() == whole.state.tobytes()


@installed
def test_variables_of_the_c_are_started() -> None:
    """Start-up copies what has a first value to RAM and clears the rest; each run starts from reset."""
    files, manifest = lag("float32")
    text = "static unsigned started = 40u, cleared;\nunsigned next(void) { return started++ + cleared++; }\n"
    step = files["lag.c"].replace("return state->ticks << 1", "extern unsigned next(void); return next() << 1")
    board = qemu.load(files | {"next.c": text, "lag.c": step}, manifest)
    for _ in range(2):
        assert board.replay({"u": np.zeros(3), "gain": 1.0}).faults.tolist() == [80, 84, 88]


@installed
@pytest.mark.parametrize(
    ("statement", "says"),
    [
        ("*(volatile uint32_t *)0xB0000000u = 1u;", "status 1"),
        ('__asm__ volatile("udf #0");', "status 1"),
        (
            'uint32_t f; __asm__ volatile("vmrs %0, fpscr\\n\\torr %0, %0, #0x1000000\\n\\tvmsr fpscr, %0" : "=r"(f));',
            "mode bits 0x1000000",
        ),
    ],
)
def test_code_that_faults_is_refused(statement: str, says: str) -> None:
    files, manifest = lag("float32")
    broken = files["lag.c"].replace("    const int good", f"    {statement}\n    const int good")
    with pytest.raises(SynthError, match=f"QEMU's cortex-m4f.*{says}"):
        qemu.load(files | {"lag.c": broken}, manifest).replay({"u": np.zeros(2), "gain": 1.0})


@installed
def test_a_run_that_does_not_terminate_is_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(qemu, "_TIMEOUT_S", 1.0)
    files, manifest = lag("float32")
    endless = files["lag.c"].replace("    const int good", "    for (;;) state->ticks = 0u;\n    const int good")
    with pytest.raises(SynthError, match="found no end after 1 s"):
        qemu.load(files | {"lag.c": endless}, manifest).replay({"u": np.zeros(1), "gain": 1.0})


@installed
def test_inputs_and_manifests_that_do_not_fit_are_named() -> None:
    files, manifest = lag("float32")
    with pytest.raises(SignalError, match=r"missing \['gain'\]"):
        qemu.load(files, manifest).replay({"u": np.zeros(3)})
    with pytest.raises(SignalError, match="state of 'lag'"):
        qemu.load(files, manifest).replay({"u": np.zeros(3), "gain": 1.0}, np.zeros(2))
    with pytest.raises(DesignError, match="struct 'input'"):
        qemu.load(files, {**manifest, "structs": {}})
    with pytest.raises(CompileError, match="core: found 'cortex-m0'"):
        qemu.load(files, manifest, "cortex-m0")


def test_a_missing_emulator_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(CompileError, match=r"no qemu-system-arm on the PATH.*install"):
        qemu.load(*lag("float32"))
