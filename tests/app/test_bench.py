"""Margins over the bench of a stage: never above those at other places, found where they are least; set files."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from designs.levitator_2dof.design import DESIGN
from synth.app import bench, tasks
from synth.app.tune_command import tune_on_bench
from synth.base.progress import silent
from synth.declare.stage import Stage
from synth.declare.tuning import Bench, Tried
from synth.errors import DesignError
from synth.execute import host
from synth.report import tuning as report


def trials(monkeypatch: pytest.MonkeyPatch, margin: object) -> None:
    """Let the margins of values be those of a function of the shares of the ranges."""

    def try_values(stage: Stage, values: dict[str, float]) -> Tried:
        return Tried(values, {"phase_margin": margin(*values.values())}, ())  # type: ignore[operator]

    monkeypatch.setattr(bench, "try_values", try_values)


def with_bench(**ranges: tuple[float, float]) -> Stage:
    assert DESIGN.tuning is not None
    return replace(DESIGN, tuning=replace(DESIGN.tuning, bench=Bench(ranges)))


def test_a_least_margin_within_a_range_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    trials(monkeypatch, lambda weight: abs(weight - 0.613) + 30)
    over_bench = bench.over(with_bench(set_point_weight_z=(0.0, 1.0)), silent)
    place = over_bench.least["phase_margin"]
    assert place.values["set_point_weight_z"] == pytest.approx(0.613, abs=2e-3)
    assert place.margins["phase_margin"] == pytest.approx(30, abs=2e-3)


def test_a_least_margin_between_two_parameters_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    trials(monkeypatch, lambda z, x: (z - 0.33) ** 2 + (x - 0.81 + 0.5 * z) ** 2 + 30)
    over_bench = bench.over(with_bench(set_point_weight_z=(0.0, 1.0), set_point_weight_x=(0.0, 1.0)), silent)
    assert over_bench.least["phase_margin"].margins["phase_margin"] == pytest.approx(30, abs=1e-4)


def test_margins_at_random_places_are_not_below_the_least() -> None:
    assert DESIGN.tuning is not None and DESIGN.tuning.bench is not None
    low, high = DESIGN.tuning.bench.ranges["damping_z"]
    over_bench = tasks.on_bench(DESIGN).result(silent)
    assert over_bench is not None and not any(t.missed for t in over_bench.tried)
    for value in np.exp(np.random.default_rng(5).uniform(np.log(low), np.log(high), 3)):
        margins = bench.try_values(DESIGN, {"damping_z": float(value)}).margins
        for name, place in over_bench.least.items():
            assert margins[name] >= place.margins[name]
    assert (
        report.bench_sheet(DESIGN, over_bench)
        .lines[0]
        .startswith(f"All that is required holds at {len(over_bench.tried)}")
    )


def test_a_set_file_holds_what_the_c_takes(tmp_path: Path) -> None:
    file = tmp_path / "set.txt"
    assert tune_on_bench("levitator_2dof", False, ["damping_z=1500"], file) == 0
    lines = [line.split(" = ") for line in file.read_text().splitlines() if not line.startswith("#")]
    values, check = {name: float(value) for name, value in lines[:-1]}, int(lines[-1][1], 16)
    emitted = tasks.emission(DESIGN, np.float32).result(silent)[DESIGN.name]
    controller = host.load(emitted.files, emitted.manifest)
    state = controller.init()
    assert controller.parameters(values)["check"] == check and controller.tune(state, values) == 0


def test_values_that_miss_what_is_required_are_not_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tried = Tried({"damping_z": 700.0}, {"phase_margin": 30.0}, ("phase_margin",))
    monkeypatch.setattr(bench, "try_values", lambda stage, values: tried)
    file = tmp_path / "set.txt"
    assert tune_on_bench("levitator_2dof", False, ["damping_z=700"], file) == 1
    assert not file.exists()


@pytest.mark.parametrize("values", [{"damping_z": 1e4}, {"damping_z": np.nan}, {"damping_x": 1.0}])
def test_values_that_are_not_on_the_bench_are_refused(values: dict[str, float]) -> None:
    with pytest.raises(DesignError, match=r"is not on the bench of 'levitator_2dof': it has damping_z 600 .. 1600"):
        bench.try_values(DESIGN, values)


def test_a_stage_without_a_bench_is_refused() -> None:
    with pytest.raises(DesignError, match="tunes nothing on the machine: give"):
        bench.of(replace(DESIGN, tuning=None))
