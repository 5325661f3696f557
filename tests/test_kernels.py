"""The kernels of OpenBLAS that a processor can run, and that they take effect."""

import json
import os
import subprocess
import sys

import pytest

from tests import kernels


@pytest.mark.parametrize(
    ("flags", "expected"),
    [
        ("", []),
        ("fpu sse2 pni", ["Prescott"]),
        ("pni sse4_2 avx", ["Prescott", "Sandybridge", "Nehalem"]),
        ("pni sse4_2 avx avx2 fma", ["Prescott", "Sandybridge", "Haswell", "Nehalem"]),
        ("pni sse4_2 avx avx2 fma avx512f", ["Prescott", "Sandybridge", "Haswell", "Nehalem"]),
        ("pni sse4_2 avx avx2 fma avx512f avx512cd avx512bw avx512dq avx512vl", list(kernels.FLAGS)),
    ],
)
def test_only_kernels_that_the_processor_can_run_are_taken(flags: str, expected: list[str]) -> None:
    assert kernels.runnable(f"processor\t: 0\nflags\t\t: {flags}\nbugs\t\t: spectre\n") == expected


@pytest.mark.slow
@pytest.mark.skipif("Prescott" not in kernels.runnable(kernels.cpuinfo()), reason="no x86-64 under Linux")
def test_the_variable_chooses_the_kernel_of_both_libraries() -> None:
    around = {**os.environ, "OPENBLAS_CORETYPE": "Prescott"}
    command = [sys.executable, "-c", "import json; from tests import kernels; print(json.dumps(kernels.in_use()))"]
    shown = subprocess.run(command, cwd=kernels.ROOT, env=around, capture_output=True, text=True, check=True).stdout
    assert set(json.loads(shown).values()) == {kernels.REPORTED["Prescott"]}


@pytest.mark.slow
def test_a_kernel_that_is_not_taken_ends_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernels, "TESTS", ("--version",))
    with pytest.raises(SystemExit, match="asked for the kernel Bogus, found"):
        kernels.run("Bogus", 1)
