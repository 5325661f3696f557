"""Figs. 10, 11 and 12 with the loop closed by four sensors: the experiments of `experiments`, and failures of a sensor.

The fields are those that the shipped estimator does not know (`four_sensors`). Beside the requirements of
`experiments`, each run has those of an estimate that is trusted; its error is that from the pose of a filter's lag ago:

    not valid           1 % of the samples after the first valid one, at most
    misleading          no error is above its protection level while the estimate is valid
    beyond 4 sigma      0.1 % of the valid errors over their deviation
    valid and wrong     0.2 % of the samples have an error above 0.5 mm or 20 mrad

    first valid         within 120 samples

The rms error over the deviation is shown only: its bar is for many units and places. The estimate without calibration
is, bit for bit, that of the shipped C. `failures` are those of `protected.faults` in a steady motion, of each sensor,
at STARTING_PLACES places. Fewer than 0.2 % of the AFTER samples after them are valid and wrong. After a failure the
loop may latch. Up to the latch the platen is at most 0.5 mm from where it is without the failure, except after
EXCURSIONS of the failures: docs/decisions/hall_position_loop.md.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from types import MappingProxyType

import numpy as np

from designs.hall_position.protected import config
from studies.hall.loop import experiments, four_sensors, sources
from studies.hall.loop.experiments import SPEED
from studies.hall.loop.four_sensors import AXES
from studies.hall.loop.stage_loop import TIME, Loop
from studies.hall.protected import faults, trust
from synth.check import Check
from synth.simulate.experiments import Experiment
from synth.simulate.scenario import Override, Trajectory, sample_times
from synth.statespace import Array

UNAVAILABLE, BEYOND, WRONG = 0.01, 1e-3, 2e-3  # shares of samples
ESTIMATOR = ("screen_", "estimator_", "metres_")  # states of the estimator without its guard
SIGMAS, FIRST_VALID = 4.0, 120
STARTS, FAILS, ENDS = 0.3, 0.6, 0.8  # s of the motion, of the failure, and of the run
STARTING_PLACES, REACH = 10, 0.018  # and m to either side of the origin
EXCURSIONS = 0.01
SHOWN = ("dead sensor", 2)  # and its number
FAILURES = faults.LASTING  # a stuck sensor keeps its last voltages here


def run(progress: Callable[[str], None]) -> list[Experiment]:
    """Run every experiment; `progress` is called with the name of the next part."""
    progress("calibration of four sensors")
    both = four_sensors.loops()
    plain, calibrated = both["plain"], both["calibrated"]
    progress("four sensors: standstill, steps, zigzags, staircase")
    runs = [experiments.standstill(calibrated), *(experiments.step(both[name], name) for name in both)]
    runs += [*experiments.zigzags(both), experiments.staircase(calibrated)]
    progress("four sensors: failures")
    done = [_of_four(e, trusted_checks(e.trajectory)) for e in runs]
    done = [
        replace(e, checks=(*e.checks, shipped_check(e.trajectory, plain))) if "plain" in e.name else e for e in done
    ]
    return [*done, failures(calibrated), _of_four(experiments.loss(calibrated), ())]


def _of_four(e: Experiment, checks: tuple[Check, ...]) -> Experiment:
    """Return an experiment under the name of four sensors, with further checks."""
    figures = dict(e.figures) | (error_figures(e.trajectory) if checks else {})
    return replace(
        e, name=f"{e.name}_four", title=f"{e.title}, four sensors", figures=figures, checks=(*e.checks, *checks)
    )


def shipped_check(run: Trajectory, loop: Loop) -> Check:
    """Check that the estimate in the loop is that of the shipped C: its own answers to the same voltages.

    The estimator has no output in the loop. Its states after the run are compared, and the estimates of `Loop.view`.
    """
    shipped = trust.compile_estimator(config.USUAL).replay({name: run.measured[name] for name in loop.hall})
    after = loop.rig.controller.replay(run.measured).state
    states = [n for n in shipped.state.dtype.names or () if n.startswith(ESTIMATOR)]
    off = [float(np.abs(np.float64(shipped.outputs[name]) - run[name]).max()) for name in (*AXES, "valid")]
    off += [abs(float(shipped.state[name]) - float(after[name])) for name in states]
    return Check("estimate differs from the shipped C", max(off), 0.0, "m, rad")


def errors(run: Trajectory) -> Array:
    """Return the errors (N, 3) of X, Y in m and the yaw from the pose that the filtered voltages show."""
    late = run.time - 1 / (2 * np.pi * four_sensors.unit().bench.chain.corner)
    true = (np.interp(late, run.time, run[name]) for name in ("x", "y", "phi"))
    return np.stack([run[name] - at for name, at in zip(AXES, true, strict=True)], axis=1)


def wrong_samples(run: Trajectory) -> experiments.Mask:
    """Return the samples that are valid and wrong."""
    off = errors(run)
    wrong = (np.hypot(off[:, 0], off[:, 1]) > trust.WRONG) | (np.abs(off[:, 2]) > trust.WRONG_YAW)
    return np.asarray(wrong & (run["valid"] > 0))


def _columns(run: Trajectory, prefix: str) -> Array:
    return np.stack([run[f"{prefix}_{axis}"] for axis in AXES], axis=1)


def error_figures(run: Trajectory) -> dict[str, float]:
    """Return how large errors, deviations and protection levels of valid samples are."""
    good = run["valid"] > 0
    off, deviations, levels = errors(run)[good], _columns(run, "deviation")[good], _columns(run, "protection")[good]
    return {
        "error of X and Y, um rms": 1e6 * float(np.sqrt(np.mean(off[:, :2] ** 2))),
        "error of X or Y, um at most": 1e6 * float(np.abs(off[:, :2]).max()),
        "rms error over deviation of X and Y": float(np.sqrt(np.mean((off / deviations)[:, :2] ** 2))),
        "protection level of X or Y, um at most": 1e6 * float(levels[:, :2].max()),
    }


def trusted_checks(run: Trajectory) -> tuple[Check, ...]:
    """Return the requirements of an estimate that is trusted."""
    good = run["valid"] > 0
    if not good.any():
        return (Check("not valid", 1.0, UNAVAILABLE, "1", "of all samples"),)
    off, deviations, levels = np.abs(errors(run)), _columns(run, "deviation"), _columns(run, "protection")
    unavailable = 1 - float(good[np.argmax(good) :].mean())
    return (
        Check("not valid", unavailable, UNAVAILABLE, "1", "of the samples after the first valid one"),
        Check("misleading", float(np.sum(off[good] > levels[good])), 0.0, "1", "errors above their protection level"),
        Check("beyond 4 sigma", float(np.mean(off[good] > SIGMAS * deviations[good])), BEYOND, "1", "of the errors"),
        Check("valid and wrong", float(wrong_samples(run).mean()), WRONG, "1", "of the samples"),
        Check("first valid sample", float(np.argmax(good)), FIRST_VALID, "1"),
    )


@dataclass(frozen=True)
class Consequence:
    """How far a failure moves the platen, m, the share of samples that are valid and wrong, and whether it latches."""

    excursion: float
    wrong: float
    latched: bool


def failures(loop: Loop) -> Experiment:
    """Return steady motions in which a sensor fails; the one that is shown is that of a sensor that dies."""
    consequences: dict[str, list[Consequence]] = {fault: [] for fault in FAILURES}
    for x, y in np.random.default_rng(loop.rig.seed).uniform(-REACH, REACH, (STARTING_PLACES, 2)):
        start = {"x": float(x), "y": float(y)}
        clean = _motion(loop, start)
        for fault, sensor in product(consequences, range(len(loop.hall) // 2)):
            run = _motion(loop, start, _overrides(loop, clean, fault, sensor))
            consequences[fault].append(_consequence(run, clean))
    shown = _motion(loop, {}, _overrides(loop, _motion(loop, {}), *SHOWN))
    excursions = [c.excursion > trust.WRONG for fault, each in consequences.items() if fault != "none" for c in each]
    wrong = max(float(np.mean([c.wrong for c in each])) for each in consequences.values())
    checks = (
        Check("valid and wrong", wrong, WRONG, "1", "of the samples after a failure, the worst kind"),
        Check("excursions", float(np.mean(excursions)), EXCURSIONS, "1", "above 0.5 mm, of the failures"),
        Check("latched", float(sum(c.latched for c in consequences["none"])), 0.0, "1", "without a failure"),
    )
    title, about = "A sensor fails in a steady motion, four sensors", f"{1e3 * SPEED:g} mm/s, {sources.ABOUT}"
    figures, path = _failure_figures(consequences), {"x": _along(shown.time)}
    return Experiment("failures_four", title, about, shown, ("x", "x_raw"), path, figures, checks)


def _along(time: Array) -> Array:
    return SPEED * np.maximum(time - STARTS, 0.0)


def _motion(
    loop: Loop, start: Mapping[str, float], overrides: Mapping[str, Override] = MappingProxyType({})
) -> Trajectory:
    x = start.get("x", 0.0) + _along(sample_times(ENDS, TIME.period_s))
    return loop.run(ENDS, {"x": x}, start, overrides=overrides)


def _overrides(loop: Loop, clean: Trajectory, fault: str, sensor: int) -> Mapping[str, Override]:
    """Return overrides of a sensor's voltages from FAILS on, made from those without a failure."""
    names, k = loop.hall[2 * sensor : 2 * sensor + 2], np.arange(len(clean.time)) - round(FAILS / TIME.period_s)
    V = np.stack([np.float64(clean.measured[name]) for name in names], axis=1)
    kept = np.broadcast_to(V[k == -1], V.shape)
    failed = np.clip(faults.FAULTS[fault](V, kept, np.maximum(k, 0)), -faults.END, faults.END)
    return {name: Override(k >= 0, failed[:, i]) for i, name in enumerate(names)}


def _consequence(run: Trajectory, clean: Trajectory) -> Consequence:
    """Return the consequence of a failure up to the latch, with the wrong ones of the AFTER samples from it on."""
    latched = run.faults >> np.uint32(31) > 0
    until = (run.time >= FAILS) & ~latched
    first = round(FAILS / TIME.period_s)
    return Consequence(
        excursion=float(np.hypot(run["x"] - clean["x"], run["y"] - clean["y"])[until].max(initial=0.0)),
        wrong=float(wrong_samples(run)[first : first + trust.AFTER].mean()),
        latched=bool(latched.any()),
    )


def _failure_figures(consequences: Mapping[str, Sequence[Consequence]]) -> dict[str, float]:
    figures: dict[str, float] = {}
    for fault, each in consequences.items():
        figures[f"{fault}: moves the platen by, um at most"] = 1e6 * max(c.excursion for c in each)
        figures[f"{fault}: latches, %"] = 100 * float(np.mean([c.latched for c in each]))
    return figures
