"""Plots on request: what the curves and marks show agrees with the margins, and nothing of pyplot is touched."""

import subprocess
import sys

import control
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from synth.analyse import plots, stability_margins, time_response, transfer
from synth.errors import SignalError

LOOP = control.ss(control.tf([30.0, 900.0], [1 / 300, 1.0, 0.0, 0.0]))
LOOPS = {
    "continuous": LOOP,
    "sampled": control.c2d(LOOP, 2e-3),
    "delayed": transfer.with_delay_and_hold(LOOP, 1e-3, 1e-3),
    "conditionally stable": control.ss(control.tf([2.0], [1.0, -1.0])),
    "resonant": control.ss(control.tf([50.0], [1 / 160_000, 2 * 0.005 / 400, 1.0, 0.0])),
    "not stable": control.ss(control.tf([-2.0], [1.0, -1.0])),
    "static": control.ss([], [], [], [[0.5]], 0),
}


@pytest.mark.parametrize("name", LOOPS)
def test_a_bode_plot_marks_each_crossing_where_the_curve_has_it(name: str) -> None:
    loop = LOOPS[name]
    figure, loop_margins = plots.bode(loop), stability_margins.of_loop(loop)
    gain, phase = figure.axes
    FigureCanvasAgg(figure).draw()
    dots, diamonds = (next(line for line in gain.lines if line.get_marker() == marker) for marker in "oD")
    np.testing.assert_allclose(np.ravel(dots.get_ydata()), 0.0, atol=1e-2)
    assert len(np.ravel(dots.get_xdata())) == len(loop_margins.gain_crossings)
    inside = [
        c for c in loop_margins.phase_crossings if gain.get_xlim()[0] <= c.frequency / (2 * np.pi) <= gain.get_xlim()[1]
    ]
    assert len(np.ravel(diamonds.get_xdata())) >= len([c for c in inside if c.frequency])
    dots = next(line for line in phase.lines if line.get_marker() == "o")
    phase_margins = [c.phase_margin for c in loop_margins.gain_crossings]
    degrees = np.asarray(dots.get_ydata(), dtype=float) + 180
    np.testing.assert_allclose((degrees - phase_margins + 180) % 360 - 180, 0.0, atol=0.2)
    assert gain.get_ylabel() == "|L| [dB]" and phase.get_ylabel() == "arg L [°]"
    assert phase.get_xlabel().startswith("frequency [Hz]")
    assert ("NOT STABLE" in gain.get_title("left")) == (not loop_margins.stable)


def test_limits_are_rad_per_second_and_margins_may_be_handed_over() -> None:
    loop_margins = stability_margins.of_loop(LOOP)
    (gain, _) = plots.bode(LOOP, low=2 * np.pi, high=200 * np.pi, margins=loop_margins).axes
    np.testing.assert_allclose(gain.get_xlim(), (1.0, 100.0), rtol=1e-6)
    with pytest.raises(SignalError, match="open it at one signal"):
        plots.bode(control.ss(np.eye(2), np.eye(2), np.eye(2), np.zeros((2, 2))))
    with pytest.raises(SignalError, match="0 < low < high"):
        plots.bode(LOOP, low=10.0, high=1.0)


@pytest.mark.parametrize(("low", "high"), [(-180.0, 0.0), (-360.0, -180.0)])
def test_the_phase_at_the_crossing_lies_in_one_turn(low: float, high: float) -> None:
    w = np.geomspace(0.1, 100, 500)
    L = 1 / (1j * w) ** 2 * (1 + 1j * w if low == -180.0 else 1 / (1 + 1j * w))
    assert low < float(np.interp(1.0, w, plots.unwrapped_phase(w, L, 1.0))) < high


def test_step_responses_stand_in_a_grid_with_units() -> None:
    system = control.ss([[0, 1], [-4, -0.4]], [[0, 0], [1, 2]], np.eye(2), np.zeros((2, 2)))
    figure = plots.step(system, duration_s=20.0)
    response = time_response.step_response(system, duration_s=20.0)
    assert isinstance(figure, Figure) and len(figure.axes) == 4
    for axes, (i, j) in zip(figure.axes, np.ndindex(2, 2), strict=True):
        np.testing.assert_array_equal(axes.lines[0].get_ydata(), response.outputs[:, i, j])
        assert response.final is not None
        np.testing.assert_allclose(axes.lines[1].get_ydata(), response.final[i, j])
    assert figure.axes[-1].get_xlabel() == "time [s]" and figure.axes[0].get_title() == "step at u[0]"
    assert len(plots.step(response).axes) == 4
    wide = control.ss([[-1.0]], np.ones((1, 7)), [[1.0]], np.zeros((1, 7)))
    with pytest.raises(SignalError, match="do not fit one figure: select 1 to 6"):
        plots.step(wide)


def test_signals_over_time_have_units_where_they_are_known() -> None:
    t = np.arange(5) / 10
    figure = plots.over_time(t, {"gap": t, "fault": t > 0.2}, {"gap": "m"})
    assert [axes.get_ylabel() for axes in figure.axes] == ["gap [m]", "fault"]
    with pytest.raises(SignalError, match="name 1 to 12"):
        plots.over_time(t, {}, {})


def test_matplotlib_is_loaded_for_a_figure_alone_and_pyplot_never() -> None:
    script = (
        "import sys\nfrom synth.analyse import plots\nbefore = 'matplotlib' in sys.modules\n"
        "plots.bode(([[0.0, 1.0], [0.0, -1.0]], [[0.0], [1.0]], [[1.0, 0.0]], [[0.0]]))\n"
        "print(before, 'matplotlib' in sys.modules, 'matplotlib.pyplot' in sys.modules)"
    )
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert run.stdout.split() == ["False", "True", "False"]
