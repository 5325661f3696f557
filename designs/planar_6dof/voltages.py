"""Phase voltages that the currents of a run need, and the stage driven by amplifiers with limited supply voltage.

With the forces per ampere J and the velocities v of the six axes, J(q)' v is the back-EMF: its product with the
currents is the mechanical power of the motors.

phase_voltages         Currents of a run are held over a sample. The voltage is that of a current which changes linearly
                       over the sample before:  u_k = R i_k + L (i_k - i_k-1) / T + J(q_k)' v_k
plant_with_amplifiers  L di/dt = u - R i - J' v,  u = R i + J' v + L (i_demand - i) / LAG, limited to a supply

Table 1 states 6.525 V, which is 4 % more than R times 1.26 A: almost nothing is left for L di/dt at full current.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import casadi as ca
import numpy as np

from models import halbach, planar_stage
from synth.base import column_maps
from synth.plant import Plant, build
from synth.signals import signal_names
from synth.simulate.scenario import Trajectory
from synth.statespace import Array

Exprs = Mapping[str, ca.SX]
RATED_VOLTAGE = 6.525  # V, Table 1
LAG = 0.25e-3  # s, of an amplifier's current loop: a quarter of a sample
INERTIA = {"x": "M", "y": "M", "z": "M", "phi": "Izz", "theta": "Ixx", "psi": "Iyy"}


def phase_voltages(plant: Plant, run: Trajectory) -> Array:
    """Return the voltages (9, N) in V that the currents of a run need; before the first sample the currents are 0."""
    R, L = (plant.parameter(name).value for name in ("resistance", "inductance"))
    currents = np.array([run.applied[name] for name in signal_names(planar_stage.INPUTS)])
    rate = np.diff(currents, axis=1, prepend=0.0) / (run.time[1] - run.time[0])
    return np.asarray(R * currents + L * rate + back_emf(plant, run))


def back_emf(plant: Plant, run: Trajectory) -> Array:
    """Return the back-EMF (9, N) of a run, V."""
    x, u, p = plant.f.sx_in()
    at = dict(zip(signal_names(plant.states), ca.vertsplit(x), strict=True))
    slope = dict(zip(signal_names(plant.states), ca.vertsplit(plant.f(x, u, p)), strict=True))
    second = {axis: slope[v] for axis, v in planar_stage.RATE.items()}
    values = dict(zip(signal_names(plant.parameters), ca.vertsplit(p), strict=True))
    induced = ca.Function("induced", [x, p], [_back_emf(at, u, values, second)])
    states = np.array([run.states[name] for name in signal_names(plant.states)])
    return column_maps.map_columns(induced, states, plant.values)[0]


def plant_with_amplifiers(volts: float, harmonics: Sequence[int] = halbach.HARMONICS) -> Plant:
    """Return the stage with amplifiers of a supply voltage in V; inputs are the demanded currents, 21 states."""
    current_states = {s.name: replace(s, name=f"true_{s.name}", low=-2.0, high=2.0) for s in planar_stage.INPUTS}
    states = (*planar_stage.STATES, *current_states.values())

    def physics(x: Exprs, u: Exprs, p: Exprs) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        currents = {name: x[s.name] for name, s in current_states.items()}
        second = planar_stage.accelerations(x, currents, p, harmonics)
        i = ca.vertcat(*currents.values())
        drop = p["resistance"] * i + _back_emf(x, i, p, second)
        required = drop + p["inductance"] / LAG * (ca.vertcat(*(u[name] for name in currents)) - i)
        slope = (ca.fmax(ca.fmin(required, volts), -volts) - drop) / p["inductance"]
        derivative = {q: x[v] for q, v in planar_stage.RATE.items()}
        derivative |= {v: second[q] for q, v in planar_stage.RATE.items()}
        derivative |= {s.name: each for s, each in zip(current_states.values(), ca.vertsplit(slope), strict=True)}
        measurements = planar_stage.hall_voltages(x, p) | planar_stage.laser_distances(x, p)
        return derivative, {q: x[q] for q in planar_stage.AXES} | measurements

    inputs, outputs = planar_stage.INPUTS, planar_stage.OUTPUTS
    return build("planar_stage_amplified", states, inputs, outputs, planar_stage.PARAMETERS, physics)


def _back_emf(x: Exprs, i: ca.SX, p: Exprs, second: Exprs) -> ca.SX:
    """Return the back-EMF (9, 1) from the accelerations as functions of the currents (9, 1)."""
    power = ca.SX(0)
    for axis, inertia in INERTIA.items():
        power += p[inertia] * second[axis] * x[planar_stage.RATE[axis]]
    return ca.jacobian(power, i).T


def largest_current(run: Trajectory) -> float:
    """Return the largest commanded phase current of a run, A."""
    return float(max(np.abs(run.applied[name]).max() for name in signal_names(planar_stage.INPUTS)))


def voltage_figures(plant: Plant, noisy: Trajectory, ideal: Trajectory | None) -> dict[str, float]:
    """Return how large the voltages of a run are and how often above RATED_VOLTAGE, and of its twin without noise."""
    u = np.abs(phase_voltages(plant, noisy))
    voltages = {
        "largest voltage, V": float(u.max()),
        "share of voltages above 6.525 V": float(np.mean(u > RATED_VOLTAGE)),
    }
    if ideal is not None:
        voltages["largest voltage without noise, V"] = float(np.abs(phase_voltages(plant, ideal)).max())
    return voltages
