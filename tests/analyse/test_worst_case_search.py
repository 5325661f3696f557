"""Worst cases against closed forms: at a vertex, on an edge, inside; unstable loops; printed results."""

from collections.abc import Mapping

import casadi as ca
import numpy as np
import pytest

from synth import plant as plants
from synth.analyse import feedback_loop, linearisation, loop, operating_points, stability_margins, worst_case_search
from synth.errors import ModelError, SignalError
from synth.signals import Parameter, Signal
from synth.statespace import StateSpace
from synth.timing import Continuous

KNOWN = "a test"


def parameter(name: str, value: float, tolerance: float, unit: str = "1") -> Parameter:
    return Parameter(name, value, unit, tolerance, KNOWN)


def integrator(k: float, pole: float = 1.0) -> StateSpace:
    """L = k / (s (s + pole))."""
    A, B, C = [[0, 1], [0, -pole]], [[0], [k]], [[1, 0]]
    return StateSpace(A, B, C, [[0]], ("x", "v"), ("u",), ("y",), Continuous())


def phase_margin(k: float, pole: float) -> float:
    """|L| = 1 at w with w^2 (w^2 + pole^2) = k^2; the margin is atan(pole / w)."""
    w2 = (-(pole**2) + np.sqrt(pole**4 + 4 * k**2)) / 2
    return float(np.degrees(np.arctan(pole / np.sqrt(w2))))


def test_the_worst_phase_margin_is_at_the_vertex_of_high_gain_and_slow_pole() -> None:
    parameters = [parameter("k", 5.0, 0.2), parameter("pole", 3.0, 0.1, "1/s")]
    worst_case = worst_case_search.search(
        lambda v: integrator(v["k"], v["pole"]), parameters, worst_case_search.PHASE_MARGIN
    )
    assert worst_case.where == pytest.approx({"k": 6.0, "pole": 2.7})
    assert worst_case.value == pytest.approx(phase_margin(6.0, 2.7), rel=1e-9)
    assert worst_case.points[0].centre == pytest.approx(phase_margin(5.0, 3.0), rel=1e-9)
    assert worst_case.value < worst_case.points[0].centre - 3  # the centre alone, the planted defect, is too optimistic
    text = repr(worst_case)
    assert "with k 6 1, pole 2.7 1/s" in text and "attained, not proved" in text and "worst vertex" in text
    assert f"{worst_case.evaluations} loops" in text


def test_each_figure_is_at_its_worst_where_the_gain_is_highest_or_lowest() -> None:
    """L = k / (s + 1)^3: gain margin 8 / k; the others get worse with k as well."""

    def lags(v: Mapping[str, float]) -> StateSpace:
        A = [[-1, 0, 0], [1, -1, 0], [0, 1, -1]]
        return StateSpace(A, [[v["k"]], [0], [0]], [[0, 0, 1]], [[0]], ("a", "b", "c"), ("u",), ("y",), Continuous())

    k = [parameter("k", 4.0, 0.25)]
    at_most = stability_margins.of_loop(lags({"k": 5.0}))
    expected = {
        worst_case_search.GAIN_MARGIN: 8 / 5,
        worst_case_search.PHASE_MARGIN: at_most.phase_margin,
        worst_case_search.DELAY_MARGIN: at_most.delay_margin,
        worst_case_search.MODULUS_MARGIN: at_most.modulus_margin,
        worst_case_search.PEAK_SENSITIVITY: at_most.peak_sensitivity,
    }
    for figure, value in expected.items():
        worst_case = worst_case_search.search(lags, k, figure)
        assert worst_case.value == pytest.approx(value, rel=1e-6), figure.name
        assert worst_case.where["k"] == pytest.approx(5.0, rel=1e-6)
    # 4 / (s - 1) with the gain k falls to 1 / (4 k)
    magnet = worst_case_search.search(
        lambda v: ([[1.0]], [[1.0]], [[4 * v["k"]]], [[0.0]]),
        [parameter("k", 1.0, 0.5)],
        worst_case_search.GAIN_REDUCTION,
    )
    assert magnet.value == pytest.approx(0.5) and magnet.where["k"] == 0.5


def test_a_loop_that_is_not_stable_has_no_margin() -> None:
    """L = k / (s - 1) is stable above k = 1; its phase margin by the crossing alone would be positive below, too."""

    def magnet(v: Mapping[str, float]) -> object:
        return ([[1.0]], [[1.0]], [[v["k"]]], [[0.0]])

    k = [parameter("k", 1.5, 0.5)]
    assert (
        stability_margins.of_loop(magnet({"k": 2.0})).stable
        and not stability_margins.of_loop(magnet({"k": 0.9})).stable
    )
    for figure, lost in (
        (worst_case_search.PHASE_MARGIN, 0),
        (worst_case_search.GAIN_REDUCTION, 1),
        (worst_case_search.PEAK_SENSITIVITY, np.inf),
    ):
        worst_case = worst_case_search.search(magnet, k, figure)
        assert worst_case.value == lost and worst_case.where["k"] < 1.0


@pytest.mark.parametrize("inside", [(0.3, -0.4), (1.0, 0.25), (-0.85, 0.9)])
def test_a_worst_case_inside_the_box_or_on_its_edge_is_found(inside: tuple[float, float]) -> None:
    parameters = [parameter("a", 2.0, 0.1), parameter("b", -5.0, 0.2)]
    at = {"a": 2.0 * (1 + 0.1 * inside[0]), "b": -5.0 * (1 + 0.2 * inside[1])}

    def bowl(system: object) -> float:
        a, b = (float(v) for v in np.asarray(system[1])[0])
        return (a - at["a"]) ** 2 + 0.3 * (b - at["b"]) ** 2 + 0.1 * (a - at["a"]) * (b - at["b"]) + 7.0

    def pair(v: Mapping[str, float]) -> object:
        return ([[-1.0]], [[v["a"], v["b"]]])

    worst_case = worst_case_search.search(pair, parameters, worst_case_search.Criterion("bowl", "1", bowl))
    assert worst_case.value == pytest.approx(7.0, abs=1e-4) and worst_case.points[0].vertex > worst_case.value
    assert worst_case.where == pytest.approx(at, rel=1e-2)
    hill = worst_case_search.search(
        pair, parameters, worst_case_search.Criterion("hill", "1", lambda s: -bowl(s), largest=True)
    )
    assert hill.value == pytest.approx(-7.0, abs=1e-4)


def test_each_operating_point_has_its_row_and_the_worst_is_reported() -> None:
    points = {"slow": {"pole": 1.0}, "fast": {"pole": 9.0}}
    worst_case = worst_case_search.search(
        lambda v: integrator(v["k"], v["pole"]), [parameter("k", 5.0, 0.2)], worst_case_search.PHASE_MARGIN, points
    )
    assert worst_case.at == "slow" and [p.name for p in worst_case.points] == ["slow", "fast"]
    assert [p.worst for p in worst_case.points] == pytest.approx([phase_margin(6.0, 1.0), phase_margin(6.0, 9.0)])
    assert len(worst_case.sheet().tables[0].rows) == 2
    alone = worst_case_search.search(lambda v: integrator(5.0, v["pole"]), [], worst_case_search.PHASE_MARGIN, points)
    assert alone.evaluations == 2 and alone.value == pytest.approx(phase_margin(5.0, 1.0))


@pytest.mark.slow
def test_a_plants_own_tolerances_are_searched() -> None:
    """A mass on a spring under a sampled PD controller, rebuilt and linearised at each vertex."""
    x, v, f = Signal("x", "m", -1, 1), Signal("v", "m/s", -1, 1), Signal("f", "N", -9, 9)
    parameters = [parameter("m", 2.0, 0.1, "kg"), parameter("c", 100.0, 0.3, "N/m"), parameter("spare", 1.0, 0.0)]

    def physics(x: object, u: object, p: object) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        return {"x": x["v"], "v": (u["f"] - p["c"] * x["x"]) / p["m"]}, {"q": x["x"]}

    mass = plants.build("mass", [x, v], [f], [Signal("q", "m", -1, 1)], parameters, physics)
    K = ([[0.0]], [[1.0]], [[-2e4]], [[2.4e4]], 1e-3)  # 4e3 e + 2e4 (e - last e)

    def open_loop(values: Mapping[str, float]) -> StateSpace:
        changed = mass.with_parameters(**values)
        model = linearisation.linearise(changed, operating_points.trim(changed, {"x": 0.0}, ["f"]))
        return feedback_loop.close(loop.sampled(model.channel("q", "f"), 1e-3, 0.5e-3), K).L

    worst_case = worst_case_search.search(open_loop, mass.parameters, worst_case_search.PHASE_MARGIN)
    corners = {
        (m, c): stability_margins.of_loop(open_loop({"m": m, "c": c})).phase_margin
        for m in (1.8, 2.2)
        for c in (70.0, 130.0)
    }
    (m, c), least = min(corners.items(), key=lambda item: item[1])
    assert worst_case.value == pytest.approx(least, rel=1e-6) and worst_case.value <= least * (1 + 1e-12)
    assert worst_case.where == pytest.approx({"m": m, "c": c, "spare": 1.0}, rel=1e-3)


def test_invalid_searches_are_refused() -> None:
    k = [parameter("k", 5.0, 0.2)]
    with pytest.raises(SignalError, match=r"parameter 'zero' is 0 N with the relative tolerance 0.1"):
        worst_case_search.search(
            lambda v: integrator(1.0), [parameter("zero", 0.0, 0.1, "N")], worst_case_search.PHASE_MARGIN
        )
    with pytest.raises(SignalError, match="sets 'k', also a parameter"):
        worst_case_search.search(lambda v: integrator(1.0), k, worst_case_search.PHASE_MARGIN, {"here": {"k": 1.0}})
    with pytest.raises(SignalError, match="no operating point"):
        worst_case_search.search(lambda v: integrator(1.0), k, worst_case_search.PHASE_MARGIN, {})
    with pytest.raises(SignalError, match=r"2\^11 vertices: keep 10"):
        worst_case_search.search(
            lambda v: integrator(1.0), [parameter(f"p{i}", 1.0, 0.1) for i in range(11)], worst_case_search.PHASE_MARGIN
        )
    with pytest.raises(ModelError, match=r"no phase margin at k = 5: .* 1 \+ L has no inverse"):
        worst_case_search.search(lambda v: ([[-1.0]], [[1.0]], [[1.0]], [[-1.0]]), k, worst_case_search.PHASE_MARGIN)
    with pytest.raises(ModelError, match="the thing is NaN at k = 5"):
        worst_case_search.search(
            lambda v: integrator(1.0), k, worst_case_search.Criterion("thing", "1", lambda s: np.nan)
        )


@pytest.mark.parametrize("what", ["division", "matrix", "name", "figure"])
def test_errors_in_the_loop_are_reported_with_the_values(what: str) -> None:
    """At k = 1, the end of the box, each fails in its own way."""

    def loop_of(v: Mapping[str, float]) -> StateSpace:
        if what == "division" and v["k"] == 1.0:
            return integrator(1 / (v["k"] - 1.0))
        if what == "matrix":
            np.linalg.inv(np.array([[v["k"] - 1.0]]))
        return integrator(v["gain"] if what == "name" else v["k"])

    figure = (
        worst_case_search.Criterion("length", "1", lambda L: L.length)
        if what == "figure"
        else worst_case_search.PHASE_MARGIN
    )
    expected = {"division": "ZeroDivisionError", "matrix": "LinAlgError", "name": "KeyError: 'gain'"}
    kind = expected.get(what, "AttributeError")
    with pytest.raises(ModelError, match=rf"no {figure.name} at k = [12]: {kind}.*mend the loop") as raised:
        worst_case_search.search(loop_of, [parameter("k", 2.0, 0.5)], figure)
    assert type(raised.value.__cause__).__name__ == kind.split(":")[0]


def test_an_interrupt_by_the_user_propagates() -> None:
    def interrupt(v: Mapping[str, float]) -> StateSpace:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        worst_case_search.search(interrupt, [parameter("k", 2.0, 0.5)], worst_case_search.PHASE_MARGIN)
