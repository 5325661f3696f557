"""Cost of the other estimators in the report: slower code shows as more instructions, and every row is shown.

The C here computes sines by libm, which is emitted in a tenth of the time; the one that ships is measured in the build.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache, partial

import numpy as np
import pytest

from designs.hall_position import config
from designs.hall_position.protected.config import THREE, block
from models.hall_stage import Stage
from models.hall_two_waves import SpatialArray
from studies.hall import costs
from studies.hall.costs import BUILDS, Row, Subject
from studies.hall.pages import six as pages
from studies.hall.protected import spatial
from synth.block import unranged
from synth.emit import write
from synth.emit.write import EmittedCode
from synth.execute import cross, host
from synth.report import page
from synth.verify import meter, steps
from tests import tools
from tests.models.posed import volts
from tests.studies.hall import posed

pytestmark = pytest.mark.whole

PLAIN = BUILDS[0]
TURNS = 50  # of a loop that is planted
emit_with_libm = partial(write.emit, libm=True)
GUARDED = cache(spatial.guarded_estimator)  # built once, as several tests ask for it


@cache
def three() -> EmittedCode:
    """Return the C of three sensors."""
    return emit_with_libm(block(name=THREE), np.float32)


@cache
def array() -> SpatialArray:
    """Return the four sensors that are measured in six degrees of freedom."""
    return pages.optimised_layout(Stage(), pages.MIN_SENSORS)


@cache
def six() -> EmittedCode:
    return emit_with_libm(unranged(GUARDED(array(), config.TIME)), np.float32)


@cache
def subject() -> Subject:
    """Return what is measured of three sensors."""
    return costs.of_companion(three())


@cache
def measure_three() -> Row:
    return costs.row(subject(), PLAIN)


def with_loop(emitted: EmittedCode) -> EmittedCode:
    """Return the C with a loop before it returns."""
    name = f"{THREE}.c"
    loop = f"    for (volatile int k = 0; k < {TURNS}; ++k) {{}}\n    return fault_word;"
    planted = emitted.files[name].replace("    return fault_word;", loop)
    assert planted.count("volatile int k") == 1
    return replace(emitted, files={**emitted.files, name: planted})


@tools.needs_arm_gcc
def test_a_loop_that_is_planted_shows_as_more() -> None:
    slower = costs.row(subject()._replace(emitted=meter.emitted_source(with_loop(three()))), PLAIN)
    assert 4 * TURNS <= slower.emitted - measure_three().emitted <= 10 * TURNS  # load, compare, branch, add, store
    assert slower.casadi == measure_three().casadi


@tools.needs_arm_gcc
def test_every_estimator_is_measured_by_every_build(monkeypatch: pytest.MonkeyPatch) -> None:
    """By what counts steps only, as compilers take most of the time."""
    monkeypatch.setattr(
        costs, "emit", lambda block: six() if "pose" in block.name else emit_with_libm(block, np.float32)
    )
    monkeypatch.setattr(spatial, "guarded_estimator", GUARDED)
    monkeypatch.setattr(costs, "row", lambda of, build: Row(of.name, build.name, len(of.steps), 1, 1))
    rows = costs.measure(lambda _: None)
    names = "4 sensors", "3 sensors", "six degrees of freedom, 4 sensors"
    assert [(r.estimator, r.build) for r in rows] == [(name, b.name) for name in names for b in BUILDS]
    assert [r.steps for r in rows[::2]] == [*(2 * [len(subject().steps)]), 2 * costs.SPATIAL_STEPS]
    assert {b.flags for b in BUILDS} == {(), cross.CONTRACTED} and "-O2" in cross.FLAGS


def test_without_the_compiler_it_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cross, "available", lambda: ("zig",))
    rows = costs.measure(lambda _: None)
    assert rows == ()
    assert "arm-none-eabi-gcc is not installed" in render(rows)


def test_the_motion_in_six_degrees_of_freedom_is_seen_as_it_is() -> None:
    poses = costs.motion(array(), costs.SPATIAL_STEPS)
    seen = costs.six_steps(array(), host.load(six().files, six().manifest)).inputs[: costs.SPATIAL_STEPS]
    read = np.array([seen[name] for name in seen.dtype.names or ()]).T
    read[costs.FALSE_VOLTAGES] *= -1
    off = read - volts(array(), poses).reshape(costs.SPATIAL_STEPS, -1)
    assert np.std(off) == pytest.approx(array().deviation, rel=0.1)
    assert (np.ptp(poses, axis=0) > np.array([1e-3, 1e-3, 5e-6, 1e-4, 1e-4, 1e-3])).all()
    assert (np.abs(poses[:, 2] - array().height) < posed.USUAL.gap).all()
    assert (np.abs(poses[:, 3:5]) < posed.USUAL.tilt).all()


def test_it_finds_its_way_and_loses_it() -> None:
    controller = host.load(six().files, six().manifest)
    sequence = costs.six_steps(array(), controller)
    assert len(sequence) == 2 * costs.SPATIAL_STEPS
    outputs = steps.evaluate(controller, sequence).outputs
    valid, lost = (outputs[name][: costs.SPATIAL_STEPS] > 0 for name in ("valid", "lost"))
    assert valid[costs.AT_REST : costs.FALSE_VOLTAGES.start].all()
    assert not valid[costs.FALSE_VOLTAGES.start :].any() and lost[costs.FALSE_VOLTAGES.stop :].all()


def test_every_row_is_shown() -> None:
    html = render((Row("three", "plain", 600, 3795, 7225), Row("six", "contracted", 240, 5557, 10581)))
    for text in ("three", "plain", "600", "3,795", "7,225", "1.90", "six", "contracted", "5,557", "10,581"):
        assert text in html.replace("\u202f", ","), text
    assert html.count("1.90") == 2 and "instructions are not cycles" in html


def render(rows: Sequence[Row]) -> str:
    return page.render(page.Report("costs", "", (costs.section(rows),)))
