"""Dead reckoning and braking of an axis q'' = b f, in exact motions: with measurements, without, and to a stop."""

from collections.abc import Sequence
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from synth.block import Block
from synth.blocks.estimate import dead_reckoning
from synth.blocks.estimate.dead_reckoning import Axis
from synth.blocks.guard import safe_output, safety
from synth.composition import compose
from synth.errors import SignalError
from synth.execute.host import compile_block
from synth.signals import Signal
from synth.statespace import Array
from synth.timing import Discrete

TIME = Discrete(1e-3)
T, B, R = TIME.period_s, 13.0, 0.9
Q = Signal("q", "m", -0.1, 0.1)
F = Signal("f", "A", -2.0, 2.0, "effort that acts until the next sample")
PREDICTED = replace(Q, name="q_predicted", low=-0.2, high=0.2)
AXIS = Axis("q", Q, PREDICTED, F, B, fastest=2.0, pole=R)
LAW, PASSED = Signal("law_f", "A", -1e3, 1e3), Signal("d_f", "A", -1e5, 1e5)


def motion(f: Array, q: float = 0.02, v: float = 0.1) -> Array:
    """Return the positions (N,) of the axis."""
    positions = []
    for acting in f:
        positions.append(q)
        q, v = q + T * v + B * acting * T**2 / 2, v + B * acting * T
    return np.array(positions)


def run(block: Block, q: Array, f: Array, bad: Sequence[int] = ()) -> tuple[Array, Array]:
    """Return predictions and advances (N,); in `bad` samples the prediction itself is fed back as measured."""
    step, x, rows = block.function(), block.initial, []
    for k in range(len(q)):
        at = float(x[0]) if k in bad else q[k]
        x, y = (np.asarray(v).ravel() for v in step(x, [at, f[k], float(k > 0), float(k not in bad)]))
        rows.append(y)
    return np.array(rows).T[0], np.array(rows).T[1]


def test_an_exact_motion_is_predicted_with_and_without_measurements() -> None:
    f = np.sin(0.05 * np.arange(400))
    q, bad = motion(f, v=0.0), range(100, 140)
    predicted, advance = run(dead_reckoning.block("reckoning", TIME, [AXIS]), q, f, bad)
    assert np.abs(predicted[2:] - q[2:]).max() < 1e-12
    rate = np.gradient(q, T)[3:-2]
    assert np.abs(advance[2:-3] / T - rate).max() < 0.02  # the mean of two samples of an acceleration of 13 m/s^2


@pytest.mark.parametrize(("acceleration", "low", "high", "f"), [(-5e3, -2.0, 2.0, -2.0), (5e3, -2.0, 0.0, -2.0)])
def test_the_c_keeps_the_predicted_range_for_an_effort_that_pushes_either_way(
    acceleration: float, low: float, high: float, f: float
) -> None:
    """The limit acts, so a certificate that takes the effort with its sign would leave it out."""
    axis = replace(AXIS, acceleration=acceleration, effort=replace(F, low=low, high=high), fastest=0.2)
    axis = replace(axis, predicted=replace(PREDICTED, low=-0.12, high=0.12))
    block = compose("c", [dead_reckoning.block("r", TIME, [axis])], inputs=["q", "f", "ready", "measured"], outputs=[
        "q_predicted"
    ])  # fmt: skip
    at = 0.1 * np.sign(acceleration * f)
    played = compile_block(block, np.float64).replay({"q": np.full(300, at), "f": f, "ready": 1.0, "measured": 1.0})
    assert played.outputs["q_predicted"][-1] == np.sign(at) * 0.12


def test_a_wrong_start_decays_with_a_double_pole() -> None:
    f = np.zeros(150)
    predicted, _ = run(dead_reckoning.block("reckoning", TIME, [AXIS]), motion(f), f)
    e = (motion(f) - predicted)[1:]  # the first sample starts at rest
    assert np.abs(e[2:] - 2 * R * e[1:-1] + R**2 * e[:-2]).max() < 1e-15 and abs(e[-1]) < 0.02 * np.abs(e).max()


def test_an_unknown_acceleration_is_the_innovation() -> None:
    """e = d T^2 / (1 - r)^2."""
    d, f = 2.0, np.zeros(400)
    q = motion(np.full(400, d / B), v=0.0)
    predicted, _ = run(dead_reckoning.block("reckoning", TIME, [AXIS]), q, f)
    assert (q - predicted)[-1] == pytest.approx(d * T**2 / (1 - R) ** 2, rel=1e-6)


FORCED = replace(AXIS, disturbance=dead_reckoning.Disturbance(0.97, 5.0))


def predict(axis: Axis, d: float, bad: Sequence[int] = (), n: int = 600) -> tuple[Array, Array]:
    """Return q less its prediction and the advance (N,) of an axis on which d m/s^2 act from the start."""
    q = motion(np.full(n, d / B), q=0.0, v=0.0)
    predicted, advance = run(dead_reckoning.block("reckoning", TIME, [axis]), q, np.zeros(n), bad)
    return q - predicted, advance


def test_a_steady_force_leaves_an_innovation_until_its_axis_has_learnt_it() -> None:
    d, steady = 0.2, 0.2 * T**2 / (1 - R) ** 2
    assert predict(AXIS, d)[0][-1] == pytest.approx(steady, rel=1e-9)
    learnt, advance = predict(FORCED, d)
    assert abs(learnt[-1]) < 1e-5 * steady < 0.4 * steady < learnt.max() < 0.7 * steady
    decays = np.convolve(learnt[100:], np.poly([R, R, 0.97]), "valid")  # of the three poles
    assert np.abs(decays).max() < 1e-11 * learnt.max()
    assert advance[-1] == pytest.approx(d * T * T * 600, rel=1e-6)  # the rate has no error


def test_a_disturbance_beyond_its_bound_leaves_the_innovation_of_the_rest() -> None:
    limited = replace(AXIS, disturbance=dead_reckoning.Disturbance(0.97, 0.05))
    k_s = (1 - R) ** 2 + 2 * (1 - R) * 0.03 - (1 - R) ** 2 * 0.03 / 2  # what is added to the rate in each sample
    assert predict(limited, 0.2)[0][-1] == pytest.approx(0.15 * T**2 / k_s, rel=1e-6)


def test_an_unmeasured_axis_goes_on_under_the_force_that_it_knows() -> None:
    gap = range(500, 540)
    known, unknown = (predict(axis, 0.2, gap)[0] for axis in (FORCED, AXIS))
    assert abs(known[539]) < 1e-8 < 1e-4 < abs(unknown[539])


@pytest.mark.parametrize(("pole", "largest", "message"), [
    (1.0, 5.0, "a pole of axis 'q' is 1.0"), (0.97, 0.0, "the disturbance of axis 'q' is at most 0.0: give a bound"),
])  # fmt: skip
def test_a_disturbance_that_cannot_be_learnt_is_refused(pole: float, largest: float, message: str) -> None:
    with pytest.raises(SignalError, match=message):
        dead_reckoning.block("r", TIME, [replace(AXIS, disturbance=dead_reckoning.Disturbance(pole, largest))])


BIASED = replace(AXIS, bias=dead_reckoning.RateBias(0.99, 30))


def left_after_braking(axis: Axis, change: float = 1.0) -> float:
    """Return the rate that is left of an axis at rest after 30 samples without measurement in which it brakes.

    A feedback on the position holds it against an unknown acceleration; `change` scales the gain of the bias.
    """
    reckoning = dead_reckoning.block("reckoning", TIME, [axis])
    constants = [replace(c, value=change * c.value) if c.name == "q_bias_gain" else c for c in reckoning.constants]
    brakes = safe_output.braking_block("braking", TIME, [axis], {"q": (LAW, PASSED)}, 0.5)
    whole = compose("whole", [replace(reckoning, constants=tuple(constants)), brakes],
                    inputs=["q", "f", "ready", "measured", "law_f", "brakes"],
                    outputs=["d_f", "q_predicted"])  # fmt: skip
    step, x, d, q, v, f, predicted = whole.function(), whole.initial, 2.0, 0.0, 0.0, 0.0, 0.0
    for k in range(2000):
        blind = k >= 1970
        inputs = [predicted if blind else q, f, float(k > 0), float(not blind), -8.0 * q - 1.0 * v, float(blind)]
        x, y = (np.asarray(u).ravel() for u in step(x, inputs))
        predicted = float(x[0])
        q, v = q + T * v + (B * f + d) * T**2 / 2, v + (B * f + d) * T
        f = float(np.clip(y[0], -2, 2))
    return abs(v)


def test_braking_leaves_an_axis_at_rest_that_a_constant_acceleration_pushes() -> None:
    """Without its bias the predicted rate is off by 2 d T / (1 - r) and more, and braking makes it a real one."""
    assert left_after_braking(AXIS) > 0.05
    assert left_after_braking(BIASED) < 0.1 * left_after_braking(AXIS)
    assert left_after_braking(BIASED, change=0.0) > 0.05 and left_after_braking(BIASED, change=2.0) > 0.05


def largest_rate_error(axis: Axis, every: int) -> float:
    """Return the largest error of the predicted rate once it is steady, m/s, where every n-th sample is missing.

    The source then returns the prediction plus the last innovation. An acceleration acts that no effort explains.
    """
    d, block = 0.1, dead_reckoning.block("reckoning", TIME, [axis])
    step, x, added, errors = block.function(), block.initial, 0.0, []
    q = motion(np.full(1000, d / B), q=0.0, v=0.0)
    for k in range(len(q)):
        good, p = k % every != every - 1, float(x[0])
        added = q[k] - p if good and k else added
        x = np.asarray(step(x, [q[k] if good else p + added, 0.0, float(k > 0), float(good)])[0]).ravel()
        errors.append(abs(float(x[1]) / T - d * (k + 1) * T))
    return max(errors[500:])


def test_samples_that_are_missing_now_and_then_leave_the_rate_of_an_axis_with_a_bias() -> None:
    """Planted: an axis without one takes the bridged position for its own, and the errors of the rate add up."""
    whole = largest_rate_error(BIASED, 2000)
    assert largest_rate_error(BIASED, 10) < 1.1 * whole
    assert largest_rate_error(AXIS, 10) > 1.5 * whole


def bridge(repeated: bool) -> float:
    """Return the largest jump of q over 20 bad samples under an unknown acceleration.

    They take the prediction, plus the last innovation if it is `repeated`.
    """
    q, block = motion(np.full(400, 2.0 / B), v=0.0), dead_reckoning.block("reckoning", TIME, [AXIS])
    step, x, last, jumps = block.function(), block.initial, 0.0, [0.0]
    for k in range(len(q)):
        good = not 350 <= k < 370
        e = q[k] - float(x[0]) if good else last * repeated
        jumps.append(0.0 if good else abs(float(x[0]) + e - q[k]))
        x = np.asarray(step(x, [float(x[0]) + e, 0.0, float(k > 0), float(good)])[0]).ravel()
        last = e if good else 0.0
    return max(jumps)


def test_the_last_innovation_removes_the_offset_of_an_unknown_acceleration() -> None:
    """The offset d T^2 / (1 - r)^2 is gone; what remains is d t^2 / 2 and an error of the rate."""
    d, offset = 2.0, 2.0 * T**2 / (1 - R) ** 2
    assert bridge(repeated=False) > offset
    assert bridge(repeated=True) < d * (20 * T) ** 2 + d * 20 * T**2 / (1 - R)


def loop(share: float = 0.5, change: float = 1.0) -> Block:
    """Return reckoning and braking of an axis whose effort is limited to 1 A; `change` scales the braking gain."""
    axis = replace(AXIS, effort=replace(F, name="acting", low=-1.0, high=1.0))
    block = safe_output.braking_block("braking", TIME, [axis], {"q": (LAW, PASSED)}, share)
    block = replace(block, constants=tuple(replace(c, value=change * c.value) for c in block.constants))
    return compose("loop", [dead_reckoning.block("reckoning", TIME, [axis]), block],
                   inputs=["q", "acting", "ready", "measured", "law_f", "brakes"],
                   outputs=["d_f", "q_predicted"])  # fmt: skip


def brake(block: Block, v: float, samples: int = 60) -> Array:
    """Return the rates (N,) of an axis that moves at v, is measured for 200 samples, and then brakes blindly."""
    step, x, q, acting, rates, predicted = block.function(), block.initial, 0.0, 0.0, [], 0.0
    for k in range(200 + samples):
        blind = k >= 200
        inputs = [predicted if blind else q, acting, float(k > 0), float(not blind), 0.0, float(blind)]
        x, y = (np.asarray(v).ravel() for v in step(x, inputs))
        f = float(np.clip(y[0], -1, 1))
        predicted = float(x[0])
        q, v = q + T * v + B * acting * T**2 / 2, v + B * acting * T
        acting = f
        rates.append(v)
    return np.array(rates)


@pytest.mark.parametrize("v", [0.05, -0.3])
def test_a_moving_axis_stops_without_measurements(v: float) -> None:
    """The largest deceleration first, then half of the rate in each sample."""
    rates = brake(loop(), v)
    stopped = 200 + int(np.ceil(abs(v) / (B * T))) + 12
    assert np.abs(rates[stopped:]).max() < 1e-3 * abs(v)


def test_the_law_passes_unchanged_while_nothing_brakes() -> None:
    step = loop().function()
    y = np.asarray(step(loop().initial, [0.01, 0.3, 1.0, 1.0, 17.3, 0.0])[1]).ravel()
    assert y[0] == 17.3


READING = safety.GuardedInput(Signal("reading", "m", -1.0, 1.0), 0.0, True)


def words(bad: Sequence[bool], bad_samples: int, samples: int) -> tuple[list[bool], list[bool]]:
    """Return for each sample whether a guard brakes and whether it has latched."""
    block = safety.guard(TIME, [READING], bad_samples, braking=samples)
    x, u, c = (ca.vcat([block.symbol[s] for s in names]) for names in (
        [s.name for s in block.states], ["reading"], [c.name for c in block.constants]))  # fmt: skip
    y = ca.vcat([block.output["latch_certain"], block.output["latched"]])
    step = ca.Function("step", [x, u, c], [ca.vcat([block.next[s.name] for s in block.states]), y])
    state, rows = block.initial, []
    for is_bad in bad:
        state, flags = (np.asarray(v).ravel() for v in step(state, [np.nan if is_bad else 0.0], []))
        rows.append(flags > 0)
    return [bool(r[0]) for r in rows], [bool(r[1]) for r in rows]


def test_a_guard_brakes_from_the_last_bad_sample_to_the_latch() -> None:
    braking_flags, latched = words([False] + [True] * 9, 3, 4)
    assert braking_flags == [False] * 3 + [True] * 7 and latched == [False] * 7 + [True] * 3


def test_a_good_sample_does_not_end_the_braking() -> None:
    braking_flags, latched = words([True] * 3 + [False] * 6, 3, 4)
    assert braking_flags == [False] * 2 + [True] * 7 and latched == [False] * 6 + [True] * 3


def test_fewer_bad_samples_are_forgotten() -> None:
    braking_flags, latched = words(([True] * 2 + [False]) * 4, 3, 4)
    assert not any(braking_flags) and not any(latched)


def test_a_prediction_whose_range_excludes_0_starts_at_its_nearest_end() -> None:
    gap = replace(AXIS, predicted=replace(PREDICTED, low=0.01, high=0.03))
    assert dead_reckoning.block("reckoning", TIME, [gap]).initial.tolist() == [0.01, 0.0]
