"""How often a protection level is exceeded after a single fault: `python -m studies.hall.protected.levels BODIES`.

    gain    y g,  g within 0 .. 1.6                 offset   y +- c,  c within 0.05 .. 3 V
    drift   y +- c k,  c within 2 .. 200 mV         stuck    the last value before the failure, or one of another pose
    lost    0 V, refused (NaN), or +-5 V            noise    y + sigma n,  sigma within 0.05 .. 2 V

The size of a fault is uniform, in its logarithm where it is in V. It is in one voltage of a sensor, or in both. Half of
the bodies rest, the others move at up to `trust.SPEED`. Fields are those of `trust`, and `declared`: that of the model,
and in each voltage of a body an error from the covariance R for which the levels are declared.

Samples of a body depend on each other. The interval is therefore of one sample of each body, drawn at random among
AFTER: the upper end of that of Clopper and Pearson, one-sided. `share` is of all valid samples.
"""

import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from scipy import stats

from designs.hall_position.config import TIME
from designs.hall_position.protected import config
from designs.hall_position.protected.parameters import Tuning
from models import hall_motions as motions
from models.hall_motions import Numbers, Pose
from studies.hall.protected import faults, trust
from studies.hall.protected.trust import World
from synth.base import progress
from synth.errors import ModelError
from synth.execute import host

KINDS = ("none", "gain", "offset", "drift", "stuck", "lost", "noise")
FIELDS = {
    config.NAME: ("own", "declared", "fabricated", "built"),
    config.THREE: ("own", "declared", "calibrated"),  # without a calibration it promises nothing
}
SIZES = {"offset": (0.05, 3.0), "drift": (2e-3, 0.2), "noise": (0.05, 2.0)}  # V, V a sample, V
LARGEST_GAIN, AFTER, CONFIDENCE, CHUNK = 1.6, 60, 0.95, 10_000  # -, samples, -, bodies that run at once


@dataclass(frozen=True)
class Exceeded:
    """Shares after a fault: of samples that are `valid`, and of these with an error above its level.

    Of one sample of each of the `bodies`, drawn at random, `chosen` are valid and `exceeding` have such an error.
    """

    valid: float
    share: float
    exceeding: int
    chosen: int
    bodies: int

    @property
    def of_valid(self) -> float:
        """The upper end of the share of valid samples that have such an error."""
        return upper_bound(self.exceeding, self.chosen)

    @property
    def of_all(self) -> float:
        """The upper end of the share of all samples that are valid and have such an error."""
        return upper_bound(self.exceeding, self.bodies)

    def __str__(self) -> str:
        """Return the shares in %."""
        counts = f"{self.exceeding} of {self.chosen} drawn"
        beyond = f"level exceeded in {100 * self.share:.3f} % of them"
        ends = f"at most {100 * self.of_valid:.3f} % of the valid and {100 * self.of_all:.4f} % of all samples"
        return f"valid {100 * self.valid:.2f} %, {beyond}, {counts}, {ends}"


def upper_bound(count: int, samples: int, confidence: float = CONFIDENCE) -> float:
    """Return the upper end of the one-sided Clopper-Pearson interval of a share; 1 without a sample."""
    return float(stats.beta.ppf(confidence, count + 1, samples - count)) if count < samples else 1.0


def world(field: str, bodies: int, rng: np.random.Generator, name: str, tuning: Tuning) -> World:
    """Return bodies in a field; raise ModelError for an unknown one."""
    if field != "declared":
        return trust.world(field, bodies, rng, name)
    exact = trust.world("own", bodies, rng, name)
    error = tuning.model_error * rng.standard_normal((bodies, exact.sensors, 2))
    return World(lambda pose: exact.read(pose) + error, exact.sensors)


def failing(
    kind: str, of: World, bodies: int, rng: np.random.Generator, size: float | None = None
) -> Callable[[Numbers, int], None]:
    """Return what corrupts voltages (N, sensors, 2) of a sample, so many samples since the failure; all of one `size`.

    Raises ModelError for an unknown kind.
    """
    if kind not in KINDS:
        raise ModelError(f"'{kind}' is not a kind of fault: give one of {', '.join(KINDS)}")
    each, sensor, sign = np.arange(bodies), rng.integers(of.sensors, size=bodies), rng.choice([-1, 1], (bodies, 2))
    fails = np.ones((bodies, 2), bool)
    single = rng.random(bodies) < 0.5
    fails[each[single], rng.integers(2, size=single.sum())] = False
    low, high = np.log(SIZES.get(kind, (1.0, 1.0)))
    sizes = rng.uniform(0, LARGEST_GAIN, bodies) if kind == "gain" else np.exp(rng.uniform(low, high, bodies))
    c = (sizes if size is None else np.full(bodies, size))[:, None]
    case, elsewhere = rng.integers(3, size=(bodies, 1)), of.read(trust.draw(trust.REACH, bodies, rng))[each, sensor]
    last: list[Numbers] = []
    by_kind: dict[str, Callable[[Numbers, int], Numbers]] = {
        "none": lambda y, k: y,
        "gain": lambda y, k: c * y,
        "offset": lambda y, k: y + sign * c,
        "drift": lambda y, k: y + sign * c * k,
        "stuck": lambda y, k: np.where(case == 0, last[0], elsewhere),
        "lost": lambda y, k: np.where(case == 0, 0.0, np.where(case == 1, np.nan, sign * faults.END)),
        "noise": lambda y, k: y + c * rng.standard_normal(y.shape),
    }

    def corrupt(V: Numbers, k: int) -> None:
        y = V[each, sensor]
        last.extend([y] if not last else [])
        V[each, sensor] = np.where(fails, by_kind[kind](y, k), y)

    return corrupt


def run(
    controller: host.Controller,
    tuning: Tuning,
    field: str,
    kind: str,
    bodies: int,
    name: str = config.NAME,
    size: float | None = None,
) -> Exceeded:
    """Return how often the level is exceeded; raise ModelError for an unknown field or kind."""
    parts = [
        _part(controller, tuning, field, kind, min(CHUNK, bodies - first), name, size, np.random.default_rng(first))
        for first in range(0, bodies, CHUNK)
    ]
    valid, exceeded, chosen, bad = (sum(counts) for counts in zip(*parts, strict=True))
    return Exceeded(valid / (bodies * AFTER), exceeded / max(valid, 1), bad, chosen, bodies)


def _part(
    controller: host.Controller,
    tuning: Tuning,
    field: str,
    kind: str,
    bodies: int,
    name: str,
    size: float | None,
    rng: np.random.Generator,
) -> tuple[int, int, int, int]:
    """Return valid samples, those with an error above its level, and both of the samples that are drawn."""
    of = world(field, bodies, rng, name, tuning)
    corrupt = failing(kind, of, bodies, rng, size)
    heading = rng.uniform(0, 2 * np.pi, bodies)
    speed = np.where(rng.random(bodies) < 0.5, 0.0, trust.SPEED * rng.random(bodies))
    duration = (trust.BEFORE + AFTER) * TIME.period_s
    start = trust.draw(trust.REACH - trust.SPEED * duration, bodies, rng)
    states = trust.tracking_states(controller, tuning, start, speed, heading)
    sample, valid, exceeded, chosen, bad = rng.integers(AFTER, size=bodies), 0, 0, 0, 0
    for k in range(-trust.BEFORE, AFTER):
        pose = start.displaced(speed * (k + trust.BEFORE) * TIME.period_s, heading)
        V = of.read(pose) + config.array(name).deviation * rng.standard_normal((bodies, of.sensors, 2))
        if k >= 0:
            corrupt(V, k)
        batch = controller.batch(states, motions.by_input(np.clip(V, -faults.END, faults.END)))
        states = batch.states
        if k >= 0:
            usable, above = _judge(batch.outputs, pose)
            valid, exceeded = valid + int(usable.sum()), exceeded + int(above.sum())
            chosen, bad = chosen + int((usable & (sample == k)).sum()), bad + int((above & (sample == k)).sum())
    return valid, exceeded, chosen, bad


def _judge(outputs: dict[str, Numbers], pose: Pose) -> tuple[Numbers, Numbers]:
    """Return which samples (N,) are valid, and which of them have an error above its level."""
    levels = np.stack([outputs[f"protection_{a}"] for a in trust.AXES], axis=-1)
    valid = outputs["valid"] > 0
    return valid, valid & (np.abs(trust.errors(outputs, pose)) > levels).any(axis=-1)


def lines(bodies: int) -> Iterator[str]:
    """Yield a line for each estimator, field and kind of fault."""
    for name in config.PLACES:
        tuning = config.TUNINGS[name]
        controller = trust.compile_estimator(tuning, name)
        for field in FIELDS[name]:
            for kind in KINDS:
                yield f"{name} {field:10s} {kind:6s} {run(controller, tuning, field, kind, bodies, name)}"


if __name__ == "__main__":
    progress.write(lines(int(sys.argv[1]) if len(sys.argv) > 1 else 20_000))
