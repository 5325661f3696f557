"""The opened loops: at rest, the same controller by way of the pose, poles of the whole loop, and their margins."""

from collections.abc import Mapping

import numpy as np
import pytest

from designs.maglev_5dof import control, loops
from designs.maglev_5dof.experiments import WIRES as ACTUATORS
from synth.analyse import discretise, linearise, loop
from synth.block import Block
from synth.compose import compose
from synth.plant import Plant
from synth.signals import names
from tests import tolerances

SENSORS = {s.name: s.of for s in control.INTERFACE.sensors}
INPUTS = [s.name for s in control.INTERFACE.inputs]
OUTPUTS = [s.name for s in control.OUTPUTS]
# axis, gap mm: phase margin in degrees at the fastest crossing, gain margin above 1, peak sensitivity
MARGINS = {
    ("y", 18): (47.4, 2.85, 1.83),
    ("y", 25): (49.6, 2.98, 1.78),
    ("y", 31): (50.4, 3.04, 1.76),
    ("x", 18): (68.2, 11.1, 1.17),
    ("x", 25): (68.2, 11.1, 1.17),
    ("x", 31): (68.2, 11.1, 1.17),
    ("z", 18): (68.2, 11.1, 1.17),
    ("z", 25): (68.2, 11.1, 1.17),
    ("z", 31): (68.2, 11.1, 1.17),
    ("phi", 18): (48.7, 2.84, 2.17),
    ("phi", 25): (50.7, 2.97, 2.38),
    ("phi", 31): (51.5, 3.02, 2.46),
    ("theta", 18): (45.4, 2.58, 1.96),
    ("theta", 25): (47.3, 2.70, 1.89),
    ("theta", 31): (48.1, 2.74, 1.87),
}


def whole(parts: list[Block]) -> Block:
    return compose(control.NAME, parts, inputs=INPUTS, outputs=OUTPUTS)


def level(gap: float) -> dict[str, float]:
    """Return the inputs of a level platen at a gap in m, which is its set-point."""
    return dict.fromkeys(INPUTS, 0.0) | {f"y{j}": gap for j in range(1, 5)} | {"y_ref": gap}


def step(block: Block, state: Mapping[str, float], inputs: Mapping[str, float]) -> tuple[np.ndarray, np.ndarray]:
    x = [state.get(s.name, s.initial) for s in block.states]
    after, outputs = block.function()(x, [inputs[n] for n in names(block.inputs)])
    return np.asarray(after).ravel(), np.asarray(outputs).ravel()


@pytest.fixture(scope="module")
def opened(stage: Plant) -> dict[tuple[str, int], loops.OpenLoop]:
    return {(o.axis, round(o.gap * 1e3)): o for o in loops.all_loops(stage)}


@pytest.mark.parametrize("gap", loops.GAPS)
def test_the_controller_rests_on_the_currents_that_hold_the_platen(stage: Plant, gap: float) -> None:
    """The equilibrium is the controller's too, at the ends of the range as well; init's last currents are none."""
    point, block = loops.holding(stage, gap), whole(list(control.controller(stage).parts))
    rest = dict(loops.resting(point)) | {f"guard_last_y{j}": gap for j in range(1, 5)} | {"guard_last_y_ref": gap}
    after, outputs = step(block, rest, level(gap))
    x = [rest.get(s.name, s.initial) for s in block.states]
    held = [point[s.name] for s in control.CURRENTS]
    np.testing.assert_allclose(outputs[:4], held[:4], rtol=0, atol=tolerances.of("double"))
    assert not outputs[4:].any()
    np.testing.assert_allclose(after, x, rtol=0, atol=tolerances.of("double"))
    lifted = step(block, {"guard_ready": 1.0}, level(gap))[1]
    assert np.abs(lifted[:4] - held[:4]).min() > 1e-3


def test_gaps_by_way_of_the_pose_change_nothing(stage: Plant) -> None:
    """Nor does a warp of the four gaps, which a pose alone would lose."""
    direct, posed = whole(list(control.controller(stage).parts)), whole(loops.posed(stage))
    assert [s.name for s in direct.states] == [s.name for s in posed.states]
    rng = np.random.default_rng(1)
    for _ in range(20):
        gaps = {f"y{j}": 0.025 + w for j, w in enumerate(rng.uniform(-4e-3, 4e-3, 4), 1)}
        inputs = level(0.025) | gaps | {"y_ref": 0.025 + 1e-5}
        state = loops.resting(loops.holding(stage, 0.025))
        for found, expected in zip(step(posed, state, inputs), step(direct, state, inputs), strict=True):
            np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11)
    flat = level(0.025) | {f"y{j}": 0.025 + (-1) ** j * 1e-3 for j in range(1, 5)}
    assert np.abs(step(posed, state, flat)[1] - step(posed, state, level(0.025))[1]).max() > 1e-2


@pytest.mark.parametrize("gap", loops.GAPS)
def test_closing_a_loop_gives_poles_of_the_whole_one(
    stage: Plant, opened: dict[tuple[str, int], loops.OpenLoop], gap: float
) -> None:
    """The whole loop is put together here, from the controller as it ships and the plant under its delay."""
    point = loops.holding(stage, gap)
    block = whole(list(control.controller(stage).parts)).rounded(np.float32)
    K = loop.linearised(block, loops.resting(point), level(gap))
    held = discretise.zero_order_hold(linearise.linearise(stage, point), control.TIME.period_s)
    P = discretise.with_delay(held, 1)
    S = np.array([[float(SENSORS.get(i) == o) for o in P.outputs] for i in K.inputs])
    U = np.array([[float(ACTUATORS[i] == o) for o in K.outputs] for i in P.inputs])
    A = np.block([[P.A + P.B @ U @ K.D @ S @ P.C, P.B @ U @ K.C], [K.B @ S @ P.C, K.A]])
    poles = np.linalg.eigvals(A)
    for axis in control.AXES:
        L = opened[axis.name, round(gap * 1e3)].L
        closed = np.linalg.eigvals(L.A - L.B @ np.linalg.solve(np.eye(1) + L.D, L.C))
        distance = np.abs(closed[:, None] - poles[None, :]).min(axis=1)
        assert distance.max() < tolerances.of("multiple_root"), axis.name
        assert np.abs(closed).max() < 1


def test_margins(opened: dict[tuple[str, int], loops.OpenLoop]) -> None:
    assert opened.keys() == MARGINS.keys()
    for key, (phase, gain, peak) in MARGINS.items():
        found = opened[key].margins
        assert found.stable
        fastest = max(found.gain_crossings, key=lambda c: c.frequency)
        highest = max(found.phase_crossings, key=lambda c: c.frequency)
        assert fastest.phase_margin == pytest.approx(phase, abs=0.06), key
        assert highest.gain_margin == pytest.approx(gain, rel=5e-3), key
        assert found.peak_sensitivity == pytest.approx(peak, abs=6e-3), key


def test_the_compensation_lies_in_the_loop(stage: Plant, opened: dict[tuple[str, int], loops.OpenLoop]) -> None:
    """Cut at the position alone, with the law's gaps left in place, the loop would show another low-frequency gain."""
    parts = loop.cut(list(control.controller(stage).parts), "y")
    block = compose(control.NAME, parts, inputs=[*INPUTS, "y"], outputs=[*OUTPUTS, "y_out"])
    point = loops.holding(stage, 0.025)
    K = loop.linearised(block, loops.resting(point), level(0.025) | {"y": 0.025})
    wires = {i: str(o) for i, o in ACTUATORS.items()}
    partial = loop.opened(linearise.linearise(stage, point), K, "y", SENSORS, wires)
    z = np.exp(1j * np.array([20.0]) * control.TIME.period_s)
    whole_response, part = (np.abs(L.response(z)[0, 0, 0]) for L in (opened["y", 25].L, partial))
    assert abs(whole_response / part - 1) > 0.1
