"""Loops of a stage over operating points and tolerances: against the linear theory, with the worst named."""

from typing import Any

import numpy as np
import pytest

from synth.analyse import operating_points
from synth.analyse.loops import disk, equilibrium, loop, robustness, stability_margins, transfer
from synth.analyse.loops.robustness import Case, Loops
from synth.declare.stage import DISK, MARGINS
from synth.errors import NoEquilibriumError, SignalError
from tests import levitator

DESIGN: Any = levitator.design("levitator_2dof")
CONTROLLER = DESIGN.DESIGN.controller
POINTS = {"low": {"z": -5e-4}, "side": {"x": 8e-4}}


def loops(points: Any = None, cases: Any = (robustness.NOMINAL,)) -> Loops:
    return robustness.of_controller(CONTROLLER, DESIGN.PLANT, POINTS if points is None else points, cases)


@pytest.fixture(scope="module")
def nominal() -> list[robustness.OpenLoop]:
    return robustness.open_loops(loops())


def test_every_actuator_and_sensor_is_opened_at_every_point(nominal: list[robustness.OpenLoop]) -> None:
    assert [(o.point, o.signal) for o in nominal] == [(p, s) for p in POINTS for s in ("i1", "i2", "z", "x")]
    assert all(o.margins.stable for o in nominal)
    assert nominal[0].label == "at i1, low"


def test_the_equilibrium_is_that_of_the_plant_and_the_controller(nominal: list[robustness.OpenLoop]) -> None:
    rest = robustness.equilibrium_at(loops(), "side")
    point = operating_points.trim(DESIGN.PLANT, {"x": 8e-4}, ["i1", "i2"])
    assert rest.point["i2"] == pytest.approx(400 * 8e-4 / 8, rel=1e-6)
    assert rest.point["i1"] == pytest.approx(point["i1"], rel=1e-6)
    assert rest.inputs["x"] == pytest.approx(rest.inputs["x_ref"], rel=1e-9) and rest.inputs["x_ref"] == 8e-4


def test_a_decoupled_axis_has_the_margins_of_its_own_linear_loop(nominal: list[robustness.OpenLoop]) -> None:
    """x does not depend on z: its loop is the model that it was made from, with hold and delay, under its servo."""
    T = DESIGN.TIME.period_s
    model = operating_points.linearise(DESIGN.PLANT, DESIGN.REST).channel("x", "i2")
    _, x = levitator.axes()
    servo = x.law(DESIGN.TIME, DESIGN.INTERFACE).blocks[0].rounded(np.float32)
    K = loop.linearise_block(servo, {"started": 1.0}, dict.fromkeys((s.name for s in servo.inputs), 0.0))
    P = loop.sampled(model, T, T)
    inputs = {name: i for i, name in enumerate(K.inputs)}
    # The measurement also enters the error; the limited command is fed back.
    on_y = K.B[:, [inputs["x_held"]]] - K.B[:, [inputs["x_error"]]]
    D = float(K.D[0, inputs["x_held"]] - K.D[0, inputs["x_error"]])
    on_u, C = K.B[:, [inputs["i2_computed"]]], K.C[:1]
    A = K.A + on_u @ C
    z = np.exp(1j * T * np.geomspace(1.0, 3000.0, 40))
    controller = np.array([(C @ np.linalg.solve(v * np.eye(len(A)) - A, on_y + on_u * D))[0, 0] + D for v in z])
    L = -P.response(z)[:, 0, 0] * controller
    response = next(o for o in nominal if (o.point, o.signal) == ("low", "x")).L.response(z)[:, 0, 0]
    np.testing.assert_allclose(response, L, rtol=1e-5)


def test_the_worst_loop_is_named_with_its_parameters() -> None:
    cases = [robustness.NOMINAL, *robustness.corners(DESIGN.PLANT, ["k", "m"])]
    open_loops = robustness.open_loops(loops({"mid": {"z": 0.0}}, cases), ["i2"])
    (check,) = robustness.checks(open_loops, {"modulus_margin": 0.5})
    least = min(open_loops, key=lambda o: o.margins.modulus_margin)
    assert check.passed and check.value == least.margins.modulus_margin
    assert least.case.values == {"k": pytest.approx(8.8), "m": pytest.approx(0.285)}  # the largest gain
    assert "of 5 loops, at i2, mid, k = 8.8, m = 0.285" in check.about


def test_an_insufficient_margin_fails_and_so_does_an_unstable_loop() -> None:
    open_loops = robustness.open_loops(loops({"mid": {"z": 0.0}}, [Case({"K": 80.0})]), ["z"])  # four times the gain
    require = {"phase_margin": 30.0, "gain_margin": 1.5, "modulus_margin": 0.5}
    lost = {c.name: c for c in robustness.checks(open_loops, require)}
    assert not open_loops[0].margins.stable and "not stable" in lost["phase margin"].about
    assert lost["phase margin"].value == 0.0 and lost["modulus margin"].value == 0.0
    assert lost["gain margin"].value == 1.0 and not any(c.passed for c in lost.values())
    sound = robustness.checks(robustness.open_loops(loops({"mid": {"z": 0.0}}), ["z"]), {"phase_margin": 80.0})
    assert not sound[0].passed and 30 < sound[0].value < 50


def test_a_point_without_an_equilibrium_leaves_no_margin(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: at one of two operating points the samples of the loop lead to no equilibrium."""
    solve = equilibrium.solve

    def fail_at_the_side(closed: Any, references: Any, near: Any) -> equilibrium.Equilibrium:
        if references["x_ref"]:
            raise NoEquilibriumError("'x' still changes")
        return solve(closed, references, near)

    monkeypatch.setattr(equilibrium, "solve", fail_at_the_side)
    survey = robustness.survey(loops())
    assert {o.point for o in survey.loops} == {"low"} and [u.point for u in survey.unsolved] == ["side"]
    (check,) = robustness.checks(survey.loops, {"phase_margin": 30.0}, survey.unsolved)
    assert not check.passed and check.value == 0.0
    assert "no equilibrium at side: 'x' still changes" in check.about


def test_disk_margins_are_no_larger_than_those_of_one_channel(nominal: list[robustness.OpenLoop]) -> None:
    disk_margins = robustness.disk_margins(loops(), "low")
    single = min(disk.of_loop(o.L).upper for o in nominal if o.point == "low" and o.signal in ("i1", "i2"))
    assert disk_margins["actuators"].lower <= single * (1 + 1e-6)
    assert disk_margins["both"].upper < disk_margins["sensors"].lower


def test_tolerances_are_taken_in_all_corners() -> None:
    plant = DESIGN.PLANT
    corners = robustness.corners(plant, ["K", "F0"])
    expected = [(18.0, 13.72), (18.0, 14.28), (22.0, 13.72), (22.0, 14.28)]
    np.testing.assert_allclose([tuple(c.values.values()) for c in corners], expected)
    assert robustness.corners(plant, []) == []


def test_the_margins_are_those_of_the_opened_loop(nominal: list[robustness.OpenLoop]) -> None:
    for o in nominal[:2]:
        assert o.margin("delay_margin") == stability_margins.of_loop(o.L).delay_margin
        assert o.margin("gain_reduction") == 1 / o.margins.gain_reduction_margin


def coordinates(**weights: dict[str, float]) -> Loops:
    return robustness.of_controller(CONTROLLER, DESIGN.PLANT, {"mid": {"z": 0.0}}, coordinates=weights)


def test_loops_open_at_coordinates_instead_of_sensors() -> None:
    """A scaled sensor is cut as it is; all of them cut at once leave det(1 + L) in any coordinates."""
    z = np.exp(1j * np.array([0.02, 0.3, 1.5]))
    at = robustness.equilibrium_at(loops({"mid": {"z": 0.0}}), "mid")
    scaled = robustness.open_loops(coordinates(far={"z": 2.0}))
    assert [o.signal for o in scaled] == ["far", "x"]
    np.testing.assert_allclose(scaled[0].L.response(z), equilibrium.open_loop(at, "z").response(z), rtol=1e-9)
    turned = robustness.equilibrium_at(coordinates(mean={"z": 0.5, "x": 0.5}, gap={"z": 1.0, "x": -0.7}), "mid")
    pairs = equilibrium.open_loop(turned, ["mean", "gap"]), equilibrium.open_loop(at, ["z", "x"])
    new, old = (np.linalg.det(np.eye(2) + L.response(z)) for L in pairs)
    np.testing.assert_allclose(new, old, rtol=1e-9)
    alone = equilibrium.open_loop(turned, "mean").response(z)
    assert np.abs(alone / equilibrium.open_loop(at, "z").response(z) - 1).max() > 0.1


def test_a_loop_does_not_open_at_a_sensor_and_at_its_coordinate() -> None:
    at = robustness.equilibrium_at(coordinates(far={"z": 2.0}), "mid")
    with pytest.raises(SignalError, match="at 'z' and at a coordinate of it at once"):
        equilibrium.open_loop(at, ["far", "z"])


def test_the_margins_that_a_stage_may_require_are_those_that_a_loop_has() -> None:
    assert (*robustness.REQUIREMENTS, DISK) == MARGINS


def test_the_poles_of_the_closed_loop_are_those_of_each_axis() -> None:
    """Opened at one actuator a loop has the poles of its own axis alone; the closed loop has those of all."""
    opened = loops()
    closed = robustness.closed_loops(opened)
    assert [c.place for c in closed] == [*POINTS] and all(c.is_stable for c in closed)
    at_rest = robustness.equilibrium_at(opened, "low")
    each = [transfer.closed_loop_poles(equilibrium.open_loop(at_rest, signal)) for signal in opened.actuators]
    assert len(each[0]) < len(closed[0].poles)
    for pole in np.concatenate(each)[np.abs(np.concatenate(each)) > 1e-3]:
        assert np.abs(closed[0].poles - pole).min() < 1e-6


def test_an_axis_that_no_other_reaches_is_found_unstable() -> None:
    k = DESIGN.PLANT.parameter("k").value
    (closed,) = robustness.closed_loops(loops({"low": POINTS["low"]}, [Case({"k": 20 * k})]))
    assert not closed.is_stable


def test_a_loop_with_ten_times_its_force_is_unstable() -> None:
    K = DESIGN.PLANT.parameter("K").value
    closed = robustness.closed_loops(loops({"low": POINTS["low"]}, [robustness.NOMINAL, Case({"K": 10 * K})]))
    assert [c.is_stable for c in closed] == [True, False]
    assert closed[1].reason or closed[1].slowest_s == np.inf


def test_time_constant_and_damping_are_those_of_the_slowest_and_the_least_damping_pole() -> None:
    T, s = 1e-3, np.array([-10.0, -30.0 + 400.0j, -30.0 - 400.0j])
    closed = robustness.ClosedLoop("rest", np.append(np.exp(s * T), 0.0).astype(complex), T)
    assert closed.is_stable and closed.slowest_s == pytest.approx(0.1)
    assert closed.least_damping == pytest.approx((30 / abs(s[1]), abs(s[1]) / (2 * np.pi)))
    grows = robustness.ClosedLoop("rest", np.exp(np.array([2.0 + 0j]) * T), T)
    assert not grows.is_stable and grows.slowest_s == np.inf and grows.least_damping[0] == pytest.approx(-1.0)


def test_an_equilibrium_continued_from_the_first_case_is_that_of_the_whole_search() -> None:
    varied = loops(cases=[robustness.NOMINAL, *robustness.corners(DESIGN.PLANT, ["M", "K"])])
    rests = robustness.equilibria(varied)
    assert [r.point for r in rests[:2]] == [*POINTS] and all(r.case == robustness.NOMINAL for r in rests[:2])
    for rest in rests:
        alone = robustness.equilibrium_at(varied, rest.point, rest.case)
        assert rest.equilibrium is not None
        np.testing.assert_allclose(rest.equilibrium.point.x, alone.point.x, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(rest.equilibrium.point.u, alone.point.u, rtol=1e-9, atol=1e-12)
    closed = robustness.closed_loops(varied, rests[-1:])
    assert [c.place for c in closed] == [rests[-1].label]
