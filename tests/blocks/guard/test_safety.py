"""Guard and safe output as compiled C against a recursion in NumPy, for any bits that inputs can hold.

    reading, angle (measurements), wish (set-point)  -->  force = clip(gain (wish - reading) / (angle + wide), ..)

The law divides by little: what it computes leaves the range of the force a hundredfold.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from synth.block import Block, Exprs, State, Step, build, clip
from synth.blocks.guard import safe_output
from synth.blocks.guard.safety import LATCH_BIT, GuardedInput, Safety, frozen, guard
from synth.composition import compose
from synth.emit.write import EmittedCode, emit
from synth.errors import SignalError
from synth.execute import host
from synth.signals import Signal
from synth.timing import Discrete

pytestmark = pytest.mark.slow

f32 = np.float32
TIME = Discrete(1e-3)
INPUTS = [
    GuardedInput(Signal("reading", "m", 0.0168, 0.0322), 0.031, True),
    GuardedInput(Signal("angle", "rad", -0.1, 0.3), 0.2, True),
    GuardedInput(Signal("wish", "m", 0.018, 0.031), 0.02, False),
]
FORCE = Signal("force", "A", -4.9497, 4.9497)
SAFE = Safety(5, {"force": 2.5}, {"force": 100.0}, "the stage rests on its feet")
GAIN, WIDE = 100.0, 0.101
LATCHED = 1 << LATCH_BIT
GOOD = {"reading": 0.02, "angle": 0.1, "wish": 0.021}
NAMES = tuple(GOOD)
# Bit patterns: NaNs quiet and signalling with payloads, infinities, zeros, subnormals, extremes, bounds and their
# neighbours outside.
EDGES = [0x7FC00000, 0xFFC12345, 0x7F800001, 0x7F800000, 0xFF800000, 0x0, 0x80000000, 0x1, 0x80000001, 0x007FFFFF]
EDGES += [0x7F7FFFFF, 0xFF7FFFFF]
for g in INPUTS:
    low, high = f32(g.signal.low), f32(g.signal.high)
    near = [low, high, np.nextafter(low, f32(-9)), np.nextafter(high, f32(9)), f32((low + high) / 2)]
    EDGES += np.array(near, f32).view(np.uint32).tolist()


def controller(safety: Safety = SAFE) -> Block:
    held = [Signal(f"{n}_held", g.signal.unit, -1, 1) for n, g in zip(NAMES, INPUTS, strict=True)]
    law = build(
        "law",
        TIME,
        lambda u, x, k: Step(
            {"force_computed": GAIN * (u["wish_held"] - u["reading_held"]) / (u["angle_held"] + WIDE)}
        ),
        inputs=held,
        outputs=[Signal("force_computed", "A", -1, 1)],
    )
    blocks = [safe_output.block(TIME, [FORCE], safety), law, guard(TIME, INPUTS, safety.bad_samples)]
    return compose("guarded", blocks, inputs=NAMES, outputs=["force"])


def load(change: Callable[[str], str] = str, safety: Safety = SAFE) -> host.Controller:
    made = emit(controller(safety), f32)
    return host.load(dict(made.files) | {"guarded.c": change(made.files["guarded.c"])}, made.manifest)


@pytest.fixture(scope="module")
def guarded() -> host.Controller:
    return load()


def recursion(u: Mapping[str, np.ndarray], safety: Safety = SAFE) -> tuple[np.ndarray, np.ndarray]:
    """Return outputs (N,) and fault words (N,), each operation rounded to single precision."""
    last = {g.signal.name: f32(g.initial) for g in INPUTS}
    bad, latched, out = 0, False, f32(safety.safe_output["force"])
    rate = f32(safety.slew_per_s["force"] * TIME.period_s)
    outputs, words = [], []
    for k in range(len(u["wish"])):
        word, complete = 0, True
        for bit, g in enumerate(INPUTS):
            name, value = g.signal.name, u[g.signal.name][k]
            if f32(g.signal.low) <= value <= f32(g.signal.high):
                last[name] = value
            else:
                word |= 1 << bit
                complete &= not g.measurement
        bad = 0 if complete else bad + 1
        latched |= bad >= safety.bad_samples
        with np.errstate(all="ignore"):
            computed = f32(GAIN) * (last["wish"] - last["reading"]) / (last["angle"] + f32(WIDE))
            slewed = max(min(f32(safety.safe_output["force"]), out + rate), out - rate)
            out = slewed if latched else computed
        # Not a number is limited as if it were too large.
        out = f32(FORCE.high) if np.isnan(out) else min(max(out, f32(FORCE.low)), f32(FORCE.high))
        outputs.append(out)
        words.append(word | LATCHED * latched)
    return np.array(outputs, f32), np.array(words, np.uint32)


def columns(rows: Sequence[Mapping[str, Any]]) -> dict[str, np.ndarray]:
    """Return samples of the inputs, each good unless overridden."""
    return {n: np.array([{**GOOD, **row}[n] for row in rows], f32) for n in NAMES}


def from_bits(bits: np.ndarray) -> dict[str, np.ndarray]:
    return dict(zip(NAMES, np.ascontiguousarray(bits.T).view(f32), strict=True))


def disagreements(controller: host.Controller, u: Mapping[str, np.ndarray], safety: Safety = SAFE) -> int:
    replay, (force, faults) = controller.replay(u), recursion(u, safety)
    return int((replay.outputs["force"] != force).sum() + (replay.faults != faults).sum())


def edge_rows(seed: int, count: int = 600) -> dict[str, np.ndarray]:
    """Return mostly good samples, with runs of edge values or random bits in between."""
    rng = np.random.default_rng(seed)
    good = np.array([rng.uniform(g.signal.low, g.signal.high, count) for g in INPUTS], f32).view(np.uint32)
    odd = np.where(rng.random((3, count)) < 0.3, rng.choice(EDGES, (3, count)), rng.integers(0, 2**32, (3, count)))
    is_odd = np.zeros((3, count), bool)
    for row, start, length in rng.integers((0, 0, 1), (3, count, 16), (15, 3)):
        is_odd[row, start : start + length] = True
    return from_bits(np.where(is_odd, odd, good).astype(np.uint32).T)


PATTERNS = st.sampled_from(EDGES) | st.integers(0, 2**32 - 1)


@settings(max_examples=150, deadline=None)
@given(arrays(np.uint32, st.tuples(st.integers(1, 30), st.just(3)), elements=PATTERNS))
def test_outputs_are_finite_and_in_range_for_any_bits(guarded: host.Controller, bits: np.ndarray) -> None:
    u = from_bits(bits)
    force = guarded.replay(u).outputs["force"]
    assert (np.abs(force) <= f32(FORCE.high)).all()
    assert disagreements(guarded, u) == 0


def test_long_mixtures_equal_the_recursion(guarded: host.Controller) -> None:
    latched = []
    for seed in range(12):
        u = edge_rows(seed)
        assert disagreements(guarded, u) == 0
        latched.append((guarded.replay(u).faults >= LATCHED).mean())
    assert 0.1 < np.mean(latched) < 0.9


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("(low <= value)", "(low < value)"),
        ("(value <= high)", "(value < high)"),
        ("in->angle, -0.1f", "in->angle, -0.2f"),
        ("(faults & 0x00000003u) == 0u", "(faults & 0x00000001u) == 0u"),
        ("latch_samples = 5u", "latch_samples = 6u"),
        ("left <= 1u", "left <= 2u"),
        ("left - 1u", "left - 2u"),
        ("latched = latched_before", "latched = 0u"),
        ("guard.latched = 1u", "guard.latched = 0u"),
        ("(target < highest)", "(target > highest)"),
        ("(fabsf(x) <= high)", "(fabsf(x) <= 2.0f * high)"),
        ("0x80000000u", "0x40000000u"),
        ("*last = value", "*last = 0.5f * value"),
    ],
)
def test_a_planted_change_of_the_c_is_detected(old: str, new: str) -> None:
    def change(text: str) -> str:
        assert old in text
        return text.replace(old, new)

    mutant = load(change)
    bounds = columns([{"reading": v} for v in (0.0168, 0.0322)])
    run = columns([{}] + [{"angle": np.nan}] * 5 + [{}] * 3)
    assert sum(disagreements(mutant, u) for u in (bounds, run, *map(edge_rows, range(3)))) > 0


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e-40, -1e-40, 3e38, -3e38])
@pytest.mark.parametrize("name", ["reading", "wish"])
def test_a_bad_value_is_flagged_and_replaced_by_the_last_good_one(
    guarded: host.Controller, name: str, value: float
) -> None:
    bit = 1 << NAMES.index(name)
    # Before the first good sample the declared initial value serves.
    initial = INPUTS[NAMES.index(name)].initial
    rows = columns([{name: value}, {name: 0.0205}, {name: value}, {name: value}, {}])
    meant = columns([{name: initial}, {name: 0.0205}, {name: 0.0205}, {name: 0.0205}, {}])
    replay = guarded.replay(rows)
    assert replay.faults.tolist() == [bit, 0, bit, bit, 0]
    np.testing.assert_array_equal(replay.outputs["force"], guarded.replay(meant).outputs["force"])


@pytest.mark.parametrize("name", ["reading", "angle"])
def test_five_consecutive_bad_samples_latch_and_four_do_not(guarded: host.Controller, name: str) -> None:
    bad, bit = {name: np.nan}, 1 << NAMES.index(name)
    four = guarded.replay(columns(([bad] * 4 + [{}]) * 6)).faults
    assert four.tolist() == ([bit] * 4 + [0]) * 6
    five = guarded.replay(columns([{}] + [bad] * 5 + [{}] * 3)).faults
    assert five.tolist() == [0] + [bit] * 4 + [bit | LATCHED] + [LATCHED] * 3


@pytest.mark.parametrize("bad_samples", [1, 2, 7])
def test_the_count_of_bad_samples_is_the_declared_one(bad_samples: int) -> None:
    safety = Safety(bad_samples, SAFE.safe_output, SAFE.slew_per_s, SAFE.safe_output_effect)
    rows = [{}] + [{"angle": np.nan}] * bad_samples + [{}]
    faults = load(safety=safety).replay(columns(rows)).faults
    assert (faults >= LATCHED).tolist() == [False] * bad_samples + [True, True]


def test_a_bad_set_point_never_latches(guarded: host.Controller) -> None:
    replay = guarded.replay(columns([{"wish": 0.0205}] + [{"wish": np.nan}] * 500))
    assert replay.faults.tolist() == [0] + [4] * 500
    assert len(set(replay.outputs["force"])) == 1


def test_latched_outputs_slew_to_the_safe_output_until_init(guarded: host.Controller) -> None:
    pulling = {"reading": 0.03, "wish": 0.018, "angle": 0.01}  # the law asks for less than the lower limit
    latched = guarded.replay(columns([pulling] * 3 + [{**pulling, "reading": np.nan}] * 5))
    force = latched.outputs["force"]
    step = SAFE.slew_per_s["force"] * TIME.period_s
    assert (force[:7] == f32(FORCE.low)).all()
    np.testing.assert_allclose(force[7] - force[6], step, rtol=1e-5)
    # Good samples come back, and nothing but init releases it.
    after = guarded.replay(columns([pulling] * 200), latched.state)
    travelled = np.concatenate([force[7:], after.outputs["force"]])
    assert (np.diff(travelled) >= 0).all() and (np.diff(travelled) <= step * (1 + 1e-5)).all()
    needed = int(np.ceil((2.5 + 4.9497) / step)) - 1
    assert travelled[needed - 1] < 2.5 and (travelled[needed:] == f32(2.5)).all()
    assert (after.faults == LATCHED).all()
    assert guarded.step(guarded.init(), pulling).faults == 0


@pytest.mark.parametrize("safe", [4.9497, -4.9497, 0.1])
def test_a_rate_that_spans_the_range_does_not_overshoot_it(safe: float) -> None:
    safety = Safety(1, {"force": safe}, {"force": 2e4}, "fast")
    fast = load(safety=safety)
    rows = [{"reading": r, "wish": w} for r, w in np.random.default_rng(0).uniform(0.0181, 0.031, (400, 2))]
    for row in rows:
        u = columns([row, {**row, "angle": np.nan}, row])
        force = fast.replay(u).outputs["force"]
        assert (np.abs(force) <= f32(FORCE.high)).all() and force[2] == f32(safe)
        assert disagreements(fast, u, safety) == 0


def test_ready_follows_the_first_complete_sample() -> None:
    block = guard(TIME, INPUTS, 5)
    step, x, seen = block.function(), block.initial, []
    at = [[s.name for s in block.outputs].index(n) for n in ("complete", "ready")]
    for sample in ([0.02, 9, 0.02], [9, 0.1, 0.02], [0.02, 0.1, 9], [9, 9, 9], [9, 9, 9]):
        next, y = step(x, sample)
        x = next.full().ravel()
        seen.append(tuple(float(y[i]) for i in at))
    assert seen == [(0, 0), (0, 0), (1, 0), (0, 1), (0, 1)]


def test_complete_depends_on_the_compared_measurements_alone() -> None:
    """A bad angle counts for the latch and for ready; the reading, which may be suspected, can still be compared."""
    block = guard(TIME, INPUTS, 2, ("reading",))
    step, x, seen = block.function(), block.initial, []
    at = [[s.name for s in block.outputs].index(n) for n in ("complete", "ready", "latched")]
    for reading, angle, suspected in (
        (0.02, 9, 0),
        (0.02, 0.1, 0),
        (9, 0.1, 0),
        (0.02, 0.1, 1),
        (0.02, 0.1, 0),
        (0.02, 9, 0),
    ):
        next, y = step(
            x, [{"reading": reading, "angle": angle, "suspected": suspected}.get(s.name, 0) for s in block.inputs]
        )
        x = next.full().ravel()
        seen.append(tuple(float(y[i]) for i in at))
    assert seen == [(1, 0, 0), (1, 0, 0), (0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 1)]


def readings(held: bool, values: Sequence[float]) -> list[float]:
    """Return the value that replaces a refused reading, held or not, in compiled C."""
    inputs = [replace(INPUTS[0], held=held), *INPUTS[1:]]
    made = emit(guard(TIME, inputs, SAFE.bad_samples), f32)
    u = {n: np.full(len(values), v) for n, v in GOOD.items()} | {"reading": np.array(values)}
    return host.load(made.files, made.manifest).replay(u).outputs["reading_held"].tolist()


def test_a_refused_input_without_hold_takes_its_initial_value() -> None:
    values = [np.nan, 0.02, np.nan, 0.0322 + 1e-6, 0.03, -np.inf]
    initial, expected = INPUTS[0].initial, f32([0.031, 0.02, 0.031, 0.031, 0.03, 0.031]).tolist()
    assert readings(False, values) == expected and expected[0] == f32(initial)
    assert readings(True, values) == f32([0.031, 0.02, 0.02, 0.02, 0.03, 0.03]).tolist()


def test_an_input_without_hold_has_no_state_and_still_latches() -> None:
    block = guard(TIME, [replace(INPUTS[0], held=False), *INPUTS[1:]], 2)
    assert [s.name for s in block.states] == ["last_angle", "last_wish", "left", "latched", "ready"]
    assert block.faults == guard(TIME, INPUTS, 2).faults
    made = emit(block, f32)
    u = {n: np.full(4, v) for n, v in GOOD.items()} | {"reading": np.array([0.02, np.nan, np.nan, 0.02])}
    assert host.load(made.files, made.manifest).replay(u).faults.tolist() == [0, 1, 1 | LATCHED, LATCHED]


def counting() -> Block:
    """A guarded composition with a sum of the wishes."""
    wish, total = Signal("wish_held", "m", -1, 1), State(Signal("total", "m", -100, 100), 0)
    outputs = [Signal("force_computed", "A", -1, 1)]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        return Step({"force_computed": 100 * x["total"]}, {"total": x["total"] + u["wish_held"]})

    summed = build("law", TIME, law, inputs=[wish], outputs=outputs, states=[total])
    blocks = [guard(TIME, INPUTS, SAFE.bad_samples), summed, safe_output.block(TIME, [FORCE], SAFE)]
    return compose("counting", blocks, inputs=NAMES, outputs=["force"])


def states_after(block: Block, rows: Sequence[Mapping[str, Any]]) -> list[dict[str, float]]:
    made = emit(block, f32)
    loaded = host.load(made.files, made.manifest)
    state, states = loaded.init(), []
    for row in rows:
        loaded.step(state, {**GOOD, **row})
        states.append({n: float(state[n]) for n in state.dtype.names or ()})
    return states


def test_once_latched_only_the_guard_and_the_slew_change() -> None:
    rows = [{}] * 4 + [{"angle": np.nan}] * 5 + [{"wish": 0.03, "reading": 0.025}] * 3
    held, free = states_after(frozen(counting()), rows), states_after(counting(), rows)
    assert held[:8] == free[:8] and held[7]["law_total"] > held[6]["law_total"]  # not latched: it counts on
    assert len({s["law_total"] for s in held[7:]}) == 1 and held[8]["guard_latched"] == 1
    assert len({s["law_total"] for s in free[7:]}) == 5  # the planted defect: what is not frozen goes on
    assert held[-1]["guard_last_reading"] == f32(0.025)
    outputs = [s["safe_output_last_force"] for s in held]
    assert outputs == [s["safe_output_last_force"] for s in free]
    np.testing.assert_allclose(np.abs(np.diff(outputs[7:])), 0.1, rtol=1e-5)


def emit_self_limited(width: float) -> EmittedCode:
    """Emit a law that limits the force itself, possibly to more than the output's range."""
    wide, wish = Signal("force_computed", "A", -width, width), Signal("wish_held", "m", -1, 1)
    law = build(
        "law",
        TIME,
        lambda u, x, k: Step({"force_computed": clip(1e4 * u["wish_held"] - 250, wide)}),
        inputs=[wish],
        outputs=[wide],
    )
    blocks = [guard(TIME, INPUTS, SAFE.bad_samples), law, safe_output.block(TIME, [FORCE], SAFE)]
    return emit(compose("passed", blocks, inputs=NAMES, outputs=["force"]), f32)


@pytest.mark.parametrize(("width", "limits"), [(4.0, 1), (40.0, 2)])
def test_an_output_proved_in_range_is_not_limited_again(width: float, limits: int) -> None:
    made = emit_self_limited(width)
    code = made.files["passed.c"]
    assert code.count("passed_limit(") == 1 + limits  # with its definition
    controller = host.load(made.files, made.manifest)
    wishes = np.repeat([0.018, 0.031, 0.018], 20)
    u = {n: np.full(60, v) for n, v in GOOD.items()} | {
        "wish": wishes,
        "angle": np.where(np.arange(60) > 30, np.nan, 0.1),
    }
    force = controller.replay(u).outputs["force"]
    reach = f32(min(width, FORCE.high))
    assert force.min() == -reach and force.max() == reach and force[-1] == 2.5


def many(count: int) -> list[GuardedInput]:
    return [GuardedInput(Signal(f"u{i}", "1", 0, 1), 0, True) for i in range(count)]


@pytest.mark.parametrize(
    ("inputs", "bad_samples", "text"),
    [
        (many(32), 5, "32 inputs are guarded and 0 may be suspects, but the fault word has 31 bits: split"),
        (many(2), 0, "bad_samples is 0: a latch needs at least 1"),
        (many(1) * 2, 5, "'u0' is declared 2 times|'u0_held' is declared 2 times"),
        ([GuardedInput(Signal("u", "1", 0, 1), 2, True)], 5, "'last_u' starts at 2, outside"),
        (
            [GuardedInput(Signal("u", "1", 0, 1), 2, True, held=False)],
            5,
            "initial value 2 of 'u' is outside 0 .. 1: choose",
        ),
        ([GuardedInput(Signal("u", "1", 0, 1), np.nan, True, held=False)], 5, "initial value nan of 'u' is outside"),
    ],
)
def test_invalid_guards_are_refused(inputs: list[GuardedInput], bad_samples: int, text: str) -> None:
    with pytest.raises(SignalError, match=text):
        guard(TIME, inputs, bad_samples)
    assert len(guard(TIME, many(31), 1).faults) == len(guard(TIME, many(16), 1, [f"u{i}" for i in range(15)]).faults)
    with pytest.raises(SignalError, match="16 inputs are guarded and 16 may be suspects, but"):
        guard(TIME, many(16), 1, [f"u{i}" for i in range(16)])


SUSPICIOUS = ("suspected", "suspect_reading", "suspect_angle")
READING, ANGLE = 1 << 3, 1 << 4  # after the bits of the inputs


def suspicious_block() -> Block:
    """Return the guarded law with a Block that passes its inputs on as suspicions, one sample later."""
    flags = [Signal(f"raise_{n}", "1", 0, 1) for n in SUSPICIOUS]
    kept = [State(Signal(f"delayed_{n}", "1", 0, 1), 0, True) for n in SUSPICIOUS]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        return Step(
            {n: x[f"delayed_{n}"] for n in SUSPICIOUS}, {f"delayed_{n}": u[f"raise_{n}"] > 0.5 for n in SUSPICIOUS}
        )

    outputs = [Signal(n, "1", 0, 1) for n in SUSPICIOUS]
    watch = build("watch", TIME, law, inputs=flags, outputs=outputs, states=kept)
    force = build(
        "law",
        TIME,
        lambda u, x, k: Step({"force_computed": u["reading_held"] + u["angle_held"] + 0 * u["wish_held"]}),
        inputs=[Signal(f"{n}_held", g.signal.unit, -1, 1) for n, g in zip(NAMES, INPUTS, strict=True)],
        outputs=[Signal("force_computed", "A", -1, 1)],
    )
    blocks = [guard(TIME, INPUTS, 5, ("reading", "angle")), watch, force, safe_output.block(TIME, [FORCE], SAFE)]
    return compose("watched", blocks, inputs=[*NAMES, *(s.name for s in flags)], outputs=["force"])


def run_with_suspects(
    suspects: Sequence[str], change: Callable[[str], str] = str, **inputs: Sequence[float]
) -> tuple[list[int], np.ndarray]:
    """Return fault words and forces; the letters s, r, a of a sample raise the three flags of SUSPICIOUS."""
    made = emit(suspicious_block(), f32)
    controller = host.load(dict(made.files) | {"watched.c": change(made.files["watched.c"])}, made.manifest)
    u = {n: np.full(len(suspects), v, f32) for n, v in GOOD.items()} | {n: np.array(v, f32) for n, v in inputs.items()}
    u |= {
        f"raise_{n}": np.array([letter in t for t in suspects], f32)
        for letter, n in zip("sra", SUSPICIOUS, strict=True)
    }
    run = controller.replay(u)
    return run.faults.tolist(), run.outputs["force"]


SPELL = ["", "", "sr", "sr", "sra", "ra", "s", ""]


def follows(change: Callable[[str], str] = str) -> bool:
    values = np.linspace(0.02, 0.027, 8)
    faults, force = run_with_suspects(SPELL, change, reading=values)
    right = [0, 0, 0, READING, READING, READING | ANGLE, 0, 0]
    return faults == right and bool((force == f32(values) + f32(0.1)).all())


def test_a_suspect_sets_its_bit_as_long_as_it_is_suspected_and_its_value_is_passed_on() -> None:
    assert follows()


@pytest.mark.parametrize(("suspects", "bits"), [("sr", READING), ("sa", ANGLE), ("sra", READING | ANGLE), ("s", 0)])
def test_any_suspicion_latches(suspects: str, bits: int) -> None:
    faults, _ = run_with_suspects([suspects] * 8)
    assert faults == [0, *[bits] * 4, *[bits | LATCHED] * 3]


def test_samples_that_are_refused_and_samples_that_are_suspected_add_up_to_the_latch() -> None:
    bad = [0.02, np.nan, np.nan, 0.02, 0.02, 0.02, 0.02, np.nan]
    faults, _ = run_with_suspects(["", "", "sr", "sr", "sr", "", "", ""], reading=bad)
    assert faults == [0, 1, 1, READING, READING, READING | LATCHED, LATCHED, 1 | LATCHED]
    faults, force = run_with_suspects(["sr", "sr", "", ""], reading=[0.02, 9.0, 9.0, 0.021])
    assert faults == [0, 1 | READING, 1 | READING, 0]
    assert (force == f32([0.02, 0.02, 0.02, 0.021]) + f32(0.1)).all()


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("(watch_delayed_suspected != 0u)", "(true)"),
        ("(watch_delayed_suspected != 0u)", "(false)"),
        ("(watch_delayed_suspect_reading != 0u)", "(true)"),
        ("(watch_delayed_suspect_angle != 0u)", "(watch_delayed_suspect_reading != 0u)"),
        ("0x00000008u", "0x00000020u"),
        ("state->delayed_suspect_reading = ", "state->delayed_suspect_angle = "),
    ],
)
def test_a_planted_change_of_suspicion_is_detected(old: str, new: str) -> None:
    def change(text: str) -> str:
        assert old in text
        return text.replace(old, new)

    assert not follows(change)


def test_manifest_and_header_name_the_suspects() -> None:
    made = emit(suspicious_block(), f32)
    named = [{"bit": 3, "suspect": "reading"}, {"bit": 4, "suspect": "angle"}, {"bit": 31, "latched": True}]
    inputs = [{"bit": i, "input": n} for i, n in enumerate(NAMES)]
    assert made.manifest["faults"] == [*inputs, *named]
    for bit, name in ((3, "reading"), (4, "angle")):
        assert f" *   bit  {bit}  {name}: contradicts other measurements or its prediction\n" in made.files["watched.h"]


def test_without_suspects_nothing_changes() -> None:
    plain, none = guard(TIME, INPUTS, 5), guard(TIME, INPUTS, 5, ())
    assert emit(plain, f32).files == emit(none, f32).files
    assert [s.name for s in plain.inputs] == list(NAMES)
    more = guard(TIME, INPUTS, 5, ("angle",))
    assert [s.name for s in more.inputs] == [*NAMES, "suspected", "suspect_angle"] and more.states == plain.states
