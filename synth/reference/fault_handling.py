"""Landing along ramps, and missed calls, in NumPy: reference of `blocks.landing` and `blocks.missed_calls`.

w = p^2 (r - q) + 2 p (r' - v) + r'' - d along ramps r, the first one down to its stop, the others braked to rest

Observers of position, rate and disturbance that predict a sample ahead, in NumPy: reference of `blocks.predictor`.

    q'' = g a + d for each axis, with the innovation nu = q measured - q predicted:
    q + alpha nu, v + beta nu, d + gamma nu; triple pole p = exp(-w T), alpha = 1 - p^3,
    beta = 3/2 (1 - p)^2 (1 + p) / T, gamma = (1 - p)^3 / T^2

An axis that learns has the gain g of its actuator as a state. Once its measurement is found frozen, what the
corrections since the last change of its code have added to the rate is taken back.

Readings replaced by parity and prediction, and sensors excluded, in NumPy.

It is the reference of `blocks.redundancy` and, for the `others`, of `blocks.innovation_monitor`.

parity       sum of s_j y_j = 0 for the sensors of a relation, s_j = +-1: a refused one follows from the others, two
             or more follow from the predictions
isolation    for |sum of s_j y_j| above a threshold, which its mean squared change in a sample raises: by codes that
             stand still and by innovations
others       a code that stands still while the prediction moves by more than a gate is frozen; a reading further
             than `jump` from a prediction that is believed has jumped; both need an earlier agreement
             unless the distance grew by more than a wide gate since the last change of the code

Probe of sensors at rest, in NumPy: reference of `blocks.probe`.

+a for n samples, -a for 2 n, +a for n;   a = step / (n T)^2 times k + 1, or (-1)^k (1 + k/2) to both sides
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import exp
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.reference.guard import by_row, leak, rows

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Columns = Mapping[str, NDArray[Any]]


@dataclass(frozen=True)
class Landing:
    """Poles in rad/s of every axis, with and without what determines them; the first `braking` axes follow ramps.

    The first descends to `end` with `speed`, slower by `descent` towards `touch` before it, and `press` beyond; it has
    landed at `end + beyond`. `braking` are the decelerations of the others; `most` bounds a demand, `fastest` and
    `farthest` the ramps.
    """

    poles: Mapping[str, float]
    undetermined_poles: Mapping[str, float]
    end: float
    beyond: float
    speed: float
    touch: float
    press: float
    descent: float
    braking: tuple[float, ...]
    bad_samples: int
    good_samples: int
    T: float
    most: float = 1e4
    fastest: float = 10.0
    farthest: float = 0.5

    @property
    def ramps(self) -> list[str]:
        """The axes that follow a ramp."""
        return list(self.poles)[: 1 + len(self.braking)]


def demand(
    state: Columns, estimate: tuple[Array, Array, Array], regular: Flags, determined: Flags, of: Landing
) -> tuple[Array, Flags, dict[str, Any]]:
    """Return the demands (m, n) of a landing, whether it lands, and the next states; `landed` is beside them."""
    (q, v, d), T, ramps = estimate, of.T, of.ramps
    waiting = ~regular & (np.asarray(state["guard_ready"]) > 0)
    was = np.asarray(state["landing_landing"]) > 0
    left, over = leak(np.asarray(state["landing_left"]), waiting, of.bad_samples, of.good_samples)
    landing = was | over
    next: dict[str, Any] = {"landing_left": left}
    next["landing_landing"] = landing
    high = by_row([of.end + 4 * of.beyond, *(of.farthest for _ in of.braking)], q)
    start = np.clip(q[: len(ramps)], -of.farthest, high)
    ramp, rate = (
        np.where(was, rows(state, [f"landing_{n}_{s}" for s in ramps]), x[: len(ramps)])
        for n, x in (("r", start), ("dr", np.clip(v, -of.fastest, of.fastest)))
    )
    speed = np.clip(of.touch + of.descent / of.speed * (of.end - ramp[0]), of.press, of.speed)
    most = by_row([of.descent * T, *(b * T for b in of.braking)], q)
    change = np.clip(np.array([speed - rate[0], *(-rate[1:])]), -most, most)
    still = np.zeros_like(q[len(ramps) :])
    full = [np.concatenate([x, still]) for x in (ramp, rate, change / T)]
    poles, undetermined = (by_row([*each.values()], q) for each in (of.poles, of.undetermined_poles))
    p = np.where(determined, poles, undetermined)
    w = p**2 * (full[0] - q) + 2 * p * (full[1] - v) + (full[2] - d)
    ahead = np.where(was, np.clip(ramp + T * rate + T / 2 * change, -of.farthest, high), ramp)
    for n, x in (("r", ahead), ("dr", rate + change)):
        before = rows(state, [f"landing_{n}_{s}" for s in ramps])
        next |= {f"landing_{n}_{s}": row for s, row in zip(ramps, np.where(landing, x, before), strict=True)}
    landed = was & (np.asarray(state[f"landing_r_{ramps[0]}"]) >= of.end + of.beyond)
    return w, landing, next | {"landed": landed}


def misses_calls(count: Any, limit: float) -> Flags:
    """Return whether more calls than `limit` are missing, or their count is negative or NaN."""
    with np.errstate(invalid="ignore"):
        return ~((np.asarray(count) >= 0) & (np.asarray(count) <= limit))


LEAK = 1 / 512  # of what a sample forgets of the corrections since the last change


@dataclass(frozen=True)
class Axis:
    """An axis: bandwidth in rad/s, bounds of position, rate and disturbance, and whether it learns."""

    bandwidth: float
    low: float
    high: float
    rate: float
    disturbance: float
    learns: bool = False


@dataclass(frozen=True)
class Observers:
    """The axes by name, the period in s, and rate in 1/s and bounds of the gains that are learnt."""

    axes: Mapping[str, Axis]
    T: float
    learning: float
    gains: tuple[float, float]

    def each(self, what: str, like: Array) -> Array:
        """Return a number of each axis as a column."""
        return by_row([getattr(axis, what) for axis in self.axes.values()], like)

    @property
    def learning_axes(self) -> list[str]:
        """The axes that learn."""
        return [name for name, axis in self.axes.items() if axis.learns]


def positions(state: Columns, axes: Sequence[str]) -> Array:
    """Return the positions that are predicted for this sample (m, n)."""
    return rows(state, [f"observer_{s}_q" for s in axes])


def observe(
    state: Columns, q: Array, demand: Array, trusted: Flags, frozen: Flags, still: Array, ready: Flags, of: Observers
) -> tuple[Array, Array, Array, dict[str, Array]]:
    """Return position, rate and disturbance (m, n) after the correction by the pose q, and the next states.

    `demand` (m, n) are the accelerations that act. `trusted`, `frozen` and the samples without a change are those of
    the axes that learn.
    """
    T, learning = of.T, of.learning_axes
    learns = [name in learning for name in of.axes]
    p = by_row([exp(-axis.bandwidth * T) for axis in of.axes.values()], q)
    before, v, d = (rows(state, [f"observer_{s}_{n}" for s in of.axes]) for n in "qvd")
    nu = q - before
    rate, most = of.each("rate", q), of.each("disturbance", q)
    position = np.where(ready, before + (1 - p**3) * nu, q)
    correction = 1.5 * (1 - p) ** 2 * (1 + p) / T * nu
    at_change, gained = (rows(state, [f"observer_{s}_{n}" for s in learning]) for n in ("d_at_change", "gained"))
    # A correction of the rate is that of d times 3/2 T (1 + p) / (1 - p).
    learnt = (1.5 * T * (1 + p) / (1 - p))[learns] * (d[learns] - at_change) + T * gained
    corrected = v + correction
    corrected[learns] = np.where(trusted, corrected[learns], v[learns] - np.where(frozen, learnt, 0.0))
    v = np.where(ready, corrected, 0.0)
    d = np.where(ready, np.clip(d + (1 - p) ** 3 / T**2 * nu, -most, most), 0.0)
    d[learns] = np.where(trusted, d[learns], 0.0)
    same = trusted & (still >= 1)
    gained = np.where(same, (1 - LEAK) * gained + d[learns] - at_change, 0.0)
    at_change = np.where(same, at_change, d[learns])
    g, acting = rows(state, [f"observer_{s}_g" for s in learning]), demand.copy()
    next_gain = np.clip(g + of.learning * T * demand[learns] * d[learns], *of.gains)
    acting[learns] *= g
    a = acting + d
    next_q = np.clip(position + T * (v + T / 2 * a), of.each("low", q), of.each("high", q))
    next_v = np.clip(v + T * a, -rate, rate)
    after = {"q": next_q, "v": next_v, "d": d}
    next = {f"observer_{s}_{n}": row for n, each in after.items() for s, row in zip(of.axes, each, strict=True)}
    after = {"g": next_gain, "gained": gained, "d_at_change": at_change}
    next |= {f"observer_{s}_{n}": row for n, each in after.items() for s, row in zip(learning, each, strict=True)}
    return position, v, d, next


FRESH, STILL, PERSISTENT, UNDECIDED, DOUBTS = 3, 8, 3, 10, 10  # samples, changes of a code
CANDIDATE, LEAD = 0.4, (0.05, 0.3)  # of |r|
LEARNT = 1 / 128  # of the squared threshold, in a sample without a contradiction


@dataclass(frozen=True)
class Sensors:
    """The sensors of the relation with their signs and its threshold, and the `others` with gates and travel.

    Its square is `threshold`^2 + `gain` m, m the mean squared change of the residual, and at most `largest`^2.
    Samples without a change of the others are counted up to `longest`. Readings are limited to `low` .. `high`.
    """

    signs: Mapping[str, float]
    threshold: float
    gain: float
    largest: float
    others: Sequence[str]
    gate: float
    frozen: float
    jump: float
    wide_jump: float
    wide_frozen: float
    travel: float
    longest: int
    low: Array
    high: Array

    @property
    def sensors(self) -> tuple[str, ...]:
        """All sensors."""
        return (*self.signs, *self.others)

    def states(self, what: str) -> list[str]:
        """Return the names of a state of all sensors."""
        return [f"redundancy_{what}_{n}" for n in self.signs] + [f"{n}_monitor_{what}" for n in self.others]

    def parity(self, y: Array) -> Array:
        """Return the parity of some readings; its rows are those of the relation."""
        return np.asarray(np.sum(self.column(y) * y, axis=0))

    def column(self, like: Array) -> Array:
        """Return the signs as a column."""
        return by_row([*self.signs.values()], like)


def readings(
    state: Columns, y: Array, good: Flags, expected: Array, attempts: int, missed: Array, of: Sensors
) -> tuple[Array, Flags, dict[str, Flags], dict[str, Any]]:
    """Return the readings to use (m, n), the suspects (m, n), flags of the sample, and the next states.

    `expected` are the predicted readings; `attempts` of the probe without an answer exclude one of the others. A jump
    is not looked for in a sample before which calls were `missed`.
    """
    g = len(of.signs)
    same = y == rows(state, of.states("code"))
    excluded = rows(state, of.states("excluded")) > 0
    usable, longest = good & ~excluded, by_row([STILL] * g + [of.longest] * len(of.others), y)
    count = rows(state, of.states("still"))
    value, ready = np.where(usable, y, expected), np.asarray(state["guard_ready"]) > 0
    still = np.where(same, np.minimum(count + 1, longest), 0.0)
    judging = ready & ~(np.asarray(state["guard_latched"]) > 0)  # once latched, the observers stand still
    r, bound = of.parity(y[:g]), np.asarray(state["redundancy_bound_0"])
    threshold = np.sqrt(bound)
    related, named, after = _isolate(state, of, threshold, y[:g], value[:g], expected[:g], usable[:g], still[:g], ready)
    readmitted = ~same[:g] & excluded[:g] & good[:g] & (np.asarray(state["redundancy_stuck_0"]) > 0)
    undecided = after["waited"] | readmitted.any(axis=0)
    undecided = undecided | (np.asarray(state["redundancy_undecided_0"]) > 0)
    remembered = rows(state, of.states("before")[g:])
    before = np.where(ready, np.where(same[g:], remembered, expected[g:]), y[g:])
    unanswered = rows(state, [f"probe_{n}_attempt" for n in of.others]) >= attempts
    doubts = rows(state, of.states("doubts")[g:])
    distance, counted = np.abs(expected[g:] - y[g:]), rows(state, of.states("jumps")[g:])
    last = rows(state, of.states("code")[g:])
    growth = distance - np.abs(last - remembered)
    with np.errstate(invalid="ignore"):
        believed = judging & ((doubts == 0) | (growth > of.wide_jump)) & (np.asarray(missed) == 0)
    believed &= (np.abs(expected[g:]) < of.travel) & (np.abs(last) < of.travel)
    far = distance > of.jump
    doubted = np.where(far & believed, doubts, np.where(distance > of.gate, DOUBTS, np.maximum(doubts - 1, 0)))
    suspicious = ((doubts == 0) & (np.abs(expected[g:] - before) > of.frozen)) | (growth > of.wide_frozen) | unanswered
    stands = ready & (still[g:] >= FRESH) & (np.abs(y[g:]) < of.travel) & suspicious
    jumps = far & ((counted > 0) | (believed & ~same[g:]))
    freezes = stands & ~jumps & usable[g:]
    degraded = np.asarray(state["redundancy_degraded"]) > 0
    sound = ready & good.all(axis=0) & ~degraded
    usual = sound & ~stands & ~jumps
    stopped = ~usual & (freezes | excluded[g:])
    wrong = stopped | (~usual & jumps)
    out = ~usual & (np.where(jumps, counted >= PERSISTENT - 1, freezes) | excluded[g:])
    trusted = usual | (usable[g:] & ~wrong)
    value = np.concatenate([related, np.where(trusted, y[g:], expected[g:])])
    low, high = by_row(of.low, y), by_row(of.high, y)
    suspects = np.concatenate([named | excluded[:g] | undecided, wrong])
    next: dict[str, Any] = dict(zip(of.states("code"), y, strict=True))
    next |= dict(zip(of.states("still"), still, strict=True))
    next |= dict(zip(of.states("before")[g:], before, strict=True))
    kept_doubts = np.where(same[g:], doubts, doubted)
    next |= dict(zip(of.states("doubts")[g:], kept_doubts, strict=True))
    calm = sound & usual.all(axis=0) & (np.abs(r) <= threshold)
    last_r = np.asarray(state["redundancy_last_residual_0"])
    learnt = (1 - LEARNT) * bound + LEARNT * (of.threshold**2 + of.gain * (r - last_r) ** 2)
    next["redundancy_bound_0"] = np.where(calm, np.minimum(learnt, of.largest**2), bound)
    next["redundancy_last_residual_0"] = np.where(calm, r, last_r)
    jump_counts = np.where(jumps & (counted < PERSISTENT - 1), counted + 1, 0)
    next |= dict(zip(of.states("jumps")[g:], jump_counts, strict=True))
    next |= dict(zip(of.states("excluded")[g:], out, strict=True))
    leave_out = (excluded[:g] & ~readmitted) | after["excluded"]
    decisions = dict(zip(of.states("excluded")[:g], leave_out, strict=True))
    decisions |= {"redundancy_stuck_0": after["stuck"], "redundancy_undecided_0": undecided}
    decisions["redundancy_degraded"] = degraded | suspects.any(axis=0) | leave_out.any(axis=0) | out.any(axis=0)
    next |= {n: np.where(calm, np.asarray(state[n]) > 0, v) for n, v in decisions.items()}
    next["redundancy_contradictions_0"] = np.where(calm, 0, after["count"])
    missing = np.sum(~usable[:g], axis=0)
    determined = (missing <= 1) & ~undecided
    flags = {
        "determined": calm | determined,
        "regular": calm | (determined & trusted.all(axis=0)),
        "sufficient": calm | (missing <= 2),
        "trusted": trusted,
        "degraded": ~calm & ready,
        "frozen": stopped,
    }
    return np.where(calm, y, np.clip(value, low, high)), ~calm & suspects, flags, next


def _isolate(
    state: Columns,
    of: Sensors,
    threshold: Array,
    y: Array,
    value: Array,
    expected: Array,
    usable: Flags,
    still: Array,
    ready: Flags,
) -> tuple[Array, Flags, dict[str, Any]]:
    """Return the readings of the relation to use, which is named now, and what follows for the states."""
    sign = of.column(y)
    r, missing = of.parity(value), np.sum(~usable, axis=0)
    wrong = (missing == 0) & (np.abs(r) > threshold) & ready
    E = np.where(r > 0, 1.0, -1.0) * sign * (y - expected)
    undecided = np.asarray(state["redundancy_undecided_0"]) > 0
    candidate = (still >= FRESH) & (CANDIDATE * np.abs(r) < E)
    first = candidate.any(axis=0)
    score = np.where(first, np.where(candidate, E, -1.0), E)
    order = np.sort(score, axis=0)
    alone = (still >= STILL) & (np.sum(still < FRESH, axis=0) == len(y) - 1)
    second = alone.any(axis=0) & ~first
    third = (order[-1] - order[-2] > LEAD[1] * np.abs(r)) & ~undecided
    first &= order[-1] - order[-2] > LEAD[0] * np.abs(r)
    largest = np.arange(len(y)).reshape(by_row(range(len(y)), y).shape) == np.argmax(score, axis=0)
    named = np.where(second, alone, largest) & wrong & (first | second | third)
    by_parity = named | (~usable & (missing == 1))
    count = np.asarray(state["redundancy_contradictions_0"])
    excluded = named & (count >= PERSISTENT - 1)
    stuck = (np.asarray(state["redundancy_stuck_0"]) > 0) | (excluded & (still >= FRESH)).any(axis=0)
    next = {"excluded": excluded, "stuck": stuck, "waited": wrong & (count >= UNDECIDED - 1)}
    next["count"] = np.where(wrong, np.minimum(count + 1, UNDECIDED), 0)
    return np.where(by_parity, value - sign * r, value), named, next


MEMORY = ("sample", "attempt", "towards")


@dataclass(frozen=True)
class Probe:
    """Samples of waiting and of a quarter, first displacement in m, pairs, whether to both sides, period and bound."""

    quiet: int
    quarter: int
    step: float
    attempts: int
    T: float
    both_sides: bool = False
    most: float = 1e4  # of a demand


def probe(
    axes: Sequence[str], w: Array, e: Array, state: Columns, still: Array, free: Flags, by: Probe
) -> tuple[Array, dict[str, Array]]:
    """Return the demands of some axes (m, n) with the pairs of the probe, and its next states."""
    sample, attempt, towards = (rows(state, [f"probe_{s}_{n}" for s in axes]) for n in MEMORY)
    pair, acceleration = 4 * by.quarter + 3, by.step / (by.quarter * by.T) ** 2
    runs, waits = sample > 0, still >= by.quiet
    ends, failures = sample >= pair, np.minimum(attempt + 1, by.attempts)
    starts = waits & free
    after = np.where(ends, np.where(still >= pair, failures, 0), attempt)
    other = np.where(ends, -towards, towards) if by.both_sides else towards
    first = np.where(e > 0, -acceleration, acceleration)
    first = np.where(attempt >= 1, towards, first) if by.both_sides else first
    new = (
        np.where(runs, np.where(ends, 0, sample + 1), starts),
        np.where(runs, after, attempt),
        np.where(runs, other, first),
    )
    idle, next = (np.zeros_like(sample), np.zeros_like(sample), towards), dict[str, Array]()
    for n, value, unprobed in zip(MEMORY, new, idle, strict=True):
        each = np.where(runs | waits, value, unprobed)
        next |= {f"probe_{s}_{n}": row for s, row in zip(axes, each, strict=True)}
    push = towards * ((attempt / 2 if by.both_sides else attempt) + 1)
    inner = (sample > by.quarter) & (sample <= 3 * by.quarter)
    pulse = np.where(sample <= 4 * by.quarter, np.where(inner, -push, push), 0.0)
    return np.where(runs, np.clip(w + pulse, -by.most, by.most), w), next
