"""Disk margins against a random search for destabilising factors, python-control and poles."""

from dataclasses import replace

import control
import numpy as np
import pytest
import scipy.linalg
from scipy.optimize import minimize

from synth.analyse.loops import disk, feedback_loop, structured_peak
from synth.statespace import StateSpace, of
from synth.timing import Continuous, Discrete
from tests.analyse.destabiliser import destabiliser
from tests.analyse.disk_tolerances import DOUBLE, LEVEL

Complex = np.typing.NDArray[np.complex128]
Array = np.typing.NDArray[np.float64]
NARROW = np.array([[0.0, 1.0], [-1.0, -2e-5]])  # a resonance at 1 rad/s with a damping of 1e-5


def lqg_pair(p: int, sampled: bool, seed: int) -> tuple[StateSpace, StateSpace]:
    """Return a random plant (p, p) and a linear-quadratic-Gaussian controller, u = -K y."""
    rng = np.random.default_rng(seed)
    n = p + 2
    A = rng.standard_normal((n, n))
    A -= (np.linalg.eigvals(A).real.max() + rng.uniform(-0.3, 0.5)) * np.eye(n)
    B, C, I, O = rng.standard_normal((n, p)), rng.standard_normal((p, n)), np.eye(p), np.zeros((p, p))
    Q, time = np.eye(n), Discrete(0.3) if sampled else Continuous()
    if sampled:
        both = scipy.linalg.expm(np.block([[A, B], [np.zeros((p, n + p))]]) * 0.3)
        A, B = both[:n, :n], both[:n, n:]
        X, Y = scipy.linalg.solve_discrete_are(A, B, Q, I), scipy.linalg.solve_discrete_are(A.T, C.T, Q, I)
        G, F = np.linalg.solve(I + B.T @ X @ B, B.T @ X @ A), A @ Y @ C.T @ np.linalg.inv(I + C @ Y @ C.T)
    else:
        X, Y = scipy.linalg.solve_continuous_are(A, B, Q, I), scipy.linalg.solve_continuous_are(A.T, C.T, Q, I)
        G, F = B.T @ X, Y @ C.T
    return of((A, B, C, O, time)), of((A - B @ G - F @ C, F, G, O, time))


def point(loop: StateSpace, w: Array) -> Complex:
    return np.exp(1j * w * loop.time.period_s) if isinstance(loop.time, Discrete) else 1j * w


def search_least_delta(loop: StateSpace, skew: float, seed: int = 0) -> tuple[float, float, Complex]:
    """Return the least |delta| that a search over w and phases finds, with w and delta, from 1 + L f = 0 alone.

    With f_i = (1 + a d_i)/(1 - b d_i), d = r exp(i phi), it says det((1 + L) - r (b - a L) exp(i phi)) = 0.
    """
    rng, p = np.random.default_rng(seed), len(loop.inputs)
    a, b, one = (1 - skew) / 2, (1 + skew) / 2, np.eye(p)

    def frequency(x: Array) -> Array:
        w = np.exp(np.clip(x, -30, 30))
        return np.pi / loop.time.period_s * w / (1 + w) if isinstance(loop.time, Discrete) else w

    def inverse_radii(v: Array) -> Complex:
        L = loop.response(point(loop, frequency(v[:, 0])))
        turns = np.exp(1j * np.concatenate([np.zeros((len(v), 1)), v[:, 1:]], axis=1))
        values = np.linalg.eigvals(np.linalg.solve(one + L, (b * one - a * L) * turns[:, None, :]))
        return values[np.arange(len(v)), np.abs(values).argmax(axis=1)]

    starts = np.hstack([rng.uniform(-7, 7, (2000, 1)), rng.uniform(0, 2 * np.pi, (2000, p - 1))])
    best = starts[np.argsort(-np.abs(inverse_radii(starts)))[:6]]
    ends = [minimize(lambda v: -np.log(np.abs(inverse_radii(v[None])[0])), v, method="BFGS") for v in best]
    v = min(ends, key=lambda end: end.fun).x
    delta = np.exp(1j * np.append(0.0, v[1:])) / inverse_radii(v[None])[0]
    return float(np.abs(delta[0])), float(frequency(v[:1])[0]), delta


def off_pole(loop: StateSpace, w: float, skew: float, delta: Complex) -> float:
    """Return the distance of the nearest pole of the loop closed with f(delta) from the point of w."""
    f = np.diag((1 + (1 - skew) / 2 * delta) / (1 - (1 + skew) / 2 * delta))
    closed = loop.A - loop.B @ f @ np.linalg.solve(np.eye(len(f)) + loop.D @ f, loop.C)
    return float(np.abs(np.linalg.eigvals(closed) - point(loop, np.array(w))).min())


def holds(margin: disk.DiskMargin, destabilising: float) -> bool:
    """Tell whether a margin is below the destabilising size, within the error of the search."""
    slack = 1.01 if len(margin.channels) <= 3 else 1.05
    return margin.certified and margin.alpha <= destabilising * (1 + DOUBLE) and destabilising <= slack * margin.alpha


CASES = [(p, sampled, seed) for p in (1, 2, 3, 4) for sampled in (False, True) for seed in (0, 1)]


@pytest.mark.slow
@pytest.mark.parametrize(("p", "sampled", "seed"), CASES)
def test_a_search_finds_no_smaller_factors_and_none_much_larger(p: int, sampled: bool, seed: int) -> None:
    loop = feedback_loop.close(*lqg_pair(p, sampled, seed)).L
    skew = (0.0, 0.7, -1.0, 1.0)[(p + seed) % 4]
    margin = disk.of_loop(loop, skew)
    destabilising, w, delta = search_least_delta(loop, skew)
    assert holds(margin, destabilising)
    assert off_pole(loop, w, skew, delta) < 1e-6  # the search is right
    assert margin.lower <= margin.upper <= margin.lower * (1 + LEVEL)
    assert off_pole(loop, margin.frequency, skew, margin.delta) < 1e-6


@pytest.mark.parametrize("sampled", [False, True])
def test_a_peak_off_the_grid_is_found_by_the_certificate(sampled: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """With a planted grid of five points the margin of the grid alone is wrong; the certificate corrects it."""
    loop = feedback_loop.close(*lqg_pair(3, sampled, 5)).Li
    destabilising = search_least_delta(loop, 0.0)[0]
    monkeypatch.setattr(structured_peak, "grid", lambda poles: np.array([0.0, 1e-3, 20.0, 1e3, np.inf]))
    monkeypatch.setattr(structured_peak, "_climb", lambda M, points: None)
    assert disk.of_loop(loop, certify=False).alpha > 1.02 * destabilising
    assert holds(disk.of_loop(loop), destabilising)


def test_a_certificate_of_one_interval_only_is_detected(monkeypatch: pytest.MonkeyPatch) -> None:
    """A planted defect: intervals above the level count as finished."""
    loop = feedback_loop.close(*lqg_pair(3, False, 5)).Li
    destabilising = search_least_delta(loop, 0.0)[0]
    monkeypatch.setattr(structured_peak, "grid", lambda poles: np.array([0.0, 1e-3, 20.0, 1e3, np.inf]))
    monkeypatch.setattr(structured_peak, "_climb", lambda M, points: None)
    monkeypatch.setattr(structured_peak, "_above", lambda M, x, level, intervals: [])
    assert not holds(disk.of_loop(loop), destabilising)


@pytest.mark.parametrize("sampled", [False, True])
def test_the_least_of_several_loops_is_that_of_each_alone(sampled: bool) -> None:
    """Ten loops with their gains changed by up to 10 %, and three that differ more."""
    loop = feedback_loop.close(*lqg_pair(3, sampled, 5)).Li
    loops = [replace(loop, B=loop.B * np.random.default_rng(k).uniform(0.9, 1.1, 3)) for k in range(10)]
    loops += [feedback_loop.close(*lqg_pair(3, sampled, seed)).Li for seed in (5, 6, 7)]
    margins = [disk.of_loop(each).lower for each in loops]
    worst = int(np.argmin(margins))
    least = disk.least(loops, np.inf)
    assert least is not None and least[0] == worst and least[1].lower == pytest.approx(margins[worst], rel=LEVEL)
    others = [each for k, each in enumerate(loops) if k != worst]
    others.append(of((np.array([[-0.5]]), np.ones((1, 1)), np.full((1, 1), 0.01), np.zeros((1, 1)), loop.time)))
    assert disk.least(others, margins[worst]) is None and disk.least([], np.inf) is None


def test_a_loop_that_is_cleared_without_proof_is_detected(monkeypatch: pytest.MonkeyPatch) -> None:
    """A planted defect: intervals above the level count as finished, and a peak off the grid is missed."""
    loop = feedback_loop.close(*lqg_pair(3, False, 5)).Li
    below = 1.02 * disk.of_loop(loop).lower
    monkeypatch.setattr(structured_peak, "grid", lambda poles: np.array([0.0, 1e-3, 20.0, 1e3, np.inf]))
    assert disk.least([loop], below) is not None
    monkeypatch.setattr(structured_peak, "_above", lambda M, x, level, intervals: [])
    assert disk.least([loop], below) is None


def test_where_singular_values_meet_the_level_is_raised_until_the_axis_is_covered() -> None:
    """The scaling then gains little at its neighbours: this loop takes some twenty intervals, and 1e-3 more."""
    loop = feedback_loop.close(*lqg_pair(3, True, 10)).both
    margin = disk.of_loop(loop)
    destabilising, w, delta = search_least_delta(loop, 0.0)
    assert off_pole(loop, w, 0.0, delta) < 1e-6
    assert margin.certified and margin.alpha <= destabilising * (1 + DOUBLE)
    assert margin.upper <= margin.lower * (1 + 2e-3)
    assert margin.upper > margin.lower * (1 + 1e-4)  # otherwise the case does not occur


def narrow() -> StateSpace:
    """Return a loop of two channels with a resonance at 1 rad/s whose width is 2e-5 rad/s."""
    A = scipy.linalg.block_diag(NARROW, -1.0, -2.0)
    B = np.array([[0.0, 0.0], [2e-5, 1e-5], [1.0, 0.0], [0.0, 1.0]])
    C = np.array([[0.0, -0.6, 1.0, 0.3], [0.0, -0.4, -0.2, 1.0]])
    return of((A, B, C, np.zeros((2, 2))))


@pytest.mark.parametrize(
    ("loop", "grid"),
    [
        pytest.param(narrow(), np.geomspace(1e-2, 1.1e2, 400), id="between the points"),
        pytest.param(
            feedback_loop.close(*lqg_pair(2, False, 2)).Li, np.geomspace(1e-3, 0.5, 400), id="beyond the last"
        ),
    ],
)
def test_a_peak_that_python_control_misses_is_found(loop: StateSpace, grid: Array) -> None:
    margin = disk.of_loop(loop)
    assert control.disk_margins(loop.to_control(), grid)[0] > 1.05 * margin.upper
    assert margin.certified and margin.upper <= margin.lower * (1 + LEVEL)
    assert off_pole(loop, margin.frequency, 0.0, margin.delta) < 1e-9


@pytest.mark.parametrize("skew", [0.0, 1.0, -1.0])
@pytest.mark.parametrize("p", [2, 3])
def test_python_control_agrees_on_a_fine_grid(p: int, skew: float) -> None:
    """Its grid misses the peak by about 1e-5, its phase lacks the half-plane case; its gain margin is smaller."""
    loop = feedback_loop.close(*lqg_pair(p, False, 3)).Li
    margin = disk.of_loop(loop, skew)
    alpha, gain, phase = control.disk_margins(loop.to_control(), np.geomspace(1e-3, 1e2, 800), skew)
    assert margin.lower <= alpha and alpha == pytest.approx(margin.alpha, rel=2e-4)
    smaller = min(margin.gain_high, 1 / margin.gain_low) if margin.gain_low > 0 else margin.gain_high
    assert 20 * np.log10(smaller) == pytest.approx(gain, rel=1e-3)
    assert margin.phase == pytest.approx(phase, rel=1e-3)


@pytest.mark.parametrize("sampled", [False, True])
def test_one_channel_at_a_time_is_the_scalar_loop_with_the_other_closed(sampled: bool) -> None:
    loop = feedback_loop.close(*lqg_pair(2, sampled, 7)).L
    w = np.geomspace(1e-3, np.pi / 0.3, 20001)
    L = loop.response(point(loop, w))
    by_channel = disk.loop_at_a_time(loop)
    assert tuple(by_channel) == loop.inputs
    for k, alone in enumerate(by_channel.values()):
        j = 1 - k
        scalar = L[:, k, k] - L[:, k, j] * L[:, j, k] / (1 + L[:, j, j])
        assert alone.alpha == pytest.approx(2 / np.abs((1 - scalar) / (1 + scalar)).max(), rel=1e-4)
        assert alone.alpha > disk.of_loop(loop).alpha and alone.channels == (loop.inputs[k],)


@pytest.mark.parametrize("sampled", [False, True])
def test_factors_at_inputs_and_outputs_at_once_are_a_search_of_the_whole_loop(sampled: bool) -> None:
    plant, controller = lqg_pair(2, sampled, 4)
    closed = feedback_loop.close(plant, controller)
    both = disk.of_loop(closed.both)
    parts = [disk.of_loop(part).alpha for part in (closed.Li, closed.L)]
    assert both.certified and both.alpha < min(parts)
    f_u, f_y = np.diag(both.factors[:2]), np.diag(both.factors[2:])
    closed = np.block(
        [
            [plant.A, -plant.B @ f_u @ controller.C],
            [controller.B @ f_y @ plant.C, controller.A],
        ]
    )
    assert np.abs(np.linalg.eigvals(closed) - point(plant, np.array(both.frequency))).min() < 1e-6


@pytest.mark.parametrize(("sampled", "skew"), [(False, 0.0), (False, 1.0), (True, 0.0), (True, -1.0)])
def test_the_destabiliser_is_a_real_system_that_puts_a_pole_on_the_boundary(sampled: bool, skew: float) -> None:
    loop = feedback_loop.close(*lqg_pair(3, sampled, 0 if sampled else 3)).Li
    margin = disk.of_loop(loop, skew)
    f = destabiliser(margin)
    assert f.inputs == loop.inputs and f.time == loop.time and np.isrealobj(f.A)
    value = np.diagonal(f.response(point(loop, np.array(margin.frequency)))[0])
    assert value == pytest.approx(margin.factors, rel=1e-6)
    poles = control.feedback(control.series(f.to_control(), loop.to_control()), np.eye(3)).poles()
    assert np.abs(poles - point(loop, np.array(margin.frequency))).min() < 1e-6
    # Its modulus is alpha at all frequencies: delta = (f - 1)/(a + b f).
    a, b = (1 - skew) / 2, (1 + skew) / 2
    values = np.diagonal(f.response(point(loop, np.linspace(0.1, 9.0, 20))), axis1=1, axis2=2)
    assert np.abs((values - 1) / (a + b * values)) == pytest.approx(margin.upper, rel=1e-6)


def test_units_of_state_and_time_do_not_matter() -> None:
    loop = feedback_loop.close(*lqg_pair(3, False, 2)).Li
    scale = 10.0 ** np.linspace(-4, 4, len(loop.A))
    A, B, C = 1e3 * loop.A * scale / scale[:, None], 1e3 * loop.B / scale[:, None], loop.C * scale
    margin, expected = disk.of_loop((A, B, C, loop.D)), disk.of_loop(loop)
    assert margin.alpha == pytest.approx(expected.alpha, rel=1e-6)
    assert margin.frequency == pytest.approx(1e3 * expected.frequency, rel=1e-3)


def test_the_curve_is_the_margin_of_each_frequency() -> None:
    loop = feedback_loop.close(*lqg_pair(3, True, 1)).Li
    margin = disk.of_loop(loop)
    assert margin.frequencies[0] == 0 and margin.frequencies[-1] == pytest.approx(np.pi / 0.3)
    assert (np.diff(margin.frequencies) >= 0).all() and margin.curve.min() == pytest.approx(margin.alpha, rel=LEVEL)
    inner = slice(1, -1, 20)
    alpha = control.disk_margins(loop.to_control(), margin.frequencies[inner], returnall=True)[0]
    assert (margin.curve[inner] <= alpha * (1 + 1e-6)).all() and margin.curve[inner] == pytest.approx(alpha, rel=0.01)


def test_a_loop_without_gain_has_no_factors_to_show() -> None:
    """L = 0 with skew -1: f has no effect, whatever it is."""
    margin = disk.of_loop(([[-1.0]], [[0.0]], [[0.0]]), -1.0)
    assert np.isinf(margin.upper) and "no factors make the loop unstable" in str(margin)


def test_a_parabola_leads_to_the_peak_and_to_no_other_point() -> None:
    w = np.array([1.0, 1.7, 2.5])
    assert np.allclose(structured_peak._vertex(w, 3 - (w - 2) ** 2), [2.0], rtol=1e-14)
    for bound in (w, 1 + (w - 2) ** 2, 3 - (w - 1.7) ** 2, 3 - (w - 4) ** 2):  # straight, a valley, at a point, beyond
        assert not len(structured_peak._vertex(w, bound))
    oscillator = of(([[0, 1], [-1, -0.2]], [[0], [1]], [[1, 0]], [[0]]))
    peak = structured_peak.over_frequency(oscillator)
    assert peak.certified and np.isclose(peak.lower, 1 / (0.2 * np.sqrt(1 - 0.01)), rtol=1e-8)
