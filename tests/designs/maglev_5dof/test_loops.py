"""The open loops: at rest on the currents that hold the platen, with poles of the whole loop, and their margins."""

import numpy as np
import pytest

from designs.maglev import platen
from designs.maglev.platen import WIRES
from designs.maglev_5dof import control
from designs.maglev_5dof.design import DESIGN
from synth.analyse import discretise, operating_points
from synth.analyse.loops import loop, robustness
from synth.composition import compose
from synth.plant import Plant
from tests import tolerances

OpenLoops = dict[tuple[str, int], robustness.OpenLoop]
GAPS = (18, 25, 31)  # mm
CUT = [*(s.name for s in platen.OUTPUTS), "y_out"]
# axis, gap mm: phase margin in degrees at the fastest crossing, gain margin above 1, peak sensitivity
MARGINS = {
    ("y", 18): (47.5, 2.85, 1.83),
    ("y", 25): (49.6, 2.98, 1.78),
    ("y", 31): (50.4, 3.04, 1.76),
    ("x", 18): (68.2, 11.1, 1.17),
    ("x", 25): (68.2, 11.1, 1.17),
    ("x", 31): (68.2, 11.1, 1.17),
    ("z", 18): (68.2, 11.1, 1.17),
    ("z", 25): (68.2, 11.1, 1.17),
    ("z", 31): (68.2, 11.1, 1.17),
    ("phi", 18): (48.8, 2.84, 2.17),
    ("phi", 25): (50.7, 2.97, 2.38),
    ("phi", 31): (51.5, 3.02, 2.46),
    ("theta", 18): (45.5, 2.58, 1.96),
    ("theta", 25): (47.3, 2.70, 1.89),
    ("theta", 31): (48.1, 2.74, 1.87),
}


@pytest.fixture(scope="module")
def loops() -> robustness.Loops:
    return robustness.of_stage(DESIGN)


@pytest.fixture(scope="module")
def open_loops(loops: robustness.Loops) -> OpenLoops:
    return {(o.signal, int(o.point.removesuffix(" mm"))): o for o in robustness.open_loops(loops)}


@pytest.mark.parametrize("gap", GAPS)
def test_the_controller_rests_on_the_currents_that_hold_the_platen(
    stage: Plant, loops: robustness.Loops, gap: int
) -> None:
    """The equilibrium is the controller's too, at the ends of the set-points as well; init's last currents are none."""
    held = DESIGN.operating_points[f"{gap} mm"]
    point, rest = operating_points.trim(stage, held, list(WIRES)), robustness.equilibrium_at(loops, f"{gap} mm")
    for s in platen.CURRENTS:
        assert rest.state[f"safe_output_last_{s.name}"] == pytest.approx(point[s.name], abs=1e-6)
    assert abs(point["i_d1"] - platen.SAFE_CURRENT) > 1e-3
    assert rest.inputs["y1"] == pytest.approx(held["y"], abs=1e-9)


@pytest.mark.parametrize("gap", GAPS)
def test_closing_a_loop_gives_poles_of_the_whole_one(loops: robustness.Loops, open_loops: OpenLoops, gap: int) -> None:
    """The whole loop is put together here, from the controller as it ships and the plant under its delay."""
    rest = robustness.equilibrium_at(loops, f"{gap} mm")
    K, sensors = rest.controller, {s.name: s.of for s in platen.INTERFACE.sensors}
    P = discretise.delay_samples(discretise.zero_order_hold(rest.plant, platen.TIME.period_s), 1)
    S = np.array([[float(sensors.get(i) == o) for o in P.outputs] for i in K.inputs])
    U = np.array([[float(WIRES[i] == o) for o in K.outputs] for i in P.inputs])
    A = np.block([[P.A + P.B @ U @ K.D @ S @ P.C, P.B @ U @ K.C], [K.B @ S @ P.C, K.A]])
    poles = np.linalg.eigvals(A)
    for axis in control.AXES:
        L = open_loops[axis.name, gap].L
        closed = np.linalg.eigvals(L.A - L.B @ np.linalg.solve(np.eye(1) + L.D, L.C))
        distance = np.abs(closed[:, None] - poles[None, :]).min(axis=1)
        assert distance.max() < tolerances.of("multiple_root"), axis.name
        assert np.abs(closed).max() < 1


def test_margins(open_loops: OpenLoops) -> None:
    assert open_loops.keys() == MARGINS.keys()
    for key, (phase, gain, peak) in MARGINS.items():
        margins = open_loops[key].margins
        assert margins.stable
        fastest = max(margins.gain_crossings, key=lambda c: c.frequency)
        highest = max(margins.phase_crossings, key=lambda c: c.frequency)
        assert fastest.phase_margin == pytest.approx(phase, abs=0.06), key
        assert highest.gain_margin == pytest.approx(gain, rel=5e-3), key
        assert margins.peak_sensitivity == pytest.approx(peak, abs=6e-3), key


def test_the_compensation_lies_in_the_loop(loops: robustness.Loops, open_loops: OpenLoops) -> None:
    """Cut at the position alone, with the law's gaps left in place, the loop would show another low-frequency gain."""
    rest, of = robustness.equilibrium_at(loops, "25 mm"), loops.closed
    block = compose("cut", loop.cut(DESIGN.controller.parts, "y"), inputs=[*rest.inputs, "y"], outputs=CUT)
    K = loop.linearise_block(block, rest.state, {**rest.inputs, "y": 0.025})
    partial = loop.open_loop(rest.plant, K, "y", of.sensors, of.actuators)
    z = np.exp(1j * np.array([20.0]) * platen.TIME.period_s)
    whole, part = (np.abs(L.response(z)[0, 0, 0]) for L in (open_loops["y", 25].L, partial))
    assert abs(whole / part - 1) > 0.1
