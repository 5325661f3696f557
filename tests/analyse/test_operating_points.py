"""Trim against closed forms, values for the stage, and plants without an equilibrium."""

from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest
from scipy.optimize import minimize

from models import maglev_stage
from synth import plant
from synth.analyse.operating_points import OperatingPoint, trim, trim_with_free_states
from synth.errors import ModelError, SignalError
from synth.plant import Plant, Symbols
from synth.signals import Parameter, Signal

DIRECT = ("i_d1", "i_d2", "i_d3", "i_d4")
HELD = {
    "csch2": {25: 0.67864},
    "coth2": {18: 2.6183, 20: 2.0104, 25: 0.74174, 30: -0.22550, 31: -0.38864, 33: -0.68853},
}


def toy(derivatives: Callable[[Symbols, Symbols], dict[str, ca.SX]], inputs: int = 2) -> Plant:
    states = (Signal("q", "m", -1, 1), Signal("v", "m/s", -1, 1))
    forces = tuple(Signal(f"F{j}", "N", -10, 10) for j in range(1, inputs + 1))
    m = Parameter("m", 2.0, "kg", 0.0, "test")
    return plant.build("toy", states, forces, (), (m,), lambda x, u, p: (derivatives(x, u), {}))


@pytest.mark.parametrize(("lv3", "mm"), [(lv3, mm) for lv3, row in HELD.items() for mm in row])
def test_holding_currents(lv3: str, mm: int) -> None:
    point = trim(maglev_stage.plant(lv3), {"y": mm * 1e-3}, DIRECT)
    assert [point[n] for n in DIRECT] == pytest.approx([HELD[lv3][mm]] * 4, rel=2e-5)
    assert point.residual < 1e-9
    assert point.outside == (("y",) if mm > 31 else ())


def test_zero_current_balance() -> None:
    point = trim(maglev_stage.plant(), {}, ["y"])
    assert point["y"] == pytest.approx(28.704e-3, abs=5e-7)


def test_redundant_currents_are_the_smallest() -> None:
    stage = maglev_stage.plant()
    held = {"y": 0.025, "theta": 0.01, "phi": 0.001}
    point = trim(stage, held, DIRECT)
    assert point.residual < 1e-9

    def balance(i: np.ndarray) -> np.ndarray:
        return np.asarray(stage.f(point.x, [*i, 0.0, 0.0], stage.values)).ravel()[[1, 7, 9]]

    other = minimize(
        lambda i: i @ i,
        np.ones(4),
        method="SLSQP",
        constraints={"type": "eq", "fun": balance},
        options={"ftol": 1e-14, "maxiter": 200},
    )
    assert other.success
    assert point.u[:4] == pytest.approx(other.x, abs=1e-5)
    shifted = other.x + 1e-3 * np.array([1, -1, 1, -1])  # the redundant direction, to first order
    assert shifted @ shifted > point.u[:4] @ point.u[:4]


def test_of_two_roots_the_one_nearer_zero_is_taken() -> None:
    def law(x: Symbols, u: Symbols) -> dict[str, ca.SX]:
        return {"q": x["v"], "v": (u["F1"] - 1) * (u["F1"] + 4)}

    assert trim(toy(law, 1), {}, ["F1"])["F1"] == pytest.approx(1.0, rel=1e-12)


def test_a_purely_quadratic_input_is_found_from_zero() -> None:
    def law(x: Symbols, u: Symbols) -> dict[str, ca.SX]:
        return {"q": x["v"], "v": u["F1"] ** 2 - 4}

    assert abs(trim(toy(law, 1), {}, ["F1"])["F1"]) == pytest.approx(2.0, rel=1e-12)


def test_ties_are_listed_and_the_larger_root_is_taken() -> None:
    def law(x: Symbols, u: Symbols) -> dict[str, ca.SX]:
        return {"q": u["F1"] * u["F2"], "v": u["F1"] ** 2 + u["F2"] ** 2 - 4}

    point = trim(toy(law), {}, ["F1", "F2"])
    assert (point["F1"], point["F2"]) == pytest.approx((2.0, 0.0), abs=1e-12)
    ties = [(tie["F1"], tie["F2"]) for tie in point.ties]
    assert ties == [pytest.approx(root, abs=1e-12) for root in ((0.0, 2.0), (0.0, -2.0), (-2.0, 0.0))]
    assert not trim(maglev_stage.plant("coth2"), {"y": 0.018}, DIRECT).ties


@pytest.mark.parametrize("seed", range(4))
def test_rounding_does_not_choose_the_root(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: a least-squares solver with random errors in the last digits."""
    rng, exact = np.random.default_rng(seed), np.linalg.lstsq

    def perturbed_lstsq(*arguments: object, **options: object) -> tuple[object, ...]:
        solution, *rest = exact(*arguments, **options)
        return solution * (1 + 1e-13 * rng.normal(size=solution.shape)), *rest

    monkeypatch.setattr(np.linalg, "lstsq", perturbed_lstsq)
    point = trim(maglev_stage.plant("coth2"), {"y": 0.018}, DIRECT)
    assert [point[n] for n in DIRECT] == pytest.approx([HELD["coth2"][18]] * 4, rel=2e-5)


def tank(low: float = 0.0, high: float = 2.0) -> Plant:
    """A tank with inflow q and gravity outflow: h' = q - a sqrt(h), whose slope is infinite at h = 0."""
    h, q = Signal("h", "m", low, high), Signal("q", "m/s", -1.0, 1.0)
    a = Parameter("a", 0.5, "1", 0.0, "test")
    return plant.build("tank", (h,), (q,), (), (a,), lambda x, u, p: ({"h": u["q"] - p["a"] * ca.sqrt(x["h"])}, {}))


@pytest.mark.parametrize(("low", "high"), [(0.0, 2.0), (-2.0, 2.0), (-50.0, 1.0), (0.5, 1.5)])
@pytest.mark.parametrize("q", [1e-3, 0.1, 0.3, 0.7])
def test_a_slope_that_is_infinite_at_an_end_of_the_range(low: float, high: float, q: float) -> None:
    point = trim(tank(low, high), {"q": q}, ["h"])
    assert point["h"] == pytest.approx((q / 0.5) ** 2, rel=1e-8, abs=1e-12)
    assert point.outside == (() if low <= point["h"] <= high else ("h",))


@pytest.mark.parametrize(
    "law",
    [
        lambda x, F: ca.log(x) + F,
        lambda x, F: 1 / x - F,
        lambda x, F: ca.sqrt(x - 0.3) + F,
        lambda x, F: ca.sqrt(ca.sqrt(x)) - 2 - F**2,
        lambda x, F: ca.acos(x) - 4 + 0 * F,
        lambda x, F: ca.exp(700 * x) * ca.exp(700 * F),
        lambda x, F: ca.fabs(x) - ca.if_else(F > 0, 1 / F, ca.log(F)),
        lambda x, F: 1e300 * (x - 0.25) + 1e280 * F,
        lambda x, F: 1e-300 * (x - 0.25) ** 3 + F,
        lambda x, F: 0 * x + 0 * F + 1,
        lambda x, F: ca.sqrt(-1 - x**2) + F,
    ],
)
@pytest.mark.parametrize("free", [["q"], ["F1"], ["q", "F1"]])
def test_awkward_plants_give_a_trim_or_an_equation(law: Callable[[ca.SX, ca.SX], ca.SX], free: list[str]) -> None:
    both = toy(lambda x, u: {"q": law(x["q"], u["F1"]), "v": x["v"]}, 1)
    try:
        assert np.isfinite(trim(both, {}, free).residual)
    except ModelError as error:
        assert "d(q)/dt" in str(error)


def test_smallest_inputs_by_their_ranges() -> None:
    def law(x: Symbols, u: Symbols) -> dict[str, ca.SX]:
        return {"q": x["v"], "v": u["F1"] + 2 * u["F2"] - 5}

    point = trim(toy(law), {}, ["F1", "F2"])
    assert point.u == pytest.approx([1.0, 2.0], rel=1e-12)


def test_all_motors_attract_so_a_steep_attitude_has_no_trim_as_printed() -> None:
    # With coth^2 the vertical force is a negative square: F_V <= 0. The springs at these angles ask 39.8 N more of
    # motor 3 than of 1 and of motor 2 than of 4, so the four pull at least 79.6 N where 67.7 N balance the weight.
    held = {"y": 0.025, "theta": 0.01, "phi": 0.002}
    with pytest.raises(ModelError, match=r"no trim: d\(vy\)/dt = 0 cannot be met"):
        trim(maglev_stage.plant("coth2"), held, DIRECT)
    assert trim(maglev_stage.plant("csch2"), held, DIRECT).residual < 1e-9


def test_nothing_free_at_an_equilibrium() -> None:
    def law(x: Symbols, u: Symbols) -> dict[str, ca.SX]:
        return {"q": x["v"], "v": u["F1"] - x["q"]}

    point = trim(toy(law, 1), {"q": 0.5, "F1": 0.5}, [])
    assert (point["q"], point.residual) == (0.5, 0.0)
    with pytest.raises(SignalError, match="height"):
        point["height"]


def test_a_point_shows_its_values_by_name() -> None:
    tie = ({"i": 1.0},)
    point = OperatingPoint(np.array([5e-4, 0.0]), np.array([0.25]), np.zeros(0), 0.0, ("x", "vx"), ("i",), ("i",), tie)
    lines = repr(point).splitlines()
    assert lines[:3] == [
        "Operating point, residual 0",
        "outside its range: i",
        "1 other equilibria at the same distance",
    ]
    assert [line.split() for line in lines[4:]] == [
        ["state", "x", "0.0005"],
        ["state", "vx", "0"],
        ["input", "i", "0.25"],
    ]


def on_a_spring(offset: float) -> Plant:
    """A force F on a carriage with a spring of 4 N/m, `offset` m off its centre, turns it on one of 8 N m/rad."""

    def physics(x: Symbols, u: Symbols, p: Symbols) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        turning = offset * u["F"] - p["c"] * x["theta"]
        return {"q": x["v"], "v": u["F"] - 4 * x["q"], "theta": x["w"], "w": turning}, {}

    states = [Signal(name, unit, -1, 1) for name, unit in (("q", "m"), ("v", "m/s"), ("theta", "rad"), ("w", "rad/s"))]
    c = Parameter("c", 8.0, "N m/rad", 0.1, "test")
    return plant.build("carriage", states, [Signal("F", "N", -10, 10)], (), [c], physics)


@pytest.mark.parametrize("offset", [0.0, 0.2])
def test_a_static_force_moves_a_state_that_is_not_held(offset: float) -> None:
    point = trim_with_free_states(on_a_spring(offset), {"q": 0.5}, ["F"])
    assert point["F"] == pytest.approx(2.0) and point["theta"] == pytest.approx(offset * 2 / 8, abs=1e-12)
    assert (point["q"], point["v"], point["w"]) == pytest.approx((0.5, 0, 0), abs=1e-30)


def test_a_division_by_a_parameter_that_is_zero_is_named() -> None:
    def physics(x: Symbols, u: Symbols, p: Symbols) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        return {"q": x["v"], "v": (u["F"] - 1) / p["m"]}, {}

    states = [Signal("q", "m", -1, 1), Signal("v", "m/s", -1, 1)]
    parameters = [Parameter(name, 2.0, "kg", 0.0, "test") for name in ("m", "load")]
    moved = plant.build("mass", states, [Signal("F", "N", -10, 10)], (), parameters, physics)
    assert trim(moved, {}, ["F"])["F"] == pytest.approx(1.0)
    with pytest.raises(ModelError, match=r"division by a parameter that is 0: m$"):
        trim(moved.with_parameters(m=0.0), {}, ["F"])


def test_near_an_equilibrium_its_branch_is_continued_and_elsewhere_searched() -> None:
    square = toy(lambda x, u: {"q": x["v"], "v": u["F1"] ** 2 - 4 - x["q"]}, inputs=1)
    far = trim(square, {"q": 0.0, "F1": -2.0}, [])
    assert trim(square, {"q": 0.0}, ["F1"])["F1"] == pytest.approx(2.0)  # of two ties the larger
    assert trim(square, {"q": 0.5}, ["F1"], far)["F1"] == pytest.approx(-np.sqrt(4.5))
    hidden = toy(lambda x, u: {"q": x["v"], "v": u["F1"] ** 2 * (u["F1"] ** 2 - 9) + 10 - x["q"]}, inputs=1)
    lost = OperatingPoint(np.zeros(2), np.zeros(1), hidden.values, 0.0, ("q", "v"), ("F1",))  # at a maximum of |f|
    assert trim(hidden, {"q": 0.0}, ["F1"], lost).residual < 1e-8
