"""The stage, its emitted C in both scalar types, and the evidence, computed once for all tests of this folder."""

import numpy as np
import pytest

from designs.maglev_5dof.design import DESIGN
from models import maglev_stage
from synth.app import standard_tasks, tasks
from synth.declare.stage import Stage
from synth.execute import host
from synth.plant import Plant
from synth.simulate.rig import Rig
from synth.verify.suite import Evidence


@pytest.fixture(scope="session")
def design() -> Stage:
    return DESIGN


@pytest.fixture(scope="session")
def stage() -> Plant:
    return maglev_stage.plant()


@pytest.fixture(scope="session")
def single() -> host.Controller:
    return standard_tasks.compiled_controller(DESIGN, np.float32)


@pytest.fixture(scope="session")
def double() -> host.Controller:
    return standard_tasks.compiled_controller(DESIGN, np.float64)


@pytest.fixture(scope="session")
def emitted_rig() -> Rig:
    return standard_tasks.rig(DESIGN, np.float32)


@pytest.fixture(scope="session")
def evidence() -> Evidence:
    return tasks.verification(DESIGN, True).result(lambda _: None)
