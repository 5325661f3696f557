"""The stage, its emitted C in both scalar types, and the evidence, computed once for all tests of this folder."""

import numpy as np
import pytest

from designs.maglev_5dof import verification
from designs.maglev_5dof.loop import Loop, compiled
from models import maglev_stage
from synth.execute import host
from synth.plant import Plant
from synth.verify.evidence import Evidence


@pytest.fixture(scope="session")
def stage() -> Plant:
    return maglev_stage.plant()


@pytest.fixture(scope="session")
def single(stage: Plant) -> host.Controller:
    return compiled(stage, np.float32)


@pytest.fixture(scope="session")
def double(stage: Plant) -> host.Controller:
    return compiled(stage, np.float64)


@pytest.fixture(scope="session")
def shipped(stage: Plant, single: host.Controller) -> Loop:
    return Loop(stage, single)


@pytest.fixture(scope="session")
def evidence(stage: Plant) -> Evidence:
    return verification.verify(stage, lambda _: None)
