"""The planar stage against its equations written in NumPy, its symmetries, and its Hall voltages against the field."""

import casadi as ca
import numpy as np
import pytest

from models import lorentz_motor, planar_stage
from synth.signals import signal_names
from tests import tolerances

DOUBLE = tolerances.of("double")
PLANT = planar_stage.plant()
V = {p.name: p.value for p in planar_stage.PARAMETERS}
K = float(lorentz_motor.force_constant({n: ca.SX(v) for n, v in V.items()}))
k = 2 * np.pi / V["l"]
CENTRES = {"A": (-V["a"], -V["b"]), "B": (V["a"], -V["b"]), "C": (0.0, V["c"])}


def random_point(seed: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    low, high = (np.array([getattr(s, end) for s in PLANT.states]) for end in ("low", "high"))
    return rng.uniform(low, high), rng.uniform(-1, 1, 9)


def expected_accelerations(x: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return the accelerations of (18)-(20) in the order x, y, phi, z, theta, psi."""
    X, Y, phi, z, theta, psi = x[:6]
    along, up = {}, {}
    for motor, i in zip("ABC", u.reshape(3, 3), strict=True):
        r_x, r_y = CENTRES[motor]
        at = X + np.cos(phi) * r_x - np.sin(phi) * r_y if motor == "C" else Y + np.sin(phi) * r_x + np.cos(phi) * r_y
        force = K * np.exp(-k * (z + theta * r_y - psi * r_x))
        alpha, beta = (2 * i[0] - i[1] - i[2]) / 3, (i[1] - i[2]) / np.sqrt(3)
        along[motor] = force * (np.cos(k * at) * alpha + np.sin(k * at) * beta)
        up[motor] = force * (np.cos(k * at) * beta - np.sin(k * at) * alpha)
    F = np.array([along["C"], along["A"] + along["B"]])
    turned = np.array([[np.cos(phi), -np.sin(phi)], [np.sin(phi), np.cos(phi)]]) @ F
    yaw = sum(CENTRES[m][0] * along[m] for m in "AB") - CENTRES["C"][1] * along["C"]
    roll = sum(CENTRES[m][1] * up[m] for m in "ABC") - V["K_theta"] * theta
    pitch = -sum(CENTRES[m][0] * up[m] for m in "ABC") - V["K_psi"] * psi
    lift = sum(up.values()) - V["Kz"] * z
    return np.array([*turned / V["M"], yaw / V["Izz"], lift / V["M"], roll / V["Ixx"], pitch / V["Iyy"]])


@pytest.mark.parametrize("seed", range(8))
def test_the_plant_is_its_equations(seed: int) -> None:
    x, u = random_point(seed)
    derivative = ca.DM(PLANT.f(x, u, PLANT.values)).full().ravel()
    rates = x[[signal_names(PLANT.states).index(planar_stage.RATE[axis]) for axis in planar_stage.AXES]]
    expected = dict(
        zip((*planar_stage.AXES, *planar_stage.RATE.values()), [*rates, *expected_accelerations(x, u)], strict=True)
    )
    np.testing.assert_allclose(derivative, [expected[n] for n in signal_names(PLANT.states)], rtol=DOUBLE, atol=DOUBLE)


def test_rows_x_and_z_of_table_3_move_one_axis_each() -> None:
    for push, lift, axis in (((-1, 1, 1), (0, 0, 0), "x"), ((0, 0, 0), (1, 1, 1), "z")):
        p = {n: ca.SX(v) for n, v in V.items()}
        at_rest = {n: ca.SX(0) for n in planar_stage.AXES}
        u = {}
        for motor, i_q, i_d in zip("ABC", push, lift, strict=True):
            where = planar_stage.centres(at_rest, p)[motor]
            along = where.X if motor == "C" else where.Y
            phases = lorentz_motor.phase_currents(ca.SX(i_q), ca.SX(i_d), along, p)
            u |= {f"i_{motor}{phase}": i for phase, i in phases.items()}
        moved = {n: float(v) for n, v in planar_stage.accelerations(at_rest, u, p).items()}
        assert abs(moved.pop(axis)) > 1 and max(map(abs, moved.values())) < 1e-10


def test_hall_voltages_are_the_field_at_the_sensors_turned_with_the_platen() -> None:
    at = dict.fromkeys(signal_names(PLANT.states), 0.0)
    amplitude = V["sensitivity"] * 0.35  # V, roughly

    def read(**pose: float) -> dict[str, float]:
        x = np.array(list((at | pose).values()))
        return dict(
            zip(signal_names(PLANT.outputs), ca.DM(PLANT.h(x, np.zeros(9), PLANT.values)).full().ravel(), strict=True)
        )

    assert read()["V_ax"] == pytest.approx(0, abs=DOUBLE) and read()["V_bx"] < -0.5 * amplitude
    assert read(x=V["l"] / 4)["V_ax"] > 0.5 * amplitude and read(y=V["l"] / 4)["V_ay"] > 0.5 * amplitude
    quarter = read(x=V["l"] / 4, phi=0.01)
    assert quarter["V_ay"] == pytest.approx(-np.tan(0.01) * quarter["V_ax"], rel=DOUBLE)
    assert read(z=1e-4)["V_bx"] / read()["V_bx"] == pytest.approx(np.exp(-k * 1e-4), rel=3e-3)  # harmonics decay faster


def test_lasers_see_the_three_vertical_axes() -> None:
    def read(**pose: float) -> np.ndarray:
        x = np.array([pose.get(n, 0.0) for n in signal_names(PLANT.states)])
        return ca.DM(PLANT.h(x, np.zeros(9), PLANT.values)).full().ravel()[-3:]

    arm = V["laser_arm"]
    np.testing.assert_allclose(read(z=1e-4), [1e-4] * 3)
    np.testing.assert_allclose(read(theta=1e-3), [-1e-3 * arm, -1e-3 * arm, 1e-3 * arm])
    np.testing.assert_allclose(read(psi=1e-3), [1e-3 * arm, -1e-3 * arm, 0])
