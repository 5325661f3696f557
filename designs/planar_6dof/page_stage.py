"""The report's parts on the stage: its model, its sensing and filter, and the failures of which nobody learns."""

from collections.abc import Sequence

import casadi as ca
import numpy as np

from designs.planar_6dof import allocation, drawings, filtering, interface, sensing_maps
from designs.planar_6dof import loop as simulated
from models import hall_calibration, planar_stage
from synth.plant import Plant, Symbols
from synth.report import figures, page, standard
from synth.report.figures import SYMBOLS
from synth.report.notation import number
from synth.simulate.experiment import Experiment
from synth.simulate.scenario import Trajectory
from synth.statespace import Array
from synth.timing import Discrete

REST, FIRST, SHOWN = "standstill", 1.0, 2.0  # its name, s of it that are left out, s that are drawn
DRAWN = 41  # places over a pitch in x and in y of a picture, one where voltages are 0
PLACES = 9  # over a pitch in x and in y, at which every failure is followed: one where voltages are 0


def model(plant: Plant) -> page.Section:
    """Return the equations of motion, the parameters, and the force law's figures."""
    return standard.model(plant, _forces, (_derived(plant),))


def _forces(x: Symbols, u: Symbols, p: Symbols) -> dict[str, ca.SX]:
    """Return the force of each motor along its motion by name, as the physics computes it."""
    return {f"f_{motor}": f.y for motor, f in planar_stage.motor_forces(x, u, p).items()}


def _derived(plant: Plant) -> page.Table:
    K, M, a, Izz = allocation.force_constant(plant), *(plant.parameter(n).value for n in ("M", "a", "Izz"))
    rows = (
        ("K", K, "N/A", "force of a motor per ampere, (17) with 3/(2π)"),
        ("K / M", K / M, "m/s²/A", "(26) prints 13.2547, which carries the factor 1/2 of (17)"),
        ("K a / Izz", K * a / Izz, "rad/s²/A", "(26) prints 117.15"),
        ("A", hall_calibration.of(plant).amplitude, "V", "amplitude of a Hall voltage's fundamental"),
        ("A γ", interface.volts_per_metre(plant) / 1e3, "V/mm", "its slope where it is 0"),
    )
    return page.Table("Derived", ("name", "value", "unit", "is"), rows, digits=5)


def sensing(plant: Plant, time: Discrete, filtered: Sequence[Experiment] | None) -> page.Section:
    """Return the way from six voltages to a position, its errors over a pitch, and the filter behind it.

    Of the `filtered` runs one at rest shows what the filter does; None where there is no filter.
    """
    caption = "Voltages of x over a pitch, in eight sections, and the error of the raw position at yaw 0."
    beside = "Figs. 3 and 4: one of two sensors is always in its sensitive interval; they switch every quarter pitch."
    waves = page.Figure(figures.svg(drawings.pitch(plant), "pitch"), caption, beside)
    caption = "The raw yaw over a pitch in x and y: its error where a yaw of 6 mrad is predicted as 7, and its noise."
    maps = page.Figure(figures.svg(drawings.yaw_maps(plant), "yaw-maps"), caption)
    parts = () if filtered is None else (_filter(time, filtered),)
    return page.Section("Sensing", (waves, maps), parts)


def _filter(time: Discrete, experiments: Sequence[Experiment]) -> page.Section:
    columns = ("axis", "jerk, unit²/s⁶", "noise, m or rad", "K", "poles, z", "residual", "error of P")
    rows = []
    for axis in filtering.AXES:
        found = filtering.estimator(axis, time)
        gain = found.M[:, 0] * np.array([1, time.period_s, time.period_s**2 / 2])
        poles = [f"{p.real:.4f}" + (f" ± {p.imag:.4f}i" if p.imag else "") for p in found.poles if p.imag >= 0]
        told = (", ".join(number(k) for k in gain), ", ".join(poles))
        exact = (found.certificate.residual, found.certificate.forward_error)
        rows.append((SYMBOLS.get(axis, axis), filtering.JERK[axis], filtering.DEVIATION, *told, *exact))
    table = page.Table("Kalman filters (6)-(16)", columns, tuple(rows), digits=2)
    drawn = tuple(_before_and_after(e.trajectory, time) for e in experiments if e.name == REST)
    return page.Section("Kalman filter of the position", (table, *drawn))


def _before_and_after(rest: Trajectory, time: Discrete) -> page.Figure:
    part = slice(round(FIRST / time.period_s), round((FIRST + SHOWN) / time.period_s))
    shown = seen(rest, time, part.stop)
    raw, filtered = shown["x_raw"][part], shown["x"][part]
    left = float(np.std(filtered) / np.std(raw)) if len(raw) else np.nan
    caption = (
        f"x at rest as the Hall sensors show it and behind the filter, which leaves {100 * left:.0f} % of the rms."
    )
    drawn = figures.svg(drawings.before_and_after(rest.time[part], raw, filtered), "before-after")
    return page.Figure(drawn, caption, "Fig. 5: around ±40 µm before and ±10 µm after filtering.")


def seen(run: Trajectory, time: Discrete, samples: int, predicted: bool = True) -> dict[str, Array]:
    """Return raw and filtered positions, ``x_raw`` and ``x``, in the first samples of a run; see `loop.view`."""
    view = simulated.view(time, predicted)
    u = np.array([np.asarray(run.measured[s.name][:samples], dtype=np.float64) for s in view.inputs])
    y = view.function().mapaccum(u.shape[1])(view.initial, u)[1].full()
    return dict(zip((s.name for s in view.outputs), y, strict=True))


def failures(plant: Plant, time: Discrete, filtered: bool) -> page.Section:
    """Return where a failed voltage is not noticed, and what it does until it is; `filtered` as in `Contents`."""
    silent = sensing_maps.unnoticed(plant, time, DRAWN, filtered)
    drawn = figures.svg(drawings.failures(silent, plant.parameter("l").value), "unnoticed")
    caption = "Where a voltage that drops to zero is never noticed while the platen rests: dark."
    rows: list[tuple[page.Cell, ...]] = []
    for r in sensing_maps.faults(plant, time, PLACES, filtered):
        share = float(silent[r.voltage].mean()) if r.failure == "zero" else r.unnoticed
        shares, errors = (share, r.named, r.alone), (r.moved, r.position, r.yaw)
        rows.append((r.voltage, r.failure, *(100 * v for v in shares), *(1e3 * v for v in errors)))
    columns = ("voltage", "failure", "unnoticed, %", "named, %", "alone, %", "moved, mm", "position, mm", "yaw, mrad")
    title = f"Failures of one voltage at {PLACES**2} places of a pitch: the worst of them before it is noticed"
    table = page.Table(title, columns, tuple(rows), digits=3)
    return page.Section("Failures that cannot be detected", (page.Figure(drawn, caption), table))
