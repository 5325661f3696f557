"""Calibrated voltages for the estimator: gains, angles and offsets, and the field that its model does not have.

    V_k' = M_k^-1 (V_k - o_k) - a R(yaw)' table(P_k),   P_k = (X, Y) + R(yaw) r_k

at the predicted pose: the last one, continued at its velocity. While the estimator tracks, a pose changes the
prediction by GATE at most a sample, and by DOUBTED if it is not valid or a sensor is excluded: a pose that a fault has
displaced then meets the table of another place, which its residuals show. Up to the first valid sample of a track, the
last pose is the next prediction. The amplitude a is averaged over some samples.

The table is looked up once a sample, at the prediction: its slope times the error of the prediction is what is left,
less than 4 mV/mm, and no part of the estimator's Jacobian, to which it adds 2 % at most.
"""

from collections.abc import Mapping
from dataclasses import replace

import casadi as ca
import numpy as np

from designs.hall_position.glsdc import channels
from studies.hall.calibrated import stages
from studies.hall.calibrated.stages import UnitCalibration
from synth.block import Block, Constant, Exprs, State, Step, build, clip, table
from synth.blocks.laws import lookup_table
from synth.blocks.laws.lookup_table import Grid
from synth.errors import ModelError
from synth.signals import Signal
from synth.timing import Discrete

GATE = {"X": 3e-4, "Y": 3e-4, "yaw": 0.01}  # m, m, rad: largest innovation of a sample
DOUBTED = {"X": 2e-5, "Y": 2e-5, "yaw": 1e-3}  # the same, of a sample in doubt: 6 m/s^2 at 800 Hz
VELOCITY_GAIN, AMPLITUDE_GAIN = 0.5, 0.25
LARGEST_MOTION = 4e-3  # m a sample


def corrections(of: UnitCalibration, time: Discrete, pose: Mapping[str, Signal]) -> Block:
    """Return the Block from ``<voltage>_held`` to ``<voltage>_calibrated``.

    `pose` are outputs of the estimator, which it reads after each sample: X, Y, yaw, amplitude, tracking, excluded
    and valid.

    Raises ModelError for a calibration without a table.
    """
    letters, inverse = stages.letters(of.fit.values), np.linalg.inv(of.gains())
    volts = channels.voltages(len(letters))
    constants = _constants(of, inverse)
    fitted = of.table
    if fitted is None:
        raise ModelError(
            f"the calibration up to the stage '{of.stage}' has no table of the field: calibrate to 'waves' or 'map'"
        )
    tables = {a: table(f"field_{a}", fitted.values[..., i].ravel().tolist()) for i, a in enumerate("xy")}

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        predicted = {n: clip(x[f"last_{n}"] + x[f"motion_{n}"], pose[n]) for n in "XY"} | {"yaw": x["last_yaw"]}
        output: dict[str, ca.SX] = {}
        c, s = ca.cos(predicted["yaw"]), ca.sin(predicted["yaw"])
        for letter in letters:
            field = _field(tables, fitted.grid, letter, predicted, (c, s), k)
            body = c * field["x"] + s * field["y"], c * field["y"] - s * field["x"]
            held = [u[f"V_{letter}{axis}_held"] for axis in "xy"]
            for axis, B in zip("xy", body, strict=True):
                linear = sum(k[f"inverse_{letter}{axis}{b}"] * v for b, v in zip("xy", held, strict=True))
                volt = linear - k[f"offset_{letter}{axis}"] - x["mean_amplitude"] * B
                output[f"V_{letter}{axis}_calibrated"] = clip(volt, volts[0])
        return Step(output, _advance(u, x, predicted, pose))

    return build(
        "calibration",
        time,
        law,
        inputs=[*(replace(v, name=f"{v.name}_held") for v in volts), *pose.values()],
        outputs=[replace(v, name=f"{v.name}_calibrated", about=f"{v.about}, calibrated") for v in volts],
        states=_states(pose),
        constants=constants,
        tag="calibration of sensors and field",
    )


def _constants(of: UnitCalibration, inverse: np.ndarray) -> list[Constant]:
    made, offsets = [], np.einsum("kij,kj->ki", inverse, of.offsets())
    for i, letter in enumerate(stages.letters(of.fit.values)):
        for j, axis in enumerate("xy"):
            made += [
                Constant(f"inverse_{letter}{axis}{b}", float(inverse[i, j, m]), "1", "calibration")
                for m, b in enumerate("xy")
            ]
            made.append(Constant(f"offset_{letter}{axis}", float(offsets[i, j]), "V", "calibration"))
            made.append(Constant(f"place_{letter}{axis}", float(of.places()[i, j]), "m", "calibration"))
    return made


def _field(
    tables: Mapping[str, ca.Function],
    grid: Grid,
    letter: str,
    predicted: Mapping[str, ca.SX],
    turn: tuple[ca.SX, ca.SX],
    k: Exprs,
) -> dict[str, ca.SX]:
    """Return the table's field at a sensor, V, in the axes of the matrix."""
    (c, s), (rx, ry) = turn, (k[f"place_{letter}{axis}"] for axis in "xy")
    at = predicted["X"] + c * rx - s * ry, predicted["Y"] + s * rx + c * ry
    return lookup_table.bilinear(tables, grid, *at)


def _advance(u: Exprs, x: Exprs, predicted: Mapping[str, ca.SX], pose: Mapping[str, Signal]) -> dict[str, ca.SX]:
    next: dict[str, ca.SX] = {}
    trusted = ca.logic_and(u["valid"], u["excluded"] == 0)
    aligned = ca.logic_and(u["tracking"], ca.logic_or(u["valid"], x["aligned"]))
    for name, most in GATE.items():
        change = u[name] - predicted[name]
        wide, narrow = (clip(change, Signal("gate", pose[name].unit, -v, v)) for v in (most, DOUBTED[name]))
        innovation = ca.if_else(trusted, wide, narrow)
        following = clip(predicted[name] + innovation, pose[name])
        next[f"last_{name}"] = ca.if_else(aligned, following, u[name])
        if name in "XY":
            motion = clip(x[f"motion_{name}"] + VELOCITY_GAIN * innovation, _motion(name))
            next[f"motion_{name}"] = aligned * motion
    shift = AMPLITUDE_GAIN * (u["amplitude"] - x["mean_amplitude"])
    mean = clip(x["mean_amplitude"] + aligned * shift, pose["amplitude"])
    return next | {"mean_amplitude": mean, "aligned": aligned}


def _motion(name: str) -> Signal:
    return Signal(f"motion_{name}", "m", -LARGEST_MOTION, LARGEST_MOTION, f"change of {name} a sample")


def _states(pose: Mapping[str, Signal]) -> list[State]:
    lasts = [State(replace(pose[n], name=f"last_{n}", about=f"{n} of the table's prediction"), 0.0) for n in GATE]
    mean = replace(pose["amplitude"], name="mean_amplitude", about="amplitude, averaged")
    aligned = State(Signal("aligned", "1", 0, 1, "a sample of this track was valid"), 0, True)
    return [*lasts, *(State(_motion(n), 0.0) for n in "XY"), State(mean, 1.0), aligned]
