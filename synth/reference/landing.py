"""Landing along ramps, and missed calls, in NumPy: reference of `blocks.landing` and `blocks.missed_calls`.

w = p^2 (r - q) + 2 p (r' - v) + r'' - d along ramps r, the first one down to its stop, the others braked to rest
"""

from collections.abc import Mapping
from dataclasses import dataclass
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
