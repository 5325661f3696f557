"""Unwrapped readings are those of `numpy.unwrap`; turns stay exact for a day, through bad samples, or are flagged."""

import numpy as np
import pytest

from synth import stage
from synth.block import Block, Constant, Exprs, Step, build
from synth.blocks.estimate import unwrap
from synth.execute import host
from synth.plant import build as build_plant
from synth.signals import Parameter, Signal
from synth.simulate import closed_loop, scenario
from synth.timing import Discrete

TAU, T, BAD = 2 * np.pi, 1e-2, 3
R, PHI = Signal("r", "rad", 0.0, TAU), Signal("phi", "rad", -30.0, 40.0)
READY = {"ready": 1.0}


def block(position: Signal = PHI, speed: float = 80.0) -> Block:
    return unwrap.block("unwrap", Discrete(T), R, position, span=TAU, speed=speed, bad_samples=BAD)


def run(made: Block, readings: np.ndarray, scalar: type[np.floating] = np.float64) -> host.Columns:
    ready = (np.arange(len(readings)) > 0).astype(float)
    return host.compile_block(made, scalar).replay({made.inputs[0].name: readings, "ready": ready}).outputs


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
@pytest.mark.parametrize("seed", range(5))
def test_a_motion_back_and_forth_is_that_of_numpy(seed: int, scalar: type[np.floating]) -> None:
    rng = np.random.default_rng(seed)
    phi = np.interp(np.arange(4000), np.arange(0, 4001, 400), np.r_[1.0, rng.uniform(-29, 39, 10)])
    made = run(block(), phi % TAU, scalar)
    exact = np.unwrap(phi % TAU, period=TAU)
    np.testing.assert_allclose(made["phi"], exact, rtol=0, atol=8e-6 if scalar is np.float32 else 1e-12)
    np.testing.assert_allclose(exact, phi, rtol=0, atol=1e-12)
    # float32 rounds a reading just below the span to the span: the position is the same, the turn one less
    assert (np.abs(made["phi_turns"] - np.floor(phi / TAU)) <= (np.abs(phi / TAU - np.rint(phi / TAU)) < 1e-6)).all()
    assert not made["phi_lost"].any()


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("bits", [16, 24])
def test_a_day_of_rotation_counts_every_turn_in_single_precision(bits: int, direction: int) -> None:
    """8 turns a second for 24 h at 100 Hz: 691,000 turns, of which the position itself has too few digits."""
    span, per_sample = 2**bits, direction * (2**bits // 12 - 1)
    reading = Signal("r", "1", 0, span - 1)
    everywhere = Signal("phi", "1", -(2.0**20) * span, 2.0**20 * span)
    made = unwrap.block(
        "unwrap", Discrete(T), reading, everywhere, span=float(span), speed=abs(per_sample) / T, bad_samples=BAD
    )
    controller, state = host.compile_block(made, np.float32), None
    hour = 360_000
    for h in range(24):
        total = per_sample * np.arange(h * hour, (h + 1) * hour, dtype=np.int64)
        ready = np.ones(hour) if h else (np.arange(hour) > 0).astype(float)
        replay = controller.replay({"r": total % span, "ready": ready}, state)
        state = replay.state
        np.testing.assert_array_equal(replay.outputs["phi_turns"], total // span)
        assert not replay.outputs["phi_lost"].any()
    assert abs(int(replay.outputs["phi_turns"][-1])) > 680_000


def test_a_16_bit_counter_is_exact_in_single_precision_over_256_spans() -> None:
    rng, span = np.random.default_rng(0), 2**16
    total = np.cumsum(rng.integers(-10_000, 10_001, 20_000)) % (200 * span) - 100 * span
    total = total[np.r_[True, np.abs(np.diff(total)) < span // 2].cumprod().astype(bool)]
    reading, position = Signal("r", "1", 0, span - 1), Signal("phi", "1", -(2.0**23), 2.0**23)
    made = unwrap.block("u", Discrete(T), reading, position, span=float(span), speed=1e6, bad_samples=BAD)
    outputs = run(made, total % span, np.float32)
    np.testing.assert_array_equal(outputs["phi"] - outputs["phi"][0], total - total[0])


def guarded() -> stage.Controller:
    """Return a rotary axis that turns at the speed of its set-point, seen by an encoder of one turn."""

    def physics(x: Exprs, u: Exprs, p: Exprs) -> tuple[Exprs, Exprs]:
        return {"angle": x["w"], "w": u["M"] / p["J"]}, {"angle": x["angle"], "w": x["w"]}

    plant = build_plant(
        "rotor",
        states=[Signal("angle", "rad", -30, 40), Signal("w", "rad/s", -80, 80)],
        inputs=[Signal("M", "N m", -5, 5)],
        outputs=[Signal("angle", "rad", -30, 40), Signal("w", "rad/s", -80, 80)],
        parameters=[Parameter("J", 0.01, "kg m^2", 0.1, "weighed")],
        physics=physics,
    )
    interface = stage.interface(
        plant,
        sensors=[stage.Sensor("r", of="angle", resolution=TAU / 2**20, wraps=TAU), stage.Sensor("w")],
        set_points=[stage.SetPoint("angle_ref", of="angle", low=-29, high=39)],
        actuators=[stage.Actuator("M", safe=0.0, slew_per_s=1e3)],
        bad_samples=BAD,
        suspected=["r"],
        delay=0,
    )
    phi, reference, w = PHI, interface.held("angle_ref"), interface.held("w")

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        return Step({"M_demand": k["P"] * (u[reference.name] - u["phi"]) - k["D"] * u[w.name]})

    unwrapped = unwrap.block("unwrap", Discrete(T), interface.held("r"), phi, span=TAU, speed=80.0, bad_samples=BAD)
    flags = [Signal(n, "1", 0, 1) for n in ("phi_lost", "suspected", "suspect_r")]

    def suspicion(u: Exprs, x: Exprs, k: Exprs) -> Step:
        return Step({"suspected": u["phi_lost"], "suspect_r": u["phi_lost"]})

    suspect = build("suspicion", Discrete(T), suspicion, inputs=flags[:1], outputs=flags[1:])
    gains = [Constant("P", 2.0, "N m/rad", "tuned"), Constant("D", 0.3, "N m s/rad", "tuned")]
    demand = interface.demand("M")
    pd = build("pd", Discrete(T), law, inputs=[phi, reference, w], outputs=[demand], constants=gains)
    return stage.controller("rotor", Discrete(T), interface, [unwrapped, suspect, pd], outputs=["M", "phi", "phi_lost"])


@pytest.mark.parametrize("bad", [0, 1, 2])
def test_a_stage_follows_over_several_turns_with_bad_samples_on_the_way(bad: int) -> None:
    controller = guarded()
    compiled = host.compile_block(controller.block, np.float32)
    time = np.arange(600) * T
    mask = (np.arange(600) % 20 >= 5) & (np.arange(600) % 20 < 5 + bad)
    ramp = np.interp(time, [0.5, 2.5, 5.0], [1.0, 35.0, -25.0])
    made = closed_loop.simulate(
        controller.interface.plant,
        compiled,
        scenario.Scenario(
            6.0,
            {"angle": 1.0},
            {"r": "angle", "w": "w"},
            {"M": "M"},
            {"angle_ref": ramp},
            {"r": scenario.Encoder(TAU / 2**20, span=TAU, low=0.0)},
            overrides={"r": scenario.Override(mask, np.full(600, np.nan))},
            delay=0,
        ),
    )
    true, unwrapped = made.states["angle"], made.commands["phi"]
    assert true.max() > 33 and true.min() < -24 and not made.commands["phi_lost"].any()
    np.testing.assert_allclose(unwrapped[~mask], true[~mask], rtol=0, atol=TAU / 2**20 + 4e-6)
    assert not (made.faults[~mask] & 1).any() and not (made.faults >> 31).any()


def test_a_jump_of_a_reading_latches_the_stage_once_the_sensor_is_suspected() -> None:
    compiled = host.compile_block(guarded().block, np.float32)
    r = np.r_[np.full(10, 1.0), np.full(20, 3.5)]
    replay = compiled.replay({"r": r, "w": 0.0 * r, "angle_ref": np.ones(30)})
    latched = replay.faults >> 31
    np.testing.assert_array_equal(latched, np.arange(30) >= 10 + BAD)  # suspected from sample 11 on


def test_a_motion_that_the_speed_does_not_allow_is_flagged_from_the_next_sample_on() -> None:
    phi = np.r_[np.full(5, 1.0), np.full(5, 1.0 + 2.5)]  # 2.5 rad in a sample, where 80 rad/s make 2.4 in three
    lost = run(block(), phi % TAU)["phi_lost"]
    np.testing.assert_array_equal(lost, [0] * 6 + [1] * 4)
    assert not run(block(), (np.r_[np.full(5, 1.0), np.full(5, 1.0 + 2.3)]) % TAU)["phi_lost"].any()


def test_more_than_half_a_span_is_a_turn_the_other_way_and_flagged() -> None:
    outputs = run(block(), np.array([1.0, 1.0, 1.0 + 3.5, 1.0 + 3.5]))
    np.testing.assert_array_equal(outputs["phi_turns"], [0, 0, -1, -1])
    assert outputs["phi_lost"][-1]


@pytest.mark.parametrize("direction", [1, -1])
def test_a_turn_beyond_the_range_is_flagged_and_the_position_stays_at_its_end(direction: int) -> None:
    phi = 1.0 + direction * 0.5 * np.arange(150)
    outputs = run(block(), phi % TAU)
    inside = (phi >= PHI.low) & (phi <= PHI.high)
    np.testing.assert_allclose(outputs["phi"][inside], phi[inside], rtol=0, atol=1e-12)
    assert outputs["phi_lost"][-1] and not outputs["phi_lost"][inside].any()
    assert (PHI.low <= outputs["phi"]).all() and (outputs["phi"] <= PHI.high).all()
