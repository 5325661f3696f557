"""Content-addressed cache: a result is kept under the digest of everything that it depends on.

    key = SHA-256(the function's slice, its arguments, versions of Python and of all packages, platform and processor)

Nothing goes by time: what has not changed is found again, and what has changed has another key.
"""

import functools
import importlib.metadata
import os
import platform
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

from synth import contents, slices, store
from synth.errors import ContentError

P = ParamSpec("P")
T = TypeVar("T")

# Variables that choose the kernels of linear algebra, and how many threads share a sum: both change how it rounds.
KERNELS = ("OPENBLAS_CORETYPE", "OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "GOTO_NUM_THREADS", "MKL_NUM_THREADS")


def kept(function: Callable[P, T]) -> Callable[P, T]:
    """Keep the results of a function of its arguments alone; one of an argument without digest is computed each time.

    What it raises is not kept.
    """

    @functools.wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> T:
        try:
            name = key(function, args, kwargs)
        except ContentError:
            return function(*args, **kwargs)
        return store.fetch(name, lambda: function(*args, **kwargs))

    return call


def key(function: Callable[..., Any], *values: Any, data: bool = False) -> str:
    """Return the key of what a function computes of `values`; with `data` also of data files beside its modules.

    Raises ContentError for a value that has no digest.
    """
    beside = slices.digest(function, data) if data else ""
    return contents.digest(environment(), function, beside, values)


@functools.cache
def environment() -> str:
    """Return a digest of what every result may depend on: Python, packages, platform, processor, kernels."""
    packages = sorted({(d.name or "", d.version or "") for d in importlib.metadata.distributions()})
    processor = (platform.system(), platform.machine(), _processor(), os.cpu_count())
    kernels = [(name, os.environ.get(name)) for name in KERNELS]
    return contents.digest(sys.version, packages, processor, kernels)


def _processor() -> str:
    """Return what decides which kernels run: model and flags of the first processor, where Linux tells them."""
    path = Path("/proc/cpuinfo")
    lines = path.read_text(encoding="utf-8").split("\n\n")[0].splitlines() if path.exists() else [platform.processor()]
    return "\n".join(line for line in lines if line.startswith(("model name", "flags", "Features", "CPU part")))
