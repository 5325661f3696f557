"""A levitator whose permanent magnet carries most of the weight, with a voice-coil axis on it.

    M z'' = F0 exp(z / l) + K exp(z / l) i1 - M g + C x i2        the magnet pulls up, the more the nearer
    m x'' = k i2 - c x' - s x + hum                              a flexure centres x

z is up from the nominal gap, x along the voice coil, both with stops. The coil of the magnet works in the field of the
magnet, which falls off with the length l; C is the stray field of the voice coil.
"""

import casadi as ca

from synth.plant import Plant, Symbols, build
from synth.signals import Parameter, Signal

PARAMETERS = (
    Parameter("M", 1.5, "kg", 0.05, "weighed, with payload"),
    Parameter("F0", 14.0, "N", 0.02, "force gauge"),
    Parameter("K", 20.0, "N/A", 0.1, "force gauge"),
    Parameter("l", 5e-3, "m", 0.1, "field map"),
    Parameter("g", 9.81, "m/s^2", 0.0, "standard"),
    Parameter("C", 100.0, "N/A/m", 0.5, "field map"),
    Parameter("m", 0.3, "kg", 0.05, "weighed"),
    Parameter("k", 8.0, "N/A", 0.1, "force gauge"),
    Parameter("c", 1.0, "N s/m", 0.5, "decay of the free motion"),
    Parameter("s", 400.0, "N/m", 0.1, "frequency of the free motion"),
)
VELOCITY = {"z": "vz", "x": "vx"}
HEAVY = {"K": 18.0, "F0": 13.7, "M": 1.57}  # of a weak magnet under a payload
STIFF = {"k": 7.2, "s": 440.0}  # of a stiff flexure
STOPS = {"z": (-6e-4, 6e-4), "x": (-1e-3, 1e-3)}  # m


def _physics(x: Symbols, u: Symbols, p: Symbols) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
    field = ca.exp(x["z"] / p["l"])
    lift = field * (p["F0"] + p["K"] * u["i1"]) + p["C"] * x["x"] * u["i2"]
    push = p["k"] * u["i2"] - p["c"] * x["vx"] - p["s"] * x["x"] + u["hum"]
    rates = {"z": x["vz"], "vz": lift / p["M"] - p["g"], "x": x["vx"], "vx": push / p["m"]}
    return rates, {"z": x["z"], "x": x["x"]}


def plant() -> Plant:
    """Return the levitator with currents in A and the hum in N."""
    z, x = (Signal(n, "m", low, high, f"position along {n}") for n, (low, high) in STOPS.items())
    vz, vx = Signal("vz", "m/s", -0.2, 0.2, "velocity along z"), Signal("vx", "m/s", -0.5, 0.5, "velocity along x")
    inputs = [
        Signal("i1", "A", -3, 3, "coil of the magnet"),
        Signal("i2", "A", -2, 2, "voice coil"),
        Signal("hum", "N", -0.5, 0.5, "force of the mains on x"),
    ]
    return build("levitator", [z, vz, x, vx], inputs, [z, x], PARAMETERS, _physics)
