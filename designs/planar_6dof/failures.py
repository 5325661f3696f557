"""A Hall channel that sticks, drops to zero or reads NaN, at rest or in motion: noticed when, and what happens then.

Each of the six channels fails by itself, FAILURE seconds after the start, with noise. An experiment is one kind of
failure; its trajectory is that of the run in which the stage goes furthest astray before the currents are taken away.
One from START is told channel by channel, a survey goes over PLACES and counts. The fault word names a channel that is
out of range, or suspects since the sensing's residual was out of its bound. Samples are counted from the first bad one,
0 for that one itself; from the latch on the currents may change by SLEW only.

Within PROMPT samples of the first residual out of bounds the channel that fails is named, alone or with others that
could make what is seen, or the latch has come before: a platen that a failure carries away may tilt until the lasers
are out of range. What never has such a residual is not noticed, and is told as a share.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from designs.planar_6dof import interface, sensing
from designs.planar_6dof.loop import Array, seen, simulate
from models import hall_calibration, planar_stage
from synth.check import Check
from synth.simulate.experiment import Experiment
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory, sample_times
from synth.simulate.sensors import Override
from synth.synthesise import safety

Kind = Literal["stuck", "zero", "nan"]

FAILURE, DURATION = 0.3, 1.3  # s
START = {"x": 0.009, "y": 0.005}  # m: where no channel reads zero
SPEED = {"x": 0.020, "y": 0.015}  # m/s, in motion
PLACES = 12  # of a survey, all over a pitch, from each of which the platen moves another way
Place = Mapping[str, float]
SURVEYED: tuple[Kind, ...] = ("zero", "stuck")
SPEEDS = (0.0, 0.02, 0.08)  # m/s
HALL = planar_stage.HALL
SLEW = interface.SLEW * (1 + 1e-5)  # A/s: single precision of 1.26 A over a sample
PROMPT = 5  # samples
WORDS = {"stuck": "sticks", "zero": "drops to zero", "nan": "reads NaN"}


@dataclass(frozen=True, eq=False)
class Failed:
    """A run in which `channel` fails at `sample`; `strayed` (N,) is how far x or y is from where it should be, m.

    `beyond` (N,) says where a residual is out of bounds since, `bits` which of the fault word name a channel.
    """

    channel: str
    sample: int
    run: Trajectory
    strayed: Array
    beyond: NDArray[np.bool_]
    bits: Mapping[str, int]

    @property
    def latched(self) -> int | None:
        """Samples from the failure to the latch, None if never."""
        return self._first(self.run.faults >> safety.LATCH_BIT & 1)

    @property
    def contradicted(self) -> int | None:
        """Samples from the failure to the first residual out of bounds, None if not up to the latch."""
        return self._first(self.beyond[: len(self._words())])

    @property
    def named(self) -> int | None:
        """Samples from the failure to the first in which the channel is named, None if not up to the latch."""
        return self._first(self._words() & self.bits[self.channel])

    @property
    def others(self) -> tuple[str, ...]:
        """The channels that are named up to the latch though they are sound."""
        word = int(np.bitwise_or.reduce(self._words()))
        return tuple(n for n in HALL if word & self.bits[n] and n != self.channel)

    @property
    def unanswered(self) -> float:
        """Samples from the first residual out of bounds to the channel's name or the latch, inf if there is neither.

        A latch counts where nobody is named at it: what others have been is no answer.
        """
        if self.contradicted is None:
            return 0.0
        answers = [self.named, None if self.others else self.latched]
        return min((float(n - self.contradicted) for n in answers if n is not None), default=np.inf)

    @property
    def astray(self) -> float:
        """How far the stage is off at most from the failure to the latch, m."""
        end = None if self.latched is None else self.sample + self.latched
        return float(self.strayed[self.sample : end].max())

    def slew(self) -> float:
        """Return the greatest change of a current from the latch on, A/s."""
        if self.latched is None:
            return 0.0
        step = float(self.run.time[1] - self.run.time[0])
        return float(np.abs(np.diff(self._currents()[:, self.sample + self.latched - 1 :], axis=1)).max()) / step

    def left(self) -> float:
        """Return the largest current at the end, A, 0 without a latch."""
        return 0.0 if self.latched is None else float(np.abs(self._currents()[:, -1]).max())

    def coasting(self) -> float:
        """Return how fast the platen goes on without current at the end, m/s, 0 without a latch."""
        speed = float(np.hypot(self.run["vx"][-1], self.run["vy"][-1]))
        return 0.0 if self.latched is None else speed

    def _currents(self) -> Array:
        return np.array([self.run.commands[s.name] for s in interface.OUTPUTS], dtype=np.float64)

    def _words(self) -> NDArray[np.uint32]:
        """Return the fault words up to the latch."""
        return self.run.faults[: None if self.latched is None else self.sample + self.latched + 1]

    def _first(self, flags: NDArray[Any]) -> int | None:
        found = np.flatnonzero(flags)
        return int(found[0]) - self.sample if found.size else None


def fail(loop: Rig, channel: str, kind: Kind, start: Place = START, speed: Place | None = None) -> Failed:
    """Run the stage with a channel that fails after FAILURE seconds and stays so; at rest without a `speed`, m/s."""
    time = sample_times(DURATION, loop.period_s)
    k = int(np.argmax(time >= FAILURE))
    gone = np.maximum(time - 0.1, 0.0)
    wanted = {a: at + (speed or dict.fromkeys(start, 0.0))[a] * gone for a, at in start.items()}
    value = _read(loop, wanted, channel, k) if kind == "stuck" else {"zero": 0.0, "nan": np.nan}[kind]
    bad = Override(np.arange(len(time)) >= k, np.full(len(time), value))
    run = simulate(loop, DURATION, wanted, start, overrides={channel: bad})
    strayed = np.max([np.abs(run[a] - r) for a, r in wanted.items()], axis=0)
    beyond = (residuals(loop, run) > 1) & (np.arange(len(time)) >= k)
    return Failed(channel, k, run, strayed, beyond, _bits(loop))


def residuals(loop: Rig, run: Trajectory) -> Array:
    """Return rho (N,) of `sensing`, 0 where the word names a channel already."""
    shown, A = seen(loop, run), hall_calibration.of(loop.plant).amplitude
    bounds = {s.name: sensing.POWER * A**2 if s.unit == "V^2" else sensing.RESIDUAL * A for s in sensing.RESIDUALS}
    rho = np.sqrt(np.sum([(shown[name] / bound) ** 2 for name, bound in bounds.items()], axis=0))
    return np.where(run.faults & np.bitwise_or.reduce(list(_bits(loop).values())), 0.0, rho)


def _bits(loop: Rig) -> dict[str, int]:
    """Return the bits of the fault word by the channel that they name."""
    found = dict.fromkeys(HALL, 0)
    for fault in loop.controller.manifest["faults"]:
        name = fault.get("input") or fault.get("suspect")
        if name in found:
            found[name] |= 1 << fault["bit"]
    return found


def _read(loop: Rig, wanted: dict[str, Array], channel: str, k: int) -> float:
    """Return what a channel reads at sample k as long as it is sound."""
    until = {axis: values[: k + 1] for axis, values in wanted.items()}
    start = {axis: float(values[0]) for axis, values in wanted.items()}
    return float(simulate(loop, (k + 1) * loop.period_s, until, start).measured[channel][k])


def experiment(loop: Rig, kind: Kind, moving: bool) -> Experiment:
    """Return what one kind of failure does, over all channels."""
    runs = [fail(loop, channel, kind, START, SPEED if moving else None) for channel in HALL]
    worst = max(runs, key=lambda f: f.astray)
    where = "in motion" if moving else "at rest"
    return Experiment(
        f"{kind}_{'moving' if moving else 'resting'}",
        f"A Hall channel {WORDS[kind]} {where}",
        f"each of six channels by itself after {FAILURE:g} s; shown is {worst.channel}",
        worst.run,
        ("x", "y", "phi"),
        {},
        _figures(runs),
        checks(runs, kind, moving),
    )


def _figures(runs: list[Failed]) -> dict[str, float]:
    found: dict[str, float] = {}
    for f in runs:
        found[f"samples until {f.channel} is contradicted"] = np.inf if f.contradicted is None else f.contradicted
        found[f"samples until {f.channel} is named"] = np.inf if f.named is None else f.named
        found[f"samples until the latch, {f.channel}"] = np.inf if f.latched is None else f.latched
        found[f"sound channels named, {f.channel}"] = len(f.others)
        found[f"furthest astray before the latch, {f.channel}, um"] = 1e6 * f.astray
        found[f"coasts at, {f.channel}, mm/s"] = 1e3 * f.coasting()
    return found


def checks(runs: list[Failed], kind: Kind, moving: bool) -> tuple[Check, ...]:
    """Return what holds of every failure, and that it is noticed unless it is one that sticks at rest."""
    early = max(int(np.count_nonzero(f.run.faults[: f.sample])) for f in runs)
    found = [
        Check("samples with a fault before the failure", float(early), 0.0, "1"),
        Check("change of a current from the latch on", max(f.slew() for f in runs), SLEW, "A/s", "declared: 126"),
        Check("current left at the end after a latch", max(f.left() for f in runs), 0.0, "A"),
    ]
    if kind == "nan":
        late = max(np.inf if f.latched is None else f.latched for f in runs)
        found.append(Check("samples until the latch", float(late), interface.BAD_SAMPLES - 1.0, "1", "every channel"))
        return tuple(found)
    found.append(_prompt(runs))
    if kind == "zero" or moving:
        unnoticed = sum(f.latched is None for f in runs)
        found.append(Check("channels whose failure is not noticed", float(unnoticed), 0.0, "1", "in 1 s"))
    return tuple(found)


def _prompt(runs: Sequence[Failed]) -> Check:
    slow = max(f.unanswered for f in runs)
    return Check("samples from a residual out of bounds to the channel's name or the latch", slow, PROMPT, "1")


@cache
def places() -> tuple[tuple[Place, Place], ...]:
    """Return PLACES starts, m, and the directions to go from each; evenly over a pitch and a turn, by Roberts."""
    pitch, found = planar_stage.plant().parameter("l").value, []
    for n in range(PLACES):
        x, y, turn = ((0.5 + n * step) % 1 for step in (0.7548776662466927, 0.5698402909980532, 0.6180339887498949))
        angle = 2 * np.pi * turn
        start = {"x": (0.8 * x - 0.4) * pitch, "y": (0.8 * y - 0.4) * pitch}
        found.append((start, {"x": float(np.cos(angle)), "y": float(np.sin(angle))}))
    return tuple(found)


def survey(loop: Rig, kind: Kind, speeds: Sequence[float]) -> Experiment:
    """Return what one kind of failure does, over all channels, places and speeds in m/s."""
    runs = [
        fail(loop, channel, kind, start, {axis: v * part for axis, part in way.items()})
        for channel in HALL
        for start, way in places()
        for v in speeds
    ]
    noticed = [f for f in runs if f.contradicted is not None]
    named = [f for f in noticed if f.named is not None]
    figures = {
        "runs": float(len(runs)),
        "with a residual out of its bound, %": 100 * len(noticed) / len(runs),
        "latched by other means alone, %": 100
        * sum(f.latched is not None for f in runs if f not in noticed)
        / len(runs),
        "of those noticed, the channel is named, %": 100 * len(named) / len(noticed),
        "of those noticed, it is named alone, %": 100 * sum(not f.others for f in named) / len(noticed),
        "sound channels named beside it, mean": float(np.mean([len(f.others) for f in named])),
        "furthest astray where nothing is noticed, um": 1e6
        * max((f.astray for f in runs if f.latched is None), default=0.0),
    }
    worst = max(runs, key=lambda f: f.astray)
    at = ", ".join(f"{1e3 * v:g}" for v in speeds)
    about = f"each channel at {PLACES} places, at {at} mm/s; shown is {worst.channel}"
    title = f"A Hall channel {WORDS[kind]}, anywhere"
    slew = Check("change of a current from the latch on", max(f.slew() for f in runs), SLEW, "A/s", "declared: 126")
    return Experiment(
        f"{kind}_anywhere", title, about, worst.run, ("x", "y", "phi"), {}, figures, (_prompt(runs), slew)
    )


def experiments(loop: Rig) -> list[Experiment]:
    """Return the three kinds of failure, at rest and in motion, and the surveys."""
    kinds: tuple[Kind, ...] = ("nan", "zero", "stuck")
    by_channel = [experiment(loop, kind, moving) for moving in (False, True) for kind in kinds]
    return [*by_channel, *(survey(loop, kind, SPEEDS) for kind in SURVEYED)]
