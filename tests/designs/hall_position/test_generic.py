"""Hall position as an instance of the general estimator: the specialised one's estimates, and its cost beside it."""

from dataclasses import replace
from functools import cache
from math import pi, sqrt
from typing import Any

import numpy as np
import pytest
from scipy import optimize

from designs.hall_position import config, generic
from designs.hall_position.glsdc.parameters import Tuning
from models.hall_two_waves import PlanarArray
from synth.blocks.glsdc_integrity import Integrity
from synth.blocks.glsdc_solution import Iteration
from synth.emit import write
from synth.emit.write import EmittedCode
from synth.execute import cross, host, target
from synth.statespace import Array

ARRAY, SAMPLES = config.array(config.NAME), 400
TIMES = np.arange(SAMPLES) / 800
POSE = np.column_stack(
    [0.004 * np.sin(4 * pi * TIMES), 0.003 * np.cos(6 * pi * TIMES) - 0.003, 0.02 * np.sin(2 * pi * TIMES)]
)


def volts(array: PlanarArray, pose: Array, noise: float = 1e-3) -> dict[str, Array]:
    """Return the voltages of poses (N, 3), in NumPy."""
    (X, Y, yaw), rng, read = pose.T, np.random.default_rng(0), {}
    c, s = np.cos(yaw), np.sin(yaw)
    for letter, (x, y) in zip("abc", array.positions, strict=False):
        bx, by = (
            array.c + array.alpha * np.sin(array.wave_number * at) + array.beta * np.sin(5 * array.wave_number * at)
            for at in (X + c * x - s * y, Y + s * x + c * y)
        )
        for axis, v in (("x", c * bx + s * by), ("y", c * by - s * bx)):
            read[f"V_{letter}{axis}"] = v + noise * rng.standard_normal(len(X))
    return read


@cache
def emitted(kind: str, scalar: type[np.floating] = np.float32) -> EmittedCode:
    if kind == "specialised":
        return write.emit(config.controller(config.NAME).block, scalar)
    iteration = Iteration(2) if kind == "tracking" else generic.USUAL_ITERATION
    return write.emit(generic.guarded_estimator(ARRAY, config.TIME, iteration=iteration), scalar)


def outputs(kind: str, scalar: type[np.floating] = np.float32, array: PlanarArray = ARRAY) -> Any:
    made = emitted(kind, scalar)
    return host.load(made.files, made.manifest).replay(volts(array, POSE)).outputs


def distance(array: PlanarArray) -> float:
    """Return the largest difference of the instance from the specialised estimator, in deviations at rest."""
    ours, theirs = outputs("instance", array=array), outputs("specialised")
    pairs = [(name, ours[f"deviation_{name}"]) for name in ("X", "Y", "yaw")]
    return max(float(np.max(np.abs(ours[n] - theirs[n])[20:] / sigma[20:])) for n, sigma in pairs)


def test_the_estimates_are_those_of_the_specialised_estimator() -> None:
    assert outputs("instance")["valid"].all() and distance(ARRAY) < 0.1


def test_a_sensor_that_is_displaced_by_a_tenth_of_a_millimetre_shows() -> None:
    (x, y), *others = ARRAY.positions
    assert distance(replace(ARRAY, positions=((x + 1e-4, y), *others))) > 1


def test_single_precision_follows_double() -> None:
    single, double = (outputs("instance", scalar) for scalar in (np.float32, np.float64))
    for name in ("X", "Y", "yaw"):
        assert np.abs(single[name] - double[name]).max() < 0.05 * double[f"deviation_{name}"].min()


def test_a_sample_minimises_residuals_and_priors() -> None:
    """SciPy minimises the same cost from the same prediction, of bodies that left it by a deviation or two."""
    tuning, rng = Tuning(), np.random.default_rng(2)
    made = emitted("instance", np.float64)
    controller = host.load(made.files, made.manifest)
    prior = ARRAY.deviation / (ARRAY.alpha * sqrt(tuning.damping))
    sigma = np.array([prior, prior, prior / (ARRAY.radius * tuning.yaw_damping_ratio)])
    at = np.column_stack([rng.uniform(-0.02, 0.02, (30, 2)), rng.uniform(-0.1, 0.1, 30)])
    start = at * [ARRAY.wave_number, ARRAY.wave_number, 1] + sigma * rng.standard_normal((30, 3))
    states = np.repeat(controller.init()[None], 30)
    for name, values in zip(("phase_x", "phase_y", "yaw"), start.T, strict=True):
        states[f"estimator_{name}"] = values
    read = volts(ARRAY, at)
    out = controller.batch(states, read).outputs
    checked = 0
    for i in np.flatnonzero(out["converged"]):
        y = {n: v[i] for n, v in read.items()}

        def residuals(q: Array, y: dict[str, float] = y, begin: Array = start[i]) -> Array:
            model = volts(ARRAY, np.array([[q[0] / ARRAY.wave_number, q[1] / ARRAY.wave_number, q[2]]]), noise=0.0)
            e = [(y[n] - model[n][0]) / ARRAY.deviation for n in y]
            return np.array([*e, *((q - begin) / sigma)])

        best = optimize.least_squares(residuals, start[i], x_scale=sigma, xtol=1e-14, ftol=1e-14).x
        pose = np.array([out["X"][i] * ARRAY.wave_number, out["Y"][i] * ARRAY.wave_number, out["yaw"][i]])
        assert np.all(np.abs(pose - best) < 0.1 * sigma)
        checked += 1
    assert checked > 20


@pytest.mark.parametrize("fault", [0.0, 6e-3, 1e-2, 0.1])
def test_three_sensors_mislead_no_more_than_allocated(fault: float) -> None:
    """A fault in one voltage, V, at rest: errors beyond the level while valid; the field and the noise are its own."""
    array, N, risk, rng = config.array(config.THREE), 4000, 1e-2, np.random.default_rng(5)
    limits = {"phase_x": 0.1, "phase_y": 0.1, "yaw": 0.1}
    block = generic.guarded_estimator(array, config.TIME, integrity=Integrity(limits, false_alarm=1e-3, risk=risk))
    made = write.emit(block, np.float32)
    controller = host.load(made.files, made.manifest)
    at = np.column_stack([rng.uniform(-0.02, 0.02, (N, 2)), rng.uniform(-0.08, 0.08, N)])
    pose = at * [array.wave_number, array.wave_number, 1]
    states = np.repeat(controller.init()[None], N)
    for name, values in zip(("phase_x", "phase_y", "yaw"), pose.T, strict=True):
        states[f"estimator_{name}"] = values + 0.01 * rng.uniform(-1, 1, N)
    read, channel = volts(array, at), rng.integers(6, size=N)
    out = controller.batch(states, {n: v + fault * (channel == j) for j, (n, v) in enumerate(read.items())}).outputs
    error = np.abs(np.column_stack([out["X"] * array.wave_number, out["Y"] * array.wave_number, out["yaw"]]) - pose)
    levels = np.column_stack([out[f"protection_{n}"] for n in limits])
    assert ((error > levels) & (out["valid"] > 0)[:, None]).mean(axis=0).max() <= risk
    # At some positions a fault of one voltage leaves no residual of the other five: nothing is valid there.
    assert out["valid"].mean() > 0.9 if not fault else out["valid"].mean() < 0.9


@pytest.mark.slow
def test_it_costs_at_most_a_fifth_more_than_the_specialised_estimator() -> None:
    """Both with two sensors, five corrections and the descent check, over the same samples; two corrections track."""
    compiler = "gcc" if "gcc" in cross.available() else "zig"
    most = {}
    for kind in ("specialised", "instance", "tracking"):
        made = emitted(kind)
        core = target.load(made.files, made.manifest, compiler=compiler)
        most[kind] = int(core.measure({n: v[:100] for n, v in volts(ARRAY, POSE).items()}).cost.instructions.max())
    assert most["instance"] <= 1.2 * most["specialised"]
    if compiler == "gcc":
        assert most["instance"] <= 1.2 * 2295 and most["tracking"] <= 1300
