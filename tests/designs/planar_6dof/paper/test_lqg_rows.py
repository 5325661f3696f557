"""The audit of the planar positioner's optimal gains and Kalman filter: known figures, verdicts, what moves what."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
import scipy.signal
from scipy.optimize import brentq

from designs.planar_6dof import filtering
from designs.planar_6dof.paper import gains, kalman_filter
from designs.planar_6dof.paper.records import prominent_line
from synth.report.audit import Formula, Published, Row
from synth.synthesise.feedback import lqr
from synth.synthesise.observers import kalman, square_root_kalman
from synth.timing import Discrete
from tests.designs.planar_6dof.paper import recomputed
from tests.designs.planar_6dof.paper.recomputed import (
    PRINTED,
    RECORDED,
    assert_a_number_moves_what_depends_on_it,
    one,
    recorded,
    with_other_digits,
)

ROWS = recomputed.ids(optimal=True)
NUMBERS = recomputed.numbers(list(PRINTED))
T = 1 / 800
STATES = ("x", "y", "phi", "z1", "z2", "z3", "d", "f", "v")
Q49 = np.diag([1e4, 1e3, 1e3, 1e10, 1e9, 1e10, 1e2, 1e1, 2e1])


@pytest.fixture(scope="module")
def rows() -> dict[str, Row]:
    return {name: one(name) for name in ROWS}


# Worked out apart from this code, to the digits given: (row, figure, value, one unit of the last digit).
K49 = (1757.55, 507.24, 472.64, 84872, 19975, 41394, 18.1556, 6.4304, 2.6962)
K47 = (898.22, 316.06, 144.24, 27793, 6140.1, 3124.6, 14.500, 7.8274, 3.3136)
LAST = (1e-2, 1e-2, 1e-2, 1, 0.1, 0.1, 1e-3, 1e-4, 1e-4)
EXPECTED = [
    *(("Y-10", f"gain of {n}", value, 1.3e-5 * value / 0.6) for n, value in zip(STATES, K49, strict=True)),
    *(("Y-11", f"gain of {n}", value, unit) for n, value, unit in zip(STATES, K47, LAST, strict=True)),
    ("Y-12", "H, own position", 1600.0, 0.1),
    ("Y-12", "H, another position", 0.000625, 1e-6),
    ("Y-12", "H, own integral", 1.0, 1e-4),
    ("Y-12", "greatest |z| of A22 - H A12", 1.0000023, 1e-7),
    ("Y-13", "bandwidth at 800 Hz", 25.458, 1e-3),
    ("Y-13", "bandwidth at 1 kHz", 25.627, 1e-3),
    ("Y-14", "bandwidth at 800 Hz", 75.532, 1e-3),
    ("Y-14", "bandwidth at 1 kHz", 76.850, 1e-3),
    ("Y-15", "noise left in x and y at 800 Hz", 0.33906, 1e-5),
    ("Y-15", "noise left in x and y at 1 kHz", 0.30502, 1e-5),
    ("Y-36", "greatest |z| of A - B K, y", 0.94562, 1e-5),
    ("Y-38", "reduction between the printed levels", 75, 1e-9),
    ("Y-39", "gain after 1 s, as printed", 1, 1e-9),
    ("Y-39", "steady gain", 0.1360, 1e-4),
]
VERDICTS = {
    **dict.fromkeys(("Y-36", "Y-38"), "R"),
    **dict.fromkeys(("Y-10", "Y-12", "Y-37", "Y-39"), "RC"),
    **dict.fromkeys(("Y-11", "Y-13", "Y-14", "Y-15"), "N"),
}


@pytest.mark.parametrize(("name", "figure", "value", "unit"), EXPECTED)
def test_figures_are_the_known_ones(rows: dict[str, Row], name: str, figure: str, value: float, unit: float) -> None:
    assert rows[name][figure] == pytest.approx(value, abs=unit * 0.6)


def test_verdicts_and_completeness(rows: dict[str, Row]) -> None:
    assert {name: str(r.verdict) for name, r in rows.items()} == VERDICTS
    assert all(r.why.startswith("Rule") and r.published.where for r in rows.values())
    assert [r.document()["id"] for r in rows.values()] == list(rows)


def test_every_row_named_in_either_audit_is_in_one() -> None:
    numbered = sorted([*(f"Y-{n}" for n in range(1, 42)), "Y-9b"])
    assert sorted([*recomputed.ids(optimal=False), *ROWS, *RECORDED]) == numbered == sorted(PRINTED)
    assert all(PRINTED[name].computed for name in PRINTED)


# Oracles


def planar() -> tuple[np.ndarray, np.ndarray]:
    A, b, c = np.zeros((9, 9)), 13.2547, 117.15
    A[:3, 6:] = A[3:6, :3] = np.eye(3)
    return A, np.vstack([np.zeros((6, 3)), [[0, 0, b], [b, b, 0], [-c, c, 0]]])


def sampled(A: np.ndarray, B: np.ndarray, Q: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return the held model and the cost over a period by Gauss quadrature of the flow."""
    n, m = B.shape
    F = np.block([[A, B], [np.zeros((m, n + m))]])
    nodes, weights = np.polynomial.legendre.leggauss(12)
    flows = [scipy.linalg.expm(F * T / 2 * (v + 1)) for v in nodes]
    W = T / 2 * sum(w * M.T @ scipy.linalg.block_diag(Q, np.eye(m)) @ M for w, M in zip(weights, flows, strict=True))
    M = scipy.linalg.expm(F * T)
    return M[:n, :n], M[:n, n:], W[:n, :n], W[n:, n:], W[:n, n:]


def test_the_gains_are_those_of_scipys_riccati_solution(rows: dict[str, Row]) -> None:
    A, B, Q, R, N = sampled(*planar(), Q49)
    X = scipy.linalg.solve_discrete_are(A, B, Q, R, s=N)
    K = np.linalg.solve(R + B.T @ X @ B, B.T @ X @ A + N.T)
    K_recomputed = gains.matrix({n: rows["Y-10"][f"gain of {n}"] for n in STATES})
    np.testing.assert_allclose(K_recomputed, K, rtol=1e-6, atol=1e-6 * np.abs(K).max())


def test_the_gain_matrix_has_the_printed_pattern() -> None:
    K = gains.matrix(dict(zip(STATES, K49, strict=True)))
    assert K[0].tolist() == [0, 507.24, -472.64, 0, 19975, -41394, 0, 6.4304, -2.6962]
    assert K[1].tolist() == [0, 507.24, 472.64, 0, 19975, 41394, 0, 6.4304, 2.6962]
    assert K[2].tolist() == [1757.55, 0, 0, 84872, 0, 0, 18.1556, 0, 0]


@pytest.mark.parametrize("axis", ["x", "y", "phi"])
def test_weights_come_back_from_their_gains(axis: str) -> None:
    stage = gains.Stage(13.2547, 117.15, T)
    q = {"x": (3e4, 2e10, 50.0), "y": (700.0, 4e9, 3.0), "phi": (2e3, 1e9, 80.0)}[axis]
    chain, r = gains.axis_model(stage, axis)
    K = -lqr.lqrd(chain, q, [r], T).K[0]
    weights = gains.weights(stage, axis, tuple(K.tolist()))
    np.testing.assert_allclose(list(weights.values()), q, rtol=1e-6)


def test_the_recovered_weights_are_near_the_round_ones(rows: dict[str, Row]) -> None:
    """Five digits of a gain leave up to 3 % of a weight that matters little."""
    weights = [rows["Y-10"][f"weight on {n} from the printed gains"] for n in STATES]
    np.testing.assert_allclose(weights, np.diag(Q49), rtol=0.03)


def test_h_is_its_closed_form(rows: dict[str, Row]) -> None:
    """In the direction (1, 1, 1) 2 s + 3 psi = c s^2 / theta with c = T^2 + T^4/4; across it 2 s = c s^2 / theta."""
    c, theta = T**2 + T**4 / 4, 5e-5
    along = (1 + np.sqrt(1 + 3 * c)) * theta / c
    across = 2 * theta / c
    diagonal, other = (along + 2 * across) / 3, (along - across) / 3
    assert rows["Y-12"]["H, own position"] == pytest.approx(diagonal * T / theta, rel=1e-9)
    assert rows["Y-12"]["H, another position"] == pytest.approx(other * T / theta, rel=1e-6)
    assert rows["Y-12"]["greatest |z| of A22 - H A12"] == pytest.approx(np.sqrt(1 + 3 * c), rel=1e-10)


@pytest.mark.parametrize(("name", "q"), [("Y-13", 100.0), ("Y-14", 1e5)])
@pytest.mark.parametrize(("case", "rate"), [("800 Hz", 800), ("1 kHz", 1000)])
def test_the_bandwidth_is_that_of_scipys_filter(
    rows: dict[str, Row], name: str, q: float, case: str, rate: int
) -> None:
    h = 1 / rate
    A, G = np.array([[1, h, h * h / 2], [0, 1, h], [0, 0, 1]]), np.array([[h**3 / 6], [h * h / 2], [h]])
    scale = np.diag([1, h, h * h])  # so that all three are lengths
    A, G, C = scale @ A @ np.linalg.inv(scale), 1e5 * scale @ G, np.eye(1, 3)
    P = scipy.linalg.solve_discrete_are(A.T, C.T, q * G @ G.T, [[1e10 * 25e-10]])
    M = P @ C.T / (P[0, 0] + 25)
    numerator, denominator = scipy.signal.ss2tf(A - A @ M @ C, A @ M, C - C @ M @ C, C @ M)

    def excess(f: float) -> float:
        z = np.exp(2j * np.pi * f * h)
        return abs(np.polyval(numerator.ravel(), z) / np.polyval(denominator, z)) ** 2 - 0.5

    assert rows[name][f"bandwidth at {case}"] == pytest.approx(brentq(excess, 5, 0.4 * rate), rel=1e-6)
    needed = next(f for f in rows[name].recomputed if f.name.startswith("deviation"))
    bandwidth = PRINTED[name]["bandwidth"].value
    better = kalman.discrete(filtering.model("x", Discrete(1e-3)), [q], [needed.value**2], ("jerk",))
    assert kalman_filter.half_power(better.current()) == pytest.approx(bandwidth, rel=1e-6)


def test_simulated_noise_is_let_through_as_the_row_says(rows: dict[str, Row]) -> None:
    form = kalman_filter.steady(100.0, T, 5e-5).current()
    y, x, left = np.random.default_rng(3).normal(size=60_000), np.zeros(3), []
    for value in y:
        left.append(form.C[0] @ x + form.D[0, 0] * value)
        x = form.A @ x + form.B[:, 0] * value
    assert np.std(left[500:]) == pytest.approx(rows["Y-15"]["noise left in x and y at 800 Hz"], rel=0.03)


def test_the_recursion_is_that_of_covariances_written_out(rows: dict[str, Row]) -> None:
    axis = filtering.model("x", Discrete(T))
    A, C, Gamma, R = axis.A, axis.C, axis.B, 25e-10
    P, history = 1e8 * np.eye(3), []
    for _ in range(200):
        K = P @ C.T / (P[0, 0] + R)
        history.append(K[0, 0])
        rest = np.eye(3) - K @ C
        P = A @ (rest @ P @ rest.T + R * K @ K.T) @ A.T + 100 * Gamma @ Gamma.T
    np.testing.assert_allclose(kalman_filter.position_gains(100.0, T, 5e-5, 1e8, True)[:200], history, rtol=1e-3)
    settled = 1 + int(np.flatnonzero(np.abs(np.array(history) / rows["Y-39"]["steady gain"] - 1) > 0.01)[-1])
    assert rows["Y-39"]["time until the gain is within 1 % of it, P updated"] == pytest.approx(1e3 * settled * T)


# What moves what


@pytest.fixture(scope="module")
def readers() -> dict[str, set[str]]:
    return recomputed.readers(ROWS)


@pytest.mark.usefixtures("plant_built_once")
@pytest.mark.parametrize("source", NUMBERS)
def test_a_printed_number_moves_the_rows_that_depend_on_it_and_no_other(
    rows: dict[str, Row], readers: dict[str, set[str]], source: str
) -> None:
    after = assert_a_number_moves_what_depends_on_it(rows, readers, source)
    assert after or source.partition(".")[0] not in ROWS  # no number is printed for nothing


# Verdicts fall and rise

WITH_POINTS = {"Y-10.d": "18.1556", "Y-10.f": "6.4304", "Y-10.v": "2.6962"}
OTHER_PRINTS = [
    ("Y-10", {"Y-10.phi": "474.64"}, "N"),
    ("Y-10", {"Y-7.rate_lqg": "1000"}, "N"),
    ("Y-10", {"Y-5.per_ampere": "13.3547"}, "N"),
    (
        "Y-11",
        {f"Y-11.q_{n}": f"{q:g}" for n, q in zip(STATES, np.diag(Q49), strict=True)},
        "R",
    ),
    ("Y-12", {"Y-12.own": "142.42", "Y-12.other": "0.0000"}, "R"),
    ("Y-12", {"Y-12.own": "1700"}, "N"),
    ("Y-12", {"Y-7.rate_lqg": "1000"}, "N"),
    ("Y-13", {"Y-13.bandwidth": "26"}, "R"),
    ("Y-13", {"Y-13.deviation": "6.2322e-6"}, "R"),
    ("Y-14", {"Y-14.bandwidth": "76"}, "R"),
    ("Y-15", {"Y-15.reduction": "70"}, "R"),
    ("Y-38", {"Y-38.after": "2e-5"}, "N"),
    ("Y-38", {"Y-13.q": "10000"}, "N"),
    ("Y-39", {"Y-13.q": "1e9"}, "N"),
    ("Y-39", {"Y-13.q": "1e-12", "Y-39.p0": "1e-20"}, "R"),
]
STRUCTURE = {"Y-36", "Y-37"}  # statements that no printed number enters: see the planted defects


@pytest.mark.parametrize(("name", "numbers", "verdict"), OTHER_PRINTS)
def test_a_verdict_follows_the_print(name: str, numbers: dict[str, str], verdict: str) -> None:
    assert VERDICTS[name] != verdict == one(name, published=with_other_digits(numbers)).verdict


def test_every_verdict_can_change() -> None:
    assert {name for name, *_ in OTHER_PRINTS} | STRUCTURE == set(ROWS)


def test_the_gains_reproduce_as_printed_where_no_point_is_lost() -> None:
    def kept(published: dict[str, Published]) -> dict[str, Published]:
        row = published["Y-10"]
        return published | {"Y-10": replace(row, computed={**row.computed, "lost": Formula("1")})}

    assert one("Y-10", published=kept(with_other_digits(WITH_POINTS))).verdict == "R"
    assert one("Y-10", published=kept(PRINTED)).verdict == "N"


# Planted defects

Patch = Callable[[pytest.MonkeyPatch], None]


def _sign_in_33(patch: pytest.MonkeyPatch) -> None:
    right = gains.loop_33

    def wrong(held: object, K: np.ndarray, L: np.ndarray) -> np.ndarray:
        matrix = right(held, K, L)  # type: ignore[arg-type]
        matrix[9:, :6] *= -1
        return matrix

    patch.setattr(gains, "loop_33", wrong)


def _unsampled_cost(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(gains, "gains", gains.gains.__wrapped__)
    patch.setattr(lqr, "lqrd", lambda model, Q, R, T: lqr.lqr(model, Q, R))


def _no_update(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(kalman_filter, "position_gains", kalman_filter.position_gains.__wrapped__)
    patch.setattr(square_root_kalman, "update", lambda now, *_: now)


@pytest.mark.parametrize(
    ("name", "defect", "verdict"),
    [
        ("Y-36", _sign_in_33, "N"),
        ("Y-10", _unsampled_cost, "N"),
        ("Y-39", _no_update, "N"),
    ],
)
def test_a_planted_defect_costs_the_verdict(
    name: str, defect: Patch, verdict: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    defect(monkeypatch)
    assert one(name).verdict == verdict != VERDICTS[name]


# The rows of records


def test_recorded_noise() -> None:
    assert recorded("Y-40", noise_at_rest=lambda *_: {"x": 10e-6, "y": 10.5e-6}).verdict == "R"
    assert recorded("Y-40", noise_at_rest=lambda *_: {"x": 6e-6, "y": 6e-6}).verdict == "N"


@pytest.mark.parametrize("seed", range(6))
def test_a_line_in_the_spectrum_is_found_and_noise_has_none(seed: int) -> None:
    rng, time = np.random.default_rng(seed), np.arange(8192) * T
    low_passed = scipy.signal.lfilter([0.2], [1, -0.8], rng.normal(size=len(time))) * 1e-5
    quiet = recorded("Y-41", of_step=lambda _: prominent_line(low_passed, T))
    assert quiet.verdict == "R" and quiet["above its neighbours"] < 6
    hum = low_passed + 0.5e-5 * np.sin(2 * np.pi * 60 * time)
    loud = recorded("Y-41", of_step=lambda _: prominent_line(hum, T))
    assert loud.verdict == "N" and loud["most prominent line"] == pytest.approx(60, abs=1)
