"""Back-to-back tests of a Block with independent witnesses: reference, CasADi, C of CasADi, and the emitted C.

    reference, casadi, casadi_c --- against --- c64     to 1e-12 of max(floor, |output|), or of the range of a state
    c64 ------------------------- against --- c32       from the same bits, where both take the same decisions

The stimuli are random steps (`sampling`) and recorded inputs that are replayed from `init`.

Verification evidence of a design: measured values with their limits.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth import check as checks
from synth import show
from synth.analyse.loops.robustness import Survey
from synth.block import Block
from synth.check import Check
from synth.declare.stage import Reference
from synth.declare.tuning import BenchMargins
from synth.execute import host
from synth.simulate import study as studies
from synth.simulate.faults.fault_table import Campaign
from synth.simulate.study import StudyTable
from synth.verify import agree, disagreement, replays, steps
from synth.verify.agree import Agreement, Columns, StepResults


@show.with_repr
@dataclass(frozen=True, repr=False)
class Evidence:
    """Agreements between witnesses and the checks that follow from them; what else a build measured, where it did.

    `loops` are the loops with their margins, `bench` the margins over the bench, `faults` the campaign, `study` the
    study. `verdicts` are the checks that the toolkit makes of these and of audit and cost, by title of the section of
    the report that shows them.
    """

    design: str
    agreements: Sequence[Agreement]
    checks: Sequence[Check]
    faults: Campaign | None = None
    study: StudyTable | None = None
    loops: Survey | None = None
    bench: BenchMargins | None = None
    verdicts: Mapping[str, Sequence[Check]] = field(default_factory=dict)

    def sheet(self) -> show.Sheet:
        """Return the checks and the agreements."""
        failed = sum(not c.passed for c in self.checks)
        title = f"Evidence of {self.design}: {len(self.checks)} checks, {failed} failed"
        agreements = (
            (f"{a.first}, {a.second}", a.what, str(a.samples), show.number(a.worst), a.signal) for a in self.agreements
        )
        columns = ("witnesses", "compared", "samples", "worst difference", "signal")
        tables = [checks.table(self.checks), show.Table("", columns, tuple(agreements))]
        lines = [line for d in self.disagreements for line in (d.sheet().title, *d.sheet().lines)]
        return show.Sheet(title, tuple(lines), tuple(t for t in tables if t.rows))

    @property
    def disagreements(self) -> list[show.Shown]:
        """Where each witness parts from the law, in the first comparison that shows it."""
        return [*{a.first: a.disagreement for a in reversed(self.agreements) if a.disagreement}.values()][::-1]

    @property
    def passed(self) -> bool:
        """Whether every check passes."""
        return all(c.passed for c in self.checks)

    def document(self) -> Mapping[str, Any]:
        """Return the evidence as a JSON document."""
        return {
            "design": self.design,
            "passed": self.passed,
            "agreements": [
                {k: v for k, v in asdict(a).items() if k != "disagreement" or v is not None} for a in self.agreements
            ],
            "checks": [c.document() for c in self.checks],
            **({"faults": self.faults.document()} if self.faults else {}),
            **({"study": studies.document(self.study)} if self.study else {}),
        }


# Of max(floor, |output|), and of the range of a state: rounding of some hundred operations in double.
DOUBLE_TOLERANCE = 1e-12
WITNESS_NAMES = ("reference", "casadi", "casadi_c")  # witnesses that are compared with the C in double precision


@dataclass(frozen=True, eq=False)
class Witnesses:
    """The witnesses of one step of a Block by name, and its compiled C in both scalar types."""

    block: Block
    by_name: Mapping[str, agree.Witness]
    c64: host.Controller
    c32: host.Controller

    @property
    def oracles(self) -> dict[str, agree.Witness]:
        """The witnesses that the C in double precision is compared with."""
        return {name: witness for name, witness in self.by_name.items() if name != "c64"}


def witnesses(block: Block, reference: Reference, error: Mapping[type[np.floating], float] | None = None) -> Witnesses:
    """Return all witnesses of a Block; `error` is the relative error of surrogates by scalar type."""
    c64, c32 = (host.compile_block(block, t, error=(error or {}).get(t)) for t in (np.float64, np.float32))
    others = {"reference": agree.reference(reference, block), "casadi": agree.casadi(block)}
    return Witnesses(block, others | {"casadi_c": agree.casadi_own_c(block), "c64": agree.emitted_c(c64)}, c64, c32)


def compare(
    what: str,
    witness_set: Witnesses,
    states: Columns,
    inputs: Columns,
    floor: agree.Floor,
    authority: Mapping[str, float] | None = None,
) -> list[Agreement]:
    """Compare each other witness with the C in double precision over N steps (x, u), as `agree.compare`.

    One that differs is compared with the law as well: see `disagreement.localise`.
    """
    c64, block = witness_set.by_name["c64"](states, inputs), witness_set.block
    agreements = [
        agree.compare(what, (name, witness(states, inputs)), ("c64", c64), floor, block, authority=authority)
        for name, witness in witness_set.oracles.items()
    ]
    return [a if _agrees(a) else _with_disagreement(a, witness_set, (states, inputs), floor) for a in agreements]


def _agrees(a: Agreement) -> bool:
    """Return whether an agreement passes its checks."""
    worst = a.worst, a.state_worst, a.authority_worst or 0.0
    return all(difference <= DOUBLE_TOLERANCE for difference in worst) and not a.faults_differ  # NaN is none


def _with_disagreement(a: Agreement, by: Witnesses, stimuli: tuple[Columns, Columns], floor: agree.Floor) -> Agreement:
    """Return an agreement with the place where the witness parts from the law over steps (states, inputs)."""
    place = disagreement.localise(a.what, a.first, by.block, by.by_name, stimuli, floor, DOUBLE_TOLERANCE)
    return replace(a, disagreement=place)


def replay(
    witness_set: Witnesses,
    runs: Mapping[str, Columns],
    floor: agree.Floor,
    authority: Mapping[str, float] | None = None,
) -> list[Agreement]:
    """Compare each other witness with the C in double precision over the N recorded inputs of each run.

    A witness that differs is compared with the law as well, in single steps from the states of the C.
    """
    c64 = [replays.replay_in_parts(witness_set.c64, inputs) for inputs in runs.values()]
    others = {name: replays.repeat(witness, c64) for name, witness in witness_set.oracles.items()}
    agreements = [
        agree.compare(what, (name, pairs[k][0]), ("c64", pairs[k][1]), floor, witness_set.block, authority=authority)
        for k, what in enumerate(runs)
        for name, pairs in others.items()
    ]
    first = {a.first: a for a in reversed(agreements) if not _agrees(a)}
    for a in first.values():
        recorded = steps.record(witness_set.c64, a.what, runs[a.what])
        stimuli = host.columns(recorded.states), host.columns(recorded.inputs)
        agreements[agreements.index(a)] = _with_disagreement(a, witness_set, stimuli, floor)
    return agreements


def exact_checks(agreements: Sequence[Agreement], unit: str) -> list[Check]:
    """Return the checks of each agreement in double precision: outputs in `unit`, next states, and fault words."""
    checks = []
    for a in agreements:
        about, pair = f"worst of {a.samples} steps, {a.signal}", f"{a.first} and {a.second}"
        checks += [
            Check(f"{a.what}: {a.first} against {a.second}", a.worst, DOUBLE_TOLERANCE, unit, about),
            Check(f"{a.what}: next states of {pair}", a.state_worst, DOUBLE_TOLERANCE, "of range", a.state),
            Check(f"{a.what}: fault words of {pair} that differ", a.faults_differ, 0, "1"),
        ]
        if a.authority_worst is not None:
            law = f"{a.what}: next states of the law of {pair}"
            checks.append(Check(law, a.authority_worst, DOUBLE_TOLERANCE, "max(|x|, authority)"))
    return checks


def in_both_precisions(witness_set: Witnesses, states: Columns, inputs: Columns) -> tuple[StepResults, StepResults]:
    """Return the steps of the C in double and in single precision, from the same values rounded to single."""
    x, u = ({n: v.astype(np.float32) for n, v in columns.items()} for columns in (states, inputs))
    return agree.emitted_c(witness_set.c64)(x, u), agree.emitted_c(witness_set.c32)(x, u)


def same_decisions(block: Block, first: StepResults, second: StepResults) -> NDArray[np.bool_]:
    """Return for each step (N,) whether fault words and integer states of two witnesses are equal."""
    same = np.asarray(first.faults) == np.asarray(second.faults)
    for s in (s for s in block.states if s.integer):
        same &= np.asarray(first.states[s.name]) == np.asarray(second.states[s.name])
    return np.asarray(same)


def select(stepped: StepResults, chosen: NDArray[np.bool_]) -> StepResults:
    """Return the chosen steps among N."""
    outputs, states = ({n: v[chosen] for n, v in c.items()} for c in (stepped.outputs, stepped.states))
    return StepResults(outputs, states, stepped.faults[chosen])
