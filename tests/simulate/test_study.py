"""A study: its rows, what drives a figure, the yield, and machines without a result."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from synth.app import standard_tasks
from synth.check import Check
from synth.declare.effects import CurrentLoops
from synth.declare.experiments import Conditions, Hold
from synth.errors import DesignError, SignalError, WiringError
from synth.report import sections as report
from synth.simulate import integration, study, worst_case
from synth.simulate.experiments import Experiment
from synth.simulate.integration import Integration
from synth.simulate.rig import Rig
from synth.simulate.sampling import Sampling
from synth.simulate.study import StudyTable
from tests import levitator

pytestmark = pytest.mark.slow
PID = levitator.design()
EXACT = Integration(4, 0.0)


@dataclass(frozen=True)
class Fall:
    """How far z falls in 20 ms from a start off its set-point; the machine with the mass `lost` has no result."""

    name: str = "fall"
    limit: float = 1.0
    lost: float = 0.0

    def run(self, rig: Rig) -> Experiment:
        run = rig.run(0.02, {"z": 1e-4})
        mass = rig.plant.parameter("M").value
        if self.lost and mass > self.lost:
            raise SignalError("planted")
        checks = (Check("peak", float(np.abs(run["z"]).max()), self.limit, "m"),)
        return Experiment(self.name, "", "", run, (), {}, {"mass, kg": mass}, checks)


@pytest.fixture(scope="module")
def rig() -> Rig:
    return standard_tasks.rig(PID.DESIGN, np.float64)


@pytest.fixture(scope="module")
def table(rig: Rig) -> StudyTable:
    return study.run(rig, [Fall()], Sampling(20, 1), range(20), EXACT)


def test_a_row_alone_has_the_bits_of_the_table(rig: Rig, table: StudyTable) -> None:
    for row in (0, 7, 19):
        alone = study.run(rig, [Fall()], Sampling(20, 1), [row], EXACT)
        assert alone.checks["fall: peak"].tobytes() == table.checks["fall: peak"][row : row + 1].tobytes()
        assert all(alone.z[name][0] == z[row] for name, z in table.z.items())


def test_rows_are_the_runs_of_each_machine(rig: Rig, table: StudyTable) -> None:
    mass = rig.plant.parameter("M")
    masses = mass.value * (1 + mass.tolerance * table.z["M"])
    assert np.array_equal(table.figures["fall: mass, kg"], masses) and np.ptp(masses) > 0.01
    heavy = replace(rig, plant=rig.plant.with_parameters(M=float(masses[3]), **others(rig, table, 3)))
    alone = Fall().run(heavy).checks[0].value
    assert table.checks["fall: peak"][3] == pytest.approx(alone, rel=1e-6)


def others(rig: Rig, table: StudyTable, row: int) -> dict[str, float]:
    names = [p for p in rig.plant.parameters if p.name in table.z and p.name != "M"]
    return {p.name: p.value * (1 + p.tolerance * float(table.z[p.name][row])) for p in names}


def made(values: list[float], limit: float = 2.0, **z: list[float]) -> StudyTable:
    n = len(values)
    columns = {name: np.array(each) for name, each in z.items()}
    return StudyTable(np.arange(n), columns, {}, {"e: c": np.array(values)}, {"e: c": limit}, {"e: c": "m"}, EXACT)


def test_the_driver_is_the_quantity_that_orders_the_values() -> None:
    rng = np.random.default_rng(2)
    a, b = rng.uniform(-1, 1, (2, 200))
    (summary,) = study.summarise(made((np.exp(-3 * a) + 0.1 * b).tolist(), a=a.tolist(), b=b.tolist()))
    assert summary.driver == "a" and summary.correlation < -0.98
    assert summary.worst_row == int(np.argmin(a + 0 * b)) or summary.worst == pytest.approx(
        np.max(np.exp(-3 * a) + 0.1 * b)
    )
    unknown = np.where(np.arange(200) % 7 == 0, np.nan, np.exp(-3 * a) + 0.1 * b)
    (summary,) = study.summarise(made(unknown.tolist(), a=a.tolist(), b=b.tolist()))
    reference = stats.spearmanr(a, unknown, nan_policy="omit").statistic
    assert summary.driver == "a" and summary.correlation == pytest.approx(reference, rel=1e-12)
    (constant,) = study.summarise(made([1.0] * 200, a=a.tolist()))
    assert (constant.driver, constant.correlation) == ("", 0.0)


def test_a_quantity_that_acts_to_both_sides_alike_is_a_driver_by_its_size() -> None:
    rng = np.random.default_rng(4)
    a, b = rng.uniform(-1, 1, (2, 400))
    (summary,) = study.summarise(made((a**2 + 0.05 * b).tolist(), a=a.tolist(), b=b.tolist()))
    assert summary.driver == "|a|" and summary.correlation > 0.95
    corners = np.sign(a).tolist()
    (summary,) = study.summarise(made((2 * np.sign(a) + b).tolist(), a=corners, b=np.sign(b).tolist()))
    assert summary.driver == "a", "at the corners every size is the same"


def test_the_yield_has_its_interval() -> None:
    none_failed = study.estimate_yield(made([1.0] * 300))
    assert none_failed.share == none_failed.high == 1.0
    assert none_failed.low == pytest.approx(0.025 ** (1 / 299)), "Clopper and Pearson, in closed form"
    half = study.estimate_yield(made([1.0, *[1.0, 3.0] * 50]))
    assert half.share == 0.5 and half.low == pytest.approx(1 - half.high) and 0.39 < half.low < 0.41


def test_the_yield_leaves_out_the_nominal_machine() -> None:
    lucky = study.estimate_yield(made([1.0, *[3.0] * 9]))
    assert lucky.share == lucky.low == 0 and lucky.high == pytest.approx(1 - 0.025 ** (1 / 9))
    alone = study.estimate_yield(made([1.0]))
    assert (alone.share, alone.low, alone.high) == (1.0, 0.0, 1.0)


def test_a_value_that_is_no_number_keeps_no_limit() -> None:
    table = made([1.0, np.nan, 2.0, 2.1])
    assert table.passed.tolist() == [True, False, True, False]
    (summary,) = study.summarise(table)
    assert (summary.worst, summary.worst_row, summary.passed) == (2.1, 3, 0.5)


@pytest.mark.parametrize("n", [1, 2, 10, 20, 30, 199, 200])
def test_the_quantiles_are_the_least_values_that_a_share_of_the_machines_does_not_exceed(n: int) -> None:
    values = np.random.default_rng(n).permutation(n) + 1.0
    (summary,) = study.summarise(made(values.tolist(), a=values.tolist()))
    for value, percent in ((summary.median, 50), (summary.percentile_95, 95)):
        assert value == -(-percent * n // 100), "the values are the ranks"


def test_a_machine_without_a_result_fails_and_is_reported(rig: Rig) -> None:
    mass = rig.plant.parameter("M").value
    table = study.run(rig, [Fall(lost=mass)], Sampling(10, 1), range(10), EXACT)
    heavy = table.z["M"] > 0
    assert 0 < heavy.sum() < 10 and not table.passed[heavy].any() and table.passed[~heavy].all()
    assert {row for row, _, _ in table.errors} == set(np.flatnonzero(heavy))
    reason = "planted; at tests/simulate/test_study.py:"  # and the line
    assert study.notes(table)[1].startswith(f"No result of fall on {heavy.sum()} machines: {reason}")
    assert study.csv_text(table).count("nan") == 2 * heavy.sum()


def test_the_steps_are_the_fewest_within_the_error(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    plain = integration.choose(rig, Fall())
    assert plain.substeps in (1, 2, 4, 8) and 0 < plain.error <= integration.LARGEST_ERROR
    monkeypatch.setattr(integration, "LARGEST_ERROR", plain.error / 2)
    finer = integration.choose(rig, Fall())
    assert (finer.substeps, finer.order) > (plain.substeps, plain.order) or finer.error > plain.error / 2
    monkeypatch.setattr(integration, "LARGEST_ERROR", 0.0)
    assert integration.choose(rig, Fall()).substeps == integration.CANDIDATES[-1][0]


def test_the_steps_are_not_chosen_for_a_further_plant(rig: Rig) -> None:
    lagging = Hold({"z_ref": 1.0}, 0.1, 0.05, Conditions(effects=[CurrentLoops(5e-4)]))
    assert not integration.runs_in_lanes(rig, lagging)
    with pytest.raises(WiringError, match="experiment 'hold_z_ref' changes the plant: choose the steps in another one"):
        integration.choose(rig, lagging)


def test_experiments_are_chosen_by_patterns() -> None:
    experiments = [Fall("step_x"), Fall("step_z"), Fall("hold")]
    assert [e.name for e in study.select(experiments, ["step_*", "hold"])] == ["step_x", "step_z", "hold"]
    assert study.select(experiments, []) == experiments
    with pytest.raises(DesignError, match="no experiment is called 'stp': choose from step_x, step_z, hold"):
        study.select(experiments, ["stp"])


def test_the_search_climbs_beyond_the_sample_and_says_so(rig: Rig, table: StudyTable) -> None:
    worst = worst_case.search(rig, [Fall()], 1, table, "fall: mass, kg")
    mass = rig.plant.parameter("M")
    assert worst.converged and worst.z["M"] == 1.0
    assert worst.value == mass.value * (1 + mass.tolerance) > worst.sampled == table.figures["fall: mass, kg"].max()
    assert worst == worst_case.search(rig, [Fall()], 1, table, "fall: mass, kg"), "reproducible"
    assert "lower bound" in worst_case.notes(worst)[0]
    peak = worst_case.search(rig, [Fall()], 1, table, "fall: peak")
    z = np.array([[peak.z[name] for name in table.z]])
    again = study.run_machines(rig, [Fall()], z, 1, [peak.row], EXACT)
    assert again.checks["fall: peak"][0] == peak.value >= peak.sampled
    with pytest.raises(DesignError, match="no value is called 'fall: pek'"):
        worst_case.search(rig, [Fall()], 1, table, "fall: pek")


def test_the_search_that_is_stopped_has_not_converged(
    rig: Rig, table: StudyTable, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(worst_case, "ROUNDS", 1)
    assert not worst_case.search(rig, [Fall()], 1, table, "fall: mass, kg").converged


def test_the_report_has_the_worst_row_and_the_yield(rig: Rig, table: StudyTable) -> None:
    tight = study.run(rig, [Fall(limit=1e-9)], Sampling(20, 1), range(20), EXACT)
    summary = study.summarise(table)[0]
    text = report.page_text("levitator", table)
    assert f"<td>{summary.worst_row}</td>" in text.replace(' class="text"', "") or str(summary.worst_row) in text
    assert "20 of 20 machines keep every limit: yield 100.00%" in text and "lower bound" in text
    assert "0 of 20 machines keep every limit" in report.page_text("levitator", tight)


def test_parquet_without_pyarrow_is_refused_with_a_mend(monkeypatch: pytest.MonkeyPatch) -> None:
    def absent(name: str) -> None:
        raise ImportError(name)

    monkeypatch.setattr(study, "import_module", absent)
    with pytest.raises(DesignError, match="needs pyarrow, which is not installed: run `pip install"):
        study.require_parquet()


def test_parquet_has_the_columns_of_csv(table: StudyTable, tmp_path: Path) -> None:
    _, parquet = study.require_parquet()
    study.write_parquet(table, tmp_path / "table.parquet")
    again = parquet.read_table(tmp_path / "table.parquet")
    columns = study.columns(table)
    assert again.column_names == list(columns)
    assert all(again[name].to_numpy().tobytes() == values.tobytes() for name, values in columns.items())
