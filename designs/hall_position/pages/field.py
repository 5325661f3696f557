"""Field in the report: waves, spacing of sensors, fit of model (2) to a scan, and its dependence on the air gap."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from designs.hall_position.paper import field as audited
from designs.hall_position.paper import field_figures, scan_fit
from designs.hall_position.paper.field_figures import Surface
from designs.hall_position.paper.scan_fit import Decay, Fit
from models import concentrated_field, hall_array
from models.concentrated_field import CROSS, PARAMETERS, orders_on_axes
from models.hall_stage import Stage
from synth.report import maps
from synth.report.figures import COLOURS
from synth.report.maps import Chart, Line, Map
from synth.report.prose import Content, Rows

POINTS = 97  # of a map of the field, along a pitch
HEIGHTS = (2e-3, 2.5e-3, 3e-3, 3.5e-3, 4e-3)  # m
SCAN_POINTS = 24  # along a pitch, at each height
SEED = 4  # of the noise of the first scan
MISALIGNMENT = np.radians(1.0)  # about Z, of the scanned sensor: it makes gamma observable
WAVE_NUMBERS = (1, 3, 5, 7, 9)
FABRICATED = (*orders_on_axes(WAVE_NUMBERS), *CROSS)  # waves above blocks as made: also cross terms
PRINTED_SPACINGS = 3  # the paper gives the first three of (3)
GREEK = {"alpha": "α", "beta": "β", "gamma": "γ"}


def blocks(stage: Stage) -> dict[str, Content]:
    """Return the matrix' field with Figs. 3, 4, 5 and 8, and the dependence on the air gap."""
    fit, (fits, decays) = audited.fit_above_blocks(stage), over_gap(stage)
    residual = 1e3 * np.abs(fit.residual)  # mV
    waves = stage.waves(concentrated_field.orders_up_to(5) + orders_on_axes((7, 9)))
    above = {"ideal": stage.waves(orders_on_axes(field_figures.HARMONICS), ideal=True), "as made": waves}
    surfaces = {name: field_figures.surface(each, POINTS, stage.height) for name, each in above.items()}
    return {
        "field.parameters": _parameters(stage),
        "field.amplitudes": _amplitudes(stage),
        "field.coefficients": maps.draw([_harmonics(stage, z) for z in (0.0, stage.height)], 3.0),
        "field.surface": _surface(surfaces),
        "field.sections": _sections(surfaces),
        "field.spacing": _spacing(stage),
        "fit.largest_mV": float(residual.max()),
        "fit.rms_mV": float(np.sqrt(np.mean(residual**2))),
        "fit.gain": stage.chain.gain,
        "fit.residuals": _residuals(fit),
        "gap.misalignment_deg": float(np.degrees(MISALIGNMENT)),
        "gap.figure": _gap(stage, fits, decays),
        "gap.coefficients": [_coefficients(z, fit) for z, fit in fits.items()],
        "gap.decays": [_decay(each) for each in decays],
    }


def over_gap(stage: Stage) -> tuple[Mapping[float, Fit], list[Decay]]:
    """Return fits of model (2) at HEIGHTS, of a sensor with MISALIGNMENT, and the decay of its coefficients."""
    sensor = hall_array.Sensor((0.0, 0.0, 0.0), misalignment=(0.0, 0.0, MISALIGNMENT))
    array, waves = hall_array.HallArray((sensor,), stage.chain), stage.waves(FABRICATED)
    fits = {}
    for k, z in enumerate(HEIGHTS):
        log = scan_fit.simulate_scan(array, waves, scan_fit.places(stage.pitch, SCAN_POINTS, (z,)), SEED + k)
        fits[z] = scan_fit.fit(log, "V_ax", stage.pitch)
    return fits, [scan_fit.decay(fits, name, stage.pitch, stage.height) for name in GREEK]


def _parameters(stage: Stage) -> Rows:
    chain = stage.chain
    return [
        *((p.name, p.value, p.unit, p.source) for p in PARAMETERS),
        ("height", 1e3 * stage.height, "mm", "Fig. 4, of the sensors above the blocks"),
        ("sensitivity", chain.sensitivity, "V/T", "assumed: with 0.1 V/T 10 µm would not be met"),
        ("amplifier", chain.amplifier, "", "section II-C"),
        ("filter", chain.corner, "Hz", "section II-C; of first order"),
        ("noise", 1e3 * chain.noise, "mV", "section II-C, rms behind the filter"),
        ("volume", "250 × 250 × 200", "µm", "section III-A; voltages are means over it"),
    ]


def _amplitudes(stage: Stage) -> Rows:
    rows = []
    for label, ideal in (("ideal", True), ("as made", False)):
        for z in (0.0, stage.height):
            sizes = stage.amplitudes(WAVE_NUMBERS, z, ideal)
            shown = np.where(np.abs(sizes) < audited.NEGLIGIBLE_AMPLITUDE, 0.0, sizes).tolist()
            rows.append((label, f"{1e3 * z:g} mm", *shown, 0.0 if ideal else stage.cross(z)))
    return rows


def _harmonics(stage: Stage, z: float) -> Chart:
    """Return Fig. 3: amplitudes by number, above ideal and fabricated blocks, z in m above the blocks."""
    first = list(range(1, 10))
    numbers, sizes = [*first, 11], [*stage.amplitudes(first, z), stage.cross(z)]
    fabricated = Line(numbers, sizes, "as made", {"ls": "", "marker": "s", "ms": 4})
    ideal = Line(first, stage.amplitudes(first, z, True), "ideal", {"ls": "", "marker": "o", "ms": 7, "mfc": "none"})
    ticks = {"xlim": (0.5, numbers[-1] + 0.5), "xticks": numbers, "xticklabels": [*map(str, first), "(2, 1)"]}
    labels = "number n of sin(n ω X)", "amplitude of B_X, T", f"{1e3 * z:g} mm above"
    return Chart([ideal, fabricated], *labels, levels=(0.0,), legend="upper right", options=ticks)


def _surface(above: Mapping[str, Surface]) -> Figure:
    """Return Fig. 4: B_X over the target area above ideal and fabricated blocks."""
    shown = [Map(f"B_X, {name}, mT", 1e3 * surface.B_X) for name, surface in above.items()]
    return maps.signed_maps(shown, [(0.0, 1e3 * float(above["ideal"].X[-1]))] * 2)


def _sections(above: Mapping[str, Surface]) -> Figure:
    """Return four sections along X of each surface."""
    lines = [
        Line(1e3 * surface.X, 1e3 * surface.B_X[:, k], "" if k else name, {"color": colour, "lw": 0.8})
        for (name, surface), colour in zip(above.items(), COLOURS, strict=False)
        for k in range(0, len(surface.Y) - 1, (len(surface.Y) - 1) // 4)
    ]
    return maps.draw([Chart(lines, "X, mm", "B_X, mT", legend="upper right")], 2.6)


def _spacing(stage: Stage) -> Figure:
    """Return Fig. 5: voltages of two sensors along X, and the least slope of a pair over its spacing."""
    waves, printed = (
        stage.waves(orders_on_axes(field_figures.HARMONICS)),
        field_figures.spacings(PRINTED_SPACINGS, stage.pitch),
    )
    line = field_figures.line(waves, float(printed[0]), height=stage.height)
    slopes = field_figures.least_slopes(waves, 240, stage.height)
    X, pitch, top = 1e3 * line.X, line.X[-1], 1e-3 * float(slopes.least.max())
    first_is_steeper = np.abs(line.slopes[0]) >= np.abs(line.slopes[1])
    voltages = []
    for k, (volts, is_steeper) in enumerate(zip(line.volts, (first_is_steeper, ~first_is_steeper), strict=True)):
        voltages.append(Line(X, volts, style={"color": COLOURS[k], "lw": 0.8}))
        bold = {"color": COLOURS[k], "lw": 2.8}
        voltages.append(Line(X, np.where(is_steeper, volts, np.nan), f"sensor {'AB'[k]}", bold))
    least = [Line(slopes.spacing / pitch, 1e-3 * slopes.least)]
    dashed = {"color": COLOURS[1], "ls": "--"}
    least += [Line([at, at], [0.0, top], "" if k else "(3)", dashed) for k, at in enumerate(printed / pitch)]
    limits = {"ylim": (0.0, None)}
    right = Chart(least, "spacing, pitches", "least slope of the pair, V/mm", legend="lower right", options=limits)
    return maps.draw([Chart(voltages, "X, mm", "voltage, V; bold: the steeper", legend="upper right"), right], 2.8)


def _residuals(fit: Fit) -> Figure:
    """Return Fig. 8: a scan of a voltage, its fit by model (2), and the residual; places are the centres of squares."""
    n, half = int(np.sqrt(len(fit.measured))), fit.Y[1] / 2
    sides = [(1e3 * float(v[0] - half), 1e3 * float(v[-1] + half)) for v in (fit.X, fit.Y)]
    shown = {"(a) measured, V": fit.measured, "(b) model (2), V": fit.modelled, "(c) residual, mV": 1e3 * fit.residual}
    return maps.signed_maps([Map(title, values.reshape(n, n)) for title, values in shown.items()], sides)


def _gap(stage: Stage, fits: Mapping[float, Fit], decays: list[Decay]) -> Figure:
    """Return |alpha|, |beta|, .. of fits over the height, and the law of decay from the sensors' height."""
    z, lines = np.linspace(HEIGHTS[0], HEIGHTS[-1], 50), []
    for (name, greek), decay, colour in zip(GREEK.items(), decays, COLOURS, strict=False):
        law = np.exp(decay.estimate["ln_at_height"] - decay.law * (z - stage.height))
        dots = {"ls": "", "marker": "o", "ms": 4, "color": colour}
        sizes = [abs(f.estimate[name]) for f in fits.values()]
        lines += [Line(1e3 * z, law, style={"color": colour}), Line(1e3 * np.array(HEIGHTS), sizes, f"|{greek}|", dots)]
    limits = {"xlim": (1e3 * HEIGHTS[0] - 0.05, 1e3 * HEIGHTS[-1] + 0.05)}
    labels = "height above the matrix, mm", "coefficient, V"
    return maps.draw([Chart(lines, *labels, log="y", legend="center right", options=limits)], 2.9)


def _coefficients(z: float, fit: Fit) -> tuple[str | float, ...]:
    e = fit.estimate
    halves = np.diff(e.intervals)[:, 0] / 2
    shown = (f"{1e3 * e[n]:.2f} ± {1e3 * half:.2f}" for n, half in zip(e.parameters, halves, strict=True))
    return f"{1e3 * z:g}", *(t.replace("-", "−") for t in shown), 1e3 * float(np.abs(fit.residual).max())


def _decay(decay: Decay) -> tuple[str | float, ...]:
    low, high = decay.estimate.intervals[1]
    in_interval = "yes" if low <= decay.law <= high else "NO"
    return GREEK[decay.coefficient], decay.estimate["rate"], low, high, decay.law, in_interval
