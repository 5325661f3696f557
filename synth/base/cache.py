"""Content-addressed cache (as `joblib.Memory`): each result is stored under the digest of all that it depends on.

    key = SHA-256(the function's slice, its arguments, versions of Python and of all packages, platform and processor)

Time stamps play no part: a changed input gives another key.
"""

import functools
import importlib.metadata
import os
import platform
import re
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

from synth.base import contents, slices, store
from synth.errors import ContentError

P = ParamSpec("P")
T = TypeVar("T")

DISTRIBUTION = "synth-stage"
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
    """Return a digest of the environment of every result: Python, packages, platform, processor, kernels.

    Packages that only tests and documents of the toolkit need are no part of it: `make test` uses what was built.
    """
    installed = {_name(d.name or ""): d for d in importlib.metadata.distributions()}
    optional = _requirements(installed, True) - _requirements(installed, False)
    packages = sorted((name, d.version or "") for name, d in installed.items() if name not in optional)
    processor = (platform.system(), platform.machine(), _processor(), os.cpu_count())
    kernels = [(name, os.environ.get(name)) for name in KERNELS]
    return contents.digest(sys.version, packages, processor, kernels)


def _requirements(installed: Mapping[str, importlib.metadata.Distribution], extras: bool) -> set[str]:
    """Return the names of the installed packages that the toolkit requires, directly or not, with its extras or not."""
    reached, waiting = set[str](), [DISTRIBUTION]
    while waiting:
        name = waiting.pop()
        if name in installed and name not in reached:
            reached.add(name)
            with_extras = extras and name == DISTRIBUTION
            waiting += [_name(r) for r in installed[name].requires or () if with_extras or "extra ==" not in r]
    return reached


def _name(requirement: str) -> str:
    """Return the normalised name of a package from a requirement, as in `Jinja2>=3.1; extra == "docs"`."""
    return re.split(r"[^A-Za-z0-9._-]", requirement, maxsplit=1)[0].lower().replace("_", "-").replace(".", "-")


def _processor() -> str:
    """Return model and flags of the first processor, which select the kernels, where Linux reports them."""
    path = Path("/proc/cpuinfo")
    lines = path.read_text(encoding="utf-8").split("\n\n")[0].splitlines() if path.exists() else [platform.processor()]
    return "\n".join(line for line in lines if line.startswith(("model name", "flags", "Features", "CPU part")))
