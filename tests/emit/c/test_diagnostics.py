"""Diagnostics: absent without the macro, and with it the step's results, signals, saturation and cause of a latch."""

import ctypes
import re
from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, Step, build
from synth.blocks.guard import safe_output
from synth.blocks.guard.safety import GuardedInput, Safety, guard
from synth.composition import compose
from synth.emit.c import diagnostics
from synth.emit.c import locals as variables
from synth.emit.passes import parts
from synth.emit.write import EmittedCode, emit
from synth.execute import compile as compiler
from synth.execute import host
from synth.signals import Signal
from synth.timing import Discrete

TIME = Discrete(1e-3)
FORCE = Signal("force", "N", -1, 1)
SAFETY = Safety(3, {"force": 0.25}, {"force": 100.0}, "a spring centres it")
POSITION, LIMITED = Signal("position", "m", -1, 1), Signal("force_computed", "N", -0.5, 0.5)
MACRO = "-DSTAGE_DIAGNOSTICS"


def stage() -> Block:
    """Return a guarded law with one signal between two Blocks, and one limit."""

    def sense(u: Any, x: Any, k: Any) -> Step:
        return Step({"angle": ca.sqrt(2 + u["position_held"]) - 1})

    def control(u: Any, x: Any, k: Any) -> Step:
        return Step({"force_computed": ca.fmax(ca.fmin(2 * u["angle"], 0.5), -0.5)})

    held, angle = Signal("position_held", "m", -1, 1), Signal("angle", "rad", -9, 9, "of the lever")
    blocks = [
        guard(TIME, [GuardedInput(POSITION, 0.0, True)], 3),
        build("sensing", TIME, sense, inputs=[held], outputs=[angle]),
        build("control", TIME, control, inputs=[angle], outputs=[LIMITED]),
        safe_output.block(TIME, [FORCE], SAFETY),
    ]
    return compose("stage", blocks, inputs=["position"], outputs=["force"])


def code(emitted: EmittedCode) -> dict[str, str]:
    return {n: t for n, t in emitted.files.items() if n.endswith((".c", ".h"))}


def fields(header: str) -> list[tuple[str, type]]:
    """Return the members of the struct of diagnostics."""
    body = header[: header.index("} stage_diagnostics_t;")].rpartition("typedef struct {")[2]
    kinds = {"float": ctypes.c_float, "uint32_t": ctypes.c_uint32}
    return [(name, kinds[kind]) for kind, name in re.findall(r"^    (\w+) (\w+);", body, re.MULTILINE)]


@pytest.fixture(scope="module")
def emitted() -> EmittedCode:
    return emit(stage(), np.float32)


class Diagnosed:
    """Runs the step with diagnostics."""

    def __init__(self, emitted: EmittedCode, change: tuple[str, str] = ("", "")) -> None:
        files = {n: t.replace(*change) if change[0] else t for n, t in code(emitted).items()}
        self.library = ctypes.CDLL(str(compiler.shared_library(files, ["-O1", MACRO])))
        self.kinds = {role: host.dtype(role, emitted.manifest) for role in ("state", "input", "output")}
        self.record = type("Record", (ctypes.Structure,), {"_fields_": fields(files["stage.h"])})()
        self.state = np.zeros((), self.kinds["state"])
        self.library.stage_init(ctypes.c_void_p(self.state.ctypes.data))

    def step(self, position: float, pointer: Any = None) -> tuple[Any, int]:
        inputs, out = np.zeros((), self.kinds["input"]), np.zeros((), self.kinds["output"])
        inputs["position"] = position
        self.library.stage_step_diagnosed.restype = ctypes.c_uint32
        places = (ctypes.c_void_p(a.ctypes.data) for a in (self.state, inputs, out))
        return out, self.library.stage_step_diagnosed(*places, pointer)


def replay(emitted: EmittedCode, change: tuple[str, str] = ("", "")) -> list[str]:
    """Return what is wrong with the results and records of a run that saturates and latches."""
    run, plain = Diagnosed(emitted, change), host.load(emitted.files, emitted.manifest)
    state, wrong = plain.init(), []
    positions = [0.0, -0.9, 0.5, np.nan, 7.0, np.nan, 0.1, np.nan]
    for count, position in enumerate(positions, 1):
        out, faults = run.step(position, ctypes.byref(run.record))
        expected = plain.step(state, {"position": position})
        if (float(out["force"]), faults) != (expected.outputs["force"], expected.faults):
            wrong.append(f"{count}: results")
        if (run.record.samples, run.record.faults) != (count, expected.faults):
            wrong.append(f"{count}: words")
        if np.isfinite(position) and count < 6:
            angle = np.sqrt(2 + (position if position < 1 else 0.5)) - 1
            if abs(run.record.angle - angle) > 1e-6:
                wrong.append(f"{count}: signal")
            if run.record.saturated != int(abs(2 * angle) >= 0.5):
                wrong.append(f"{count}: saturation")
        if run.record.latch_cause != (0 if count < 6 else 0x80000001):
            wrong.append(f"{count}: cause")
    return wrong


def test_the_record_says_what_happened(emitted: EmittedCode) -> None:
    assert replay(emitted) == []


@pytest.mark.parametrize(
    "change",
    [
        ("diagnostics->angle = angle", "diagnostics->angle = 2.0f * angle"),
        ("diagnostics->samples += 1u", "diagnostics->samples += 2u"),
        (">= 0.5f) ? 0x00000001u", ">= 0.6f) ? 0x00000001u"),
        ("diagnostics->latch_cause == 0u", "diagnostics->latch_cause != 0u"),
        ("diagnostics->saturated = 0u", "diagnostics->saturated |= 0u"),
    ],
)
def test_a_planted_defect_is_found(emitted: EmittedCode, change: tuple[str, str]) -> None:
    assert change[0] in emitted.files["stage.c"]
    assert replay(emitted, change)


def overwritten_stage() -> Block:
    """Return a composition in which a signal is the start of another one's choice, whose variable could be the same."""
    demand, pushed, position = Signal("demand", "N", 0, 3), Signal("pushed", "N", 0, 3), Signal("position", "m", -1, 1)

    def ask(u: Any, x: Any, k: Any) -> Step:
        return Step({"demand": ca.if_else(u["position"] > 0, ca.sqrt(2 + u["position"]), ca.exp(u["position"]))})

    def push(u: Any, x: Any, k: Any) -> Step:
        fading = ca.exp(-u["demand"])
        return Step({"pushed": ca.if_else(u["position"] > 0.5, fading * ca.sqrt(3 + fading), u["demand"])})

    def move(u: Any, x: Any, k: Any) -> Step:
        return Step({"force": u["pushed"] / 4})

    blocks = [
        build("asking", TIME, ask, inputs=[position], outputs=[demand]),
        build("pushing", TIME, push, inputs=[position, demand], outputs=[pushed]),
        build("moving", TIME, move, inputs=[pushed], outputs=[FORCE]),
    ]
    return compose("stage", blocks, inputs=["position"], outputs=["force"])


def recorded_demand() -> float:
    run = Diagnosed(emit(overwritten_stage(), np.float32, libm=True))
    run.step(0.75, ctypes.byref(run.record))
    return float(run.record.demand)


def test_a_recorded_signal_is_not_overwritten(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parts, "FEWEST", 99)  # the step computes everything itself
    assert recorded_demand() == pytest.approx(np.sqrt(2.75))
    planted = SimpleNamespace(of_program=lambda p: diagnostics.Diagnostics({}, {}))
    monkeypatch.setattr(variables, "diagnostics", planted)
    fading = np.exp(-np.sqrt(2.75))
    assert recorded_demand() == pytest.approx(fading * np.sqrt(3 + fading))


def test_a_null_pointer_records_nothing(emitted: EmittedCode) -> None:
    run, plain = Diagnosed(emitted), host.load(emitted.files, emitted.manifest)
    state = plain.init()
    for position in (0.3, np.nan, -0.9):
        out, faults = run.step(position)
        expected = plain.step(state, {"position": position})
        assert (float(out["force"]), faults) == (expected.outputs["force"], expected.faults)


def test_the_manifest_says_what_is_recorded(emitted: EmittedCode) -> None:
    assert emitted.manifest["diagnostics"] == {
        "macro": "STAGE_DIAGNOSTICS",
        "function": "stage_step_diagnosed",
        "type": "stage_diagnostics_t",
        "signals": {"angle": "rad"},
        "words": ["samples", "faults", "latch_cause", "saturated"],
        "saturated": ["force_computed"],
    }


def test_it_compiles_under_the_strict_flags(emitted: EmittedCode) -> None:
    compiler.check(code(emitted), [*compiler.STRICT_FLAGS, MACRO])


def assembly(files: dict[str, str]) -> str:
    return compiler.build(files, ["-std=c99", "-O2", "-g0", "-S"], "stage.s", compiler.find_compiler()).read_text()


def test_without_the_macro_nothing_is_left_of_it(emitted: EmittedCode) -> None:
    """The machine code of the step is that of a text in which nothing is recorded."""
    files = code(emitted)
    text, blocks = re.subn(
        r" *if \(diagnostics != NULL\) \{\n(.*;\n| *if .*\{\n.*\n *\}\n)* *\}\n", "", files["stage.c"]
    )
    assert blocks >= 2 and "diagnostics->" not in text
    assert assembly(files) == assembly({**files, "stage.c": text})


def test_a_single_block_has_none() -> None:
    block = build(
        "plain",
        TIME,
        lambda u, x, k: Step({"y": 2 * u["x"]}),
        inputs=[Signal("x", "1", -1, 1)],
        outputs=[Signal("y", "1", -2, 2)],
    )
    made = emit(block, np.float32)
    assert made.manifest["diagnostics"] == {} and "DIAGNOSTICS" not in made.files["plain.c"]
