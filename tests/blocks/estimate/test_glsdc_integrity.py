"""Integrity of least squares: thresholds against SciPy, achieved risk within the allocated one, exclusion, refusals."""

from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest
from scipy import stats

from benchmarks import beacons
from benchmarks.beacons import Problem
from synth.block import Block
from synth.blocks.estimate import glsdc_estimator, glsdc_integrity, glsdc_model
from synth.blocks.estimate.glsdc_integrity import Integrity
from synth.blocks.estimate.glsdc_model import Unknown
from synth.errors import ModelError
from synth.execute.host import Columns, Controller, compile_block
from synth.signals import Signal
from synth.statespace import Array

RISK, FALSE_ALARM, SAMPLES = 1e-2, 1e-3, 10_000
LIMITS = {"ranges": {"x": 0.8, "y": 0.8}, "bearings": {"x": 0.3, "y": 0.3, "heading": 0.03}}
PROBLEMS = [beacons.ranges(5), beacons.ranges(6, bias=True), beacons.bearings(6)]
SIZES = (0.0, 4.0, 6.0, 8.0, 12.0, 50.0)  # deviations of the channel


def integrity(of: Problem, exclude: bool = False) -> Integrity:
    return Integrity(LIMITS[of.kind], FALSE_ALARM, RISK, exclude)


@cache
def compiled(of: Problem, exclude: bool) -> Controller:
    return compile_block(beacons.block(of, integrity(of, exclude)))


class Run(NamedTuple):
    """Outputs of the last of some samples, and the errors (N, n) of the limited unknowns."""

    outputs: Columns
    errors: Array
    channel: Array

    def misleading(self, names: list[str]) -> list[float]:
        """Return for each unknown the fraction of samples that are valid with an error above the protection level."""
        valid = self.outputs["valid"] > 0
        levels = [self.outputs[f"protection_{n}"] for n in names]
        return [float((valid & (e > p)).mean()) for e, p in zip(self.errors.T, levels, strict=True)]


def run(of: Problem, controller: Controller, size: float, samples: int = 3, noise: float = 1.0) -> Run:
    """Return the last of some samples at rest with a fault in a random channel of each of SAMPLES bodies."""
    rng = np.random.default_rng(round(1 + 10 * size))
    q, channel = beacons.draw(of, SAMPLES, rng), rng.integers(of.beacons, size=SAMPLES)
    states = np.repeat(controller.init()[None], SAMPLES)
    for name, values in zip(of.unknowns, q.T, strict=True):
        states[f"estimator_{name}"] = values + (0.01 if name == "heading" else 0.05) * rng.uniform(-1, 1, SAMPLES)
    for _ in range(samples):
        y = beacons.values(of, q) + noise * of.sigma * rng.standard_normal((SAMPLES, of.beacons))
        y[np.arange(SAMPLES), channel] += size * of.sigma
        y = beacons.wrap(y) if of.kind == "bearings" else y
        batch = controller.batch(states, {s.name: y[:, i] for i, s in enumerate(of.channels)})
        states = batch.states
    errors = np.column_stack([batch.outputs[n] for n in LIMITS[of.kind]]) - q[:, : len(LIMITS[of.kind])]
    errors = beacons.wrap(errors) if of.kind == "bearings" else errors
    return Run(batch.outputs, np.abs(errors), channel)


@pytest.mark.parametrize("freedom", [1, 2, 3, 7])
@pytest.mark.parametrize("risk", [1e-2, 1e-4, 1e-7])
def test_the_thresholds_are_those_of_scipy(freedom: int, risk: float) -> None:
    """The noncentral distribution is summed here as a Poisson mixture of central ones."""
    of = glsdc_integrity.thresholds(freedom, FALSE_ALARM, risk)
    assert stats.chi2.sf(of.test, freedom) == pytest.approx(FALSE_ALARM, rel=1e-9)
    j = np.arange(400)
    mixture = stats.poisson.pmf(j, of.noncentrality / 2) @ stats.chi2.cdf(of.test, freedom + 2 * j)
    assert mixture == pytest.approx(risk, rel=1e-5)
    assert stats.ncx2.cdf(of.test, freedom, of.noncentrality) == pytest.approx(risk, rel=1e-6)
    assert 2 * stats.norm.sf(of.deviations) == pytest.approx(risk / 2, rel=1e-9)
    if freedom == 1:  # |N(sqrt(L), 1)| <= sqrt(T)
        root = np.sqrt(of.noncentrality)
        inside = stats.norm.cdf(np.sqrt(of.test) - root) - stats.norm.cdf(-np.sqrt(of.test) - root)
        assert inside == pytest.approx(risk, rel=1e-6) and of.hypothesis == np.inf
    else:
        assert stats.chi2.sf(of.hypothesis, freedom - 1) == pytest.approx(risk / 2, rel=1e-9)


@pytest.mark.parametrize("of", PROBLEMS, ids=lambda of: of.kind)
def test_the_levels_are_those_of_the_reference(of: Problem) -> None:
    """With pseudoinverses: slopes of a fault in each channel, of the estimate over the residuals."""
    out = run(of, compiled(of, exclude=False), 0.0, samples=1).outputs
    at = np.column_stack([out[name] for name in of.unknowns])
    H = beacons.jacobian(of, at)
    K = np.linalg.pinv(H)
    S = np.eye(of.beacons) - H @ K
    limits = glsdc_integrity.thresholds(of.beacons - len(of.unknowns), FALSE_ALARM, RISK)
    slopes = np.abs(K) / np.sqrt(np.diagonal(S, axis1=1, axis2=2))[:, None, :]
    sigmas = of.sigma * np.linalg.norm(K, axis=2)
    levels = of.sigma * np.sqrt(limits.noncentrality) * slopes.max(axis=2) + limits.deviations * sigmas
    for i, name in enumerate(LIMITS[of.kind]):
        np.testing.assert_allclose(out[f"protection_{name}"], levels[:, i], rtol=2e-3)


@pytest.mark.parametrize("exclude", [False, True], ids=["test", "exclusion"])
@pytest.mark.parametrize("of", PROBLEMS, ids=lambda of: of.kind)
def test_the_achieved_risk_is_at_most_the_allocated_one(of: Problem, exclude: bool) -> None:
    for size in SIZES:
        result = run(of, compiled(of, exclude), size)
        assert max(result.misleading(list(LIMITS[of.kind]))) <= RISK
        if size == 0:
            assert result.outputs["valid"].mean() > 0.99


def test_noise_beyond_the_covariance_shows_as_false_alarms_and_risk() -> None:
    of = beacons.ranges(5)
    result = run(of, compiled(of, exclude=False), 0.0, noise=2.0)
    assert result.outputs["valid"].mean() < 0.9


def test_a_faulty_channel_is_excluded_and_taken_in_again() -> None:
    of, rng = beacons.ranges(6), np.random.default_rng(3)
    controller = compiled(beacons.ranges(6, bias=True), exclude=True)
    of = beacons.ranges(6, bias=True)
    q = np.repeat([[1.0, -2.0, 0.3]], 60, axis=0)
    y = beacons.values(of, q) + of.sigma * rng.standard_normal((60, 6))
    y[20:40, 2] += 1.0
    out = controller.replay({s.name: y[:, i] for i, s in enumerate(of.channels)}).outputs
    assert not out["excluded"][5:21].any() and not out["excluded"][41:].any() and (out["excluded"][22:40] == 3).all()
    assert out["valid"][5:20].all() and not out["valid"][20] and out["valid"][22:40].all() and out["valid"][42:].all()
    error = np.hypot(out["x"] - 1, out["y"] + 2)
    assert error[20] > 0.2 and error[22:40].max() < 0.15


def test_hypotheses_that_disagree_are_not_valid() -> None:
    """With the fewest beacons that exclusion needs, few faults are separable: the level covers both explanations."""
    of = beacons.ranges(5, bias=True)
    result = run(of, compile_block(beacons.block(of, integrity(of, exclude=True))), 12.0)
    wrong = (result.outputs["excluded"] > 0) & (result.outputs["excluded"] != result.channel + 1)
    assert wrong.mean() > 0.02
    assert max(result.misleading(["x", "y"])) <= RISK


def test_a_channel_that_alone_determines_an_unknown_has_no_protection() -> None:
    """A fault of the only height gauge moves the height and leaves no residual, however small it is."""
    names = ("a", "b", "gauge")
    channels = [Signal(n, "m", -2.0, 2.0) for n in names]
    unknowns = [Unknown(Signal(n, "m", -1, 1), largest_deviation=0.1, step=0.5) for n in ("along", "height")]

    def block(of: Any) -> Block:
        bare = glsdc_estimator.estimator(
            "estimator",
            beacons.TIME,
            lambda q, k: {"a": q["along"], "b": q["along"], "gauge": q["height"]},
            glsdc_model.covariance([1e-3] * 3, [0.0] * 3),
            channels=channels,
            unknowns=unknowns,
            integrity=of,
        )
        return glsdc_estimator.guarded(bare, "gauges", channels, 5)

    inputs = {"a": np.full(5, 0.5), "b": np.full(5, 0.5), "gauge": np.full(5, 0.2)}
    out = compile_block(block(Integrity({"along": 0.05, "height": 0.05}))).replay(inputs).outputs
    assert out["converged"][2:].all() and not out["valid"].any()
    assert (out["protection_height"] == np.float32(5.0)).all()


def test_before_a_fault_exclusion_changes_no_bit() -> None:
    of = beacons.ranges(5)
    plain, excluding = (run(of, compiled(of, exclude), 0.0, samples=1).outputs for exclude in (False, True))
    unequal = [name for name in plain if not np.array_equal(plain[name], excluding[name])]
    assert not unequal and not excluding["excluded"].any()


def test_a_test_reduces_to_the_estimator_without_one() -> None:
    """Bit for bit: monitoring only adds outputs, and takes validity away."""
    of = beacons.ranges(5)
    monitored = run(of, compiled(of, exclude=False), 5.0).outputs
    alone = run_without_levels(of)
    assert all(np.array_equal(monitored[name], alone[name]) for name in alone if name != "valid")
    assert (monitored["valid"] <= alone["valid"]).all() and (monitored["valid"] < alone["valid"]).any()


def run_without_levels(of: Problem) -> Columns:
    return run(of, compile_block(beacons.block(of)), 5.0).outputs


def test_exclusion_from_dependent_channels_is_refused() -> None:
    of = beacons.ranges(5)
    arguments: Any = {"channels": of.channels, "unknowns": [beacons.UNKNOWNS[n] for n in of.unknowns]}
    R = beacons.SIGMA**2 * (np.eye(5) + 0.1)
    with pytest.raises(ModelError, match="errors are independent"):
        glsdc_estimator.estimator(
            "e", beacons.TIME, beacons.measurement(of), R, integrity=integrity(of, exclude=True), **arguments
        )
