"""The force law of `models.lorentz_motor`, integrated symbolically from the Lorentz force on the winding.

    f = Nm w eta0 sum_j i_j int_z0^(z0 + Gamma) int_-l/12^l/12 (B(y + c_j + s) - B(y + c_j + l/2 + s)) ds dz

for one harmonic n of the field, with nothing simplified by hand: the bands, the two integrals and the sum over phases.
"""

from dataclasses import dataclass

import sympy as sp

from models.lorentz_motor import PHASE_OFFSETS

l, Gamma, Delta, w, eta0, Nm, m, z0 = sp.symbols("l Gamma Delta w eta0 Nm mu0_M0 z0", positive=True)
y, i_Q, i_D = sp.symbols("y i_Q i_D", real=True)
CURRENTS = dict(zip("ABC", sp.symbols("i_A i_B i_C", real=True), strict=True))


@dataclass(frozen=True)
class ForceLaw:
    """f_y and f_z in N, linear in the three phase currents."""

    f_y: sp.Expr
    f_z: sp.Expr


def force_law(n: int = 1) -> ForceLaw:
    """Return the force of the field's harmonic n (1, 5, 9, ..) on the winding."""
    gamma = 2 * sp.pi / l
    s, z, middle = sp.symbols("s z middle", real=True)
    peak = 4 / (n * sp.pi) * sp.sin(n * sp.pi / 4) * m * (1 - sp.exp(-n * gamma * Delta))
    decay = sp.integrate(sp.exp(-n * gamma * z), (z, z0, z0 + Gamma))

    def force(shape: type[sp.Function]) -> sp.Expr:
        band = sp.integrate(shape(n * gamma * (middle + s)), (s, -l / 12, l / 12))
        total = sp.Integer(0)
        for phase, offset in PHASE_OFFSETS.items():
            centre = y + sp.nsimplify(offset) * l
            total += CURRENTS[phase] * (band.subs(middle, centre) - band.subs(middle, centre + l / 2))
        return Nm * w * eta0 * peak * decay * total

    return ForceLaw(force(sp.cos), -force(sp.sin))


def force_constant() -> sp.Expr:
    """Return K in N/A: f_y for i_Q = 1 A, i_D = 0 after commutation, which does not depend on y."""
    gamma, law = 2 * sp.pi / l, force_law()
    alpha, beta = sp.cos(gamma * y), sp.sin(gamma * y)
    half = sp.sqrt(3) / 2 * beta
    commutated = dict(zip(CURRENTS.values(), (alpha, half - alpha / 2, -half - alpha / 2), strict=True))
    factors = sp.factor_terms(law.f_y.subs(commutated)).as_independent(y, as_Add=False)
    return sp.simplify(factors[0]) * sp.simplify(sp.expand(sp.expand_trig(factors[1])))
