"""Blocks of redundancy: substitution, isolation, frozen codes, probe, observer and landing, each with a defect."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from synth.analyse.structure.parity import Relation
from synth.block import Block, Constant
from synth.blocks.estimate import predictor
from synth.blocks.faults import innovation_monitor, landing, probe, redundancy
from synth.blocks.faults.redundancy_decision import FRESH, frozen_gate, jump_gate
from synth.composition import compose
from synth.fault import BRAKING_BIT
from synth.signals import Signal, signal_names
from synth.timing import Discrete

T = 1e-3
TIME = Discrete(T)
SENSORS = [Signal(n, "m", -1.0, 1.0) for n in ("a", "b", "c", "x")]
SUM = Relation({"a": 1.0, "b": -1.0, "c": 1.0}, 1e-3)
DECISION = redundancy.Decision({"x": 1e-3}, {"x": (-0.9, 0.9)}, persistent=3, undecided=10, at_rest=50)


def whole(decision: redundancy.Decision, missed_calls: Signal | None = None) -> Block:
    """Return the redundancy of the group with the monitor of x."""
    blocks = [
        innovation_monitor.block(TIME, SENSORS[-1], decision, missed_calls),
        redundancy.block(TIME, SENSORS, [SUM], decision),
    ]
    made = {s.name for b in blocks for s in b.outputs}
    read = dict.fromkeys(s.name for b in blocks for s in b.inputs if s.name not in made)
    return compose("whole", blocks, inputs=[*read], outputs=[s.name for b in blocks for s in b.outputs])


BLOCK = whole(DECISION)


class Runner:
    """A Block with its state, called sample by sample."""

    def __init__(self, block: Block) -> None:
        self.block, self.step, self.state = block, block.function(), block.initial

    def __call__(self, **inputs: float) -> dict[str, float]:
        self.state, y = (
            np.array(v).ravel() for v in self.step(self.state, [inputs[s.name] for s in self.block.inputs])
        )
        return dict(zip(signal_names(self.block.outputs), y, strict=True))


def sample(readings: Mapping[str, float], expected: Mapping[str, float] | None = None, **more: Any) -> dict[str, float]:
    inputs = {f"{n}_accepted": v for n, v in readings.items()} | {f"fault_{n}": 0.0 for n in readings}
    inputs |= {f"{n}_expected": v for n, v in (expected or readings).items()}
    inputs |= {"ready": 1.0, "judging": 1.0, "x_unanswered": 0.0}
    inputs["complete"] = 0.0 if any(n.startswith("fault_") for n in more) else 1.0
    return inputs | more


def moving(k: int) -> dict[str, float]:
    return {"a": 0.01 * k, "b": 0.03 * k, "c": 0.02 * k, "x": 0.01 * k}


def test_a_refused_reading_of_a_group_follows_from_the_others_and_two_from_the_predictions() -> None:
    runner, readings = Runner(BLOCK), moving(5)
    out = runner(**sample(readings | {"b": 0.0}, readings | {"b": 0.7}, fault_b=1.0))
    assert out["b_held"] == pytest.approx(0.15) and out["regular"] == 1
    out = runner(**sample(readings, readings | {"b": 0.7, "a": 0.6}, fault_b=1.0, fault_a=1.0))
    assert (out["a_held"], out["b_held"]) == (0.6, 0.7) and out["regular"] == out["determined"] == 0
    assert out["sufficient"] == 1
    out = runner(**sample(readings, fault_a=1.0, fault_b=1.0, fault_c=1.0))
    assert out["sufficient"] == 0


@pytest.mark.parametrize("name", ["a", "b", "c"])
def test_a_frozen_sensor_of_a_group_is_named_and_excluded_in_motion(name: str) -> None:
    runner = Runner(BLOCK)
    for k in range(20):
        true = moving(k)
        readings = true | ({name: moving(10)[name]} if k > 10 else {})
        out = runner(**sample(readings, true))
        if k >= 13:
            assert [n for n in "abc" if out[f"suspect_{n}"]] == [name]
            assert out[f"{name}_held"] == pytest.approx(true[name]) and out["regular"] == 1
    assert runner.state[[s.name for s in BLOCK.states].index(f"redundancy_excluded_{name}")] == 1


def test_a_contradiction_that_nothing_explains_makes_all_suspects_and_keeps_all_in_use() -> None:
    runner, readings = Runner(BLOCK), {"a": 0.0, "b": 0.0, "c": 0.0, "x": 0.0}
    for k in range(12):
        wrong = readings | {"a": 2e-3 + 1e-4 * k, "b": 1e-4 * k, "c": 1e-5 * (k % 3)}
        out = runner(**sample(wrong, wrong | {"x": 0.0}))
    assert all(out[f"suspect_{n}"] == 1 for n in "abc") and out["regular"] == 0 and out["a_held"] == wrong["a"]


def test_one_sensor_that_moves_after_it_was_excluded_as_frozen_makes_the_group_undecided() -> None:
    runner = Runner(BLOCK)
    for k in range(20):
        runner(**sample(moving(k) | ({"a": 0.1} if k > 10 else {}), moving(k)))
    out = runner(**sample(moving(20), moving(20)))
    assert out["regular"] == 0 and all(out[f"suspect_{n}"] for n in "abc")


def test_a_sensor_that_was_excluded_wrongly_is_used_again_and_the_frozen_one_is_found() -> None:
    """The codes of a and b stand still, and a wrong prediction accuses a; then a moves."""
    runner, names = Runner(BLOCK), [s.name for s in BLOCK.states]
    for k in range(16):
        readings = moving(k) | ({"b": moving(10)["b"], "a": moving(10)["a"]} if k > 10 else {})
        predicted = moving(k) | {"b": readings["b"], "a": moving(10)["a"] - 0.02 * max(k - 10, 0)}
        runner(**sample(readings, predicted))
    assert [runner.state[names.index(f"redundancy_excluded_{n}")] for n in "abc"] == [1, 0, 0]
    for k in range(16, 24):
        out = runner(**sample(moving(k) | {"b": moving(10)["b"]}, moving(k)))
    assert [runner.state[names.index(f"redundancy_excluded_{n}")] for n in "abc"] == [0, 1, 0]
    assert out["b_held"] == pytest.approx(moving(23)["b"]) and out["determined"] == 0


@pytest.mark.parametrize(("stuck", "error", "frozen"), [(0.1, 0.0, 1), (0.95, 0.0, 0), (0.1, 2e-3, 0)])
def test_a_code_that_stands_still_while_its_prediction_moves_is_frozen(stuck: float, error: float, frozen: int) -> None:
    """It is not at a stop, and not where the prediction was wrong while the code moved, as after missing calls."""
    runner = Runner(BLOCK)
    for k in range(30):
        readings = moving(k) | {"x": stuck + 4e-4 * min(k - 20, 0)}
        out = runner(**sample(readings, readings | {"x": stuck + 4e-4 * (k - 20) + error}))
    assert out["suspect_x"] == frozen and out["x_trusted"] == 1 - frozen


def test_a_sensor_at_rest_is_frozen_only_if_the_probe_was_not_answered() -> None:
    rest = {"a": 0.0, "b": 0.0, "c": 0.0, "x": 0.0}
    for unanswered in (0.0, 1.0):
        runner = Runner(BLOCK)
        named = [runner(**sample(rest, x_unanswered=unanswered))["suspect_x"] for _ in range(60)]
        assert named == [0.0] * 60 if not unanswered else named[4:] == [1.0] * 56


JUMPING = replace(DECISION, jump={"x": 2e-3})
MISSED = Signal("missed_calls", "1", 0, 40)


def jump(
    by: float,
    samples: int,
    missed: float = 0.0,
    error: float = 0.0,
    x: float = 0.1,
    judging: float = 1.0,
    decision: Any = JUMPING,
) -> tuple[list[float], list[float], list[float]]:
    """Return suspects, values less predictions, and frozen flags, of a reading that jumps after 30 good samples."""
    runner = Runner(whole(decision, MISSED))
    suspects, differences, frozen = [], [], []
    for k in range(40):
        true = moving(k) | {"x": x + 1e-4 * k}
        away = by if 30 <= k < 30 + samples else 0.0
        inputs = sample(true | {"x": true["x"] + away}, true | {"x": true["x"] + error}, judging=judging)
        out = runner(**inputs, missed_calls=missed if k == 30 else 0.0)
        suspects.append(out["suspect_x"])
        differences.append(out["x_held"] - true["x"])
        frozen.append(out["x_frozen"])
    return suspects[28:], differences[28:], frozen


def test_a_reading_that_jumps_is_replaced_at_once_and_excluded_in_the_third_sample() -> None:
    suspects, differences, frozen = jump(-3e-3, 10)
    assert suspects == [0, 0, *[1] * 10] and np.abs(differences).max() < 1e-12 and not any(frozen[:33])
    assert jump(3e-3, 3)[0] == [0, 0, *[1] * 10]


@pytest.mark.parametrize("samples", [1, 2])
def test_a_spike_is_noticed_and_replaced_and_the_sensor_stays_in_use(samples: int) -> None:
    suspects, differences, _ = jump(0.3, samples)
    assert suspects == [0, 0, *[1] * samples, *[0] * (10 - samples)] and np.abs(differences).max() < 1e-12


@pytest.mark.parametrize(
    "harmless",
    [
        {"by": 1.9e-3, "samples": 10},  # inside the gate
        {"by": 3e-3, "samples": 10, "missed": 5.0},  # the body has moved on
        {"by": 3e-3, "samples": 10, "missed": np.nan},  # nobody knows
        {"by": 3e-3, "samples": 10, "missed": -np.inf},
        {"by": 3e-3, "samples": 10, "error": 1.5e-3},  # the prediction is not believed
        {"by": 3e-3, "samples": 10, "x": 0.95},  # a stop may hold it
        {"by": 3e-3, "samples": 10, "judging": 0.0},  # once latched the prediction stands still
    ],
)
def test_a_reading_far_from_a_prediction_that_is_not_believed_has_not_jumped(harmless: dict[str, float]) -> None:
    assert not any(jump(**harmless)[0])  # type: ignore[arg-type]


@pytest.mark.parametrize(("wide", "by"), [(4e-3, -0.01), (0.0, -0.01), (4e-3, 3.5e-3)])
def test_with_a_wide_gate_a_reading_that_moves_away_from_a_doubted_prediction_is_noticed(
    wide: float, by: float
) -> None:
    """One that jumps to its prediction comes back to it, as after missing calls."""
    decision = replace(JUMPING, wide_jump={"x": wide} if wide else {})
    suspects = jump(by, 10, error=3.5e-3, decision=decision)[0]
    assert suspects == [0, 0, *([1] * 10 if wide and by < 0 else [0] * 10)]


@pytest.mark.parametrize("wide", [4.5e-3, 0.0])
def test_with_a_wide_gate_a_code_that_stands_still_is_frozen_without_an_agreement_before(wide: float) -> None:
    runner = Runner(whole(replace(DECISION, wide_frozen={"x": wide} if wide else {})))
    named = []
    for k in range(30):
        readings = moving(k) | {"x": 0.1 + 1e-3 * min(k - 20, 0)}
        named.append(runner(**sample(readings, readings | {"x": 0.1 + 1e-3 * (k - 20) + 2e-3}))["suspect_x"])
    assert named == [0] * 25 + [1.0 if wide else 0.0] * 5


def test_the_gate_of_jumps_is_what_a_wrong_acceleration_adds_in_a_sample() -> None:
    gate, e = 40e-6, 53.0
    t = np.sqrt(2 * gate / e)
    assert jump_gate(gate, e, 1e-5, T) == pytest.approx(e * (t + T) ** 2 / 2 + 1e-5)


def test_the_gate_of_frozen_codes_is_seldom_reached_by_the_noise_of_a_moving_sensor() -> None:
    """Codes of one count repeat while the body moves, by noise: so far in a share of the samples below the chance."""
    sigma, q, chance = 1.0, 1.0, 1e-4
    gate, rng, n = frozen_gate(0.1, q, sigma, chance), np.random.default_rng(1), 400_000
    assert frozen_gate(0.1, q, 0.0) == 0.1 and frozen_gate(9.0, q, sigma, chance) == 9.0

    def repeats(distance: float) -> float:
        k = np.arange(FRESH + 1)[:, None] / FRESH
        codes = np.round(distance * k + rng.uniform(-0.5, 0.5, n) + rng.normal(0.0, sigma, (FRESH + 1, n)))
        return float(np.mean((codes == codes[0]).all(axis=0)))

    assert repeats(gate) == pytest.approx(chance, rel=0.3) and repeats(gate / 2) > 10 * chance


W, ERROR = Signal("w", "m/s^2", -9.0, 9.0), Signal("e", "m", -1.0, 1.0)
PROBE, BOTH_SIDES = probe.Probe(10, 3, 4e-6, 4), probe.Probe(10, 1, 2e-6, 6, both_sides=True)


def probe_a_body(
    offset: float, factor: float = 1.0, frozen: bool = False, free: float = 1.0, by: probe.Probe = PROBE
) -> tuple[Any, Any, bool]:
    """Return positions, speeds between the pairs and whether no pair was answered, of a body with counts of 10 um."""
    runner, x, v, still, code = Runner(probe.block(TIME, "x", ERROR, W, by)), offset, 0.0, 0.0, 0.0
    xs, vs, unanswered = [], [], False
    for _ in range(150):
        now = code if frozen else round(x / 1e-5)
        still, code = (still + 1 if now == code else 0.0), now
        out = runner(w_unprobed=0.0, x_unchanged=min(still, by.count_limit), e=1e-5 * code, free=free)
        x, v = x + T * v + T * T / 2 * factor * out["w"], v + T * factor * out["w"]
        xs.append(x)
        vs.append(v if runner.state[0] == 0 else 0.0)
        unanswered |= out["x_unanswered"] > 0
    return np.array(xs), np.array(vs), unanswered


@pytest.mark.parametrize("factor", [0.9, 1.1])
@pytest.mark.parametrize("offset", [-4.9e-6, -1e-6, 0.0, 2e-6, 4.9e-6])
def test_the_probe_changes_the_code_of_a_body_by_one_count_and_leaves_no_speed(offset: float, factor: float) -> None:
    x, v, unanswered = probe_a_body(offset, factor)
    assert not unanswered and 0 < np.abs(np.round(x / 1e-5)).max() == 1
    assert np.abs(x).max() < 5e-6 + 1.1 * PROBE.step and np.abs(v).max() < 1e-9


@pytest.mark.parametrize("offset", [-4.9e-6, -1e-6, 0.0, 2e-6, 4.9e-6])
def test_pairs_to_both_sides_change_the_code_of_a_body_by_one_count_and_leave_no_speed(offset: float) -> None:
    x, v, unanswered = probe_a_body(offset, 0.9, by=BOTH_SIDES)
    assert not unanswered and np.abs(np.round(x / 1e-5)).max() == 1
    assert np.abs(x).max() < 5e-6 + 1.5 * BOTH_SIDES.step and np.abs(v).max() < 1e-9


def test_pairs_to_both_sides_of_a_frozen_sensor_move_the_body_there_and_back() -> None:
    x, v, unanswered = probe_a_body(1e-6, frozen=True, by=BOTH_SIDES)
    assert unanswered and np.abs(v).max() < 1e-9
    # Where nothing takes the demand over after the sixth pair, further ones move the body by 8 um.
    assert x.max() == pytest.approx(1e-6 + 8e-6, rel=1e-3) and x.min() == pytest.approx(1e-6 - 8e-6, rel=1e-3)
    assert BOTH_SIDES.samples < 60


def test_a_frozen_sensor_does_not_answer_and_a_body_on_a_stop_is_not_probed() -> None:
    x, v, unanswered = probe_a_body(1e-6, frozen=True)
    assert unanswered and x.max() == pytest.approx(1e-6 + 4 * PROBE.step, rel=0.3) and np.abs(v).max() < 1e-9
    assert abs(x[-1] - 1e-6) < 1e-9 and PROBE.samples < 100
    x, v, unanswered = probe_a_body(1e-6, free=0.0)
    assert not unanswered and not v.any()


def test_the_observer_learns_gain_and_disturbance_and_predicts_without_measurement() -> None:
    measured, w = Signal("x", "m", -1.0, 1.0), Signal("w", "m/s^2", -10.0, 10.0)
    bounds = {"bandwidth": 60.0, "rate": 5.0, "disturbance": 20.0}
    gain_bounds, flags = predictor.Gain(0.5, 1.5, 30.0), predictor.Flags("ok", "unchanged", "frozen")
    runner = Runner(predictor.block("q", TIME, measured, w, flags=flags, gain=gain_bounds, **bounds))
    x, v, gain, out = 0.0, 0.0, 1.1, {}
    for k in range(6000):
        a = 0.6 * np.sin(5.0 * k * T)
        lost = k >= 5000
        measured = out["q_expected"] if lost and k > 5000 else x
        out = runner(x=measured, w=a, ready=float(k > 0), ok=1.0 - lost, unchanged=0.0, frozen=0.0)
        out["q_expected"] = float(runner.state[0])
        x, v = x + T * v + T * T / 2 * gain * a, v + T * gain * a
    state = dict(zip([s.name for s in runner.block.states], runner.state, strict=True))
    assert state["g"] == pytest.approx(gain, abs=0.02)
    assert abs(state["v"] - v) < 5e-3  # m/s, after 1 s without a measurement; with the gain 1 it is 12 mm/s and more


def rate_error(v: float, a: float, samples: int, counted: bool = True, frozen: bool = True) -> float:
    """Return the error of the rate, m/s, when a code that has stood still for some samples is no longer trusted."""
    measured, w = Signal("x", "m", -1.0, 1.0), Signal("w", "m/s^2", -10.0, 10.0)
    flags = predictor.Flags("ok", "unchanged", "frozen")
    runner = Runner(predictor.block("q", TIME, measured, w, flags=flags, bandwidth=60.0, rate=5.0, disturbance=20.0))
    onset, rates = 400, v + a * T * np.arange(-400, samples + 1)
    for k in range(onset + samples):
        since, lost = k - onset, k == onset + samples - 1
        x = v * T * min(since, 0) + a * (T * min(since, 0)) ** 2 / 2
        unchanged = float(max(since, 0)) if counted else 0.0
        inputs = {"w": a, "ready": float(k > 0), "ok": 1.0 - lost, "unchanged": unchanged, "frozen": lost * frozen}
        out = runner(x=float(runner.state[0]) if lost else x, **inputs)
    return float(abs(out["q_rate"] - rates[onset + samples - 1]))


FROZEN = pytest.mark.parametrize(("v", "a", "samples"), [(-0.14, 0.0, 4), (0.0, 0.67, 17), (0.0, 0.05, 75)])


@FROZEN
def test_the_rate_that_a_frozen_code_teaches_is_taken_back(v: float, a: float, samples: int) -> None:
    assert rate_error(v, a, samples) < 1e-3


@FROZEN
def test_it_is_not_where_unchanged_codes_are_not_counted_or_the_reading_is_only_refused(
    v: float, a: float, samples: int
) -> None:
    assert rate_error(v, a, samples, counted=False) > 2e-3
    assert rate_error(v, a, samples, frozen=False) > 2e-3


def test_the_landing_touches_slowly_levels_and_leaves_an_axis_to_its_spring() -> None:
    units = {"y": "m/s^2", "x": "m/s^2", "t": "rad/s^2", "p": "rad/s^2"}
    courses = [
        landing.Descent("y", 0.031, 0.08, 5e-3, 1e-3, 2.0, 4e-4, 60.0, 0.1, 0.0305),
        landing.Braking("x", 4.0, 30.0, 0.1),
        landing.Levelling("t", 40.0, 20.0),
        landing.Release("p", Constant("spring_p", 50.0, "1/s^2", "test")),
    ]
    runner = Runner(landing.block(TIME, courses, [Signal(f"w_{n}", unit, -1e3, 1e3) for n, unit in units.items()], 5))
    q, v, touch, landed = np.array([0.02, 0.01, 5e-3]), np.array([-0.02, 0.14, 0.05]), [], []
    for k in range(900):
        inputs = {f"{n}_estimate": x for n, x in zip("yxt", q, strict=True)} | {"p": 3e-3, "t_measured": 1.0, "y": 0.02}
        inputs |= {f"{n}_rate": x for n, x in zip("yxt", v, strict=True)} | {f"{n}_disturbance": 0.0 for n in "yxt"}
        inputs |= {f"w_{n}_tracking": 7.0 for n in units}
        out = runner(**inputs, regular=float(k < 3), ready=1.0, latched=0.0)
        assert (out["w_y"] == 7.0) == (k < 7) and out["w_p"] == (7.0 if k < 7 else pytest.approx(-50 * 3e-3))
        if k >= 7:
            q, v = q + T * v + T * T / 2 * (w := np.array([out[f"w_{n}"] for n in "yxt"])), v + T * w
            assert v[0] < 0.085
        touch += [v[0]] if q[0] >= 0.031 else []
        landed.append(out["landed"])
        q[0] = min(q[0], 0.031)
    assert 0 < touch[0] < 6e-3 and 0.2 < landed.index(1) * T < 0.8  # m/s, s
    assert abs(q[2]) < 1e-4 and abs(v[1]) < 1e-4 and q[1] < 0.015


def test_a_coordinate_that_is_only_predicted_is_levelled_more_slowly() -> None:
    courses = [
        landing.Descent("y", 0.031, 0.08, 5e-3, 1e-3, 2.0, 4e-4, 60.0, 0.1, 0.0305),
        landing.Levelling("t", 40.0, 20.0),
    ]
    block = landing.block(TIME, courses, [Signal("w_y", "m/s^2", -1e3, 1e3), Signal("w_t", "rad/s^2", -1e3, 1e3)], 1)
    rest = {f"{n}_{of}": 0.0 for n in "yt" for of in ("rate", "disturbance")} | {
        "w_y_tracking": 0.0,
        "y": 0.02,
        "w_t_tracking": 0.0,
        "regular": 0.0,
        "ready": 1.0,
        "latched": 0.0,
    }
    demands = [
        Runner(block)(**rest, y_estimate=0.02, t_estimate=1e-3, t_measured=measured)["w_t"] for measured in (1.0, 0.0)
    ]
    assert demands == [pytest.approx(-1.6), pytest.approx(-0.4)]  # rad/s^2: p^2 q


def test_a_body_that_is_held_up_has_landed_and_does_not_rest_on_its_stop() -> None:
    descent = landing.Descent("y", 0.031, 0.08, 5e-3, 1e-3, 2.0, 4e-4, 60.0, 0.1, 0.0305)
    block = landing.block(TIME, [descent], [Signal("w_y", "m/s^2", -1e3, 1e3)], 3)
    inputs = dict.fromkeys([s.name for s in block.inputs], 0.0) | {"ready": 1.0, "y_estimate": 0.027}
    for y, rests in ((0.027, 0.0), (0.031, 1.0)):
        runner = Runner(block)
        out = [runner(**(inputs | {"y": y})) for _ in range(900)][-1]
        assert out["landed"] == 1 and out["rests"] == rests


def lands(block: Block) -> list[float]:
    """Return the status of a landing whose readings are good again before its end, and of its latch."""
    rest = dict.fromkeys([s.name for s in block.inputs], 0.0) | {"y_estimate": 0.02, "ready": 1.0}
    flags = [{"regular": 1.0}, {}, {}, {}, {"regular": 1.0}, {"regular": 1.0}, {"regular": 1.0, "latched": 1.0}]
    runner = Runner(block)
    return [runner(**(rest | of_sample))["lands"] for of_sample in flags]


def test_the_status_says_that_it_lands_until_the_latch_while_all_readings_are_good_again() -> None:
    descent = landing.Descent("y", 0.031, 0.08, 5e-3, 1e-3, 2.0, 4e-4, 60.0, 0.1, 0.0305)
    block = landing.block(TIME, [descent], [Signal("w_y", "m/s^2", -1e3, 1e3)], 3)
    (fault,) = block.faults
    assert fault.status and fault.bit == BRAKING_BIT and fault.output == "lands"
    assert lands(block) == [0, 0, 0, 1, 1, 1, 0]
    waiting = 1 - block.symbol["regular"]  # the planted defect: the readings now, not the landing
    assert lands(replace(block, output={**block.output, "lands": waiting})) == [0, 1, 1, 1, 0, 0, 0]
