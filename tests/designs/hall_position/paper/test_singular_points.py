"""All points at which two sensors lose rank, against searches from random starts and the sensor model's Jacobian."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from designs.hall_position.paper import fisher, sensor_accuracy, singular_points
from models import concentrated_field, hall_array
from models.hall_two_waves import PlanarArray as Array
from synth.errors import ModelError

l, ALPHA, BETA = 50.8e-3, 8.4 * 0.37502, -8.4 * 0.02146
PLACES = ((-0.375 * l, -0.375 * l), (0.375 * l, 0.375 * l))
PAIR = Array(PLACES, 0.0, ALPHA, BETA)
WAVES = concentrated_field.waves_from_amplitudes({1: ALPHA / 8.4, 5: BETA / 8.4}, 3e-3, concentrated_field.values())


def test_the_published_point_is_exact_and_one_of_many() -> None:
    points = singular_points.of_pair(PAIR, 0.0)
    assert len(points) == 64
    off = np.abs(points - [l / 8, 3 * l / 8]).max(axis=1)
    assert off.min() < 1e-17  # an ulp of the place


@pytest.mark.parametrize("yaw", [0.0, 0.05, -0.7])
def test_the_sensor_model_loses_rank_there(yaw: float) -> None:
    points = singular_points.of_pair(PAIR, yaw)
    sensors = hall_array.point_sensors(PLACES)
    poses = np.column_stack([points, np.full(len(points), yaw)])
    assert len(poses) and (sensor_accuracy.of_sensors(sensors, WAVES, poses, 0.01).condition > 1e12).all()


def determinants(yaw: float) -> ca.Function:
    """Return D_X, D_Y of phases, written once more, with their derivatives."""
    p = ca.SX.sym("p", 2)
    c, s = np.cos(yaw), np.sin(yaw)
    B = lambda t: ALPHA * ca.sin(t) + BETA * ca.sin(5 * t)  # noqa: E731
    slope = lambda t: ALPHA * ca.cos(t) + 5 * BETA * ca.cos(5 * t)  # noqa: E731
    x, y = [], []
    for r in 2 * np.pi / l * np.array(PLACES):
        o = c * r[0] - s * r[1], s * r[0] + c * r[1]
        u, v = p[0] + o[0], p[1] + o[1]
        x.append((slope(u), B(v) - slope(u) * o[1]))
        y.append((slope(v), slope(v) * o[0] - B(u)))
    D = ca.vertcat(*(a[0] * b[1] - b[0] * a[1] for a, b in (x, y)))
    return ca.Function("D", [p], [D, ca.jacobian(D, p)])


@pytest.mark.parametrize("yaw", [0.0, 0.05])
def test_no_drawn_start_leads_elsewhere(yaw: float) -> None:
    known, D = singular_points.of_pair(PAIR, yaw), determinants(yaw)
    at = np.random.default_rng(2).uniform(0, 2 * np.pi, (2, 600))
    many = D.map(at.shape[1])
    for _ in range(25):
        value, J = (each.full() for each in many(at))
        at = at - np.einsum("nij,jn->in", np.linalg.pinv(J.reshape(2, -1, 2).transpose(1, 0, 2)), value)
    ends = at[:, np.abs(many(at)[0].full()).max(axis=0) < 1e-10]
    off = (ends.T[:, None] - 2 * np.pi / l * known + np.pi) % (2 * np.pi) - np.pi
    near = np.abs(off).max(axis=2)
    assert near.min(axis=1).max() < 1e-5
    assert len(set(near.argmin(axis=1).tolist())) > 0.9 * len(known)


def test_cells_are_only_left_out_where_there_is_no_point() -> None:
    points = singular_points.of_pair(PAIR, 0.05) * 2 * np.pi / l
    rng = np.random.default_rng(4)
    for half in (0.05, 0.01, 1e-3):
        cells = points.T + rng.uniform(-half, half, points.T.shape)
        assert singular_points.possible(PAIR, 0.05, cells, half).all()


def test_half_a_pitch_apart_a_line_is_lost() -> None:
    with pytest.raises(ModelError, match=r"at X = .* no slope along X, which is not observable on this whole line"):
        singular_points.of_pair(replace(PAIR, positions=((0.0, 0.0), (l / 2, 0.3 * l))), 0.0)


def test_three_sensors_are_refused() -> None:
    with pytest.raises(ModelError, match="3 sensors"):
        singular_points.of_pair(replace(PAIR, positions=(*PLACES, (0.0, 0.01))), 0.0)


def test_deviations_have_no_bound_at_the_points() -> None:
    points = singular_points.of_pair(PAIR, 0.05)
    q = np.vstack([points.T, np.full(len(points), 0.05)])
    assert (fisher.deviations(PAIR, q)[2] > 1e3).all()
    assert (fisher.deviations(PAIR, q + np.array([[1e-4], [0.0], [0.0]]))[2] < 1.0).all()
