"""The report's parts on the field: waves, spacing of sensors, model (2) of a scan, and how it goes with the gap."""

import casadi as ca
import numpy as np

from designs.hall_position import drawings
from designs.hall_position.paper import field as paper_field
from designs.hall_position.paper.stage import Stage
from models import concentrated_field, hall_array, hall_figures, hall_scan
from models.concentrated_field import CROSS, PARAMETERS, on_axes
from models.hall_figures import Surface
from synth.report import figures, page

POINTS = 97  # of a field's picture, along a pitch
HEIGHTS = (2e-3, 2.5e-3, 3e-3, 3.5e-3, 4e-3)  # m
SCAN, SEED = 24, 4  # places along a pitch at each height; of its noise
TURNED = np.radians(1.0)  # about Z, of the sensor whose model is told by the gap, so that gamma is seen
MADE = (*on_axes((1, 3, 5, 7, 9)), *CROSS)
PRINTED = 3  # spacings of (3)
DECAYING = ("alpha", "beta", "gamma")
GREEK = {"alpha": "α", "beta": "β", "gamma": "γ"}

FIELD = (
    ("", "B = -∇Φ,  Φ = Σ_k Φ_k e^{i k·r - κ z},  κ = |k|,  k = (2 π / l) (p, q)"),
    ("", "Φ_k = (1 - e^{-κ Δ}) / (2 κ) (J_z - i k·J / κ)"),
    ("", "ideal:  B_X = Σ A_n sin(n ω X),  |A_n| = (2 √2 / (π n)) m (1 - e^{-n ω l / 4}) e^{-n ω z},  n = 1, 5, 9, .."),
    ("K(2)", "B_X = c + α sin(ω X) + β sin(5 ω X) + γ sin(ω Y) + δ sin(5 ω Y),  ω = 2 π / l"),
    ("K(2)", "B_Y = c + α sin(ω Y) + β sin(5 ω Y) + γ sin(ω X) + δ sin(5 ω X)"),
    ("K(3)", "spacing = (1/4 + n/2) l"),
)


def field(stage: Stage) -> page.Section:
    """Return the matrix' field: harmonics, Figs. 3 and 4, and the spacing of Fig. 5."""
    text = page.Text(
        "Blocks of one pitch, each with its magnetisation, make waves of which every amplitude is a closed expression "
        "in remanences, sides and distance. The fabricated matrix has weak blocks of 1.10 T where an ideal one had "
        "1.01 T: the harmonics 3 and 7 appear, and waves of X and Y together, (2, ±1) and (1, ±2), of which (2) has "
        "none. At the sensors' height the wave (2, 1) is larger than the 9th harmonic. β is negative where α is "
        "positive."
    )
    drawn = drawings.coefficients(
        [(f"{1e3 * z:g} mm above", hall_figures.coefficients(z=z)) for z in (0.0, stage.height)]
    )
    third = page.Figure(
        figures.svg(drawn, "coefficients"),
        "Amplitudes of B_X at the blocks' face and at the sensors' height.",
        "Fig. 3: coefficients at 0 mm; the fundamental and the 5th are the largest.",
    )
    fourth = page.Figure(
        figures.svg(drawings.field(hall_figures.surface(POINTS, stage.height), surface(stage)), "field"),
        "B_X over the target area, a pitch by a pitch, 3 mm above the matrix. As made it depends on Y too.",
        "Fig. 4: the ideal matrix.",
    )
    blocks = (text, page.Equations(FIELD), _parameters(stage), _amplitudes(stage), third, fourth, _spacing(stage))
    return page.Section("Field", blocks)


def surface(stage: Stage, points: int = POINTS) -> Surface:
    """Return B_X above the blocks that were made on a grid over a pitch."""
    X, Y, z = (ca.SX.sym(name) for name in "XYz")
    B = concentrated_field.field(stage.waves(concentrated_field.up_to(5) + on_axes((7, 9))), X, Y, z)
    side = np.linspace(0.0, stage.pitch, points)
    at = (each.reshape(1, -1) for each in np.meshgrid(side, side, indexing="ij"))
    flux = ca.Function("B_X", [X, Y, z], [B.x]).map(points**2)(*at, stage.height).full()
    return Surface(side, side, flux.reshape(points, points))


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
    numbers = (1, 3, 5, 7, 9)
    rows: list[tuple[page.Cell, ...]] = []
    for label, ideal in (("ideal", True), ("as made", False)):
        for z in (0.0, stage.height):
            cross = 0.0 if ideal else stage.cross(z)
            values = np.where(np.abs(found := stage.amplitudes(numbers, z, ideal)) < paper_field.NONE, 0.0, found)
            rows.append((label, f"{1e3 * z:g} mm", *values.tolist(), cross))
    columns = ("matrix", "above", *(f"n = {n}" for n in numbers), "(2, ±1)")
    return page.Table("Amplitudes of B_X, T", columns, tuple(rows))


def _spacing(stage: Stage) -> page.Figure:
    waves = stage.waves(on_axes(hall_figures.HARMONICS))
    printed = hall_figures.spacings(PRINTED, stage.pitch)
    line = hall_figures.line(waves, float(printed[0]), height=stage.height)
    drawn = drawings.spacing(line, hall_figures.insensitive(waves, 240, stage.height), printed)
    caption = (
        "Two sensors 3/4 pitch apart on a line: where one has no slope the other has one. On the right the least "
        "√(slope² + slope²) in the pitch by the spacing; it vanishes for multiples of half a pitch."
    )
    return page.Figure(figures.svg(drawn, "spacing"), caption, "Fig. 5 and (3).")


def fit(stage: Stage) -> page.Section:
    """Return model (2) of a scan, Fig. 8, and its coefficients by the gap."""
    found = paper_field.fitted(stage)
    left = 1e3 * np.abs(found.residual)
    text = page.Text(
        "Batch least squares fits (2) to the voltages of a scan; measured scans are read from files with named columns "
        f"in stated units. Here the scan is computed above six pitches of blocks. The fit leaves {left.max():.1f} mV "
        f"at most and {np.sqrt(np.mean(left**2)):.1f} mV rms, many times the noise: the model's error, not the "
        "noise, decides the accuracy. The pattern is that of the waves (2, ±1)."
    )
    figure = page.Figure(
        figures.svg(drawings.residuals(found), "residuals"),
        f"Voltage of a sensor's axis along X at {stage.chain.gain:g} V/T; (c) has a scale of its own.",
        "Fig. 8: the error is less than 200 mV.",
    )
    return page.Section("Batch least squares", (text, figure), (_gap(stage),))


def _gap(stage: Stage) -> page.Section:
    sensor = hall_array.Sensor((0.0, 0.0, 0.0), misalignment=(0.0, 0.0, TURNED))
    one, waves = hall_array.HallArray((sensor,), stage.chain), stage.waves(MADE)
    fits = {
        z: hall_scan.fit(
            hall_scan.scanned(one, waves, hall_scan.places(stage.pitch, SCAN, (z,)), SEED + k), "V_ax", stage.pitch
        )
        for k, z in enumerate(HEIGHTS)
    }
    decays = [hall_scan.decay(fits, name, stage.pitch, stage.height) for name in DECAYING]
    values = {GREEK[name]: np.array([f.estimate[name] for f in fits.values()]) for name in DECAYING}
    drawn = drawings.gap(np.array(HEIGHTS), values, decays, stage.height)
    text = page.Text(
        "A wave of the number n decays as exp(-n ω z): with that, fits at one height hold at all. Scans with noise at "
        f"five heights, of a sensor turned by {np.degrees(TURNED):g}°, which shows as γ, agree: the law lies in the "
        "intervals of 95 %. This is the model of the six degrees of freedom."
    )
    figure = page.Figure(figures.svg(drawn, "gap"), "Coefficients by the height, dots, and the law, lines.")
    return page.Section("Dependence on the air gap", (text, figure, _coefficients(fits), _decays(decays)))


def _coefficients(fits: dict[float, hall_scan.Fit]) -> page.Table:
    rows: list[tuple[page.Cell, ...]] = []
    for z, found in fits.items():
        e = found.estimate
        told = (
            f"{1e3 * e[n]:.2f} ± {1e3 * half:.2f}"
            for n, half in zip(e.names, np.diff(e.intervals)[:, 0] / 2, strict=True)
        )
        rows.append((f"{1e3 * z:g}", *(t.replace("-", "−") for t in told), 1e3 * float(np.abs(found.residual).max())))
    columns = ("height, mm", "c", "α", "β", "γ", "δ", "largest residual, mV")
    return page.Table("Coefficients of (2) in mV with intervals of 95 %", columns, tuple(rows))


def _decays(decays: list[hall_scan.Decay]) -> page.Table:
    rows: list[tuple[page.Cell, ...]] = []
    for each in decays:
        low, high = each.estimate.intervals[1]
        rows.append(
            (
                GREEK[each.coefficient],
                each.estimate["rate"],
                low,
                high,
                each.law,
                "yes" if low <= each.law <= high else "NO",
            )
        )
    columns = ("coefficient", "−d ln|·| / dz, 1/m", "from", "to", "n ω, 1/m", "law within")
    return page.Table("Rates of decay with intervals of 95 %", columns, tuple(rows))
