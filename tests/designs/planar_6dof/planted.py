"""Defects planted in a controller or in its reference, and whether the witnesses of verification tell them."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from designs.planar_6dof import interface, random_steps, verification
from designs.planar_6dof.random_steps import Columns, Subject
from models import planar_stage
from synth.block import Block
from synth.emit import write
from synth.execute import host
from synth.verify import agree, suite
from synth.verify.suite import Evidence

PLANT = planar_stage.plant()
RANDOM_STEPS, EDGES = 30_000, 5000


@dataclass(frozen=True, eq=False)
class WitnessSteps:
    """A controller, steps drawn in operation and at the edges, and what its C answers to them."""

    subject: Subject
    states: Columns
    inputs: Columns
    emitted: write.EmittedCode
    c64: agree.StepResults


def witness_steps(subject: Subject, edges: int = EDGES) -> WitnessSteps:
    """Draw steps in operation and so many at the edges, and take them with the C in double precision."""
    drawn = random_steps.operating_steps(subject, PLANT, RANDOM_STEPS), random_steps.edge_steps(subject.block, edges)
    states, inputs = ({n: np.concatenate([a[n], b[n]]) for n in a} for a, b in zip(*drawn, strict=True))
    made = emitted(subject.block)
    return WitnessSteps(
        subject, states, inputs, made, agree.emitted_c(host.load(made.files, made.manifest))(states, inputs)
    )


def emitted(block: Block) -> write.EmittedCode:
    """Return the C in double precision."""
    return write.emit(block, np.float64, error=interface.SURROGATE_ERROR[np.float64])


def is_detected(at: WitnessSteps, witness: agree.Witness) -> bool:
    """Tell whether a witness fails one of the checks against the sound C."""
    pair = ("casadi", witness(at.states, at.inputs)), ("c64", at.c64)
    checks = suite.exact_checks([agree.compare("planted", *pair, verification.FLOOR, at.subject.block)], "1")
    return not all(c.passed for c in checks)


def constants(at: WitnessSteps, factor: float) -> Iterator[tuple[str, agree.Witness]]:
    """Yield CasADi's evaluation with one constant off by a factor, and its name; what is 0 is left alone."""
    block = at.subject.block
    for name in (c.name for c in block.constants if c.value):
        off = [replace(c, value=c.value * factor) if c.name == name else c for c in block.constants]
        yield name, agree.casadi(replace(block, constants=tuple(off)))


def thinned(at: WitnessSteps, every: int) -> WitnessSteps:
    """Return every so manieth of the steps."""
    states, inputs = ({n: v[::every] for n, v in columns.items()} for columns in (at.states, at.inputs))
    c64 = agree.emitted_c(host.load(at.emitted.files, at.emitted.manifest))(states, inputs)
    return WitnessSteps(at.subject, states, inputs, at.emitted, c64)


def mutants(at: WitnessSteps, count: int) -> Iterator[tuple[str, agree.Witness]]:
    """Yield C in which one sum became a difference or the reverse, evenly over the step, with the line changed.

    Left alone are what keeps a divisor away from 0, whose sign changes next to nothing, and the margin of the test that
    names one voltage alone, whose sign decides in none of the steps.
    """
    name = at.subject.block.name
    text = at.emitted.files[f"{name}.c"]
    start = text.index("typedef struct")  # behind the functions of one operation
    unused = r"/\*.*?\*/|if \(diagnostics != NULL\) \{.*?\}"  # comments, and what a null pointer leaves out
    spans = [m.span() for m in re.finditer(unused, text, re.S)]
    left_alone = r" [-+] (?![\d.]+e-|least_|nearly_zero_m)"
    places = [m.start() + 1 for m in re.finditer(left_alone, text) if m.start() > start]
    places = [p for p in places if not any(low <= p < high for low, high in spans)]
    for k in np.linspace(0, len(places) - 1, count).round().astype(int):
        at_place = places[k]
        other = text[:at_place] + ("-" if text[at_place] == "+" else "+") + text[at_place + 1 :]
        line = text[text.rindex("\n", 0, at_place) + 1 : text.index("\n", at_place)].strip()
        mutant = replace(at.emitted, files={**at.emitted.files, f"{name}.c": other})
        yield f"{line}, column {at_place}", agree.emitted_c(unoptimised(mutant))


def unoptimised(made: write.EmittedCode) -> host.Controller:
    """Load C that takes few steps: its results are those of the optimised, and it is compiled much sooner."""
    return host.load(made.files, made.manifest, ["-O0"])


def require_witnesses(evidence: Evidence, samples: Mapping[str, int]) -> None:
    """Assert that every witness has been compared in every kind of step, with so many samples of some of them."""
    pairs = {(a.what, a.first, a.second) for a in evidence.agreements}
    replays = [what for what, _, _ in pairs if what.startswith("replay")]
    kinds = {"random steps", "edge steps", *replays}
    assert pairs == {(k, n, "c64") for k in kinds for n in suite.WITNESS_NAMES} | {("random steps", "c64", "c32")}
    assert len(set(replays)) == 4
    by_case = {a.what: a.samples for a in evidence.agreements if a.first == "reference"}
    assert {what: by_case[what] for what in samples} == samples
    assert evidence.document()["passed"] is True
