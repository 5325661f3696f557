"""The cores alone: certified by the library, the same as its compensators, and what a step costs."""

import numpy as np
import pytest

from designs.planar_6dof import lqg
from designs.planar_6dof.allocation import HORIZONTAL
from designs.planar_6dof_lqg import core
from designs.planar_6dof_lqg.core import Order
from synth.analyse.loops import loop
from synth.block import unranged
from synth.emit import write
from synth.execute import host
from synth.verify import meter, steps
from tests import ceilings, tolerances


def test_the_loop_separates_and_is_as_slow_as_the_regulator() -> None:
    compensator = core.compensator()
    assert compensator.separation < tolerances.of("double")
    assert np.abs(compensator.poles).max() == pytest.approx(0.94863, abs=1e-5)
    np.testing.assert_allclose(sorted(compensator.observer.poles.real), sorted(lqg.OBSERVER_POLE.values()), rtol=1e-12)


def test_the_reduced_core_is_the_librarys_compensator() -> None:
    linear = loop.linearise_block(core.block("reduced"), {}, dict.fromkeys(HORIZONTAL, 0.0))
    z = np.exp(1j * np.geomspace(1e-3, np.pi, 30))
    np.testing.assert_allclose(linear.response(z), core.compensator().model.response(z), rtol=1e-9, atol=1e-9)


def test_the_full_core_regulates_the_plant_with_the_estimators_poles() -> None:
    held = lqg.discretise.zero_order_hold(lqg.model(integrals=False), lqg.TIME.period_s)
    K = loop.linearise_block(core.block("full"), {}, dict.fromkeys(HORIZONTAL, 0.0))
    poles = np.linalg.eigvals(np.block([[held.A, held.B @ K.C], [K.B @ held.C, K.A]]))
    assert not K.D.any()
    assert np.abs(poles).max() < 0.96
    for pole in core.estimator().poles:
        assert np.abs(poles - pole).min() < tolerances.of("multiple_root")


@pytest.mark.parametrize(("order", "build"), ceilings.builds(*core.ORDERS))
def test_what_a_step_costs(order: Order, build: meter.Build) -> None:
    """By gcc -O2 as long as no integral is at its limit, by gcc -Os always."""
    ceiling = ceilings.of(order, build)
    emitted = write.emit(unranged(core.block(order)), np.float32)
    controller = host.load(emitted.files, emitted.manifest)
    errors = {axis: 1e-6 * np.sin(np.arange(50) + i) for i, axis in enumerate(HORIZONTAL)}
    small = steps.record(controller, "small", errors, closed_loop=True)
    stimulus = steps.random_steps(controller, 1000) if build.name == ceilings.OS else small
    assert meter.run(meter.emitted_source(emitted), stimulus, build).cost.instructions.max() <= ceiling
