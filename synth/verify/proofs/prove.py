"""All proofs and tests of emitted C, at one of two depths.

    Eva            all states in bounds, all finite inputs: the contract holds, no operation is undefined
    nonfinite      a NaN or infinite input has the effect of a finite input out of range
    fuzzing        10,000,000 steps (whole) or 300,000 (subset) of machine code under sanitizers
    misra          the MISRA addon of cppcheck reports no finding
    latch          outputs slew to their safe values as declared, after random inputs

The first two are proofs over the whole declared domain at both depths.

Static analysis of emitted C with the MISRA addon of cppcheck: the number of findings.

The addon covers part of MISRA C:2012 and reports rules by number. The result is this count; it is not a claim of
compliance. A file that the addon did not read has no findings either. Each run therefore also checks a file with one
known violation, an octal constant (rule 7.1), which the addon must find.
"""

import subprocess
import tempfile
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from synth.check import Check
from synth.errors import CompileError
from synth.execute import host
from synth.verify.proofs import contract, eva, fuzz

_KNOWN_FILE = "synth_witness.c"
_KNOWN_TEXT = "int witness(int a);\nint witness(int a)\n{\n    return a + 010;\n}\n"
_KNOWN_RULE = "misra-c2012-7.1"
_OPTIONS = (
    "--addon=misra",
    "--std=c99",
    "--enable=style",
    "--quiet",
    "--template={id}\t{severity}\t{file}\t{line}\t{message}",
)


@dataclass(frozen=True)
class Finding:
    """A violation: the rule, as the addon names it, and its file and line."""

    rule: str
    file: str
    line: int


@dataclass(frozen=True)
class Report:
    """The analysed files and their findings."""

    files: tuple[str, ...]
    findings: tuple[Finding, ...]

    def checks(self) -> tuple[Check, ...]:
        """Return the report as a count that must be zero."""
        counts = Counter(finding.rule for finding in self.findings)
        places = {f.rule: f"{f.file}:{f.line}" for f in reversed(self.findings)}
        by_rule = [f"{rule} {count} times, first at {places[rule]}" for rule, count in sorted(counts.items())]
        about = "; ".join([f"cppcheck --addon=misra on {', '.join(self.files)}; no claim of compliance", *by_rule])
        return (Check("cppcheck's misra addon: findings", len(self.findings), 0, "findings", about),)


def inspect(files: Mapping[str, str]) -> Report:
    """Run the addon on emitted `{filename: text}`, sources and headers.

    Raises CompileError when cppcheck is missing, reports an error, or misses the known violation, and DesignError
    when there is no source.
    """
    cppcheck = contract.find_tool("cppcheck", "cppcheck")
    units = contract.units(files)
    with tempfile.TemporaryDirectory() as work:
        for name, text in {**files, _KNOWN_FILE: _KNOWN_TEXT}.items():
            (Path(work) / name).write_text(text, encoding="utf-8")
        done = subprocess.run([cppcheck, *_OPTIONS, *units, _KNOWN_FILE], cwd=work, capture_output=True, text=True)
    rows = [line.split("\t") for line in done.stderr.splitlines() if line.count("\t") == 4]
    errors = [row for row in rows if row[1] == "error"]
    if done.returncode != 0 or errors:
        raise CompileError(
            f"cppcheck: reports an error, need none: mend the C\n{done.stdout[-1000:]}{done.stderr[-1000:]}"
        )
    findings = tuple(Finding(row[0], row[2], int(row[3])) for row in rows if row[0].startswith("misra-"))
    if not any(f.rule == _KNOWN_RULE and f.file == _KNOWN_FILE for f in findings):
        raise CompileError(
            f"cppcheck: its misra addon did not find the known violation of {_KNOWN_RULE}, need it to: it needs "
            "python3 on the PATH and its addons, `apt-get install cppcheck python3`"
        )
    return Report(tuple(sorted(files)), tuple(f for f in findings if f.file != _KNOWN_FILE))


WHOLE_STEPS = 10_000_000
SUBSET_STEPS = 300_000


def prove(
    files: Mapping[str, str], manifest: Mapping[str, Any], whole: bool, progress: Callable[[str], None]
) -> tuple[Check, ...]:
    """Run every proof on the .c and .h files of emitted `{filename: text}`; other files are ignored.

    `whole` selects the greater depth; `progress` receives the name of each proof before it starts.

    Raises CompileError when a tool is missing or refuses the C, and DesignError when the manifest is incomplete.
    """
    code = {name: text for name, text in files.items() if name.endswith((".c", ".h"))}
    steps = WHOLE_STEPS if whole else SUBSET_STEPS
    progress("Eva: every state in its bounds, all finite inputs")
    checks = eva.prove(code, manifest).checks()
    progress("partial evaluation: inputs that are not finite")
    checks += contract.compare(code, manifest).checks()
    progress(f"fuzzing: {steps} steps")
    checks += fuzz.run(code, manifest, steps).checks()
    progress("cppcheck --addon=misra")
    checks += inspect(code).checks()
    progress("latch: slew to the safe output")
    return checks + contract.verify(host.load(code, manifest))
