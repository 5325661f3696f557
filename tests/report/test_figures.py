"""Plots show the data, keep every spike, and give equal bytes for equal data."""

import re
from collections.abc import Callable
from dataclasses import replace

import matplotlib
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from matplotlib.figure import Figure

from synth.analyse.loops import stability_margins
from synth.errors import SignalError
from synth.report import bode, figures, page, sections
from synth.report.figures import Curve, Panel
from synth.simulate.experiments import Experiment
from synth.statespace import StateSpace
from synth.timing import Continuous

UNITS = {"y": "m", "theta": "rad"}
TIME = np.arange(400) * 1e-3


def small(scale: float = 1.0) -> Figure:
    return figures.time_plot(TIME, [Panel("y", "m", (Curve("y", scale * np.sin(9 * TIME)),))])


@given(hnp.arrays(np.float64, st.integers(1, 3000), elements=st.floats(-1e6, 1e6)), st.integers(2, 200))
@settings(max_examples=60, deadline=None)
def test_decimation_keeps_the_extremes_and_the_ends(values: np.ndarray, points: int) -> None:
    at = figures.decimate(values, points)
    assert len(at) <= points + 2 and (np.diff(at) > 0).all()
    assert values[at].max() == values.max() and values[at].min() == values.min()
    assert (at[0], at[-1]) == (0, len(values) - 1)


def test_a_spike_of_one_sample_is_drawn_where_every_30th_sample_would_miss_it(run: Callable[..., Experiment]) -> None:
    experiment = run()
    gap = experiment.trajectory["y"] - experiment.references["y"]
    assert np.abs(gap[::30]).max() < 1e-5
    figure = figures.response(experiment, UNITS)
    error = np.asarray(figure.axes[1].lines[0].get_ydata(), dtype=float)
    assert error.max() == pytest.approx(1e6 * np.abs(gap).max(), rel=1e-12)
    assert error.max() > 2990


def test_signals_are_in_mm_and_mrad_and_errors_in_um_and_urad(run: Callable[..., Experiment]) -> None:
    y, e_y, theta, e_theta = figures.response(run(), UNITS, {"y": 1e-5}, (0.0, 8.0)).axes
    labels = [axes.get_ylabel() for axes in (y, e_y, theta, e_theta)]
    assert labels == ["y, mm", "|error| of y, µm", "θ, mrad", "|error| of θ, µrad"]
    assert [axes.get_yscale() for axes in (y, e_y, theta, e_theta)] == ["linear", "log", "linear", "log"]
    drawn = np.asarray(theta.lines[0].get_ydata(), dtype=float)
    assert np.abs(drawn).max() == pytest.approx(10.03, abs=0.05)
    assert np.asarray(e_theta.lines[0].get_ydata(), dtype=float).max() == pytest.approx(30, rel=1e-3)
    assert y.get_xlim() == (0.0, 8.0) and e_y.get_xlim() == pytest.approx((0.0, 60.0))
    assert np.asarray(e_y.lines[1].get_ydata(), dtype=float).tolist() == pytest.approx([10.0, 10.0])


def test_a_run_without_set_points_shows_its_signals_alone(run: Callable[..., Experiment]) -> None:
    assert len(figures.response(run(references=False), UNITS).axes) == 2


def test_a_missing_unit_and_a_wrong_length_are_refused(run: Callable[..., Experiment]) -> None:
    with pytest.raises(SignalError, match="theta without a unit"):
        figures.response(run(), {"y": "m"})
    with pytest.raises(SignalError, match="'y' of panel 'gap'"):
        figures.time_plot(TIME, [Panel("gap", "m", (Curve("y", TIME[1:]),))])
    with pytest.raises(SignalError, match="cannot begin an id"):
        figures.svg(small(), "3 mm")


def test_the_same_data_give_the_same_bytes_whatever_the_users_settings() -> None:
    before = dict(matplotlib.rcParams)
    first = figures.svg(small(), "a")
    assert dict(matplotlib.rcParams) == before
    with matplotlib.rc_context({"axes.facecolor": "red", "font.size": 30, "svg.hashsalt": "x", "svg.fonttype": "path"}):
        assert figures.svg(small(), "a") == first
    assert figures.svg(small(1.1), "a") != first


def test_an_svg_bears_no_date_no_program_and_only_ids_of_its_own() -> None:
    first, second = (figures.svg(small(), name) for name in "ab")
    ids = [re.findall(r' id="([^"]*)"', text) for text in (first, second)]
    assert ids[0] and not set(ids[0]) & set(ids[1]) and all(i.startswith("a-") for i in ids[0])
    assert set(re.findall(r"url\(#([^)]+)\)|href=\"#([^\"]+)\"", first))
    referred = {a or b for a, b in re.findall(r"url\(#([^)]+)\)|href=\"#([^\"]+)\"", first)}
    assert referred == set(ids[0])
    assert "<metadata" not in first and "atplotlib" not in first and first.startswith("<svg")


def test_coordinates_are_shortened_but_stay_within_a_hundredth() -> None:
    figure = small()
    text = figures.svg(figure, "a")
    assert max(len(d) for d in re.findall(r"\.(\d+)", " ".join(re.findall(r' d="([^"]*)"', text)))) == 2


def test_a_path_in_space_keeps_its_extremes() -> None:
    t = np.linspace(0, 60, 60_000)
    path = np.array([0.03 * np.cos(4.7 * t), 0.03 * np.sin(4.7 * t), 0.025 + 0 * t])
    path[2, 777] = 0.031
    figure = figures.path_3d(path, path, ("x", "z", "y"))
    axes = figure.axes[0]
    drawn = np.array(axes.lines[1].get_data_3d())  # type: ignore[attr-defined]
    assert drawn.shape[1] < 5000 and drawn[2].max() == pytest.approx(31.0)
    assert axes.get_xlabel() == "x, mm"
    assert len(figures.svg(figure, "path")) < 300_000


def resonant() -> StateSpace:
    """Return L = 40 / ((s^2 + 1)(s + 5)), whose phase is -atan(w/5), less 180 degrees above 1 rad/s."""
    A = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-5.0, -1.0, -5.0]])
    B, C = np.array([[0.0], [0.0], [1.0]]), np.array([[40.0, 0.0, 0.0]])
    return StateSpace(A, B, C, np.zeros((1, 1)), ("a", "b", "c"), ("u",), ("y",), Continuous())


def test_the_phase_follows_the_poles() -> None:
    loop = resonant()
    curve = bode.curve("L", loop, stability_margins.of_loop(loop), 0.05, 100.0)
    w = curve.frequency
    expected = -np.degrees(np.arctan(w / 5)) - np.where(w > 1, 180.0, 0.0)
    away = np.abs(np.log(w)) > 1e-3
    assert np.allclose(bode.phase(curve)[away], expected[away], atol=1e-6)
    # np.unwrap takes the pole the other way: what the rule of this module is there for
    assert not np.allclose(np.degrees(np.unwrap(np.angle(curve.response)))[away], expected[away], atol=1.0)


def test_a_bode_plot_marks_the_crossings() -> None:
    loop = resonant()
    curve = bode.curve("L", loop, stability_margins.of_loop(loop), 0.05, 100.0)
    gain, angle, sensitivity = bode.bode_plot([curve]).axes
    dots = [line for line in gain.lines if line.get_marker() == "o"]
    assert len(dots) == 1 and len(dots[0].get_xdata()) == len(curve.margins.gain_crossings) > 0
    assert np.allclose(np.asarray(dots[0].get_ydata(), dtype=float), 0.0, atol=1e-6)
    peak = np.asarray(sensitivity.lines[0].get_ydata(), dtype=float).max()
    assert peak == pytest.approx(20 * np.log10(curve.margins.peak_sensitivity), abs=0.1)
    assert sensitivity.get_xlabel() == "frequency, Hz" and angle.get_ylabel() == "arg L, °"


@pytest.mark.parametrize("turns", [-4, 0, 3])
def test_the_axes_enclose_every_crossing_and_the_largest_sensitivity(
    turns: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where poles on the axis or delays put them turns away, and below the lowest frequency that is asked for."""
    phase = bode.phase
    monkeypatch.setattr(bode, "phase", lambda curve: phase(curve) + 360 * turns)
    loop = resonant()
    curve = bode.curve("L", loop, stability_margins.of_loop(loop), 10.0, 100.0)
    gain, angle, sensitivity = bode.bode_plot([curve]).axes
    for axes in (gain, angle, sensitivity):
        (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
        marks = {
            str(line.get_marker()): line.get_xydata() for line in axes.lines if line.get_marker() in ("o", "D", "s")
        }
        assert len(marks["s"]) == 1 and len(marks["o"]) > 0
        assert marks["s"][0, 0] == pytest.approx(curve.margins.peak_frequency / (2 * np.pi))
        for xy in marks.values():
            assert ((left < xy[:, 0]) & (xy[:, 0] < right) & (bottom < xy[:, 1]) & (xy[:, 1] < top)).all()


def test_an_unstable_loop_has_no_margins() -> None:
    """It is drawn before loops of smaller modulus margins, and named in the legend."""
    A, B = np.array([[0.0, 1.0], [0.0, -1.0]]), np.array([[0.0], [100.0]])
    stable = StateSpace(A, B, np.eye(1, 2), np.zeros((1, 1)), ("a", "b"), ("u",), ("y",), Continuous())
    unstable = resonant()
    curves = [bode.curve(n, s, stability_margins.of_loop(s)) for n, s in (("a", stable), ("b", unstable))]
    assert [c.margins.stable for c in curves] == [True, False]
    assert curves[0].margins.modulus_margin < curves[1].margins.modulus_margin
    first, second = sections.margins_table("both", curves).rows
    assert first[1] == "stable" and all(isinstance(cell, float) for cell in first[2:])
    assert second[1] == "UNSTABLE" and isinstance(second[2], float) and {*second[3:]} == {"unstable"}
    assert len(first) == len(second)
    ranges = sections.margins_ranges([c.margins for c in curves])
    assert ranges[1:] == ("unstable",) * 3 and "unstable" not in sections.margins_ranges([curves[0].margins])
    drawn = sections.loop("Loop", "loop", [*(replace(curves[0]) for _ in range(6)), curves[1]]).blocks[0]
    assert isinstance(drawn, page.Figure) and ">b, unstable<" in drawn.svg


def test_more_loops_than_can_be_distinguished_are_refused() -> None:
    loop = resonant()
    curve = bode.curve("L", loop, stability_margins.of_loop(loop))
    for count in (0, 7):
        with pytest.raises(SignalError, match=f"has {count} loops"):
            bode.bode_plot([curve] * count)
