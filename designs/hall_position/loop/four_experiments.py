"""Figs. 10, 11 and 12 with the loop closed by four sensors: the experiments of `experiments`, and failures of a sensor.

The fields are those that the shipped estimator does not know (`four_sensors`). Beside the requirements of
`experiments`, each run has those of an estimate that is trusted; its error is that from the pose of a filter's lag ago:

    not valid           1 % of the samples after the first valid one, at most
    misleading          no error is above its protection level while the estimate is valid
    beyond 4 sigma      0.1 % of the valid errors over their deviation
    valid and wrong     0.2 % of the samples have an error above 0.5 mm or 20 mrad

The estimate without calibration is, bit for bit, that of the shipped C. `failures` are those of `four.trust`: after each
of them the loop may latch, but up to the latch the platen is within 0.5 mm of where it is without the failure.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from designs.hall_position.four import config, trust
from designs.hall_position.loop import experiments, four_sensors, sources
from designs.hall_position.loop.experiments import SPEED
from designs.hall_position.loop.four_sensors import AXES
from designs.hall_position.loop.stage_loop import TIME, Loop
from synth.check import Check
from synth.simulate.experiment import Experiment
from synth.simulate.scenario import Trajectory, sample_times
from synth.simulate.sensors import Override
from synth.statespace import Array

UNAVAILABLE, BEYOND, WRONG = 0.01, 1e-3, 2e-3  # shares of samples
SIGMAS = 4.0
STARTS, FAILS, ENDS = 0.5, 1.0, 1.6  # s of the motion, of the failure, and of the run


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
    done = [replace(e, checks=(*e.checks, shipped_check(e.trajectory, plain))) if "plain" in e.name else e for e in done]
    return [*done, failures(calibrated), _of_four(experiments.loss(calibrated), ())]


def _of_four(e: Experiment, checks: tuple[Check, ...]) -> Experiment:
    """Return an experiment under the name of four sensors, with further checks."""
    figures = dict(e.figures) | (error_figures(e.trajectory) if checks else {})
    return replace(
        e, name=f"{e.name}_four", title=f"{e.title}, four sensors", figures=figures, checks=(*e.checks, *checks)
    )


def shipped_check(run: Trajectory, loop: Loop) -> Check:
    """Check that the loop was closed with the estimate of the shipped C: its own answers to the same voltages."""
    shipped = trust.compile_estimator(config.USUAL).replay({name: run.measured[name] for name in loop.hall}).outputs
    off = max(float(np.abs(np.float64(shipped[name]) - run[name]).max()) for name in (*AXES, "valid"))
    return Check("estimate differs from the shipped C", off, 0.0, "m, rad")


def errors(run: Trajectory) -> Array:
    """Return the errors (N, 3) of X, Y in m and the yaw from the pose that the filtered voltages show."""
    late = run.time - 1 / (2 * np.pi * four_sensors.unit().bench.chain.corner)
    true = (np.interp(late, run.time, run[name]) for name in ("x", "y", "phi"))
    return np.stack([run[name] - at for name, at in zip(AXES, true, strict=True)], axis=1)


def valid(run: Trajectory) -> tuple[experiments.Mask, experiments.Mask]:
    """Return the valid samples, and those that are wrong among them."""
    off, good = errors(run), run["valid"] > 0
    return good, good & ((np.hypot(off[:, 0], off[:, 1]) > trust.WRONG) | (np.abs(off[:, 2]) > trust.WRONG_YAW))


def _columns(run: Trajectory, prefix: str) -> Array:
    return np.stack([run[f"{prefix}_{axis}"] for axis in AXES], axis=1)


def error_figures(run: Trajectory) -> dict[str, float]:
    """Return how large errors, deviations and protection levels of valid samples are."""
    good, _ = valid(run)
    off, deviations, levels = errors(run)[good], _columns(run, "deviation")[good], _columns(run, "protection")[good]
    return {
        "error of X and Y, um rms": 1e6 * float(np.sqrt(np.mean(off[:, :2] ** 2))),
        "error of X or Y, um at most": 1e6 * float(np.abs(off[:, :2]).max()),
        "rms error over deviation of X and Y": float(np.sqrt(np.mean((off / deviations)[:, :2] ** 2))),
        "protection level of X or Y, um at most": 1e6 * float(levels[:, :2].max()),
        "first valid sample": float(np.argmax(good)),
    }


def trusted_checks(run: Trajectory) -> tuple[Check, ...]:
    """Return the requirements of an estimate that is trusted."""
    good, wrong = valid(run)
    off, deviations, levels = np.abs(errors(run)), _columns(run, "deviation"), _columns(run, "protection")
    unavailable = 1 - float(good[np.argmax(good) :].mean()) if good.any() else 1.0
    return (
        Check("not valid", unavailable, UNAVAILABLE, "1", "of the samples after the first valid one"),
        Check("misleading", float(np.sum(off[good] > levels[good])), 0.0, "1", "errors above their protection level"),
        Check("beyond 4 sigma", float(np.mean(off[good] > SIGMAS * deviations[good])), BEYOND, "1", "of the errors"),
        Check("valid and wrong", float(wrong.mean()), WRONG, "1", "of the samples"),
    )


def failures(loop: Loop) -> Experiment:
    """Return a steady motion in which a sensor fails, each in each way; the run is that of a sensor that dies."""
    time = sample_times(ENDS, TIME.period_s)
    set_points = {"x": SPEED * np.maximum(time - STARTS, 0.0)}
    clean, figures = loop.run(ENDS, set_points), {}
    worst: dict[str, float] = {"x or y differs": 0.0, "valid and wrong": 0.0, "misleading": 0.0}
    for fault in trust.FAULTS:
        runs = [loop.run(ENDS, set_points, overrides=_failure(loop, clean, fault, k)) for k in range(4)]
        results = [_after_failure(run, clean) for run in runs]
        for name in worst:
            worst[name] = max(worst[name], *(result[name] for result in results))
        figures[f"{fault}: x or y differs by, um"] = 1e6 * max(result["x or y differs"] for result in results)
        figures[f"{fault}: sensors after which it latches"] = sum(result["latched"] for result in results)
    run = loop.run(ENDS, set_points, overrides=_failure(loop, clean, "dead sensor", 2))
    checks = (
        Check("x or y differs", worst["x or y differs"], trust.WRONG, "m", "from that without a failure"),
        Check("valid and wrong", worst["valid and wrong"], WRONG, "1", "of the samples after a failure"),
    )
    title, about = "A sensor fails in a steady motion, four sensors", f"{1e3 * SPEED:g} mm/s, {sources.ABOUT}"
    return Experiment("failures_four", title, about, run, ("x", "x_raw"), set_points, figures, checks)


def _failure(loop: Loop, clean: Trajectory, fault: str, sensor: int) -> Mapping[str, Override]:
    """Return overrides of a sensor's voltages from FAILS on, made from those without a failure."""
    names, k = loop.hall[2 * sensor : 2 * sensor + 2], np.arange(len(clean.time)) - round(FAILS / TIME.period_s)
    V = np.stack([np.float64(clean.measured[name]) for name in names], axis=1)
    kept = np.broadcast_to(V[k == -1], V.shape)
    failed = np.clip(trust.FAULTS[fault](V, kept, np.maximum(k, 0)), -trust.END, trust.END)
    return {name: Override(k >= 0, failed[:, i]) for i, name in enumerate(names)}


def _after_failure(run: Trajectory, clean: Trajectory) -> dict[str, float]:
    """Return how far the platen is from where it is without a failure, up to the latch, and what the estimate claims."""
    latched = run.faults >> np.uint32(31) > 0
    after = (run.time >= FAILS) & ~latched
    good, wrong = valid(run)
    misled = (np.abs(errors(run)) > _columns(run, "protection")).any(axis=1) & good
    return {
        "x or y differs": float(np.hypot(run["x"] - clean["x"], run["y"] - clean["y"])[after].max()),
        "valid and wrong": float(wrong[run.time >= FAILS].mean()),
        "misleading": float(misled[run.time >= FAILS].mean()),
        "latched": float(latched.any()),
    }
