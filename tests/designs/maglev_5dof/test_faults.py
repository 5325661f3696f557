"""Any bit pattern on the inputs: outputs finite and within limits, the right fault bits, recovery or the latch."""

import platform
from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from designs.maglev import motions, platen
from designs.maglev.fault_handling import DEGRADED, MISSED_CALLS
from designs.maglev_5dof import control
from designs.maglev_5dof.design import DESIGN
from synth import stage as stages
from synth.emit import write
from synth.execute import host
from synth.plant import Plant
from synth.simulate.rig import Rig
from synth.simulate.scenario import Override, Trajectory, sample_times

INPUTS = stages.guarded_inputs(platen.INTERFACE)
NAMES = [g.signal.name for g in INPUTS]
MEASURED = [g.signal.name for g in INPUTS if g.measurement]
SAFETY = DESIGN.controller.block.safety
LATCHED = 1 << 31
NONE_MISSED = {"missed_calls": 0.0}
BAD = (np.nan, np.inf, -np.inf, 1e30, -1e30, 5e-324, -1.0)
LIMIT = 4.950


def bits(values: list[int]) -> np.ndarray:
    return np.array(values, dtype=np.uint32).view(np.float32)


def require_sound(replay: host.Replay, state_manifest: list[dict]) -> None:
    outputs = {n: v.astype(float) for n, v in replay.outputs.items()}
    for j in range(1, 5):
        current = np.hypot(outputs[f"i_d{j}"], outputs[f"i_q{j}"])
        assert np.isfinite(current).all() and current.max() <= LIMIT
    for member in state_manifest:
        value = float(replay.state[member["name"]])
        assert member["low"] <= value <= member["high"], member["name"]


@settings(max_examples=150, deadline=None, derandomize=True)
@given(st.data())
def test_any_bits_for_ever(single: host.Controller, data: st.DataObject) -> None:
    """Random words on every input, any sequence: nothing escapes, every state stays in its bounds."""
    n = 40
    seed = data.draw(st.integers(0, 2**32 - 1))
    rng = np.random.default_rng(seed)
    words = {name: bits(rng.integers(0, 2**32, n, dtype=np.uint64).tolist()) for name in (*NAMES, *NONE_MISSED)}
    for name in data.draw(st.sets(st.sampled_from(NAMES))):
        signal = next(g.signal for g in INPUTS if g.signal.name == name)
        words[name] = rng.uniform(signal.low, signal.high, n).astype(np.float32)
    replay = single.replay(words)
    require_sound(replay, single.manifest["structs"]["state"]["fields"])
    for i, g in enumerate(INPUTS):
        low, high = np.float32(g.signal.low), np.float32(g.signal.high)
        with np.errstate(invalid="ignore"):
            good = (words[g.signal.name] >= low) & (words[g.signal.name] <= high)
        np.testing.assert_array_equal((replay.faults >> i) & 1, ~good)
    with np.errstate(invalid="ignore"):
        tolerated = (words["missed_calls"] >= 0) & (words["missed_calls"] <= MISSED_CALLS)
    np.testing.assert_array_equal((replay.faults >> DEGRADED.bit + 1) & 1, ~tolerated)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("bad", BAD)
def test_one_bad_sample_is_held_and_flagged_and_the_loop_recovers(emitted_rig: Rig, name: str, bad: float) -> None:
    time = sample_times(1.5, platen.TIME.period_s)
    mask = (time >= 0.5) & (time < 0.5015)
    signal = next(g.signal for g in INPUTS if g.signal.name == name)
    in_range = signal.low <= bad <= signal.high
    trajectory = emitted_rig.run(1.5, {"y": 0.025}, {}, overrides={name: Override(mask, np.full(len(time), bad))})
    bits = 1 << NAMES.index(name) | (1 << DEGRADED.bit if name in MEASURED else 0)
    expected = np.where(mask & (not in_range), bits, 0)
    np.testing.assert_array_equal(trajectory.faults, expected)
    assert np.max(np.abs(trajectory["y"][-100:] - 0.025)) < 2e-5
    assert motions.motor_currents(trajectory).max() <= LIMIT


@pytest.mark.parametrize("name", NAMES)
def test_permanently_bad_lands_without_x_or_z_alone(emitted_rig: Rig, name: str) -> None:
    time = sample_times(3.0, platen.TIME.period_s)
    lost = Override(time >= 0.5, np.full(len(time), np.nan))
    trajectory = emitted_rig.run(3.0, {"y": 0.025}, {}, overrides={name: lost})
    latched = trajectory.faults & LATCHED != 0
    if name in "xz":
        assert 0.3 < time[np.argmax(latched)] - 0.5 < 0.6 and latched[-1]
        assert trajectory.impacts["y"] < 0.02 and trajectory["y"][-1] == pytest.approx(platen.GAP[1])  # m/s
        require_final_currents(trajectory, latched, SAFETY.landed_output)
    else:
        assert not latched.any()
        assert np.max(np.abs(trajectory["y"][-100:] - 0.025)) < 2e-5


def require_final_currents(trajectory: Trajectory, latched: np.ndarray, safe: Mapping[str, float]) -> None:
    currents = {n: trajectory.commands[n].astype(float) for n in safe}
    assert {n: i[-1] for n, i in currents.items()} == {n: pytest.approx(v) for n, v in safe.items()}
    steps = [np.abs(np.diff(i[latched])).max() for i in currents.values()]
    assert max(steps) <= platen.SLEW * platen.TIME.period_s * (1 + 1e-5)


def test_three_lost_gap_encoders_latch_at_once(emitted_rig: Rig) -> None:
    time = sample_times(3.0, platen.TIME.period_s)
    lost = {f"y{j}": Override(time >= 0.5, np.full(len(time), np.nan)) for j in (1, 2, 4)}
    trajectory = emitted_rig.run(3.0, {"y": 0.025}, {}, overrides=lost)
    latched = trajectory.faults & LATCHED != 0
    assert np.argmax(latched) == np.argmax(time >= 0.5) + platen.BAD_SAMPLES - 1 and latched[-1]
    require_final_currents(trajectory, latched, SAFETY.safe_output)


def test_bad_samples_of_several_measurements_in_a_row_latch(single: host.Controller) -> None:
    good = NONE_MISSED | {g.signal.name: np.full(12, g.initial) for g in INPUTS}
    turns = {name: good[name].copy() for name in MEASURED}
    for k, name in enumerate(MEASURED):
        turns[name][k] = np.nan
    faults = single.replay(good | turns).faults
    assert (faults >> 31).tolist() == [0] * 4 + [1] * 8
    spared = {name: np.where(np.arange(12) == 4, good[name], values) for name, values in turns.items()}
    assert (single.replay(good | spared).faults < LATCHED).all()


def test_four_bad_samples_and_a_good_one_for_ever_land_or_latch(emitted_rig: Rig) -> None:
    """Without z it lands, without three gaps it latches; one bad sample in six does neither."""
    time = sample_times(3.0, platen.TIME.period_s)
    k = np.arange(len(time))
    for names, mask, lands in (
        (("z",), k % 5 != 0, True),
        (("y1", "y2", "y4"), k % 5 != 0, True),
        (("z",), k % 6 == 0, False),
        (("y1", "y2", "y4"), k % 6 == 0, False),
    ):
        lost = {n: Override(mask & (time >= 0.5), np.full(len(time), np.nan)) for n in names}
        trajectory = emitted_rig.run(3.0, {"y": 0.025}, {}, overrides=lost)
        assert bool(trajectory.faults[-1] & LATCHED) == lands
        assert np.abs(trajectory["z"]).max() < 1e-3 and (lands or np.abs(trajectory["y"][-100:] - 0.025).max() < 5e-5)


@pytest.mark.parametrize("name", ["x", "z"])
def test_a_reading_that_is_offset_by_half_a_millimetre_is_noticed_at_once_and_the_platen_lands(
    emitted_rig: Rig, name: str
) -> None:
    """At rest, where the sound reading stays within a count; the prediction replaces it from the first sample on."""
    time = sample_times(3.0, platen.TIME.period_s)
    healthy = emitted_rig.run(3.0, {"y": 0.025}, {})
    jumped = healthy.measured[name] + 5e-4 * (time >= 0.5)
    trajectory = emitted_rig.run(3.0, {"y": 0.025}, {}, overrides={name: Override(time >= 0.5, jumped)})
    bit = 1 << 15 + "xz".index(name)
    assert np.argmax(trajectory.faults & bit > 0) == np.argmax(time >= 0.5)
    assert trajectory.faults[-1] & LATCHED and trajectory.impacts["y"] < 0.02 and np.abs(trajectory[name]).max() < 2e-3


def test_a_latch_stays_until_init(single: host.Controller) -> None:
    good = NONE_MISSED | {g.signal.name: np.full(50, g.initial) for g in INPUTS}
    lost = dict(good) | {"z": np.where(np.arange(50) < 5, np.nan, 0.0)}
    latched = single.replay(lost)
    after = single.replay(good, latched.state)
    assert (after.faults == LATCHED).all()
    assert single.replay(good).faults.max() == 0


def _emitted(stage: Plant) -> write.EmittedCode:
    error = platen.SURROGATE_ERROR[np.float32]
    return write.emit(control.controller(stage).block, np.float32, error=error)


@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="-mfma is a flag of x86-64 compilers")
def test_a_motor_at_its_limit_with_fused_operations(stage: Plant) -> None:
    """Contraction, the default of gcc for ARM, rounds a product less: no root of a negative number comes of it."""
    emitted = _emitted(stage)
    fused = host.load(emitted.files, emitted.manifest, ("-ffp-contract=fast", "-mfma"))
    held = {g.signal.name: np.full(3000, g.initial) for g in INPUTS}
    moves = {"y_ref": np.full(3000, 0.0181), "x_ref": np.full(3000, 0.0499), "z_ref": np.full(3000, -0.0499)}
    replay = fused.replay(held | moves)
    require_sound(replay, fused.manifest["structs"]["state"]["fields"])
    assert max(float(np.abs(replay.outputs[f"i_d{j}"]).max()) for j in range(1, 5)) > 4.949
