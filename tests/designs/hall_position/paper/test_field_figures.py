"""The arrays of Figs. 4 and 5: digits, symmetry, and which spacings keep a pair of sensors sensitive."""

import numpy as np
import pytest

from designs.hall_position.paper import field_figures
from models import concentrated_field as cf

l = 50.8e-3
P = cf.values()
SINE = cf.waves_from_amplitudes({1: 0.375}, 3e-3, P)
IDEAL = cf.waves(cf.ideal_matrix(P["strong"]), cf.orders_on_axes(field_figures.HARMONICS), P)
FABRICATED = cf.waves(cf.fabricated_matrix(P["strong"], P["weak"]), cf.orders_on_axes((1, 5, 9, 13)), P)


def test_figure_4() -> None:
    surface = field_figures.surface(IDEAL, 33)
    assert surface.X[0] == 0 and surface.X[-1] == pytest.approx(l) and surface.B_X.shape == (33, 33)
    np.testing.assert_allclose(surface.B_X, -surface.B_X[::-1], rtol=0, atol=1e-15)
    assert np.ptp(surface.B_X, axis=1).max() == 0  # an ideal matrix' B_X does not depend on Y
    assert np.ptp(surface.B_X, axis=0).min() > 0.6
    w = 2 * np.pi / l
    theirs = 0.35184 * np.sin(w * surface.X) - 0.02013 * np.sin(5 * w * surface.X) + 0.00254 * np.sin(9 * w * surface.X)
    np.testing.assert_allclose(surface.B_X[:, 7], theirs, rtol=0, atol=4.2e-4)  # the 13th has 4e-4 T


def test_figure_5() -> None:
    line = field_figures.line(FABRICATED, 0.75 * l)
    np.testing.assert_allclose(line.volts[1], np.roll(line.volts[0][:-1], -192)[np.arange(257) % 256], atol=1e-12)
    middle = (line.volts[:, 2:] - line.volts[:, :-2]) / (line.X[2] - line.X[0])
    np.testing.assert_allclose(line.slopes[:, 1:-1], middle, rtol=0, atol=4.0)  # (13 w h)^2 / 6 of its share
    assert np.abs(line.slopes).min(axis=1).max() < 10  # each of them is insensitive somewhere
    assert np.abs(line.slopes).max(axis=0).min() > 250  # but never both


def test_spacing_3_is_best_for_a_sine_and_within_a_per_cent_for_the_field() -> None:
    at = np.rint(field_figures.spacings(3, 480)).astype(int)
    assert at.tolist() == [360, 600, 840]
    sine, field = field_figures.least_slopes(SINE), field_figures.least_slopes(FABRICATED)
    peak = 8.4 * 0.375 * 2 * np.pi / l * (1 - 1.5e-5)
    np.testing.assert_allclose(sine.least[at], peak, rtol=1e-6)
    assert sine.least.max() <= peak * (1 + 1e-6)
    assert field.spacing[at] == pytest.approx(l * np.array([0.75, 1.25, 1.75]))
    assert field.least.max() / 1.01 < field.least[at].min() <= field.least.max()


def test_a_spacing_of_half_pitches_is_seen_to_be_blind() -> None:
    for slopes in (field_figures.least_slopes(SINE), field_figures.least_slopes(FABRICATED)):
        assert slopes.least[[0, 240, 480, 720]].max() < 1e-9
