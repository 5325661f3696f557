"""Allocation and commutation against the stage's physics, and the limits that they keep."""

import re
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from designs.planar_6dof import allocation, interface, reference_control
from models import lorentz_motor, planar_stage
from synth.block import Block, unranged
from synth.emit import write
from synth.errors import EmitError
from synth.execute import host
from synth.signals import signal_names
from synth.timing import Discrete
from synth.verify import agree
from tests import tolerances
from tests.c_code import without_comments

DOUBLE = tolerances.of("double")
PLANT = planar_stage.plant()
TIME = Discrete(1e-3)
V = {p.name: p.value for p in PLANT.parameters}
P = {n: ca.SX(v) for n, v in V.items()}
K = allocation.force_constant(PLANT)
SCALES = allocation.scales(PLANT)
BOX_YAW = allocation.BOX["phi"].high  # rad, by which the stage turns
N = 20_000


def compiled(block: Block) -> agree.Witness:
    emitted = write.emit(unranged(block), np.float64)
    return agree.emitted_c(host.load(emitted.files, emitted.manifest))


@pytest.fixture(scope="module")
def allocated() -> dict[str, agree.Witness]:
    block = allocation.allocation(PLANT, TIME)
    return {"casadi": agree.casadi(block), "c64": compiled(block)}


@pytest.fixture(scope="module")
def commutated() -> dict[str, agree.Witness]:
    block = allocation.commutation(PLANT, TIME)
    return {"casadi": agree.casadi(block), "c64": compiled(block)}


def demands(size: float, n: int = N) -> dict[str, np.ndarray]:
    """Return demands of `size` of what the motors can meet of each axis, and a yaw over all that is turned back."""
    rng, most = np.random.default_rng(0), allocation.authority(PLANT)
    columns = {s.name: size * most[a] * rng.uniform(-1, 1, n) for a, s in zip(most, allocation.DEMANDS, strict=True)}
    return columns | {"phi": rng.uniform(allocation.YAW.low, allocation.YAW.high, n)}


def poses(n: int = N) -> dict[str, np.ndarray]:
    """Return currents within the limit, poses over the travel, some on pitches' borders, and their places there."""
    rng, columns = np.random.default_rng(1), {}
    for motor in planar_stage.MOTORS:
        columns[f"i_{motor}Q"] = allocation.QUADRATURE * rng.uniform(-1, 1, n)
        columns[f"i_{motor}D"] = np.sqrt(allocation.LIMIT**2 - columns[f"i_{motor}Q"] ** 2) * rng.uniform(-1, 1, n)
    columns |= {
        s.name: rng.uniform(s.low, s.high, n) for s in (allocation.BOX["x"], allocation.BOX["y"], allocation.YAW)
    }
    for axis in "xy":
        pitch = np.round(columns[axis] / V["l"])
        border = rng.uniform(size=n) < 0.05  # of a pitch, to either side of which it may be taken
        columns[f"within_{axis}"] = np.where(
            border, rng.choice([-0.5, 0.5], n) * V["l"], columns[axis] - V["l"] * pitch
        )
        columns[axis] = columns[f"within_{axis}"] + V["l"] * pitch
    return columns


def commutation_inputs(q: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return what the commutation knows of a pose."""
    return {name: v for name, v in q.items() if name not in ("x", "y")}


def forces(q: dict[str, np.ndarray], out: agree.Columns) -> tuple[np.ndarray, np.ndarray]:
    """Return what the stage's motors make of phase currents (3, n), along their motion and up, at the nominal gap."""
    x = {n: ca.SX.sym(n) for n in ("x", "y", "phi")}
    u = {n: ca.SX.sym(n) for n in signal_names(planar_stage.INPUTS)}
    made = planar_stage.motor_forces(x | dict.fromkeys(("z", "theta", "psi"), ca.SX(0)), u, P)
    both = ca.vcat([getattr(made[m], axis) for axis in "yz" for m in planar_stage.MOTORS])
    f = ca.Function("f", [ca.vcat([*x.values(), *u.values()])], [both])
    columns = [q[n] for n in x] + [np.asarray(out[f"{n}_computed"]) for n in u]
    values = np.asarray(f.map(len(q["x"]))(np.array(columns)))
    return values[:3], values[3:]


def test_shares_have_the_signs_of_table_3() -> None:
    table = {"x": "-++000", "y": "++0000", "phi": "-+0000", "z": "000+++", "theta": "000--+", "psi": "000+-0"}
    for row, (axis, expected) in zip(np.linalg.inv(allocation.wrench(PLANT)).T, table.items(), strict=True):
        signs = "".join("+" if v > 1e-12 else "-" if v < -1e-12 else "0" for v in row)
        assert signs == expected, axis


def test_the_wrench_is_that_of_the_stage() -> None:
    """Its columns are the stage's accelerations at rest, times the inertias, for 1 N of each motor."""
    at_rest = {n: ca.SX(0) for n in signal_names(PLANT.states)}
    inertia = np.array([V[n] for n in ("M", "M", "Izz", "M", "Ixx", "Iyy")])
    columns = []
    for direct in (False, True):
        for motor in planar_stage.MOTORS:
            u = {n: ca.SX(0) for n in signal_names(PLANT.inputs)}
            where = planar_stage.centres(at_rest, P)[motor]
            i = (ca.SX(0), ca.SX(1 / K)) if direct else (ca.SX(1 / K), ca.SX(0))
            phases = lorentz_motor.phase_currents(*i, where.X if motor == "C" else where.Y, P)
            u |= {f"i_{motor}{phase}": v for phase, v in phases.items()}
            moved = planar_stage.accelerations(at_rest, u, P)
            columns.append([float(moved[axis]) for axis in allocation.AXES] * inertia)
    np.testing.assert_allclose(allocation.wrench(PLANT), np.array(columns).T, rtol=DOUBLE, atol=DOUBLE)


@pytest.mark.parametrize("witness", ["casadi", "c64"])
def test_motors_make_what_is_commanded_anywhere(commutated: dict[str, agree.Witness], witness: str) -> None:
    """Over the travel, all pitches, their borders and the yaw: K i_Q along, K i_D up, to rounding."""
    q = poses()
    along, up = forces(q, commutated[witness]({}, commutation_inputs(q)).outputs)
    for axis, made in (("Q", along), ("D", up)):
        commanded = K * np.array([q[f"i_{m}{axis}"] for m in planar_stage.MOTORS])
        np.testing.assert_allclose(made, commanded, rtol=0, atol=DOUBLE * K * allocation.LIMIT)


def test_phases_are_those_of_the_reference_and_within_the_limit(commutated: dict[str, agree.Witness]) -> None:
    q = poses()
    currents = {m: (q[f"i_{m}Q"], q[f"i_{m}D"]) for m in planar_stage.MOTORS}
    expected = reference_control.phases(currents, q)
    phases = commutated["c64"]({}, commutation_inputs(q)).outputs
    for name, i in expected.items():
        np.testing.assert_allclose(phases[f"{name}_computed"], i, rtol=0, atol=DOUBLE)
        assert np.abs(i).max() <= allocation.LIMIT * (1 + DOUBLE)
        assert np.abs(phases[f"{name}_computed"]).max() <= allocation.LIMIT


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_no_phase_has_more_than_the_limit_though_no_limit_is_printed(scalar: type[np.floating]) -> None:
    """Both currents of a motor at their bounds at once: its phases come up to the limit but for what is spared."""
    q = poses(20 * N)
    for m in planar_stage.MOTORS:
        q[f"i_{m}Q"] = allocation.QUADRATURE * np.sign(q[f"i_{m}Q"])
        q[f"i_{m}D"] = allocation.DIRECT * np.sign(q[f"i_{m}D"])
    block = allocation.commutation(PLANT, TIME)
    emitted = write.emit(unranged(block), scalar, error=interface.SURROGATE_ERROR[scalar])
    text = emitted.files[f"{block.name}.c"]
    code = without_comments(text)
    assert code.count("admit -1.26") == 9 and not re.search(r"i_.._computed = \w*limit", code)
    phases = agree.emitted_c(host.load(emitted.files, emitted.manifest))({}, commutation_inputs(q)).outputs
    largest = max(np.abs(phases[s.name]).max() for s in allocation.COMPUTED)
    assert allocation.LIMIT * (1 - 2 * allocation.ROUNDING_MARGIN) < largest <= scalar(allocation.LIMIT)


def test_a_limit_stays_where_nothing_is_spared(monkeypatch: pytest.MonkeyPatch) -> None:
    """The planted defect: currents that leave nothing to rounding, or polynomials that are too coarse."""
    coarse = write.emit(unranged(allocation.commutation(PLANT, TIME)), np.float32, error=1e-3)
    monkeypatch.setattr(allocation, "DIRECT", np.sqrt(allocation.LIMIT**2 - allocation.QUADRATURE**2))
    tight = write.emit(unranged(allocation.commutation(PLANT, TIME)), np.float32, error=1e-6)
    for emitted in (coarse, tight):
        text = emitted.files["commutation.c"]
        assert "admit" not in text and text.count("_computed = commutation_limit(") == 9


@pytest.mark.parametrize("witness", ["casadi", "c64"])
def test_what_the_motors_can_do_is_done(allocated: dict[str, agree.Witness], witness: str) -> None:
    u = demands(0.1)
    out = allocated[witness]({}, u).outputs
    for axis, demand in zip(allocation.AXES, allocation.DEMANDS, strict=True):
        size = allocation.authority(PLANT)[axis]
        np.testing.assert_allclose(out[f"achieved_{axis}"], u[demand.name], rtol=0, atol=DOUBLE * size)


def test_currents_are_those_of_the_reference(allocated: dict[str, agree.Witness]) -> None:
    for size in (0.1, 1.0, 100.0):
        u = demands(size)
        demand = {a: SCALES[a] * u[s.name] for a, s in zip(allocation.AXES, allocation.DEMANDS, strict=True)}
        currents, made = reference_control.allocate(demand, u["phi"])
        out = allocated["c64"]({}, u).outputs
        for m, pair in currents.items():
            for axis, i in zip("QD", pair, strict=True):
                np.testing.assert_allclose(out[f"i_{m}{axis}"], i, rtol=0, atol=max(1, size) * DOUBLE)
        for axis, force in made.items():
            most = allocation.authority(PLANT)[axis]
            met = force / SCALES[axis]
            np.testing.assert_allclose(out[f"achieved_{axis}"], met, rtol=0, atol=max(1, size) * DOUBLE * most)


def test_limits_put_yaw_first_and_leave_the_vertical_axes_their_part(allocated: dict[str, agree.Witness]) -> None:
    u = demands(10.0)
    out = allocated["c64"]({}, u).outputs
    alone = allocated["c64"]({}, u | {s.name: np.zeros(N) for s in allocation.DEMANDS[3:]}).outputs
    for m in planar_stage.MOTORS:
        i_q, i_d = out[f"i_{m}Q"], out[f"i_{m}D"]
        assert np.hypot(i_q, i_d).max() <= allocation.LIMIT * (1 + DOUBLE)
        np.testing.assert_array_equal(i_q, alone[f"i_{m}Q"])
        most = allocation.QUADRATURE / (2 if m == "C" else 1)  # C leaves the others half for the yaw
        assert np.mean(np.abs(i_q) >= most * (1 - DOUBLE)) > 0.45
        assert np.abs(i_d).max() == allocation.DIRECT
    made, straight = np.array([out[f"achieved_{axis}"] for axis in allocation.AXES]), np.abs(u["phi"]) <= BOX_YAW
    bounds = (allocation.achievable_bound, allocation.authority)
    reach, most = (np.array(list(v(PLANT).values()))[:, None] for v in bounds)
    assert (np.abs(made) <= reach * (1 + DOUBLE)).all()
    assert (np.abs(made[:, straight]) <= most * (1 + DOUBLE)).all() and 0.2 < straight.mean() < 0.4


def test_yaw_is_held_where_x_and_y_are_beyond_the_motors(allocated: dict[str, agree.Witness]) -> None:
    """C pushes as far as it can, A and B take back its torque, and with what is left they push along y."""
    u = {s.name: np.zeros(1) for s in allocation.DEMANDS} | {"phi": np.zeros(1), "d_x": [100.0], "d_y": [100.0]}
    out = allocated["c64"]({}, {n: np.asarray(v) for n, v in u.items()}).outputs
    assert out["achieved_phi"] == pytest.approx(0.0, abs=DOUBLE) and out["i_CQ"] == allocation.QUADRATURE
    u["d_x"] = np.array([0.5])
    out = allocated["c64"]({}, {n: np.asarray(v) for n, v in u.items()}).outputs
    assert out["achieved_phi"] == pytest.approx(0.0, abs=DOUBLE) and out["achieved_x"] == pytest.approx(0.5)
    assert out["achieved_y"] == pytest.approx(2 * (allocation.QUADRATURE - 0.5))


def test_the_cosine_of_a_quarter_is_proved_and_that_of_a_place_beyond_its_pitch_is_not() -> None:
    """Its root is of 1 - sin^2, which rounding may make negative where a quarter of the angle is 90 degrees."""
    beyond = [replace(s, low=2 * s.low, high=2 * s.high) for s in allocation.WITHIN]
    write.emit(unranged(allocation.commutation(PLANT, TIME)), np.float32)
    block = allocation.commutation(PLANT, TIME)
    inputs = tuple(next((s for s in beyond if s.name == i.name), i) for i in block.inputs)
    with pytest.raises(EmitError, match=r"sqrt of `\(1 - \(quarter_sine_(\w+) \* quarter_sine_\1\)\)`"):
        write.emit(unranged(replace(block, inputs=inputs)), np.float32)


def test_the_functions_of_the_angle_become_polynomials() -> None:
    text = write.emit(unranged(allocation.commutation(PLANT, TIME)), np.float64).files["commutation.c"]
    step = without_comments(text[text.index("commutation_step(") :])
    assert not re.search(r"\b(sin|cos)f?\(", step)
    assert step.count("quarter_sine_polynomial(") == 2  # of the rear motors and of the front ones


def test_scales_are_those_of_the_reference_and_leave_ratios_of_arms() -> None:
    """A demand of 1 A by axis (columns) is, in A of the six motors' currents, what the module's text says."""
    other, a, b, c = reference_control.scales(), *(V[n] for n in "abc")
    for axis, scale in SCALES.items():
        assert scale == pytest.approx(other[axis], rel=DOUBLE)
    h = c / (2 * a)
    rows = {
        "AQ": [-h, 0.5, -1, 0, 0, 0],
        "BQ": [h, 0.5, 1, 0, 0, 0],
        "CQ": [1, 0, 0, 0, 0, 0],
        "AD": [0, 0, 0, 1, -1, 1],
        "BD": [0, 0, 0, 1, -1, -1],
        "CD": [0, 0, 0, 2 * b / c, 2, 0],
    }
    ratios = np.linalg.inv(allocation.wrench(PLANT)) * list(SCALES.values()) / K
    np.testing.assert_allclose(ratios, list(rows.values()), rtol=0, atol=DOUBLE)


def test_authority_is_what_all_motors_make_together(allocated: dict[str, agree.Witness]) -> None:
    """With every motor pushing as far as it can: DIRECT each for a vertical axis, QUADRATURE for a horizontal one.

    C, which turns the platen, does so with half of it while the yaw is demanded.
    """
    T = allocation.wrench(PLANT)
    for row, (axis, most) in zip(T, allocation.authority(PLANT).items(), strict=True):
        achievable = T @ np.sign(row) * K * 1e3 / list(SCALES.values())
        u = dict(zip((s.name for s in allocation.DEMANDS), achievable[:, None], strict=True)) | {"phi": np.zeros(1)}
        part = (allocation.QUADRATURE if axis in allocation.HORIZONTAL else allocation.DIRECT) / allocation.LIMIT
        part *= {"x": 0.5, "phi": 0.75}.get(axis, 1.0)
        assert allocated["c64"]({}, u).outputs[f"achieved_{axis}"] == pytest.approx(part * most, rel=DOUBLE), axis


def test_k_is_the_lorentz_integrals_and_not_as_printed() -> None:
    printed = float(lorentz_motor.force_constant(P, "printed"))
    for other in (printed * 3 / np.pi, reference_control.force_constant()):
        assert pytest.approx(other, rel=DOUBLE) == K
