"""Figures of the planar motor: the force by quadrature, and G."""

import numpy as np
import pytest

from designs.planar_6dof.paper import motors
from models import planar_stage

PLANT = planar_stage.plant()


def test_the_direct_integral_known_elsewhere_has_the_pitch_of_table_1() -> None:
    """19.349 N/A is for l = w = 50.977 mm, where (17) gives 20.262 N/A; 20.205 N/A is that of G = 1.072e-5."""
    l, density = 50.977e-3, 3.5246e6
    plant = PLANT.with_parameters(l=l, w=l, Delta=l / 4, turns=density * 8.6524e-5)
    p = {each.name: each.value for each in plant.parameters}
    direct, lift = motors.lorentz_force(p, 0.0)
    printed = motors.force_constant(p, "printed")
    assert (round(direct, 3), round(printed, 3)) == (19.349, 20.262)
    assert direct / printed == pytest.approx(3 / np.pi, rel=1e-12) and abs(lift) < 1e-12
    of_G = 0.5 * 0.71 * density * 2 * 1.072e-5 * np.exp(-123.25 * 2.3e-3)
    assert round(of_G, 3) == 20.205 and abs(19.349 / of_G - 3 / np.pi) > 2e-3


def test_g_is_the_formula_of_the_paper() -> None:
    l, w, Gamma = 50.977e-3, 50.8e-3, 8.6524e-5 / (50.977e-3 / 6)
    expected = np.sqrt(2) * w * l**2 / np.pi**2 * (1 - np.exp(-2 * np.pi / l * Gamma)) * (1 - np.exp(-np.pi / 2))
    assert motors.G(l, w, 8.6524e-5, l / 4) == pytest.approx(expected, rel=1e-12)
