"""Calibration of a unit in stages: the field's amplitudes, the sensors, extra waves, and a map of the field.

    V_k = M_k R(yaw)' B(P_k) + o_k,   P_k = (X, Y) + R(yaw) r_k      M_k: gains and angles (2, 2), r_k, o_k of a sensor
    B = sum over (m, n) of a_mn (m, n) sin(w (m X + n Y))  +  map(X, Y)

Each wave is that of a potential. alpha = a_10 = a_01 keeps its value, as M_k has the gains. The map is fitted to the
residuals in the field's axes, at the sensors' places, and the other parameters to what the map leaves, in turn,
PASSES times: fitted without the map, gains and places follow the field's own errors by up to 1 %. The estimator has
the waves 1 and 5 along each axis; everything else of B is in its table, of spacing pitch / PER_PITCH.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from string import ascii_lowercase
from typing import Any

import casadi as ca
import numpy as np

from designs.hall_position.protected import config
from models.hall_motions import Numbers
from studies.hall.calibrated import unit as units
from studies.hall.calibrated.unit import Unit
from synth.base.cache import cached
from synth.block import Exprs
from synth.blocks.laws import lookup_table
from synth.blocks.laws.lookup_table import ResidualMap
from synth.errors import ModelError
from synth.signals import Parameter
from synth.synthesise.identify import calibration
from synth.synthesise.identify.calibration import Assessment, Calibration
from synth.synthesise.identify.logs import Log

AXIAL, CROSS = (1, 3, 5, 7, 9), ((2, 1), (2, -1), (1, 2), (1, -2))  # numbers of waves along the axes, and of both
MODEL_WAVES = (1, 5)  # of the estimator
MATRIX = ("xx", "xy", "yx", "yy")
STAGES = ("amplitudes", "sensors", "waves", "map")
MAP_SPACING, MAP_REACH, PASSES = 2.4e-3, 0.0685, 4  # m, m, fits of map and parameters in turn
PER_PITCH, FINE, TABLE_SMOOTHING = 32, 4, 1e-6  # points of the table and of its samples in a cell, along an axis
UNIT = 1e-5  # V, of the table


def letters(k: Mapping[str, Any]) -> str:
    """Return the letters of the sensors whose parameters are in `k`."""
    return "".join(n for n in ascii_lowercase if f"place_{n}x" in k)


def parameters(name: str = config.NAME) -> list[Parameter]:
    """Return the parameters of an estimator's sensors and field at their nominal values."""
    array, made = config.array(name), []
    for letter, place in zip(ascii_lowercase, array.positions, strict=False):
        made += [Parameter(f"gain_{letter}{e}", float(e in ("xx", "yy")), "1", 0.02, "nominal") for e in MATRIX]
        made += [Parameter(f"offset_{letter}{axis}", 0.0, "V", 0.0, "nominal") for axis in "xy"]
        made += [
            Parameter(f"place_{letter}{axis}", v, "m", 0.01, "nominal") for axis, v in zip("xy", place, strict=True)
        ]
    sizes = {1: array.alpha, 5: array.beta}
    made += [Parameter(f"wave_{n}", sizes.get(n, 0.0), "V", 0.1, "nominal") for n in AXIAL]
    return made + [Parameter(_cross(of), 0.0, "V", 0.1, "nominal") for of in CROSS]


def _cross(of: tuple[int, int]) -> str:
    return f"wave_{of[0]}_{of[1]}".replace("-", "minus_")


def voltages(q: Exprs, k: Exprs) -> Exprs:
    """Return the voltages of the model at a pose."""
    c, s, volts = ca.cos(q["yaw"]), ca.sin(q["yaw"]), {}
    for letter in letters(k):
        x, y = (k[f"place_{letter}{axis}"] for axis in "xy")
        B = _waves(k, q["X"] + c * x - s * y, q["Y"] + s * x + c * y, AXIAL, CROSS)
        body = c * B[0] + s * B[1], c * B[1] - s * B[0]
        for axis in "xy":
            gains = (k[f"gain_{letter}{axis}{of}"] for of in "xy")
            volts[f"V_{letter}{axis}"] = (
                sum(g * b for g, b in zip(gains, body, strict=True)) + k[f"offset_{letter}{axis}"]
            )
    return volts


def _waves(k, X, Y, axial: Sequence[int], cross: Sequence[tuple[int, int]]):  # type: ignore[no-untyped-def]
    """Return the field of some waves along X and Y, symbolic or in numbers."""
    w = config.array().wave_number
    sin = np.sin if isinstance(X, np.ndarray) else ca.sin
    x = sum(k[f"wave_{n}"] * sin(n * w * X) for n in axial)
    y = sum(k[f"wave_{n}"] * sin(n * w * Y) for n in axial)
    for m, n in cross:
        wave = k[_cross((m, n))] * sin(w * (m * X + n * Y))
        x, y = x + m * wave, y + n * wave
    return x, y


@dataclass(frozen=True, eq=False)
class UnitCalibration:
    """What a stage of a unit's calibration gives: parameters, the table (or None), and residuals held out.

    `assessment` is of the estimator's own model: two waves, and the table.
    """

    name: str
    stage: str
    fit: Calibration
    table: ResidualMap | None
    assessment: Assessment
    position_error: float  # m rms, along X or Y
    yaw_error: float  # rad rms

    @property
    def residual(self) -> float:
        """The rms residual of a voltage that was held out, V."""
        return float(np.sqrt(np.mean([v**2 for v in self.assessment.rms.values()])))

    def model_error(self, gain_drift: float) -> float:
        """Return the rms model error of a voltage with a relative drift of gains, rms."""
        return float(np.sqrt(np.mean(np.square(self.assessment.budget(gain_drift)))))

    def places(self) -> Numbers:
        """Return the sensors' places (sensors, 2), m."""
        return _pairs(self.fit, "place")

    def gains(self) -> Numbers:
        """Return M (sensors, 2, 2)."""
        return _gains(self.fit)

    def offsets(self) -> Numbers:
        """Return the offsets (sensors, 2), V."""
        return _pairs(self.fit, "offset")


def calibrate(unit: Unit, stage: str = STAGES[-1]) -> UnitCalibration:
    """Return the calibration of a unit up to a stage; raise ModelError for an unknown one."""
    if stage not in STAGES:
        raise ModelError(f"'{stage}' is not a stage of the calibration: give one of {', '.join(STAGES)}")
    test = units.held_out(unit)
    fit, of = _fit_map(unit) if stage == "map" else (_fit_stage(stage, unit), None)
    table = _table(fit, of) if stage in ("waves", "map") else None
    predicted = predict(fit, table, test.columns(tuple(units.REFERENCES)))
    h = test.columns(tuple(unit.readings)) - fit.residuals(test)
    corrections = predicted.reshape(h.shape) - h
    errors = _pose_errors(fit, test, fit.residuals(test) - corrections)
    along, turn = float(np.sqrt((errors[:, :2] ** 2).mean())), float(np.sqrt((errors[:, 2] ** 2).mean()))
    return UnitCalibration(unit.name, stage, fit, table, calibration.assess(fit, test, corrections), along, turn)


@cache
def _fit_stage(stage: str, unit: Unit) -> Calibration:
    """Return the fit of a stage to the scan of a unit: the map begins with that of the waves."""
    return _fit(stage, units.scan(unit), parameters(unit.name))


def _fit_map(unit: Unit) -> tuple[Calibration, ResidualMap]:
    """Return the parameters and the map, fitted in turn."""
    fit, log = _fit_stage("waves", unit), units.scan(unit)
    of, readings = _map(fit, log), log.columns(tuple(unit.readings))
    for _ in range(PASSES):
        left = readings - _map_voltages(fit, of, log.columns(tuple(units.REFERENCES)))
        fit = _fit("waves", Log({**log.samples, **dict(zip(unit.readings, left.T, strict=True))}), fit.parameters)
        of = _map(fit, log)
    return fit, of


def _map_voltages(fit: Calibration, of: ResidualMap, poses: Numbers) -> Numbers:
    """Return what a map of the field adds to the voltages (N, 2 sensors) at poses (N, 3)."""
    at = sensor_places(fit, poses)
    B = _rotate(of.at(at.reshape(-1, 2)).reshape(at.shape), -poses[:, 2])
    return np.asarray(np.einsum("kij,nkj->nki", _gains(fit), B).reshape(len(poses), -1))


def _fit(stage: str, log: Log, start: Sequence[Parameter]) -> Calibration:
    """Return the fit of a stage's parameters from a start."""
    names = [p.name for p in start]
    sensors = [n for n in names if not n.startswith("wave")]
    free = {"amplitudes": ["wave_1", "wave_5"], "sensors": [*sensors, "wave_5"]}
    free["waves"] = [*sensors, *(n for n in names if n.startswith("wave") and n != "wave_1")]
    readings = {n: units.NOISE for n in log.samples if n not in units.REFERENCES}
    deviations = {"references": units.REFERENCES, "readings": readings}
    return calibration.calibrate(voltages, log, start, free=free[stage], **deviations)


def _field_residuals(fit: Calibration, log: Log) -> tuple[Numbers, Numbers]:
    """Return the places (sensors N, 2) of the sensors, and the residuals there in the field's axes, V."""
    poses = log.columns(tuple(units.REFERENCES))
    e = np.linalg.solve(_gains(fit)[None], fit.residuals(log).reshape(len(poses), -1, 2, 1))[..., 0]
    return sensor_places(fit, poses).reshape(-1, 2), _rotate(e, poses[:, 2]).reshape(-1, 2)


def _gains(fit: Calibration) -> Numbers:
    return np.array([[fit.values[f"gain_{n}{e}"] for e in MATRIX] for n in letters(fit.values)]).reshape(-1, 2, 2)


def _pairs(fit: Calibration, name: str) -> Numbers:
    return np.array([[fit.values[f"{name}_{n}{axis}"] for axis in "xy"] for n in letters(fit.values)])


def sensor_places(fit: Calibration, poses: Numbers) -> Numbers:
    """Return the places of the sensors (N, sensors, 2) at poses (N, 3), m."""
    r = _pairs(fit, "place")
    return np.asarray(poses[:, None, :2] + _rotate(np.broadcast_to(r, (len(poses), *r.shape)), poses[:, 2]))


def _rotate(v: Numbers, yaw: Numbers) -> Numbers:
    c, s = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
    return np.stack([c * v[..., 0] - s * v[..., 1], s * v[..., 0] + c * v[..., 1]], axis=-1)


def _map(fit: Calibration, log: Log) -> ResidualMap:
    return lookup_table.fit(*_field_residuals(fit, log), lookup_table.square(MAP_REACH, MAP_SPACING))


def _table(fit: Calibration, of: ResidualMap | None) -> ResidualMap:
    """Return the estimator's table: the waves that its model does not have, and the map, V."""
    grid = lookup_table.square(MAP_REACH, config.array().pitch / PER_PITCH)
    end = -grid.low[0]
    along = np.linspace(-end, end, FINE * (grid.size[0] - 1) + 1)
    at = np.array(np.meshgrid(along, along)).reshape(2, -1).T
    field = _extra_waves(fit.values, at) + (of.at(at) if of else 0.0)
    return lookup_table.fit(at, field, grid, TABLE_SMOOTHING, UNIT)


def _extra_waves(values: Mapping[str, float], at: Numbers) -> Numbers:
    further = [n for n in AXIAL if n not in MODEL_WAVES]
    return np.stack(_waves(values, at[:, 0], at[:, 1], further, CROSS), axis=-1)


def predict(fit: Calibration, table: ResidualMap | None, poses: Numbers) -> Numbers:
    """Return the voltages (N, sensors, 2) at poses (N, 3) by the estimator's model: two waves an axis, and a table."""
    at = sensor_places(fit, poses)
    B = np.stack(_waves(fit.values, at[..., 0], at[..., 1], MODEL_WAVES, ()), axis=-1)
    if table is not None:
        B = B + table.at(at.reshape(-1, 2)).reshape(B.shape)
    return np.einsum("kij,nkj->nki", _gains(fit), _rotate(B, -poses[:, 2])) + _pairs(fit, "offset")


def _pose_errors(fit: Calibration, log: Log, residuals: Numbers) -> Numbers:
    """Return the errors (N, 3) of the weighted least-squares pose with the amplitude unknown, linearised."""
    h, _, by_q = fit.channels.evaluate(log, np.array(list(fit.values.values())))
    H = np.concatenate([by_q, h[:, :, None]], axis=2)
    return np.asarray(np.linalg.pinv(H) @ residuals[:, :, None])[:, :3, 0]


@cache
@cached
def of_unit(field: str, seed: int, stage: str = STAGES[-1], name: str = config.NAME) -> UnitCalibration:
    """Return the calibration of a unit by its field and seed, with the sensors of an estimator."""
    return calibrate(units.draw(field, seed, name), stage)
