"""All proofs and tests of emitted C, at one of two depths.

    Eva            all states in bounds, all finite inputs: the contract holds, no operation is undefined
    nonfinite      a NaN or infinite input has the effect of a finite input out of range
    fuzzing        10,000,000 steps (whole) or 300,000 (subset) of machine code under sanitizers
    misra          the MISRA addon of cppcheck reports no finding
    latch          outputs slew to their safe values as declared, after random inputs

The first two are proofs over the whole declared domain at both depths.
"""

from collections.abc import Callable, Mapping
from typing import Any

from synth.check import Check
from synth.execute import host
from synth.verify.proofs import eva, fuzz, latch, misra, nonfinite

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
    checks += nonfinite.compare(code, manifest).checks()
    progress(f"fuzzing: {steps} steps")
    checks += fuzz.run(code, manifest, steps).checks()
    progress("cppcheck --addon=misra")
    checks += misra.inspect(code).checks()
    progress("latch: slew to the safe output")
    return checks + latch.verify(host.load(code, manifest))
