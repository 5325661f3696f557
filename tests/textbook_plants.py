"""Nonlinear plants whose relative degrees, decoupling matrices and zero dynamics textbooks give in closed form."""

from collections.abc import Sequence

import casadi as ca

from synth.plant import Plant, Symbols, build
from synth.signals import Parameter, Signal, per_second, signal_names

B, G = 5 / 7, 9.81  # of the ball and beam
MASS = {"MgL": 5.0, "I": 0.8, "J": 0.3, "k": 12.0}  # of the flexible joint


def ball_and_beam(low: float) -> Plant:
    """Hauser, Sastry, Kokotovic 1992: r'' = B (r w^2 - G sin theta), theta'' = tau, y = r; r and w from `low` to 1."""
    states = [
        Signal("r", "m", low, 1.0),
        Signal("vr", "m/s", -1.0, 1.0),
        Signal("theta", "rad", -1.0, 1.0),
        Signal("w", "rad/s", low, 1.0),
    ]

    def physics(x: Symbols, u: Symbols, p: Symbols) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        fall = B * (x["r"] * x["w"] ** 2 - G * ca.sin(x["theta"]))
        return {"r": x["vr"], "vr": fall, "theta": x["w"], "w": u["tau"]}, {"y": x["r"]}

    return build("ball_and_beam", states, [Signal("tau", "rad/s^2", -10, 10)], [Signal("y", "m", -1, 1)], [], physics)


def flexible_joint() -> Plant:
    """Spong 1987: I q1'' + MgL sin q1 + k (q1 - q2) = 0, J q2'' = k (q1 - q2) + u, y = q1."""
    states = [
        Signal("q1", "rad", -2, 2),
        Signal("w1", "rad/s", -5, 5),
        Signal("q2", "rad", -2, 2),
        Signal("w2", "rad/s", -5, 5),
    ]
    parameters = [Parameter(n, v, "1", 0.01, "chosen") for n, v in MASS.items()]

    def physics(x: Symbols, u: Symbols, p: Symbols) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        twist = p["k"] * (x["q1"] - x["q2"])
        rates = {"q1": x["w1"], "q2": x["w2"]}
        rates |= {"w1": -(p["MgL"] * ca.sin(x["q1"]) + twist) / p["I"], "w2": (twist + u["torque"]) / p["J"]}
        return rates, {"y": x["q1"]}

    inputs = [Signal("torque", "N m/rad", -50, 50)]
    return build("flexible_joint", states, inputs, [Signal("y", "rad", -2, 2)], parameters, physics)


def two_masses(damping: float = 0.0) -> Plant:
    """m1 and m2 by a spring and a damper, a force on m2: x2 is collocated with it, x1 is not."""
    states = [Signal(n, unit, -1, 1) for n, unit in (("x1", "m"), ("v1", "m/s"), ("x2", "m"), ("v2", "m/s"))]
    values = {"m1": 2.0, "m2": 3.0, "stiffness": 50.0, "damping": damping}
    parameters = [Parameter(n, v, "1", 0.01, "chosen") for n, v in values.items()]

    def physics(x: Symbols, u: Symbols, p: Symbols) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        between = p["stiffness"] * (x["x2"] - x["x1"]) + p["damping"] * (x["v2"] - x["v1"])
        rates = {"x1": x["v1"], "x2": x["v2"], "v1": between / p["m1"], "v2": (u["force"] - between) / p["m2"]}
        return rates, {"y1": x["x1"], "y2": x["x2"]}

    outputs = [Signal("y1", "m", -1, 1), Signal("y2", "m", -1, 1)]
    return build("two_masses", states, [Signal("force", "N", -5, 5)], outputs, parameters, physics)


def aircraft(eps: float) -> Plant:
    """Hauser, Sastry, Meyer 1992, vertical take-off: thrust T, roll M, and the force `eps` M that rolling makes."""
    units = {"x": "m", "vx": "m/s", "z": "m", "vz": "m/s", "theta": "rad", "w": "rad/s"}
    states = [Signal(n, unit, -1, 1) for n, unit in units.items()]
    inputs = [Signal("T", "m/s^2", 0.5, 2.0), Signal("M", "rad/s^2", -5, 5)]

    def physics(x: Symbols, u: Symbols, p: Symbols) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        c, s = ca.cos(x["theta"]), ca.sin(x["theta"])
        rates = {"x": x["vx"], "z": x["vz"], "theta": x["w"], "w": u["M"]}
        rates |= {"vx": -s * u["T"] + p["eps"] * c * u["M"], "vz": c * u["T"] + p["eps"] * s * u["M"] - 1}
        return rates, {"px": x["x"], "pz": x["z"]}

    outputs = [Signal("px", "m", -1, 1), Signal("pz", "m", -1, 1)]
    return build("aircraft", states, inputs, outputs, [Parameter("eps", eps, "m", 0.01, "chosen")], physics)


def unicycle(slowest: float = -1.0) -> Plant:
    """x' = v cos theta, y' = v sin theta, theta' = turn; speeds from `slowest` to 1 m/s."""
    states = [Signal("x", "m", -1, 1), Signal("y", "m", -1, 1), Signal("theta", "rad", -3, 3)]
    inputs = [Signal("v", "m/s", slowest, 1.0), Signal("turn", "rad/s", -2, 2)]

    def physics(x: Symbols, u: Symbols, p: Symbols) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        rates = {"x": u["v"] * ca.cos(x["theta"]), "y": u["v"] * ca.sin(x["theta"]), "theta": u["turn"]}
        return rates, {"px": x["x"], "py": x["y"]}

    return build("unicycle", states, inputs, [Signal("px", "m", -1, 1), Signal("py", "m", -1, 1)], [], physics)


def with_input(rate: ca.Function) -> Plant:
    """dx/dt = -x + rate(x, u), y = x, for one state and one input."""

    def physics(x: Symbols, u: Symbols, p: Symbols) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        return {"level": -x["level"] + rate(x["level"], u["flow"])}, {"y": x["level"]}

    one = [Signal("level", "m", 0.5, 2.0)]
    return build("tank", one, [Signal("flow", "m/s", -1, 1)], [Signal("y", "m", 0.5, 2.0)], [], physics)


def hidden(e: ca.Function) -> Plant:
    """x1' = x2 + e(x1, x2) u, x2' = x3 - x2^3, x3' = u + x1 x2, y = x1: degree 3 where e is zero, else 1."""

    def physics(x: Symbols, u: Symbols, p: Symbols) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        rates = {"x1": x["x2"] + e(x["x1"], x["x2"]) * u["u"], "x2": x["x3"] - x["x2"] ** 3}
        return rates | {"x3": u["u"] + x["x1"] * x["x2"]}, {"y": x["x1"]}

    states = [Signal(n, "1", 0.2, 1.5) for n in ("x1", "x2", "x3")]
    return build("hidden", states, [Signal("u", "1", -1, 1)], [Signal("y", "1", 0, 2)], [], physics)


def with_integrators(plant: Plant, names: Sequence[str]) -> Plant:
    """Return the plant with some inputs as states, in the order of `names`, and their rates as inputs instead."""
    old = [next(s for s in plant.inputs if s.name == name) for name in names]
    rates = {s.name: Signal(f"{s.name}_rate", per_second(s.unit), s.low - s.high, s.high - s.low) for s in old}

    def physics(x: Symbols, u: Symbols, p: Symbols) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        values = [x[s.name] if s.name in rates else u[s.name] for s in plant.inputs]
        args = ca.vertcat(*(x[s.name] for s in plant.states)), ca.vertcat(*values), ca.vertcat(*p.values())
        f, h = (ca.vertsplit(ca.cse(function(*args))) for function in (plant.f, plant.h))
        derivatives = dict(zip(signal_names(plant.states), f, strict=True))
        derivatives |= {name: u[rate.name] for name, rate in rates.items()}
        return derivatives, dict(zip(signal_names(plant.outputs), h, strict=True))

    inputs = [rates.get(s.name, s) for s in plant.inputs]
    return build(plant.name, [*plant.states, *old], inputs, plant.outputs, plant.parameters, physics)
