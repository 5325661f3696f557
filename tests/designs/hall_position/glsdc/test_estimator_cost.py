"""Instructions a sample on the emulated Cortex-M4F, two sensors and five corrections, and no function of libm."""

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from designs.hall_position.glsdc.parameters import Tuning
from synth.execute import host
from synth.verify import meter, steps
from synth.verify.meter import Build
from tests import ceilings, tools
from tests.designs.hall_position.tracked import TWO, USUAL, block, by_input, compile_c, emit_c, motion, noisy

LIMIT = 2800
PLAIN = ceilings.BUILDS["gcc, newlib"]
FIVE, TWO_CORRECTIONS = "two sensors, five corrections", "two sensors, two corrections"
LIBM = re.compile(r"\b(sin|cos|tan|asin|acos|atan|atan2|exp|log|pow)f?\(")


@cache
def sequence(tuning: Tuning) -> steps.Steps:
    """Return steps of a motion in which it loses its way now and then, and steps from any state."""
    controller = compile_c(TWO, tuning, np.float32)
    V = noisy(TWO, motion(400, 1, 1, travel=0.1, yaw=0.1))
    V[150:170] *= -1
    recorded = steps.record(controller, "motion", by_input(TWO, V[:, 0]))
    return steps.concatenate("all", [recorded, steps.random_steps(controller, 600)])


def most(tuning: Tuning, build: Build) -> int:
    files = emit_c(TWO, tuning, np.float32)
    return int(meter.run(meter.emitted_source(files), sequence(tuning), build).cost.instructions.max())


@pytest.mark.parametrize(("subject", "build"), ceilings.builds(FIVE))
def test_five_corrections_are_within_the_limit(subject: str, build: Build) -> None:
    assert USUAL.iterations == 5
    assert 1500 < most(USUAL, build) <= ceilings.of(subject, build)


@tools.needs_arm_gcc
def test_it_costs_at_most_a_fifth_more_than_equations_written_out() -> None:
    """Its normal equations, written out for two sensors, took 2,295 instructions; two corrections are a bar as well."""
    ceiling = ceilings.of(TWO_CORRECTIONS, PLAIN)
    assert most(USUAL, PLAIN) <= 1.2 * 2295 and most(replace(USUAL, iterations=2), PLAIN) <= ceiling


@tools.needs_arm_gcc
def test_seven_corrections_exceed_it() -> None:
    assert most(replace(USUAL, iterations=7), PLAIN) > LIMIT


@tools.needs_arm_gcc
def test_casadis_own_c_takes_twice_as_many() -> None:
    few, build = steps.thinned(sequence(USUAL), 30), PLAIN
    baseline = meter.run(meter.casadi(block(TWO), shimmed=True), few, build).cost.instructions
    emitted_cost = meter.run(meter.emitted_source(emit_c(TWO, USUAL, np.float32)), few, build).cost.instructions
    assert baseline.max() > 1.9 * emitted_cost.max()


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_there_is_no_function_of_libm_in_the_loop(scalar: type[np.floating]) -> None:
    text = "".join(host.code(emit_c(TWO, USUAL, scalar).files).values())
    code = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    assert LIBM.findall("x = cosf(y);") and not LIBM.findall(code)
    assert len(re.findall(r"\bsqrtf?\(", code)) == 4  # deviations and residual
