"""The tests of a design, for pytest: what is committed, the evidence, and planted defects that the evidence must find.

    from designs.levitator.design import DESIGN
    from synth.testing import *

    @pytest.fixture(scope="session")
    def design() -> Stage:
        return DESIGN

Run in the root of the workspace. Defects are planted in a declared stage: the sign of each constant, slews, limits,
accepted ranges and the number of bad samples. A constant whose sign changes nothing, since the law squares it, is
doubled instead. CasADi's evaluation of the defective controller is compared with the reference.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from synth import stage as stages
from synth.app import builds, standard_tasks
from synth.app.tasks import attempt
from synth.base.progress import silent
from synth.block import Block
from synth.declare.stage import Controller, Interface, Stage
from synth.execute import compile as host_compiler
from synth.execute import host
from synth.verify import agree, sampling, standard, steps, stimuli, suite
from synth.verify.suite import Evidence

__all__ = [
    "test_defects_that_are_planted_are_found",
    "test_the_c_compiles_without_a_warning",
    "test_the_committed_files_are_regenerated_byte_for_byte",
    "test_the_evidence_passes",
    "undetected_defects",
    "variants",
]

STEPS = 2000  # random ones, and as many edge steps
NOTICED = 1e3  # times the tolerance between witnesses
WIDER = 1.1  # a planted limit or range, of the declared one


def test_the_committed_files_are_regenerated_byte_for_byte(design: Stage) -> None:
    """Compare generated_c/ with the emitted files; vectors are recorded and may differ in the last place."""
    for folder, emitted in standard_tasks.emit(design, design.scalar).items():
        committed = Path("generated_c") / folder
        assert committed.is_dir(), f"{committed} is missing: run `synth build {design.name}` and commit it"
        for name, text in emitted.files.items():
            same = name == "vectors.json" or (committed / name).read_text(encoding="utf-8") == text
            assert same, f"{committed / name} is stale: run `synth build {design.name}` and commit it"


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_the_c_compiles_without_a_warning(design: Stage, scalar: type[np.floating]) -> None:
    """Compile the C of both scalar types with every warning on."""
    for emitted in standard_tasks.emit(design, scalar).values():
        host_compiler.check(host.code(emitted.files))


def test_the_evidence_passes(design: Stage) -> None:
    """Verify the design over short replays, as `synth build` does: with the same sources, its evidence is read."""
    evidence, _ = attempt(partial(builds.verify, design, False, silent), "verification", Evidence(design.name, (), ()))
    assert evidence.checks
    failed = [f"{c.name}: {c.value:g}, allowed {c.limit:g} {c.unit} {c.about}" for c in evidence.checks if not c.passed]
    assert not failed, "\n".join(failed)


def test_defects_that_are_planted_are_found(design: Stage) -> None:
    """Compare variants of the controller, each with one defect, with the reference."""
    undetected = undetected_defects(design)
    assert not undetected, (
        f"the reference agrees with a controller that has a planted defect: {', '.join(undetected)}; write the "
        "reference from the equations, or leave out what has no effect on any output or state"
    )


def undetected_defects(stage: Stage) -> list[str]:
    """Return the planted defects that the comparison with the reference does not detect."""
    states, inputs = _steps(stage)
    assert stage.reference is not None
    block = stage.controller.block
    expected = agree.reference(stage.reference, block)(states, inputs)
    of_constants = agree.casadi_of_constants(block)
    correct = of_constants({})(states, inputs)

    def agrees(name: str, variant: Block, witness: agree.StepResults, tolerance: float) -> bool:
        same = variant.next is block.next and variant.output is block.output
        constants = {c.name: c.value for c in variant.constants}
        observed = (of_constants(constants) if same else agree.casadi(variant))(states, inputs)
        gap = agree.compare(name, ("witness", witness), ("casadi", observed), None, block)
        return max(gap.worst, gap.state_worst) <= tolerance and not gap.faults_differ

    undetected = [(n, v) for n, v in variants(stage) if agrees(n, v, expected, NOTICED * suite.DOUBLE_TOLERANCE)]
    signs = {f"sign of {c.name}": c.name for c in block.constants}
    even = [signs[name] for name, v in undetected if name in signs and agrees(name, v, correct, 0.0)]
    doubled = [(f"{name} doubled", _with_constant(block, name, 2.0)) for name in even]
    remaining = [name for name, _ in undetected if signs.get(name) not in even]
    return [*remaining, *(n for n, v in doubled if agrees(n, v, expected, NOTICED * suite.DOUBLE_TOLERANCE))]


def _steps(stage: Stage) -> tuple[sampling.Columns, sampling.Columns]:
    """Return random and edge steps, and those of a closed loop up to the latch and of latches from the limits."""
    rig, block = standard_tasks.rig(stage, np.float64), stage.controller.block
    loop = steps.record(rig.controller, "", stimuli.closed_loop(rig, stimuli.VECTOR_STEPS).measured)
    recorded = steps.concatenate("", [loop, *stimuli.latches(rig.controller, stimuli.SEED)])
    rng = np.random.default_rng(standard.SEED)
    random_steps = [sampling.operating_steps(block, rng, STEPS, loop), sampling.edge_steps(block, rng, STEPS)]
    x = {s.name: recorded.states[s.name].astype(np.float64) for s in block.states}
    u = {s.name: recorded.inputs[s.name].astype(np.float64) for s in block.inputs}
    parts = [*random_steps, (x, u)]
    return tuple({n: np.concatenate([part[i][n] for part in parts]) for n in parts[0][i]} for i in (0, 1))  # type: ignore[return-value]


def variants(stage: Stage) -> Iterator[tuple[str, Block]]:
    """Yield (defect, controller), one defect each."""
    made, block = stage.controller, stage.controller.block
    for constant in block.constants:
        yield f"sign of {constant.name}", _with_constant(block, constant.name, -1.0)
    outputs = [s.name for s in block.outputs]
    for name, interface in _interfaces(made):
        yield name, stages.controller(made.name, made.time, interface, made.laws, outputs).block


def _with_constant(block: Block, name: str, factor: float) -> Block:
    """Return the Block with one constant multiplied by a factor."""
    changed = (replace(c, value=factor * c.value) if c.name == name else c for c in block.constants)
    return replace(block, constants=tuple(changed))


def _interfaces(controller: Controller) -> Iterator[tuple[str, Interface]]:
    interface, driven = (
        controller.interface,
        {s.name for law in controller.laws for block in law.blocks for s in block.outputs},
    )
    yield "bad_samples", replace(interface, bad_samples=interface.bad_samples + 1)
    for k, a in enumerate(interface.actuators):
        others = interface.actuators[:k], interface.actuators[k + 1 :]
        faster = (*others[0], replace(a, slew_per_s=2 * a.slew_per_s), *others[1])
        yield f"slew of {a.name} doubled", replace(interface, actuators=faster)
    limited = [s for s in interface.outputs if f"{s.name}_demand" in driven]  # the laws limit the others
    for s in (*limited, *interface.inputs):
        wider = replace(s, high=s.high + (WIDER - 1) * (s.high - s.low))
        if s is interface.missed_calls:
            yield "missed_calls", replace(interface, missed_calls=wider)
        else:
            yield f"range of {s.name} wider", replace(interface, signals={**interface.signals, s.name: wider})
