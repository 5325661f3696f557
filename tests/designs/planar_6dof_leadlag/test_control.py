"""The lead-lag controller: margins with hold, filter and delay, steps, saturation, a failed sensor."""

import numpy as np
import pytest

from designs.planar_6dof import allocation, interface, random_steps
from designs.planar_6dof_leadlag import control, reference
from models import planar_stage
from synth.blocks.guard import safety
from synth.emit import write
from synth.execute import host
from tests import tolerances
from tests.designs.planar_6dof import ideal_loops, ideal_runs

DOUBLE = tolerances.of("double")
PLANT = ideal_loops.PLANT
# axis: crossover in Hz, phase margin in degrees, gain margin, peak sensitivity, with a sample of delay
WITHOUT_FILTER = {"x": (17.34, 65.1, 7.03, 1.26), "y": (17.34, 65.1, 7.03, 1.26), "phi": (30.09, 58.8, 4.00, 1.50)}
BEHIND_FILTER = {"x": (17.70, 10.1, 1.75, 6.21), "y": (17.70, 10.1, 1.75, 6.21), "phi": (39.35, 16.9, 1.50, 4.66)}
SHIPPED = {"x": (10.67, 36.8, 4.39, 2.20), "y": (10.67, 36.8, 4.39, 2.20), "phi": (17.96, 67.6, 3.00, 1.89)}
# axis: height in m or rad, overshoot, rise in s, behind the filter
RESPONSES = {"x": (20e-6, 0.24, 0.019), "y": (1e-4, 0.24, 0.019), "phi": (np.radians(0.01), 0.17, 0.011)}


@pytest.fixture(scope="module")
def c64() -> host.Controller:
    emitted = write.emit(control.controller(PLANT), np.float64)
    return host.load(emitted.files, emitted.manifest)


@pytest.fixture(scope="module")
def known() -> host.Controller:
    return ideal_runs.compile_law(control.law(PLANT), control.TIME, filtered=True)


@pytest.mark.parametrize("axis", allocation.HORIZONTAL)
@pytest.mark.parametrize(
    ("variant", "filtered", "expected"),
    [("published", False, WITHOUT_FILTER), ("published", True, BEHIND_FILTER), ("shipped", True, SHIPPED)],
)
def test_margins(variant: str, filtered: bool, expected: dict[str, tuple[float, ...]], axis: str) -> None:
    # With the vertical loops as shipped: those as printed are unstable, in whatever loop is opened.
    horizontal = control.law(PLANT, variant)[:3]
    law = [*horizontal, *control.law(PLANT)[3:]]
    margins = ideal_loops.margins_of(law, control.TIME, axis, filtered)
    crossover, phase, gain, peak = expected[axis]
    assert margins.stable
    assert margins.gain_crossings[-1].frequency / (2 * np.pi) == pytest.approx(crossover, abs=0.02)
    assert margins.phase_margin == pytest.approx(phase, abs=0.1)
    assert margins.gain_margin == pytest.approx(gain, abs=0.01)
    assert margins.peak_sensitivity == pytest.approx(peak, abs=0.01)


def test_a_second_sample_of_delay_is_seen() -> None:
    late = ideal_loops.margins_of(control.law(PLANT), control.TIME, "phi", True, delay=2)
    assert late.phase_margin < ideal_loops.margins_of(control.law(PLANT), control.TIME, "phi", True).phase_margin - 5


@pytest.mark.parametrize("axis", RESPONSES)
def test_steps_of_the_stage(known: host.Controller, axis: str) -> None:
    """The nonlinear stage behind hold, filter and a sample of delay; the other axes stay where they are."""
    height, beyond, time = RESPONSES[axis]
    run = ideal_runs.run(known, 0.6, {axis: height})
    assert ideal_runs.overshoot(run[axis], height) == pytest.approx(beyond, abs=0.01)
    assert ideal_runs.rise(run[axis], height, control.TIME.period_s) == pytest.approx(time, abs=1e-3)
    assert run[axis][-1] == pytest.approx(height, rel=5e-3)
    others = [np.abs(run[a]).max() for a in allocation.HORIZONTAL if a != axis]
    assert max(others) < 1e-9


def test_a_step_beyond_the_motors_does_not_wind_up() -> None:
    """30 mm in x with the published gain: the motors stand at their limit, and the step does not overshoot."""
    law = [*control.law(PLANT, "published")[:3], *control.law(PLANT)[3:]]
    run = ideal_runs.run(ideal_runs.compile_law(law, control.TIME), 1.5, {"x": 0.03})
    assert np.count_nonzero(random_steps.is_saturated(run.commands)) > 5
    assert ideal_runs.overshoot(run["x"], 0.03) < 1e-3
    assert run["x"][-1] == pytest.approx(0.03, rel=1e-3)


def test_gains_are_those_of_the_reference() -> None:
    for axis, K in control.loops().items():
        k = reference.compensators()[axis]
        np.testing.assert_allclose([K.gain, *K.zeros], [k.D, k.z1, k.z2], rtol=DOUBLE)
        assert K.poles == pytest.approx((k.p, 1.0), abs=DOUBLE)


def test_a_bad_measurement_for_long_takes_the_currents_to_zero(c64: host.Controller) -> None:
    n = 40
    inputs = {g.signal.name: np.zeros(n) for g in interface.INPUTS}
    inputs |= {name: np.full(n, v) for name, v in ideal_runs.at_rest().items()} | {"x_ref": np.full(n, 1e-4)}
    rng = np.random.default_rng(0)
    inputs |= {name: inputs[name] + rng.normal(0, 1e-4, n) for name in planar_stage.HALL}  # no code repeats
    inputs["d1"][10:] = np.nan
    got = c64.replay(inputs)
    latched = got.faults >> safety.LATCH_BIT > 0
    assert latched.argmax() == 10 + interface.BAD_SAMPLES - 1 + interface.BRAKING
    size = np.max([np.abs(got.outputs[s.name]) for s in interface.OUTPUTS], axis=0)
    assert size[latched.argmax() - 1] > 1e-3 and not size[-1]
    assert (np.diff(size[latched]) <= 0).all()
