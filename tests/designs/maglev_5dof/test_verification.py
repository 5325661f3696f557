"""The witnesses agree to the stated limits, and a planted defect in the C, a gain or the physics parts them."""

import numpy as np
import pytest

from designs.maglev import reference_stage, verification
from designs.maglev_5dof import control, reference
from designs.maglev_5dof.design import DESIGN
from designs.maglev_5dof.verification import law_states
from models import maglev_stage
from synth.block import Block
from synth.execute import host
from synth.plant import Plant
from synth.verify import agree, sampling, suite
from synth.verify.suite import Evidence
from tests.designs.maglev_5dof import full_plant


@pytest.mark.whole
def test_every_check_passes(evidence: Evidence) -> None:
    assert [c for c in evidence.checks if not c.passed] == []
    by = {(a.what, a.first): a for a in evidence.agreements}
    assert by["random steps", "reference"].samples == 100_000
    assert by["replay of 60 s", "reference"].samples == 60_000
    assert {first for _, first in by} == {"reference", "casadi", "casadi_c", "c64"}
    assert evidence.document()["passed"] is True


Steps = tuple[verification.Columns, verification.Columns]


@pytest.fixture(scope="module")
def random_steps(stage: Plant) -> Steps:
    """Random steps of the domain, then as many edge steps: bad inputs, limits, latched states."""
    block = control.with_fault_handling(stage).block
    rng = np.random.default_rng(verification.SEED + 1)
    random = verification.random_steps(block, reference.with_fault_handling, law_states, 2000)
    edge = sampling.edge_steps(block, rng, 2000)
    joined = [{n: np.concatenate([a[n], b[n]]) for n in a} for a, b in zip(random, edge, strict=True)]
    return joined[0], joined[1]


def _worst(controller: host.Controller, random_steps: Steps) -> agree.Agreement:
    expected = agree.reference(reference.with_fault_handling)(*random_steps)
    block, stepped = DESIGN.controller.block, agree.emitted_c(controller)(*random_steps)
    return agree.compare("planted", ("reference", expected), ("c64", stepped), verification.EDGE_FLOOR, block)


def test_most_random_steps_are_near_operation(stage: Plant) -> None:
    """Far from a limit, not latched, few suspects, the last currents those of a platen at rest: the law is compared."""
    block = control.with_fault_handling(stage).block
    states, inputs = verification.random_steps(block, reference.with_fault_handling, law_states, 5000)
    after, outputs, faults = reference.with_fault_handling(states, inputs)
    assert 0.01 < np.mean(faults > 0) < 0.1 and not np.any(faults >> 31)
    assert set(states) == {s.name for s in block.states}
    assert 0.01 < np.mean(verification.is_saturated(outputs)) < 0.2
    held = verification.holding_current(np.array([0.018, 0.025, 0.031]))
    np.testing.assert_allclose(held[1], 0.67864, atol=1e-5)
    near = np.abs(states["safe_output_last_i_d1"] - verification.holding_current(inputs["y1"]))
    assert near.max() <= 0.5 and {1, 20} <= set(states["guard_left"])
    assert all(np.std(after[n]) > 0 for n in after if n not in ("guard_latched", "guard_left", "guard_ready"))


def _disagrees(agreement: agree.Agreement) -> bool:
    return max(agreement.worst, agreement.state_worst) > 1e3 * suite.DOUBLE_TOLERANCE or agreement.faults_differ > 0


def _compiled(block: Block) -> host.Controller:
    """Return the C of a defective Block with functions of libm: other constants need polynomials of their own."""
    return host.compile_block(block, np.float64, libm=True)


def test_the_sound_c_agrees(double: host.Controller, random_steps: Steps) -> None:
    worst = _worst(double, random_steps)
    assert max(worst.worst, worst.state_worst) <= suite.DOUBLE_TOLERANCE and worst.faults_differ == 0


def test_with_functions_of_libm_the_sound_c_agrees(stage: Plant, random_steps: Steps) -> None:
    assert not _disagrees(_worst(_compiled(control.with_fault_handling(stage).block), random_steps))


def test_the_plant_agrees_with_the_reference_plant() -> None:
    """F(5)-(7) in CasADi against the same in NumPy, over the box of states and currents."""
    plant, rng = maglev_stage.plant(), np.random.default_rng(1)
    x = np.array([rng.uniform(s.low, s.high, 500) for s in plant.states])
    u = np.array([rng.uniform(s.low, s.high, 500) for s in plant.inputs])
    derivative = np.asarray(plant.f(x, u, np.tile(plant.values[:, None], 500)))
    currents = np.array([*u[:4], u[5], u[4], u[5], u[4]])
    expected = full_plant.plant(x, currents, reference_stage.Parameters())
    np.testing.assert_allclose(derivative, expected, rtol=1e-9, atol=1e-9)
    turned = full_plant.plant(x, -currents, reference_stage.Parameters())
    assert np.abs(derivative - turned).max() > 1.0
