"""Feedback linearisation of the levitated platen: its accelerations as polynomials in the currents, and the inverse.

With the direct currents (8) from v = (v_y, v_phi, v_theta), the accelerations (6), (7) of `maglev_stage` are a
polynomial in v, u_x, u_z:

    (9)  y''     = a1 + a2 v_phi + a3 v_y + a4 v_phi v_y + ... + a9 v_theta^2, and alike phi'' (b), theta'' (c)
    (11) the same without the terms NEGLIGIBLE
    (12) v = D^-1 (w_y - a1, w_phi - b1, w_theta - c1),   u_x = w_x/h_x,   u_z = w_z/h_z,   which inverts (11)

Source: Fulford, Maggiore, Apkarian, "Control of a 5DOF Magnetically Levitated Positioning Stage", (8)-(12).
"""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace

import casadi as ca

from models import maglev_stage
from synth.errors import ModelError
from synth.synthesise.nonlinear import feedback_linearisation

Exprs = Mapping[str, ca.SX]

TRANSFORMED = ("v_y", "v_phi", "v_theta")

# (9): each coefficient's acceleration and the monomial of v that it multiplies.
TERMS: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "a1": ("y", ()),
    "a2": ("y", ("v_phi",)),
    "a3": ("y", ("v_y",)),
    "a4": ("y", ("v_phi", "v_y")),
    "a5": ("y", ("v_phi", "v_phi")),
    "a6": ("y", ("v_y", "v_y")),
    "a7": ("y", ("v_theta",)),
    "a8": ("y", ("v_y", "v_theta")),
    "a9": ("y", ("v_theta", "v_theta")),
    "b1": ("phi", ()),
    "b2": ("phi", ("v_phi",)),
    "b3": ("phi", ("v_y",)),
    "b4": ("phi", ("v_phi", "v_y")),
    "b5": ("phi", ("v_phi", "v_phi")),
    "b6": ("phi", ("v_y", "v_y")),
    "c1": ("theta", ()),
    "c2": ("theta", ("v_theta",)),
    "c3": ("theta", ("v_y",)),
    "c4": ("theta", ("v_y", "v_theta")),
    "c5": ("theta", ("v_theta", "v_theta")),
    "c6": ("theta", ("v_y", "v_y")),
}
NEGLIGIBLE = ("a4", "a5", "a6", "a8", "a9", "b4", "b5", "b6", "c4", "c5", "c6")  # what (11) drops


@dataclass(frozen=True, eq=False)
class InputPolynomial:
    """The accelerations as polynomials in v: (9), or (11) when terms are left out.

    `x` holds the symbols y, phi, theta; `u` those of u_x, u_z; `v` those of v_y, v_phi, v_theta. `coefficients` maps
    a1..a9, b1..b6, c1..c6 (each kept name of `TERMS`) and h_x, h_z to expressions in x, in u, and in the symbols of
    the parameters. The unit of a coefficient is that of its acceleration over A^degree.
    """

    x: Exprs
    u: Exprs
    v: Exprs
    coefficients: Exprs

    def accelerations(self) -> dict[str, ca.SX]:
        """Return the five accelerations, put together from the kept monomials."""
        total = {q: ca.SX(0) for q in maglev_stage.RATE}
        for name, expr in self.coefficients.items():
            if name in TERMS:
                acceleration, monomial = TERMS[name]
                total[acceleration] += expr * _product(self.v[n] for n in monomial)
        return total | {q: self.coefficients[f"h_{q}"] * self.u[f"u_{q}"] for q in ("x", "z")}

    def decoupling(self) -> ca.SX:
        """Return [[a3, a2, a7], [b3, b2, 0], [c3, 0, c2]], the matrix (3, 3) in (11) and (12)."""
        second = self.accelerations()
        vertical = ca.vcat([second[q] for q in ("y", "phi", "theta")])
        v = ca.vcat([self.v[name] for name in TRANSFORMED])
        return ca.substitute(ca.jacobian(vertical, v), v, ca.SX.zeros(v.numel()))


def input_polynomial(p: Exprs, lv3: str = "csch2") -> InputPolynomial:
    """Return (9): the coefficients are derivatives at v = 0 of the full model (6), (7) under (8).

    `p` holds the parameters by name, as numbers (`maglev_stage.nominal()`) or as symbols.

    Raises ModelError for an unknown `lv3`.
    """
    x = {name: ca.SX.sym(name) for name in ("y", "phi", "theta")}
    u = {name: ca.SX.sym(name) for name in ("u_x", "u_z")}
    v = {name: ca.SX.sym(name) for name in TRANSFORMED}
    second = maglev_stage.accelerations(x, u | maglev_stage.input_transformation(v), p, maglev_stage.force_variant(lv3))
    coefficients = {name: _coefficient(second[q], v, monomial) for name, (q, monomial) in TERMS.items()}
    coefficients |= {f"h_{q}": ca.jacobian(second[q], u[f"u_{q}"]) for q in ("x", "z")}
    return InputPolynomial(x, u, v, coefficients)


def simplified(model: InputPolynomial, dropped: Collection[str] = NEGLIGIBLE) -> InputPolynomial:
    """Return the model without the `dropped` terms: (11) for the default.

    Raises ModelError for a name that the model does not have.
    """
    unknown = [name for name in dropped if name not in model.coefficients or name not in TERMS]
    if unknown:
        kept = ", ".join(name for name in model.coefficients if name in TERMS)
        raise ModelError(f"the terms {', '.join(unknown)} cannot be dropped: the polynomial has {kept}")
    return replace(model, coefficients={n: e for n, e in model.coefficients.items() if n not in dropped})


def inverse(model: InputPolynomial, w: Exprs) -> dict[str, ca.SX]:
    """Return v_y, v_phi, v_theta, u_x, u_z in A from the demanded accelerations, in the symbols of `model`.

    Source: (12).
    """
    second, names = model.accelerations(), ("y", "phi", "theta")
    law = feedback_linearisation.linearise([second[n] for n in names], model.v, [w[n] for n in names])
    u = {f"u_{n}": w[n] / model.coefficients[f"h_{n}"] for n in ("x", "z")}
    old, new = ca.vcat(list(model.u.values())), ca.vcat([u[n] for n in model.u])
    return u | {n: ca.substitute(e, old, new) for n, e in law.inputs.items()}


def law(p: Exprs, lv3: str, position: Exprs, w: Exprs) -> dict[str, ca.SX]:
    """Return i_d1..i_d4, u_x, u_z in A from positions and demanded accelerations. Source: (8), (12).

    `p` holds the parameters by name. Without theta among the positions, v_phi = v_theta = 0 and (12) reduces to its
    first row.
    """
    model = simplified(input_polynomial(p, lv3))
    currents = inverse(model, w)
    if "theta" not in position:
        c, u = model.coefficients, ca.vcat([currents[n] for n in model.u])
        alone = ca.substitute((w["y"] - c["a1"]) / c["a3"], ca.vcat(list(model.u.values())), u)
        currents |= {"v_y": alone, "v_phi": ca.SX(0), "v_theta": ca.SX(0)}
    inputs = maglev_stage.input_transformation(currents) | {n: currents[n] for n in model.u}
    pose = ca.vcat([position.get(n, ca.SX(0)) for n in model.x])
    at_pose = ca.substitute(ca.vcat(list(inputs.values())), ca.vcat(list(model.x.values())), pose)
    return dict(zip(inputs, ca.vertsplit(at_pose), strict=True))


def _coefficient(expr: ca.SX, v: Exprs, monomial: tuple[str, ...]) -> ca.SX:
    """Return the coefficient of a monomial: its mixed derivative at v = 0 over the factorials of its powers."""
    factor = 1
    for position, name in enumerate(monomial):
        expr = ca.jacobian(expr, v[name])
        factor *= 1 + monomial[:position].count(name)
    at_zero = ca.substitute(expr, ca.vcat(list(v.values())), ca.SX.zeros(len(v)))
    return ca.simplify(at_zero / factor)


def _product(factors: Iterable[ca.SX]) -> ca.SX:
    result = ca.SX(1)
    for factor in factors:
        result *= factor
    return result
