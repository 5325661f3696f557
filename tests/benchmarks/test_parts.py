"""Parts of a step: they add up to what is issued, and what is planted in a Block's lines is charged to that Block."""

import numpy as np
import pytest

from benchmarks import axes, parts
from synth.emit.write import EmittedCode
from synth.errors import SignalError
from synth.execute import host
from synth.verify import baselines, lines, meter, steps
from synth.verify.steps import Steps
from tests import tools

pytestmark = pytest.mark.whole

EMITTED = axes.emit(2, np.float32)
BUILDS = {b.compiler: b for b in reversed(meter.BUILDS)}  # without contraction
LOOP = "for (volatile int i = 0; i < 20; i++) { }"
BLOCKS = {tag.split(":")[0] for tag in EMITTED.manifest["trace"]}


@pytest.fixture(scope="module")
def stimulus() -> Steps:
    controller = host.load(EMITTED.files, EMITTED.manifest)
    return steps.without_faults(controller, steps.in_range(controller, 60))


def planted(before: str, after: str, top: str = "") -> EmittedCode:
    """Return the emitted C with one text replaced and another put in front of the step; no line moves."""
    text = EMITTED.files["axes_2.c"]
    assert text.count(before) == 1
    step = "uint32_t axes_2_step("
    text = text.replace(before, after).replace(step, top + step)
    return EmittedCode(EMITTED.files | {"axes_2.c": text}, EMITTED.manifest)


def line_of(block: str) -> str:
    """Return a declaration of a real number among a Block's lines."""
    runs = next(runs for tag, runs in EMITTED.manifest["trace"].items() if tag.startswith(f"{block}:"))
    text = EMITTED.files["axes_2.c"].splitlines()
    lines_found = [text[k - 1] for first, last in runs for k in range(first, last + 1)]
    return [line for line in lines_found if line.strip().startswith("const float")][-1]  # of the step


@pytest.mark.parametrize("build", tools.BUILDS)
def test_parts_add_up_to_what_is_issued(build: meter.Build, stimulus: Steps) -> None:
    counts = parts.measure(EMITTED, stimulus, build)
    issued = meter.run(baselines.emitted_c(EMITTED), stimulus, build).cost.instructions
    assert np.array_equal(sum(counts.values()), issued)
    assert set(counts) == BLOCKS | {parts.FRAME} and list(counts)[-1] == parts.FRAME
    busy = {"guard", "regulator_1", "regulator_2"}
    assert busy <= BLOCKS and all(counts[name].mean() > 5 for name in busy)
    assert counts[parts.FRAME].mean() < 0.2 * issued.mean()  # clang gives some of what it merges no line


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
def test_what_is_planted_in_a_block_is_charged_to_it(compiler: str, stimulus: Steps) -> None:
    line = line_of("regulator_2")
    usual = parts.measure(EMITTED, stimulus, BUILDS[compiler])
    counts = parts.measure(planted(line, f"{line} {LOOP}"), stimulus, BUILDS[compiler])
    more = {name: float((counts[name] - usual[name]).mean()) for name in usual}
    assert more["regulator_2"] > 80  # four instructions and more a turn
    assert sum(abs(m) for name, m in more.items() if name != "regulator_2") < 20  # registers are allocated again


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
def test_a_function_is_charged_to_the_line_that_calls_it(compiler: str, stimulus: Steps) -> None:
    """Whether the compiler calls it or puts its text in."""
    line = line_of("regulator_1")
    usual = parts.measure(EMITTED, stimulus, BUILDS[compiler])
    for how in ("__attribute__((noinline)) ", "inline "):
        top = f"static {how}void waste(void) {{ {LOOP} }} "
        counts = parts.measure(planted(line, f"{line} waste();", top), stimulus, BUILDS[compiler])
        more = {name: float((counts[name] - usual[name]).mean()) for name in usual}
        assert more["regulator_1"] > 80 and sum(abs(m) for m in more.values()) < more["regulator_1"] + 20


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
def test_inlined_calls_stand_at_their_lines(compiler: str) -> None:
    path = meter.link(baselines.emitted_c(EMITTED), BUILDS[compiler])
    text = EMITTED.files["axes_2.c"].splitlines()
    inlined = lines.calls(path, "axes_2_step")
    assert inlined and all(call.low < call.high for call in inlined)
    assert all("axes_2_" in text[call.line - 1] for call in inlined), inlined
    assert lines.calls(path, "no_such_function") == ()


def test_no_step_is_named(stimulus: Steps) -> None:
    with pytest.raises(SignalError, match="found 0 steps, need 1 or more"):
        parts.measure(EMITTED, stimulus.part(slice(0, 0)), meter.builds()[0])
