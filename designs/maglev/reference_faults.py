"""Fault handling of the maglev controller: NumPy reference for the generated C, around the law of `reference`.

    readings     y1 - y2 + y3 - y4 = 0 by F(5); a refused gap follows from the other three, two or more and x, z from
                 the predictions
    prediction   q'' = g a + d for each axis, with the innovation nu = q measured - q predicted:
                 q + alpha nu, v + beta nu, d + gamma nu; triple pole p = exp(-w T), alpha = 1 - p^3,
                 beta = 3/2 (1 - p)^2 (1 + p) / T, gamma = (1 - p)^3 / T^2
    isolation    of a gap encoder for |y1 - y2 + y3 - y4| > 48 um, by codes that stand still and by innovations
    probe        pairs of doublets of a (k + 1), k = 0, 1 .., at a code of x or z that stands still
    landing      w = p^2 (r - q) + 2 p (r' - v) + r'' - d along ramps r, down to the stop at 31 mm

`step` is that of the shipped controller, columns (n,) by name as in `reference`.
"""

from collections.abc import Callable, Mapping
from math import exp
from typing import Any

import numpy as np
from numpy.typing import NDArray

from designs.maglev import reference_phase, reference_probe, reference_stage
from designs.maglev.reference_stage import AXES, HIGH, LAST, LIMITS, LOW, OUTPUTS, SAFE, SENSORS, SLEW

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Columns = Mapping[str, NDArray[Any]]
# Of the demands, gaps and last currents: the currents (6, n), accelerations of x and z by them (2, n), and next states.
Finish = Callable[[Array, Array, Array], tuple[Array, Array, dict[str, Any]]]
# Of the states, the pose (5, n), the set-points (5, n) and whether it is ready: the demands (5, n) and what follows.
Law = Callable[[Columns, Array, Array, Flags], tuple[Array, Finish]]

T = 1e-3  # s
NAMES = tuple(LIMITS)[:SENSORS]
SIGN = np.array([1.0, -1.0, 1.0, -1.0])  # of y1..y4 in the parity relation
THRESHOLD = 4 * (5e-6 + 7e-6)  # m: half a count and an offset of each gap encoder
FRESH, STILL, PERSISTENT, UNDECIDED, DOUBTS = 3, 8, 3, 10, 10  # samples, changes of a code
CANDIDATE, LEAD = 0.4, (0.05, 0.3)  # of |r|
GATE, TRAVEL, LOST = 40e-6, 0.0499, 0.2  # m, of x and z
LIFTED, LONGEST = 0.0305, 40  # m, of the probe; samples counted without a change
BANDWIDTH = (120.0, 60.0, 60.0, 120.0, 120.0)  # rad/s, of y, x, z, phi, theta
RANGES = ((0.0145, 0.0345), (-0.1, 0.1), (-0.1, 0.1), (-0.02, 0.02), (-0.031, 0.031))  # m, rad
RATES, DISTURBANCES = (4.0, 2.0, 2.0, 4.0, 4.0), (50.0, 20.0, 20.0, 200.0, 200.0)
LEARNING, GAINS, LEAK = 30.0, (0.8, 1.2), 1 / 512
POLES = np.array([60.0, 30.0, 30.0, 0.0, 40.0])  # rad/s, of the landing; phi is left to its spring
WITHOUT_GAPS = np.array([60.0, 30.0, 30.0, 0.0, 14.0])  # rad/s: theta is predicted
PHI_SPRING = 0.75 * 15_000.0  # 1/s^2, the compensated part
END, BEYOND, SPEED, TOUCH, PRESS, DESCENT, BRAKE = 0.031, 0.4e-3, 0.08, 5e-3, 1e-3, 2.0, 4.0
DELAYED = 1e6  # m/s^2, rad/s^2: bound of the accelerations of one sample ago
DEMANDS = {"y": "w_y", "x": "a_x", "z": "a_z", "phi": "w_phi", "theta": "w_theta"}
WIDE, REACH = 10.0, 0.5  # m/s, m: bounds of the ramps
MISSED_CALLS = 40


def by_row(values: Any, like: Array) -> Array:
    """Return values (m,) as a column for rows (m, n)."""
    return np.reshape(np.asarray(values, dtype=float), (-1,) + (1,) * (like.ndim - 1))


def flags(state: Columns, names: Any) -> Flags:
    """Return some states as rows of flags."""
    return reference_stage.rows(state, names) > 0


def readings(state: Columns, y: Array, good: Flags, q: Array, attempts: int) -> tuple[Array, Flags, dict[str, Any]]:
    """Return the readings to use (6, n), the suspects (6, n), and the next states with the flags of the sample."""
    r = reference_stage.Parameters().r
    expected = np.array([q[0] - r * q[3], q[0] + r * q[4], q[0] + r * q[3], q[0] - r * q[4], q[1], q[2]])
    same = y == reference_stage.rows(state, [f"redundancy_code_{n}" for n in NAMES])
    excluded = flags(state, [f"redundancy_excluded_{n}" for n in NAMES])
    usable, longest = good & ~excluded, by_row([STILL] * 4 + [LONGEST] * 2, y)
    count = reference_stage.rows(state, [f"redundancy_still_{n}" for n in NAMES])
    still = np.where(same, np.minimum(count + 1, longest), 0.0)
    value, ready = np.where(usable, y, expected), np.asarray(state["guard_ready"]) > 0
    gaps, named, after = _group(state, y[:4], value[:4], expected[:4], usable[:4], still[:4], ready)
    moved = (~same[:4] & excluded[:4] & good[:4]).any(axis=0)
    undecided = after["waited"] | ((np.asarray(state["redundancy_stuck_0"]) > 0) & moved)
    undecided = undecided | (np.asarray(state["redundancy_undecided_0"]) > 0)
    before = np.where(
        same[4:], reference_stage.rows(state, ["redundancy_before_x", "redundancy_before_z"]), expected[4:]
    )
    unanswered = reference_stage.rows(state, ["probe_x_attempt", "probe_z_attempt"]) >= attempts
    doubts = reference_stage.rows(state, ["redundancy_doubts_x", "redundancy_doubts_z"])
    changed = np.where(np.abs(expected[4:] - y[4:]) > GATE, DOUBTS, np.maximum(doubts - 1, 0))
    suspicious = ((doubts == 0) & (np.abs(expected[4:] - before) > GATE)) | unanswered
    stands = (still[4:] >= FRESH) & (np.abs(y[4:]) < TRAVEL) & suspicious
    frozen = (ready & stands & usable[4:]) | excluded[4:]
    trusted = usable[4:] & ~frozen
    value = np.concatenate([gaps, np.where(trusted, y[4:], expected[4:])])
    low, high = by_row(LOW[:SENSORS], y), by_row(HIGH[:SENSORS], y)
    suspects = np.concatenate([named | excluded[:4] | undecided, frozen])
    next: dict[str, Any] = {f"redundancy_code_{n}": v for n, v in zip(NAMES, y, strict=True)}
    next |= {f"redundancy_still_{n}": v for n, v in zip(NAMES, still, strict=True)}
    leave_out = np.concatenate([excluded[:4] | after["excluded"], frozen])
    next |= {"redundancy_before_x": before[0], "redundancy_before_z": before[1]}
    next |= zip(("redundancy_doubts_x", "redundancy_doubts_z"), np.where(same[4:], doubts, changed), strict=True)
    degraded = np.asarray(state["redundancy_degraded"]) > 0
    calm = ready & good.all(axis=0) & ~degraded & ~stands.any(axis=0)
    calm &= np.abs(np.sum(by_row(SIGN, y) * y[:4], axis=0)) <= THRESHOLD
    decisions = {f"redundancy_excluded_{n}": v for n, v in zip(NAMES, leave_out, strict=True)}
    decisions |= {"redundancy_stuck_0": after["stuck"], "redundancy_undecided_0": undecided}
    decisions["redundancy_degraded"] = degraded | suspects.any(axis=0) | leave_out.any(axis=0)
    next |= {n: np.where(calm, np.asarray(state[n]) > 0, v) for n, v in decisions.items()}
    next["redundancy_contradictions_0"] = np.where(calm, 0, after["count"])
    missing = np.sum(~usable[:4], axis=0)
    determined = (missing <= 1) & ~undecided
    regular = determined & trusted.all(axis=0)
    next |= {
        "determined": calm | determined,
        "regular": calm | regular,
        "sufficient": calm | (missing <= 2),
        "trusted": calm | trusted,
        "degraded": ~calm & ready,
    }
    return np.where(calm, y, np.clip(value, low, high)), ~calm & suspects, next


def _group(
    state: Columns, y: Array, value: Array, expected: Array, usable: Flags, still: Array, ready: Flags
) -> tuple[Array, Flags, dict[str, Any]]:
    """Return the gaps to use (4, n), which is named now, and what follows for the states."""
    sign = by_row(SIGN, y)
    r, missing = np.sum(sign * value, axis=0), np.sum(~usable, axis=0)
    wrong = (missing == 0) & (np.abs(r) > THRESHOLD) & ready
    E = np.where(r > 0, 1.0, -1.0) * sign * (y - expected)
    undecided = np.asarray(state["redundancy_undecided_0"]) > 0
    candidate = (still >= FRESH) & (CANDIDATE * np.abs(r) < E)
    first = candidate.any(axis=0)
    score = np.where(first, np.where(candidate, E, -1.0), E)
    order = np.sort(score, axis=0)
    alone = (still >= STILL) & (np.sum(still < FRESH, axis=0) == 3)
    second = alone.any(axis=0) & ~first
    third = (order[-1] - order[-2] > LEAD[1] * np.abs(r)) & ~undecided
    first &= order[-1] - order[-2] > LEAD[0] * np.abs(r)
    largest = np.arange(4).reshape(by_row(range(4), y).shape) == np.argmax(score, axis=0)
    named = np.where(second, alone, largest) & wrong & (first | second | third)
    replaced = named | (~usable & (missing == 1))
    count = np.asarray(state["redundancy_contradictions_0"])
    excluded = named & (count >= PERSISTENT - 1)
    stuck = (np.asarray(state["redundancy_stuck_0"]) > 0) | (excluded & (still >= FRESH)).any(axis=0)
    next = {"excluded": excluded, "stuck": stuck, "waited": wrong & (count >= UNDECIDED - 1)}
    next["count"] = np.where(wrong, np.minimum(count + 1, UNDECIDED), 0)
    return np.where(replaced, value - sign * r, value), named, next


def observe(
    state: Columns, q: Array, trusted: Flags, frozen: Flags, still: Array, ready: Flags
) -> tuple[Array, Array, Array, dict[str, Array]]:
    """Return position, rate and disturbance (5, n) after the correction by the pose q, and the next states."""
    p = by_row([exp(-w * T) for w in BANDWIDTH], q)
    before, v, d = (reference_stage.rows(state, [f"observer_{s}_{n}" for s in AXES]) for n in "qvd")
    nu = q - before
    low, high = (by_row(ends, q) for ends in zip(*RANGES, strict=True))
    rate, most = by_row(RATES, q), by_row(DISTURBANCES, q)
    position = np.where(ready, before + (1 - p**3) * nu, q)
    correction = 1.5 * (1 - p) ** 2 * (1 + p) / T * nu
    at_change, gained = (
        reference_stage.rows(state, [f"observer_{s}_{n}" for s in "xz"]) for n in ("d_at_change", "gained")
    )
    # A correction of the rate is that of d times 3/2 T (1 + p) / (1 - p).
    learnt = (1.5 * T * (1 + p) / (1 - p))[1:3] * (d[1:3] - at_change) + T * gained
    corrected = v + correction
    corrected[1:3] = np.where(trusted, corrected[1:3], v[1:3] - np.where(frozen, learnt, 0.0))
    v = np.where(ready, corrected, 0.0)
    d = np.where(ready, np.clip(d + (1 - p) ** 3 / T**2 * nu, -most, most), 0.0)
    d[1:3] = np.where(trusted, d[1:3], 0.0)
    same = trusted & (still >= 1)
    gained = np.where(same, (1 - LEAK) * gained + d[1:3] - at_change, 0.0)
    at_change = np.where(same, at_change, d[1:3])
    demand = reference_stage.rows(state, [f"delay_{DEMANDS[s]}_last" for s in AXES])
    g = reference_stage.rows(state, ["observer_x_g", "observer_z_g"])
    after_gain = np.clip(g + LEARNING * T * demand[1:3] * d[1:3], *GAINS)
    demand[1:3] *= g
    a = demand + d
    next_q, next_v = np.clip(position + T * (v + T / 2 * a), low, high), np.clip(v + T * a, -rate, rate)
    next = {f"observer_{s}_{n}": row for n, all in zip("qvd", (next_q, next_v, d), strict=True)
            for s, row in zip(AXES, all, strict=True)}  # fmt: skip
    for s, *each in zip("xz", after_gain, gained, at_change, strict=True):
        next |= {f"observer_{s}_{n}": row for n, row in zip(("g", "gained", "d_at_change"), each, strict=True)}
    return position, v, d, next


def land(
    state: Columns, w: Array, estimate: tuple[Array, Array, Array], phi: Array, regular: Flags, determined: Flags
) -> tuple[Array, dict[str, Any]]:
    """Return the demands (5, n), the tracking ones w or those of the landing, and the next states with `landed`."""
    q, v, d = estimate
    waiting = ~regular & (np.asarray(state["guard_ready"]) > 0)
    left, was = np.asarray(state["landing_left"]), np.asarray(state["landing_landing"]) > 0
    landing = was | (waiting & (left <= 1))
    next: dict[str, Any] = {"landing_left": np.where(waiting, np.maximum(left - 1, 1), reference_stage.BAD_SAMPLES)}
    next["landing_landing"] = landing
    ramp, rate = (np.where(was, reference_stage.rows(state, [f"landing_{n}_{s}" for s in AXES[:3]]), x[:3])
                  for n, x in (("r", q), ("dr", v)))  # fmt: skip
    speed = np.clip(TOUCH + DESCENT / SPEED * (END - ramp[0]), PRESS, SPEED)
    most = by_row([DESCENT * T, BRAKE * T, BRAKE * T], q)
    change = np.clip(np.array([speed - rate[0], -rate[1], -rate[2]]), -most, most)
    full = [np.concatenate([x, np.zeros_like(x[:2])]) for x in (ramp, rate, change / T)]
    p = np.where(determined, by_row(POLES, q), by_row(WITHOUT_GAPS, q))
    demand = p**2 * (full[0] - q) + 2 * p * (full[1] - v) + (full[2] - d)
    demand[3] = -PHI_SPRING * phi
    high = by_row([END + 4 * BEYOND, REACH, REACH], q)
    ahead = np.clip(np.where(was, ramp + T * rate + T / 2 * change, ramp), -REACH, high)
    for n, x in (("r", ahead), ("dr", np.clip(rate + change, -WIDE, WIDE))):
        before = reference_stage.rows(state, [f"landing_{n}_{s}" for s in AXES[:3]])
        next |= {f"landing_{n}_{s}": row for s, row in zip(AXES[:3], np.where(landing, x, before), strict=True)}
    landed = was & (np.asarray(state["landing_r_y"]) >= END + BEYOND)
    return np.where(landing, np.clip(demand, -1e4, 1e4), w), next | {"landed": landed}


def without_positions(state: Columns, computed: Array, trusted: Flags) -> tuple[Array, Array]:
    """Return the next transfer and the currents (6, n), as the commutation hands over direct currents."""
    i_d, (u_x, u_z), lost = computed[:4], computed[4:], ~trusted
    before = np.asarray(state["handover_transfer"], dtype=np.float64)
    active = lost.any(axis=0) | (before != 0)
    transfer = reference_phase.next_transfer(before, lost[0], lost[1])
    values = {f"i_d{j}": i for j, i in enumerate(i_d, 1)} | {"i_q1": u_z, "i_q2": u_x, "i_q3": u_z, "i_q4": u_x}
    direct = reference_phase.direct_currents(values, transfer, active)
    part = {"x": np.maximum(transfer, 0), "z": np.maximum(-transfer, 0)}
    kept = [np.where(active, (1 - part["zxzx"[j - 1]]) * direct[j], i) for j, i in enumerate(i_d, 1)]
    return np.where(active, transfer, 0), np.concatenate([kept, computed[4:]])


def exceeds_limit(count: Any) -> Flags:
    """Return whether too many calls are missing, or their count is negative or NaN."""
    with np.errstate(invalid="ignore"):
        return ~((np.asarray(count) >= 0) & (np.asarray(count) <= MISSED_CALLS))


def step(
    state: Columns, inputs: Columns, law: Law, at_rest: reference_probe.Probe = reference_probe.PROBE
) -> tuple[dict[str, Array], dict[str, Array], NDArray[Any]]:
    """Return (next state, outputs, fault word) of one sample of a law with its fault handling, columns by name."""
    values, after, word = reference_stage.guard(state, inputs)
    good = np.array([(word & bit) == 0 for bit in reference_stage.BITS[:SENSORS]])
    ready, was_latched = np.asarray(state["guard_ready"]) > 0, np.asarray(state["guard_latched"]) > 0
    q = reference_stage.rows(state, [f"observer_{s}_q" for s in AXES])
    used, suspects, after_readings = readings(state, values[:SENSORS], good, q, at_rest.attempts)
    flag = {n: after_readings.pop(n) for n in ("regular", "sufficient", "trusted", "determined", "degraded")}
    pose = reference_stage.pose(used, reference_stage.Parameters().r)
    still = np.array([after_readings[f"redundancy_still_{s}"] for s in "xz"])
    q, v, d, after_observers = observe(state, pose, flag["trusted"], suspects[4:], still, ready)
    last, e = reference_stage.rows(state, LAST), pose - values[SENSORS:]
    w, finish = law(state, pose, values[SENSORS:], ready)
    w, after_landing = land(state, w, (q, v, d), pose[3], flag["regular"], flag["determined"])
    free = flag["regular"] & (state["observer_y_q"] < LIFTED)
    w[1:3], after_probe = reference_probe.probe(w[1:3], e[1:3], state, still, free, at_rest)
    computed, thrust, after_law = finish(w, used[:4], last)
    transfer, computed = without_positions(state, computed, flag["trusted"])
    enough = np.where(ready, flag["sufficient"] & flag["trusted"].any(axis=0), good.all(axis=0))
    left = np.where(enough, reference_stage.BAD_SAMPLES, np.asarray(state["guard_left"]) - 1)
    latched = was_latched | (left < 1) | after_landing.pop("landed")
    after |= {"guard_left": np.maximum(left, 1), "guard_latched": latched}
    demands = {"w_y": w[0], "a_x": thrust[0], "a_z": thrust[1], "w_phi": w[3], "w_theta": w[4]}
    next: dict[str, Any] = (
        after_readings
        | after_observers
        | after_landing
        | after_probe
        | {f"delay_{n}_last": np.clip(x, -DELAYED, DELAYED) for n, x in demands.items()}
    )
    next["handover_transfer"] = transfer
    next |= after_law
    after |= {n: np.where(latched, state[n], x) for n, x in next.items()}
    out = np.where(latched, np.clip([*SAFE.values()], last.T - SLEW, last.T + SLEW).T, computed)
    after |= zip(LAST, out, strict=True)
    word = (
        (word & 0x7FF)
        | (1 << np.arange(11, 17)) @ suspects
        | (flag["degraded"].astype(np.uint32) << 17)
        | (exceeds_limit(inputs["missed_calls"]).astype(np.uint32) << 18)
        | ((next["landing_landing"] & ~latched).astype(np.uint32) << 30)
        | (latched.astype(np.uint32) << 31)
    )
    outputs = dict(zip(OUTPUTS, np.concatenate([out[:4], out[reference_stage.QUADRATURE]]), strict=True))
    positions = np.where(latched & ~flag["trusted"], LOST, used[4:])
    outputs |= {"x_commutation": positions[0], "z_commutation": positions[1]}
    return after, outputs, np.asarray(word).astype(np.uint32)
