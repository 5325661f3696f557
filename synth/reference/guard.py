"""Guard and safe output of a controller in NumPy: reference of `blocks.safety`.

accept   a value outside its range, or NaN, is replaced by the last accepted one, or by 0; its fault bit is set
count    after a number of samples in a row with a bad measurement, the latch
slew     once latched, outputs move to their safe values, and the states of the law stand still
"""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Flags = NDArray[np.bool_]
Columns = Mapping[str, Array]
Limits = Mapping[str, tuple[float, float]]
LATCH = 31  # bit of the fault word
MAY_LATCH_FROM = 2  # samples left before one that may latch


@dataclass(frozen=True)
class Accepted:
    """The values to use and whether each input is good, by name, and the next states of the guard."""

    values: dict[str, Array]
    good: dict[str, Flags]
    after: dict[str, Array]

    @property
    def word(self) -> Array:
        """The bits of the refused inputs, in their order."""
        return (1 << np.arange(len(self.good))) @ np.array([~good for good in self.good.values()])


def rows(columns: Columns, names: Iterable[str]) -> Array:
    """Return some columns (n,) as the rows of one array (m, n)."""
    return np.array([columns[name] for name in names], dtype=np.float64)


def by_row(values: Any, like: Array) -> Array:
    """Return values (m,) as a column for rows (m, n)."""
    return np.reshape(np.asarray(values, dtype=float), (-1,) + (1,) * (like.ndim - 1))


def accept(
    state: Columns,
    inputs: Columns,
    limits: Limits,
    zeroed: Collection[str] = (),
    called: Mapping[str, str] | None = None,
) -> Accepted:
    """Return the guarded inputs; refused ones of `zeroed` become 0. `called` are the inputs whose names differ."""
    u = {n: np.asarray(inputs[(called or {}).get(n, n)], dtype=np.float64) for n in limits}
    with np.errstate(invalid="ignore"):
        good = {n: (u[n] >= low) & (u[n] <= high) for n, (low, high) in limits.items()}
    values = {n: np.where(good[n], u[n], 0.0 if n in zeroed else state[f"guard_last_{n}"]) for n in limits}
    return Accepted(values, good, {f"guard_last_{n}": v for n, v in values.items() if n not in zeroed})


def count(state: Columns, complete: Flags, bad_samples: int, good_samples: int = 0) -> dict[str, Array]:
    """Return the next count before the latch, the latch, and whether all measurements have been good once.

    Where `good_samples` make up for a bad one, a bad one takes so many from the count and a good one gives one back.
    """
    left, over = leak(np.asarray(state["guard_left"]), ~complete, bad_samples, good_samples)
    return {
        "guard_left": left,
        "guard_latched": np.where(over, 1, state["guard_latched"]),
        "guard_ready": np.where(complete, 1, state["guard_ready"]),
    }


def leak(left: Array, bad: Flags, bad_samples: int, good_samples: int) -> tuple[Array, Flags]:
    """Return the next count and whether bad samples have used it up, where it stays."""
    each = good_samples or 1
    restored = np.minimum(left + 1, bad_samples * each) if good_samples else bad_samples
    over = bad & (left <= each)
    return np.where(over, left, np.where(bad, left - each, restored)), over


def fault_word(bits: Any, after: Columns) -> Array:
    """Return the fault word of some bits, with that of the latch."""
    return np.asarray(bits + (1 << LATCH) * (after["guard_latched"] > 0)).astype(np.uint32)


def standard(
    state: Columns,
    inputs: Columns,
    limits: Limits,
    measurements: Collection[str],
    bad_samples: int,
    good_samples: int = 0,
) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Return the values to use, the next states of the guard and the fault word; bad `measurements` latch."""
    accepted = accept(state, inputs, limits)
    complete = np.all([accepted.good[n] for n in measurements], axis=0)
    after = accepted.after | count(state, complete, bad_samples, good_samples)
    return accepted.values, after, fault_word(accepted.word, after)


def frozen(state: Columns, after: Columns, latched: Flags) -> dict[str, Array]:
    """Return the next states of the law, which stand still once latched."""
    return {n: np.where(latched, state[n], v) for n, v in after.items()}


def begun(state: Columns, demands: Columns, complete: Flags) -> dict[str, Array]:
    """Return the demands, 0 before the first complete sample: reference of `blocks.start`."""
    known = (np.asarray(state["guard_ready"]) > 0) | complete
    return {name: np.where(known, d, 0.0) for name, d in demands.items()}


def slew(
    state: Columns, computed: Columns, latched: Flags, step: float, safe: Mapping[str, float | Array] | None = None
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return the outputs and the next states of the safe output: once latched, by `step` a sample to `safe`, else 0."""
    outputs = {}
    for n, value in computed.items():
        last = np.asarray(state[f"safe_output_last_{n}"])
        outputs[n] = np.where(latched, np.clip((safe or {}).get(n, 0.0), last - step, last + step), value)
    return outputs, {f"safe_output_last_{n}": v for n, v in outputs.items()}


def stored_before_latch(state: Columns, last: Columns, latched: Flags) -> dict[str, Array]:
    """Return the next states of the safe output behind a guard that brakes, from those of `slew`.

    They are stored once latched, and where the next sample may latch.
    """
    stored = latched | (np.asarray(state["guard_left"]) <= MAY_LATCH_FROM)
    return {n: np.where(stored, v, state[n]) for n, v in last.items()}


def initial_state(limits: Limits, outputs: Iterable[str], left: int, zeroed: Collection[str] = ()) -> dict[str, Array]:
    """Return the states of guard and safe output after init, with 0 for every last value."""
    names = [f"guard_last_{n}" for n in limits if n not in zeroed] + [f"safe_output_last_{n}" for n in outputs]
    names += ["guard_latched", "guard_ready"]
    return {n: np.array(0.0) for n in names} | {"guard_left": np.array(float(left))}
