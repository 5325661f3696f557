"""Recovery of the example of Doyle and Stein (1979), of sampled plants, and its obstacles."""

from collections.abc import Callable
from dataclasses import replace

import control
import numpy as np
import pytest

from synth.errors import ModelError, SignalError, TimingError
from synth.statespace import StateSpace, of
from synth.synthesise.feedback import lqr
from synth.synthesise.observers import kalman, lqg, noise, recovery
from synth.timing import Continuous, Discrete
from tests import tolerances

BAND = (0.01, 100.0)
QS = (0.0, 1e3, 1e4)


def doyle_stein() -> StateSpace:
    """(s + 2) / ((s + 1) (s + 3)), whose noise enters by (35, -61)."""
    units = {"x1": "m", "x2": "m/s", "u": "N", "y": "m"}
    return StateSpace(
        [[0, 1], [-3, -4]], [[0], [1]], [[2, 1]], [[0]], ("x1", "x2"), ("u",), ("y",), Continuous(), units
    )


NAMES = (("x1", "x2", "x3"), ("u",), ("y",))
NOISE = [[35.0], [-61.0]]


def regulator() -> lqr.Gain:
    root = np.sqrt(80) * np.array([[35**0.5], [1.0]])
    return lqr.lqr(doyle_stein(), (root @ root.T + (root @ root.T).T) / 2, np.eye(1))


def sampled_plant() -> StateSpace:
    """A sampled plant with its zero at 0.87 and C B = 1: it answers in the next sample."""
    C, units = [[0.3, 1]], {"x1": "m", "x2": "m/s", "u": "N", "y": "m"}
    return StateSpace(
        [[0.9, 0.1], [-0.2, 0.7]], [[0], [1]], C, [[0]], ("x1", "x2"), ("u",), ("y",), Discrete(0.1), units
    )


def test_the_gains_of_the_published_example() -> None:
    """Printed: u = -(50, 10) x and L = (30, -50)."""
    np.testing.assert_allclose(regulator().K, [[-50, -10]], rtol=1e-4)
    np.testing.assert_allclose(kalman.continuous(doyle_stein(), [1.0], [1.0], NOISE).L[:, 0], [30, -50], rtol=1e-3)


def test_the_loop_is_recovered_at_the_input_as_q_grows_and_noise_with_it() -> None:
    sweep = recovery.at_input(regulator(), doyle_stein(), [1.0], [1.0], QS, BAND, G=NOISE)
    assert not sweep.obstacles
    assert sweep.distances[0] > 1
    assert sweep.distances[1] / sweep.distances[2] == pytest.approx(10, rel=0.05)  # falls as 1 / q
    assert sweep.distances[2] < 0.02
    deviations = [step.noise.deviations["u"] for step in sweep.steps]
    assert deviations[2] > 2 * deviations[1]
    # the margin that the published example has lost, 15 degrees or less, comes back to the 60 and more of feedback
    margins = []
    for step in sweep.steps:
        loop = control.series(doyle_stein().to_control(), -1 * step.controller.compensator.to_control())
        margins.append(control.margin(loop)[1])
    assert margins[0] < 15.1
    assert margins[2] > 60


def test_the_loop_is_recovered_at_the_output() -> None:
    estimator = kalman.continuous(doyle_stein(), [1.0], [1.0], NOISE)
    sweep = recovery.at_output(estimator, {"x1": 1e-3, "x2": 1e-3}, [1.0], QS, BAND)
    assert not sweep.obstacles
    assert sweep.distances[1] / sweep.distances[2] == pytest.approx(10, rel=0.05)
    assert sweep.distances[2] < 0.02
    assert [step.controller.estimator for step in sweep.steps] == [estimator] * 3


def test_the_distance_is_that_of_python_control_loops() -> None:
    plant, gain = doyle_stein(), regulator()
    step = recovery.at_input(gain, plant, [1.0], [1.0], (100.0,), BAND, G=NOISE).steps[0]
    F, G = step.controller.compensator.to_control(), plant.to_control()
    full = control.ss(plant.A, plant.B, -gain.K, 0)
    w = np.geomspace(*BAND, recovery.POINTS)
    loop, target = (control.frequency_response(s, w, squeeze=True).complex for s in (-1 * F * G, full))
    assert step.distance == pytest.approx(
        (np.abs(loop - target) / np.abs(target)).max(), rel=tolerances.of("frequency")
    )
    assert step.controller.estimator.noise.W[1, 1] == pytest.approx(61**2 + 100**2)
    expectation = lqg.expected_cost(step.controller, noise.white(plant, [1.0], [1.0], NOISE).noise)
    assert step.noise.deviations == expectation.deviations  # the noise that acts, without what was added for recovery


def test_noise_raised_along_anything_but_the_inputs_does_not_recover() -> None:
    plant, gain, s = doyle_stein(), regulator(), 1j * np.geomspace(*BAND, 50)
    target = -gain.K @ np.linalg.solve(s[:, None, None] * np.eye(2) - plant.A, np.broadcast_to(plant.B, (50, 2, 1)))

    def distance(direction: np.ndarray) -> float:
        W = np.outer(*2 * [NOISE @ np.ones(1)]) + 1e8 * np.outer(direction, direction)
        estimator = kalman.continuous(plant, W, [1.0])
        F = lqg.current(gain, estimator).compensator
        return float((np.abs(-F.response(s) @ plant.response(s) - target) / np.abs(target)).max())

    assert distance(np.array([0.0, 1.0])) < 0.02
    assert distance(np.array([1.0, 0.0])) > 0.5


@pytest.mark.parametrize("place", ["input", "output"])
def test_a_sampled_loop_is_recovered_in_the_current_form_alone(place: str, monkeypatch: pytest.MonkeyPatch) -> None:
    plant, band = sampled_plant(), (0.01, 30.0)

    def sweep() -> recovery.Recovery:
        if place == "input":
            gain = lqr.lqr(plant, np.eye(2), [[0.1]])
            return recovery.at_input(gain, plant, [1, 1], [1], (10, 1e3), band)
        return recovery.at_output(kalman.discrete(plant, [1, 1], [1]), [1, 1], [1], (10, 1e3), band)

    now = sweep()
    assert not now.obstacles
    assert now.distances[1] < 1e-5
    monkeypatch.setattr(lqg, "current", lqg.predictor)
    assert sweep().distances[1] > 0.5


def test_two_inputs_and_two_outputs_are_recovered_and_integrators_with_them() -> None:
    rng = np.random.default_rng(2)
    A, B = rng.normal(size=(4, 4)) - 2 * np.eye(4), rng.normal(size=(4, 2))
    plant = of((A, B, B.T))  # C B > 0; its zeros are checked below, by having no obstacle
    weight = lqr.with_integrators(plant, ("y1", "y2"))
    gain = lqr.lqr(weight, np.diag([1, 1, 1, 1, 10, 10]), np.eye(2))
    sweep = recovery.at_input(gain, plant, np.ones(4), np.ones(2), (1.0, 1e3, 1e4), (0.1, 10))
    assert not sweep.obstacles
    assert sweep.distances[0] > 0.3
    assert sweep.distances[2] < 0.01
    s, F = 1j * np.geomspace(0.1, 10, recovery.POINTS), sweep.steps[0].controller.compensator
    ratios = -F.select(F.outputs, plant.outputs).response(s) @ plant.response(s)
    targets = -gain.K @ replace(weight, C=np.eye(6), D=np.zeros((6, 2)), outputs=weight.states).response(s)
    sizes = [[np.linalg.svd(M)[1][0] for M in stack] for stack in (ratios - targets, targets)]
    assert sweep.distances[0] == pytest.approx(np.max(np.divide(*sizes)), rel=tolerances.of("frequency"))


def test_a_pair_of_zeros_is_named_once() -> None:
    plant = StateSpace(
        np.diag([-1.0, 0, 0]) + np.eye(3, k=1), [[0], [0], [1]], [[5, -3, 1]], [[0]], *NAMES, Continuous()
    )
    sweep = recovery.at_input(lqr.lqr(plant, np.eye(3), [[1.0]]), plant, [1, 1, 1], [1], (1.0,), (0.1, 10))
    zeros = np.roots(np.polyadd(np.polyadd([1, 1, 0], np.polymul([-3], [1, 1])), [5]))
    assert zeros[0].imag
    assert len(sweep.obstacles) == 1
    assert f"{zeros[0].real:.5g}" in sweep.obstacles[0]


def test_a_zero_on_the_right_is_named_and_the_loop_is_not_recovered() -> None:
    plant = replace(doyle_stein(), C=[[2, -1]])
    sweep = recovery.at_input(regulator(), plant, [1.0], [1.0], QS, BAND, G=NOISE)
    assert sweep.obstacles == ("the plant's zero 2 does not decay: no recovery near it and above",)
    assert sweep.distances[2] > 0.5
    assert "the plant's zero 2 does not decay" in repr(sweep)


def test_a_sampled_mass_has_its_zero_at_minus_one() -> None:
    held = kalman.kalmd(of(([[0, 1], [0, 0]], [[0], [1]], [[1, 0]])), [1, 1], [1], 0.1).model
    gain = lqr.lqr(held, np.eye(2), [[1.0]])
    sweep = recovery.at_input(gain, held, [1, 1], [1], (1.0, 1e4), (0.1, 30))
    assert len(sweep.obstacles) == 1
    assert "zero -1 does not decay" in sweep.obstacles[0]
    assert sweep.distances[1] > 0.1


def test_a_late_answer_and_too_few_outputs_are_named() -> None:
    plant = sampled_plant()
    late = replace(plant, C=[[1, 0]])
    sweep = recovery.at_input(lqr.lqr(late, np.eye(2), [[1.0]]), late, [1, 1], [1], (1e4,), (0.1, 30))
    assert any("C B does not have full rank" in text for text in sweep.obstacles)
    assert sweep.distances[0] > 0.1
    wide = replace(plant, B=np.eye(2), D=[[0, 0]], inputs=("u1", "u2"))
    sweep = recovery.at_input(lqr.lqr(wide, np.eye(2), np.eye(2)), wide, [1, 1], [1], (1e4,), (0.1, 30))
    assert any("rank 1 but 2 inputs" in text for text in sweep.obstacles)
    assert sweep.distances[0] > 0.1


def test_correlated_noise_of_a_sampled_plant_is_named_at_the_output() -> None:
    estimator = kalman.discrete(sampled_plant(), [1, 1], [1], S=[[0.3], [0.3]])
    sweep = recovery.at_output(estimator, [1, 1], [1], (1e3,), (0.01, 30.0))
    assert any("correlated" in text for text in sweep.obstacles)
    assert sweep.distances[0] > 0.1


def test_a_sweep_prints_distances_beside_deviations_with_units() -> None:
    text = repr(recovery.at_input(regulator(), doyle_stein(), [1.0], [1.0], QS, BAND, G=NOISE))
    assert "Loop transfer recovery at the input" in text
    assert "deviation of u [N]" in text
    assert "0.01 .. 100 rad/s" in text


def test_arrays_and_python_control_systems_are_models() -> None:
    m, gain = of((doyle_stein().A, doyle_stein().B, doyle_stein().C, [[0.0]])), regulator()
    gain = replace(gain, inputs=("u1",))
    want = recovery.at_input(gain, m, [1.0], [1.0], QS, BAND, G=NOISE).distances
    arrays = (m.A, m.B, m.C, m.D)
    np.testing.assert_array_equal(recovery.at_input(gain, arrays, [1.0], [1.0], QS, BAND, G=NOISE).distances, want)
    np.testing.assert_array_equal(
        recovery.at_input(gain, m.to_control(), [1.0], [1.0], QS, BAND, G=NOISE).distances, want
    )


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: at_input(qs=(-1.0,)), SignalError, "sweep is over q"),
        (lambda: at_input(qs=()), SignalError, "at least one"),
        (lambda: at_input(qs=(np.nan,)), SignalError, "sweep is over q"),
        (lambda: at_input(band=(0.0, 1.0)), SignalError, "0 < low < high"),
        (lambda: at_input(plant=sampled_plant(), band=(1.0, 40.0)), SignalError, "below 31.4"),
        (lambda: at_input(plant=sampled_plant(), band=(1.0, 30.0)), TimingError, "discretise"),
        (lambda: at_input(plant=replace(doyle_stein(), D=[[1.0]])), ModelError, "y depend directly on u"),
        (lambda: at_input(plant=doyle_stein().renamed({"x1": "a"})), SignalError, "'a' is not both"),
        (
            lambda: recovery.at_output(kalman.continuous(doyle_stein(), [1, 1], [1]), [1, -1], [1], QS, BAND),
            SignalError,
            "Q has",
        ),
    ],
)
def test_what_does_not_fit_is_refused(make: Callable[[], object], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        make()


def at_input(
    plant: StateSpace | None = None, qs: tuple[float, ...] = QS, band: tuple[float, float] = BAND
) -> recovery.Recovery:
    return recovery.at_input(regulator(), plant or doyle_stein(), [1, 1], [1], qs, band)


def test_a_gain_of_zero_leaves_nothing_to_recover() -> None:
    """A plant that forgets its state within a sample needs neither gain nor filter."""
    plant = ([[0.0]], [[1.0]], [[1.0]], [[0.0]], 0.1)
    with pytest.raises(ModelError, match="target loop of the gain K is 0 in the band: there is nothing to recover"):
        recovery.at_input(lqr.lqr(plant, [1.0], [1.0]), plant, [1.0], [1.0], [0, 1.0], (0.1, 10))
    with pytest.raises(ModelError, match="target loop of the gain L is 0 in the band: there is nothing to recover"):
        recovery.at_output(kalman.discrete(plant, [1.0], [1.0]), [1.0], [1.0], [0, 1.0], (0.1, 10))


@pytest.mark.parametrize(
    ("qs", "band"),
    [([1j], (0.1, 10)), (["a"], (0.1, 10)), (1.0, (0.1, 10)), ([1.0], (1, 2, 3)), ([1.0], None), ([1.0], (1j, 2))],
)
def test_a_sweep_that_is_no_list_of_numbers_is_refused(qs: list[float], band: tuple[float, float]) -> None:
    plant = ([[-1.0]], [[1.0]], [[1.0]])
    with pytest.raises(SignalError, match=r"the sweep|the band|`(qs|band)` of"):
        recovery.at_input(lqr.lqr(plant, [1.0], [1.0]), plant, [1.0], [1.0], qs, band)
