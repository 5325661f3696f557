"""Prove by abstract interpretation (Frama-C's Eva) that one step stays inside its contract.

For every state in its declared box S and all finite inputs,

    step(S x R^m) raises no alarm,    outputs in Y,    next states in S,    and init gives a state in S,

so that by induction every reachable state lies in S. An alarm is any operation whose result Eva cannot show to be
defined and finite: an overflow to infinity, a division by zero, the root of a negative number, an access out of bounds,
a member that was not written, a wrapping unsigned sum. Eva computes with intervals of float and double and with every
operation rounded to nearest, as without contraction. Infinite and NaN inputs are the matter of `nonfinite`.

"No alarm" alone is no proof: an analysis that stops early raises none. So the end of each harness must be seen to be
reached, and the number of proved claims must be the number that the manifest asks for.

What one analysis of the whole box leaves open, and one of good inputs alone does not, is tried again, once for each
input, with that input's range split into good, too low and too high: that keeps a guard's verdict tied to its input
however far apart the C uses them. Each analysis covers the whole box, and excludes a failure unless an earlier one of
its own alarms comes true; so no failure can be the first of an execution unless every analysis raises it, and only
what all leave open is open.
"""

import csv
import os
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial, reduce
from pathlib import Path
from typing import Any

from synth.check import Check
from synth.errors import CompileError
from synth.verify import contract, eva_report
from synth.verify.contract import Member
from synth.verify.eva_report import HARNESS, Analysis

TIME_LIMIT_S = 1800  # a guard against an analysis without an end, no verdict on speed: minutes are usual
_PROCESSES = 2
_REPORT = "properties.csv"
_ADMIT, _CHECK = "@ admit ", "@ check "
# Two branchings are remembered, so that what a comparison found still holds where its result is used; equalities carry
# it from |v| to v; a polynomial in one variable is bounded on that many parts of its range; short loops are unrolled.
_OPTIONS = (
    "-eva",
    "-main=drive",
    "-warn-special-float=non-finite",
    "-warn-unsigned-overflow",
    "-warn-decimal-float=none",
    "-eva-domains=equality",
    "-eva-partition-history=2",
    "-eva-interprocedural-history",
    "-eva-interprocedural-splits",
    "-eva-no-remove-redundant-alarms",
    "-eva-subdivide-non-linear=200",
    "-eva-auto-loop-unroll=100",
    "-eva-msg-key=-final-states,-initial-state",
)
# Frama-C knows these by contracts that Eva cannot invert; so they get bodies, exact on finite arguments.
_BODIES = """
float fabsf(float x) { return (x < 0.0f) ? -x : x; }
double fabs(double x) { return (x < 0.0) ? -x : x; }
"""
_DRAW = {
    "float": "Frama_C_float_interval",
    "double": "Frama_C_double_interval",
    "uint32_t": "Frama_C_unsigned_int_interval",
    "int32_t": "Frama_C_interval",
}
_LARGEST = {"float": "FLT_MAX", "double": "DBL_MAX"}


@dataclass(frozen=True)
class Proof:
    """What Eva said of init and one step: `proved` of `expected` claims, the alarms, and what it could not show.

    `trusted` names the library functions that were taken at their contract's word. `admitted` counts the bounds that
    Eva took over from certificates of the C's author; of outputs and states fuzzing checks them.
    """

    design: str
    proved: int
    expected: int
    alarms: tuple[str, ...]
    unproved: tuple[str, ...]
    trusted: tuple[str, ...]
    admitted: int = 0

    def checks(self) -> tuple[Check, ...]:
        """Return the proof as figures that must all be zero."""
        scope = f"every state in its bounds, all finite inputs; {self.proved} of {self.expected} claims proved"
        trust = f"; contracts trusted: {', '.join(self.trusted)}" if self.trusted else ""
        trust += f"; {self.admitted} bounds taken over from certificates" if self.admitted else ""
        open_claims = max(len(self.unproved), self.expected - self.proved)
        return (
            Check("Eva: alarms in one step", len(self.alarms), 0, "alarms", _summary(scope + trust, self.alarms)),
            Check("Eva: claims not proved", open_claims, 0, "claims", _summary(scope, self.unproved)),
        )


def prove(files: Mapping[str, str], manifest: Mapping[str, Any]) -> Proof:
    """Prove the contract of `manifest` for emitted `{filename: text}`.

    Raises CompileError when Frama-C is missing, refuses the C or takes longer than TIME_LIMIT_S for one analysis, and
    DesignError when the manifest or the files are not whole.
    """
    outputs, states = contract.members(manifest, "output"), contract.members(manifest, "state")
    admitted = sum(files[name].count(_ADMIT) for name in contract.units(files))
    refuted = _refuted_admissions(files, _step_harness(files, manifest, _draw_finite)) if admitted else frozenset()
    step, init = _analyses(files, (_step_harness(files, manifest, _draw_finite), _init_harness(files, manifest)))
    step = _analyse_split_inputs(files, manifest, step)
    return Proof(
        design=manifest["design"],
        proved=len(step.proved) + len(init.proved),
        expected=len(_claims("output", outputs)) + 2 * len(_claims("state", states)),
        alarms=(*sorted(init.alarms), *sorted(step.alarms)),
        unproved=(*sorted(refuted), *sorted(init.unproved), *sorted(step.unproved)),
        trusted=tuple(sorted(init.trusted | step.trusted)),
        admitted=admitted,
    )


def _analyse_split_inputs(files: Mapping[str, str], manifest: Mapping[str, Any], step: Analysis) -> Analysis:
    """Analyse again with one input split, for each input, unless what is open stays so when every input is good."""
    if not step.open:
        return step
    (good,) = _analyses(files, [_step_harness(files, manifest, _draw_in_range)])
    if step.open <= good.open:
        return step
    inputs = [m for m in contract.members(manifest, "input") if m.real]
    harnesses = [_step_harness(files, manifest, partial(_draw_split, m)) for m in inputs]
    return reduce(_combine, _analyses(files, harnesses), step)


def _combine(a: Analysis, b: Analysis) -> Analysis:
    return Analysis(a.proved | b.proved, a.alarms & b.alarms, a.unproved & b.unproved, a.trusted | b.trusted)


def _step_harness(files: Mapping[str, str], manifest: Mapping[str, Any], draw: Callable[[Member], str]) -> str:
    inputs, outputs, states = (contract.members(manifest, role) for role in ("input", "output", "state"))
    body = [
        *(_draw("state", m, m.literal(m.low), m.literal(m.high)) for m in states),
        *map(draw, inputs),
        f"{manifest['functions']['step']}(&state, &input, &output);",
        *_claims("output", outputs),
        *_claims("state", states),
    ]
    return _harness(files, manifest, body)


def _init_harness(files: Mapping[str, str], manifest: Mapping[str, Any]) -> str:
    body = [f"{manifest['functions']['init']}(&state);", *_claims("state", contract.members(manifest, "state"))]
    return _harness(files, manifest, body)


def _harness(files: Mapping[str, str], manifest: Mapping[str, Any], body: Sequence[str]) -> str:
    includes = [f'#include "{name}"' for name in contract.headers(files)]
    # Locals start uninitialised: a member that is read before it is written, or that the manifest hides, is an alarm.
    structs = [f"{manifest['structs'][role]['type']} {role};" for role in ("state", "input", "output")]
    lines = [*includes, "#include <float.h>", '#include "__fc_builtin.h"', _BODIES, "void drive(void) {"]
    return "\n".join([*lines, *structs, "int part = Frama_C_interval(0, 2);", *body, "//@ check \\false;", "}", ""])


def _draw(struct: str, member: Member, low: str, high: str) -> str:
    return f"{struct}.{member.path} = {_DRAW[member.ctype]}({low}, {high});"


def _draw_finite(member: Member) -> str:
    return _draw("input", member, *_all_finite(member))


def _draw_in_range(member: Member) -> str:
    return _draw("input", member, member.literal(member.low), member.literal(member.high))


def _draw_split(chosen: Member, member: Member) -> str:
    """Draw the chosen input in three parts that stay apart; on one line, so that all harnesses share their lines."""
    if member != chosen:
        return _draw_finite(member)
    least, most = _all_finite(member)
    low = _draw("input", member, least, member.literal(member.below()))
    high = _draw("input", member, member.literal(member.above()), most)
    return f"/*@ split part; */ if (part == 0) {{ {_draw_in_range(member)} }} else if (part == 1) {{ {low} }} else {{ {high} }}"


def _all_finite(member: Member) -> tuple[str, str]:
    if member.real:
        return f"-{_LARGEST[member.ctype]}", _LARGEST[member.ctype]
    return ("0u", "0xffffffffu") if member.ctype == "uint32_t" else ("(-0x7fffffff - 1)", "0x7fffffff")


def _claims(struct: str, members: Sequence[Member]) -> list[str]:
    """One claim a line: a `check` leaves the state as it is, so that no claim helps the next."""
    lines = []
    for m in members:
        value, (low, high) = f"{struct}.{m.path}", (_exact_literal(m, v) for v in (m.low, m.high))
        lines += [f"//@ check \\is_finite({value});"] if m.real else []
        lines += [f"//@ check {low} <= {value};", f"//@ check {value} <= {high};"]
    return lines


def _exact_literal(member: Member, value: float) -> str:
    # In a claim a literal is a real number; a suffix would have it read as a decimal and rounded.
    return float(value).hex() if member.real else str(int(value))


def _analyses(files: Mapping[str, str], harnesses: Sequence[str]) -> list[Analysis]:
    with ThreadPoolExecutor(_PROCESSES) as pool:
        return list(pool.map(lambda harness: eva_report.read(*_run_frama_c(files, harness)), harnesses))


def _run_frama_c(files: Mapping[str, str], harness: str) -> tuple[list[dict[str, str]], str]:
    """Return Frama-C's properties and what it said."""
    frama_c = contract.find_tool("frama-c", "frama-c-base")
    with tempfile.TemporaryDirectory() as work:
        folder = Path(work)
        for name, text in {**files, HARNESS: harness}.items():
            (folder / name).write_text(text, encoding="utf-8")
        command = [frama_c, *_OPTIONS, *contract.units(files), HARNESS, "-then", f"-report-csv={_REPORT}"]
        said = _run(command, folder)
        with (folder / _REPORT).open(encoding="utf-8", newline="") as report:
            return list(csv.DictReader(report, delimiter="\t", quoting=csv.QUOTE_NONE)), said


def _refuted_admissions(files: Mapping[str, str], harness: str) -> frozenset[str]:
    """Return what is admitted although Eva, which may take it for granted no more, sees that it never holds.

    Behind such a bound nothing would be analysed any more.
    """
    checked_files = {name: text.replace(_ADMIT, _CHECK) for name, text in files.items()}
    rows, _ = _run_frama_c(checked_files, harness)
    source_rows = [row for row in rows if row["property kind"] == "user check" and row["file"] != HARNESS]
    return frozenset(eva_report.property_text(row) for row in source_rows if row["status"] not in ("Valid", "Unknown"))


def _run(command: Sequence[str], folder: Path) -> str:
    # Frama-C takes the working folder from the environment.
    environment = {**os.environ, "PWD": str(folder)}
    try:
        done = subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, text=True, timeout=TIME_LIMIT_S
        )
    except subprocess.TimeoutExpired as error:
        raise CompileError(
            f"Frama-C: no result within {TIME_LIMIT_S} s, need one: simplify the C, or split the design"
        ) from error
    if done.returncode != 0 or not (folder / _REPORT).exists():
        raise CompileError(
            f"Frama-C: stopped with status {done.returncode}, need 0: mend the lines it names\n{done.stdout[-2000:]}"
            f"{done.stderr[-2000:]}"
        )
    return done.stdout


def _summary(scope: str, details: Sequence[str], shown: int = 3) -> str:
    more = [f"and {len(details) - shown} more"] if len(details) > shown else []
    return "; ".join([scope, *details[:shown], *more])
