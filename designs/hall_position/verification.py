"""Verification of the emitted C: NumPy reference, CasADi, CasADi's own C, and the C in double and in single precision.

Steps are those of `random_steps`, of motions each from the state that the C has come to. Besides, the reference and
single precision run free along the motions, from `init` on. The C in single precision follows bodies that move at
random, for long.

Errors of rounding are magnified in a step by the largest condition number of its corrections times that by which the
step magnifies a change of its voltages: it is large near a decision boundary as well. Steps above ILL_CONDITIONED are
counted, and compared at that number times epsilon; all others at suite.EXACT.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from designs.hall_position import config, random_steps, reference, reference_guard, reference_rounding
from designs.hall_position.glsdc import estimator
from designs.hall_position.random_steps import Subject
from designs.hall_position.trust import endurance
from designs.hall_position.trust.fleet import EstimatorConfig
from models.hall_motions import Numbers
from synth.check import Check
from synth.execute import host
from synth.simulate import ensemble
from synth.verify import agree, suite
from synth.verify.agree import Stepped
from synth.verify.evidence import Evidence
from synth.verify.sampling import Columns
from synth.verify.suite import Witnesses

WHOLE = {"motions": 100_000, "random": 20_000, "edge": 10_000}  # steps of each estimator
QUICK = {"motions": 10_000, "random": 4_000, "edge": 2_000}
BODIES, LONG, SHORT = 2000, 5000, 50  # in motion without end, and their samples: ten million, or few
FLOOR = 1.0  # m, rad, V: differences of outputs are absolute below it
EPSILON = 2.0**-52
ILL_CONDITIONED, ILL_SHARE = 1e3, 0.02  # of steps drawn at the edges half of these come to a bound exactly
CHANGE = 1e-9  # of alpha
TIMES = 16  # condition numbers times epsilon; a fit has a hundred operations, and 6 are seen
SINGLE = 1e-6  # m
# Of a yaw, rad, which half a pitch away moves as far; of residuals, V, a fifth of the noise; of a deviation, of itself.
SINGLE_YAW, SINGLE_RESIDUAL, SINGLE_DEVIATION = 4e-5, 2e-4, 5e-3
RELATIVE = 1e-10  # of deviations in double precision, which are micrometres
STEP, NARROW = 2.0**-23, 2e-3  # of single precision; share of steps of which a cost is that near its bound
OTHERWISE = 0.01  # share of the steps of motions that decide otherwise in single precision
VALID_OTHERWISE = 2e-3
OF_CONDITION = "condition number times epsilon"
DECISIONS = ("converged", "damped", "valid")
Progress = Callable[[str], None]
Compared = tuple[Sequence[agree.Agreement], Sequence[Check]]


@dataclass(frozen=True, eq=False)
class Steps:
    """N steps: states and inputs (N,) by name, what magnifies their errors (N,), and the margin of their costs (N,)."""

    what: str
    states: Columns
    inputs: Columns
    severity: Numbers
    margin: Numbers


def witnesses(of: Subject) -> Witnesses:
    """Return the witnesses of an estimator."""
    return suite.witnesses(of.block, partial(reference_guard.step, of.of), estimator.SURROGATE_ERROR)


def verify(progress: Progress, whole: bool) -> Evidence:
    """Compare all witnesses of both estimators, over many steps or over few."""
    agreements: list[agree.Agreement] = []
    checks: list[Check] = []
    for name in config.PLACES:
        progress(f"{name}: witnesses")
        of = random_steps.subject(name)
        for found, some in compared(of, witnesses(of), WHOLE if whole else QUICK, progress):
            agreements += found
            checks += some
        progress(f"{name}: random motion without end")
        checks += endurance.checks(name, EstimatorConfig(config.array(name)), BODIES, LONG if whole else SHORT)
    return Evidence(config.NAME, tuple(agreements), tuple(checks))


def compared(of: Subject, by: Witnesses, sizes: Mapping[str, int], progress: Progress) -> Iterator[Compared]:
    """Yield the comparisons of an estimator."""
    inputs = random_steps.along_motions(of, sizes["motions"])
    kinds = {
        "motions": partial(along, of, by.c64, inputs),
        "random": partial(random_steps.in_operation, of, sizes["random"]),
        "edge": partial(random_steps.at_the_edges, of, sizes["edge"]),
    }
    for kind, draw in kinds.items():
        progress(f"{of.name}: {kind} steps")
        steps = conditioned(of, f"{of.name}, {kind} steps", *draw())
        c64 = by.of["c64"](steps.states, steps.inputs)
        yield (), [ill_conditioned(steps)]
        for name in suite.OTHERS:
            yield exact(of, steps, (name, by.of[name](steps.states, steps.inputs)), c64)
        if kind == "motions":
            yield in_single(of, by, steps)
    progress(f"{of.name}: each its own way")
    yield (), free_running(of, by, inputs)


def along(of: Subject, controller: host.Controller, inputs: Columns) -> tuple[Columns, Columns]:
    """Return the steps that the C takes from `init` over columns (samples, bodies) of inputs, one after the other."""
    batches = list(ensemble.replayed(controller, inputs))
    before = [ensemble.started(controller, len(batches[0].states)), *(batch.states for batch in batches[:-1])]
    recorded = np.concatenate(before)
    return {s.name: recorded[s.name] for s in of.block.states}, {n: v.ravel() for n, v in inputs.items()}


def conditioned(of: Subject, what: str, states: Columns, inputs: Columns) -> Steps:
    """Return steps with what magnifies their errors."""
    held, refused = reference_guard.hold_refused(of.of, states, inputs)
    step = of.of, reference_guard.estimator_states(states), held, refused
    near = np.where(near_decision_boundary(of, *step[1:]), 1 / CHANGE, 0.0)
    severity = np.maximum(reference_rounding.magnification(*step), near)
    return Steps(what, states, inputs, severity, reference_rounding.margin(*step))


def near_decision_boundary(of: Subject, states: Columns, held: Numbers, refused: Numbers) -> NDArray[np.bool_]:
    """Tell for each step whether a decision is another one when its voltages move by CHANGE of alpha."""
    change = CHANGE * of.array.alpha * np.random.default_rng(0).standard_normal(held.shape)
    (out, after), (other, then) = (reference.step(of.of, states, v, refused) for v in (held, held + change))
    counts = [s.name.removeprefix(reference_guard.PREFIX) for s in of.block.states if s.integer]
    flags = [out[name] != other[name] for name in DECISIONS]
    return np.any([*flags, *(after[n] != then[n] for n in counts if n in after)], axis=0)


def ill_conditioned(steps: Steps) -> Check:
    """Return the share of steps that are compared at their condition number times epsilon."""
    above = steps.severity > ILL_CONDITIONED
    about = f"{np.count_nonzero(above)} of {len(above)} steps, at most {steps.severity.max():.2g}"
    name = f"{steps.what}: magnified over {ILL_CONDITIONED:g} times"
    return Check(name, float(np.mean(above)), ILL_SHARE, "1", about)


def exact(of: Subject, steps: Steps, first: tuple[str, Stepped], c64: Stepped) -> Compared:
    """Compare a witness by name with the C in double precision."""
    above = steps.severity > ILL_CONDITIONED
    pair = (first[0], suite.part(first[1], ~above)), ("c64", suite.part(c64, ~above))
    a = agree.compare(steps.what, *pair, FLOOR, of.block)
    outputs, states = agree.differences(first[1], c64, FLOOR, of.block)
    magnified = np.max([*outputs.values(), *states.values()], axis=0) / (EPSILON * steps.severity)
    unlike = int(np.count_nonzero(first[1].faults != c64.faults))
    name = f"{steps.what}: {first[0]} against c64"
    return [a], [
        Check(name, a.worst, suite.EXACT, f"max({FLOOR:g}, |y|)", f"worst of {a.samples} steps, {a.signal}"),
        Check(f"{name}, next states", a.state_worst, suite.EXACT, "of range", a.state),
        Check(f"{name}, deviations", _of_deviations(pair[0][1], pair[1][1]), RELATIVE, "of itself"),
        Check(f"{name}, where magnified", float(magnified[above].max(initial=0.0)), TIMES, OF_CONDITION),
        Check(f"{name}, fault words unlike", unlike, 0, "1"),
    ]


def in_single(of: Subject, by: Witnesses, steps: Steps) -> Compared:
    """Compare positions in single with those in double from the same bits, and count other decisions.

    From the states of the C in double, rounded. Where a decision is another one, so may the position be; and where, far
    from a solution, one cost of several volts is as low as another but for rounding.
    """
    double, single = suite.in_single(by, steps.states, steps.inputs)
    alike = _decides_alike(of, double, single)
    converged = double.outputs["converged"] > 0
    narrow = ~converged & (steps.margin < STEP)
    chosen = alike & ~narrow & (steps.severity <= ILL_CONDITIONED)
    pair = suite.part(double, chosen), suite.part(single, chosen)
    a = agree.compare(steps.what, ("c64", pair[0]), ("c32", pair[1]), FLOOR, of.block, np.float32)
    less = "single less double"
    rows = [
        (f"yaw, {less}", _gap(*pair, "yaw").max(initial=0.0), SINGLE_YAW, "rad", ""),
        (f"residual, {less}", _gap(*pair, "residual").max(initial=0.0), SINGLE_RESIDUAL, "V", ""),
        (f"deviations, {less}", _of_deviations(*pair), SINGLE_DEVIATION, "of itself", ""),
        ("decisions otherwise in single", np.mean(~alike), OTHERWISE, "1", ""),
        ("not converged, costs apart by rounding in single", np.mean(narrow), NARROW, "1", ""),
    ]
    off = np.maximum(_gap(double, single, "X"), _gap(double, single, "Y"))
    for where, among in (("converged", chosen & converged), ("not converged", chosen & ~converged)):
        about = f"{np.count_nonzero(among)} of {len(chosen)} steps, errors magnified up to {ILL_CONDITIONED:g} times"
        rows.append((f"X and Y, {less}, where {where}", off[among].max(initial=0.0), SINGLE, "m", about))
    return [a], [
        Check(f"{steps.what}: {name}", float(found), limit, unit, about) for name, found, limit, unit, about in rows
    ]


def _decides_alike(of: Subject, double: Stepped, single: Stepped) -> NDArray[np.bool_]:
    """Tell for each step whether flags and counts are alike, and no angle has been wrapped in one of them alone."""
    alike = suite.decide_alike(of.block, double, single)
    for flag in DECISIONS:
        alike &= double.outputs[flag] == single.outputs[flag]
    _, states = agree.differences(double, single, FLOOR, of.block)
    return alike & np.all([states[s.name] < 0.5 for s in of.block.states if not s.integer], axis=0)


def _of_deviations(first: Stepped, second: Stepped) -> float:
    """Return by how much of itself a standard deviation differs, at most."""
    sizes = {n: np.abs(v.astype(np.float64)) for n, v in first.outputs.items() if n.startswith("deviation")}
    return max(float((_gap(first, second, n) / size).max(initial=0.0)) for n, size in sizes.items())


def _gap(first: Stepped, second: Stepped, name: str) -> Numbers:
    return np.abs(second.outputs[name].astype(np.float64) - first.outputs[name])


def free_running(of: Subject, by: Witnesses, inputs: Columns) -> list[Check]:
    """Compare valid positions of the reference and of single precision, each on its own way, with those of the C."""
    start = {s.name: s.initial for s in of.block.states}
    double, alone, single = (
        agree.recorded(witness, start, inputs).outputs
        for witness in (by.of["c64"], by.of["reference"], agree.emitted(by.c32))
    )
    checks = []
    for name, way, limit, share in (("reference", alone, suite.EXACT, 0.0), ("c32", single, SINGLE, VALID_OTHERWISE)):
        both = (way["valid"] > 0) & (double["valid"] > 0)
        worst = max(float(np.abs(way[y] - double[y])[both].max(initial=0.0)) for y in ("X", "Y"))
        unlike = float(np.mean(way["valid"] != double["valid"]))
        about = f"{np.count_nonzero(both)} of {both.size} samples from init are valid"
        what = f"{of.name}, each its own way: {name} against c64"
        checks.append(Check(f"{what}, where valid", worst, limit, "m", about))
        checks.append(Check(f"{what}, valid unlike", unlike, share, "1"))
    return checks
