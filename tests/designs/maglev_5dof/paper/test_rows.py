"""The audit of the maglev paper: figures against independent ones, verdicts that can fall, and what moves what."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import solve_continuous_are

from designs.maglev_5dof import control
from designs.maglev_5dof.design import DESIGN
from designs.maglev_5dof.paper import rows as paper
from designs.maglev_5dof.paper.closed_loop_runs import SPRING_STIFFNESSES, AuditSetup
from models import maglev_stage
from synth.analyse import operating_points
from synth.report import audit
from synth.report.audit import Formula, Published, Row

pytestmark = pytest.mark.whole

PLANT = maglev_stage.plant()
PRINTS = paper.published_rows()
NAMES = tuple(p.name for p in PLANT.parameters)
TABLE_I = tuple(p.name for p in PLANT.parameters if p.source.startswith("Table I"))
TRACKING = ("F-14", "F-15", "F-16")
SHORT, COARSE = 0.9, 3  # s of tracking, cells of the field


@pytest.fixture(scope="module")
def rows() -> dict[str, Row]:
    return {r.id: r for r in paper.rows(DESIGN)}


# Worked out apart from this code, to the digits given: (row, figure, value, one unit of the last digit).
EXPECTED = [
    ("F-1", "gap of balance without current", 28.704, 1e-3),
    ("F-1", "i_d at 25 mm", 0.74174, 1e-5),
    ("F-1", "i_d at 25 mm, csch^2", 0.67864, 1e-5),
    ("F-3", "F_H, p = 3", 24.976, 1e-3),
    ("F-3", "F_H, p = 6", 12.488, 1e-3),
    ("F-3", "F_H, finite differences", 12.858, 0.03),
    ("F-4", "cogging at 20 mm", 0.0771 * 2 / np.sqrt(3), 1e-3),
    ("F-4", "cogging at 25 mm", 0.0136 * 2 / np.sqrt(3), 3e-4),
    ("F-5", "a2 at 20 mm", 0.2305, 1e-4),
    ("F-5", "a3 at 20 mm", 5.7708, 1e-4),
    ("F-5", "a7 at 20 mm", 1.1545, 1e-4),
    ("F-5", "a6 at 20 mm", 0.27736, 1e-5),
    ("F-5b", "a6 at 20 mm", 0.068848, 1e-6),
    ("F-5b", "a8 at 20 mm", 0.04312, 1e-5),
    ("F-5b", "a9 at 20 mm", 0.037865, 1e-6),
    ("F-5b", "a5 at 20 mm", 0.030983, 1e-6),
    ("F-5b", "a2 at 30 mm", 0.10141, 1e-5),
    ("F-5b", "a6 at 30 mm", 0.021986, 1e-6),
    ("F-6", "a1 at 20 mm", -17.501, 1e-3),
    ("F-6", "a1 at 25 mm", -5.2261, 1e-4),
    ("F-6", "a1 at 30 mm", 1.3445, 1e-4),
    ("F-7", "least |det|", 134.09, 1e-2),
    ("F-7", "greatest condition number", 3.6821, 1e-4),
    ("F-11", "overshoot, linear", 13.885, 1e-3),
    ("F-11", "t_s, linear", 1.851, 1e-3),
    ("F-11", "t_enc, linear", 3.276, 1e-3),
    ("F-11", "overshoot, nonlinear, 22 to 29 mm", 14.013, 1e-3),
    ("F-12", "overshoot, linear", 14.804, 1e-3),
    ("F-12", "t_s, linear", 1.898, 1e-3),
    ("F-13", "overshoot, linear", 24.066, 1e-3),
    ("F-13", "t_s, linear", 1.724, 1e-3),
    ("F-14", "y, encoders, printed law", 53.3, 0.5),
    ("F-15", "y, ideal, springs absent", 37.88, 0.1),
    ("F-15", "theta, ideal, springs absent", 208.5, 4.0),
    ("F-15", "y, encoders, printed law, springs known", 44.3, 0.4),
    ("F-15", "theta, encoders, printed law, springs unknown", 16.8, 0.3),
    ("F-15", "time at which the gap leaves 18 .. 31 mm, ideal, coth^2, springs absent", 0.295, 3e-3),
    ("F-16", "x, ideal", 0.0, 5e-3),
    ("F-16", "z, ideal", 0.0, 5e-3),
    ("F-16", "x, encoders, printed law", 1.0, 0.3),
    ("F-16", "x, encoders, friction, cogging", 78.7, 0.8),
    ("F-16", "z, encoders, friction, cogging", 70.0, 0.7),
    ("F-20", "left of a constant", 0.0, 1e-6),
    ("F-20", "left of omega0", 0.0, 1e-6),
    ("F-20", "y, 30 N of 2 omega0", 2.4, 0.1),
    ("F-20", "x, 30 N of 2 omega0", 6.4, 0.2),  # of the full plant with encoders
    ("F-20", "theta, 3 N m of 2 omega0", 2.5, 0.4),  # the same, with the guide spring
    ("F-21", "x, change in print", -0.4, 0.1),
    ("F-21", "z, change in print", 12.6, 0.1),
    ("F-22", "i_d at 33 mm", -0.68853, 1e-5),
]
VERDICTS = {
    **dict.fromkeys(("F-1", "F-3", "F-5b"), "RC"),
    **dict.fromkeys(("F-4", "F-7", "F-8", "F-9", "F-10", "F-11", "F-13", "F-17", "F-18", "F-19", "F-20"), "R"),
    **dict.fromkeys(("F-2", "F-5", "F-6", "F-12", "F-14", "F-15", "F-16", "F-21", "F-22"), "N"),
}


@pytest.mark.parametrize(("name", "figure", "value", "unit"), EXPECTED)
def test_figures_are_the_known_ones(rows: dict[str, Row], name: str, figure: str, value: float, unit: float) -> None:
    assert rows[name][figure] == pytest.approx(value, abs=unit * 0.6)


def test_verdicts_and_completeness(rows: dict[str, Row]) -> None:
    assert {name: str(r.verdict) for name, r in rows.items()} == VERDICTS
    assert list(rows) == list(PRINTS)
    assert all(r.why.startswith("Rule") and r.published.where for r in rows.values())
    assert [r.document()["id"] for r in rows.values()] == list(rows)


def test_rows_come_one_by_one() -> None:
    assert next(iter(paper.rows(DESIGN))).id == "F-1"


def test_holding_currents_are_those_of_trim(rows: dict[str, Row]) -> None:
    for lv3, figure in (("coth2", "i_d at 25 mm"), ("csch2", "i_d at 25 mm, csch^2")):
        point = operating_points.trim(maglev_stage.plant(lv3), {"y": 0.025}, [f"i_d{j}" for j in range(1, 5)])
        assert rows["F-1"][figure] == pytest.approx(point["i_d1"], rel=1e-9)


@pytest.mark.parametrize(("row", "axis"), [("F-8", "y"), ("F-9", "x"), ("F-9", "z"), ("F-10", "theta")])
def test_poles_are_those_of_an_independent_riccati_solution(rows: dict[str, Row], row: str, axis: str) -> None:
    w2 = (1.5 * np.pi) ** 2
    A = np.array([[0, 1, 0, 0, 0], [0] * 5, [0, 0, 0, 1, 0], [0, 0, 0, 0, 1], [1, 0, 0, -w2, 0]], dtype=float)
    B = np.array([[0.0], [1], [0], [0], [0]])
    Q = np.diag(next(a.weights for a in control.AXES if a.name == axis))
    expected = np.linalg.eigvals(A - B @ B.T @ solve_continuous_are(A, B, Q, np.eye(1)))
    values = {f.name: f.value for f in rows[row].recomputed}
    pairs = [complex(values[f"{n} pair, real"], values[f"{n} pair, imaginary"]) for n in ("first", "second")]
    mine = np.array([values["fast"], *pairs, *np.conj(pairs)])
    assert np.abs(np.sort_complex(mine) - np.sort_complex(expected)).max() < 1e-6


def test_the_nonlinear_step_is_that_of_a_loop_written_out_by_hand(rows: dict[str, Row]) -> None:
    """One motor's force four times, in NumPy; only the gain comes from the project."""
    v = {p.name: p.value for p in PLANT.parameters}
    k = np.pi / v["tau"]
    magnets, K = v["L_A"] * v["p_m"], np.asarray(control.gain(control.AXES[0]).K).ravel()

    def terms(g: float) -> tuple[float, float, float]:
        half, s, h = v["b0"] / 2 / g, v["h_m"] + g, k * (v["h_m"] + g)
        K_c = v["t1"] / (v["t1"] - g * 4 / np.pi * (half * np.arctan(half) - 0.5 * np.log(1 + half**2)))
        lam = 1 - v["b0"] ** 2 / (4 * v["t1"] * (s + v["b0"] / 2))
        B = 4 / np.pi * v["mu0"] * v["H_c"] * np.sin(k * v["tau_p"] / 2) * np.sinh(k * v["h_m"]) / np.sinh(h)
        n = magnets * v["W"] / 6
        F0 = magnets * v["tau"] / 4 / v["mu0"] * lam * B**2
        linear = 3 * np.sqrt(2) * n * lam * B / np.tanh(h) / K_c
        return F0, linear, 18 * n * v["W"] / 6 * v["mu0"] / v["tau"] * lam / np.sinh(h) ** 2 / K_c**2

    def slope(t: float, q: np.ndarray) -> np.ndarray:
        F0, linear, quadratic = terms(q[0])
        e = q[0] - 0.029
        w = K @ [e, q[1], *q[2:]]
        i = (v["M_y"] * (w - v["G"]) / 4 + F0) / linear
        lift = v["G"] + 4 / v["M_y"] * (-F0 + linear * i - quadratic * i**2)
        return np.array([q[1], lift, q[3], q[4], e - (1.5 * np.pi) ** 2 * q[3]])

    solution = solve_ivp(slope, (0, 3), [0.022, 0, 0, 0, 0], "Radau", np.arange(3000) * 1e-3, rtol=1e-9, atol=1e-12)
    overshoot = 100 * (solution.y[0].max() - 0.029) / 0.007
    assert rows["F-11"]["overshoot, nonlinear, 22 to 29 mm"] == pytest.approx(overshoot, abs=1e-4)


def setup_with(**changed: float) -> AuditSetup:
    return AuditSetup(DESIGN, PLANT.with_parameters(**changed), SHORT, COARSE)


def row(name: str, on: AuditSetup, printed: Published | None = None) -> Row:
    """Return a row as recomputed with a setup, as printed or with another print of it."""
    published = {**PRINTS, name: printed or PRINTS[name]}
    return audit.recompute(published[name], paper.scope(on, published))


SHARED = setup_with()


@pytest.fixture(scope="module")
def nominal() -> dict[str, Row]:
    return {r.id: r for r in audit.rows(paper.scope(SHARED, PRINTS))}


def differs(before: Row, after: Row) -> bool:
    """Whether a figure changed by more than rounding, or came to exist or ceased to."""
    old, new = (np.array([f.value for f in r.recomputed]) for r in (before, after))
    return not np.allclose(old, new, rtol=1e-7, atol=1e-9, equal_nan=True)


def wrong_dependences(before: dict[str, Row], after: dict[str, Row], parameter: str) -> list[str]:
    """Return the rows that moved without declaring the parameter, or declare it and did not move."""
    return [n for n, r in before.items() if differs(r, after[n]) != (parameter in r.depends)]


def one_figure(name: str, what: str) -> Published:
    """Return a row with the formulas of one of its figures only."""
    computed, needed = PRINTS[name].computed, dict[str, Formula]()
    left = [n for n, f in computed.items() if f.what == what]
    while left:
        formula = computed[n := left.pop()]
        needed[n] = formula
        left += [m for m in formula.identifiers if m in computed and m not in needed]
    return replace(PRINTS[name], computed={n: f for n, f in computed.items() if n in needed})


def moves(before: Row, on: AuditSetup) -> bool:
    """Whether a figure of a row changes: the first that does decides, as each run with encoders takes seconds."""
    parts = (replace(before, recomputed=(f,)) for f in before.recomputed)
    return any(differs(part, row(before.id, on, one_figure(before.id, part.recomputed[0].name))) for part in parts)


@pytest.mark.parametrize("parameter", NAMES)
def test_a_parameter_moves_the_rows_that_depend_on_it_and_no_other(nominal: dict[str, Row], parameter: str) -> None:
    """Every row for Table I and the springs; the tracking rows, which take longest, not for the other constants."""
    rows = [n for n in nominal if n not in TRACKING or parameter in (*TABLE_I, *SPRING_STIFFNESSES)]
    changed = setup_with(**{parameter: PLANT.parameter(parameter).value * 1.01})
    one_by_one = [n for n in rows if n in TRACKING and parameter in nominal[n].depends]
    assert not [n for n in one_by_one if not moves(nominal[n], changed)]
    whole = [n for n in rows if n not in one_by_one]
    assert not wrong_dependences({n: nominal[n] for n in whole}, {n: row(n, changed) for n in whole}, parameter)


def test_figures_one_by_one_are_those_of_the_row(nominal: dict[str, Row]) -> None:
    for name in TRACKING:
        for f in nominal[name].recomputed:
            alone = row(name, SHARED, one_figure(name, f.name))
            assert alone.recomputed == (f,), f
        assert not moves(nominal[name], SHARED)


def test_every_parameter_of_table_i_is_perturbed_and_all_but_one_matter(nominal: dict[str, Row]) -> None:
    used = {n for r in nominal.values() for n in r.depends}
    assert set(TABLE_I) - used == {"motor_separation"}  # printed, in no equation
    assert {n for n in used if not n.startswith("F-")} <= set(NAMES)


def one(name: str, **changed: float) -> Row:
    return row(name, setup_with(**changed))


@pytest.mark.parametrize(
    ("name", "changed", "verdict"),
    [
        ("F-1", {"M_y": 100.0}, "N"),  # a platen too heavy to hold
        ("F-3", {"mu_rec": 3.0}, "N"),  # magnets that are no longer charge sheets
        ("F-4", {"tau": 0.12, "t1": 0.04, "b0": 0.03, "w_c": 0.12}, "N"),  # slots wide beside the gap
        ("F-5b", {"r": 0.1}, "N"),  # an arm so short that the angles have little effect
        ("F-6", {"H_c": 4e6}, "R"),  # magnets that attract at 10^2 times the acceleration
        ("F-7", {"b0": 0.06}, "N"),  # slots so wide that no tooth is left: the Carter coefficient runs through a pole
        ("F-17", {"r": 0.2}, "N"),
        ("F-18", {"r": 0.5}, "N"),  # the tilt no longer fits between the stops
    ],
)
def test_a_verdict_falls_with_the_physics(name: str, changed: dict[str, float], verdict: str) -> None:
    assert one(name).verdict != verdict
    assert one(name, **changed).verdict == verdict


ABSENT = "springs absent"


@pytest.mark.parametrize(
    ("name", "figures", "verdict"),
    [
        ("F-14", {"y": "y, ideal"}, "RC"),
        ("F-14", {"y": "y, ideal, coth^2"}, "R"),
        ("F-14", {"y": "y, encoders, printed law"}, "RC"),
        ("F-15", {"y": f"y, ideal, {ABSENT}", "theta": f"theta, ideal, {ABSENT}"}, "RC"),
        ("F-15", {"y": f"y, ideal, {ABSENT}"}, "N"),
        ("F-16", {"x": "x, encoders, printed law", "z": "z, encoders, printed law"}, "R"),
        ("F-16", {"x": "x, encoders, friction, cogging", "z": "z, encoders, friction, cogging"}, "N"),
    ],
)
def test_a_verdict_follows_the_print(nominal: dict[str, Row], name: str, figures: dict[str, str], verdict: str) -> None:
    """Had the paper printed the recomputed figures, the rule would say so; fitted ones count for nothing."""
    was = PRINTS[name]
    numbers = {n: replace(was[n], text=f"{nominal[name][figure]:.4g}") for n, figure in figures.items()}
    printed = replace(was, numbers={**was.numbers, **numbers})
    assert row(name, SHARED, printed).verdict == verdict


def test_the_rules_for_steps_follow_the_print(rows: dict[str, Row]) -> None:
    was = PRINTS["F-12"]
    numbers = {"overshoot": replace(was["overshoot"], text="14"), "t_s_low": replace(was["t_s_low"], text="1")}
    assert row("F-12", SHARED, replace(was, numbers={**was.numbers, **numbers})).verdict == "R"
    assert rows["F-12"].verdict == "N"
