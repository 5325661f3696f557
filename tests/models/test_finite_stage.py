"""The stage over a finite matrix against forces by quadrature, fields of blocks, and the stage of the closed law."""

import casadi as ca
import magpylib
import numpy as np
import pytest

from models import finite_matrix, finite_motor, finite_stage, halbach, planar_stage
from synth.signals import signal_names
from tests.models import finite_oracle as oracle

V = {p.name: p.value for p in planar_stage.PARAMETERS}
# N/A, N m/A, up to a lift in m and a yaw in rad: measured 1.9e-3 and 3.6e-5, 1.2e-2 and 3.3e-4, of 13.7 and 0.3
ERRORS = ((1e-4, 0.005, 2.5e-3, 5e-5), (3e-4, 0.02, 1.5e-2, 4e-4))
CENTRES = {"A": (-V["a"], -V["b"]), "B": (V["a"], -V["b"]), "C": (0.0, V["c"])}
WIRES = oracle.conductors(False)


@pytest.fixture(scope="module")
def bars() -> magpylib.Collection:
    return oracle.bars(V["mu0_M0"])


def tabulated_map(values: np.ndarray, lift: float, phi: float) -> np.ndarray:
    value, lifted, yawed = values.reshape(3, 3, 6)
    return np.exp(-finite_motor.DECAY * lift) * (value + lift * lifted) + phi * yawed


@pytest.mark.parametrize("seed", range(2))
def test_tables_keep_their_stated_error(bars: magpylib.Collection, seed: int) -> None:
    """Anywhere over the travel, between the grid's points, against the integral itself."""
    motor = finite_stage.tables(False, 0.0).motor
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(-0.12, 0.12, 2)
    for lift, phi, force, torque in ERRORS:
        for way in (-1, 1):
            tabulated = tabulated_map(np.array(motor(x, y)), lift, way * phi)
            off = np.abs(tabulated - oracle.wrenches(bars, WIRES, (x, y), way * phi, lift))
            assert off[:, :3].max() < force and off[:, 3:].max() < torque


def accelerations_by_quadrature(bars: magpylib.Collection, x: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return the accelerations x, y, phi, z, theta, psi of a level platen, from quadrature alone."""
    X, Y, phi, z, theta, psi = x[:6]
    c, s = np.cos(phi), np.sin(phi)
    force, torque = np.zeros(3), np.zeros(3)
    for motor, i in zip("ABC", u.reshape(3, 3), strict=True):
        a, b = CENTRES[motor]
        angle = -np.pi / 2 if motor == "C" else 0.0  # C's motion, its y, is along the platen's x
        place = (X + c * a - s * b, Y + s * a + c * b)
        w = i @ oracle.wrenches(bars, WIRES, place, phi + angle, z + theta * b - psi * a)
        turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
        force += turn @ w[:3]
        torque += np.cross([a, b, 0.0], turn @ w[:3]) + turn @ w[3:]
    plane = np.array([c * force[0] - s * force[1], s * force[0] + c * force[1]]) / V["M"]
    roll, pitch = torque[0] - V["K_theta"] * theta, torque[1] - V["K_psi"] * psi
    lift = (force[2] - V["Kz"] * z) / V["M"]
    return np.array([*plane, torque[2] / V["Izz"], lift, roll / V["Ixx"], pitch / V["Iyy"]])


@pytest.mark.parametrize("pose", [(0.013, -0.021, 0.004, 1e-4, 0.0, 0.0), (-0.08, 0.06, -0.003, -5e-5, 2e-4, -3e-4)])
def test_the_plant_is_the_quadrature_of_its_three_motors(bars: magpylib.Collection, pose: tuple[float, ...]) -> None:
    """Motor C among them, turned by -90 degrees as it is. Within what tables leave and tilt does beside lifting."""
    plant = finite_stage.plant(made=False, end_turns=0.0)
    x, u = np.array([*pose, *np.zeros(6)]), np.random.default_rng(5).uniform(-0.5, 0.5, 9)
    derivative = np.array(plant.f(x, u, plant.values)).ravel()
    second = [derivative[signal_names(plant.states).index(planar_stage.RATE[axis])] for axis in planar_stage.AXES]
    inertia = np.array([V["M"], V["M"], V["Izz"], V["M"], V["Ixx"], V["Iyy"]])
    off = np.abs(second - accelerations_by_quadrature(bars, x, u)) * inertia
    assert off[[0, 1, 3]].max() < 0.01 and off[[2, 4, 5]].max() < 5e-4  # N of 6, N m of 0.2


def test_hall_voltages_are_the_field_of_the_blocks() -> None:
    plant, blocks = finite_stage.plant(), oracle.single(finite_matrix.fabricated_blocks())
    nominal = {n: ca.SX(v) for n, v in V.items()}
    gain = V["sensitivity"] * float(halbach.amplitude(1, ca.SX(3e-3), nominal)) / 0.375
    for X, Y, phi, z in ((0.0, 0.0, 0.0, 0.0), (0.021, -0.047, 0.01, 1e-4), (-0.1, 0.1, -0.01, -1e-4)):
        c, s = np.cos(phi), np.sin(phi)
        outputs = np.array(plant.h([X, Y, phi, z, *np.zeros(8)], np.zeros(9), plant.values)).ravel()
        seen = dict(zip(signal_names(plant.outputs), outputs, strict=True))
        for name, r in (("a", (0, 0)), ("b", (V["spacing"], 0)), ("c", (0, V["spacing"]))):
            B = blocks.getB([X + c * r[0] - s * r[1], Y + s * r[0] + c * r[1], 3e-3 + z])
            expected = gain * np.array([c * B[0] + s * B[1], c * B[1] - s * B[0]])
            np.testing.assert_allclose([seen[f"V_{name}x"], seen[f"V_{name}y"]], expected, rtol=2e-3, atol=2e-3)


def test_over_the_middle_of_ideal_blocks_it_is_nearly_the_stage_of_the_closed_law() -> None:
    """Forces within 0.8 %, of the 20 N/A that any may have; torques within the 0.1 N m/A of each motor."""
    plants = finite_stage.plant(made=False), planar_stage.plant(halbach.HARMONICS)
    rng = np.random.default_rng(7)
    for _ in range(20):
        x = np.concatenate([rng.uniform(-1, 1, 2) * V["l"] / 2, np.zeros(10)])
        u = rng.uniform(-1, 1, (3, 3))
        u = (u - u.mean(axis=1, keepdims=True)).ravel()
        ours, theirs = (np.array(p.f(x, u, p.values)).ravel()[6:] for p in plants)
        off = dict(zip((s.name for s in plants[0].states[6:]), np.abs(ours - theirs), strict=True))
        assert max(off[v] * V["M"] for v in ("vx", "vy", "vz")) < 0.008 * 20 * 3
        assert max(off[f"w{a}"] * V[i] for a, i in (("theta", "Ixx"), ("psi", "Iyy"))) < 0.1 * 3
        seen = [np.array(p.h(x, u, p.values)).ravel()[6:12] for p in plants]
        assert np.abs(seen[0] - seen[1]).max() < 0.02  # V of 2.9: ends of the matrix, harmonics beyond the 9th


def test_strength_scales_and_geometry_is_fixed() -> None:
    plant = finite_stage.plant(made=False)
    x, u = np.array([0.01, 0.02, *np.zeros(10)]), np.linspace(-0.3, 0.3, 9)

    def accelerations(**changed: float) -> np.ndarray:
        p = plant.with_parameters(**changed)
        return np.array(p.f(x, u, p.values)).ravel()[6:]

    nominal = accelerations()
    np.testing.assert_allclose(accelerations(mu0_M0=1.1 * V["mu0_M0"]), 1.1 * nominal, rtol=1e-12)
    np.testing.assert_allclose(accelerations(turns=0.9 * V["turns"]), 0.9 * nominal, rtol=1e-12)
    lifted = plant.f(np.array([0.01, 0.02, 0, 1e-4, *np.zeros(8)]), u, plant.values)
    lower = accelerations(z0=V["z0"] + 1e-4)
    assert lower[0] == pytest.approx(float(lifted[6])) and abs(lower[0] / nominal[0] - 1) > 0.01
    for name in finite_stage.FIXED:
        assert np.isnan(accelerations(**{name: 1.001 * V[name]})).all()
