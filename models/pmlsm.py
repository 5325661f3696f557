"""Forces of one iron-cored permanent-magnet linear synchronous motor (PMLSM).

    stator iron, slotted, with currents   ^ F_V < 0 : the mover is attracted, the gap g closes
    ------------------------------------  |
          g                               v F_V > 0 : the gap opens; down, for a mover that hangs below its stator
    ====== magnets, height h_m =========
    mover iron                            --> F_H along the motion

    (1) F_H = -K_h L_h(g) i_q
    (2) F_V = -K_v1 L_v1(g) + K_v2 L_v2(g) i_d - K_v3 L_v3(g) (i_d^2 + i_q^2)

g is the gap in m; i_d, i_q are rms currents in A (a phase peaks at sqrt(2) i); forces are in N; k = pi/tau.

Every function takes `p`, the parameters by name: symbols or numbers.

Variants of the printed formulas. The paper says "3 pole pairs" for p, K_v2 ~ 1/p^2 and L_v3 ~ coth^2. Maxwell's stress
of a current sheet between two iron faces gives p = 6 poles, K_v2 ~ 1/p (only then K_v2^2 = 4 K_v1 K_v3) and L_v3 ~
csch^2: the tangential field on the sheet lowers the attraction by the missing coth^2 - csch^2 = 1. `Variant` names each
choice.

Source: Fulford, Maggiore, Apkarian, "Control of a 5DOF Magnetically Levitated Positioning Stage", (1)-(4), Table I.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import nan, pi, sqrt
from typing import Literal

import casadi as ca

from synth.block import Constant, Exprs
from synth.plant import Plant
from synth.signals import Parameter


@dataclass(frozen=True)
class Variant:
    """A variant of the printed formulas; the default is the one that follows from Maxwell's stress.

    `lv3` is the factor in L_v3, `kv2_power` the power of p in K_v2, `p_counts` the meaning of p in (3) and (4).
    """

    lv3: Literal["csch2", "coth2"] = "csch2"
    kv2_power: Literal[1, 2] = 1
    p_counts: Literal["poles", "pole_pairs"] = "poles"


STRESS = Variant()
PRINTED = Variant("coth2", 2, "pole_pairs")

TABLE = "Table I"
PARAMETERS = (
    Parameter("b0", 12.7e-3, "m", 4e-3, TABLE),  # stator slot width
    Parameter("t1", 19.05e-3, "m", 3e-4, TABLE),  # stator slot pitch
    Parameter("W", 900.0, "1", 0.0, TABLE),  # turns per phase
    Parameter("w_c", 57.15e-3, "m", 1e-4, TABLE),  # coil pitch
    Parameter("p", 6.0, "1", 0.0, "Table I prints 3 pole pairs; (3) and (4) hold for the 6 poles"),
    Parameter("z1", 18.0, "1", 0.0, TABLE),  # stator slots
    Parameter("h_m", 5e-3, "m", 0.1, TABLE),  # magnet height
    Parameter("L_A", 50e-3, "m", 0.01, TABLE),  # magnet length
    Parameter("p_m", 4.0, "1", 0.0, TABLE),  # magnets
    Parameter("tau", 57.15e-3, "m", 1e-4, TABLE),  # pole pitch
    Parameter("tau_p", 28.58e-3, "m", 2e-4, TABLE),  # magnet width
    Parameter("H_c", 875400.0, "A/m", 6e-5, "Table I; also taken as the magnets' surface charge sigma_m in (4)"),
    Parameter("mu_rec", 1.0, "1", 0.05, "not printed: charge sheets, as in (4), have that of air"),
    Parameter("mu0", 4e-7 * pi, "N/A^2", 1e-9, "CODATA 2018"),
)


@dataclass(frozen=True, eq=False)
class Constants:
    """The factors of (1) and (2) that do not depend on the gap: K_h N/A, K_v1 N/T^2, K_v2 N/(A T), K_v3 N/A^2."""

    K_h: ca.SX
    K_v1: ca.SX
    K_v2: ca.SX
    K_v3: ca.SX


@dataclass(frozen=True, eq=False)
class Coefficients:
    """The factors of (1) and (2) that depend on the gap: L_h 1, L_v1 T^2, L_v2 T, L_v3 1."""

    L_h: ca.SX
    L_v1: ca.SX
    L_v2: ca.SX
    L_v3: ca.SX


@dataclass(frozen=True, eq=False)
class ForceLaw:
    """One motor at its gap: F_V = -a + b i_d - c (i_d^2 + i_q^2), F_H = -h i_q; a N, b N/A, c N/A^2, h N/A.

    `half_a` and `half_c` are a/2 and c/2, `ratio` is half_a/h^2 in A^2/N.
    """

    half_a: ca.SX
    half_c: ca.SX
    b: ca.SX
    h: ca.SX
    ratio: ca.SX


def winding_factor(p: Exprs) -> ca.SX:
    """Return k_w1: pitch factor sin(pi w_c / (2 tau)) times the distribution factor of q = z1/(3 p) slots.

    Both factors are 1 for full pitch and one slot per pole and phase, as here.
    """
    q = p["z1"] / (3 * p["p"])
    return ca.sin(ca.pi * p["w_c"] / (2 * p["tau"])) * ca.sin(ca.pi / 6) / (q * ca.sin(ca.pi / (6 * q)))


def carter_coefficient(g: ca.SX, p: Exprs) -> ca.SX:
    """Return K_c = t1 / (t1 - g gamma_1(g)), the factor by which slots lengthen the gap `g` in m. Source: (4)."""
    half = p["b0"] / (2 * g)
    gamma_1 = 4 / ca.pi * (half * ca.atan(half) - ca.log(ca.sqrt(1 + half**2)))
    return p["t1"] / (p["t1"] - g * gamma_1)


def permeance_factor(g: ca.SX, p: Exprs) -> ca.SX:
    """Return lambda = 1 - b0^2 / (4 t1 (g + b0/2 + h_m/mu_rec)), the pull that slot openings lose. Source: (4)."""
    return 1 - p["b0"] ** 2 / (4 * p["t1"] * (g + p["b0"] / 2 + p["h_m"] / p["mu_rec"]))


def magnet_field(g: ca.SX, p: Exprs) -> ca.SX:
    """Return B_pmy1, the amplitude in T of the magnets' fundamental at the stator.

    B_pmy1 = (4/pi) mu0 sigma_m sin(pi tau_p / (2 tau)) sinh(k h_m) / sinh(k (h_m + g)), sigma_m = H_c: charge sheets on
    the magnets' faces between iron of infinite permeability. K_h L_h in (3), (4) contains the same field.
    """
    k = ca.pi / p["tau"]
    sheet = 4 / ca.pi * p["mu0"] * p["H_c"] * ca.sin(k * p["tau_p"] / 2)
    return sheet * ca.sinh(k * p["h_m"]) / ca.sinh(k * (p["h_m"] + g))


def constants(p: Exprs, variant: Variant = STRESS) -> Constants:
    """Return K_h, K_v1, K_v2, K_v3. Source: (3), (4), with p and its power in K_v2 as `variant` says."""
    k, k_w1 = ca.pi / p["tau"], winding_factor(p)
    poles = p["p"] if variant.p_counts == "poles" else p["p"] / 2
    magnets = p["L_A"] * p["p_m"]
    charge = p["H_c"] * p["mu0"] * ca.sinh(k * p["h_m"]) * ca.sin(k * p["tau_p"] / 2)
    return Constants(
        K_h=12 * ca.sqrt(2) * p["W"] * k_w1 * magnets * charge / (ca.pi * poles),
        K_v1=magnets * p["tau"] / (4 * p["mu0"]),
        K_v2=3 * ca.sqrt(2) * magnets * p["W"] * k_w1 / poles**variant.kv2_power,
        K_v3=18 * magnets * p["W"] ** 2 * k_w1**2 * p["mu0"] / (p["tau"] * poles**2),
    )


def coefficients(g: ca.SX, p: Exprs, variant: Variant = STRESS) -> Coefficients:
    """Return L_h, L_v1, L_v2, L_v3 at the gap `g` in m. Source: (3), (4), with the factor in L_v3 as `variant` says."""
    height = ca.pi / p["tau"] * (p["h_m"] + g)
    lambda_, K_c, B = permeance_factor(g, p), carter_coefficient(g, p), magnet_field(g, p)
    stress = {"csch2": 1 / ca.sinh(height) ** 2, "coth2": 1 / ca.tanh(height) ** 2}[variant.lv3]
    return Coefficients(
        L_h=lambda_ / (K_c * ca.sinh(height)),
        L_v1=lambda_ * B**2,
        L_v2=lambda_ * B / (ca.tanh(height) * K_c),
        L_v3=lambda_ * stress / K_c**2,
    )


def thrust(g: ca.SX, i_q: ca.SX, p: Exprs, variant: Variant = STRESS) -> ca.SX:
    """Return F_H = -K_h L_h(g) i_q in N, for a gap in m and an rms current in A. Source: (1)."""
    return -constants(p, variant).K_h * coefficients(g, p, variant).L_h * i_q


def normal_force(g: ca.SX, i_d: ca.SX, i_q: ca.SX, p: Exprs, variant: Variant = STRESS) -> ca.SX:
    """Return F_V = -K_v1 L_v1 + K_v2 L_v2 i_d - K_v3 L_v3 (i_d^2 + i_q^2) in N, positive when it opens the gap.

    `g` is the gap in m, `i_d` and `i_q` are rms currents in A. Source: (2).
    """
    K, L = constants(p, variant), coefficients(g, p, variant)
    return -K.K_v1 * L.L_v1 + K.K_v2 * L.L_v2 * i_d - K.K_v3 * L.L_v3 * (i_d**2 + i_q**2)


@dataclass(frozen=True)
class Balance:
    """A load and a motor's own forces without thrust: free + linear i_d + quadratic i_d^2 = 0, in N and A rms."""

    free: float
    linear: float
    quadratic: float

    @property
    def discriminant(self) -> float:
        """linear^2 - 4 quadratic free, in N^2/A^2; below 0 no direct current carries the load."""
        return self.linear**2 - 4 * self.quadratic * self.free

    @property
    def current(self) -> float:
        """The smaller direct current that carries the load, NaN where none does."""
        D = self.discriminant
        return -2 * self.free / (self.linear + sqrt(D)) if D >= 0 else nan


def balance(load: ca.SX, p: Exprs, variant: Variant = STRESS) -> Callable[[float], Balance]:
    """Return the balance of a `load` in N, downwards, by the gap in m; parameters are numbers. Source: (2)."""
    g = ca.SX.sym("g")
    K, L = constants(p, variant), coefficients(g, p, variant)
    terms = ca.Function("balance", [g], [load - K.K_v1 * L.L_v1, K.K_v2 * L.L_v2, -K.K_v3 * L.L_v3])
    return lambda gap: Balance(*map(float, terms(gap)))


def force_law(g: ca.SX, p: Exprs) -> ForceLaw:
    """Return (1) and (2) at the gap `g` in m, for the variant STRESS, all four coefficients from the thrust constant h.

    With S = B_pmy1 sinh(k (h_m + g)), which does not depend on the gap, K_v2 S = K_h and K_v2^2 = 4 K_v1 K_v3, so that

        c = K_v3 / K_h^2 h^2 / lambda,    a = K_v1 (S / K_h)^2 h^2 K_c^2 / lambda,    b^2 = h^2 + 4 a c

    1 / lambda = 1 + beta / (g + b0/2 + h_m/mu_rec - beta), beta = b0^2 / (4 t1). Source: (3), (4).
    """
    K, L = constants(p), coefficients(g, p)
    S = K.K_h / K.K_v2
    beta, inverse = _slot_length(p), 1 / (g + _gap_offset(p))
    h = K.K_h * L.L_h
    ratio = K.K_v1 / 2 * (S / K.K_h) ** 2 * carter_coefficient(g, p) ** 2 / permeance_factor(g, p)
    k = _half_c_over_h2(p)
    slot_effect = k * beta * inverse
    half_a, half_c = h**2 * ratio, h**2 * (k + slot_effect)
    return ForceLaw(half_a, half_c, ca.sqrt(h**2 + 16 * (half_a * half_c)), h, ratio)


def numbers(plant: Plant) -> list[Constant]:
    """Return the numbers of `force_law` that the C names."""
    k, beta = "K_v3 / (2 K_h^2) of (2)", "beta = b0^2 / (4 t1)"
    return [
        plant.constant("half_c_over_h2", "1/N", _half_c_over_h2, f"{k}: half_c / h^2 without the effect of the slots"),
        plant.constant(
            "slot_pull", "m/N", lambda p: _half_c_over_h2(p) * _slot_length(p), f"half_c_over_h2 beta, {beta}"
        ),
        plant.constant("gap_offset", "m", _gap_offset, f"b0/2 + h_m/mu_rec - beta, {beta}"),
        Constant(
            "discriminant_factor",
            16.0,
            "1",
            "4 a c = 16 half_a half_c; b^2 = h^2 + 4 a c as coth^2 = 1 + 1/sinh^2 in (2)-(4)",
        ),
    ]


def _half_c_over_h2(p: Exprs) -> ca.SX:
    K = constants(p)
    return K.K_v3 / (2 * K.K_h**2)


def _slot_length(p: Exprs) -> ca.SX:
    """Return beta of `force_law` in m."""
    return p["b0"] ** 2 / (4 * p["t1"])


def _gap_offset(p: Exprs) -> ca.SX:
    return p["b0"] / 2 + p["h_m"] / p["mu_rec"] - _slot_length(p)
