"""Watch over repeated codes in NumPy: reference of `blocks.repeated_codes`.

One channel is watched at a time, in measured samples. A sample between two watches compares nothing; the first watch
waits until it goes on. Then the code is stored, and each further sample counts while it repeats the code. With N equal
codes in a row the channel is frozen; a different code ends the watch, and the channel before follows. ``watch_left`` is
N + 1 between two watches, then N less the equal codes so far.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Columns = Mapping[str, Array]


def initial_state(owner: str, repeats: int) -> dict[str, Array]:
    """Return the state of the Block `owner` after init, by name."""
    zero = {f"{owner}_{name}": np.array(0.0) for name in ("watch_channel", "frozen", "watch_code")}
    return zero | {f"{owner}_watch_left": np.array(repeats + 1.0)}


def next_state(
    owner: str,
    state: Columns,
    read: Columns,
    channels: Sequence[str],
    measured: Array,
    goes_on: Array | bool,
    repeats: int,
) -> tuple[dict[str, Array], Array, Array]:
    """Return the next state, the samples between two watches, and those that show a channel to be frozen."""
    i, left, stored, frozen = (
        np.asarray(state[f"{owner}_{n}"]) for n in ("watch_channel", "watch_left", "watch_code", "frozen")
    )
    code = np.choose(i.astype(int), np.broadcast_arrays(*(read[c] for c in channels)))
    between, begins, compares = (measured & c for c in (left > repeats, left == repeats, left < repeats))
    repeated, differs = compares & (code == stored), compares & (code != stored)
    is_last = repeated & (left <= 1)
    phases = [between & goes_on, begins, is_last, repeated, differs]
    after = {
        "watch_channel": np.where(differs, (i - 1) % len(channels), i),
        "watch_left": np.select(phases, [repeats, repeats - 1, left, left - 1, repeats + 1], left),
        "frozen": np.where(is_last, i + 1, frozen),
        "watch_code": np.where(begins, code, stored),
    }
    return {f"{owner}_{name}": value for name, value in after.items()}, between, is_last
