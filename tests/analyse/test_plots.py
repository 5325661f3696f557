"""Plots on request: the phase as a curve, signals with their units, and nothing of pyplot is touched."""

import subprocess
import sys

import numpy as np
import pytest

from synth.analyse import plots
from synth.errors import SignalError


@pytest.mark.parametrize(("low", "high"), [(-180.0, 0.0), (-360.0, -180.0)])
def test_the_phase_at_the_crossing_lies_in_one_turn(low: float, high: float) -> None:
    w = np.geomspace(0.1, 100, 500)
    L = 1 / (1j * w) ** 2 * (1 + 1j * w if low == -180.0 else 1 / (1 + 1j * w))
    assert low < float(np.interp(1.0, w, plots.unwrapped_phase(w, L, 1.0))) < high


def test_signals_over_time_have_units_where_they_are_known() -> None:
    t = np.arange(5) / 10
    figure = plots.over_time(t, {"gap": t, "fault": t > 0.2}, {"gap": "m"})
    assert [axes.get_ylabel() for axes in figure.axes] == ["gap [m]", "fault"]
    with pytest.raises(SignalError, match="name 1 to 12"):
        plots.over_time(t, {}, {})


def test_matplotlib_is_loaded_for_a_figure_alone_and_pyplot_never() -> None:
    script = (
        "import sys\nfrom synth.analyse import plots\nbefore = 'matplotlib' in sys.modules\n"
        "plots.over_time([0.0, 0.1], {'gap': [1.0, 2.0]}, {'gap': 'm'})\n"
        "print(before, 'matplotlib' in sys.modules, 'matplotlib.pyplot' in sys.modules)"
    )
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert run.stdout.split() == ["False", "True", "False"]
