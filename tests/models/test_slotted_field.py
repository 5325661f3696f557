"""The slotted field against a mode-matching solution, the smooth-gap series, virtual work and the published motor.

Mode matching shares nothing with the grid: Fourier harmonics in the gap, cosine modes in the slots, Galerkin's
condition on the openings, stress from the harmonics. Its error falls as modes^(-4/3), because of the tooth corners.
"""

from __future__ import annotations

from dataclasses import astuple, fields, replace

import numpy as np
import pytest
from scipy.sparse.linalg import splu

from models import slotted_field as sf
from models import slotted_grid

pytestmark = pytest.mark.whole

MOTOR = sf.Geometry()
SMOOTH = replace(MOTOR, b0=1e-4 * MOTOR.t1, slot_depth=2e-4 * MOTOR.t1)
GAPS = (20e-3, 25e-3, 30e-3)


def by_modes(motor: sf.Geometry, gap: float, modes: int) -> np.ndarray:
    """Return thrust, vertical, attraction, lift and cogging as `forces` does; needs mu_rec = 1."""
    tau, b, H = motor.tau, motor.opening, motor.h_m + gap
    n = np.arange(-60 * modes + 1, 60 * modes, 2)
    k, a, left = n * np.pi / tau, abs(n) * np.pi / tau, np.arange(3) * tau / 3
    m = np.arange(modes + 1)
    w = np.add.outer(k, -m * np.pi / b), np.add.outer(k, m * np.pi / b)
    single = sum(b * np.exp(-1j * v * b / 2) * np.sinc(v * b / (2 * np.pi)) for v in w) / 2
    P = (np.exp(-1j * np.outer(k, left))[:, :, None] * single[:, None, :]).reshape(len(n), -1)
    order, gain = np.tile(m, 3), 1 / np.tanh(a * H) / a
    free = order > 0
    slot = np.zeros(len(order))
    slot[free] = b * b / (2 * np.pi * order[free]) / np.tanh(order[free] * np.pi * motor.slot_depth / b)
    K = (P.conj().T @ (P * gain[:, None])).real / tau

    def field(ampere_turns: np.ndarray, A_0: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        c = np.zeros(len(order))
        c[~free] = sf.MU0 * ampere_turns / b
        known = K[np.ix_(free, ~free)] @ c[~free] + (P.conj().T @ A_0).real[free]
        c[free] = np.linalg.solve((K + np.diag(slot))[np.ix_(free, free)], -known)
        B_x = P @ c / tau
        keep = abs(n) < 60
        return B_x[keep], (-1j * k * (B_x * gain + A_0))[keep]

    def stress(u: tuple[np.ndarray, np.ndarray], v: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
        scale = motor.L_A * motor.p_m * tau / sf.MU0 / 2
        along = np.sum(u[0] * v[1].conj() + v[0] * u[1].conj()).real
        return scale * np.array([along, np.sum(u[1] * v[1].conj() - u[0] * v[0].conj()).real])

    sheet = np.exp(-a * gap) * (1 - np.exp(-2 * a * motor.h_m)) / (1 - np.exp(-2 * a * H))
    B_n = sf.MU0 * motor.H_c * 4 / (abs(n) * np.pi) * np.sin(abs(n) * np.pi * motor.tau_p / 2 / tau) * sheet
    rows, x_s, N = [], left + b / 2, 2 * motor.W / motor.poles
    for x_m in b / 2 + tau / 3 * np.arange(6) / 6:
        none, angle = np.zeros_like(k), np.pi / tau * (x_s - x_m)
        magnet = field(np.zeros(3), -B_n / 2 / (1j * k) * np.exp(-1j * k * x_m))
        d, q = field(N * np.sin(angle), none), field(N * np.cos(angle), none)
        alone = stress(magnet, magnet)
        rows.append([2 * stress(magnet, q)[0], -2 * stress(magnet, d)[1], stress(d, d)[1], alone[1], alone[0]])
    table = np.array(rows)
    return np.r_[table[:, :4].mean(axis=0), abs(np.fft.rfft(table[:, 4])[1]) / 3]


def extrapolate_by_modes(motor: sf.Geometry, gap: float) -> np.ndarray:
    coarse, fine = by_modes(motor, gap, 20), by_modes(motor, gap, 40)
    return fine + (fine - coarse) / (2 ** (4 / 3) - 1)


def smooth_series(motor: sf.Geometry, gap: float) -> np.ndarray:
    """Return thrust, vertical, attraction and lift without slots, for line currents on the stator's face."""
    n = np.arange(1, 400, 2)
    k, H, N = n * np.pi / motor.tau, motor.h_m + gap, 2 * motor.W / motor.poles
    ratio = np.exp(-k * gap) * (1 - np.exp(-2 * k * motor.h_m)) / (1 - np.exp(-2 * k * H))
    B = 4 / np.pi * sf.MU0 * motor.H_c * np.sin(n * np.pi * motor.tau_p / 2 / motor.tau) / n * ratio
    thrust = motor.L_A * motor.p_m * 1.5 * N * B[0]
    area = motor.L_A * motor.p_m * motor.tau
    sheet = np.where(n % 3 == 0, 0.0, 3 * N / motor.tau)
    csch2 = (2 * np.exp(-k * H) / (1 - np.exp(-2 * k * H))) ** 2
    return np.array(
        [
            thrust,
            thrust / np.tanh(k[0] * H),
            area * sf.MU0 / 4 * np.sum(sheet**2 * csch2),
            area / 4 / sf.MU0 * np.sum(B**2),
        ]
    )


def miss(forces: sf.Forces, expected: np.ndarray) -> float:
    return float(np.max(np.abs(np.array(astuple(forces))[: len(expected)] / expected - 1)))


@pytest.fixture(scope="module")
def converged_forces() -> dict[float, sf.Converged]:
    return {gap: sf.extrapolate(MOTOR, gap) for gap in GAPS}


@pytest.fixture(scope="module")
def modal() -> dict[float, np.ndarray]:
    return {gap: extrapolate_by_modes(MOTOR, gap) for gap in GAPS}


@pytest.mark.parametrize("gap", GAPS)
def test_mode_matching_agrees(
    gap: float, converged_forces: dict[float, sf.Converged], modal: dict[float, np.ndarray]
) -> None:
    """The cogging is held less tightly: 1e-4 is about what either method still changes in it when refined."""
    forces = converged_forces[gap]
    assert miss(forces.value, modal[gap][:4]) < 5e-5
    assert miss(forces.value, modal[gap]) < 3e-4
    assert np.all(np.abs(np.array(astuple(forces.value)) - modal[gap]) < np.array(astuple(forces.error)))


def test_smooth_gap_agrees_with_the_series() -> None:
    assert miss(sf.extrapolate(SMOOTH, 25e-3).value, smooth_series(SMOOTH, 25e-3)) < 2e-3
    assert miss(sf.extrapolate(MOTOR, 25e-3).value, smooth_series(MOTOR, 25e-3)) > 0.05


def test_recoil_permeability_agrees_with_the_two_layer_solution() -> None:
    motor, gap = replace(SMOOTH, mu_rec=1.3, tau_p=MOTOR.tau * (1 - 1e-6)), 25e-3
    n = np.arange(1, 400, 2)
    k = n * np.pi / motor.tau
    t_g, t_m = np.tanh(k * gap), np.tanh(k * motor.h_m)
    B = 4 / np.pi * sf.MU0 * motor.H_c * np.sin(n * np.pi / 2) / n
    B *= motor.mu_rec * t_m / (t_m + motor.mu_rec * t_g) / np.cosh(np.minimum(k * gap, 300))
    lift = motor.L_A * motor.p_m * motor.tau / 4 / sf.MU0 * np.sum(B**2)
    assert sf.extrapolate(motor, gap).value.lift == pytest.approx(lift, rel=2e-3)
    assert sf.extrapolate(replace(motor, mu_rec=1.0), gap).value.lift != pytest.approx(lift, rel=2e-2)


def test_mode_matching_catches_closed_slots(modal: dict[float, np.ndarray]) -> None:
    assert miss(sf.forces(SMOOTH, 25e-3, 8), modal[25e-3][:4]) > 0.05


def _field(gap: float, x_m: float, ampere_turns: np.ndarray, cells: int) -> sf.Field:
    g = sf.grid(MOTOR, gap, cells)
    currents = sf.magnet_currents(g, MOTOR, x_m) + sf.slot_currents(g, ampere_turns)
    return sf.solve(g, splu(sf.matrix(g, MOTOR, x_m)), currents)


def test_stress_is_the_slope_of_the_coenergy() -> None:
    """Along x only what the currents add is compared: a sheet's energy in its own field varies within a cell."""
    gap, x_m, turns = 22e-3, 17.3e-3, np.array([900.0, -1500.0, 400.0])

    def force(i: np.ndarray) -> np.ndarray:
        return np.array(sf.stress(MOTOR, *[_field(gap, x_m, i, 24)] * 2))

    def energy(g: float, x: float, i: np.ndarray) -> float:
        field = _field(g, x, i, 24)
        return float(MOTOR.L_A * MOTOR.p_m * np.sum(field.I * field.A) / 2)

    def added(x: float) -> float:
        return energy(gap, x, turns) - energy(gap, x, 0 * turns)

    along = (added(x_m + 1e-4) - added(x_m - 1e-4)) / 2e-4
    upwards = (energy(gap - 1e-4, x_m, turns) - energy(gap + 1e-4, x_m, turns)) / 2e-4
    assert along == pytest.approx((force(turns) - force(0 * turns))[0], rel=2e-3)
    assert upwards == pytest.approx(force(turns)[1], rel=2e-3)


def test_stress_does_not_depend_on_its_line() -> None:
    field = _field(25e-3, 0.0, np.array([900.0, -1500.0, 400.0]), 24)
    other = replace(field, grid=replace(field.grid, middle=field.grid.middle - 20))
    assert sf.stress(MOTOR, other, other) == pytest.approx(sf.stress(MOTOR, field, field), rel=2e-3)


def _order() -> float:
    lift = [sf.forces(MOTOR, 25e-3, cells).lift for cells in (6, 12, 24)]
    return float(np.log2((lift[1] - lift[0]) / (lift[2] - lift[1])))


def test_order_is_two_and_needs_the_grading(monkeypatch: pytest.MonkeyPatch) -> None:
    assert _order() == pytest.approx(2.0, abs=0.15)
    monkeypatch.setattr(slotted_grid, "_graded_at_both_ends", lambda n: np.linspace(0.0, 1.0, n + 1))
    assert _order() < 1.75


def test_cogging_has_the_slot_pitch_and_no_mean() -> None:
    g = sf.grid(MOTOR, 20e-3, 12)
    lu = splu(sf.matrix(g, MOTOR, 0.0))
    x = sf.slot_positions(MOTOR)[0] + MOTOR.tau / 3 * np.arange(12) / 12

    def cogging(x_m: float) -> float:
        return sf.stress(MOTOR, *[sf.solve(g, lu, sf.magnet_currents(g, MOTOR, x_m))] * 2)[0]

    wave = np.array([cogging(x_m) for x_m in x])
    assert cogging(x[1] + MOTOR.tau / 3) == pytest.approx(wave[1], rel=1e-6)
    assert abs(wave.mean()) < 1e-6
    assert wave.max() == pytest.approx(sf.forces(MOTOR, 20e-3, 12).cogging, rel=5e-3)


def test_slot_depth_does_not_matter() -> None:
    two, three = (sf.extrapolate(replace(MOTOR, slot_depth=depth * MOTOR.b0), 20e-3, 16).value for depth in (2, 3))
    shallow = sf.extrapolate(replace(MOTOR, slot_depth=0.5 * MOTOR.b0), 20e-3).value
    assert miss(three, np.array(astuple(two))) < 1e-4
    assert miss(shallow, np.array(astuple(two))) > 5e-3


def _changes(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the relative changes of the forces for 0.5 and 1 % more of one dimension."""
    base, half, full = (
        np.array(astuple(sf.forces(replace(MOTOR, **{name: getattr(MOTOR, name) * f}), 25e-3, 8)))
        for f in (1.0, 1.005, 1.01)
    )
    return half / base - 1, full / base - 1


def _bend(name: str) -> float:
    """Return the largest departure from proportion among the forces' relative changes, cogging apart."""
    half, full = _changes(name)
    return float(np.max(abs(full - 2 * half)[:4]))


@pytest.mark.parametrize("name", [f.name for f in fields(sf.Geometry) if f.name != "slot_depth"])
def test_each_dimension_moves_the_forces_smoothly(name: str) -> None:
    assert np.max(abs(_changes(name)[1])) > 1e-3
    assert _bend(name) < 2e-4


def test_published_motor(converged_forces: dict[float, sf.Converged]) -> None:
    """Converged figures; closed form at 25 mm: thrust 12.488, vertical 13.446 N per rms A, lift 25.937 N."""
    at = {gap: c.value for gap, c in converged_forces.items()}
    assert at[25e-3].thrust == pytest.approx(9.0833, rel=1e-4)
    assert at[25e-3].vertical == pytest.approx(9.6728, rel=1e-4)
    assert at[25e-3].attraction == pytest.approx(0.119342, rel=1e-4)
    assert [at[gap].lift for gap in GAPS] == pytest.approx([42.250, 23.188, 13.013], rel=1e-4)
    assert [at[gap].cogging for gap in GAPS] == pytest.approx([0.08902, 0.015658, 0.002854], rel=1e-3)
    assert 12.488 / np.sqrt(2) / at[25e-3].thrust == pytest.approx(0.972, abs=1e-3)
    assert 13.446 / np.sqrt(2) / at[25e-3].vertical == pytest.approx(0.983, abs=1e-3)
    assert [closed / at[gap].lift for closed, gap in zip((47.111, 25.937, 14.603), GAPS, strict=True)] == pytest.approx(
        [1.115, 1.1185, 1.122], abs=1e-3
    )


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"b0": 19.1e-3}, "reduce b0"),
        ({"tau_p": 60e-3}, "reduce tau_p"),
        ({"H_c": -1.0}, "H_c"),
        ({"h_m": np.nan}, "h_m"),
    ],
)
def test_impossible_motor_is_refused(change: dict[str, float], word: str) -> None:
    with pytest.raises(ValueError, match=word):
        sf.forces(replace(MOTOR, **change), 25e-3)


def test_impossible_gap_and_grid_are_refused() -> None:
    with pytest.raises(ValueError, match="gap"):
        sf.forces(MOTOR, 0.0)
    with pytest.raises(ValueError, match="cells"):
        sf.forces(MOTOR, 25e-3, 1)
