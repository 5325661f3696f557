"""Verification of the emitted C against a NumPy reference, CasADi and CasADi's own C, in double and single precision.

The steps are those of `random_steps`; along motions, each starts from the state of the C in double precision. The
reference and the C in single precision also run free along the motions, from `init`.

A step magnifies rounding errors by the largest condition number of its corrections times its amplification of voltage
errors, which is also large near a decision boundary. Steps above ILL_CONDITIONED are counted, and compared at that
number times epsilon; all others at suite.DOUBLE_TOLERANCE.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from designs.hall_position import (
    config,
    random_steps,
    reference,
    reference_guard,
    reference_rounding,
    verification_protected,
)
from designs.hall_position.glsdc import estimator
from designs.hall_position.random_steps import Subject
from models.hall_motions import Numbers
from synth.check import Check
from synth.simulate import sampling
from synth.verify import agree, replays, suite
from synth.verify.agree import StepResults
from synth.verify.sampling import Columns
from synth.verify.suite import Evidence, Witnesses

FULL_STEPS = {"motions": 100_000, "random": 20_000, "edge": 10_000}  # steps of each estimator
QUICK_STEPS = {"motions": 10_000, "random": 4_000, "edge": 2_000}
FLOOR = 1.0  # m, rad, V: differences of outputs are absolute below it
EPSILON = 2.0**-52
# Share; of the edge steps, half of these hit a bound exactly, or the edge of a pitch before pitches are counted.
ILL_CONDITIONED, MAX_ILL_CONDITIONED = 1e3, 0.02
CHANGE = 1e-9  # of alpha
MAX_ROUNDING_ERRORS = 16  # of condition number times epsilon: a fit has a hundred operations, and 6 are observed
SINGLE = 1e-6  # m
# Yaw in rad, equal to SINGLE half a pitch away; residual in V, a fifth of the noise; deviation, relative.
SINGLE_YAW, SINGLE_RESIDUAL, SINGLE_DEVIATION = 4e-5, 2e-4, 5e-3
RELATIVE = 1e-10  # of deviations in double precision
STEP, NARROW = 2.0**-23, 2e-3  # of single precision; share of steps with a cost that close to its bound
OTHER_DECISIONS = 0.01  # share of the steps along motions with another decision in single precision
OTHER_VALIDITY = 2e-3
OF_CONDITION = "condition number times epsilon"
DECISIONS = ("converged", "damped", "valid")
Progress = Callable[[str], None]
Comparison = tuple[Sequence[agree.Agreement], Sequence[Check]]


@dataclass(frozen=True, eq=False)
class Steps:
    """N steps: states and inputs (N,) by name, magnification of rounding errors (N,), and margin of the costs (N,)."""

    what: str
    states: Columns
    inputs: Columns
    severity: Numbers
    margin: Numbers


def witnesses(subject: Subject) -> Witnesses:
    """Return the witnesses of an estimator."""
    return suite.witnesses(subject.block, partial(reference_guard.step, subject.setup), estimator.SURROGATE_ERROR)


def verify(progress: Progress, whole: bool) -> Evidence:
    """Compare all witnesses of the estimators, over FULL_STEPS or over QUICK_STEPS numbers of steps."""
    agreements: list[agree.Agreement] = []
    checks: list[Check] = []
    progress(f"{config.NAME}: witnesses")
    subject = random_steps.subject()
    for some_agreements, some in compare_witnesses(
        subject, witnesses(subject), FULL_STEPS if whole else QUICK_STEPS, progress
    ):
        agreements += some_agreements
        checks += some
    some_agreements, some = verification_protected.verify(progress, whole)
    return Evidence(config.NAME, (*agreements, *some_agreements), (*checks, *some))


def compare_witnesses(
    subject: Subject, witness_set: Witnesses, sizes: Mapping[str, int], progress: Progress
) -> Iterator[Comparison]:
    """Yield the comparisons of an estimator."""
    inputs = random_steps.motion_inputs(subject, sizes["motions"])
    kinds: dict[str, Callable[[], tuple[Columns, Columns]]] = {
        "motions": partial(sampling.consecutive_steps, witness_set.c64, inputs),
        "random": partial(random_steps.operating_steps, subject, sizes["random"]),
        "edge": partial(random_steps.edge_steps, subject, sizes["edge"]),
    }
    for kind, draw in kinds.items():
        progress(f"{subject.name}: {kind} steps")
        steps = condition_steps(subject, f"{subject.name}, {kind} steps", *draw())
        c64 = witness_set.by_name["c64"](steps.states, steps.inputs)
        yield (), [ill_conditioned_share(steps)]
        for name in suite.WITNESS_NAMES:
            yield compare_double(subject, steps, (name, witness_set.by_name[name](steps.states, steps.inputs)), c64)
        if kind == "motions":
            yield compare_single(subject, witness_set, steps)
    progress(f"{subject.name}: free-running")
    yield (), free_running(subject, witness_set, inputs)


def condition_steps(subject: Subject, what: str, states: Columns, inputs: Columns) -> Steps:
    """Return steps with the magnification of their rounding errors and the margins of their costs."""
    held, refused = reference_guard.hold_voltages(subject.setup, states, inputs)
    step = subject.setup, reference_guard.estimator_states(states), held, refused
    margin = reference_rounding.margin(*step[:3])
    near = np.where(near_decision_boundary(subject, *step[1:]), 1 / CHANGE, 0.0)
    severity = np.maximum(reference_rounding.magnification(*step), near)
    return Steps(what, states, inputs, severity, margin)


def near_decision_boundary(subject: Subject, states: Columns, held: Numbers, refused: Numbers) -> NDArray[np.bool_]:
    """Return for each step whether a decision changes when its voltages change by CHANGE of alpha."""
    change = CHANGE * subject.array.alpha * np.random.default_rng(0).standard_normal(held.shape)
    (out, after), (other, then) = (reference.step(subject.setup, states, v, refused) for v in (held, held + change))
    counts = [s.name.removeprefix(reference_guard.PREFIX) for s in subject.block.states if s.integer]
    flags = [out[name] != other[name] for name in DECISIONS]
    return np.any([*flags, *(after[n] != then[n] for n in counts if n in after)], axis=0)


def ill_conditioned_share(steps: Steps) -> Check:
    """Check the share of steps that are compared at their condition number times epsilon."""
    above = steps.severity > ILL_CONDITIONED
    about = f"{np.count_nonzero(above)} of {len(above)} steps, at most {steps.severity.max():.2g}"
    name = f"{steps.what}: share with a condition number above {ILL_CONDITIONED:g}"
    return Check(name, float(np.mean(above)), MAX_ILL_CONDITIONED, "1", about)


def compare_double(subject: Subject, steps: Steps, first: tuple[str, StepResults], c64: StepResults) -> Comparison:
    """Compare a witness {name, steps} with the C in double precision."""
    above = steps.severity > ILL_CONDITIONED
    pair = (first[0], suite.select(first[1], ~above)), ("c64", suite.select(c64, ~above))
    a = agree.compare(steps.what, *pair, FLOOR, subject.block)
    outputs, states = agree.differences(first[1], c64, FLOOR, subject.block)
    magnified = np.max([*outputs.values(), *states.values()], axis=0) / (EPSILON * steps.severity)
    differing = int(np.count_nonzero(first[1].faults != c64.faults))
    name = f"{steps.what}: {first[0]} against c64"
    return [a], [
        Check(name, a.worst, suite.DOUBLE_TOLERANCE, f"max({FLOOR:g}, |y|)", f"worst of {a.samples} steps, {a.signal}"),
        Check(f"{name}, next states", a.state_worst, suite.DOUBLE_TOLERANCE, "of range", a.state),
        Check(f"{name}, deviations", _relative_deviation_error(pair[0][1], pair[1][1]), RELATIVE, "of itself"),
        Check(
            f"{name}, at ill-conditioned steps",
            float(magnified[above].max(initial=0.0)),
            MAX_ROUNDING_ERRORS,
            OF_CONDITION,
        ),
        Check(f"{name}, fault words that differ", differing, 0, "1"),
    ]


def compare_single(subject: Subject, witness_set: Witnesses, steps: Steps) -> Comparison:
    """Compare positions in single with those in double precision from the same bits, and count other decisions.

    The states are those of the C in double precision, rounded. Steps are left out where a decision differs, and where,
    far from a solution, two costs of several volts differ by rounding only: there positions may differ too.
    """
    double, single = suite.in_both_precisions(witness_set, steps.states, steps.inputs)
    same = _same_decisions(subject, double, single)
    converged = double.outputs["converged"] > 0
    narrow = ~converged & (steps.margin < STEP)
    chosen = same & ~narrow & (steps.severity <= ILL_CONDITIONED)
    pair = suite.select(double, chosen), suite.select(single, chosen)
    a = agree.compare(steps.what, ("c64", pair[0]), ("c32", pair[1]), FLOOR, subject.block, np.float32)
    less = "single less double"
    rows = [
        (f"yaw, {less}", _gap(*pair, "yaw").max(initial=0.0), SINGLE_YAW, "rad", ""),
        (f"residual, {less}", _gap(*pair, "residual").max(initial=0.0), SINGLE_RESIDUAL, "V", ""),
        (f"deviations, {less}", _relative_deviation_error(*pair), SINGLE_DEVIATION, "of itself", ""),
        ("decisions that differ in single precision", np.mean(~same), OTHER_DECISIONS, "1", ""),
        ("not converged, costs that differ only by rounding", np.mean(narrow), NARROW, "1", ""),
    ]
    off = np.maximum(_gap(double, single, "X"), _gap(double, single, "Y"))
    for where, among in (("converged", chosen & converged), ("not converged", chosen & ~converged)):
        about = f"{np.count_nonzero(among)} of {len(chosen)} steps, errors magnified up to {ILL_CONDITIONED:g} times"
        rows.append((f"X and Y, {less}, where {where}", off[among].max(initial=0.0), SINGLE, "m", about))
    return [a], [
        Check(f"{steps.what}: {name}", float(error), limit, unit, about) for name, error, limit, unit, about in rows
    ]


def _same_decisions(subject: Subject, double: StepResults, single: StepResults) -> NDArray[np.bool_]:
    """Return for each step whether flags and counts are equal, and no angle is wrapped in one of the two only."""
    same = suite.same_decisions(subject.block, double, single)
    for flag in DECISIONS:
        same &= double.outputs[flag] == single.outputs[flag]
    _, states = agree.differences(double, single, FLOOR, subject.block)
    return same & np.all([states[s.name] < 0.5 for s in subject.block.states if not s.integer], axis=0)


def _relative_deviation_error(first: StepResults, second: StepResults) -> float:
    """Return the largest relative difference of a standard deviation."""
    sizes = {n: np.abs(v.astype(np.float64)) for n, v in first.outputs.items() if n.startswith("deviation")}
    return max(float((_gap(first, second, n) / size).max(initial=0.0)) for n, size in sizes.items())


def _gap(first: StepResults, second: StepResults, name: str) -> Numbers:
    return np.abs(second.outputs[name].astype(np.float64) - first.outputs[name])


def free_running(subject: Subject, witness_set: Witnesses, inputs: Columns) -> list[Check]:
    """Compare valid positions of the free-running reference and of single precision with those of the C."""
    start = {s.name: s.initial for s in subject.block.states}
    double, reference_outputs, single = (
        replays.run(witness, start, inputs).outputs
        for witness in (witness_set.by_name["c64"], witness_set.by_name["reference"], agree.emitted_c(witness_set.c32))
    )
    checks = []
    for name, outputs, limit, share in (
        ("reference", reference_outputs, suite.DOUBLE_TOLERANCE, 0.0),
        ("c32", single, SINGLE, OTHER_VALIDITY),
    ):
        both = (outputs["valid"] > 0) & (double["valid"] > 0)
        worst = max(float(np.abs(outputs[y] - double[y])[both].max(initial=0.0)) for y in ("X", "Y"))
        differing = float(np.mean(outputs["valid"] != double["valid"]))
        about = f"{np.count_nonzero(both)} of {both.size} samples from init are valid"
        what = f"{subject.name}, free-running: {name} against c64"
        checks.append(Check(f"{what}, where valid", worst, limit, "m", about))
        checks.append(Check(f"{what}, share of samples whose validity differs", differing, share, "1"))
    return checks
