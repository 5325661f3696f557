"""Proof by partial evaluation that an infinite or NaN input has the effect of a finite input out of range.

One input k is constant, all other inputs and the whole state are free. The compiler specialises the step for this
constant, and the specialised functions must be identical as text:

    step(x, u; u_k = NaN) = step(x, u; u_k = +inf) = step(x, u; u_k = -inf) = step(x, u; u_k = the largest number).

Replacing one special input after the other shows that any combination of them has the effect of finite inputs, which
`eva` covers. Frama-C 25 cannot prove this itself: for a NaN it takes both branches of every comparison.
"""

import re
import subprocess
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from synth.check import Check
from synth.errors import CompileError
from synth.verify.proofs import contract
from synth.verify.proofs.contract import Member

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
    inputs = [m for m in contract.members(manifest, "input") if m.is_real]
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
    clang = contract.find_tool("clang", "clang")
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
            *(f'#include "{name}"' for name in contract.headers(files)),
            prototype.format(step=step, **types),
            *(f'#include "{name}"' for name in contract.units(files)),
            *wrappers,
        ]
    )
