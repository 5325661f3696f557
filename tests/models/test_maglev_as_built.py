"""The plant as built: the nominal one without deviations, another one at the corners of its tolerances."""

import numpy as np

from models import maglev_as_built, maglev_phases


def test_the_plant_as_built_is_the_nominal_one_without_deviations() -> None:
    built, nominal = maglev_as_built.plant(), maglev_phases.plant()
    x = [0.025, 0.0, 0.01, 0.1, -0.01, 0.0, 1e-4, 0.0, -1e-3, 0.0]
    u = np.linspace(-2, 2, 12)
    values = [np.asarray(p.f(x, u, [q.value for q in p.parameters])).ravel() for p in (built, nominal)]
    np.testing.assert_allclose(values[0], values[1], rtol=1e-12, atol=1e-12)
    corner = maglev_as_built.corner(built, 3)
    wrong = built.with_parameters(**corner)
    other = np.asarray(wrong.f(x, u, [q.value for q in wrong.parameters])).ravel()
    assert np.abs(other - values[1]).max() > 1e-2
    assert corner == maglev_as_built.corner(built, 3) != maglev_as_built.corner(built, 4)
