"""Linear algebra in one thread: matrices here are small, and threads that wait for each other cost processor time.

The eigenvalues of a matrix with some hundred rows take five times the processor time in two threads, and jobs run side
by side anyway. The number of threads changes how sums are rounded, so it is a part of the keys of cached results:
commands and tests must agree. pytest takes this module as a plugin, `-p synth.base.threads`.
"""

import os
import sys


def use_one() -> None:
    """Let OpenBLAS run in one thread, unless the environment says otherwise or NumPy has been imported."""
    if "numpy" not in sys.modules:
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def pytest_load_initial_conftests() -> None:
    """Use one thread before a test or a conftest imports NumPy."""
    use_one()
