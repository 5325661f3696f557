"""Plots of multivariable loops: singular values of L, S and T, and disk margins."""

import numpy as np
import pytest

from synth.analyse.loops import disk
from synth.report import bode
from synth.statespace import StateSpace
from synth.timing import Discrete

T = 1e-3
NAMES = ("a", "b"), ("u", "v"), ("y", "z")
A, B = np.diag([0.9, 0.8]), np.array([[0.1, 0.02], [0.0, 0.1]])
LOOP = StateSpace(A, B, np.array([[1.0, 0.0], [0.5, 1.0]]), np.zeros((2, 2)), *NAMES, Discrete(T))
FREQUENCY = np.geomspace(10, 3000, 50)


def test_singular_values_are_those_of_s_and_t() -> None:
    values = bode.singular(LOOP, FREQUENCY)
    L = LOOP.response([np.exp(1j * FREQUENCY[7] * T)])[0]
    S = np.linalg.inv(np.eye(2) + L)
    for letter, m in (("L", L), ("S", S), ("T", np.eye(2) - S)):
        np.testing.assert_allclose(getattr(values, letter)[7], np.linalg.svd(m, compute_uv=False), rtol=1e-9)


def test_each_loop_is_drawn_in_hertz_and_decibels() -> None:
    values = bode.singular(LOOP, FREQUENCY)
    figure = bode.singular_values({"as shipped": values, "as printed": values})
    assert [axes.get_title()[:18] for axes in figure.axes] == ["singular values of"] * 3
    line = figure.axes[1].get_lines()[0]
    np.testing.assert_allclose(line.get_xdata(), FREQUENCY / (2 * np.pi))
    np.testing.assert_allclose(line.get_ydata(), 20 * np.log10(values.S[:, 0]))
    assert [t.get_text() for t in figure.legends[0].get_texts()] == ["as shipped", "as printed"]


def test_a_peak_beyond_the_usual_range_is_not_cut_off() -> None:
    values = bode.singular(LOOP, FREQUENCY)
    high = bode.Singular(values.frequency, values.L, 30 * values.S, values.T)
    figure = bode.singular_values({"high": high})
    assert figure.axes[1].get_ylim()[1] >= 20 * np.log10(high.S.max()) > bode.GAIN_DECIBELS["S"][1]


def test_disk_margins_are_drawn_from_the_lowest_frequency_on() -> None:
    margin = disk.of_loop(LOOP)
    (axes,) = bode.disks({"both": margin}).axes
    drawn = axes.get_lines()[0].get_ydata()
    assert min(drawn) == pytest.approx(margin.curve[margin.frequencies > bode.MIN_FREQUENCY].min())
    assert axes.get_legend().get_texts()[0].get_text() == "both"
