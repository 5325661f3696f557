"""The field in the report: waves, spacing of sensors, model (2) of a scan, and how it goes with the gap."""

from collections.abc import Mapping

import casadi as ca
import numpy as np

from designs.hall_position.pages import drawings
from designs.hall_position.paper import field as audited
from designs.hall_position.paper.stage import Stage
from models import concentrated_field, hall_array, hall_figures, hall_scan
from models.concentrated_field import CROSS, PARAMETERS, on_axes
from models.hall_figures import Surface
from models.hall_scan import Decay, Fit
from synth.report import page
from synth.report.maps import figure
from synth.report.prose import Value

POINTS = 97  # of a field's picture, along a pitch
HEIGHTS = (2e-3, 2.5e-3, 3e-3, 3.5e-3, 4e-3)  # m
SCAN, SEED = 24, 4  # places along a pitch at each height; of its noise
TURNED = np.radians(1.0)  # about Z, of the sensor whose model is told by the gap, so that gamma is seen
MADE = (*on_axes((1, 3, 5, 7, 9)), *CROSS)
NUMBERS = (1, 3, 5, 7, 9)
PRINTED = 3  # spacings of (3)
GREEK = {"alpha": "α", "beta": "β", "gamma": "γ"}


def blocks(stage: Stage) -> dict[str, Value]:
    """Return the matrix' field with Figs. 3, 4, 5 and 8, and the dependence on the air gap."""
    fit, (fits, decays) = audited.fitted(stage), over_gap(stage)
    left = 1e3 * np.abs(fit.residual)
    return {
        "field.parameters": _parameters(stage),
        "field.amplitudes": _amplitudes(stage),
        "field.coefficients": figure(
            "coefficients",
            drawings.coefficients(
                [(f"{1e3 * z:g} mm above", hall_figures.coefficients(z=z)) for z in (0.0, stage.height)]
            ),
            "Amplitudes of B_X at the blocks' face and at the sensors' height.",
            "Fig. 3: coefficients at 0 mm; the fundamental and the 5th are the largest.",
        ),
        "field.surface": figure(
            "field",
            drawings.field(hall_figures.surface(POINTS, stage.height), surface(stage)),
            "B_X over the target area, a pitch by a pitch, 3 mm above the matrix. As made it depends on Y too.",
            "Fig. 4: the ideal matrix.",
        ),
        "field.spacing": _spacing(stage),
        "fit.largest_mV": float(left.max()),
        "fit.rms_mV": float(np.sqrt(np.mean(left**2))),
        "fit.residuals": figure(
            "residuals",
            drawings.residuals(fit),
            f"Voltage of a sensor's axis along X at {stage.chain.gain:g} V/T; (c) has a scale of its own.",
            "Fig. 8: the error is less than 200 mV.",
        ),
        "gap.turned_deg": float(np.degrees(TURNED)),
        "gap.figure": _gap(stage, fits, decays),
        "gap.coefficients": _coefficients(fits),
        "gap.decays": _decays(decays),
    }


def surface(stage: Stage, points: int | None = None) -> Surface:
    """Return B_X above the blocks that were made on a grid over a pitch."""
    X, Y, z = (ca.SX.sym(name) for name in "XYz")
    B = concentrated_field.field(stage.waves(concentrated_field.up_to(5) + on_axes((7, 9))), X, Y, z)
    n = points or POINTS
    side = np.linspace(0.0, stage.pitch, n)
    at = (each.reshape(1, -1) for each in np.meshgrid(side, side, indexing="ij"))
    flux = ca.Function("B_X", [X, Y, z], [B.x]).map(n**2)(*at, stage.height).full()
    return Surface(side, side, flux.reshape(n, n))


def over_gap(stage: Stage) -> tuple[Mapping[float, Fit], list[Decay]]:
    """Return model (2) of scans at HEIGHTS of a sensor that is TURNED, and how its coefficients decay."""
    sensor = hall_array.Sensor((0.0, 0.0, 0.0), misalignment=(0.0, 0.0, TURNED))
    one, waves = hall_array.HallArray((sensor,), stage.chain), stage.waves(MADE)
    fits = {}
    for k, z in enumerate(HEIGHTS):
        log = hall_scan.scanned(one, waves, hall_scan.places(stage.pitch, SCAN, (z,)), SEED + k)
        fits[z] = hall_scan.fit(log, "V_ax", stage.pitch)
    return fits, [hall_scan.decay(fits, name, stage.pitch, stage.height) for name in GREEK]


def _parameters(stage: Stage) -> page.Table:
    chain = stage.chain
    rows: list[tuple[page.Cell, ...]] = [(p.name, p.value, p.unit, p.source) for p in PARAMETERS]
    rows += [
        ("height", 1e3 * stage.height, "mm", "Fig. 4, of the sensors above the blocks"),
        ("sensitivity", chain.sensitivity, "V/T", "assumed: with 0.1 V/T 10 µm would not be met"),
        ("amplifier", chain.amplifier, "", "section II-C"),
        ("filter", chain.corner, "Hz", "section II-C; of first order"),
        ("noise", 1e3 * chain.noise, "mV", "section II-C, rms behind the filter"),
        ("volume", "250 × 250 × 200", "µm", "section III-A; voltages are means over it"),
    ]
    return page.Table("Matrix, sensors and their chain", ("name", "value", "unit", "source"), tuple(rows))


def _amplitudes(stage: Stage) -> page.Table:
    rows: list[tuple[page.Cell, ...]] = []
    for label, ideal in (("ideal", True), ("as made", False)):
        for z in (0.0, stage.height):
            sizes = stage.amplitudes(NUMBERS, z, ideal)
            shown = np.where(np.abs(sizes) < audited.NONE, 0.0, sizes).tolist()
            rows.append((label, f"{1e3 * z:g} mm", *shown, 0.0 if ideal else stage.cross(z)))
    columns = ("matrix", "above", *(f"n = {n}" for n in NUMBERS), "(2, ±1)")
    return page.Table("Amplitudes of B_X, T", columns, tuple(rows))


def _spacing(stage: Stage) -> page.Figure:
    waves = stage.waves(on_axes(hall_figures.HARMONICS))
    printed = hall_figures.spacings(PRINTED, stage.pitch)
    line = hall_figures.line(waves, float(printed[0]), height=stage.height)
    caption = (
        "Two sensors 3/4 pitch apart on a line: where one has no slope the other has one. On the right the least "
        "√(slope² + slope²) in the pitch by the spacing; it vanishes for multiples of half a pitch."
    )
    drawn = drawings.spacing(line, hall_figures.insensitive(waves, 240, stage.height), printed)
    return figure("spacing", drawn, caption, "Fig. 5 and (3).")


def _gap(stage: Stage, fits: Mapping[float, Fit], decays: list[Decay]) -> page.Figure:
    values = {greek: np.array([f.estimate[name] for f in fits.values()]) for name, greek in GREEK.items()}
    drawn = drawings.gap(np.array(HEIGHTS), values, decays, stage.height)
    return figure("gap", drawn, "Coefficients by the height, dots, and the law, lines.")


def _coefficients(fits: Mapping[float, Fit]) -> page.Table:
    rows: list[tuple[page.Cell, ...]] = []
    for z, fit in fits.items():
        e = fit.estimate
        halves = np.diff(e.intervals)[:, 0] / 2
        shown = (f"{1e3 * e[n]:.2f} ± {1e3 * half:.2f}" for n, half in zip(e.names, halves, strict=True))
        rows.append((f"{1e3 * z:g}", *(t.replace("-", "−") for t in shown), 1e3 * float(np.abs(fit.residual).max())))
    columns = ("height, mm", "c", "α", "β", "γ", "δ", "largest residual, mV")
    return page.Table("Coefficients of (2) in mV with intervals of 95 %", columns, tuple(rows))


def _decays(decays: list[Decay]) -> page.Table:
    rows: list[tuple[page.Cell, ...]] = []
    for each in decays:
        low, high = each.estimate.intervals[1]
        within = "yes" if low <= each.law <= high else "NO"
        rows.append((GREEK[each.coefficient], each.estimate["rate"], low, high, each.law, within))
    columns = ("coefficient", "−d ln|·| / dz, 1/m", "from", "to", "n ω, 1/m", "law within")
    return page.Table("Rates of decay with intervals of 95 %", columns, tuple(rows))
