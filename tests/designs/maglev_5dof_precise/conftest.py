"""The design whose tests are in this folder."""

import pytest

from designs.maglev_5dof_precise.design import DESIGN
from synth.declare.stage import Stage


@pytest.fixture(scope="session")
def design() -> Stage:
    return DESIGN
