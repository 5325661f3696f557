"""Tuning of a control law by goal attainment (Gembicki; MATLAB `fgoalattain`, `systune`) over an ensemble of machines.

    minimise over p in its bounds:   max_i w_i r_i(p) + RHO mean_i r_i(p)         augmented Chebyshev scalarisation

The ratios r_i are those of `tune_jobs`. The method is SciPy's differential evolution (Storn and Price); one run for
each pair of WEIGHTS, of the experiments and of the margins, makes it approach different parts of the Pareto front. The
result follows from the seed alone, not from the number of processes.

The proposal gets C of its own, with all proofs of the emission, and its margins at the limits of the tolerances.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from synth.app import verdicts
from synth.app.tune_jobs import Search, measure_goals, with_values
from synth.base import jobs
from synth.base.jobs import Job
from synth.base.progress import Counted, Display, Progress
from synth.check import Check
from synth.declare.tuning import Candidate, Certificate, Tuned
from synth.errors import DesignError
from synth.execute import host

WEIGHTS = ((1.0, 1.0), (1.0, 0.5), (0.5, 1.0))  # of the experiments and of the margins
RHO = 0.01  # weight of the mean of the ratios
A_PARAMETER, LEAST = 4, 12  # candidates of a generation: for each free parameter, and at least

Shares = NDArray[np.float64]
Archive = dict[tuple[float, ...], Candidate]


def score(candidate: Candidate, weights: tuple[float, float]) -> float:
    """Return what the search minimises, for weights of the experiments and of the margins."""
    largest = max(weights[0] * candidate.performance, weights[1] * candidate.robustness)
    return largest + RHO * float(np.mean([goal.ratio for goal in candidate.goals] or [largest]))


class Trials:
    """The jobs of all generations as one bar of the search: a line of a job is the largest ratio of a candidate.

    The bar shows the least of these so far, this one, and which `generation` is evaluated.
    """

    def __init__(self, shown: Display, name: str, total: int) -> None:
        self.generation, self.best, self.done = "", np.inf, 0
        self.tick_s, self.tick = shown.tick_s, shown.tick
        self._show = lambda line: shown.report(name, name, Counted(line, min(self.done, total), total))

    def begin(self, job: str, about: str) -> None:
        """Show nothing: the jobs are those of one bar."""

    def report(self, job: str, about: str, line: str) -> None:
        """Count a candidate and show the best one."""
        self.done, self.best = self.done + 1, min(self.best, float(line))
        self._show(f"best ratio {self.best:.4g}, last {float(line):.4g}, {self.generation}")

    def say(self, line: str) -> None:
        """Show a line of the search itself."""
        self._show(line)

    def end(self, job: str) -> None:
        """Show nothing."""


def search(of: Search, display: Display) -> Tuned:
    """Return the result of all runs of the search, shown under the name of its design.

    Raises DesignError where a process fails, or the proposal has no certificate.
    """
    archive: Archive = {}
    population = _first_population(of)
    trials = Trials(display, of.stage.name, len(population) * (1 + len(WEIGHTS) * of.plan.generations))
    trials.say(f"{len(WEIGHTS)} runs of {of.plan.generations} generations of {len(population)} candidates")
    for run, weights in enumerate(WEIGHTS, 1):
        population = _best(of, archive, weights, len(population)) if len(archive) else population
        _run(of, f"run {run}/{len(WEIGHTS)}", weights, population, archive, trials)
    candidates = list(archive.values())
    proposal = min(candidates, key=lambda c: score(c, WEIGHTS[0]))
    trials.say("certificate of the proposal")
    job = Job("certificate", of.stage.name, lambda say: certify(of, proposal))
    outcome = jobs.run([job], trials)[job.name]
    if outcome.error:
        raise DesignError(f"certificate of the proposal for '{of.stage.name}': {outcome.error}")
    return Tuned(of.plan, candidates[0], proposal, outcome.value, pareto_front(candidates), len(candidates))


def _first_population(of: Search) -> Shares:
    """Return the declared values and a Latin hypercube (candidates, parameters), as shares of the ranges."""
    from scipy.stats import qmc  # slow to import (1 s) and seldom needed

    free = of.tuning.free
    n = max(LEAST, A_PARAMETER * len(free))
    random = qmc.LatinHypercube(len(free), rng=np.random.default_rng([of.plan.seed, len(WEIGHTS)])).random(n - 1)
    return np.vstack([[f.share for f in free], random])


def _best(of: Search, archive: Archive, weights: tuple[float, float], n: int) -> Shares:
    """Return the n best candidates for other weights, from which the next run begins."""
    return np.array(sorted(archive, key=lambda shares: score(archive[shares], weights))[:n])


def _run(
    of: Search, run: str, weights: tuple[float, float], population: Shares, archive: Archive, trials: Trials
) -> None:
    """Add the candidates of one run of differential evolution to the archive."""
    from scipy import optimize  # slow to import (1 s) and seldom needed

    generations = iter(range(of.plan.generations + 1))

    def scores(_: Callable[[Shares], float], rows: Iterable[Shares]) -> list[float]:
        keys = [tuple(np.asarray(row).tolist()) for row in rows]
        trials.generation = f"{run}, generation {next(generations)}/{of.plan.generations}"
        archive.update(_evaluate(of, [k for k in dict.fromkeys(keys) if k not in archive], trials))
        return [score(archive[key], weights) for key in keys]

    optimize.differential_evolution(
        _only_in_workers, [(0.0, 1.0)] * population.shape[1], init=population, maxiter=of.plan.generations,
        tol=0.0, atol=0.0, polish=False, updating="deferred", rng=np.random.default_rng(of.plan.seed), workers=scores,
    )  # fmt: skip


def _only_in_workers(row: Shares) -> float:
    raise AssertionError("differential evolution evaluates candidates by its `workers`")


def _evaluate(of: Search, keys: Sequence[tuple[float, ...]], trials: Trials) -> Archive:
    """Return the candidates, computed by all cores; raise DesignError where a process fails."""
    processes = min(jobs.cores(), len(keys))
    parts = [keys[k::processes] for k in range(processes)]
    work = [
        Job(f"{of.stage.name} candidates {k + 1}", of.stage.name, partial(_batch, of, part))
        for k, part in enumerate(parts)
    ]
    outcomes = jobs.run(work, trials)
    if errors := [outcome.error for outcome in outcomes.values() if outcome.error]:
        raise DesignError(f"candidates of '{of.stage.name}': {errors[0]}")
    computed: Archive = {}
    for job, part in zip(work, parts, strict=True):
        computed |= zip(part, outcomes[job.name].value, strict=True)
    return {key: computed[key] for key in keys}


def _batch(of: Search, keys: Sequence[tuple[float, ...]], progress: Progress) -> list[Candidate]:
    candidates = []
    for shares in keys:
        candidates.append(of.evaluate({f.name: f.at(s) for f, s in zip(of.tuning.free, shares, strict=True)}))
        progress(repr(candidates[-1].worst))
    return candidates


def pareto_front(candidates: Sequence[Candidate]) -> tuple[Candidate, ...]:
    """Return the candidates that no other one equals or betters in both ratios, the best of the experiments first."""
    front: list[Candidate] = []
    for candidate in sorted(candidates, key=lambda c: (c.performance, c.robustness)):
        if not candidate.error and (not front or candidate.robustness < front[-1].robustness):
            front.append(candidate)
    return tuple(front)


def certify(of: Search, proposal: Candidate) -> Certificate:
    """Return the certificate of a proposal: its C with the proofs of the emission, goals and margins with this C.

    The margins are the least at all operating points, corners of the tolerances and cases.

    Raises EmitError where the law cannot be proved, and otherwise as `host.compile_block`.
    """
    stage = with_values(of.stage, of.tuning, proposal.values)
    compiled = host.compile_block(stage.controller.block, stage.scalar, error=stage.surrogate_error.get(stage.scalar))
    goals = measure_goals(of, stage, replace(of.rig, stage=stage, controller=compiled))
    pairs = zip(proposal.goals, goals, strict=True)
    differing = sum(a.name != b.name or not np.array_equal(a.value, b.value, equal_nan=True) for a, b in pairs)
    checks = [Check("goals whose value differs under C of its own", differing, 0.0, "1", "the search runs variants")]
    stage = replace(stage, require={**stage.require, **of.tuning.require})
    survey = verdicts.survey(stage)
    checks += [c for c in verdicts.margins(stage, survey) if np.isfinite(c.limit)]
    return Certificate(goals, tuple(checks), verdicts.least_margins(stage, survey))
