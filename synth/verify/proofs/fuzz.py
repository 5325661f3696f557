"""Fuzz test of the interface contract with libFuzzer, AddressSanitizer and UndefinedBehaviorSanitizer.

The fuzzer turns arbitrary bytes into runs of 16 steps, from `init` or from a state limited to its declared bounds S,
with inputs of every bit pattern: raw bits, values in range, bounds and the next numbers outside. After each step

    outputs in Y, all finite;  states in S;  fault bit k is 1 where input k is not finite or out of range, else 0;
    the latch is never reset, and from init it is set only after the declared number of consecutive samples with a
    bad input, or with an input that the step marks as a suspect; where the manifest declares good samples that make up
    for a bad one, after as many bad ones more than these make up for.

Where the manifest declares a judgement (`fault.Judgement`), a flag of the law may set the latch later, in a sample
without a bad input. Required is then: from init no latch before the declared number of consecutive samples with a bad
*measurement* or a suspect. Bad set-points do not count.

Bits of suspects and bits with a meaning of their own follow from states: the step decides them, where the manifest
declares them. Every other bit must be 0.

A campaign finds defects but proves nothing. It runs machine code, while `eva` analyses the C.
"""

import re
import shutil
import subprocess
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from synth.check import Check
from synth.errors import CompileError, DesignError
from synth.verify.proofs import contract
from synth.verify.proofs.contract import Member

STEPS_A_RUN = 16
_SEED = 20201
_SEEDS, _LENGTH = 32, 2048
_TABLES = "synth_fuzz_tables.h"
_DRIVER = "synth_fuzz.c"
_FLAGS = (
    "-std=c99",
    "-O1",
    "-g",
    "-ffp-contract=off",
    "-fsanitize=fuzzer,address,undefined,float-cast-overflow,float-divide-by-zero",
    "-fno-sanitize-recover=all",
)
_SCALARS = {"float": "FLOAT", "double": "DOUBLE", "uint32_t": "UINT32", "int32_t": "INT32"}
_FINDINGS = re.compile(r"^(?:FINDING: .*|.*runtime error: .*|.*ERROR: \w+: .*)$", re.MULTILINE)


@dataclass(frozen=True)
class Campaign:
    """Result of a fuzzing campaign: steps, runs, size of the corpus, and the first finding, empty for none.

    `requested` is the number of steps asked for, `covered` counts covered edges of the program, `features` those of
    libFuzzer.
    """

    design: str
    requested: int
    steps: int
    runs: int
    covered: int
    features: int
    corpus: int
    finding: str

    def checks(self) -> tuple[Check, ...]:
        """Return the campaign as counts that must be zero."""
        about = (
            f"{self.steps} steps in {self.runs} runs, {self.covered} edges and {self.features} features reached, "
            f"{self.corpus} inputs kept"
        )
        details = "; ".join(filter(None, (about, self.finding)))
        return (
            Check("fuzzing: findings", int(bool(self.finding)), 0, "findings", details),
            Check("fuzzing: steps missing", max(0, self.requested - self.steps), 0, "steps", about),
        )


def run(files: Mapping[str, str], manifest: Mapping[str, Any], steps: int) -> Campaign:
    """Run at least `steps` steps of emitted `{filename: text}`, or until the first finding; the seed is fixed.

    Raises CompileError when clang or its libFuzzer is missing, or refuses the C, and DesignError when the manifest is
    incomplete.
    """
    runs = -(-steps // STEPS_A_RUN)
    with tempfile.TemporaryDirectory() as work:
        folder = Path(work)
        program = _build(files, _tables(files, manifest), folder)
        seeds = _seeds(folder)
        options = (f"-runs={runs}", f"-seed={_SEED}", f"-max_len={_LENGTH}", "-len_control=0", "-detect_leaks=0")
        command = [
            *_fixed_address_command(),
            str(program),
            *options,
            "-print_final_stats=1",
            f"-artifact_prefix={folder}/",
            f"-seed_inputs={seeds}",
        ]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace")
    return _parse_log(manifest["design"], steps, done.returncode, done.stderr)


def _build(files: Mapping[str, str], tables: str, folder: Path) -> Path:
    clang = contract.find_tool("clang", "clang libclang-rt-14-dev")
    driver = resources.files(__package__).joinpath("fuzz.c").read_text(encoding="utf-8")
    for name, text in {**files, _TABLES: tables, _DRIVER: driver}.items():
        (folder / name).write_text(text, encoding="utf-8")
    command = [clang, *_FLAGS, *contract.units(files), _DRIVER, "-o", "fuzz", "-lm"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        raise CompileError(
            "clang: did not build the fuzzer, which needs the C to compile and libFuzzer: mend the C, or run "
            f"`apt-get install libclang-rt-14-dev`\n{done.stderr[-2000:]}"
        )
    return folder / "fuzz"


def _fixed_address_command() -> tuple[str, ...]:
    """Return the command that fixes memory addresses, if permitted: the choices of the fuzzer depend on addresses."""
    fixed = ("setarch", "-R")
    may = shutil.which("setarch") and subprocess.run([*fixed, "true"], capture_output=True).returncode == 0
    return fixed if may else ()


def _seeds(folder: Path) -> str:
    """Write long random inputs as the initial corpus and return their names; libFuzzer alone grows long runs slowly."""
    draw = np.random.default_rng(_SEED)
    names = [f"seed{k:02}" for k in range(_SEEDS)]
    for name in names:
        (folder / name).write_bytes(draw.bytes(_LENGTH))
    return ",".join(names)


def _parse_log(design: str, requested: int, status: int, log: str) -> Campaign:
    finding = findings[0] if (findings := _FINDINGS.findall(log)) else ""
    if status != 0 and not finding:
        finding = f"the fuzzer ended with status {status}: {log[-300:]}"
    return Campaign(
        design=design,
        requested=requested,
        steps=_last_count(r"^steps: (\d+)", log),
        runs=_last_count(r"^stat::number_of_executed_units: +(\d+)", log),
        covered=_last_count(r" cov: (\d+)", log),
        features=_last_count(r" ft: (\d+)", log),
        corpus=_last_count(r" corp: (\d+)", log),
        finding=finding.strip(),
    )


def _last_count(pattern: str, log: str) -> int:
    matches = re.findall(pattern, log, re.MULTILINE)
    return int(matches[-1]) if matches else 0


def _tables(files: Mapping[str, str], manifest: Mapping[str, Any]) -> str:
    structs, functions = manifest["structs"], manifest["functions"]
    inputs = contract.members(manifest, "input")
    latch, suspects, others = (_bits(manifest, key) for key in ("latched", "suspect", "about"))
    safety = manifest.get("safety") or {}
    judgement = safety.get("judgement")
    counted = (
        {f["input"] for f in manifest["faults"] if f.get("input")} if judgement is None else judgement["measurements"]
    )
    return "\n".join(
        [
            *(f'#include "{name}"' for name in contract.headers(files)),
            *(f"typedef {structs[role]['type']} {role}_t;" for role in structs),
            *(
                _table(f"{role.upper().rstrip('S')}S", structs[role]["type"], contract.members(manifest, role))
                for role in structs
            ),
            f"static const fault_t FAULTS[] = {{{', '.join(_faults(manifest, inputs))}}};",
            f"#define SUSPECTS {suspects:#x}u",
            f"#define DECIDED {suspects | others:#x}u",
            f"#define LATCH {latch:#x}u",
            f"#define BAD_SAMPLES {safety.get('bad_samples', 0)}u",
            f"#define GOOD_SAMPLES {safety.get('good_samples', 0)}u",
            f"#define COUNTED {sum(1 << f['bit'] for f in manifest['faults'] if f.get('input') in counted):#x}u",
            f"#define LATCHES_LATER {int(judgement is not None)}",
            f"#define INIT {functions['init']}",
            f"#define STEP {functions['step']}",
            *(f"#define {name.upper()} {of}" for name, of in manifest.get("tuning", {}).get("functions", {}).items()),
            "",
        ]
    )


def _table(name: str, struct: str, members: tuple[Member, ...]) -> str:
    rows = "".join(
        f'    {{"{m.path}", offsetof({struct}, {m.path}), {_SCALARS[m.ctype]}, {m.low.hex()}, {m.high.hex()}}},\n'
        for m in members
    )
    return f"static const member_t {name}[] = {{\n{rows}}};"


def _bits(manifest: Mapping[str, Any], key: str) -> int:
    """Return the mask of the fault bits with this key; the bit of an input follows from the input alone."""
    return sum(1 << f["bit"] for f in manifest["faults"] if f.get(key) and "input" not in f)


def _faults(manifest: Mapping[str, Any], inputs: tuple[Member, ...]) -> list[str]:
    """Return the fault table: bit, first member and number of members of each input that has a fault bit."""
    rows = []
    for fault in manifest["faults"]:
        if (name := fault.get("input")) is not None:
            places = [k for k, m in enumerate(inputs) if m.path.split("[")[0] == name]
            if not places:
                raise DesignError(f"manifest, fault bit {fault['bit']}: there is no input '{name}': emit the C again")
            rows.append(f"{{{1 << fault['bit']:#x}u, {places[0]}u, {len(places)}u}}")
    return rows or ["{0u, 0u, 0u}"]
