"""`hall_source` between estimate and regulators: only valid estimates pass; others are predicted and counted."""

from functools import cache

import numpy as np
import pytest

from designs.hall_position import config
from designs.planar_6dof import allocation, lqg
from designs.planar_6dof.sensing import sections as sensing
from models import planar_stage
from studies.hall.loop import closed_loop
from synth.block import unranged
from synth.emit import write
from synth.errors import ModelError
from synth.execute import host
from synth.signals import signal_names

pytestmark = pytest.mark.whole

TIME = lqg.TIME
N = 60
FIRST = 10  # the first valid sample
SPEED = 1e-4  # m a sample

Columns = dict[str, np.ndarray]


@cache
def emit_source() -> write.EmittedCode:
    return write.emit(unranged(closed_loop._source(TIME, "")), np.float64)


def answers(changed: Columns | None = None, old: str = "", new: str = "") -> Columns:
    """Return what ``hall_source`` makes of a steady motion that is valid from FIRST on, `old` in its C being `new`."""
    source, k = emit_source(), np.arange(N)
    text = source.files["hall_source.c"]
    assert old in text
    inputs: Columns = {"X": SPEED * k, "Y": -SPEED * k, "yaw": np.full(N, 2e-3), "valid": k >= FIRST}
    inputs |= {"lock_lost": np.zeros(N), "x_ref_held": np.full(N, 0.02)}
    inputs |= {"y_ref_held": np.full(N, -0.01), "phi_ref_held": np.zeros(N)}
    inputs |= changed or {}
    controller = host.load({**source.files, "hall_source.c": text.replace(old, new)}, source.manifest)
    return controller.replay({name: np.asarray(v, float) for name, v in inputs.items()}).outputs


def dropout(first: int, count: int) -> Columns:
    """Return flags that are not valid in some samples, and estimates that are nonsense there."""
    k = np.arange(N)
    bad = (k >= first) & (k < first + count)
    return {"valid": (k >= FIRST) & ~bad, "X": np.where(bad, 0.09, SPEED * k)}


def test_a_valid_estimate_is_the_position_and_until_then_the_set_point_is() -> None:
    outputs, k = answers(), np.arange(N)
    np.testing.assert_array_equal(outputs["x_raw"], np.where(k < FIRST, 0.02, SPEED * k))
    np.testing.assert_array_equal(outputs["y_raw"], np.where(k < FIRST, -0.01, -SPEED * k))
    np.testing.assert_array_equal(outputs["known"], k > FIRST)
    assert not outputs["suspected"].any()


def test_an_invalid_estimate_is_replaced_by_the_prediction() -> None:
    k = np.arange(N)
    outputs = answers(dropout(50, 4))["x_raw"]
    assert np.abs(outputs - SPEED * k)[50:54].max() < 0.2 * SPEED  # the motion is known to 2 % after 40 samples
    at_rest = answers({**dropout(50, 4), "X": np.where(k < 50, 0.0, 0.09)})["x_raw"]
    assert np.abs(at_rest[50:54]).max() == 0
    assert at_rest[54] == 0.09


def test_consecutive_invalid_samples_raise_the_suspicion_and_a_valid_one_resets_the_count() -> None:
    lost = closed_loop.MAX_INVALID
    for count, suspected in ((lost - 1, False), (lost, True)):
        outputs = answers(dropout(30, count))
        assert outputs["suspected"].any() == suspected
    outputs = answers(dropout(30, N))
    assert np.argmax(outputs["suspected"]) == 30 + lost + 1
    assert all(outputs[f"suspect_{name}"][-1] for name in planar_stage.HALL)
    twice = {"valid": (np.arange(N) >= FIRST) & (np.arange(N) % 6 != 0)}
    assert not answers(twice)["suspected"].any()


def test_a_search_at_the_beginning_is_no_failure() -> None:
    assert not answers({"valid": np.zeros(N)})["suspected"].any()


def test_an_estimate_without_position_lock_is_not_used() -> None:
    k = np.arange(N)
    outputs = answers({"lock_lost": k >= 30, "X": np.where(k >= 30, 0.09, SPEED * k)})
    assert np.abs(outputs["x_raw"] - SPEED * k)[30:36].max() < SPEED
    assert np.argmax(outputs["suspected"]) == 30 + closed_loop.MAX_INVALID + 1
    assert not answers({"lock_lost": np.ones(N)})["known"].any()


@pytest.mark.parametrize("elsewhere", [{"X": np.full(N, 0.0455)}, {"Y": np.full(N, -0.03)}, {"yaw": np.full(N, 1.57)}])
def test_a_position_starts_in_the_middle_pitch_at_a_small_yaw(elsewhere: Columns) -> None:
    outputs = answers(elsewhere)
    assert not outputs["known"].any() and np.all(outputs["x_raw"] == 0.02)


def test_places_within_the_pitch_are_those_of_the_position() -> None:
    at = np.concatenate([[0.0], np.linspace(-0.159, 0.159, N - 1)])
    outputs = answers({"X": at, "valid": np.ones(N)})
    np.testing.assert_array_equal(outputs["x_raw"], at)
    pitches = (outputs["x_raw"] - outputs["within_x"]) / allocation.PITCH
    np.testing.assert_allclose(pitches, np.rint(pitches), atol=1e-12)
    assert np.abs(outputs["within_x"]).max() <= allocation.PITCH / 2


def test_the_planar_controllers_law_is_unchanged_except_for_its_ready_input() -> None:
    plant = planar_stage.plant()
    blocks = lqg.law(plant)
    *changed, gate = closed_loop.gate_currents(blocks, TIME)
    ready, known = sensing.READY.name, closed_loop.KNOWN.name
    other = {b.name for b, c in zip(blocks, changed, strict=True) if signal_names(b.inputs) != signal_names(c.inputs)}
    assert other == {"lqg_x", "lqg_y", "lqg_phi"}
    assert all(known in c.symbol and ready not in c.symbol for c in changed if c.name in other)
    assert gate.name == "known_gate" and signal_names(gate.outputs) == signal_names(allocation.COMPUTED)


def test_a_source_takes_three_sensors() -> None:
    with pytest.raises(ModelError, match="2 sensors: the stage reads 3"):
        closed_loop.controller(lqg.NAME, planar_stage.plant(), TIME, [], closed_loop.Source(config.array()))
