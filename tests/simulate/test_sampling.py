"""Random machines: repeatable rows, distributions, and machines that differ in what was drawn."""

from dataclasses import replace

import numpy as np
import pytest

from synth.app import standard_tasks
from synth.errors import SignalError
from synth.simulate import sampling
from synth.simulate.rig import Rig
from synth.simulate.sampling import Method, Sampling
from tests import levitator

PID = levitator.design()


@pytest.fixture(scope="module")
def rig() -> Rig:
    loaded = standard_tasks.rig(PID.DESIGN, np.float64)
    errors = {"offset": 2e-6, "gain_error": 0.01}
    sensors = tuple(replace(s, **errors) if s.name == "z" else s for s in loaded.stage.interface.sensors)
    return loaded.with_interface(sensors=sensors)


@pytest.mark.parametrize("method", Method)
def test_a_row_is_the_same_alone_and_the_first_is_nominal(method: Method) -> None:
    drawn = Sampling(50, 3, method)
    table = sampling.draw(drawn, 4, range(50))
    assert table.shape == (50, 4) and not table[0].any() and table[1:].all()
    assert np.array_equal(sampling.draw(drawn, 4, [17]), table[17:18])
    assert not np.array_equal(sampling.draw(replace(drawn, seed=4), 4, range(50)), table)
    if method is not Method.LATIN:
        assert np.array_equal(sampling.draw(replace(drawn, rows=90), 4, range(50)), table)


def test_each_method_has_its_distribution() -> None:
    n = 4000
    z = {m: sampling.draw(Sampling(n, 1, m), 3, range(n))[1:] for m in Method}
    assert set(np.unique(z[Method.CORNERS])) == {-1.0, 1.0}
    assert np.abs(z[Method.UNIFORM]).max() <= 1 and abs(z[Method.UNIFORM].std() - 1 / np.sqrt(3)) < 0.01
    assert abs(z[Method.NORMAL].std() - 1 / 3) < 0.01 and np.abs(z[Method.NORMAL]).max() > 1
    for column in z[Method.LATIN].T:
        slices = np.floor((column + 1) / 2 * n).astype(int)
        assert len(np.unique(slices)) == n - 1, "one row in each slice but that of the nominal row"


def test_a_machine_has_the_drawn_parameters_errors_of_sensors_and_noise(rig: Rig) -> None:
    names = sampling.quantities(rig)
    assert names[-2:] == ("offset.z", "gain.z") and "M" in names
    z = dict.fromkeys(names, 0.5)
    machine = sampling.machine(rig, z, 1, 7)
    mass = rig.plant.parameter("M")
    assert machine.plant.parameter("M").value == mass.value * (1 + 0.5 * mass.tolerance)
    assert machine.offsets == {"z": 1e-6} and machine.gain_errors == {"z": 0.005}
    assert machine.seed != sampling.machine(rig, z, 1, 8).seed
    run = machine.run(0.02, {"z": 1e-4})
    assert abs(run.measured["z"][0] - (1.005 * 1e-4 + 1e-6)) < 2e-7


@pytest.mark.parametrize(("rows", "seed"), [(0, 0), (3, -1)])
def test_no_rows_and_negative_seeds_are_refused(rows: int, seed: int) -> None:
    with pytest.raises(SignalError, match="give at least 1 row and a seed"):
        Sampling(rows, seed)


def test_a_method_may_be_given_by_its_name() -> None:
    for method in Method:
        by_name = sampling.draw(Sampling(8, 0, method.value), 3, range(8))  # type: ignore[arg-type]
        np.testing.assert_array_equal(by_name, sampling.draw(Sampling(8, 0, method), 3, range(8)))
    with pytest.raises(SignalError, match="sampling by 'bogus': give one of uniform, normal, corners, latin"):
        Sampling(8, 0, "bogus")  # type: ignore[arg-type]
