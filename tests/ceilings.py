"""Instructions that a step takes at most on the emulated Cortex-M4F, by compiler and version.

Another version of a compiler makes other code of the same C. A ceiling therefore holds for the version by which it was
measured; with another one its test skips and says so. To renew the ceilings, run the tests with the new version and
enter what they find.
"""

import pytest

from synth.execute import cross
from synth.verify import meter
from synth.verify.meter import Build
from tests import tools

VERSIONS = {"gcc": "12.2.1", "zig": "clang version 22.1.8"}
BUILDS = {build.name: build for build in meter.BUILDS}
O2, OS, CONTRACTED, ZIG = "gcc, newlib", "gcc, newlib, small", "gcc, newlib, contracted", "zig, musl"
CEILINGS = {
    # 900 were asked for of both planar controllers, which predict and brake; the watch over repeated codes takes some
    # ten more, the test that no demand passes before the first complete sample ten, the force of a cable fifteen, and
    # one function a Block ten.
    "planar_6dof_leadlag": {O2: 950, OS: 895, CONTRACTED: 898},
    "planar_6dof_lqg": {O2: 945, OS: 900, CONTRACTED: 900},
    "planar, recorded": {O2: 940},
    "planar, failures": {O2: 940},
    # Of -O2 as long as no integral is at its limit, of -Os always.
    "reduced": {O2: 95, OS: 95},
    "full": {O2: 100, OS: 102},
    # The scale of the voltages costs 13 and 6 instructions of these.
    "sensing, predicted": {O2: 350, ZIG: 340},
    "sensing, as measured": {O2: 245, ZIG: 255},
    "hall_position": {O2: 2600, CONTRACTED: 2300},
    "two sensors, five corrections": {O2: 2600, OS: 2800, CONTRACTED: 2300},
    # 2,494 and 2,179 are seen; with -Os 2,752, since gcc then calls the function of an iteration, else 2,504.
    "two sensors, two corrections": {O2: 1300},
    "hall_position_four": {O2: 3600},  # 3,324 are seen: hypotheses that have passed and their trial take 91 of these
}


def builds(*subjects: str) -> list[object]:
    """Return the parameters (subject, build) of the ceilings of some subjects."""
    return [
        pytest.param(subject, BUILDS[name], id=f"{subject}, {name}", marks=tools.marks_of(BUILDS[name]))
        for subject in subjects
        for name in CEILINGS[subject]
    ]


def of(subject: str, build: Build) -> int:
    """Return the ceiling of a subject by a build; skip where the compiler is of another version.

    Raises CompileError when the compiler is not installed.
    """
    version, known = cross.find_compiler(meter.CORE, build.compiler).identity.splitlines()[0], VERSIONS[build.compiler]
    if known not in version:
        pytest.skip(
            f"the ceilings are those of {build.compiler} {known}, found {version}: would show that a step of "
            f"{subject} takes no more instructions than it took"
        )
    return CEILINGS[subject][build.name]
