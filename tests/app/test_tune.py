"""Tuning: ratios of goals, the search, its independence of processes, and a proposal that its certificate must hold."""

import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from synth.app import tune_command, tune_jobs, tune_search, workspace
from synth.base import jobs
from synth.base.progress import Counted, Display, Lines
from synth.declare.effects import Cable
from synth.declare.experiments import Conditions, Hold
from synth.declare.fault_campaign import StudyLimits
from synth.declare.tuning import LARGEST, Candidate, Certificate, FreeParameter, Goal, Plan, Tuned, Tuning
from synth.errors import DesignError, EmitError, SignalError, WiringError
from synth.execute import host
from synth.simulate import closed_loop, study
from synth.simulate.integration import Integration
from synth.simulate.lanes import lane_blocks
from synth.simulate.sampling import Sampling
from tests import levitator

QUIET = Lines(lambda job, line: None)
FREE = (FreeParameter("a", 1.0, 0.1, 10.0), FreeParameter("b", 0.0, -1.0, 1.0))


def test_a_share_of_the_range_is_logarithmic_above_zero() -> None:
    assert FREE[0].at(0.5) == pytest.approx(1.0) and FREE[0].share == pytest.approx(0.5)
    assert FREE[1].at(0.75) == 0.5 and FREE[1].share == 0.5
    assert FREE[0].at(0.0) == 0.1 and FREE[0].at(1.0) == 10.0
    with pytest.raises(SignalError, match="'c' is 3"):
        FreeParameter("c", 3.0, 0.0, 1.0)


@pytest.mark.parametrize(
    ("value", "limit", "is_margin", "ratio"),
    [(2.0, 4.0, False, 0.5), (2.0, 4.0, True, 2.0), (-1.0, 0.0, False, 0.0), (1e-9, 0.0, False, LARGEST),
     (np.nan, 1.0, False, LARGEST), (0.0, 30.0, True, LARGEST), (np.inf, 2.0, True, 0.0), (np.nan, 1.0, True, LARGEST)],
)  # fmt: skip
def test_the_ratio_is_at_most_one_where_the_goal_is_reached(
    value: float, limit: float, is_margin: bool, ratio: float
) -> None:
    assert Goal("g", "1", value, limit, is_margin).ratio == ratio


def candidate(performance: float, robustness: float, error: str = "") -> Candidate:
    goals = (Goal("e: c", "1", performance, 1.0, False), Goal("m", "1", 1 / robustness, 1.0, True))
    return Candidate({}, goals, error)


def test_no_candidate_of_the_front_is_dominated() -> None:
    pairs = [(3.0, 1.0), (1.0, 3.0), (2.0, 2.0), (2.0, 2.5), (3.5, 1.0)]
    front = tune_search.pareto_front([*(candidate(*p) for p in pairs), candidate(0.1, 0.1, "planted")])
    assert [(c.performance, c.robustness) for c in front] == [(1.0, 3.0), (2.0, 2.0), (3.0, 1.0)]


def evaluate(values: dict[str, float]) -> Candidate:
    return replace(candidate(abs(np.log(values["a"] / 4)) + 0.5, abs(values["b"] - 0.5) + 0.5), values=values)


def stub(seed: int, generations: int) -> Any:
    plan, stage = Plan(1, seed, generations), SimpleNamespace(name="stub")
    return SimpleNamespace(evaluate=evaluate, tuning=Tuning(FREE, lambda p: p), plan=plan, stage=stage)


def archive(seed: int) -> dict[tuple[float, ...], Candidate]:
    of, candidates = stub(seed, 8), dict[tuple[float, ...], Candidate]()
    trials = tune_search.Trials(QUIET, "stub", 1)
    tune_search._run(of, "run", (1.0, 1.0), tune_search._first_population(of), candidates, trials)
    return candidates


def test_the_search_approaches_the_best_values_and_follows_from_its_seed_alone(monkeypatch: Any) -> None:
    candidates = archive(3)
    best = min(candidates.values(), key=lambda c: tune_search.score(c, (1.0, 1.0)))
    first = next(iter(candidates.values()))
    assert first.values == {"a": pytest.approx(1.0), "b": 0.0}, "the declared law is the first candidate"
    assert best.worst < 0.7 < first.worst
    monkeypatch.setattr(jobs, "cores", lambda: 1)
    assert archive(3) == candidates and list(archive(3)) == list(candidates)
    assert list(archive(4)) != list(candidates)


def test_each_candidate_is_shown_with_the_best_so_far(monkeypatch: Any) -> None:
    shown: list[Counted] = []

    class Recorder(Lines):
        def report(self, job: str, about: str, line: str) -> None:
            assert job == about == "stub" and isinstance(line, Counted)
            shown.append(line)

    certificate = Certificate((), (), {})
    monkeypatch.setattr(tune_search, "certify", lambda of, proposal: certificate)
    tuned = tune_search.search(stub(3, 2), Recorder(lambda about, line: None))
    first, *trials, last = shown
    assert first == "3 runs of 2 generations of 12 candidates" and last == "certificate of the proposal"
    assert [(line.done, line.total) for line in trials] == [(k, 84) for k in range(1, tuned.candidates + 1)]
    text = re.compile(r"best ratio ([\d.]+), last ([\d.]+), run ([123])/3, generation ([012])/2")
    best, ratios, runs, generations = zip(*(text.fullmatch(line).groups() for line in trials), strict=True)  # type: ignore[union-attr]
    assert [*map(float, best)] == np.minimum.accumulate([*map(float, ratios)]).tolist()
    assert float(best[-1]) == pytest.approx(tuned.proposal.worst, rel=0.05)
    assert {*runs} == {*"123"} and {*generations} == {*"012"} and list(runs) == sorted(runs)
    assert tuned.certificate == certificate


def test_a_proposal_without_a_certificate_is_an_error_that_says_why(monkeypatch: Any) -> None:
    def fails(of: Any, proposal: Candidate) -> Certificate:
        raise EmitError("planted: unbounded")

    monkeypatch.setattr(tune_search, "certify", fails)
    with pytest.raises(DesignError, match="certificate of the proposal for 'stub': planted: unbounded"):
        tune_search.search(stub(3, 1), QUIET)


def test_the_command_says_what_runs_and_for_how_long(monkeypatch: Any, capsys: pytest.CaptureFixture[str]) -> None:
    declared = evaluate({"a": 1.0, "b": 0.0})
    tuned = Tuned(Plan(1, 0, 1), declared, declared, Certificate((), (), {}), (), 1)

    def search(of: Any, display: Display) -> Tuned:
        display.report("stub", "stub", "best ratio 1.5")
        return tuned

    monkeypatch.setattr(workspace, "designs", lambda *_: [None])
    monkeypatch.setattr(tune_jobs, "prepare", lambda *_: SimpleNamespace(tuning=Tuning(FREE, lambda p: p)))
    monkeypatch.setattr(tune_search, "search", search)
    tune_command.tune("stub", False, tune_command.TuneChoice(tuned.plan, None))
    lines = capsys.readouterr().out.splitlines()
    assert lines[:2] == ["stub: compile the declared law, 0 s", "stub: best ratio 1.5, 0 s"]


@pytest.fixture(scope="module")
def prepared() -> tune_jobs.Search:
    module = levitator.design("levitator_2dof")
    tuning = replace(module.DESIGN.tuning, experiments=["step_z*"])
    pulled = Hold({"z_ref": 1.0}, 0.1, 0.05, Conditions(effects=[Cable("x", 50.0)]), label="step_z_pulled")
    experiments = (*module.DESIGN.experiments, pulled)
    stage = replace(module.DESIGN, tuning=tuning, operating_points={"mid": {"z": 0.0}}, experiments=experiments)
    return tune_jobs.prepare(stage, Plan(3, 1, 1))


@pytest.mark.slow
def test_declared_values_must_give_the_declared_law(prepared: tune_jobs.Search) -> None:
    stage, tuning = prepared.stage, prepared.tuning
    other = replace(tuning, free=[replace(tuning.free[0], value=2e3), *tuning.free[1:]])
    with pytest.raises(DesignError, match="its declared values give"):
        tune_jobs.prepare(replace(stage, tuning=other), prepared.plan)
    with pytest.raises(DesignError, match="declares no tuning"):
        tune_jobs.prepare(replace(stage, tuning=None), prepared.plan)


@pytest.mark.slow
def test_the_certificate_holds_for_what_was_searched_and_for_nothing_else(prepared: tune_jobs.Search) -> None:
    values = {f.name: f.at(0.6) for f in prepared.tuning.free}
    proposal = tune_jobs.evaluate(prepared, values)
    certificate = tune_search.certify(prepared, proposal)
    assert proposal.error == "" and certificate.goals == proposal.goals and certificate.checks[0].passed
    assert not [g.name for g in proposal.goals if "pulled" in g.name], "its plant has no lanes"
    planted = replace(proposal.goals[0], value=np.nextafter(proposal.goals[0].value, 1.0))
    wrong = replace(proposal, goals=(planted, *proposal.goals[1:]))
    assert not tune_search.certify(prepared, wrong).checks[0].passed, "one bit of one goal"
    assert certificate.margins["disk_margin"] > 0


@pytest.mark.slow
def test_the_machines_of_a_search_keep_the_limits_of_the_study(prepared: tune_jobs.Search) -> None:
    declared = {f.name: f.value for f in prepared.tuning.free}
    limits = StudyLimits(limits={"step_z*: overshoot": 0.2, "step_z*: settling time": np.inf})
    wider = replace(prepared, stage=replace(prepared.stage, study=limits))
    goals = {g.name.partition(": ")[2]: g.limit for g in tune_jobs.evaluate(wider, declared).goals}
    assert goals["overshoot"] == 0.2 and "settling time" not in goals and goals["samples with a fault bit"] == 0.0


@pytest.mark.slow
def test_a_law_that_cannot_be_made_is_the_worst_candidate(prepared: tune_jobs.Search) -> None:
    negative = {**{f.name: f.value for f in prepared.tuning.free}, "damping_z": -1.0}
    lost = tune_jobs.evaluate(prepared, negative)
    assert lost.error and lost.worst == LARGEST


@pytest.mark.slow
def test_a_variant_has_no_c_of_its_own(prepared: tune_jobs.Search) -> None:
    controller, block = prepared.rig.controller, prepared.stage.controller.block
    variant = host.vary(controller, block)
    with pytest.raises(WiringError, match="runs in lanes alone"):
        replace(prepared.rig, controller=variant, simulate=closed_loop.simulate).run(0.01)
    with pytest.raises(WiringError, match="other signals"):
        host.vary(controller, replace(block, states=block.states[1:]))


@pytest.mark.slow
def test_other_constants_alone_share_the_program_and_have_the_bits_of_their_own_c(prepared: tune_jobs.Search) -> None:
    controller, block = prepared.rig.controller, prepared.stage.controller.block
    other = replace(block, constants=tuple(replace(c, value=c.value * 1.0001) for c in block.constants))
    variant = host.vary(controller, other)
    assert lane_blocks.blocks(variant, ())[0].program is lane_blocks.blocks(controller, ())[0].program
    arguments = prepared.stage.experiments[:1], Sampling(3, 5), range(3), Integration(2, 0.0, 4)
    controllers = variant, host.compile_block(other), controller
    tables = [study.run(replace(prepared.rig, controller=c), *arguments) for c in controllers]
    overshoots = [next(iter(t.checks.values())).tobytes() for t in tables]
    assert overshoots[0] == overshoots[1] != overshoots[2]
