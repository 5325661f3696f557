"""The force law against Maxwell's stress of the composed field, and against figures at six gaps."""

import math

import casadi as ca
import numpy as np
import pytest

from models import pmlsm

NOMINAL = {p.name: p.value for p in pmlsm.PARAMETERS}
SMOOTH = NOMINAL | {"b0": 1e-7}  # no slots: lambda = K_c = 1 to 1e-9
WEIGHT = 6.9 * 9.81  # N


def stress_forces(g: float, i_d: float, i_q: float, height: float) -> tuple[float, float]:
    """Return (|F_H|, F_V) by integrating Maxwell's stress over the plane `height` of the way through the gap.

    Two irons of infinite permeability, charge sheets as magnets, a current sheet at the stator; nothing but Table I.
    """
    T = NOMINAL
    k, D, mu0 = math.pi / T["tau"], T["h_m"] + g, T["mu0"]
    x = (np.arange(720) + 0.5) / 720 * 2 * T["tau"]
    magnets = np.where(np.abs((x / T["tau"] + 0.5) % 1 - 0.5) < T["tau_p"] / T["tau"] / 2, 1.0, 0.0)
    exact = 2 / math.pi * 2 * math.sin(math.pi * T["tau_p"] / 2 / T["tau"])
    sampled = 2 * np.mean(magnets * np.sign(np.cos(k * x)) * np.cos(k * x))
    assert sampled == pytest.approx(exact, rel=2e-2)
    # Potential a sinh(k y) below the magnets' tops, b sinh(k (y - D)) above: continuous, and B_y jumps by the charge.
    top = T["h_m"]
    system = [[math.sinh(k * top), -math.sinh(k * (top - D))], [-k * math.cosh(k * top), k * math.cosh(k * (top - D))]]
    _, b = np.linalg.solve(system, [0.0, mu0 * T["H_c"] * exact])
    sheet = mu0 * k * 1.5 * 4 / math.pi * (T["W"] / 6) * math.sqrt(2)  # T per A rms at the stator: 6 poles in series
    y = top + height * g
    currents = -i_d * np.cos(k * x) + i_q * np.sin(k * x)
    slopes = i_d * np.sin(k * x) + i_q * np.cos(k * x)
    scale = sheet / math.sinh(k * D)
    B_y = b * k * math.cosh(k * (y - D)) * np.cos(k * x) + scale * math.cosh(k * y) * currents
    B_x = -b * k * math.sinh(k * (y - D)) * np.sin(k * x) + scale * math.sinh(k * y) * slopes
    area = T["p_m"] * T["L_A"] * T["tau"]
    return area * abs(np.mean(B_x * B_y)) / mu0, -area * np.mean(B_y**2 - B_x**2) / (2 * mu0)


def law(g: float, i_d: float, i_q: float, variant: pmlsm.Variant) -> tuple[float, float]:
    F_H, F_V = pmlsm.thrust(g, i_q, SMOOTH, variant), pmlsm.normal_force(g, i_d, i_q, SMOOTH, variant)
    return abs(float(F_H)), float(F_V)


CASES = [(0.0124, 1.0, 4.0), (0.025, -3.0, 2.0), (0.0366, 4.5, -1.0), (0.02, 0.0, 0.0)]


@pytest.mark.parametrize("height", [0.1, 0.5, 0.9])
@pytest.mark.parametrize(("g", "i_d", "i_q"), CASES)
def test_forces_are_maxwells_stress(g: float, i_d: float, i_q: float, height: float) -> None:
    assert law(g, i_d, i_q, pmlsm.STRESS) == pytest.approx(stress_forces(g, i_d, i_q, height), rel=1e-8, abs=1e-9)


@pytest.mark.parametrize(
    "variant", [pmlsm.Variant(lv3="coth2"), pmlsm.Variant(kv2_power=2), pmlsm.Variant(p_counts="pole_pairs")]
)
def test_each_printed_reading_contradicts_maxwells_stress(variant: pmlsm.Variant) -> None:
    assert law(0.025, 2.0, 3.0, variant) != pytest.approx(stress_forces(0.025, 2.0, 3.0, 0.5), rel=0.02)


GAP_TABLE = [  # mm: B_pmy1 T, F0 N, 4 F0 / weight, dF_V/di_d N/A, F_H N/A
    (18, 0.16923, 60.423, 3.5706, 21.730, 18.519),
    (20, 0.14906, 47.111, 2.7840, 18.778, 16.518),
    (25, 0.11005, 25.937, 1.5327, 13.446, 12.488),
    (30, 0.08227, 14.603, 0.8629, 9.9059, 9.4923),
    (31, 0.07769, 13.040, 0.7706, 9.3391, 8.9890),
    (33, 0.06934, 10.411, 0.6152, 8.3141, 8.0630),
]


@pytest.mark.parametrize(("mm", "field", "attraction", "ratio", "lift", "push"), GAP_TABLE)
def test_figures_at_six_gaps(mm: int, field: float, attraction: float, ratio: float, lift: float, push: float) -> None:
    g = mm * 1e-3
    F0 = -pmlsm.normal_force(g, 0.0, 0.0, NOMINAL)
    slope = (pmlsm.normal_force(g, 1e-3, 0.0, NOMINAL) - pmlsm.normal_force(g, -1e-3, 0.0, NOMINAL)) / 2e-3
    values = (pmlsm.magnet_field(g, NOMINAL), F0, 4 * F0 / WEIGHT, slope, -pmlsm.thrust(g, 1.0, NOMINAL))
    assert [float(v) for v in values] == pytest.approx([field, attraction, ratio, lift, push], rel=1e-4)


@pytest.mark.parametrize("g", [0.0124, 0.018, 0.025, 0.0366])
def test_the_constants_belong_together(g: float) -> None:
    K, L = pmlsm.constants(NOMINAL), pmlsm.coefficients(g, NOMINAL)
    mixed = pmlsm.permeance_factor(g, NOMINAL) * pmlsm.magnet_field(g, NOMINAL) / pmlsm.carter_coefficient(g, NOMINAL)
    assert K.K_v2**2 == pytest.approx(4 * K.K_v1 * K.K_v3, rel=1e-13)
    assert K.K_h * L.L_h == pytest.approx(K.K_v2 * mixed, rel=1e-13)
    printed = pmlsm.constants(NOMINAL, pmlsm.Variant(kv2_power=2))
    assert printed.K_v2**2 != pytest.approx(4 * printed.K_v1 * printed.K_v3, rel=0.5)


@pytest.mark.parametrize(("power", "real"), [(1, True), (2, False)])
def test_the_printed_square_leaves_no_holding_current_at_25_mm(power: int, real: bool) -> None:
    variant = pmlsm.Variant(lv3="coth2", kv2_power=2 if power == 2 else 1)
    K, L = pmlsm.constants(NOMINAL, variant), pmlsm.coefficients(0.025, NOMINAL, variant)
    deficit = K.K_v1 * L.L_v1 - WEIGHT / 4
    assert ((K.K_v2 * L.L_v2) ** 2 >= 4 * K.K_v3 * L.L_v3 * deficit) is real


def test_three_pole_pairs_for_p_double_the_thrust() -> None:
    variant = pmlsm.Variant(p_counts="pole_pairs")
    assert -pmlsm.thrust(0.025, 1.0, NOMINAL, variant) == pytest.approx(24.976, abs=5e-4)


def test_winding_factor() -> None:
    assert pmlsm.winding_factor(NOMINAL) == pytest.approx(1.0, rel=1e-15)
    two_slots = np.abs(np.mean(np.exp(1j * np.pi / 6 * np.arange(2))))  # two coils 30 degrees apart
    assert pmlsm.winding_factor(NOMINAL | {"z1": 36.0}) == pytest.approx(two_slots, rel=1e-12)
    assert pmlsm.winding_factor(NOMINAL | {"w_c": NOMINAL["tau"] * 2 / 3}) == pytest.approx(math.sin(math.pi / 3))


@pytest.mark.parametrize("name", NOMINAL)
def test_every_parameter_counts(name: str) -> None:
    changed = NOMINAL | {name: NOMINAL[name] * 1.01}
    forces = [pmlsm.normal_force(0.025, 1.0, 1.0, p) for p in (NOMINAL, changed)]
    assert abs(forces[0] / forces[1] - 1) > 1e-6


def test_symbols_and_numbers_agree() -> None:
    p = {name: ca.SX.sym(name) for name in NOMINAL}
    g = ca.SX.sym("g")
    F = ca.Function("F", [g, ca.vcat(list(p.values()))], [pmlsm.normal_force(g, 1.5, -2.0, p)])
    expected = pmlsm.normal_force(0.021, 1.5, -2.0, NOMINAL)
    assert float(F(0.021, list(NOMINAL.values()))) == pytest.approx(expected, rel=1e-14)


# Table I, and motors whose slots, magnets and winding are others.
MOTORS = [
    {},
    {"b0": 6e-3},
    {"mu_rec": 1.1, "h_m": 7e-3},
    {"tau": 0.07, "w_c": 0.05, "z1": 36.0},
    {"H_c": 5e5, "p": 4.0},
]
GAPS = np.linspace(0.0124, 0.0366, 30).tolist()


def law_errors(changed: dict[str, float], variant: pmlsm.Variant) -> np.ndarray:
    """Return how far a, b, c and h of the force law are from constants times coefficients, relatively, at most."""
    p, worst = NOMINAL | changed, np.zeros(4)
    K = pmlsm.constants(p, variant)
    for g in GAPS:
        law, L = pmlsm.force_law(g, p), pmlsm.coefficients(g, p, variant)
        ours = np.array([2 * law.half_a, law.b, 2 * law.half_c, law.h], dtype=float)
        printed = np.array([K.K_v1 * L.L_v1, K.K_v2 * L.L_v2, K.K_v3 * L.L_v3, K.K_h * L.L_h], dtype=float)
        worst = np.maximum(worst, np.abs(ours / printed - 1))
    return worst


@pytest.mark.parametrize("changed", MOTORS)
def test_the_force_law_is_constants_times_coefficients(changed: dict[str, float]) -> None:
    assert law_errors(changed, pmlsm.STRESS).max() < 1e-14
    assert (law_errors(changed, pmlsm.Variant("coth2")) > 1e-2).tolist() == [False, False, True, False]


def test_another_power_of_p_has_another_force_law() -> None:
    assert (law_errors({}, pmlsm.Variant(kv2_power=2)) > 1).tolist() == [False, True, False, False]


@pytest.mark.parametrize("changed", MOTORS)
def test_lift_thrust_and_attractions_are_sides_of_one_triangle(changed: dict[str, float]) -> None:
    """b^2 = h^2 + 4 a c, from the printed factors alone; not so with coth^2."""
    p = NOMINAL | changed
    for variant, holds in ((pmlsm.STRESS, True), (pmlsm.Variant("coth2"), False)):
        K = pmlsm.constants(p, variant)
        for g in GAPS:
            L = pmlsm.coefficients(g, p, variant)
            b, h, ac = K.K_v2 * L.L_v2, K.K_h * L.L_h, K.K_v1 * L.L_v1 * K.K_v3 * L.L_v3
            assert (abs((h**2 + 4 * ac) / b**2 - 1) < 1e-14) is holds


def test_the_ratio_of_the_force_law_grows_slowly_with_the_gap() -> None:
    """half_a / h^2 has lost the exponentials of the gap: a polynomial of low degree will do for it."""
    laws = [pmlsm.force_law(g, NOMINAL) for g in GAPS]
    np.testing.assert_allclose([float(f.ratio) for f in laws], [float(f.half_a / f.h**2) for f in laws], rtol=1e-14)
    ratios = [float(f.ratio) for f in laws]
    assert max(ratios) < 1.25 * min(ratios) and float(laws[0].half_a) > 10 * float(laws[-1].half_a)


def test_a_motor_carries_its_load_by_the_current_of_the_balance_and_by_no_other() -> None:
    p = {name: ca.SX(value) for name, value in NOMINAL.items()}
    balance = pmlsm.balance(ca.SX(WEIGHT / 4), p)(0.025)
    assert balance.current == pytest.approx(0.67864, abs=1e-5) and balance.discriminant > 0
    for i_d, rests in ((balance.current, True), (-balance.current, False)):
        force = float(pmlsm.normal_force(ca.SX(0.025), ca.SX(i_d), ca.SX(0), p)) + WEIGHT / 4
        assert (abs(force) < 1e-11) == rests
    lost = pmlsm.balance(ca.SX(-1e4), p)(0.025)
    assert lost.discriminant < 0 and math.isnan(lost.current)
