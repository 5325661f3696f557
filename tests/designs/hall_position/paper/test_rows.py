"""The audit of Kawato and Kim's paper: known figures, verdicts, what moves what, planted defects."""

from dataclasses import replace
from math import sqrt

import numpy as np
import pytest
from scipy.optimize import least_squares

from designs.hall_position.paper import correction, errors, field, rank
from designs.hall_position.paper import rows as paper
from models import concentrated_field, hall_array
from models.hall_stage import PUBLISHED, Stage, grid
from synth.report import audit
from synth.report.audit import Printed, Row

pytestmark = pytest.mark.whole

STAGE = Stage()
PRINTED = paper.published_rows()
IDEAL = Stage(weak=1.43 / sqrt(2))
l, W = 50.8e-3, 2 * np.pi / 50.8e-3


@pytest.fixture(scope="module")
def rows() -> dict[str, Row]:
    return {r.id: r for r in paper.rows()}


# Worked out apart from this code, to the digits given: (row, figure, value, one unit of the last digit).
AMPLITUDES = {
    "0 mm": (0.54351, -0.00467, -0.13718, 0.00202, 0.07624, -0.00781),
    "3 mm": (0.37502, -0.00153, -0.02146, 0.00015, 0.00270, -0.00341),
}
WAVES = ("A_1", "A_3", "A_5", "A_7", "A_9", "wave (2, 1)")
FOUND = "sensors, random starts within"
EXPECTED = [
    ("K-1", "ideal weak remanence", 1.0112, 1e-4),
    ("K-2", "|A_1| at 0 mm", 0.50991, 1e-5),
    ("K-2", "|A_5| at 0 mm", 0.12870, 1e-5),
    ("K-2", "|A_9| at 3 mm", 0.00254, 1e-5),
    ("K-2", "|A_3| at 0 mm", 0.0, 1e-12),
    *(("K-3", f"{n} at {z}", v, 1e-5) for z, all in AMPLITUDES.items() for n, v in zip(WAVES, all, strict=True)),
    ("K-4", "greatest residual", 123.0, 3.0),  # by place and grid
    ("K-4", "alpha", 0.3749, 2e-4),
    ("K-4", "beta", -0.0215, 1e-4),
    ("K-5", "X or Y per mV at the steepest place, one sensor", 2.567, 1e-3),
    ("K-5", "yaw known, least", 1.996, 1e-3),
    ("K-5", "yaw known, largest", 3.595, 1e-3),
    ("K-5", "yaw free, median", 4.22, 1e-2),
    ("K-5", "yaw free, part of the pitch above the print", 11.1, 0.2),
    ("K-5", "at 0.1 V/T, one sensor at the steepest place", 10.27, 1e-2),
    ("K-6", "yaw free, rms", 0.32, 0.02),
    ("K-6", "yaw free, 99 % of the places", 1.3, 0.2),
    ("K-6", "yaw known, largest", 0.305, 0.01),
    ("K-7", "of a step, completed after 3 samples, corrections in each: 1", 48.8, 0.1),
    ("K-7", "of a step, completed after 3 samples, corrections in each: 5", 100 * (1 - 0.8**15), 0.1),
    ("K-7", "corrections in a sample that leave less than 5 %", 5, 1e-9),
    ("K-7", "corner of one correction a sample", 28.4, 0.1),
    ("K-7", "noise that it lets through", 1 / 3, 1e-9),
    ("K-7", f"three {FOUND} 1/4 pitch and 5 degrees, found", 98.2, 2.5),  # three deviations of 400 draws
    ("K-7", f"three {FOUND} 1/16 pitch and 5 degrees, found", 100.0, 0.1),
    ("K-8", "fundamental over that of alternating blocks", sqrt(2), 1e-12),
    ("K-13", "singular points in a pitch, yaw 0 rad", 64, 1e-9),
    ("K-13", "from the nearest of them to (1/8, 3/8) pitch", 0.0, 1e-9),
    ("K-13", "condition number, yaw times 50 mm, least", 1.376, 1e-3),
    ("K-13", "condition number, yaw times 50 mm, median", 4.14, 0.05),
    ("K-14", "three sensors, yaw 0, largest of X", 5.280, 1e-3),
    ("K-14", "three sensors, yaw 0, largest of Y", 5.308, 1e-3),
    ("K-14", "three sensors, yaw 0, largest of yaw", 198.0, 0.1),
    ("K-14", "the same with the 9th harmonic, Y", 4.95, 1e-2),
    ("K-14", "larger of X and Y, yaw 5 degrees", 7.745, 2e-3),
    ("K-14", "larger of X and Y, yaw 15 degrees", 22.82, 2e-2),
    ("K-14", "larger of X and Y, yaw 45 degrees", 119.6, 0.5),
    ("K-15", "largest change of a voltage, turned by 90 degrees about a strong block", 0.0, 1e-9),
]
VERDICTS = {
    **dict.fromkeys([f"K-{n}" for n in (1, 2, 3, 4, 5, 6, 8, 9, 10, 11, 12, 14)], "R"),
    **dict.fromkeys(("K-7", "K-15"), "RC"),
    "K-13": "N",
}


@pytest.mark.parametrize(("name", "figure", "value", "unit"), EXPECTED)
def test_figures_are_the_known_ones(rows: dict[str, Row], name: str, figure: str, value: float, unit: float) -> None:
    assert rows[name][figure] == pytest.approx(value, abs=unit)


def test_verdicts_and_completeness(rows: dict[str, Row]) -> None:
    assert {name: str(r.verdict) for name, r in rows.items()} == VERDICTS
    assert sorted(rows) == sorted(PRINTED)
    assert all(r.why.startswith("Rule") and r.published.where for r in rows.values())
    assert [r.document()["id"] for r in rows.values()] == list(rows)


def recompute(name: str, stage: Stage = STAGE, **numbers: str) -> Row:
    """Return a row of a changed stage or with other numbers in the print."""
    of = PRINTED[name]
    changed = {k: Printed(text, of.numbers[k].unit) for k, text in numbers.items()}
    row = replace(of, numbers={**of.numbers, **changed})
    return audit.recompute(row, paper.scope(stage, {**PRINTED, name: row}))


def compute_with(name: str, **functions: object) -> Row:
    """Return a row that some functions are given in place of those of its name."""
    scope = paper.scope(STAGE, PRINTED)
    return audit.recompute(PRINTED[name], replace(scope, functions={**scope.functions, **functions}))


@pytest.mark.parametrize(
    ("name", "stage", "numbers"),
    [
        ("K-1", Stage(strong=1.2), {}),
        ("K-2", STAGE, {"between": "2"}),
        ("K-3", STAGE, {"second": "3"}),
        ("K-4", Stage(height=1e-3), {}),  # the waves that (2) has not are three times as large
        ("K-4", IDEAL, {}),
        ("K-5", Stage(sensitivity=0.1), {}),
        ("K-6", Stage(height=1e-3), {}),
        ("K-6", STAGE, {"accuracy": "0.2"}),
        ("K-7", STAGE, {"alpha": "0.05"}),
        ("K-8", STAGE, {"factor": "3"}),
        ("K-9", IDEAL, {}),
        ("K-9", STAGE, {"uncalibrated": "5.9"}),
        ("K-10", Stage(sensitivity=0.1), {}),
        ("K-11", Stage(noise=0.1), {}),
        ("K-12", STAGE, {"offset": "0.5"}),
    ],
)
def test_a_defect_changes_the_verdict(name: str, stage: Stage, numbers: dict[str, str]) -> None:
    assert str(recompute(name, stage, **numbers).verdict) == "N"


def test_verdicts_on_layouts_follow_their_figures() -> None:
    assert str(compute_with("K-13", singular_points=lambda *_: np.zeros((0, 2))).verdict) == "R"
    offset = rank.voltage_changes(replace(STAGE.three, c=0.1))  # an offset of all voltages tells quarter turns apart
    assert str(compute_with("K-15", voltage_changes=lambda _: offset).verdict) == "N"
    worse = compute_with("K-14", by_waves=lambda s, of: errors.by_waves(s, of) * 10 ** (len(of.positions) - 2))
    assert str(worse.verdict) == "N"


CHEAP = ("K-1", "K-2", "K-3", "K-4", "K-5", "K-8", "K-12")
CHANGED = {
    "strong": Stage(strong=1.44),
    "weak": Stage(weak=1.11),
    "sensitivity": Stage(sensitivity=0.41),
    "noise": Stage(noise=1.1e-3),
}


@pytest.mark.parametrize("parameter", list(CHANGED))
def test_rows_depend_on_what_they_name(rows: dict[str, Row], parameter: str) -> None:
    for name in CHEAP:
        after = recompute(name, CHANGED[parameter])
        changed = any(
            abs(f.value - g.value) > 1e-9 * abs(f.value) + 1e-9  # an amplitude of nothing is 1e-17 T
            for f, g in zip(rows[name].recomputed, after.recomputed, strict=True)
        )
        assert changed == (parameter in after.depends), name


# Oracles


def test_a_correction_is_the_least_squares_solution_of_the_sensor_model() -> None:
    rng = np.random.default_rng(1)
    q = np.vstack([rng.uniform(0, l, (2, 30)), rng.uniform(-1, 1, 30)])
    read = correction.rotate_voltages(correction.volts(STAGE.three, q), -q[2])
    at = q + 1e-4 * rng.standard_normal(q.shape) * [[1], [1], [30]]
    waves = concentrated_field.waves_from_amplitudes(
        {1: STAGE.three.alpha / 8.4, 5: STAGE.three.beta / 8.4}, 3e-3, concentrated_field.values()
    )
    sensors = hall_array.point_sensors(STAGE.three.positions)
    model = hall_array.planar(sensors, waves).function()
    for known in (False, True):
        steps = correction.correction(STAGE.three, read, at, known)
        for k in range(30):
            volts, H = (v.full() for v in model(at[:, k]))
            e = read[:, :, k].T.ravel() - volts.ravel()
            n = 2 if known else 3
            expected = np.linalg.lstsq(H[:, :n], e, rcond=None)[0]
            np.testing.assert_allclose(steps[:n, k], expected, rtol=1e-6, atol=1e-12)
    end = correction.iterate(STAGE.three, read, at, 1.0, 12)
    np.testing.assert_allclose(end, q, rtol=0, atol=1e-10)


def test_errors_above_blocks_are_those_of_another_solver() -> None:
    """At places of the scan without lost rank nearby, from the voltages themselves."""
    truth, map_of_errors = STAGE.truth, errors.errors(STAGE, False).reshape(2, 40, 40)
    fit = field.fit_above_blocks(STAGE).estimate
    for i, j in ((3, 3), (20, 4), (9, 21)):
        at = [(i + s, j + s) for s in (-15, 15)]
        read = np.array([truth.at(np.array(a), np.array(b)) for a, b in at])

        def residual(q: np.ndarray, read: np.ndarray = read) -> np.ndarray:
            c, s, left = np.cos(q[2]), np.sin(q[2]), []
            for r, (u, v) in zip((-0.375 * l, 0.375 * l), read, strict=True):
                bx, by = (
                    fit["c"] + fit["alpha"] * np.sin(W * p) + fit["beta"] * np.sin(5 * W * p)
                    for p in (q[0] * 1e-3 + c * r - s * r, q[1] * 1e-3 + s * r + c * r)
                )
                left += [u - c * bx - s * by, v + s * bx - c * by]
            return np.array(left)

        place = np.array([i, j]) * l / 40 * 1e3
        q = least_squares(residual, [*place, 0.0], xtol=1e-14, ftol=1e-14, gtol=1e-14).x
        np.testing.assert_allclose(1e3 * map_of_errors[:, i, j], q[:2] - place, rtol=0, atol=2e-5)


def test_motions_are_those_between_two_estimates() -> None:
    """A body that moves by the true motion moves its estimate by the step."""
    step, count = 4e-3, STAGE.truth.count
    off = errors.errors(STAGE, True)[0].reshape(count, count)
    X = l / count * np.arange(-count, 2 * count)
    motions = errors.true_motions(off, l / count, step).reshape(count, count)
    for j in (0, 7, 30):
        seen = X + np.tile(off[:, j], 3)
        for k in (0, 11, 25):
            true = X[count + k] + motions[j, k]
            assert np.interp(true, X, seen) - seen[count + k] == pytest.approx(step, abs=1e-9)


def test_a_table_takes_away_what_is_linear_between_its_places() -> None:
    x, y = np.meshgrid(np.arange(40), np.arange(40), indexing="ij")
    tent = np.minimum(x % 10, 10 - x % 10) * (1.0 + (y % 20 < 10) * (y % 10) + (y % 20 >= 10) * (10 - y % 10))
    assert np.abs(errors.error_after_calibration(tent, 5)).max() < 1e-12
    left = errors.error_after_calibration(tent, 20)
    assert np.abs(left[::20, ::20]).max() == 0 and np.abs(left).max() > 1


def test_a_halbach_array_is_twice_as_strong_as_one_with_gaps() -> None:
    halbach, gaps = concentrated_field.halbach_array(0.7), concentrated_field.array([0.0] * 4, [0.7, 0.0, -0.7, 0.0])
    first, second = (
        float(concentrated_field.amplitude(concentrated_field.waves(a, [(1, 0)], concentrated_field.values())[0], 3e-3))
        for a in (halbach, gaps)
    )
    assert first / second == pytest.approx(2.0, rel=1e-12)


def test_the_stage_is_that_of_the_layouts() -> None:
    assert STAGE.three.positions == tuple((x * l, y * l) for x, y in PUBLISHED)
    assert grid(STAGE.pair, 4).shape == (3, 16) and STAGE.chain.gain == pytest.approx(8.4)
    assert STAGE.pair.alpha == pytest.approx(3.1502, abs=5e-5)
