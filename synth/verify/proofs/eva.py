"""Proof of the interface contract by abstract interpretation, with Frama-C's Eva.

The claim is: for every state in its declared box S and all finite inputs,

    step(S x R^m) raises no alarm,    outputs in Y,    next states in S,    and init gives a state in S.

By induction every reachable state then lies in S. An alarm is any operation whose result Eva cannot show to be defined
and finite: an overflow to infinity, a division by zero, the root of a negative number, an access out of bounds, a
member that was not written, a wrapping unsigned sum. Eva computes with intervals of float and double and rounds every
operation to nearest, which corresponds to C without contraction. `contract` covers infinite and NaN inputs.

Absence of alarms is not a proof, because an analysis that stops early raises none. The end of each harness must
therefore be reached, and the number of proved claims must equal the number that follows from the manifest.

Some claims remain open over the whole box but not over inputs in range. They are analysed again, once for each input,
with the range of that input split into good, too low and too high. The split preserves the relation between an input
and the verdict of its guard, wherever the C uses the two. Each of these analyses covers the whole box, and excludes a
failure unless one of its earlier alarms occurs. The first failure of an execution must therefore be raised by every
analysis, and only claims that all analyses leave open are open.

Parser of Frama-C's report of an Eva analysis: proved claims, alarms, unproved claims, trusted contracts.
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
from synth.verify.proofs import contract
from synth.verify.proofs.contract import Member

HARNESS = "synth_eva.c"


@dataclass(frozen=True)
class Analysis:
    """Properties as text; a property has the same text in every analysis of a harness."""

    proved: frozenset[str]
    alarms: frozenset[str]
    unproved: frozenset[str]
    trusted: frozenset[str]

    @property
    def open(self) -> frozenset[str]:
        """The alarms and the claims that are not proved."""
        return self.alarms | self.unproved


def read(rows: Sequence[Mapping[str, str]], log: str) -> Analysis:
    """Sort the properties of Frama-C into proved claims, alarms and unproved claims."""
    admitted = [row for row in rows if row["property kind"] == "user hypothesis"]
    source_rows = [row for row in rows if not row["directory"].startswith("FRAMAC_SHARE") and row not in admitted]
    ends = [row for row in source_rows if row["property"] == "\\false" and row["file"] == HARNESS]
    claims = [row for row in source_rows if row["property kind"] == "user check" and row not in ends]
    others = [
        row for row in source_rows if row not in claims and row not in ends and row["status"] not in ("Valid", "Dead")
    ]
    alarms = [row for row in others if not row["property kind"].startswith("precondition")]
    unproved = [row for row in claims if row["status"] != "Valid"] + [row for row in others if row not in alarms]
    # Eva must refute the false claim at the end: if the end were unreachable, every claim there would hold.
    reached = [row["status"] for row in ends] == ["Invalid or unreachable"]
    return Analysis(
        proved=frozenset(property_text(row) for row in claims if row["status"] == "Valid"),
        alarms=frozenset(map(property_text, alarms)),
        unproved=frozenset(map(property_text, unproved)) | (frozenset() if reached else {"the end is never reached"}),
        trusted=_trusted_functions(log),
    )


def _trusted_functions(log: str) -> frozenset[str]:
    marker = "using specification for function "
    functions = [line.split(marker)[1].strip() for line in log.splitlines() if marker in line]
    return frozenset(name for name in functions if not name.startswith("Frama_C_"))


def property_text(row: Mapping[str, str]) -> str:
    """Return a property of the report as text."""
    return f"{row['file']}:{row['line']}: {row['property kind']}: {row['property']}"


TIME_LIMIT_S = 1800  # against an analysis that does not terminate; minutes are usual
_PROCESSES = 2
_REPORT = "properties.csv"
_ADMIT, _CHECK = "@ admit ", "@ check "
# The last two branches are distinguished, which keeps the outcome of a comparison where its result is used. Equalities
# relate |v| to v. A polynomial in one variable is bounded on 200 parts of its range. Short loops are unrolled.
_OPTIONS = (
    "-c11",
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
# Frama-C has only contracts for these, which Eva cannot invert; the bodies are exact on finite arguments.
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
    """Result of Eva for init and one step: `proved` of `claims` claims, the alarms, and the unproved claims.

    `trusted` names library functions whose contracts were assumed. `admitted` counts the bounds in the C that Eva
    assumed from the certificates of the emitter; for outputs and states fuzzing checks them.
    """

    design: str
    proved: int
    claims: int
    alarms: tuple[str, ...]
    unproved: tuple[str, ...]
    trusted: tuple[str, ...]
    admitted: int = 0

    def checks(self) -> tuple[Check, ...]:
        """Return the proof as counts that must all be zero."""
        scope = f"every state in its bounds, all finite inputs; {self.proved} of {self.claims} claims proved"
        trust = f"; contracts trusted: {', '.join(self.trusted)}" if self.trusted else ""
        trust += f"; {self.admitted} bounds taken over from certificates" if self.admitted else ""
        open_claims = max(len(self.unproved), self.claims - self.proved)
        return (
            Check("Eva: alarms in one step", len(self.alarms), 0, "alarms", _summary(scope + trust, self.alarms)),
            Check("Eva: claims not proved", open_claims, 0, "claims", _summary(scope, self.unproved)),
        )


def prove(files: Mapping[str, str], manifest: Mapping[str, Any]) -> Proof:
    """Prove the contract of `manifest` for emitted `{filename: text}`.

    Raises CompileError when Frama-C is missing, refuses the C or takes longer than TIME_LIMIT_S for one analysis, and
    DesignError when the manifest or the files are incomplete.
    """
    outputs, states = contract.members(manifest, "output"), contract.members(manifest, "state")
    admitted = sum(files[name].count(_ADMIT) for name in contract.units(files))
    refuted = _refuted_admissions(files, _step_harness(files, manifest, _draw_finite)) if admitted else frozenset()
    others = [_init_harness(files, manifest), *_tune_harnesses(files, manifest)]
    step, *analyses = _analyses(files, [_step_harness(files, manifest, _draw_finite), *others])
    step = _analyse_split_inputs(files, manifest, step)
    return Proof(
        design=manifest["design"],
        proved=len(step.proved) + sum(len(a.proved) for a in analyses),
        claims=len(_claims("output", outputs)) + (1 + len(others)) * len(_claims("state", states)),
        alarms=tuple(alarm for a in (*analyses, step) for alarm in sorted(a.alarms)),
        unproved=(*sorted(refuted), *(claim for a in (*analyses, step) for claim in sorted(a.unproved))),
        trusted=tuple(sorted(step.trusted.union(*(a.trusted for a in analyses)))),
        admitted=admitted,
    )


def _analyse_split_inputs(files: Mapping[str, str], manifest: Mapping[str, Any], step: Analysis) -> Analysis:
    """Repeat the analysis with each input split in turn, unless inputs in range already leave the same claims open."""
    if not step.open:
        return step
    (good,) = _analyses(files, [_step_harness(files, manifest, _draw_in_range)])
    if step.open <= good.open:
        return step
    inputs = [m for m in contract.members(manifest, "input") if m.is_real]
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


def _tune_harnesses(files: Mapping[str, str], manifest: Mapping[str, Any]) -> list[str]:
    """Return the harness of the function that changes constants between steps, where there is one."""
    if "tuning" not in manifest:
        return []
    states = contract.members(manifest, "state")
    body = [
        *(_draw("state", m, m.literal(m.low), m.literal(m.high)) for m in states),
        *(_draw("parameters", m, *_all_finite(m)) for m in contract.members(manifest, "parameters")),
        "unsigned int left = Frama_C_unsigned_int_interval(0u, 0xffffffffu);",
        f"{manifest['tuning']['functions']['tune']}(&state, &parameters, left);",
        *_claims("state", states),
    ]
    return [_harness(files, manifest, body)]


def _harness(files: Mapping[str, str], manifest: Mapping[str, Any], body: Sequence[str]) -> str:
    includes = [f'#include "{name}"' for name in contract.headers(files)]
    # Locals start uninitialised: reading a member that was not written, or is missing in the manifest, is an alarm.
    structs = [f"{manifest['structs'][role]['type']} {role};" for role in manifest["structs"]]
    lines = [*includes, "#include <float.h>", '#include "__fc_builtin.h"', _BODIES, "void drive(void) {"]
    return "\n".join([*lines, *structs, "int part = Frama_C_interval(0, 2);", *body, "//@ check \\false;", "}", ""])


def _draw(struct: str, member: Member, low: str, high: str) -> str:
    return f"{struct}.{member.path} = {_DRAW[member.ctype]}({low}, {high});"


def _draw_finite(member: Member) -> str:
    return _draw("input", member, *_all_finite(member))


def _draw_in_range(member: Member) -> str:
    return _draw("input", member, member.literal(member.low), member.literal(member.high))


def _draw_split(chosen: Member, member: Member) -> str:
    """Draw the chosen input from three separate parts; one line keeps the line numbers of all harnesses equal."""
    if member != chosen:
        return _draw_finite(member)
    least, most = _all_finite(member)
    low = _draw("input", member, least, member.literal(member.next_below()))
    high = _draw("input", member, member.literal(member.next_above()), most)
    good = _draw_in_range(member)
    return f"/*@ split part; */ if (part == 0) {{ {good} }} else if (part == 1) {{ {low} }} else {{ {high} }}"


def _all_finite(member: Member) -> tuple[str, str]:
    if member.is_real:
        return f"-{_LARGEST[member.ctype]}", _LARGEST[member.ctype]
    return ("0u", "0xffffffffu") if member.ctype == "uint32_t" else ("(-0x7fffffff - 1)", "0x7fffffff")


def _claims(struct: str, members: Sequence[Member]) -> list[str]:
    """Return one claim per line; a `check` does not constrain the state, so no claim supports the next."""
    lines = []
    for m in members:
        value, (low, high) = f"{struct}.{m.path}", (_exact_literal(m, v) for v in (m.low, m.high))
        lines += [f"//@ check \\is_finite({value});"] if m.is_real else []
        lines += [f"//@ check {low} <= {value};", f"//@ check {value} <= {high};"]
    return lines


def _exact_literal(member: Member, value: float) -> str:
    # In a claim a literal is a real number; with a suffix it would be rounded as a decimal.
    return float(value).hex() if member.is_real else str(int(value))


def _analyses(files: Mapping[str, str], harnesses: Sequence[str]) -> list[Analysis]:
    with ThreadPoolExecutor(_PROCESSES) as pool:
        return list(pool.map(lambda harness: read(*_run_frama_c(files, harness)), harnesses))


def _run_frama_c(files: Mapping[str, str], harness: str) -> tuple[list[dict[str, str]], str]:
    """Run Frama-C; return its properties and its output."""
    frama_c = contract.find_tool("frama-c", "frama-c-base")
    with tempfile.TemporaryDirectory() as work:
        folder = Path(work)
        for name, text in {**files, HARNESS: harness}.items():
            (folder / name).write_text(text, encoding="utf-8")
        command = [frama_c, *_OPTIONS, *contract.units(files), HARNESS, "-then", f"-report-csv={_REPORT}"]
        log = _run(command, folder)
        with (folder / _REPORT).open(encoding="utf-8", newline="") as report:
            return list(csv.DictReader(report, delimiter="\t", quoting=csv.QUOTE_NONE)), log


def _refuted_admissions(files: Mapping[str, str], harness: str) -> frozenset[str]:
    """Return the admitted bounds that Eva refutes when it has to check them.

    The code after a bound that never holds would not be analysed at all.
    """
    checked_files = {name: text.replace(_ADMIT, _CHECK) for name, text in files.items()}
    rows, _ = _run_frama_c(checked_files, harness)
    source_rows = [row for row in rows if row["property kind"] == "user check" and row["file"] != HARNESS]
    return frozenset(property_text(row) for row in source_rows if row["status"] not in ("Valid", "Unknown"))


def _run(command: Sequence[str], folder: Path) -> str:
    # Frama-C reads the working folder from the environment.
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
