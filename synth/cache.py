"""Content-addressed cache (as `joblib.Memory`): each result is stored under the digest of all that it depends on.

    key = SHA-256(the function's slice, its arguments, versions of Python and of all packages, platform and processor)

Time stamps play no part: a changed input gives another key.
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


def cached(function: Callable[P, T]) -> Callable[P, T]:
    """Cache the results of a function that depends on its arguments alone.

    A call with an argument that has no digest computes its result each time. Exceptions are not cached.
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
    """Return the key of a function's result for `values`; with `data` it covers the data files beside its modules.

    Raises ContentError for a value that has no digest.
    """
    beside = slices.digest(function, data) if data else ""
    return contents.digest(environment(), function, beside, values)


@functools.cache
def environment() -> str:
    """Return a digest of the environment of every result: Python, packages, platform, processor, kernels."""
    packages = sorted({(d.name or "", d.version or "") for d in importlib.metadata.distributions()})
    processor = (platform.system(), platform.machine(), _processor(), os.cpu_count())
    kernels = [(name, os.environ.get(name)) for name in KERNELS]
    return contents.digest(sys.version, packages, processor, kernels)


def _processor() -> str:
    """Return model and flags of the first processor, which select the kernels, where Linux reports them."""
    path = Path("/proc/cpuinfo")
    lines = path.read_text(encoding="utf-8").split("\n\n")[0].splitlines() if path.exists() else [platform.processor()]
    return "\n".join(line for line in lines if line.startswith(("model name", "flags", "Features", "CPU part")))
