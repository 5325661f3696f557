"""The fuzzer reports nothing for correct C and finds every planted defect, including those beyond Eva."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.block import Exprs, State, Step, build, clip
from synth.blocks.guard import safety
from synth.composition import compose
from synth.emit import write
from synth.errors import CompileError, DesignError
from synth.signals import Signal
from synth.timing import Discrete
from synth.verify.proofs import fuzz
from tests import tools

Plant = Callable[[str, str], dict[str, str]]
needs_clang = tools.needs("clang", shows="that the fuzzer finds planted defects, and none in correct C")
STEPS = 20_000


@needs_clang
def test_the_sound_controller_has_no_finding(files: dict[str, str], manifest: dict[str, Any]) -> None:
    campaign = fuzz.run(files, manifest | {"safety": {"bad_samples": 5}}, STEPS)
    assert campaign.finding == ""
    assert campaign.steps >= STEPS and campaign.steps == fuzz.STEPS_A_RUN * campaign.runs
    assert campaign.covered > 50 and campaign.features > 50 and campaign.corpus > 10
    assert all(check.passed for check in campaign.checks())


@needs_clang
@pytest.mark.parametrize(
    ("old", "new", "finding"),
    [
        ("clamped(scale * i1, -4.95f, 4.95f)", "1.1f * scale * i1", "output i1"),
        ("if (fabsf(xi) > 0.05f)", "if (fabsf(xi) > 0.0501f)", "state xi"),
        ("(good_g1 ? 0u : 0x00000001u) | (good_g2", "(good_g1 ? 0u : 0x00000002u) | (good_g2", "fault word"),
        ("(in->r <= 0.031f)", "(in->r < 0.031f)", "fault word"),
        ("(in->r <= 0.031f)", "(in->r <= 0.03100001f)", "fault word"),
        ("(0.018f <= in->r) && (in->r <= 0.031f)", "!(in->r < 0.018f || in->r > 0.031f)", "fault word"),
        ("latched = (state->latched != 0u)", "latched = ((state->latched != 0u) && (bad_g1 != 0u))", "latch"),
        ("(bad_g2 == 5u)", "(bad_g2 == 4u)", "latch from init"),
        ("state->safe_i2 = out->i2", "(&state->safe_i2)[1] = out->i2", "AddressSanitizer"),
        ("w / (a1 + a2)", "w / (g1 - g2)", "division by zero"),
        ("w / (a1 + a2)", "w / (a1 + a2) + (float)(uint32_t)(1e-3f * w)", "outside the range"),
        ("out->i2 = clamped(scale * i2, -4.95f, 4.95f)", "(void)scale", "output i2"),
        ("state->xi = 0.0f", "state->xi = 0.051f", "initial state xi"),
    ],
    ids=[
        "no output clamp",
        "wide state clamp",
        "wrong fault bit",
        "bound refused",
        "next value accepted",
        "NaN let through",
        "latch falls",
        "latch rises early",
        "out of bounds",
        "division by zero",
        "overflowing cast",
        "output not written",
        "init out of bounds",
    ],
)
def test_a_planted_defect_is_found(planted: Plant, manifest: dict[str, Any], old: str, new: str, finding: str) -> None:
    campaign = fuzz.run(planted(old, new), manifest | {"safety": {"bad_samples": 5}}, STEPS)
    assert finding in campaign.finding
    assert not all(check.passed for check in campaign.checks())


@needs_clang
def test_a_wrong_certificate_is_found() -> None:
    """It omits a necessary limit; Eva assumes the certificate, but the fuzzer tests it."""

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        y = clip(2 * ca.sin(u["a_held"]), Signal("y", "V", -1.5, 1.5))
        return Step({"y": y}, {"last": y}, certified={"y": lambda u, e: 1.5})

    time, a, y = Discrete(1e-3), Signal("a", "rad", -1.5, 1.5), Signal("y", "V", -1.5, 1.5)
    last = State(Signal("last", "V", -1.5, 1.5), 0.0)
    held = replace(a, name="a_held")
    sine = build("sine", time, law, inputs=[held], outputs=[y], states=[last])
    guard = safety.guard(time, [safety.GuardedInput(a, 0.0, True)], 5)
    emitted = write.emit(compose("lie", [guard, sine], inputs=["a"], outputs=["y"]), np.float32)
    assert "output y" in fuzz.run(emitted.files, dict(emitted.manifest) | {"safety": {"bad_samples": 5}}, STEPS).finding


WORD = "(good_g1 ? 0u : 0x00000001u) | (good_g2"
LOST = {"bit": 8, "about": "g1: lost"}


@needs_clang
@pytest.mark.parametrize("meaning", [{"bit": 8, "suspect": "g1"}, LOST])
def test_only_the_step_decides_on_bits_that_follow_from_states(
    planted: Plant, manifest: dict[str, Any], meaning: dict[str, Any]
) -> None:
    """A bit that depends on states is not a finding if the manifest declares it."""
    files = planted(WORD, f"((state->xi > 0.0f) ? 0x100u : 0u) | {WORD}")
    extended = manifest | {"safety": {"bad_samples": 5}}
    assert "fault word" in fuzz.run(files, extended, STEPS).finding
    assert fuzz.run(files, extended | {"faults": [*manifest["faults"], meaning]}, STEPS).finding == ""


@needs_clang
@pytest.mark.parametrize(
    ("old", "new", "meaning", "finding"),
    [
        (WORD, f"((state->xi > 0.0f) ? 0x200u : 0u) | {WORD}", LOST, "fault word"),
        ("(good_r ? 0u : 0x00000004u)", "0x00000004u", {"bit": 2, "input": "r", "about": "r: lost"}, "fault word"),
        ("(good_r ? 0u : 0x00000004u)", "0x00000100u", LOST, "fault word"),
        ("(bad_g2 == 5u)", "(bad_g2 == 4u)", LOST, "latch from init"),
    ],
    ids=["another bit", "the bit of an input", "instead of the bit of an input", "latch rises early"],
)
def test_a_bit_with_a_meaning_of_its_own_excuses_no_other(
    planted: Plant, manifest: dict[str, Any], old: str, new: str, meaning: dict[str, Any], finding: str
) -> None:
    faults = [f for f in manifest["faults"] if f["bit"] != meaning["bit"]]
    extended = manifest | {"safety": {"bad_samples": 5}, "faults": [*faults, meaning]}
    assert finding in fuzz.run(planted(old, new), extended, STEPS).finding


JUDGED = {"bad_samples": 5, "judgement": {"counts": "enough", "at_once": "over", "measurements": ["g1", "g2"]}}
LATER = ("(bad_g1 == 5u)", "(state->bad_g1 == 5u)")  # one sample later, whatever that sample holds
SOUND = ("latched", "latched")


@needs_clang
@pytest.mark.parametrize("change", [SOUND, LATER], ids=["at once", "later"])
def test_a_declared_judgement_may_latch_later(
    planted: Plant, manifest: dict[str, Any], change: tuple[str, str]
) -> None:
    assert fuzz.run(planted(*change), manifest | {"safety": JUDGED}, STEPS).finding == ""


@needs_clang
def test_without_a_judgement_a_later_latch_is_found(planted: Plant, manifest: dict[str, Any]) -> None:
    campaign = fuzz.run(planted(*LATER), manifest | {"safety": {"bad_samples": 5}}, 5 * STEPS)
    assert "latch from init" in campaign.finding


@needs_clang
@pytest.mark.parametrize(
    ("old", "new", "finding"),
    [
        ("(bad_g2 == 5u)", "(bad_g2 == 4u)", "latch from init"),
        ("bad_g2 = good_g2 ?", "bad_g2 = (good_g2 && good_r) ?", "latch from init"),
        ("latched = (state->latched != 0u)", "latched = (g1 > 0.036f)", "latch from init"),
        ("latched = (state->latched != 0u)", "latched = ((state->latched != 0u) && (bad_g1 != 0u))", "latch"),
    ],
    ids=["too early", "a set-point latches", "all measurements good", "latch falls"],
)
def test_a_judgement_excuses_no_other_latch(
    planted: Plant, manifest: dict[str, Any], old: str, new: str, finding: str
) -> None:
    assert finding in fuzz.run(planted(old, new), manifest | {"safety": JUDGED}, STEPS).finding


@needs_clang
def test_omitted_steps_count_as_missing(files: dict[str, str], manifest: dict[str, Any]) -> None:
    campaign = fuzz.run(planted_exit(files), manifest, STEPS)
    assert not all(check.passed for check in campaign.checks())


def planted_exit(files: dict[str, str]) -> dict[str, str]:
    """Return C that exits with status 0 in its first step."""
    leave = '#include <unistd.h>\n#include "hover.h"\n'
    text = files["hover.c"].replace('#include "hover.h"\n', leave).replace("    if (latched) {", "    _exit(0);\n    {")
    return files | {"hover.c": text.replace("} else {", "}\n    {")}


@needs_clang
def test_c_that_does_not_compile_is_named(planted: Plant, manifest: dict[str, Any]) -> None:
    with pytest.raises(CompileError, match=r"clang: did not build(?s:.*)hover\.c"):
        fuzz.run(planted("if (latched) {", "if latched {"), manifest, STEPS)


def test_a_missing_tool_is_named(
    files: dict[str, str], manifest: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", "")
    with pytest.raises(CompileError, match=r"clang: not on the PATH.*libclang-rt-14-dev"):
        fuzz.run(files, manifest, STEPS)


def test_a_fault_bit_of_no_input_is_refused(files: dict[str, str], manifest: dict[str, Any]) -> None:
    with pytest.raises(DesignError, match="fault bit 7: there is no input 'g9'"):
        fuzz.run(files, manifest | {"faults": [{"bit": 7, "input": "g9"}]}, STEPS)
