"""Voltages of Hall sensors and their Jacobians, against formulas, differences, quadrature and magpylib's sensors."""

from collections.abc import Callable
from dataclasses import replace

import casadi as ca
import magpylib
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models import concentrated_field as cf
from models import hall_array
from models.hall_array import HallArray, Sensor
from models.hall_chain import Chain
from synth.errors import ModelError
from tests.models import matrix_oracle

P = cf.values()
l = matrix_oracle.l
w = 2 * np.pi / l
FABRICATED = cf.fabricated_matrix(P["strong"], P["weak"])
WAVES = cf.waves(FABRICATED, cf.orders_on_axes((1, 5, 9)) + cf.CROSS, P)
ALPHA, BETA = 8.4 * 0.37502, -8.4 * 0.02146  # V
FITTED = cf.waves_from_amplitudes({1: ALPHA / 8.4, 5: BETA / 8.4}, 3e-3, P)
PLACES = ((-0.375 * l, -0.375 * l), (0.375 * l, 0.375 * l), (0.640 * l, 0.613 * l))
POINTS = (0.0, 0.0, 0.0)  # m, no volume
CROOKED = HallArray(
    (
        Sensor((0.0, 0.0, 1e-3), 0.3, (1.02, 0.97), (0.02, -0.01), (0.01, -0.02, 0.03), 0.015),
        Sensor((38.1e-3, 20e-3, -5e-4), -2.0, (0.99, 1.01), (0.0, 0.03), (-0.02, 0.015, 0.0), -0.01),
        Sensor((5e-3, -30e-3, 0.0), 1.6),
    )
)


def poses(count: int, six: bool) -> np.ndarray:
    rng = np.random.default_rng(11)
    plane = np.column_stack([rng.uniform(-l, l, (count, 2)), rng.uniform(-np.pi, np.pi, count)])
    if not six:
        return plane
    return np.column_stack(
        [plane[:, :2], rng.uniform(5e-3, 8e-3, count), rng.uniform(-0.05, 0.05, (count, 2)), plane[:, 2]]
    )


def formula(q: np.ndarray, places: tuple[tuple[float, float], ...]) -> tuple[np.ndarray, np.ndarray]:
    """Return the voltages and the Jacobian of model (2) with alpha and beta, by rows written by hand."""
    volts, rows = [], []
    c, s = np.cos(q[2]), np.sin(q[2])
    for x, y in places:
        X, Y = q[0] + c * x - s * y, q[1] + s * x + c * y
        BX, BY = (ALPHA * np.sin(w * t) + BETA * np.sin(5 * w * t) for t in (X, Y))
        gX, gY = (w * (ALPHA * np.cos(w * t) + 5 * BETA * np.cos(5 * w * t)) for t in (X, Y))
        dX, dY = -s * x - c * y, c * x - s * y
        volts += [c * BX + s * BY, c * BY - s * BX]
        rows.append([c * gX, s * gY, -s * BX + c * BY + c * gX * dX + s * gY * dY])
        rows.append([-s * gX, c * gY, -c * BX - s * BY - s * gX * dX + c * gY * dY])
    return np.array(volts), np.array(rows)


def differences(f: ca.Function, q: np.ndarray, h: float) -> np.ndarray:
    """Return the Jacobian of f's first output by central differences of fourth order."""
    columns = []
    for i in range(len(q)):
        step = h * np.eye(len(q))[i]
        near, far = (f(q + k * step)[0] - f(q - k * step)[0] for k in (1, 2))
        columns.append((8 * near - far).full().ravel() / (12 * h))
    return np.array(columns).T


def test_the_plane_is_the_formula() -> None:
    f = hall_array.planar(hall_array.point_sensors(PLACES), FITTED).function()
    for q in poses(30, six=False):
        volts, jacobian = (each.full() for each in f(q))
        expected, rows = formula(q, PLACES)
        np.testing.assert_allclose(volts.ravel(), expected, rtol=0, atol=1e-12)
        np.testing.assert_allclose(jacobian, rows, rtol=0, atol=1e-10)


@pytest.mark.parametrize("six", [False, True])
def test_jacobians_are_differences_of_the_voltages(six: bool) -> None:
    prediction = hall_array.spatial(CROOKED, WAVES) if six else hall_array.planar(CROOKED, WAVES)
    f = prediction.function()
    for q in poses(8, six):
        jacobian = f(q)[1].full()
        off = np.abs(differences(f, q, 2e-6) - jacobian).max(axis=0) / np.abs(jacobian).max(axis=0)
        assert off.max() < 1e-7  # voltages of 3 V to 1e-15 over 1e-5 of a radian


def of_magpylib(q: np.ndarray) -> np.ndarray:
    """Return the voltages (3 k, 2) of CROOKED at poses (k, 6): rotations are SciPy's, sensors and blocks magpylib's."""
    volts, sensors = [], []
    for pose in q:
        turn = Rotation.from_euler("ZYX", pose[[5, 4, 3]])
        for s in CROOKED.sensors:
            tilt = Rotation.from_euler("Z", s.angle) * Rotation.from_euler("ZYX", s.misalignment[::-1])
            sensors.append(magpylib.Sensor(position=pose[:3] + turn.apply(s.position), orientation=turn * tilt))
            volts.append(s)
    u, v, _ = magpylib.getB(matrix_oracle.blocks(), sensors).T
    skew, gain, offset = (np.array([getattr(s, name) for s in volts]) for name in ("skew", "gain", "offset"))
    return offset + gain * 8.4 * np.column_stack([u, np.cos(skew) * v - np.sin(skew) * u])


def test_six_axes_are_what_sensors_of_another_library_read_above_blocks() -> None:
    q = poses(12, six=True) * [0.4, 0.4, 1, 1, 1, 1]
    theirs, waves = of_magpylib(q), cf.waves(FABRICATED, cf.orders_up_to(5) + cf.orders_on_axes((7, 9)), P)

    def off(array: HallArray) -> float:
        pose = ca.SX.sym("pose", 6)
        volts = hall_array.voltages(array, waves, hall_array.spatial_pose(pose))
        ours = ca.Function("volts", [pose], [volts]).map(len(q))(q.T).full()
        return float(np.abs(ours.T.reshape(-1, 2) - theirs).max())

    assert off(CROOKED) < 0.015  # V: 9 mV are left, of the ends of a matrix of six pitches and waves beyond these
    straight = (replace(s, misalignment=POINTS, skew=0.0) for s in CROOKED.sensors)
    assert off(HallArray(tuple(straight))) > 0.06  # what the misalignments are worth


def test_the_plane_is_space_without_tilt() -> None:
    flat, space = hall_array.planar(CROOKED, WAVES, 4e-3).function(), hall_array.spatial(CROOKED, WAVES).function()
    for q in poses(5, six=False):
        volts, jacobian = flat(q)
        other, full = space(np.array([q[0], q[1], 4e-3, 0, 0, q[2]]))
        np.testing.assert_allclose(volts.full(), other.full(), rtol=0, atol=1e-13)
        np.testing.assert_allclose(jacobian.full(), full.full()[:, [0, 1, 5]], rtol=0, atol=1e-10)


def mean(waves: tuple[cf.Wave, ...], at: np.ndarray, turn: np.ndarray, volume: np.ndarray) -> np.ndarray:
    """Return the mean field (3,) in T over a box by Gauss quadrature."""
    nodes, weights = np.polynomial.legendre.leggauss(8)
    grid = np.stack(np.meshgrid(nodes, nodes, nodes, indexing="ij"), axis=-1).reshape(-1, 3)
    share = np.prod(np.stack(np.meshgrid(weights, weights, weights, indexing="ij"), axis=-1).reshape(-1, 3), axis=1) / 8
    r = ca.SX.sym("r", 3)
    B = cf.field(waves, r[0], r[1], r[2])
    points = at + (grid * volume / 2) @ turn.T
    return ca.Function("B", [r], [ca.vertcat(B.x, B.y, B.z)]).map(len(points))(points.T).full() @ share


@pytest.mark.parametrize("factor", [1, 8])
def test_the_mean_over_the_sensitive_volume_is_exact(factor: int) -> None:
    """Also over a box eight times as long, where the mean is off the field at the middle by 0.1 mT and more."""
    cell = cf.Cell(*(ca.SX(np.random.default_rng(2).normal(size=(4, 4))) for _ in range(3)))
    waves = cf.waves(cell, [(1, 0), (2, -1), (0, 5), (9, 0), (3, 7)], P)
    volume = factor * np.array([250e-6, 250e-6, 200e-6])
    for at, angles in (((3e-3, -7e-3, 4e-3), (0, 0, 0)), ((1e-3, 2e-3, 5e-3), (0.7, 0.4, -1.1))):
        turn = Rotation.from_euler("ZYX", angles).as_matrix()
        seen = [hall_array.average_over_volume(wave, ca.SX(turn), tuple(volume)) for wave in waves]
        B = cf.field(seen, *(ca.SX(value) for value in at))
        ours = np.array([float(value) for value in (B.x, B.y, B.z)])
        theirs, point = (mean(waves, np.array(at), turn, volume * each) for each in (1, 0))
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-14)
        assert np.abs(point - theirs).max() > 1e-6 * factor**2  # what the field at the middle is off by


@pytest.mark.parametrize(("n", "less", "by_yaw"), [(1, 1.434e-5, 2e-10), (5, 3.588e-4, 1.1e-7), (9, 1.1639e-3, 1.1e-6)])
def test_what_the_volume_takes_from_each_harmonic(n: int, less: float, by_yaw: float) -> None:
    wave, volume = cf.waves(FABRICATED, [(n, 0)], P)[0], CROOKED.volume
    factors = [
        hall_array.average_over_volume(wave, hall_array._about_z(ca.SX(yaw)), volume).cosine / wave.cosine
        for yaw in np.linspace(0, np.pi / 4, 9)
    ]
    losses = 1 - np.array([float(each) for each in factors])
    assert losses[0] == pytest.approx(less, rel=1e-3)
    assert np.ptp(losses) < by_yaw


def test_two_sensors_go_blind_at_a_place_and_three_do_not() -> None:
    scale = np.array([w, w, 1.0])
    place = np.array([l / 8, 3 * l / 8, 0.0])
    for count, blind in ((2, True), (3, False)):
        f = hall_array.planar(hall_array.sensors(PLACES[:count]), FITTED).function()
        s = np.linalg.svd(f(place)[1].full() / scale, compute_uv=False)
        assert (s[-1] < 1e-12 * s[0]) == blind
        nearby = np.linalg.svd(f(place + np.array([1e-3, 0, 0]))[1].full() / scale, compute_uv=False)
        assert nearby[-1] > 1e-3 * nearby[0]


def deviations(count: int, columns: int, at: np.ndarray) -> np.ndarray:
    """Return standard deviations (k, columns) for 1 mV at places (k, 2) in pitches and yaw 0, Cramer-Rao."""
    f = hall_array.planar(hall_array.point_sensors(PLACES[:count]), FITTED).function()
    q = np.column_stack([l * at, np.zeros(len(at))])
    rows = f.map(len(q))(q.T)[1].full().reshape(2 * count, len(q), 3).transpose(1, 0, 2)[:, :, :columns]
    return 1e-3 * np.sqrt(np.linalg.inv(rows.transpose(0, 2, 1) @ rows).diagonal(axis1=1, axis2=2))


def test_known_accuracies_follow_from_the_jacobian() -> None:
    """Yaw known, the worst is where a sensor's slope vanishes and the other's is that at 0, alpha + 5 beta."""
    grid = np.array([[x, y] for x in range(64) for y in range(64)]) / 64
    known = deviations(2, 2, grid)
    assert known.min() == pytest.approx(1.996e-6, abs=5e-10)
    assert known.max() == pytest.approx(1e-3 / (w * (ALPHA + 5 * BETA)), rel=1e-12)
    assert known.max() == pytest.approx(3.595e-6, abs=5e-10)
    worst = deviations(3, 3, np.array([[0.11163, 0.08004], [0.66984, 0.13806], [0.05812, 0.64189]])).diagonal()
    np.testing.assert_allclose(worst, [5.2803e-6, 5.3084e-6, 198.00e-6], rtol=3e-5)
    assert (deviations(3, 3, grid) <= worst * (1 + 1e-6)).all()


def test_a_line_is_the_plane_along_x() -> None:
    line = hall_array.prediction_along_x(0.75 * l, FITTED).function()
    for X in (0.0, 3e-3, 0.4 * l):
        volts, slopes = (each.full().ravel() for each in line(X))
        expected, rows = formula(np.array([X, 0.0, 0.0]), ((0.0, 0.0), (0.75 * l, 0.0)))
        np.testing.assert_allclose(volts, expected[::2], rtol=4e-4)  # of the volume
        np.testing.assert_allclose(slopes, rows[::2, 0], rtol=4e-3)  # five times as much where alpha and beta cancel


def test_gain_offset_and_height_may_be_chosen_and_the_field_symbolic() -> None:
    strong, height = ca.SX.sym("strong"), ca.SX.sym("height")
    waves = cf.waves(cf.fabricated_matrix(strong, P["weak"]), cf.orders_on_axes((1, 5)), P)
    array = HallArray((Sensor((0.0, 0.0, 0.0), gain=(2.0, 1.0), offset=(0.5, 0.0)),), Chain(sensitivity=0.1), POINTS)
    f = hall_array.planar(array, waves, height).function(strong, height)
    q, A = [l / 4, 0.0, 0.0], {n: float(cf.amplitude(cf.waves(FABRICATED, [(n, 0)], P)[0], 5e-3)) for n in (1, 5)}
    assert float(f(q, 1.43, 5e-3)[0][0]) == pytest.approx(0.5 + 2 * 2.1 * (A[1] + A[5]))
    assert float(f(q, 1.50, 5e-3)[0][0]) > float(f(q, 1.43, 5e-3)[0][0])


def test_axes_are_orthonormal_and_turn_with_the_angle() -> None:
    for s in CROOKED.sensors:
        S = hall_array.axes(s)
        np.testing.assert_allclose(S.T @ S, np.eye(3), atol=1e-15)
        assert np.arctan2(S[1, 0], S[0, 0]) == pytest.approx(s.angle + s.misalignment[2], abs=1e-12)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: HallArray(()), "no sensor"),
        (lambda: hall_array.sensors([(0.0, float("nan"))]), "every number must be finite"),
        (lambda: HallArray((Sensor((0, 0, 0), gain=(1.0, float("inf"))),)), "every number must be finite"),
        (lambda: HallArray((Sensor((0, 0, 0)),), volume=(1e-4, -1e-4, 0.0)), "not negative"),
    ],
)
def test_arrays_without_sense_are_refused(make: Callable[[], HallArray], message: str) -> None:
    with pytest.raises(ModelError, match=message):
        make()
