"""Augmented models against the product of their parts' responses, spectra and simulated errors."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from synth.analyse import discretise
from synth.errors import ModelError, SignalError, TimingError
from synth.statespace import StateSpace, of
from synth.synthesise.observers import coloured, kalman, noise
from synth.timing import Continuous, Discrete
from tests import tolerances


def plant() -> StateSpace:
    """A mass on a guide under a force and a tilt of the floor; position and current are measured."""
    return StateSpace(
        [[0, 1], [-4, -0.5]],
        [[0, 0], [0.7, 9.8]],
        [[1, 0], [0, 0]],
        [[0, 0], [0.2, 0]],
        ("x", "v"),
        ("f", "tilt"),
        ("gap", "current"),
        Continuous(),
        {"x": "m", "v": "m/s", "f": "N", "tilt": "rad", "gap": "m", "current": "A"},
    )


def hum(output: str, unit: str) -> StateSpace:
    """A resonance at 20 rad/s, driven by white noise."""
    A, B, C = [[0, 1], [-400, -2]], [[0], [1]], [[300, 0]]
    return StateSpace(A, B, C, [[0]], ("hum", "hum_rate"), ("white",), (output,), Continuous(), {output: unit})


def drift(output: str, direct: float) -> StateSpace:
    A, B, C = [[-0.1]], [[1.0]], [[1.0]]
    return StateSpace(A, B, C, [[direct]], ("drift",), ("white",), (output,), Continuous(), {"drift": "m"})


POINTS = 1j * np.geomspace(0.1, 100, 30)


def test_the_noise_passes_the_filter_and_then_the_plant() -> None:
    p, f = plant(), replace(hum("f", "N"), D=[[0.4]])
    joined = coloured.process(p, f)
    assert joined.states == ("x", "v", "hum", "hum_rate")
    assert joined.inputs == ("f", "tilt", "white")
    assert joined.outputs == p.outputs
    close = {"rtol": tolerances.of("double")}
    want = p.select(p.outputs, ("f",)).response(POINTS) @ f.response(POINTS)
    np.testing.assert_allclose(joined.select(p.outputs, ("white",)).response(POINTS), want, **close)
    known = joined.select(p.outputs, p.inputs).response(POINTS)
    np.testing.assert_allclose(known, p.response(POINTS), **close)
    assert np.abs(want[:, 1]).min() > 0  # the direct term of the plant is in it


def test_the_noise_is_added_to_the_output_it_is_named_after() -> None:
    joined, p, f = coloured.measurement(plant(), drift("gap", 0.3)), plant(), drift("gap", 0.3)
    got = joined.select(p.outputs, ("white",)).response(POINTS)
    np.testing.assert_allclose(got[:, :1], f.response(POINTS), rtol=tolerances.of("double"))
    np.testing.assert_array_equal(got[:, 1], 0)
    known = joined.select(p.outputs, p.inputs).response(POINTS)
    np.testing.assert_allclose(known, p.response(POINTS), rtol=tolerances.of("double"))


def test_names_and_units_are_carried() -> None:
    joined = coloured.measurement(plant(), drift("gap", 0.3))
    assert (joined.unit("drift"), joined.unit("v"), joined.unit("gap")) == ("m", "m/s", "m")
    estimator = kalman.kalmd(coloured.process(plant(), hum("f", "N")), [2.0], [1e-10, 1e-4], 1e-3, G="white")
    assert estimator.predictor().inputs == ("f", "tilt", "gap", "current")
    assert estimator.predictor().outputs == ("x_estimate", "v_estimate", "hum_estimate", "hum_rate_estimate")


def error_of(estimator: kalman.Estimator, C: np.ndarray, acting: noise.NoisyModel) -> np.ndarray:
    """The covariance of the plant's states less their estimates, the model of the noise being `acting`.

    The estimator may know fewer states than there are; the loop of both is solved as one.
    """
    model, n = acting.model, len(estimator.model.states)
    A = np.block([[model.A, np.zeros((len(model.A), n))], [estimator.L @ model.C, estimator.model.A - estimator.L @ C]])
    B = np.block([[np.eye(len(model.A)), np.zeros(model.C.T.shape)], [np.zeros((n, len(model.A))), estimator.L]])
    e = acting.noise
    W = B @ np.block([[e.W, e.S], [e.S.T, e.V]]) @ B.T
    X = noise.stationary(A, (W + W.T) / 2, model.time)
    H = np.hstack([np.eye(2), np.zeros((2, len(model.A) - 2)), -np.eye(2), np.zeros((2, n - 2))])
    return H @ X @ H.T


def test_a_filter_that_knows_the_colour_errs_as_it_says_and_less_than_one_that_does_not() -> None:
    p = replace(plant().select(("gap",), ("f",)), D=[[0]])
    joined = coloured.process(p, hum("f", "N"))
    knowing = kalman.continuous(joined, [1.0], [1e-6], G="white")
    acting = noise.white(joined, [1.0], [1e-6], G="white")
    err = error_of(knowing, joined.C, acting)
    np.testing.assert_allclose(err, knowing.prior[:2, :2], rtol=1e-6, atol=1e-9 * np.abs(err).max())
    # the density of the hum at low frequency, (300 / 400)^2, as if it were white
    ignorant = kalman.continuous(p, [(300 / 400) ** 2], [1e-6], G=p.B)
    assert (np.diag(error_of(ignorant, p.C, acting)) > 1.1 * np.diag(err)).all()
    assert abs(error_of(ignorant, p.C, acting)[0, 0] / ignorant.prior[0, 0] - 1) > 0.1


def test_sensor_drift_is_distinguished_from_motion() -> None:
    """Simulated with a fixed seed: the error of the position is the filter's own deviation."""
    p = replace(plant().select(("gap",), ("f",)), D=[[0]])
    joined, T = coloured.measurement(p, drift("gap", 0.0)), 0.05
    two = joined.select(joined.outputs, ("f", "white"))
    G = np.hstack([np.eye(3)[:, 1:2], two.B[:, 1:]])
    estimator = kalman.kalmd(joined.select(joined.outputs, ("f",)), [0.04, 0.01], [1e-3], T, G=G)
    rng, runs, model = np.random.default_rng(5), 5_000, estimator.model
    root = np.linalg.cholesky(estimator.noise.W + 1e-18 * np.eye(3))
    x, x_hat = np.zeros((runs, 3)), np.zeros((runs, 3))
    for _ in range(500):
        e = (x - x_hat) @ model.C.T + rng.normal(size=(runs, 1)) * np.sqrt(1e-3)
        error = x - x_hat - e @ estimator.M.T
        x = x @ model.A.T + rng.normal(size=(runs, 3)) @ root.T
        x_hat = x_hat @ model.A.T + e @ estimator.L.T
    # a variance of 5000 runs scatters by 2 %
    np.testing.assert_allclose(np.var(error, axis=0), np.diag(estimator.posterior), rtol=0.05)
    np.testing.assert_allclose(model.A, discretise.zero_order_hold(joined, T).A, rtol=0)


def test_coloured_measurement_noise_without_a_white_part_is_refused_with_the_mend() -> None:
    p = plant().select(("gap",), ("f",))
    with pytest.raises(ModelError, match=r"measurement of gap has no white noise.*reduced-order observer"):
        kalman.continuous(coloured.measurement(p, drift("gap", 0.0)), [1.0], [0.0], G="white")
    both = coloured.measurement(coloured.process(p, hum("f", "N")), drift("gap", 0.3).renamed({"white": "white2"}))
    estimator = kalman.continuous(both, [1.0, 1.0], [0.0], G=("white", "white2"))
    assert estimator.poles.real.max() < 0
    assert estimator.noise.V[0, 0] == pytest.approx(0.09)
    assert estimator.noise.S[-1, 0] == pytest.approx(0.3)  # the drift and the noise that is seen are one


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (
            lambda: coloured.process(plant(), hum("gap", "m")),
            SignalError,
            "'gap' is not an input of the plant.*f, tilt",
        ),
        (lambda: coloured.measurement(plant(), hum("f", "N")), SignalError, "'f' is not an output of the plant"),
        (lambda: coloured.process(plant(), hum("f", "m")), SignalError, "'f' is in m .* and in N in the plant"),
        (
            lambda: coloured.process(plant(), hum("f", "N").renamed({"hum": "v"})),
            SignalError,
            "'v' is a name of the plant and of the shaping filter",
        ),
        (lambda: coloured.process(plant(), replace(hum("f", "N"), time=Discrete(0.1))), TimingError, "discretise"),
    ],
)
def test_what_does_not_fit_is_refused(make: Callable[[], object], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        make()


def test_arrays_and_python_control_systems_are_models() -> None:
    p = of(([[-1.0]], [[1.0]], [[2.0]], [[0.0]]))
    f = hum("u1", "1")
    want = coloured.process(p, f).A
    np.testing.assert_array_equal(coloured.process(([[-1.0]], [[1.0]], [[2.0]], [[0.0]]), f).A, want)
    np.testing.assert_array_equal(coloured.process(p.renamed({"u1": "f"}).to_control(), hum("f", "N")).A, want)
