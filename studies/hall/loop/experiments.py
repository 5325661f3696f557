"""Experiments of the loop closed with the estimate in the true field: Figs. 10, 11 and 12, and the position sources.

All runs have 1 mV of noise, the filters, the converter and a sample of delay. The controller is the compiled C in
single precision. Three sensors close the loops of X, Y and yaw; the paper takes the yaw from the laser. Requirements:

    a step of 4 mm      the paper's platen moved by 4.3 mm without calibration and by 4 mm with it: here within the
                        1.4 mm of Fig. 10, and after calibration within CALIBRATED
    zigzag, Fig. 10     true and estimated position differ by 1.4 mm at most; calibrated, by CALIBRATED plus the
                        filters' lag v / w_c at most, and the rms is IMPROVEMENT times smaller
    staircase, Fig. 12  steps of 10 um are resolved: each is 10 um within a fifth, and the noise is below 10 um
    dropouts            repeated dropouts of two sensors for three samples move a platen at rest or in steady motion by
                        MAX_DISTURBANCE at most; in a small step, by the loop's response to the error of the prediction
    loss                when all voltages are 0 the loop latches after LATCH samples, and no current flows at the end
    `sources`           the sections of planar_6dof_lqg compared with the estimate

Why dropouts are tested in a small step without noise: docs/decisions/hall_position_loop.md.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from designs.planar_6dof import interface
from designs.planar_6dof.experiments import common_checks
from models import planar_stage
from studies.hall.hall_bench import Bench
from studies.hall.loop import calibration, closed_loop, sources, stage_loop
from studies.hall.loop.stage_loop import TIME, Loop
from synth.blocks.laws.error_map import ErrorMap
from synth.check import Check
from synth.signals import signal_names
from synth.simulate.experiments import Experiment
from synth.simulate.scenario import Override, Trajectory, sample_times
from synth.statespace import Array

HORIZONTAL = closed_loop.HORIZONTAL
ACCURACY, OVERSHOOT = 1.4e-3, 0.3e-3  # m: Fig. 10; overshoot of the platen in Fig. 11
CALIBRATED, IMPROVEMENT = 6e-5, 5.0  # m: 1.5 times the map's largest error between its lines
STEP, SETTLE, AFTER = 4e-3, 0.5, 2.0  # m, s
SMALL_STEP, STEP_DURATION, STEP_COUNT, AVERAGED = 1e-5, 0.6, 8, 0.35  # m, s, steps, s at the end of each
RESOLUTION, STEP_TOLERANCE = 1e-5, 2e-6  # m
WIDE, LEG, LEGS, LEAD = 0.02, 2.0, 8, 1.5  # m to either side, s for a leg of the zigzag, legs, s before the first
MAX_DISTURBANCE = 1e-5  # m
DROPOUT_SAMPLES, DROPOUT_PERIOD, LEAVES, SPEED = (
    3,
    100,
    1.5,
    0.02,
)  # samples, samples, s before the steady motion, m/s as in the zigzag
STEP_SETTLED = 0.12  # s after which the estimate is within 10 um of the step of 4 mm, and the motion is estimated
SMALL, PLACES = (
    2.5e-4,
    range(6, 54, 8),
)  # m: needs 0.49 A of motor C, which has 0.57 A at any yaw; samples after the step
RESPONSE = 0.25  # m of x for each m of error in one sample: 0.237 of the linear loop, plus a twentieth
LATCH = closed_loop.MAX_INVALID + interface.BAD_SAMPLES  # samples
Mask = NDArray[np.bool_]


@cache
def loops(libm: bool = False) -> Mapping[str, Loop]:
    """Return the loops without and with calibration."""
    source, bench = calibration.calibrated_source(), Bench(closed_loop.PLACES)
    return {
        "plain": stage_loop.of_source(replace(source, map=None), bench, libm=libm),
        "calibrated": stage_loop.of_source(source, bench, libm=libm),
    }


def run(progress: Callable[[str], None]) -> list[Experiment]:
    """Run the experiments of the loop itself; `progress` is called with the name of the next part."""
    progress("calibration")
    both = loops()
    calibrated = both["calibrated"]
    progress("standstill and steps of 4 mm")
    done = [standstill(calibrated), step(both["plain"], "plain", calibration.calibrated_source().map)]
    done.append(step(calibrated, "calibrated"))
    progress("zigzags and staircase")
    done += [*zigzags(both), staircase(calibrated)]
    progress("dropouts")
    return [*done, dropouts(calibrated), loss(calibrated)]


def compare_sources(progress: Callable[[str], None]) -> list[Experiment]:
    """Run the comparison of the position sources."""
    progress("sources")
    return [sources.experiment({**sources.others(), sources.OPTIMISED: loops()["calibrated"]})]


def standstill(loop: Loop) -> Experiment:
    """Return the noise at rest."""
    run = loop.run(sources.REST, {})
    figures, bar = sources.noise(run, 1.0), "a step that Fig. 12 shows"
    noise = {axis: figures[f"{axis} as estimated, um rms"] / 1e6 for axis in "xy"}
    checks = [Check(f"noise of {axis} as estimated", rms, SMALL_STEP, "m", bar) for axis, rms in noise.items()]
    about = f"{sources.REST:g} s, {sources.ABOUT}"
    return Experiment("rest", "At rest", about, run, HORIZONTAL, {}, figures, (*checks, *common_checks(run)))


def step(loop: Loop, name: str, map: ErrorMap | None = None) -> Experiment:
    """Return the step of 4 mm of Fig. 11, "plain" or calibrated; a `map` of errors tells those of other steps."""
    time, plain = sample_times(SETTLE + AFTER, TIME.period_s), name == "plain"
    set_point = np.where(time < SETTLE, 0.0, STEP)
    run = loop.run(SETTLE + AFTER, {"x": set_point})
    first, last = _samples(0.25, SETTLE), _samples(SETTLE + AFTER - 0.5, SETTLE + AFTER)
    ends = {n: float(run[n][last].mean()) for n in ("x", "y", "phi", "x_raw")}
    motion, estimated = (ends[n] - float(run[n][first].mean()) for n in ("x", "x_raw"))
    figures = {
        "true motion, mm": 1e3 * motion,
        "motion as estimated, mm": 1e3 * estimated,
        "true x at the end, mm": 1e3 * ends["x"],
        "true y at the end, um": 1e6 * ends["y"],
        "true yaw at the end, mrad": 1e3 * ends["phi"],
        "Fig. 11: true motion, mm": 1e3 * (STEP + (OVERSHOOT if plain else 0.0)),
    }
    figures |= _step_errors(map) if map else {}
    checks = (
        Check("error of the motion", abs(motion - STEP), ACCURACY if plain else CALIBRATED, "m"),
        *common_checks(run),
    )
    title = f"x by 4 mm, {'not calibrated, Fig. 11(a)' if plain else 'calibrated, Fig. 11(b)'}"
    return Experiment(f"step_{name}", title, sources.ABOUT, run, ("x", "x_raw"), {"x": set_point}, figures, checks)


def _samples(since: float, until: float) -> slice:
    """Return the samples between two times in s."""
    return slice(round(since / TIME.period_s), round(until / TIME.period_s))


def _step_errors(map: ErrorMap) -> dict[str, float]:
    """Return the error of a step of 4 mm along X over the map, mm rms and at most."""
    points, h = map.added[0], round(STEP / map.grid.spacing)
    by = 1e3 * np.abs(points[h:] - points[:-h])
    return {"a step of 4 mm anywhere errs by, mm rms": _rms(by), "at most, mm": float(by.max())}


def _rms(values: ArrayLike) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def zigzags(both: Mapping[str, Loop]) -> list[Experiment]:
    """Return the zigzag of Fig. 10 without and with calibration, which must reduce the error by IMPROVEMENT."""
    time, x, y = zigzag()
    window = time > LEAD + 0.2
    runs = {name: loop.run(float(time[-1]) + TIME.period_s, {"x": x, "y": y}) for name, loop in both.items()}
    late = 2 * WIDE / LEG / (2 * np.pi * both["plain"].bench.chain.corner)  # m, by the filters
    off = {name: _position_errors(run, window) for name, run in runs.items()}
    experiments, ratio = [], off["calibrated"]["x and y, um rms"] / off["plain"]["x and y, um rms"]
    for name, run in runs.items():
        yaw = 1e3 * (run["phi"] - run["phi_raw"])[window]
        figures = off[name] | {"of this the filters' lag, um": 1e6 * late, "Fig. 10(c): at most, mm": 1.4}
        figures |= {"yaw, mrad rms": _rms(yaw), "yaw, mrad at most": float(np.abs(yaw).max())}
        worst = max(figures[f"{a}, um at most"] for a in "xy") / 1e6
        checks = [Check("true from shown position", worst, ACCURACY if name == "plain" else CALIBRATED + late, "m")]
        if name == "calibrated":
            checks.append(Check("error over that without calibration", ratio, 1 / IMPROVEMENT, "1", "rms"))
        title = f"Zigzag, Fig. 10, {'not calibrated' if name == 'plain' else name}"
        shown, references = ("x", "y"), {"x": x, "y": y}
        checks += common_checks(run)
        experiments.append(
            Experiment(f"zigzag_{name}", title, sources.ABOUT, run, shown, references, figures, tuple(checks))
        )
    return experiments


def zigzag() -> tuple[Array, Array, Array]:
    """Return times in s and set-points of x and y in m: legs along x from the origin, with rising y."""
    time = sample_times(LEAD + LEG * LEGS + 0.5, TIME.period_s)
    corners = [0.0, LEAD, *(LEAD + LEG * k for k in range(1, LEGS + 1))]
    x = np.interp(time, corners, [0.0, *(WIDE * (-1) ** (k + 1) for k in range(LEGS + 1))])
    y = np.interp(time, [0.0, LEAD, corners[-1]], [0.0, -WIDE, WIDE])
    return time, x, y


def _position_errors(run: Trajectory, window: Mask) -> dict[str, float]:
    """Return the difference between the true position and the one that the controller reads."""
    off = {axis: 1e6 * (run[axis] - run[f"{axis}_raw"])[window] for axis in "xy"}
    figures = {f"{a}, um rms": _rms(v) for a, v in off.items()}
    figures |= {f"{a}, um at most": float(np.abs(v).max()) for a, v in off.items()}
    return figures | {"x and y, um rms": _rms([*off.values()])}


def staircase(loop: Loop) -> Experiment:
    """Return the staircase of Fig. 12: steps of 10 um."""
    time = sample_times(STEP_DURATION * (STEP_COUNT + 1), TIME.period_s)
    set_point = SMALL_STEP * np.minimum(np.floor(time / STEP_DURATION + 1e-9), STEP_COUNT)
    run = loop.run(float(time[-1]) + TIME.period_s, {"x": set_point})
    ends = [round(STEP_DURATION * (k + 1) / TIME.period_s) for k in range(STEP_COUNT + 1)]
    spans = [slice(end - round(AVERAGED / TIME.period_s), end) for end in ends]
    figures, checks = {}, []
    for what, name in (("as estimated", "x_raw"), ("truly", "x")):
        heights = np.diff([run[name][span].mean() for span in spans])
        worst = float(np.abs(heights - SMALL_STEP).max())
        figures[f"mean step {what}, um"] = 1e6 * float(heights.mean())
        figures[f"largest difference from 10 um {what}, um"] = 1e6 * worst
        checks.append(Check(f"a step {what}", worst, STEP_TOLERANCE, "m", "from 10 um, of means"))
    spread = max(float(np.std(run["x_raw"][span])) for span in spans)
    figures["noise of the estimate on a step, um rms"] = 1e6 * spread
    checks.append(Check("noise of the estimate", spread, RESOLUTION, "m", "below 10 um, Fig. 12"))
    about, shown, title = f"{STEP_COUNT} steps, {sources.ABOUT}", ("x_raw", "x"), "x by 10 um, Fig. 12"
    return Experiment("staircase", title, about, run, shown, {"x": set_point}, figures, (*checks, *common_checks(run)))


def dropouts(loop: Loop) -> Experiment:
    """Return a step of 4 mm and a steady motion with repeated dropouts of two sensors."""
    time = sample_times(SETTLE + AFTER, TIME.period_s)
    set_point, k = np.where(time < SETTLE, 0.0, STEP) + SPEED * np.maximum(time - LEAVES, 0.0), np.arange(len(time))
    clean = loop.run(SETTLE + AFTER, {"x": set_point})
    run = loop.run(
        SETTLE + AFTER,
        {"x": set_point},
        overrides=_dropout_overrides((k % DROPOUT_PERIOD < DROPOUT_SAMPLES) & (k >= DROPOUT_PERIOD)),
    )
    off, stepping = np.abs(run["x"] - clean["x"]), (time >= SETTLE) & (time < SETTLE + STEP_SETTLED)
    windows = {"at rest": (time < LEAVES) & ~stepping, "in a steady motion": time >= LEAVES + STEP_SETTLED}
    largest = {f"x differs {where}": float(off[window].max()) for where, window in windows.items()}
    figures = {f"{what} by, um": 1e6 * by for what, by in largest.items()}
    figures["during the step of 4 mm, by the noise of the yaw, um"] = 1e6 * float(off[stepping].max())
    figures["invalid samples"] = float(np.sum(run["valid"] == 0))
    checks = (
        *(Check(what, by, MAX_DISTURBANCE, "m", "from that without dropouts") for what, by in largest.items()),
        _dropout_in_a_step(loop),
        Check("latched", float(np.count_nonzero(run.faults >> np.uint32(31))), 0.0, "1"),
    )
    title = "Two sensors silent for three samples, again and again"
    return Experiment("dropouts", title, sources.ABOUT, run, ("x", "x_raw"), {"x": set_point}, figures, checks)


def _dropout_overrides(missing: Mask) -> dict[str, Override]:
    """Return overrides by NaN of the voltages of sensors a and b where they are missing (N,)."""
    return {n: Override(missing, np.full(len(missing), np.nan)) for n in planar_stage.HALL if n[2] in "ab"}


def _dropout_in_a_step(loop: Loop) -> Check:
    """Check the change of x by a dropout in a small step without noise, at the worst of PLACES."""
    ideal, duration, checks = replace(loop, rig=loop.rig.ideal), 1.5 * SETTLE, []
    time = sample_times(duration, TIME.period_s)
    set_point, k = np.where(time < SETTLE, 0.0, SMALL), np.arange(len(time))
    clean = ideal.run(duration, {"x": set_point})
    errors = _held_errors(np.asarray(clean["x_raw"], np.float64))
    for after in PLACES:
        at = round(SETTLE / TIME.period_s) + after
        run = ideal.run(
            duration, {"x": set_point}, overrides=_dropout_overrides((k >= at) & (k < at + DROPOUT_SAMPLES))
        )
        about = f"{after} samples after a step of {1e3 * SMALL:g} mm, without noise"
        off = float(np.abs(run["x"] - clean["x"]).max())
        checks.append(Check("x differs in a step", off, RESPONSE * float(errors[at]), "m", about))
    return max(checks, key=lambda check: check.value / check.limit)


def _held_errors(raw: Array) -> Array:
    """Return the summed error, m, of DROPOUT_SAMPLES predictions by `closed_loop` from each sample on."""
    at, motion, steps, errors = raw[0], 0.0, np.arange(1, DROPOUT_SAMPLES + 1), []
    for k in range(len(raw) - DROPOUT_SAMPLES + 1):
        errors.append(float(np.abs(at + motion * steps - raw[k : k + DROPOUT_SAMPLES]).sum()))
        at, motion = raw[k], motion + closed_loop.VELOCITY_GAIN * (raw[k] - at - motion)
    return np.array(errors)


def loss(loop: Loop) -> Experiment:
    """Return a standstill in which every voltage drops to 0: nothing is valid, and the currents are switched off."""
    lost = sample_times(1.0, TIME.period_s) >= 0.5
    none = Override(lost, np.zeros(len(lost)))
    run = loop.run(1.0, {}, overrides=dict.fromkeys(loop.hall, none))
    latched = run.faults >> np.uint32(31) == 1
    after = float(np.argmax(latched) - np.argmax(lost)) if latched.any() else float("inf")
    currents = max(float(np.abs(run.commands[name][-1])) for name in signal_names(planar_stage.INPUTS))
    figures = {"samples to the latch": after, "x at the end, um": 1e6 * float(run["x"][-1])}
    checks = (
        Check("samples to the latch", after, float(LATCH), "1"),
        Check("largest current at the end", currents, 0.0, "A"),
    )
    return Experiment("loss", "Every Hall voltage falls to 0", sources.ABOUT, run, ("x", "y"), {}, figures, checks)
