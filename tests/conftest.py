"""Settings of every test: no verdict from a clock or from chance, and the BLAS kernels in the heading."""

import os

import pytest
from hypothesis import HealthCheck, settings

from synth.base import store
from tests import kernels, tools

# Without a deadline for one example and for drawing it, a busy machine fails nothing; the examples are always the same.
settings.register_profile("synth", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("synth")

# A test with a cache of its own shares zig's libraries, which take a minute to build.
os.environ.setdefault("ZIG_GLOBAL_CACHE_DIR", str(store.folder() / "zig"))


def pytest_runtest_setup(item: pytest.Item) -> None:
    if reason := tools.missing(item):
        pytest.skip(reason)


def pytest_report_header() -> str:
    return "BLAS kernels: " + ", ".join(f"{package} {name}" for package, name in kernels.in_use().items())
