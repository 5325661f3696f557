"""The design whose tests are in this folder."""

import pytest

from designs.maglev_5dof_precise.design import DESIGN
from synth.app.workspace import Design


@pytest.fixture(scope="session")
def design() -> Design:
    return DESIGN
