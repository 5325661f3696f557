"""Eva proves the contract of correct C and no longer proves it with any planted defect."""

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.block import Exprs, State, Step, build
from synth.blocks.guard import safety
from synth.composition import compose
from synth.emit import write
from synth.errors import CompileError, DesignError
from synth.signals import Signal
from synth.timing import Discrete
from synth.verify.proofs import eva
from tests import tools

Plant = Callable[[str, str], dict[str, str]]
needs_frama_c = tools.needs("frama-c", shows="that Eva proves correct C and no planted defect")
# Of 2 outputs and 10 states, 3 of them integers: each real is claimed finite, and each value above and below a bound.
CLAIMS = 2 * 3 + 2 * (7 * 3 + 3 * 2)


@needs_frama_c
def test_the_sound_controller_is_proved(files: dict[str, str], manifest: dict[str, Any]) -> None:
    proof = eva.prove(files, manifest)
    assert (proof.alarms, proof.unproved, proof.proved, proof.claims) == ((), (), CLAIMS, CLAIMS)
    assert proof.trusted == ()
    assert all(check.passed for check in proof.checks())


@needs_frama_c
def test_a_guard_verdict_used_far_from_its_input_keeps_its_relation(
    files: dict[str, str], manifest: dict[str, Any]
) -> None:
    verdict = "    const bool good_r = (0.018f <= in->r) && (in->r <= 0.031f);\n"
    first = "    const bool good_g1 ="
    moved = files["hover.c"].replace(verdict, "").replace(first, verdict + first)
    proof = eva.prove(files | {"hover.c": moved}, manifest)
    assert (proof.alarms, proof.unproved, proof.proved) == ((), (), CLAIMS)


@needs_frama_c
def test_a_loop_of_fixed_count_is_proved(planted: Plant, manifest: dict[str, Any]) -> None:
    loop = (
        "float q = w / (a1 + a2);\n        for (uint32_t k = 0u; k < 8u; k++) {\n            q = 1.1f * q;\n        }"
    )
    proof = eva.prove(planted("const float q = w / (a1 + a2);", loop), manifest)
    assert (proof.alarms, proof.unproved, proof.proved) == ((), (), CLAIMS)


@needs_frama_c
@pytest.mark.parametrize(
    ("old", "new", "alarm", "open_claim"),
    [
        ("clamped(scale * i1, -4.95f, 4.95f)", "scale * i1", "", "output.i1"),
        ("if (fabsf(xi) > 0.05f)", "if (fabsf(xi) > 0.06f)", "", "state.xi"),
        ("clamped((0.9f * state->v) + (260.0f * e), -30.0f, 30.0f)", "(0.9f * state->v) + (260.0f * e)", "", "state.v"),
        ("w / (a1 + a2)", "w / (a1 - a2)", "is_nan_or_infinite", ""),
        ("w / (a1 + a2)", "w + logf(e)", "", "precondition of logf"),
        ("(q > 0.0f) ? sqrtf(q) : 0.0f", "sqrtf(q)", "", "precondition of sqrtf"),
        ("(in->g1 <= 0.0365f)", "(in->g1 <= 0.0366f)", "", "state.last_g1"),
        ("state->safe_i2 = out->i2", "(&state->safe_i2)[1] = out->i2", "mem_access", ""),
        ("state->v = 0.0f", "(void)state->v", "initialization", ""),
        ("state->xi = 0.0f", "state->xi = 0.051f", "", "state.xi"),
        ("out->i2 = clamped(scale * i2, -4.95f, 4.95f)", "(void)scale", "initialization", ""),
        ("if (latched) {", "while (true) { }\n    if (latched) {", "", "the end is never reached"),
        ("bad_g1 = good_g1 ? 0u", "bad_g1 = good_g1 ? (state->bad_g1 - 1u)", "unsigned_overflow", ""),
    ],
    ids=[
        "no output clamp",
        "wide state clamp",
        "no state clamp",
        "difference divides",
        "logarithm",
        "root",
        "wide guard",
        "out of bounds",
        "init leaves a gap",
        "init out of bounds",
        "output not written",
        "endless",
        "counter wraps",
    ],
)
def test_a_planted_defect_is_not_proved(
    planted: Plant, manifest: dict[str, Any], old: str, new: str, alarm: str, open_claim: str
) -> None:
    proof = eva.prove(planted(old, new), manifest)
    assert not all(check.passed for check in proof.checks())
    assert any(alarm in text for text in proof.alarms) or not alarm
    assert any(open_claim in text for text in proof.unproved) or not open_claim


@needs_frama_c
def test_c_that_does_not_parse_is_named(planted: Plant, manifest: dict[str, Any]) -> None:
    with pytest.raises(CompileError, match=r"Frama-C: stopped(?s:.*)hover\.c"):
        eva.prove(planted("if (latched) {", "if latched {"), manifest)


def test_a_missing_tool_is_named(
    files: dict[str, str], manifest: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", "")
    with pytest.raises(CompileError, match=r"frama-c: not on the PATH.*apt-get install frama-c-base"):
        eva.prove(files, manifest)


@pytest.mark.parametrize("bounds", [(0.1, 1.0), (1.0, 0.0), (0.0, float("inf")), (float("nan"), 0.0)])
def test_invalid_bounds_are_refused(
    files: dict[str, str], manifest: dict[str, Any], bounds: tuple[float, float]
) -> None:
    field = manifest["structs"]["output"]["fields"][0] | dict(zip(("low", "high"), bounds, strict=True))
    structs = manifest["structs"] | {"output": manifest["structs"]["output"] | {"fields": [field]}}
    with pytest.raises(DesignError, match=r"output 'i1': found the bounds"):
        eva.prove(files, manifest | {"structs": structs})


GENERATED = Path(__file__).parents[3] / "generated_c" / "maglev_5dof"


@pytest.fixture(scope="module")
def maglev() -> tuple[dict[str, str], dict[str, Any]]:
    code = {path.name: path.read_text() for path in GENERATED.glob("*.[ch]")}
    return code, json.loads((GENERATED / "manifest.json").read_text())


def widened(text: str, limits: set[float]) -> str:
    """Return the C with every literal near one of these limits enlarged by a tenth, which violates the manifest."""

    def wider(literal: re.Match[str]) -> str:
        value = float(literal[0])
        return repr(1.1 * value) if any(abs(value - limit) < 1e-4 * limit for limit in limits) else literal[0]

    return re.sub(r"\d+\.\d*(?:e[-+]?\d+)?(?=f\b)", wider, text)


@needs_frama_c
def test_the_emitted_controller_is_proved(maglev: tuple[dict[str, str], dict[str, Any]]) -> None:
    proof = eva.prove(*maglev)
    assert (proof.alarms, proof.unproved) == ((), ())
    assert proof.proved == proof.claims > 300


@needs_frama_c
@pytest.mark.parametrize("role", ["output", "state"])
def test_the_emitted_controller_with_wide_limits_is_not_proved(
    maglev: tuple[dict[str, str], dict[str, Any]], role: str
) -> None:
    code, manifest = maglev
    highs = {r: {f["high"] for f in s["fields"] if f["ctype"] == "float"} for r, s in manifest["structs"].items()}
    # The guard's limits stay: what is open on account of them takes an analysis for each input.
    limits = highs[role] - highs["input"]
    wide = {name: widened(text, limits) for name, text in code.items()}
    assert wide != code
    assert any(f"{role}." in claim for claim in eva.prove(wide, manifest).unproved)


@needs_frama_c
def test_admitted_bounds_are_counted(planted: Plant, manifest: dict[str, Any]) -> None:
    """Eva assumes an admitted bound; the evidence therefore states their number."""
    limited = "out->i1 = clamped(scale * i1, -4.95f, 4.95f);"
    proof = eva.prove(planted(limited, "out->i1 = scale * i1; /*@ admit -4.95f <= out->i1 <= 4.95f; */"), manifest)
    assert (proof.alarms, proof.unproved, proof.admitted) == ((), (), 1)
    assert "1 bounds taken over from certificates" in proof.checks()[0].about
    unfit = "/*@ admit 2.0f <= i1 <= 1.0f; */"
    refuted = eva.prove(planted("out->i1 = clamped(scale * i1, -4.95f, 4.95f);", f"{limited} {unfit}"), manifest)
    assert not refuted.checks()[1].passed and "user check" in refuted.unproved[0]  # whatever follows would go unseen


@pytest.fixture(scope="module")
def rate_limited() -> tuple[dict[str, str], dict[str, Any]]:
    """Return the C of a position that follows a guarded one within its own range, and its manifest."""
    time, target, last = Discrete(1e-3), Signal("target", "m", -0.1, 0.1), Signal("last", "m", -0.1, 0.1)

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        next = ca.fmax(ca.fmin(u["target_held"], x["last"] + 1e-3), x["last"] - 1e-3)
        return Step({"position": next + 1.5 * (next - x["last"])}, {"last": next})

    position = Signal("position", "m", -0.5, 0.5)
    held = replace(target, name="target_held")
    follow = build("follow", time, law, inputs=[held], outputs=[position], states=[State(last, 0.0)])
    guard = safety.guard(time, [safety.GuardedInput(target, 0.0, False)], 5)
    emitted = write.emit(compose("follower", [guard, follow], inputs=["target"], outputs=["position"]), np.float32)
    return dict(emitted.files), dict(emitted.manifest)


@needs_frama_c
def test_a_rate_limit_between_values_in_range_is_proved(rate_limited: tuple[dict[str, str], dict[str, Any]]) -> None:
    """Its sums leave the range; only the comparison with the target shows that the result does not."""
    proof = eva.prove(*rate_limited)
    assert (proof.alarms, proof.unproved, proof.admitted) == ((), (), 0)
    assert proof.proved == proof.claims == 3 + 2 * 2 * 3


@needs_frama_c
@pytest.mark.parametrize(("end", "claim"), [("low", "\u2264 state.follow.last"), ("high", "state.follow.last \u2264")])
def test_a_wrong_claim_on_a_state_is_not_proved(
    rate_limited: tuple[dict[str, str], dict[str, Any]], end: str, claim: str
) -> None:
    """The state follows its target out of a range that is a hundredth narrower."""
    files, manifest = rate_limited
    states = manifest["structs"]["state"]
    fields = [
        f | {end: float(np.float32(0.99 * f[end]))} if f["name"] == "follow_last" else f for f in states["fields"]
    ]
    structs = manifest["structs"] | {"state": states | {"fields": fields}}
    proof = eva.prove(files, manifest | {"structs": structs})
    assert [claim in text for text in proof.unproved] == [True]


@needs_frama_c
@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("(target < highest)", "(target > highest)"),
        ("(below > lowest)", "(below < lowest)"),
        ("last - step", "last + step"),
    ],
)
def test_a_defect_of_the_rate_limit_is_not_proved(
    rate_limited: tuple[dict[str, str], dict[str, Any]], old: str, new: str
) -> None:
    files, manifest = rate_limited
    assert files["follower.c"].count(old) == 1
    proof = eva.prove(files | {"follower.c": files["follower.c"].replace(old, new)}, manifest)
    assert any("state.follow.last" in text for text in proof.unproved)
