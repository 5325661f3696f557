"""Levitated platen as it may be built: each motor with its own flux and force, encoders with an error of their scale.

    flux of motor j     H_c (1 + flux) (1 + flux_j)        forces F_H, F_V of all motors times 1 + force
    encoder             s + encoder_error sin(2 pi s/SCALE + phase)

The equations are those of `maglev_phases`; its parameters have the same names, and those that are added here are 0.
"""

from dataclasses import replace

import casadi as ca
import numpy as np

from models import maglev_phases, maglev_stage, pmlsm, windings
from models.maglev_stage import Exprs
from synth.plant import Plant, build
from synth.signals import Parameter

SCALE = 40e-6  # m, signal period of an encoder of 10 um
ADDED = (
    Parameter("flux", 0.0, "1", 0.0, "of all motors, relative"),
    *(Parameter(f"flux_{j}", 0.0, "1", 0.0, "of one motor, relative") for j in maglev_phases.MOTORS),
    Parameter("force", 0.0, "1", 0.0, "of all motors, relative"),
    Parameter("encoder_error", 0.0, "m", 0.0, "amplitude over a signal period"),
)
ENDS = {"flux": (-0.08, 0.02), "force": (-0.05, 0.05)}
ENDS |= {f"flux_{j}": (-0.03, 0.03) for j in maglev_phases.MOTORS}
RELATIVE = dict.fromkeys(("M_x", "M_y", "M_z", "I_x", "I_z"), (0.97, 1.03))
RELATIVE |= dict.fromkeys(("k_s_phi", "k_s_theta"), (0.7, 1.3))
READ = {**{f"g{j}": f"g{j}" for j in maglev_phases.MOTORS}, "x": "x", "z": "z"}


def plant() -> Plant:
    """Return the plant with twelve phase currents; ``<output>_read`` are the readings of the encoders."""

    def physics(x: Exprs, u: Exprs, p: Exprs) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        angles = [windings.electrical_angle(x[along], p["tau"]) for along in maglev_phases.ALONG]
        F_H, F_V = [], []
        for j, (g, angle) in enumerate(zip(maglev_stage.gaps(x, p), angles, strict=True), 1):
            of_motor = {**p, "H_c": p["H_c"] * (1 + p["flux"]) * (1 + p[f"flux_{j}"])}
            i_d, i_q = windings.rotor_currents([u[f"i_{phase}{j}"] for phase in "abc"], angle)
            F_H.append((1 + p["force"]) * pmlsm.thrust(g, i_q, of_motor))
            F_V.append((1 + p["force"]) * pmlsm.normal_force(g, i_d, i_q, of_motor))
        derivative, outputs = maglev_stage.motion(x, maglev_stage.platen_accelerations(x, F_H, F_V, p), p)
        for k, name in enumerate(READ):
            s = outputs[name]
            outputs[f"{name}_read"] = s + p["encoder_error"] * ca.sin(2 * ca.pi * s / SCALE + k)
        return derivative, outputs

    of = maglev_stage
    by_name = {s.name: s for s in of.OUTPUTS}
    read = [replace(by_name[n], name=f"{n}_read") for n in READ]
    return build(
        "maglev_as_built", of.STATES, maglev_phases.PHASES, (*of.OUTPUTS, *read), (*of.PARAMETERS, *ADDED), physics
    )


def corner(nominal: Plant, row: int) -> dict[str, float]:
    """Return the parameters at a corner of the tolerances, which the row determines."""
    rng = np.random.default_rng(row)
    values = {n: ends[int(rng.integers(2))] for n, ends in ENDS.items()}
    return values | {n: nominal.parameter(n).value * ends[int(rng.integers(2))] for n, ends in RELATIVE.items()}
