"""Stimuli as independent steps (x_k, u_k): each step stores its state and can be omitted.

record          x_{k+1} = step(x_k, u_k) from `init`, by the compiled C
random_steps    x random in its declared bounds, u random in its range, at its ends, beyond, or NaN
resampled       existing steps with some entries of x resampled
fault_steps     every input bad, alone and all at once, for 1 sample up to the latch, and latched until outputs settle
contradictory   existing steps in which some readings disagree, stand still or are refused, with flags resampled
edge_steps      every input alone at an end of its range, at the next number beyond, or at a special number such as -0
perturbed       existing steps with x and u perturbed
rarest          the steps with the least frequent flags
at_range_ends   the steps in which an output or x_{k+1} reaches, or nearly reaches, an end of its range
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth.blocks.guard import safety
from synth.errors import SignalError
from synth.execute import host, trace

SEED = 19_680
GOOD, LATCHED = 4, 80  # samples before and after bad ones, and samples after the latch
_BEYOND = 0.1  # of the range
_INTEGERS = ("uint32_t", "int32_t")


@dataclass(frozen=True, eq=False)
class Steps:
    """N steps: `states` (N,) and `inputs` (N,), records of the emitted structs.

    `closed_loop` marks steps of a controlled plant.
    """

    name: str
    states: host.Records
    inputs: host.Records
    closed_loop: bool = False

    def __len__(self) -> int:
        return len(self.inputs)

    def part(self, chosen: slice | NDArray[np.intp]) -> "Steps":
        """Return the chosen steps."""
        return Steps(self.name, self.states[chosen], self.inputs[chosen], self.closed_loop)


def record(
    controller: host.Controller,
    name: str,
    inputs: Mapping[str, ArrayLike],
    closed_loop: bool = False,
    initial: Mapping[str, float] = MappingProxyType({}),
) -> Steps:
    """Return the N steps under input columns (N,) or constants, with the state before each.

    The first is that after `init`, with `initial` states. Raises SignalError as `trace.states`.
    """
    n = host.length(inputs)
    states = trace.states(controller, inputs, initial)
    return Steps(name, states[:n], controller.records(inputs, n), closed_loop)


def concatenate(name: str, parts: Sequence[Steps]) -> Steps:
    """Concatenate steps; raise SignalError for an empty sequence."""
    if not parts:
        raise SignalError(f"steps '{name}': found no part, need at least one: give sequences")
    states, inputs = np.concatenate([p.states for p in parts]), np.concatenate([p.inputs for p in parts])
    return Steps(name, states, inputs, all(p.closed_loop for p in parts))


def thinned(steps: Steps, n: int) -> Steps:
    """Return at most n of the steps, evenly spaced."""
    chosen = np.linspace(0, len(steps) - 1, min(n, len(steps))).round().astype(np.intp)
    return steps.part(chosen)


def evaluate(controller: host.Controller, steps: Steps) -> host.Batch:
    """Return the results of the compiled C for each step."""
    return controller.batch(np.ascontiguousarray(steps.states), host.columns(steps.inputs))


def without_faults(controller: host.Controller, steps: Steps) -> Steps:
    """Return the steps in whose fault words no bit but those of a status is set."""
    return steps.part(np.flatnonzero(evaluate(controller, steps).faults & ~controller.status_mask == 0))


def in_range(controller: host.Controller, n: int) -> Steps:
    """Record n steps under inputs drawn uniformly from their declared ranges, independently for each sample."""
    rng = np.random.default_rng(SEED)
    fields = _fields(controller, "input")
    return record(controller, "random inputs in range", {f["name"]: _uniform(rng, f, n) for f in fields})


def random_steps(controller: host.Controller, n: int) -> Steps:
    """Draw n steps: states in their declared bounds and often at their ends, inputs also out of range."""
    rng = np.random.default_rng(SEED + 1)
    states, inputs = np.zeros(n, controller.state), np.zeros(n, controller.inputs)
    for f in _fields(controller, "state"):
        states[f["name"]] = _replace_some(rng, _uniform(rng, f, n), (f["low"], f["high"]), 0.4)
    for f in _fields(controller, "input"):
        inputs[f["name"]] = _replace_some(rng, _uniform(rng, f, n), (f["low"], f["high"], *_invalid_values(f)), 0.1)
    return Steps("random states and inputs", states, inputs)


def resampled(controller: host.Controller, steps: Steps, name: str) -> Steps:
    """Return steps with some states resampled as in `random_steps`: in a third none, in others few or half."""
    rng = np.random.default_rng(SEED + 2)
    n, states = len(steps), steps.states.copy()
    share = rng.choice((0.0, 0.03, 0.5), n)
    for f in _fields(controller, "state"):
        values = _replace_some(rng, _uniform(rng, f, n), (f["low"], f["high"]), 0.4)
        chosen = rng.uniform(size=n) < share
        states[f["name"]][chosen] = values[chosen]
    return Steps(name, states, steps.inputs)


def contradictory(controller: host.Controller, steps: Steps) -> Steps:
    """Return steps in which some readings differ from the others, are those before, or NaN.

    For most refused readings the code before it serves. Some predictions have moved since their code changed. The
    whole-number states of redundancy, monitors, landing and probe are resampled. The result is empty for a controller
    that replaces no readings.
    """
    measurements = ((controller.manifest["safety"] or {}).get("judgement") or {}).get("measurements", [])
    rng, n = np.random.default_rng(SEED + 4), len(steps) if measurements else 0
    states, inputs = steps.states[:n].copy(), steps.inputs[:n].copy()
    for f in (f for f in _fields(controller, "input") if f["name"] in measurements):
        size = rng.choice((-1, 1), n) * (f["high"] - f["low"]) * 10.0 ** (-4 * rng.uniform(0, 1, n) ** 0.6)
        wrong = np.where(rng.uniform(size=n) < 0.25, size, 0)
        inputs[f["name"]] = np.clip(inputs[f["name"]] + wrong, f["low"], f["high"])
        stands, code = rng.uniform(size=n) < 0.5, _code(states, f["name"])
        states[code] = np.where(stands, inputs[f["name"]], _uniform(rng, f, n))
        if (doubts := f"{f['name']}_{safety.MONITOR}_doubts") in (states.dtype.names or ()):
            believed = rng.uniform(size=n) < 0.5
            states[doubts] = np.where(believed, 0, states[doubts])
    share = rng.choice((0.05, 0.5), n)
    for f in _fields(controller, "state"):
        if f["ctype"] in _INTEGERS and not f["name"].startswith("guard_"):
            values = _replace_some(rng, _uniform(rng, f, n), (f["low"], f["high"]), 0.4)
            states[f["name"]] = np.where(rng.uniform(size=n) < share, values, states[f["name"]])
    for f in (f for f in _fields(controller, "state") if f["name"].endswith(f"_{safety.MONITOR}_before")):
        size = rng.choice((-1, 1), n) * (f["high"] - f["low"]) * 10.0 ** rng.uniform(-4, 0, n)
        moved = np.clip(states[f["name"]] + size, f["low"], f["high"])
        states[f["name"]] = np.where(rng.uniform(size=n) < 0.5, moved, states[f["name"]])
    for f in (f for f in _fields(controller, "input") if f["name"] in measurements):
        refused, name = rng.uniform(size=n) < 0.05, f["name"]
        inputs[name] = np.where(refused, np.nan, inputs[name])
        as_before = refused & (rng.uniform(size=n) < 0.7)
        states[f"guard_last_{name}"] = np.where(
            as_before,
            states[_code(states, name)],
            np.where(refused, _uniform(rng, f, n), states[f"guard_last_{name}"]),
        )
    return Steps("contradictions", states, inputs)


def _code(states: NDArray[np.void], name: str) -> str:
    """Return the state that holds the accepted reading of a sensor one sample ago."""
    alone = f"{name}_{safety.MONITOR}_code"
    return alone if alone in (states.dtype.names or ()) else f"redundancy_code_{name}"


def edge_steps(controller: host.Controller, steps: Steps) -> Steps:
    """Return steps in which one input has a value at a decision boundary, and the others are unchanged.

    Each value uses one of the `steps`; there are about ten values for each input.
    """
    cases = [(f["name"], value) for f in _fields(controller, "input") for value in _edge_values(controller, f)]
    base = steps.part(np.arange(len(cases)) % len(steps))
    inputs = base.inputs.copy()
    for k, (name, value) in enumerate(cases):
        inputs[name][k] = value
    return Steps("edges", base.states, inputs)


def perturbed(controller: host.Controller, steps: Steps, name: str, times: int, size: float) -> Steps:
    """Repeat the steps `times` times, with real states and inputs perturbed by up to `size` of their ranges.

    Perturbed values stay within their ranges.
    """
    rng = np.random.default_rng(SEED + 3)
    repeated = concatenate(name, [steps] * times)
    perturbed = repeated.states.copy(), repeated.inputs.copy()
    sizes = size * 10.0 ** rng.uniform(-3, 0, len(repeated))
    for role, records in zip(("state", "input"), perturbed, strict=True):
        for f in (f for f in _fields(controller, role) if f["ctype"] not in _INTEGERS):
            perturbation = sizes * (f["high"] - f["low"]) * rng.uniform(-1, 1, len(repeated))
            records[f["name"]] = np.clip(records[f["name"]] + perturbation, f["low"], f["high"])
    return Steps(name, *perturbed)


def rarest(controller: host.Controller, steps: Steps, n: int) -> Steps:
    """Return the n steps with the least frequent combination of fault word and integer states before and after."""
    after = evaluate(controller, steps)
    whole = [f["name"] for f in _fields(controller, "state") if f["ctype"] in _INTEGERS]
    key = after.faults.astype(np.uint64)
    for states in (steps.states, after.states):
        for name in whole:  # a hash that may wrap around; equal flags have equal keys
            key = key * np.uint64(0x9E3779B97F4A7C15) + states[name].astype(np.uint64)
    _, which, counts = np.unique(key, return_inverse=True, return_counts=True)
    picked = steps.part(np.sort(np.argsort(counts[which], kind="stable")[:n]))
    return Steps(f"rare among {steps.name}", picked.states, picked.inputs)


def at_range_ends(controller: host.Controller, steps: Steps, each: int, within: float = 0.0) -> Steps:
    """Return for both range ends of every output and real next state up to `each` steps that reach the end.

    `within` is the tolerated distance, relative to the range. Raises SignalError when no step reaches an end.
    """
    after, chosen = evaluate(controller, steps), []
    for role, columns in (("output", after.outputs), ("state", host.columns(after.states))):
        for f in (f for f in _fields(controller, role) if f["ctype"] not in _INTEGERS):
            values, tolerance = columns[f["name"]], within * (f["high"] - f["low"])
            ends = (
                (values <= values.dtype.type(f["low"]) + tolerance),
                (values >= values.dtype.type(f["high"]) - tolerance),
            )
            chosen += [np.flatnonzero(end)[:each] for end in ends]
    picked = steps.part(np.unique(np.concatenate(chosen)))
    return concatenate(f"{steps.name}, at ends", [picked] if len(picked) else [])


def fault_steps(controller: host.Controller, good: Mapping[str, float]) -> Steps:
    """Record bad samples of each input alone and of all inputs, between `good` ones, up to the latch and after it.

    Raises SignalError as `record`, and DesignError for a manifest without safety.
    """
    guarded = [f["input"] for f in controller.manifest["faults"] if "input" in f]
    runs = [
        record(controller, "faults", columns)
        for names in (*((name,) for name in guarded), guarded)
        for columns in _fault_runs(controller, names, good)
    ]
    return concatenate("faults", runs)


def _fault_runs(
    controller: host.Controller, names: Sequence[str], good: Mapping[str, float]
) -> Iterator[dict[str, NDArray[np.float64]]]:
    """Yield input columns: GOOD samples, 1 .. limit bad ones, then GOOD again, or LATCHED in the last run."""
    limit = (controller.manifest["safety"] or {}).get("bad_samples", 1)
    fields = {f["name"]: f for f in _fields(controller, "input")}
    for bad in range(1, limit + 1):
        after = LATCHED if bad == limit else GOOD
        columns = {name: np.full(GOOD + bad + after, float(value)) for name, value in good.items()}
        for name in names:
            columns[name][GOOD : GOOD + bad] = np.resize(_invalid_values(fields[name]), bad)
        yield columns


def _invalid_values(field: Mapping[str, Any]) -> tuple[float, ...]:
    low, high = field["low"], field["high"]
    beyond = _BEYOND * (high - low)
    return (np.nan, high + beyond, low - beyond, np.inf, -np.inf)


def _edge_values(controller: host.Controller, field: Mapping[str, Any]) -> tuple[float, ...]:
    """Return the range ends of a field, the next numbers on both sides, both zeros, and the extreme numbers."""
    scalar, info = controller.scalar, np.finfo(controller.scalar)
    ends = [scalar(field[end]) for end in ("low", "high")]
    beside = [float(np.nextafter(e, scalar(direction))) for e in ends for direction in (-np.inf, np.inf)]
    return (*map(float, ends), *beside, 0.0, -0.0, float(info.tiny), float(info.max), float(-info.max))


def _fields(controller: host.Controller, struct: str) -> list[dict[str, Any]]:
    return list(controller.manifest["structs"][struct]["fields"])


def _uniform(rng: np.random.Generator, field: Mapping[str, Any], n: int) -> NDArray[np.float64]:
    low, high = field["low"], field["high"]
    if field["ctype"] in _INTEGERS:
        return rng.integers(int(low), int(high) + 1, n).astype(float)
    return rng.uniform(low, high, n)


def _replace_some(
    rng: np.random.Generator, values: NDArray[np.float64], others: Sequence[float], share: float
) -> NDArray[np.float64]:
    """Return the values with a fraction `share` of them replaced by one of the others."""
    return np.where(rng.uniform(size=len(values)) < share, rng.choice(others, len(values)), values)
