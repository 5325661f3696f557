"""Run the tests that round under other kernels of OpenBLAS than the one it chooses here: `make test-kernels`.

OpenBLAS holds one kernel for each family of processors and chooses by the processor it finds. Each kernel sums in
another order and rounds otherwise, and so does each number of threads. The variable OPENBLAS_CORETYPE makes it take
another one; it is read when the library is loaded, thus set before Python starts. OpenBLAS does not check that the
processor can run the kernel that is asked for: `FLAGS` does.
"""

import ctypes
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import scipy

ROOT = Path(__file__).parents[1]
# Flags of /proc/cpuinfo that a kernel needs. OpenBLAS runs Zen's processors with the kernel of Haswell.
FLAGS = {
    "Prescott": {"pni"},
    "Sandybridge": {"avx"},
    "Haswell": {"avx2", "fma"},
    "SkylakeX": {"avx512f", "avx512cd", "avx512bw", "avx512dq", "avx512vl"},
    "Nehalem": {"sse4_2"},
}
REPORTED = {"Prescott": "Katmai"}  # the first of the names that share its kernel
PASSES = 2  # with the kernel of `make test` three
TESTS = (
    "tests/analyse",
    "tests/synthesise",
    "tests/test_block.py",
    "tests/test_check.py",
    "tests/test_plant.py",
    "tests/test_show.py",
    "tests/test_signals.py",
    "tests/test_statespace.py",
    "tests/test_timing.py",
)  # the vocabulary, analysis and synthesis


def in_use() -> dict[str, str]:
    """Return the name of the OpenBLAS kernel that NumPy runs with, and SciPy; 'unknown' without OpenBLAS."""
    return {module.__name__: next(_module_names(Path(module.__file__).parent), "unknown") for module in (np, scipy)}


def _module_names(package: Path) -> Iterator[str]:
    for path in sorted(package.parent.glob(f"{package.name}.libs/libscipy_openblas*")):
        library = ctypes.CDLL(str(path))
        for suffix in ("64_", ""):
            if (function := getattr(library, f"scipy_openblas_get_corename{suffix}", None)) is not None:
                function.restype = ctypes.c_char_p
                yield function().decode()


def cpuinfo() -> str:
    """Return what Linux tells of the processors; nothing elsewhere."""
    path = Path("/proc/cpuinfo")
    return path.read_text(encoding="utf-8") if path.exists() else ""


def runnable(text: str) -> list[str]:
    """Return the kernels that a processor can run, by its `cpuinfo`, in the order of FLAGS."""
    lines = [line.split(":")[1].split() for line in text.splitlines() if line.startswith("flags")]
    return [kernel for kernel, needed in FLAGS.items() if lines and needed <= set(lines[0])]


def main() -> int:
    """Run TESTS under PASSES kernels that are not the one in use, with one and two threads in turn; 0 if all pass."""
    usual = in_use().values()
    others = [kernel for kernel in runnable(cpuinfo()) if REPORTED.get(kernel, kernel) not in usual][:PASSES]
    if len(others) < PASSES:
        sys.exit(f"found {len(others)} kernels beside {', '.join(usual)}, need {PASSES}: use an x86-64 with AVX")
    return max(run(kernel, 1 + k % 2) for k, kernel in enumerate(others))


def run(kernel: str, threads: int) -> int:
    """Run TESTS under a kernel; return 0 if all pass. Exit when OpenBLAS takes another kernel than asked."""
    around = {**os.environ, "OPENBLAS_CORETYPE": kernel, "OPENBLAS_NUM_THREADS": str(threads)}
    sys.stdout.write(f"\nOpenBLAS kernel {kernel}, {threads} BLAS threads\n")
    sys.stdout.flush()
    command = [sys.executable, "-c", "import json; from tests import kernels; print(json.dumps(kernels.in_use()))"]
    shown = subprocess.run(command, cwd=ROOT, env=around, capture_output=True, text=True, check=True).stdout
    if set(json.loads(shown).values()) != {REPORTED.get(kernel, kernel)}:
        sys.exit(f"asked for the kernel {kernel}, found {shown.strip()}: use the wheels of constraints.txt")
    tests = [sys.executable, "-m", "pytest", "-q", "-n", "auto", "--dist", "loadfile", *TESTS]
    return subprocess.run(tests, cwd=ROOT, env=around).returncode


if __name__ == "__main__":
    sys.exit(main())
