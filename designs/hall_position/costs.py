"""What a sample costs the estimators beside that of two sensors: three sensors, and four for six degrees of freedom.

    most(c) = max over k of n_c(x_k, u_k),    ratio = most(CasADi's C) / most(emitted C)

n_c are the instructions that a Cortex-M4F fetches for the step of the C text c: both texts are of one block and one
build, over the same steps. Instructions are not cycles, and the most of some steps is no bound of the worst case.

Needs the extra `target`.
"""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import NamedTuple

import numpy as np

from designs.hall_position import bench, config
from designs.hall_position.glsdc import channels, six_estimator
from models import hall_array, hall_two_waves
from models import hall_motions as motions
from models.hall_motions import Numbers
from models.hall_two_waves import SpatialArray
from synth.block import unranged
from synth.emit import write
from synth.emit.write import Emitted
from synth.execute import cross, host
from synth.report import page
from synth.verify import meter, rivals, steps
from synth.verify.meter import Build
from synth.verify.rivals import Candidate
from synth.verify.steps import Steps

BUILDS = (Build("gcc -O2", "gcc"), Build("gcc -O2 contracted", "gcc", cross.CONTRACTED))
ABSENT = "Not measured: no emulator, or arm-none-eabi-gcc is not installed."
COSTLY = ("random", "states anew", "random states and inputs", "rare among states anew")  # of bench: with the worst
EACH, SIX = 100, 120  # steps of each of these, and of each kind in six degrees of freedom
TRAVEL, YAW, TILT, GAP = 0.3, 0.09, 8e-3, 4e-4  # m, rad, rad, m, of a motion in six degrees of freedom
LOST = slice(40, 60)  # samples whose voltages are of no place
TITLE = "Cost of three sensors and of six degrees of freedom"
COLUMNS = ("estimator", "build", "steps", "emitted C", "CasADi's C in float", "ratio")
SEED = 2_025  # a motion that takes within five of the most that thousands of steps do


class Row(NamedTuple):
    """The most instructions of any of some steps, of the emitted C and of CasADi's, by one build."""

    estimator: str
    build: str
    steps: int
    own: int
    rival: int


class Subject(NamedTuple):
    """The emitted C of an estimator, CasADi's C of the same block, and the steps that both are given."""

    name: str
    own: Candidate
    rival: Candidate
    steps: Steps


def measure(three: Emitted, four: SpatialArray) -> Sequence[Row]:
    """Measure the C that was emitted of three sensors, and that of four sensors in six degrees of freedom.

    The latter is emitted here, which takes most of the time; compilers run meanwhile, as processes of their own. There
    is no row where the compiler is not installed.

    Raises CompileError when the compiler refuses a text.
    """
    if "gcc" not in cross.available():
        return ()
    with ThreadPoolExecutor(len(BUILDS)) as pool:
        subjects = []
        for made in (partial(of_three, three), partial(of_six, four)):
            subjects.append(made())
            for build in BUILDS:
                pool.submit(_compile, subjects[-1], build)  # a text that is refused is so again below
    return tuple(row(subject, build) for subject in subjects for build in BUILDS)


def _compile(of: Subject, build: Build) -> None:
    """Have both texts in the cache of products, where a run finds them."""
    for candidate in (of.own, of.rival):
        meter.booted(candidate, build, meter.linked(candidate, build))


def row(of: Subject, build: Build) -> Row:
    """Measure both texts over the same steps by one build."""
    own, rival = (int(meter.run(c, of.steps, build).cost.instructions.max()) for c in (of.own, of.rival))
    return Row(of.name, build.name, len(of.steps), own, rival)


def of_three(emitted: Emitted) -> Subject:
    """Return what was emitted of three sensors, over steps among which are the costliest."""
    sequences = bench.sequences(host.load(emitted.files, emitted.manifest), lambda _: None)
    costly = steps.joined("costly", [steps.thinned(s, EACH) for s in sequences if s.name in COSTLY])
    rival = rivals.casadi(config.block(config.THREE), shimmed=True)
    return Subject("three sensors", rivals.emitted(emitted), rival, costly)


def of_six(array: SpatialArray) -> Subject:
    """Return the estimator of six degrees of freedom, on a motion and on random states and inputs."""
    block = unranged(six_estimator.guarded(array, config.TIME))  # which does not ship
    emitted = write.emit(block, np.float32, error=six_estimator.SURROGATE_ERROR[np.float32])
    sequence = six_steps(array, host.load(emitted.files, emitted.manifest))
    name = f"six degrees of freedom, {len(array.positions)} sensors"
    return Subject(name, rivals.emitted(emitted), rivals.casadi(block, shimmed=True), sequence)


def six_steps(array: SpatialArray, controller: host.Controller) -> Steps:
    """Return steps of a motion in which it loses its way now and then, and steps from any state."""
    volts, _ = hall_array.spatial(*hall_two_waves.model(array)).function().map(SIX)(motion(array, SIX).T)
    V = np.asarray(volts.full().T)
    V += array.deviation * np.random.default_rng(SEED).standard_normal(V.shape)
    V[LOST] *= -1
    inputs = dict(zip((s.name for s in channels.voltages(len(array.positions))), V.T, strict=True))
    return steps.joined("all", [steps.recorded(controller, "motion", inputs), steps.drawn(controller, SIX)])


def motion(array: SpatialArray, n: int) -> Numbers:
    """Return poses (n, 6) of X, Y, Z, roll, pitch and yaw, m and rad."""
    time = config.TIME.period_s
    across = motions.wander(time, (n, 1), SEED, TRAVEL, YAW)
    tilted = motions.wander(time, (n, 1), SEED + 1, TILT, GAP)  # roll and pitch as X and Y, the height as the yaw
    return np.hstack((across.X, across.Y, array.height + tilted.yaw, tilted.X, tilted.Y, across.yaw))


def section(rows: Sequence[Row]) -> page.Section:
    """Return the most instructions of a sample, beside those of CasADi's C, or why nothing was measured."""
    if not rows:
        return page.Section(TITLE, (page.Text(ABSENT),))
    cells = tuple((*r, f"{r.rival / r.own:.2f}") for r in rows)
    caption = "Most instructions a sample, emulated Cortex-M4F; instructions are not cycles"
    return page.Section(TITLE, (page.Table(caption, COLUMNS, cells, digits=6),))
