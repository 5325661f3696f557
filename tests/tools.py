"""Tools that `make test` does not install: a test that needs one is marked, skips without it, and says what it shows.

    @needs("frama-c", shows="that the C keeps its contract")        skips where the command is not on the PATH
    @sees_more_with_tools                                           runs anywhere, and judges more where tools are found

`pytest -m tools` runs both kinds alone. A test that reaches for a tool without a mark fails with the tool's name where
the tool is missing.
"""

import shutil

import pytest

from synth.execute import compile
from synth.execute.compile import Compiler
from synth.verify import meter
from synth.verify.meter import Build

ARM_GCC = "arm-none-eabi-gcc"
PROVERS = ("frama-c", "clang", "cppcheck")
BY_GCC = "the same of the machine code by gcc for Arm"


def needs(*commands: str, shows: str) -> pytest.MarkDecorator:
    """Return the mark of a test, or of a parameter, that skips unless all commands are on the PATH."""
    return pytest.mark.tools(*commands, shows=shows)


sees_more_with_tools = pytest.mark.tools(shows="the same of each tool that is found")
needs_arm_gcc = needs(ARM_GCC, shows=BY_GCC)

CROSS_COMPILERS = ("zig", pytest.param("gcc", marks=needs_arm_gcc))
HOST_COMPILERS = ("zig", pytest.param("cc", marks=needs("cc", shows="the same by this machine's own C compiler")))


def host_compiler(name: str) -> Compiler:
    """Return the compiler of a name of HOST_COMPILERS."""
    return compile.zig_compiler() if name == "zig" else compile.identify_compiler((name,), f"install {name}")


def marks_of(build: Build) -> tuple[pytest.MarkDecorator, ...]:
    """Return the marks of a test that measures the machine code of a build."""
    return (needs_arm_gcc,) if build.compiler == "gcc" else ()


BUILDS = tuple(pytest.param(build, id=build.name, marks=marks_of(build)) for build in meter.BUILDS)


def missing(item: pytest.Item) -> str:
    """Return why a test cannot run, "" if it can: the first commands that are not found, and what they would show."""
    for mark in item.iter_markers("tools"):
        if absent := [command for command in mark.args if not shutil.which(command)]:
            return f"{', '.join(absent)} not on the PATH, would show {mark.kwargs['shows']}"
    return ""
