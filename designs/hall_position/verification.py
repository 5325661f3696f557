"""Verification of the emitted C: NumPy reference, CasADi, CasADi's own C, and the C in double and in single precision.

Steps are those of `random_steps`, of motions each from the state that the C has come to. Besides, the reference and
single precision go their own ways along the motions, from `init` on. The C in single precision follows bodies that
move at random, for long.

What magnifies errors of rounding is, for a step, the largest condition number of its corrections times that by which
the step magnifies a change of its voltages: it is large where a decision hangs by less than that change as well. Steps
above SEVERE are counted, and compared at that number times epsilon; all others at suite.EXACT.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from designs.hall_position import random_steps, reference, reference_guard, shipped
from designs.hall_position.glsdc import estimator
from designs.hall_position.random_steps import LENGTH, Columns, Subject
from designs.hall_position.trust import endurance
from designs.hall_position.trust.fleet import Kind
from designs.hall_position.trust.motions import Numbers
from synth.check import Check
from synth.execute import host
from synth.simulate import ensemble
from synth.verify import agree, suite
from synth.verify.agree import Stepped
from synth.verify.evidence import Evidence
from synth.verify.suite import Witnesses

WHOLE = {"motions": 100_000, "random": 20_000, "edge": 10_000}  # steps of each estimator
QUICK = {"motions": 10_000, "random": 4_000, "edge": 2_000}
BODIES, LONG, SHORT = 2000, 5000, 50  # in motion without end, and their samples: ten million, or few
FLOOR = 1.0  # m, rad, V: differences of outputs are absolute below it
EPSILON = 2.0**-52
SEVERE, SEVERE_SHARE = 1e3, 0.02  # of steps drawn at the edges half of these come to a bound exactly
HANGS = 1e-9  # of alpha
TIMES = 16  # condition numbers times epsilon; a fit has a hundred operations, and 6 are seen
SINGLE = 1e-6  # m
# Of a yaw, rad, which half a pitch away moves as far; of residuals, V, a fifth of the noise; of a deviation, of itself.
SINGLE_YAW, SINGLE_RESIDUAL, SINGLE_DEVIATION = 4e-5, 2e-4, 5e-3
RELATIVE = 1e-10  # of deviations in double precision, which are micrometres
STEP, NARROW = 2.0**-23, 2e-3  # of single precision; share of steps of which a cost is that near its bound
OTHERWISE = 0.01  # share of the steps of motions that decide otherwise in single precision
VALID_OTHERWISE = 2e-3
DECISIONS = ("converged", "damped", "valid")
Told = Callable[[str], None]
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


def verify(told: Told, whole: bool) -> Evidence:
    """Compare all witnesses of both estimators, over many steps or over few."""
    sizes = WHOLE if whole else QUICK
    agreements: list[agree.Agreement] = []
    checks: list[Check] = []
    for name in shipped.PLACES:
        told(f"{name}: witnesses")
        of = random_steps.subject(name)
        for found, some in compared(of, witnesses(of), sizes, told):
            agreements += found
            checks += some
        told(f"{name}: random motion without end")
        kind = Kind(shipped.array(name), shipped.TUNING, shipped.TIME)
        checks += endurance.checks(name, kind, BODIES, LONG if whole else SHORT)
    return Evidence(shipped.NAME, tuple(agreements), tuple(checks))


def compared(of: Subject, by: Witnesses, sizes: Mapping[str, int], told: Told) -> Iterator[Compared]:
    """Yield the comparisons of an estimator."""
    inputs = random_steps.measured(of, shipped.TIME.period_s, sizes["motions"])
    kinds = {
        "motions": partial(along, of, by.c64, inputs),
        "random": partial(random_steps.in_operation, of, sizes["random"]),
        "edge": partial(random_steps.at_the_edges, of, sizes["edge"]),
    }
    for kind, drawn in kinds.items():
        told(f"{of.name}: {kind} steps")
        given = severe(of, f"{of.name}, {kind} steps", *drawn())
        c64 = by.of["c64"](given.states, given.inputs)
        yield (), [shared(given)]
        for name in suite.OTHERS:
            yield exact(of, given, (name, by.of[name](given.states, given.inputs)), c64)
        if kind == "motions":
            yield in_single(of, by, given)
    told(f"{of.name}: each its own way")
    yield (), own_ways(of, by, inputs)


def along(of: Subject, controller: host.Controller, inputs: Columns) -> tuple[Columns, Columns]:
    """Return the steps that the C takes from `init` over columns (samples, bodies) of inputs, one after the other."""
    batches = list(ensemble.replayed(controller, inputs))
    before = [ensemble.started(controller, len(batches[0].states)), *(batch.states for batch in batches[:-1])]
    recorded = np.concatenate(before)
    return {s.name: recorded[s.name] for s in of.block.states}, {n: v.ravel() for n, v in inputs.items()}


def severe(of: Subject, what: str, states: Columns, inputs: Columns) -> Steps:
    """Return steps with what magnifies their errors."""
    held, refused = reference_guard.accepted(of.of, states, inputs)
    own = reference_guard.of_estimator(states)
    found = reference.magnification(of.of, own, held, refused)
    hanging = np.where(_hanging(of, own, held, refused), 1 / HANGS, 0.0)
    return Steps(what, states, inputs, np.maximum(found, hanging), reference.margin(of.of, own, held, refused))


def _hanging(of: Subject, states: Columns, held: Numbers, refused: Numbers) -> NDArray[np.bool_]:
    """Tell for each step whether a decision is another one when its voltages change by HANGS of alpha."""
    change = HANGS * of.array.alpha * np.random.default_rng(0).standard_normal(held.shape)
    (out, after), (other, then) = (reference.step(of.of, states, v, refused) for v in (held, held + change))
    flags = [out[name] != other[name] for name in DECISIONS]
    own = (reference_guard.own_name(s.name) for s in of.block.states if s.integer)
    return np.any([*flags, *(after[n] != then[n] for n in own if n in after)], axis=0)


def shared(given: Steps) -> Check:
    """Return the share of steps that are compared at their condition number times epsilon."""
    above = given.severity > SEVERE
    about = f"{np.count_nonzero(above)} of {len(above)} steps, at most {given.severity.max():.2g}"
    return Check(f"{given.what}: magnified over {SEVERE:g} times", float(np.mean(above)), SEVERE_SHARE, "1", about)


def exact(of: Subject, given: Steps, first: tuple[str, Stepped], c64: Stepped) -> Compared:
    """Compare a witness by name with the C in double precision."""
    above = given.severity > SEVERE
    pair = (first[0], suite.part(first[1], ~above)), ("c64", suite.part(c64, ~above))
    a = agree.compare(given.what, *pair, FLOOR, of.block)
    off = float((apart(of, first[1], c64) / (EPSILON * given.severity))[above].max(initial=0.0))
    unlike = int(np.count_nonzero(first[1].faults != c64.faults))
    about = f"worst of {a.samples} steps, {a.signal}"
    name = f"{given.what}: {first[0]} against c64"
    return [a], [
        Check(name, a.worst, suite.EXACT, f"max({FLOOR:g}, |y|)", about),
        Check(f"{name}, next states", a.state_worst, suite.EXACT, "of range", a.state),
        Check(f"{name}, deviations", _relative(*(stepped for _, stepped in pair)), RELATIVE, "of itself"),
        Check(f"{name}, where magnified", off, TIMES, "condition number times epsilon"),
        Check(f"{name}, fault words unlike", unlike, 0, "1"),
    ]


def apart(of: Subject, first: Stepped, second: Stepped) -> Numbers:
    """Return by how much two witnesses differ in each step (N,): outputs of max(FLOOR, |y|), states of their range."""
    gaps = [
        np.abs(second.outputs[s.name] - first.outputs[s.name]) / np.maximum(FLOOR, np.abs(first.outputs[s.name]))
        for s in of.block.outputs
    ]
    for s in of.block.states:
        width = s.signal.high - s.signal.low
        gaps.append(np.abs(np.asarray(second.states[s.name], dtype=np.float64) - first.states[s.name]) / width)
    found = np.max(gaps, axis=0)
    return np.where(np.isfinite(found), found, np.inf)


def in_single(of: Subject, by: Witnesses, given: Steps) -> Compared:
    """Compare positions in single with those in double from the same bits, and count other decisions.

    From the states of the C in double, rounded. Where a decision is another one, so may the position be; and where, far
    from a solution, one cost of several volts is as low as another but for rounding.
    """
    double, single = suite.in_single(by, given.states, given.inputs)
    alike = double.faults == single.faults
    for flag in DECISIONS:
        alike &= double.outputs[flag] == single.outputs[flag]
    for s in of.block.states:  # a flag, a count, or an angle that has been turned back
        gap = np.abs(np.asarray(double.states[s.name], dtype=np.float64) - single.states[s.name])
        alike &= gap < (0.5 if s.integer else (s.signal.high - s.signal.low) / 2)
    converged = double.outputs["converged"] > 0
    narrow = ~converged & (given.margin < STEP)
    chosen = alike & ~narrow & (given.severity <= SEVERE)
    pair = ("c64", suite.part(double, chosen)), ("c32", suite.part(single, chosen))
    a = agree.compare(given.what, *pair, FLOOR, of.block, np.float32)
    off = np.maximum(_gap(double, single, "X"), _gap(double, single, "Y"))
    what = f"{given.what}: X and Y, single less double"
    yaw, residual = (float(_gap(double, single, name)[chosen].max(initial=0.0)) for name in ("yaw", "residual"))
    deviation = _relative(suite.part(double, chosen), suite.part(single, chosen))
    checks = [
        Check(f"{given.what}: yaw, single less double", yaw, SINGLE_YAW, "rad"),
        Check(f"{given.what}: residual, single less double", residual, SINGLE_RESIDUAL, "V"),
        Check(f"{given.what}: deviations, single less double", deviation, SINGLE_DEVIATION, "of itself"),
        Check(f"{given.what}: decisions otherwise in single", float(np.mean(~alike)), OTHERWISE, "1"),
        Check(f"{given.what}: not converged, costs apart by rounding in single", float(np.mean(narrow)), NARROW, "1"),
    ]
    for where, steps in (("converged", converged), ("not converged", ~converged)):
        worst = float(off[chosen & steps].max(initial=0.0))
        about = f"{np.count_nonzero(chosen & steps)} of {len(chosen)} steps, errors magnified up to {SEVERE:g} times"
        checks.append(Check(f"{what}, where {where}", worst, SINGLE, "m", about))
    return [a], checks


def _relative(first: Stepped, second: Stepped) -> float:
    """Return by how much of itself a standard deviation differs, at most."""
    return max(
        float((_gap(first, second, name) / np.abs(np.asarray(values, dtype=np.float64))).max(initial=0.0))
        for name, values in first.outputs.items()
        if name.startswith("deviation")
    )


def _gap(first: Stepped, second: Stepped, name: str) -> Numbers:
    return np.abs(np.asarray(second.outputs[name], dtype=np.float64) - first.outputs[name])


def own_ways(of: Subject, by: Witnesses, inputs: Columns) -> list[Check]:
    """Compare valid positions of the reference and of single precision, each on its own way, with those of the C."""
    double = positions(by.c64, inputs)
    ways = (
        ("reference", _reference(of, inputs), suite.EXACT, 0.0),
        ("c32", positions(by.c32, inputs), SINGLE, VALID_OTHERWISE),
    )
    checks = []
    for name, found, limit, share in ways:
        both = (found["valid"] > 0) & (double["valid"] > 0)
        worst = max(float(np.abs(found[y] - double[y])[both].max(initial=0.0)) for y in ("X", "Y"))
        unlike = float(np.mean(found["valid"] != double["valid"]))
        about = f"{np.count_nonzero(both)} of {both.size} samples from init are valid"
        what = f"{of.name}, each its own way: {name} against c64"
        checks.append(Check(f"{what}, where valid", worst, limit, "m", about))
        checks.append(Check(f"{what}, valid unlike", unlike, share, "1"))
    return checks


def positions(controller: host.Controller, inputs: Columns) -> dict[str, NDArray[np.float64]]:
    """Return X, Y in m and `valid` (samples, bodies) from `init` over columns of inputs."""
    return _stacked([batch.outputs for batch in ensemble.replayed(controller, inputs)])


def _reference(of: Subject, inputs: Columns) -> dict[str, NDArray[np.float64]]:
    bodies, found = next(iter(inputs.values())).shape[1], []
    now: Columns = {s.name: np.full(bodies, s.initial) for s in of.block.states}
    for k in range(LENGTH):
        now, outputs, _ = reference_guard.step(of.of, now, {n: v[k] for n, v in inputs.items()})
        found.append(outputs)
    return _stacked(found)


def _stacked(found: Sequence[Mapping[str, Numbers]]) -> dict[str, NDArray[np.float64]]:
    return {n: np.array([f[n] for f in found], dtype=np.float64) for n in ("X", "Y", "valid")}
