"""Weighted least squares of ranges and bearings: emitted C against a NumPy reference, its covariance, and refusals."""

from dataclasses import replace
from functools import cache
from math import pi
from typing import Any

import casadi as ca
import numpy as np
import pytest

from benchmarks import beacons
from benchmarks.beacons import Problem
from synth.block import Block, Constant
from synth.blocks.estimate import glsdc, glsdc_estimator, glsdc_model
from synth.blocks.estimate.glsdc_integrity import Integrity
from synth.blocks.estimate.glsdc_model import Unknown
from synth.blocks.estimate.glsdc_solution import Iteration
from synth.emit import write
from synth.errors import EmitError
from synth.execute.host import Batch, Controller, Records, compile_block
from synth.signals import Signal
from synth.statespace import Array

PROBLEMS = [beacons.ranges(3), beacons.ranges(5, bias=True), beacons.bearings(4)]
SCALARS: list[type[np.floating]] = [np.float32, np.float64]
ROUNDING = {np.float32: 5e-3, np.float64: 2e-4}  # deviations; corrections below 1e-4 deviations are left in double
TITLES = [of.kind for of in PROBLEMS]


@cache
def compiled(of: Problem, scalar: type[np.floating] = np.float32) -> Controller:
    return compile_block(beacons.block(of), scalar)


def at(of: Problem, controller: Controller, q: Array) -> Records:
    """Return states (N,) with the last estimates at unknowns (N, n)."""
    states = np.repeat(controller.init()[None], len(q))
    for name, values in zip(of.unknowns, q.T, strict=True):
        states[f"estimator_{name}"] = values
    return states


def measured(of: Problem, q: Array, rng: np.random.Generator, noise: float = 1.0) -> Array:
    y = beacons.values(of, q) + noise * of.sigma * rng.standard_normal((len(q), of.beacons))
    return beacons.wrap(y) if of.kind == "bearings" else y


def step(of: Problem, controller: Controller, start: Array, y: Array) -> Batch:
    return controller.batch(at(of, controller, start), {s.name: y[:, i] for i, s in enumerate(of.channels)})


def nearby(of: Problem, q: Array, rng: np.random.Generator) -> Array:
    return np.asarray(q + np.where(np.array(of.unknowns) == "heading", 0.05, 0.5) * rng.uniform(-1, 1, q.shape))


def disagreement(of: Problem, controller: Controller, samples: int = 2000) -> float:
    """Return the largest difference of the C from the reference, in deviations, with its covariance and chi-square."""
    rng = np.random.default_rng(3)
    q = beacons.draw(of, samples, rng)
    y = measured(of, q, rng)
    best, P, chi_square = beacons.solve(of, y, q)
    out = step(of, controller, nearby(of, q, rng), y).outputs
    assert out["valid"].all() and not out["weak"].any()
    differences = [np.abs(out["chi_square"] - chi_square)]
    for i, name in enumerate(of.unknowns):
        sigma = np.sqrt(P[:, i, i])
        error = out[name] - best[:, i]
        differences += [np.abs(beacons.wrap(error) if name == "heading" else error) / sigma]
        differences += [np.abs(out[f"deviation_{name}"] / sigma - 1)]
    return max(float(d.max()) for d in differences)


@pytest.mark.parametrize("scalar", SCALARS)
@pytest.mark.parametrize("of", PROBLEMS, ids=TITLES)
def test_the_c_computes_the_least_squares_solution(of: Problem, scalar: type[np.floating]) -> None:
    assert disagreement(of, compiled(of, scalar)) < ROUNDING[scalar]


def consistency(of: Problem, controller: Controller, noise: float = 1.0) -> list[float]:
    """Return the rms of error over deviation of each unknown."""
    rng = np.random.default_rng(4)
    q = beacons.draw(of, 20_000, rng)
    out = step(of, controller, nearby(of, q, rng), measured(of, q, rng, noise)).outputs
    ratios = []
    for i, name in enumerate(of.unknowns):
        error = out[name] - q[:, i]
        error = beacons.wrap(error) if name == "heading" else error
        ratios.append(float(np.sqrt(np.mean((error / out[f"deviation_{name}"])[out["valid"] > 0] ** 2))))
        assert np.mean(np.abs(error) < 4 * out[f"deviation_{name}"]) >= 0.999
    return ratios


@pytest.mark.parametrize("of", PROBLEMS, ids=TITLES)
def test_the_deviations_are_those_of_the_errors(of: Problem) -> None:
    """A Monte Carlo of 20,000 samples knows each ratio to 0.5 %; it must be within 0.7 .. 1.5."""
    assert all(0.97 < ratio < 1.03 for ratio in consistency(of, compiled(of)))


def test_noise_that_was_not_declared_shows_in_the_consistency() -> None:
    of = beacons.ranges(3)
    with pytest.raises(AssertionError):
        assert all(ratio < 1.5 for ratio in consistency(of, compiled(of), noise=2.0))


def test_the_covariance_of_dependent_channels_weighs_them() -> None:
    of, rng = beacons.ranges(4), np.random.default_rng(5)
    mixing = np.eye(4) + 0.6 * np.tril(np.ones((4, 4)), -1)
    R = beacons.SIGMA**2 * mixing @ mixing.T
    bare = glsdc_estimator.estimator(
        "estimator",
        beacons.TIME,
        beacons.measurement(of),
        R,
        channels=of.channels,
        unknowns=[beacons.UNKNOWNS[n] for n in of.unknowns],
    )
    controller = compile_block(glsdc_estimator.guarded(bare, "ranges", of.channels, 5))
    q = beacons.draw(of, 20_000, rng)
    y = beacons.values(of, q) + beacons.SIGMA * rng.standard_normal((len(q), 4)) @ mixing.T
    out = step(of, controller, nearby(of, q, rng), y).outputs
    for i, name in enumerate(of.unknowns):
        assert np.sqrt(np.mean(((out[name] - q[:, i]) / out[f"deviation_{name}"]) ** 2)) == pytest.approx(1, abs=0.03)
    assert out["chi_square"].mean() == pytest.approx(2, abs=0.05)


@pytest.mark.parametrize(
    "iteration", [Iteration(7, held_jacobian=True), Iteration(6, descent_check=True)], ids=["held", "descent"]
)
@pytest.mark.parametrize("of", PROBLEMS, ids=TITLES)
def test_a_held_jacobian_and_a_descent_check_reach_the_same_solution(of: Problem, iteration: Iteration) -> None:
    rng = np.random.default_rng(6)
    q = beacons.draw(of, 500, rng)
    y, start = measured(of, q, rng), q + 0.02 * rng.uniform(-1, 1, q.shape)
    other = compile_block(beacons.block(of, iteration=iteration), np.float64)
    first, second = (step(of, c, start, y).outputs for c in (compiled(of, np.float64), other))
    assert first["valid"].all() and second["valid"].all()
    for name in of.unknowns:
        # A held Jacobian H_0 solves H_0'e = 0, which differs from H'e = 0 by the curvature times the residuals.
        assert np.abs(first[name] - second[name]).max() < 0.1 * first[f"deviation_{name}"].min()


def test_with_the_descent_check_no_cost_rises() -> None:
    """For bearings that belong to no pose; without the check the last correction of some raises the cost."""
    of, rng = beacons.bearings(4), np.random.default_rng(7)
    q, y = beacons.draw(of, 3000, rng), rng.uniform(-pi, pi, (3000, 4))

    def rises(iteration: Iteration) -> Array:
        out = step(of, compile_block(beacons.block(of, iteration=iteration), np.float64), q, y).outputs
        end = np.column_stack([out[name] for name in of.unknowns])
        before, after = (np.sum(beacons.wrap(y - beacons.values(of, at)) ** 2, axis=1) for at in (q, end))
        return np.asarray((after - before) / before)

    assert rises(Iteration(4, descent_check=True)).max() < 1e-5 and rises(Iteration(4)).max() > 0.1


def test_a_heading_is_tracked_through_the_end_of_its_range() -> None:
    of, rng = beacons.bearings(4), np.random.default_rng(8)
    heading = beacons.wrap(np.linspace(2.5, 9.5, 200))
    q = np.column_stack([np.full(200, 0.5), np.full(200, -1.0), heading])
    controller = compiled(of)
    start = at(of, controller, q[:1]).reshape(())
    y = measured(of, q, rng)
    out = controller.replay({s.name: y[:, i] for i, s in enumerate(of.channels)}, start).outputs
    assert out["valid"].all() and np.abs(out["heading"]).max() <= np.float32(pi)
    assert np.abs(beacons.wrap(out["heading"] - heading)).max() < 5 * out["deviation_heading"].max()


def compass(form: str) -> Block:
    """Return a heading and the strength of a field from three coils at 120 degrees, in two forms of one model."""
    angles = (0.0, 2 * pi / 3, 4 * pi / 3)
    channels = [Signal(f"v_{k}", "V", -3, 3) for k in "abc"]

    def h(q: Any, k: Any) -> Any:
        if form == "phasor":
            along = [np.cos(a) * q["cos_heading"] + np.sin(a) * q["sin_heading"] for a in angles]
        else:
            along = [ca.cos(q["heading"] - a) for a in angles]
        return {s.name: k["gain"] * q["field"] * v for s, v in zip(channels, along, strict=True)}

    heading = Unknown(Signal("heading", "rad", -pi, pi), 0.3, 0.5, periodic=True, velocity_gain=0.5)
    field = Unknown(Signal("field", "T", 0.4, 1.6), 0.2, 0.2, start=1.0, prior=0.1, prior_value=1.0)
    bare = glsdc_estimator.estimator(
        "compass",
        beacons.TIME,
        h,
        1e-4 * np.eye(3),
        channels=channels,
        unknowns=[heading, field],
        constants=[Constant("gain", 1.5, "V/T", "test")],
    )
    return glsdc_estimator.guarded(bare, f"compass_{form}", channels, 5)


@pytest.mark.parametrize("scalar", SCALARS)
def test_phasors_of_a_periodic_unknown_are_its_cosine_and_sine(scalar: type[np.floating]) -> None:
    heading, rng = np.linspace(0.0, 20.0, 400), np.random.default_rng(9)
    y = 1.5 * 1.1 * np.cos(heading[:, None] - [0, 2 * pi / 3, 4 * pi / 3]) + 0.01 * rng.standard_normal((400, 3))
    inputs = {f"v_{k}": y[:, i] for i, k in enumerate("abc")}
    direct, phasor = (compile_block(compass(form), scalar).replay(inputs).outputs for form in ("direct", "phasor"))
    assert phasor["valid"][5:].all()
    assert np.abs(beacons.wrap(direct["heading"] - phasor["heading"])).max() < 3e-6
    assert np.abs(beacons.wrap(phasor["heading"] - heading))[5:].max() < 5 * phasor["deviation_heading"].max()
    pulled = (1.1 / (0.01 / 1.5) ** 2 * 1.5 + 1.0 / 0.1**2) / (1.5 / (0.01 / 1.5) ** 2 + 1 / 0.1**2)
    assert phasor["field"][5:].mean() == pytest.approx(pulled, abs=1e-3)  # m/2 of the squared cosines, and the prior


def test_a_prior_without_weight_changes_no_bit() -> None:
    of, rng = beacons.ranges(4), np.random.default_rng(10)
    q = beacons.draw(of, 2000, rng)
    y, start = measured(of, q, rng), nearby(of, q, rng)
    x = replace(beacons.UNKNOWNS["x"], prior=1e15, prior_value=2.0)
    for scalar in SCALARS:
        weightless = step(of, compile_block(beacons.block(of, changed={"x": x}), scalar), start, y).outputs
        without = step(of, compiled(of, scalar), start, y).outputs
        assert all(np.array_equal(without[name], weightless[name]) for name in without)
    pulled = step(of, compile_block(beacons.block(of, changed={"x": replace(x, prior=0.05)})), start, y).outputs
    assert np.abs(pulled["x"] - step(of, compiled(of), start, y).outputs["x"]).max() > 0.01


def test_a_prior_about_the_prediction_covers_the_motion() -> None:
    """A body that leaves its prediction by the declared deviation: the estimate is better, and its deviation true."""
    of, rng, moves = beacons.ranges(3), np.random.default_rng(11), 0.02
    changed = {n: replace(beacons.UNKNOWNS[n], prior=moves) for n in "xy"}
    q = beacons.draw(of, 20_000, rng)
    start, y = q + moves * rng.standard_normal(q.shape), measured(of, q, rng)
    free, led = (
        step(of, c, start, y).outputs for c in (compiled(of), compile_block(beacons.block(of, changed=changed)))
    )
    for i, name in enumerate(of.unknowns):
        error, sigma = led[name] - q[:, i], led[f"deviation_{name}"]
        assert np.sqrt(np.mean((error / sigma) ** 2)) == pytest.approx(1, abs=0.03)
        assert (sigma < free[f"deviation_{name}"]).all()


def test_a_prediction_continues_the_motion() -> None:
    """At constant speed one correction a sample has converged with the motion predicted, and lags without it."""
    of = beacons.ranges(4)
    q = np.column_stack([np.linspace(-4, 4, 200), np.linspace(3, -3, 200)])
    inputs = {s.name: v for s, v in zip(of.channels, beacons.values(of, q).T, strict=True)}
    ends = []
    for gain in (0.0, 0.5):
        changed = {n: replace(beacons.UNKNOWNS[n], velocity_gain=gain) for n in "xy"}
        once = Iteration(corrections=1, convergence=1.0)
        controller = compile_block(beacons.block(of, changed=changed, iteration=once))
        out = controller.replay(inputs, at(of, controller, q[:1]).reshape(())).outputs
        ends.append(out["converged"][20:].mean())
    assert ends[0] < 0.1 and ends[1] == 1


def test_an_unknown_that_the_channels_do_not_determine_is_weak(monkeypatch: pytest.MonkeyPatch) -> None:
    """On the line of two beacons their ranges say nothing across it: a limited pivot shows as the largest deviation."""
    monkeypatch.setattr(beacons, "CORNERS", np.array([[-7.0, -5.0], [7.0, -5.0]]))
    of = beacons.ranges(2)
    controller = compile_block(beacons.block(of))
    x, beside = np.linspace(-3, 3, 50), np.full(50, -2.0)
    for y, weak in ((np.full(50, -5.0), 1), (beside, 0)):
        q = np.column_stack([x, y])
        out = step(of, controller, q, beacons.values(of, q)).outputs
        assert (out["weak"] == weak).all() and (out["valid"] == 1 - weak).all()
        assert (out["deviation_y"] == 1).all() == bool(weak)


def test_a_pivot_without_a_floor_is_refused_by_emission(monkeypatch: pytest.MonkeyPatch) -> None:
    def no_floor(left: Any, least: Any, ratio: float) -> Any:
        return original(left, [1e-300] * len(least), ratio)

    original = glsdc.factorise_information
    monkeypatch.setattr(glsdc, "factorise_information", no_floor)
    with pytest.raises(EmitError):
        write.emit(beacons.block(beacons.ranges(3)), np.float32)


def test_channels_of_very_different_deviations_are_proved_safe() -> None:
    """Whitened rows reach 1e7 in single precision: the proofs hold whatever the units."""
    channels = [Signal(n, "m", 0.0, 1e-3) for n in "abcde"]
    unknowns = [Unknown(Signal(n, "m", -3e-4, 3e-4), 5e-6, 1e-4) for n in "xyzw"]

    def h(q: Any, k: Any) -> Any:
        x, y, z, w = (q[n] for n in "xyzw")
        gaps = {"a": x + 200 * y**2, "b": y - x, "c": z + x, "d": w + y, "e": 2 * x + 3 * y + z + w}
        return {n: 5e-4 + 0.3 * gap for n, gap in gaps.items()}

    R = glsdc_model.covariance([5e-8, 6e-8, 7e-8, 8e-8, 9e-8], [0.0] * 5)
    integrity = Integrity({"x": 3e-5, "w": 3e-5})
    bare = glsdc_estimator.estimator(
        "estimator", beacons.TIME, h, R, channels=channels, unknowns=unknowns, integrity=integrity
    )
    controller = compile_block(glsdc_estimator.guarded(bare, "gauges", channels, 5))
    q = {"x": 1e-4, "y": -5e-5, "z": 3e-5, "w": -2e-4}
    out = controller.replay({n: np.full(5, v) for n, v in h(q, {}).items()}).outputs
    assert out["valid"][2:].all()
    assert all(abs(out[n][-1] - v) < 0.1 * out[f"deviation_{n}"][-1] for n, v in q.items())


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e30, -5.0])
def test_no_channel_makes_the_estimate_leave_its_range(value: float) -> None:
    of = beacons.bearings(4)
    controller = compiled(of)
    q = np.zeros((8, 3))
    y = beacons.values(of, q)
    y[3:5, 1] = value
    replay = controller.replay({s.name: y[:, i] for i, s in enumerate(of.channels)})
    assert all(np.isfinite(column).all() for column in replay.outputs.values())
    assert (
        not replay.outputs["valid"][3:5].any() and replay.outputs["valid"][5:].all() and (replay.faults[3:5] != 0).all()
    )


def test_random_states_and_channels_stay_in_the_declared_ranges() -> None:
    of, rng = beacons.ranges(5, bias=True), np.random.default_rng(12)
    controller = compiled(of)
    q = rng.uniform(-1, 1, (5000, 3)) * [5, 5, 2]
    out = step(of, controller, q, rng.uniform(0, 30, (5000, 5))).outputs
    for s in beacons.block(of).outputs:
        assert (out[s.name] >= np.float32(s.low)).all() and (out[s.name] <= np.float32(s.high)).all()
