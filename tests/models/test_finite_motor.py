"""Motor maps against the Lorentz integral by quadrature, and the closed force law against both."""

import casadi as ca
import magpylib
import numpy as np
import pytest

from models import finite_matrix, finite_motor, lorentz_motor
from tests.models import finite_oracle as oracle

SERIES = finite_matrix.series(finite_matrix.ideal_blocks(), 16)
V = finite_matrix.VALUES
P = {name: ca.SX(value) for name, value in V.items()}
K = float(lorentz_motor.force_constant(P))
REACH = 0.131
FORCE, TORQUE = 1e-3, 4e-5  # N/A, N m/A: measured 6.3e-4 and 2.2e-5, of 13.7 and 0.3
WIRES = {flat: oracle.conductors(flat) for flat in (True, False)}
PLACES = [(13, -40), (-79, 70), (60, -82)]  # of SERIES' grid; the windings overhang the matrix in the last two


@pytest.fixture(scope="module")
def bars() -> magpylib.Collection:
    return oracle.bars(V["mu0_M0"])


def maps_of_phases(series: finite_matrix.Series, order: finite_motor.Order, flat: bool) -> np.ndarray:
    return np.array([finite_motor.maps(series, p, order, REACH, float(flat)) for p in "ABC"])


def at(values: np.ndarray, place: tuple[int, int]) -> np.ndarray:
    middle = values.shape[-1] // 2
    return values[:, :, middle + place[0], middle + place[1]]


def assert_close(ours: np.ndarray, theirs: np.ndarray, scale: float = 1.0) -> None:
    np.testing.assert_allclose(ours[:, :3], theirs[:, :3], rtol=0, atol=scale * FORCE)
    np.testing.assert_allclose(ours[:, 3:], theirs[:, 3:], rtol=0, atol=scale * TORQUE)


@pytest.mark.parametrize("flat", [True, False])
def test_maps_are_the_lorentz_integral(bars: magpylib.Collection, flat: bool) -> None:
    values = maps_of_phases(SERIES, "value", flat)
    for place in PLACES:
        x, y = (n * SERIES.spacing for n in place)
        assert_close(at(values, place), oracle.wrenches(bars, WIRES[flat], (x, y)))


def test_maps_of_blocks_as_made_are_the_lorentz_integral() -> None:
    series, place = finite_matrix.series(finite_matrix.fabricated_blocks(), 16), (60, -74)
    blocks, wires = oracle.single(finite_matrix.fabricated_blocks()), oracle.conductors(True, 3, 16, 4)
    theirs = oracle.wrenches(blocks, wires, (60 * series.spacing, -74 * series.spacing))
    assert_close(at(maps_of_phases(series, "value", True), place), theirs)


def test_what_end_turns_matter_lies_between_none_and_flat() -> None:
    none, flat = (maps_of_phases(SERIES, "value", f)[1] for f in (False, True))
    raised = finite_motor.maps(SERIES, "B", "value", REACH)
    np.testing.assert_allclose(raised, none + finite_motor.RAISED_END_TURNS * (flat - none), rtol=0, atol=1e-12)
    assert pytest.approx(np.exp(-2 * np.pi / 50.8 * 10.22), rel=1e-4) == finite_motor.RAISED_END_TURNS


def test_the_change_with_lift_and_yaw_is_that_of_the_integral(bars: magpylib.Collection) -> None:
    """By differences over 0.1 mm and 2 mrad, whose third orders are 1e-5 of the whole."""
    place, d, phi = (13, -40), 1e-4, 2e-3
    where = tuple(n * SERIES.spacing for n in place)
    value, lifted, yawed = (at(maps_of_phases(SERIES, order, True), place) for order in finite_motor.ORDERS)
    theirs = {s: oracle.wrenches(bars, WIRES[True], where, lift=s * d) for s in (-1, 1)}
    slope = (theirs[1] - theirs[-1]) / (2 * d)
    assert_close(lifted - finite_motor.DECAY * value, slope, 1000)  # N/(A m), of 1700: over 0.3 mm 3e-4 N/A
    theirs = {s: oracle.wrenches(bars, WIRES[True], where, phi=s * phi) for s in (-1, 1)}
    assert_close(yawed, (theirs[1] - theirs[-1]) / (2 * phi), 10)  # N/(A rad), of 14: over 20 mrad 2e-4 N/A


# The closed law


def driven(bars: magpylib.Collection) -> np.ndarray:
    """Return by quadrature the wrenches (2, 8, 6) per A of i_Q and of i_D at eight places of the middle pitch."""
    wrenches = []
    for y in np.arange(8) * V["l"] / 8 - V["l"] / 2:
        phases = oracle.wrenches(bars, WIRES[False], (3e-3, y))
        currents = [lorentz_motor.phase_currents(ca.SX(q), ca.SX(1 - q), ca.SX(y), P).values() for q in (1, 0)]
        wrenches.append([sum(float(i) * w for i, w in zip(each, phases, strict=True)) for each in currents])
    return np.transpose(wrenches, (1, 0, 2))


def test_the_closed_law_is_the_force_over_a_finite_matrix_of_ideal_blocks(bars: magpylib.Collection) -> None:
    """In the mean of the middle pitch within 0.05 %; 0.6 % of ripple, 0.6 % across and 0.6 % of lift are left out."""
    by_q, by_d = driven(bars)
    assert by_q[:, 1].mean() == pytest.approx(K, rel=5e-4) and by_d[:, 2].mean() == pytest.approx(K, rel=5e-4)
    for main, across in ((by_q[:, 1], by_q[:, 2]), (by_d[:, 2], by_d[:, 1])):
        assert np.abs(main / K - 1).max() < 0.0065 and np.abs(across).max() < 0.0065 * K
    assert np.abs(np.concatenate([by_q, by_d])[:, 0]).max() < 1e-3 * K
    assert np.abs(np.concatenate([by_q, by_d])[:, 5]).max() < 1e-4
    printed = float(lorentz_motor.force_constant(P, "printed"))
    assert abs(by_q[:, 1].mean() / printed - 1) > 0.04  # the factor 1/2 for 3/(2 pi)


def test_ripple_is_that_of_the_fifth_harmonic() -> None:
    """It makes a sixth of the pitch: the closed law with harmonics has it, but for 0.1 % of the windings' ends."""
    pitch = np.arange(-16, 16)
    by_q = finite_motor.commutated_wrenches(maps_of_phases(SERIES, "value", False), SERIES.grid(REACH))[0]
    middle = by_q.shape[-1] // 2
    ours = by_q[1, middle, middle + pitch]
    y, i = ca.SX.sym("y"), ca.SX(1)
    closed = lorentz_motor.forces(y, ca.SX(0), lorentz_motor.phase_currents(i, ca.SX(0), y, P), P, (1, 5, 9))
    theirs = np.array(ca.Function("f", [y], [closed.y]).map(32)(pitch * SERIES.spacing)).ravel()
    spectrum = [np.abs(np.fft.rfft(f)) / 16 / K for f in (ours, theirs)]
    assert spectrum[1][6] == pytest.approx(0.0045, abs=1e-4) and spectrum[0][6] == pytest.approx(
        spectrum[1][6], rel=0.01
    )
    assert np.abs(ours - theirs).max() < 2.5e-3 * K


def test_the_winding_twists_the_platen_about_its_own_centre() -> None:
    """By up to 0.1 N m/A, where a motor's arm makes 0.25: the closed law knows nothing of it. Flat end turns: 0.28."""
    y = SERIES.grid(REACH)
    middle = np.abs(y) <= V["l"] / 2
    for share, motion in ((0.0, 0.0), (1.0, 0.280), (finite_motor.RAISED_END_TURNS, 0.079)):
        phases = np.array([finite_motor.maps(SERIES, p, "value", REACH, share) for p in "ABC"])
        torque = finite_motor.commutated_wrenches(phases, y)[:, 3:][:, :, middle][:, :, :, middle]
        largest = np.abs(torque).max(axis=(0, 2, 3))
        np.testing.assert_allclose(largest[:2], [0.095, motion], rtol=0, atol=2e-3)
        assert largest[2] < 2e-4


def test_force_near_the_edge_falls_off() -> None:
    """Half the winding is over the edge at y = -158.75 + 12.7 / 2 mm: half the force, within what an end adds."""
    y = SERIES.grid(0.165)
    phases = np.array([finite_motor.maps(SERIES, p, "value", 0.165, 0.0) for p in "ABC"])
    force = finite_motor.commutated_wrenches(phases, y)[0, 1, len(y) // 2] / K
    edge = -finite_matrix.SIDE * (finite_matrix.BEFORE + 0.5)
    assert force[np.argmin(np.abs(y - edge))] == pytest.approx(0.5, abs=0.1)
    assert np.abs(force[np.abs(y) < 0.08] - 1).max() < 0.02
