"""Interface contract of emitted C, read from its manifest: type and bounds of every scalar struct member.

    init:  state_0 in S,        step:  S x (every bit pattern of input) -> S x Y x faults

S and Y are boxes with one interval per member. Each bound is representable in the type of the member, which makes its
C literal exact.

Test of the fault latch of compiled C: each output slews to its safe value within the declared slew rate.

    latched from sample L on:   |y_k - y_{k-1}| <= s T,      y_k = safe value for all k >= L + (high - low)/(s T)

Before the latch, random inputs over their full ranges drive the outputs away from their safe values. Then every input
becomes NaN.

Proof by partial evaluation that an infinite or NaN input has the effect of a finite input out of range.

One input k is constant, all other inputs and the whole state are free. The compiler specialises the step for this
constant, and the specialised functions must be identical as text:

    step(x, u; u_k = NaN) = step(x, u; u_k = +inf) = step(x, u; u_k = -inf) = step(x, u; u_k = the largest number).

Replacing one special input after the other shows that any combination of them has the effect of finite inputs, which
`eva` covers. Frama-C 25 cannot prove this itself: for a NaN it takes both branches of every comparison.
"""

import math
import re
import shutil
import subprocess
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np

from synth.block import LATCH_BIT
from synth.check import Check
from synth.errors import CompileError, DesignError
from synth.execute import host
from synth.verify import stimuli

SEED, RUNS, BEFORE = 31, 8, 50  # runs of random inputs, and samples of each before the loss of measurement
MAX_SLEW_SAMPLES = 100_000  # samples of a slew
ROUNDING = 16  # of a change of the output, in units in the last place of its range


def verify(controller: host.Controller) -> tuple[Check, ...]:
    """Return for each output with a safe value its fastest slew after the latch and its final distance from it."""
    safety = controller.manifest.get("safety")
    if not safety or not safety["safe_output"]:
        return ()
    period, rng = controller.period_s, np.random.default_rng(SEED)
    fields = {f["name"]: f for f in controller.manifest["structs"]["output"]["fields"]}
    span = {n: fields[n]["high"] - fields[n]["low"] for n in safety["safe_output"]}
    slews = [ceil(span[n] / (rate * period)) for n, rate in safety["slew_per_s"].items()]
    after = safety["bad_samples"] + min(max(slews), MAX_SLEW_SAMPLES) + 2
    fastest, remaining = dict.fromkeys(span, 0.0), dict.fromkeys(span, 0.0)
    for _ in range(RUNS):
        replay = controller.replay(stimuli.loss_of_measurement(controller, BEFORE, after, rng))
        latched = int(np.argmax(replay.faults >> LATCH_BIT & 1))
        for name, target in safety["safe_output"].items():
            y = np.asarray(replay.outputs[name], dtype=np.float64)
            moves = np.abs(np.diff(y[max(latched - 1, 0) :]))
            fastest[name] = max(fastest[name], float(moves.max()) / period)
            remaining[name] = max(remaining[name], abs(float(y[-1]) - float(controller.scalar(target))))
    eps = float(np.finfo(controller.scalar).eps)
    checks = []
    for name, rate in safety["slew_per_s"].items():
        unit, rounding = fields[name]["unit"], ROUNDING * eps * span[name]
        checks.append(Check(f"latched: {name} slews at", fastest[name], rate + rounding / period, f"{unit}/s"))
        checks.append(Check(f"latched: {name} ends from its safe value by", remaining[name], rounding, unit))
    return tuple(checks)


_TYPES = {"float": np.float32, "double": np.float64, "uint32_t": np.uint32, "int32_t": np.int32}


@dataclass(frozen=True)
class Member:
    """One scalar of a struct: `path` is the C expression after the struct name; low <= value <= high."""

    path: str
    ctype: str
    low: float
    high: float

    @property
    def is_real(self) -> bool:
        """Whether the member is a float or a double."""
        return self.ctype in ("float", "double")

    def literal(self, value: float) -> str:
        """Return a value of the member's type as a C literal with the same bits."""
        if not self.is_real:
            return f"{int(value)}u" if self.ctype == "uint32_t" else f"({int(value)})"
        return f"({float(value).hex()}{'f' if self.ctype == 'float' else ''})"

    def next_below(self) -> float:
        """Return the largest number of the real type below the low bound."""
        return self._next_number(self.low, -np.inf)

    def next_above(self) -> float:
        """Return the smallest number of the real type above the high bound."""
        return self._next_number(self.high, np.inf)

    def _next_number(self, value: float, towards: float) -> float:
        if self.ctype == "float":
            return float(np.nextafter(np.float32(value), np.float32(towards)))
        return float(np.nextafter(value, towards))


def members(manifest: Mapping[str, Any], role: str) -> tuple[Member, ...]:
    """Return every scalar of the struct `role` (input, output or state); an array gives one for each element.

    Raises DesignError when the manifest has no such struct, or a bound that is not finite, out of order or not
    representable in the type of the member.
    """
    try:
        return tuple(member for field in manifest["structs"][role]["fields"] for member in _elements(role, field))
    except (KeyError, TypeError) as error:
        raise DesignError(
            f"manifest, struct '{role}': {type(error).__name__} {error}; each field needs name, count, ctype, low and "
            "high: emit the C again"
        ) from error


def headers(files: Mapping[str, str]) -> tuple[str, ...]:
    """Return the names of the headers among emitted files; raise DesignError when there is none."""
    return _files_with_suffix(files, ".h")


def units(files: Mapping[str, str]) -> tuple[str, ...]:
    """Return the names of the C sources among emitted files; raise DesignError when there is none."""
    return _files_with_suffix(files, ".c")


def find_tool(command: str, package: str) -> str:
    """Return the path of a program.

    Raises CompileError, naming the Debian package that provides it, when it is not on the PATH.
    """
    if path := shutil.which(command):
        return path
    raise CompileError(f"{command}: not on the PATH, needed for the proofs: run `apt-get install {package}`")


def _elements(role: str, field: Mapping[str, Any]) -> list[Member]:
    name, count, ctype = field.get("path", field["name"]), field["count"], field["ctype"]
    if ctype not in _TYPES:
        raise DesignError(f"manifest, {role} '{name}': found the ctype {ctype!r}, need one of {', '.join(_TYPES)}")
    paths = [name] if count == 1 else [f"{name}[{k}]" for k in range(count)]
    lows, highs = (np.broadcast_to(np.asarray(field[end], dtype=np.float64), count) for end in ("low", "high"))
    elements = [Member(path, ctype, float(a), float(b)) for path, a, b in zip(paths, lows, highs, strict=True)]
    for member in elements:
        _require_bounds(role, member)
    return elements


def _require_bounds(role: str, member: Member) -> None:
    low, high = member.low, member.high
    # NaN and infinity never equal their conversion to an integer type; a value that overflows float32 is rejected.
    with np.errstate(invalid="ignore", over="ignore"):
        exact = all(math.isfinite(v) and float(np.float64(v).astype(_TYPES[member.ctype])) == v for v in (low, high))
    if not (exact and low <= high):
        raise DesignError(
            f"manifest, {role} '{member.path}': found the bounds {low!r} .. {high!r}, need two finite numbers of type "
            f"{member.ctype} in ascending order: round them when the C is emitted"
        )


def _files_with_suffix(files: Mapping[str, str], suffix: str) -> tuple[str, ...]:
    matching = tuple(sorted(name for name in files if name.endswith(suffix)))
    if not matching:
        raise DesignError(f"emitted C: found {sorted(files)}, need a file that ends in {suffix}: add it")
    return matching


_FLAGS = ("-std=c99", "-O1", "-ffp-contract=off", "-S", "-emit-llvm")
_FILE = "synth_nonfinite.c"
_VALUES = {
    "float": {
        "largest": "FLT_MAX",
        "nan": '__builtin_nanf("")',
        "negative_nan": '-__builtin_nanf("")',
        "plus_inf": "__builtin_inff()",
        "minus_inf": "-__builtin_inff()",
    },
    "double": {
        "largest": "DBL_MAX",
        "nan": '__builtin_nan("")',
        "negative_nan": '-__builtin_nan("")',
        "plus_inf": "__builtin_inf()",
        "minus_inf": "-__builtin_inf()",
    },
}
_WRAPPER = """
uint32_t input_{k}_{kind}({state} *state, const {input} *in, {output} *out)
{{
    {input} u = *in;
    u.{path} = {value};
    return {step}(state, &u, out);
}}
"""
_BODY = re.compile(r"^define [^\n]*@input_(\d+)_(\w+)\([^\n]*\n(.*?)^}", re.DOTALL | re.MULTILINE)

# A scope of aliasing, of a struct that an inlined function returns: each inlined copy has a number of its own.
_SCOPE = re.compile(r"(!noalias |!alias\.scope |noalias\.scope\.decl\(metadata )!(\d+)")


@dataclass(frozen=True)
class Equivalence:
    """Result: the inputs, the number of specialised steps, and those that differ from the largest finite number."""

    design: str
    inputs: tuple[str, ...]
    compared: int
    different: tuple[str, ...]

    def checks(self) -> tuple[Check, ...]:
        """Return the comparison as a count that must be zero."""
        about = f"{self.compared} steps specialised for NaN or infinity at one of {len(self.inputs)} inputs"
        summary = "; ".join([about, *self.different[:3]])
        name = "inputs not finite: steps that differ from the one for a finite input out of range"
        return (Check(name, len(self.different), 0, "steps", summary),)


def compare(files: Mapping[str, str], manifest: Mapping[str, Any]) -> Equivalence:
    """Compare the specialised steps of emitted `{filename: text}` for every real input of `manifest`.

    Raises CompileError when clang is missing or refuses the C, and DesignError when the manifest is incomplete.
    """
    inputs = [m for m in members(manifest, "input") if m.is_real]
    bodies = {(int(k), kind): _numbered(b) for k, kind, b in _BODY.findall(_specialise(files, manifest, inputs))}
    special = [(k, kind) for k, m in enumerate(inputs) for kind in _VALUES[m.ctype] if kind != "largest"]
    different = [f"{inputs[k].path} = {kind}" for k, kind in special if bodies[k, kind] != bodies[k, "largest"]]
    return Equivalence(manifest["design"], tuple(m.path for m in inputs), len(special), tuple(different))


def _numbered(body: str) -> str:
    """Return a function whose scopes of aliasing are numbered in the order in which they appear."""
    numbers: dict[str, int] = {}
    return _SCOPE.sub(lambda m: f"{m[1]}!{numbers.setdefault(m[2], len(numbers))}", body)


def _specialise(files: Mapping[str, str], manifest: Mapping[str, Any], inputs: list[Member]) -> str:
    """Return the wrappers as LLVM intermediate code, with the step inlined into each."""
    clang = find_tool("clang", "clang")
    with tempfile.TemporaryDirectory() as work:
        for name, text in {**files, _FILE: _wrappers(files, manifest, inputs)}.items():
            (Path(work) / name).write_text(text, encoding="utf-8")
        done = subprocess.run([clang, *_FLAGS, _FILE, "-o", "out.ll"], cwd=work, capture_output=True, text=True)
        if done.returncode != 0:
            raise CompileError(f"clang: refused the emitted C, need it to compile: mend it\n{done.stderr[-2000:]}")
        return (Path(work) / "out.ll").read_text(encoding="utf-8")


def _wrappers(files: Mapping[str, str], manifest: Mapping[str, Any], inputs: list[Member]) -> str:
    step = manifest["functions"]["step"]
    types = {role: struct["type"] for role, struct in manifest["structs"].items()}
    prototype = "uint32_t {step}({state} *state, const {input} *in, {output} *out) __attribute__((always_inline));"
    wrappers = [
        _WRAPPER.format(k=k, kind=kind, path=m.path, value=value, step=step, **types)
        for k, m in enumerate(inputs)
        for kind, value in _VALUES[m.ctype].items()
    ]
    return "\n".join(
        [
            "#include <float.h>",
            *(f'#include "{name}"' for name in headers(files)),
            prototype.format(step=step, **types),
            *(f'#include "{name}"' for name in units(files)),
            *wrappers,
        ]
    )
