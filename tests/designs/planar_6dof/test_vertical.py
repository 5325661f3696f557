"""Heights from distances, and compensators in parts: the same transfer, no windup, and margins with a delay."""

from fractions import Fraction

import numpy as np
import pytest

from designs.planar_6dof import allocation, lqg, reference_control, vertical
from designs.planar_6dof_leadlag import control as leadlag
from models import planar_stage
from synth.analyse.loops import loop
from synth.block import unranged
from synth.composition import compose
from synth.emit import write
from synth.execute import host
from synth.signals import signal_names
from synth.synthesise.classical import lead_lag
from synth.timing import Discrete
from synth.verify import agree
from tests import tolerances
from tests.designs.planar_6dof import ideal_loops

DOUBLE = tolerances.of("double")
PLANT = ideal_loops.PLANT
RATES = (Discrete(1e-3), Discrete(1 / 800))


def test_heights_undo_the_lasers() -> None:
    rng = np.random.default_rng(0)
    pose = {a: rng.uniform(s.low, s.high, 100) for a, s in allocation.BOX.items() if a in allocation.AXES}
    x = np.zeros((len(PLANT.states), 100))
    x[:6] = [pose[a] for a in signal_names(PLANT.states)[:6]]
    y = np.asarray(PLANT.h.map(100)(x, np.zeros((9, 100)), np.tile(PLANT.values[:, None], 100)))
    distances = dict(zip(signal_names(PLANT.outputs), y, strict=True))
    held = {f"{d}_held": distances[d] for d in planar_stage.LASERS}
    outputs = agree.casadi(vertical.vertical_kinematics(PLANT, RATES[0]))({}, held).outputs
    other = reference_control.vertical_kinematics(distances)
    for axis in allocation.VERTICAL:
        for seen in (outputs[axis], other[axis]):
            np.testing.assert_allclose(seen, pose[axis], rtol=0, atol=1e-3 * DOUBLE)


def every_loop(time: Discrete) -> list[tuple[str, lead_lag.LeadLag]]:
    horizontal = vertical.sampled({a: leadlag.compensator(a) for a in allocation.HORIZONTAL}, time)
    return [*vertical.loops(time).items(), *vertical.loops(time, "published").items(), *horizontal.items()]


@pytest.mark.parametrize("time", RATES)
def test_the_parts_are_the_sampled_compensator(time: Discrete) -> None:
    """With what is made wired to what is demanded, a loop has the response of `lead_lag`'s model."""
    z = np.exp(1j * np.geomspace(1e-3, np.pi, 40))
    for axis, K in every_loop(time):
        demand, achieved = vertical.DEMAND[axis], vertical.ACHIEVED_DEMAND[axis]
        unlimited = ideal_loops.renaming_blocks(time, {achieved.name: demand.name}, demand.unit)
        block = vertical.block(PLANT, axis, K, time)
        inputs = [s.name for s in block.inputs if s.name != achieved.name]
        whole = compose("whole", [block, *unlimited], inputs=inputs, outputs=[demand.name])
        model = loop.linearise_block(whole, {}, dict.fromkeys(inputs, 0.0))
        response = model.channel(demand.name, vertical.REFERENCES[axis].name).response(z)
        response = allocation.scales(PLANT)[axis] * response
        np.testing.assert_allclose(response, K.discrete.response(z), rtol=1e-9)  # z - 1 is 1e-3 at the least


@pytest.mark.parametrize("time", RATES)
def test_shipped_compensators_are_those_of_the_reference(time: Discrete) -> None:
    for axis in allocation.VERTICAL:
        K = vertical.loops(time)[axis]
        other = reference_control.vertical(axis, Fraction(1, round(1 / time.period_s)))
        np.testing.assert_allclose([K.gain, *K.zeros], [other.D, other.z1, other.z2], rtol=DOUBLE)
        constants = {c.name: c.value for c in vertical.block(PLANT, axis, K, time).constants}
        lead_input = -other.D * other.z1 / allocation.scales(PLANT)[axis]
        assert constants["lead_input"] == pytest.approx(lead_input, rel=DOUBLE)
        assert "lead_pole" not in constants and other.p == 0


def test_an_integral_goes_to_what_the_motors_make_and_back() -> None:
    """A set-point out of reach for a second leaves the integral where the motors are, not beyond."""
    time, axis = RATES[0], "z"
    block = vertical.block(PLANT, axis, vertical.loops(time)[axis], time)
    emitted = write.emit(unranged(block), np.float64)
    controller, n, limit = host.load(emitted.files, emitted.manifest), 1000, 5.0 / allocation.scales(PLANT)[axis]
    state, made, seen = controller.init(), 0.0, []
    for k in range(2 * n):
        error = 2e-4 if k < n else -2e-6
        out = controller.step(state, {"z": -error, "z_ref_held": 0.0, "achieved_z": made}).outputs
        made = float(np.clip(out["d_z"], -limit, limit))
        seen.append((float(state["integral"]), float(out["d_z"])))
    integral, demand = np.array(seen).T
    assert demand[n - 1] > 2 * limit and integral.max() <= limit
    assert integral[n - 1] == pytest.approx(limit, rel=1e-3)  # exp(-10)
    assert demand[n] < limit  # the first sample of a small error of the other sign is out of the limit


# axis: phase margin in degrees, gain margin, peak sensitivity, at 1 kHz and at 800 Hz, with a sample of delay
MARGINS = {
    "z": ((37.1, 4.12, 1.67), (31.4, 3.16, 1.98)),
    "theta": ((40.4, 3.63, 1.69), (32.7, 2.76, 2.06)),
    "psi": ((38.9, 4.80, 1.67), (30.4, 3.51, 2.09)),
}


@pytest.mark.parametrize("axis", MARGINS)
def test_margins_as_shipped(axis: str) -> None:
    laws = ((leadlag.law(PLANT), leadlag.TIME), (lqg.law(PLANT), lqg.TIME))
    for (law, time), (phase, gain, peak) in zip(laws, MARGINS[axis], strict=True):
        margins = ideal_loops.margins_of(law, time, axis, filtered=False)
        assert margins.stable
        assert margins.phase_margin == pytest.approx(phase, abs=0.1)
        assert margins.gain_margin == pytest.approx(gain, abs=0.01)
        assert margins.peak_sensitivity == pytest.approx(peak, abs=0.01)


def test_as_printed_psi_is_unstable_with_a_sample_of_delay_and_theta_almost() -> None:
    laws = ((leadlag.law(PLANT, "published"), leadlag.TIME), (lqg.law(PLANT, variant="published"), lqg.TIME))
    for (law, time), peak in zip(laws, (6.58, 38.5), strict=True):
        psi = ideal_loops.margins_of(law, time, "psi", filtered=False)
        assert not psi.stable and 0 < psi.gain_reduction_margin < 0.5
        theta = ideal_loops.margins_of(law, time, "theta", filtered=False)
        assert theta.peak_sensitivity == pytest.approx(peak, rel=1e-2)
        assert ideal_loops.margins_of(law, time, "psi", filtered=False, delay=0).stable
