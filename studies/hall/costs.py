"""Cost of a sample with protection levels, and for four sensors in six degrees of freedom, beside CasADi's C.

    most(c) = max over k of n_c(x_k, u_k),    ratio = most(CasADi's C) / most(emitted C)

n_c are the instructions that a Cortex-M4F fetches for a step of the C text c. Both texts are of the same block, build
and steps. Instructions are not cycles, and the maximum over some steps does not bound the worst case.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from designs.hall_position import config
from designs.hall_position.glsdc import channels
from designs.hall_position.glsdc.estimator import SURROGATE_ERROR
from designs.hall_position.protected import config as protected
from models import hall_array, hall_two_waves
from models import hall_motions as motions
from models.hall_motions import Numbers
from models.hall_stage import Stage
from models.hall_two_waves import SpatialArray
from studies.hall.pages import six
from studies.hall.protected import spatial
from synth import show
from synth.base.progress import Progress
from synth.block import Block, unranged
from synth.emit import write
from synth.emit.write import EmittedCode
from synth.execute import cross, host
from synth.report import page
from synth.verify import meter, steps
from synth.verify.meter import Build, Candidate
from synth.verify.steps import Steps

BUILDS = (Build("gcc -O2", "gcc"), Build("gcc -O2 contracted", "gcc", cross.CONTRACTED))
ABSENT = "Not measured: arm-none-eabi-gcc is not installed."
SPATIAL_STEPS = 300  # steps of each kind in six degrees of freedom
TRAVEL, YAW, TILT, GAP = 0.3, 0.09, 8e-3, 4e-4  # m, rad, rad, m, of a motion in six degrees of freedom
AT_REST = 160  # samples before the motion, until the estimate is valid
FALSE_VOLTAGES = slice(220, 240)  # samples whose voltages belong to no pose
TITLE = "Cost of three and four sensors, and of six degrees of freedom"
COLUMNS = ("estimator", "build", "steps", "emitted C", "CasADi's C in float", "ratio")
SEED = 2_025  # of a motion whose maximum is within five instructions of that of thousands of steps


class Row(NamedTuple):
    """Largest instruction counts of a step, of the emitted C and of CasADi's C, for one build."""

    estimator: str
    build: str
    steps: int
    emitted: int
    casadi: int


class Subject(NamedTuple):
    """The emitted C of an estimator, CasADi's C of the same block, and the steps that both execute."""

    name: str
    emitted: Candidate
    casadi: Candidate
    steps: Steps


def measure(progress: Progress) -> Sequence[Row]:
    """Measure the emitted C with protection levels, and that of four sensors in six degrees of freedom.

    Without the emulator or an installed compiler there are no rows.

    Raises CompileError when the compiler refuses a text.
    """
    if "gcc" not in cross.available():
        return ()
    return tuple(row(subject, build) for subject in _subjects(progress) for build in BUILDS)


def _subjects(progress: Progress) -> Iterator[Subject]:
    for name in protected.PLACES:
        progress(f"cost of {name}")
        yield of_companion(emit(protected.block(name=name)))
    progress("cost of six degrees of freedom")
    yield of_six()


def emit(block: Block) -> EmittedCode:
    """Return the C of a Block in single precision, with the polynomials of the one that ships."""
    return write.emit(block, np.float32, error=SURROGATE_ERROR[np.float32])


def row(subject: Subject, build: Build) -> Row:
    """Measure both texts over the same steps with one build."""
    emitted, casadi = (
        int(meter.run(c, subject.steps, build).cost.instructions.max()) for c in (subject.emitted, subject.casadi)
    )
    return Row(subject.name, build.name, len(subject.steps), emitted, casadi)


def of_companion(emitted: EmittedCode) -> Subject:
    """Return the emitted C of an estimator with protection levels, with its test vectors."""
    name = str(emitted.manifest["design"])
    inputs = protected.vectors({"V_ax": np.zeros(1, np.float32)}, {}, name)
    along = steps.record(host.load(emitted.files, emitted.manifest), "vectors", inputs)
    casadi = meter.casadi(protected.block(name=name), shimmed=True)
    return Subject(f"{len(protected.PLACES[name])} sensors", meter.emitted_source(emitted), casadi, along)


def of_six() -> Subject:
    """Return the estimator of six degrees of freedom, on a motion and on random states and inputs."""
    array = six.optimised_layout(Stage(), six.MIN_SENSORS)
    block = unranged(spatial.guarded_estimator(array, config.TIME))  # this block does not ship
    emitted = emit(block)
    sequence = six_steps(array, host.load(emitted.files, emitted.manifest))
    name = f"six degrees of freedom, {len(array.positions)} sensors"
    return Subject(name, meter.emitted_source(emitted), meter.casadi(block, shimmed=True), sequence)


def six_steps(array: SpatialArray, controller: host.Controller) -> Steps:
    """Return steps of a motion that loses position lock for a while, and steps from random states."""
    volts, _ = (
        hall_array.spatial(*hall_two_waves.model(array)).function().map(SPATIAL_STEPS)(motion(array, SPATIAL_STEPS).T)
    )
    V = np.asarray(volts.full().T)
    V += array.deviation * np.random.default_rng(SEED).standard_normal(V.shape)
    V[FALSE_VOLTAGES] *= -1
    inputs = dict(zip((s.name for s in channels.voltages(len(array.positions))), V.T, strict=True))
    return steps.concatenate(
        "all", [steps.record(controller, "motion", inputs), steps.random_steps(controller, SPATIAL_STEPS)]
    )


def motion(array: SpatialArray, n: int) -> Numbers:
    """Return poses (n, 6) of X, Y, Z, roll, pitch and yaw, m and rad, the first ones at rest."""
    time, moving = config.TIME.period_s, (n - AT_REST, 1)
    across = motions.smooth_motions(time, moving, SEED, TRAVEL, YAW)
    tilted = motions.smooth_motions(time, moving, SEED + 1, TILT, GAP)  # roll and pitch as X and Y, height as the yaw
    poses = np.hstack((across.X, across.Y, array.height + tilted.yaw, tilted.X, tilted.Y, across.yaw))
    return np.pad(poses, ((AT_REST, 0), (0, 0)), mode="edge")


def section(rows: Sequence[Row]) -> page.Section:
    """Return a table of the largest instruction counts, or the reason why nothing was measured."""
    if not rows:
        return page.Section(TITLE, (page.Text(ABSENT),))
    cells = tuple((*r, f"{r.casadi / r.emitted:.2f}") for r in rows)
    caption = "Most instructions a sample, emulated Cortex-M4F; instructions are not cycles"
    return page.Section(TITLE, (show.Table(caption, COLUMNS, cells, digits=6),))
