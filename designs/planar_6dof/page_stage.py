"""The report's parts on the stage: its model, its sensing and filter, and the failures of which nobody learns."""

from collections.abc import Sequence

import numpy as np

from designs.planar_6dof import allocation, drawings, filtering, interface, sensing_maps
from designs.planar_6dof import loop as simulated
from models import hall_calibration
from synth.plant import Plant
from synth.report import figures, page, sections
from synth.report.notation import number
from synth.simulate.experiment import Experiment
from synth.simulate.scenario import Trajectory
from synth.statespace import Array
from synth.timing import Discrete

SYMBOLS = {"phi": "φ", "theta": "θ", "psi": "ψ"}
REST, FIRST, SHOWN = "standstill", 1.0, 2.0  # its name, s of it that are left out, s that are drawn
DRAWN = 41  # places over a pitch in x and in y of a picture, one where voltages are 0
PLACES = 9  # over a pitch in x and in y, at which every failure is followed: one where voltages are 0

STAGE = (
    ("Y(17)", "f_y = K i_Q,  f_z = K i_D,  K = 3/(2 π) μ_0 M_0 η_0 N_m G e^{-γ z_0}"),
    ("Y(17)", "G = √2 w l^2 / π^2 (1 - e^{-γ Γ}) (1 - e^{-γ Δ}),  γ = 2 π / l,  η_0 = turns / area"),
    ("Y(17)", "i_A = α,  i_B = (√3 β - α) / 2,  i_C = -(√3 β + α) / 2,  α + j β = e^{j γ y} (i_Q + j i_D)"),
    ("Y(18)", "M x'' = cos φ f_C - sin φ (f_A + f_B),  M y'' = sin φ f_C + cos φ (f_A + f_B)"),
    ("Y(18)", "I_{zz} φ'' = a (f_B - f_A) - c f_C"),
    ("Y(19)", "M z'' = f_{Az} + f_{Bz} + f_{Cz} - K_z z"),
    ("Y(20)", "I_{xx} θ'' = c f_{Cz} - b (f_{Az} + f_{Bz}) - K_θ θ,  I_{yy} ψ'' = a (f_{Az} - f_{Bz}) - K_ψ ψ"),
)
SENSING = (
    ("Y(1)", "V_{ax} = A S(t_x) + φ A S(t_y),  V_{bx} = -A C(t_x) + φ A S(t_y),  t = 2 π x / l"),
    ("Y(1)", "V_{ay} = A S(t_y) - φ A S(t_x),  V_{cy} = -A C(t_y) - φ A S(t_x)"),
    ("Y(2)", "s = V_{ax} - φ_p V_{ay},  c = -V_{bx} + φ_p V_{ay},  r = s c / max(s^2, c^2)"),
    ("Y(4)", "x = f(r) + n l / 2,  |s| ≤ |c|"),
    ("Y(4)", "x = ±l/4 - f(r) + n l,  |s| > |c|,  f(r) = p_0 r + p_1 r^3 + p_2 r^5 + p_3 r^7"),
    ("", "φ = φ_p + (h_1 r_1 - h_2 r_2 + W h_3 r_3 / A^2) / (h_1^2 + h_2^2 + W h_3^2 / A^2 + R A^2)"),
)
FILTER = (
    ("Y(11)", "q_{n+1} = A q_n + Γ w_n,  q = (position, velocity, acceleration)"),
    ("Y(16)", "e = raw - q_p,  q = q_p + K e,  q_p ← A q"),
)


def model(plant: Plant) -> page.Section:
    """Return the force law, the equations of motion and the parameters."""
    text = page.Text(
        "K is the Lorentz force of the windings' current density in the field, integrated over bands, height and "
        "phases; (17) prints 1/2 where the integral gives 3/(2π), which makes the printed force 4.7 % too large. φ, "
        "θ and ψ turn about Z, X and Y; motors A and B push along the platen's y, C along its x, all three up. The "
        "arms a, b and c are not printed: (26) implies a, and b = a, c = 2 a make the rows x and z of Table 3 move "
        "these axes alone. (26) leaves out the yaw that motor C makes; the allocation does not."
    )
    return page.Section("Model", (text, page.Equations(STAGE), sections.parameters(plant), _derived(plant)))


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
    text = page.Text(
        "S and C are the sine and cosine of the field with its harmonics 5 and 9, φₚ is the predicted yaw. Of the "
        "two voltages of an axis the one nearer to zero is in its sensitive interval and is used; it is divided by "
        "the other one, so that a common change of amplitude drops out, and the eight sections of a pitch join "
        "without a jump. f is arctangent and calibration in one. The count n of pitches is the one that comes "
        "nearest to the predicted position: it cannot drift as the sum of differences in (4), (5) does. (2) and (3) "
        "print a sine where an arcsine is meant. The yaw is taken about its prediction, from what sensors B and C "
        "read beside A, r₁ and r₂, and from the squared amplitudes, r₃."
    )
    caption = "Voltages of x over a pitch, in eight sections, and the error of the raw position at yaw 0."
    beside = "Figs. 3 and 4: one of two sensors is always in its sensitive interval; they switch every quarter pitch."
    waves = page.Figure(figures.svg(drawings.pitch(plant), "pitch"), caption, beside)
    caption = "The raw yaw over a pitch in x and y: its error where a yaw of 6 mrad is predicted as 7, and its noise."
    maps = page.Figure(figures.svg(drawings.yaw_maps(plant), "yaw-maps"), caption)
    parts = () if filtered is None else (_filter(time, filtered),)
    return page.Section("Sensing", (text, page.Equations(SENSING), waves, maps), parts)


def _filter(time: Discrete, experiments: Sequence[Experiment]) -> page.Section:
    text = page.Text(
        "One filter for each axis, with the steady gain: (14) as printed predicts P and lowers it never, under which K "
        "tends to 1 and nothing is filtered. K is on the position, on T times the velocity and on T²/2 times the "
        "acceleration. Residual and error of P are those of its Riccati equation, relative."
    )
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
    return page.Section("Kalman filter of the position", (text, page.Equations(FILTER), table, *drawn))


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
    text = page.Text(
        "A Hall voltage that contradicts the others is named, and the controller latches a few samples later. What no "
        "comparison can tell is shown here: at rest all that sticks, and voltages that drop to zero near their own "
        "zeros. Computed over a pitch from the sensing Block without noise. What sticks is moved along the voltage's "
        f"own axis at {sensing_maps.SPEED:g} m/s; 'moved' is the longest way until it is noticed, ∞ where it is not, "
        "'named' and 'alone' are shares of the noticed failures in which it is among those named, or the only one."
    )
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
    return page.Section("Failures that cannot be detected", (text, page.Figure(drawn, caption), table))
