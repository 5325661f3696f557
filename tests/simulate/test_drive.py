"""Blocks between controller and plant: wired by name, run in the same sample, and refused where names do not fit."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from synth.block import Exprs, Step
from synth.block import build as block
from synth.errors import WiringError
from synth.execute import host
from synth.execute.host import Controller
from synth.plant import Plant
from synth.signals import Signal
from synth.simulate import closed_loop
from synth.simulate.closed_loop import Trajectory
from synth.timing import Discrete
from tests.simulate.test_closed_loop import BASE, T

Level = Callable[[str], Controller]
WIDE = (-1e4, 1e4)
GAP, CURRENT = Signal("gap", "m", *WIDE), Signal("current", "A", *WIDE)
DRIVEN = replace(BASE, actuators={"i": "coil"}, hold={"coil": 1.5})


def drive(
    name: str, factor: float, out: str = "coil", of: Signal = CURRENT, scalar: type[np.floating] = np.float64
) -> Controller:
    """Return the compiled Block out = factor * of."""

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        return Step({out: factor * u[of.name]})

    bounds = [abs(factor) * v for v in WIDE]
    made = block(name, Discrete(T), law, inputs=[of], outputs=[Signal(out, "A", *bounds)])
    return host.compile_block(made, scalar)


def run(mass: Plant, level: Controller, *blocks: Controller, scenario: closed_loop.Scenario = DRIVEN) -> Trajectory:
    return closed_loop.simulate(mass, level, scenario, drive=blocks)


def test_a_drive_of_gain_one_changes_no_bit(mass: Plant, level: Level) -> None:
    controller = level("float64")
    direct = closed_loop.simulate(mass, controller, replace(BASE, hold={"current": 1.5}))
    driven = run(mass, controller, drive("whole", 1.0))
    assert all(np.array_equal(driven.states[n], direct.states[n]) for n in direct.states)
    assert np.array_equal(driven["coil"], direct["current"]) and np.array_equal(driven["current"], direct["current"])
    weaker = run(mass, controller, drive("weaker", 0.9))
    assert not np.allclose(weaker["q"], direct["q"], rtol=1e-6)


def test_blocks_follow_one_another_and_the_last_one_commands(mass: Plant, level: Level) -> None:
    controller = level("float64")
    once = run(mass, controller, drive("once", 0.75))
    twice = run(mass, controller, drive("first", 0.5, "half"), drive("second", 1.5, "coil", Signal("half", "A", *WIDE)))
    assert np.array_equal(once["q"], twice["q"])
    assert np.array_equal(twice["half"], 0.5 * twice["current"])
    assert set(twice.drive_faults) == {"first", "second"} and not twice.drive_faults["first"].any()


def test_a_drive_reads_the_inputs_of_the_controller_of_this_sample(mass: Plant, level: Level) -> None:
    gap = run(mass, level("float64"), drive("sensed", 1.0, "coil", GAP))
    assert np.array_equal(gap["coil"], gap.measured["gap"])
    assert not np.array_equal(gap["coil"][1:], gap.measured["gap"][:-1])


def test_no_block_is_called_in_a_missed_sample(mass: Plant, level: Level) -> None:
    missed = np.zeros(300, bool)
    missed[100:110] = True
    driven = run(mass, level("float64"), drive("whole", 1.0), scenario=replace(DRIVEN, missed=missed))
    direct = closed_loop.simulate(mass, level("float64"), replace(BASE, hold={"current": 1.5}, missed=missed))
    assert np.array_equal(driven["q"], direct["q"])
    assert (driven["coil"][100:110] == driven["coil"][99]).all() and driven["coil"][110] != driven["coil"][99]


@pytest.mark.parametrize(
    ("blocks", "message"),
    [
        ([("odd", 1.0, "coil", Signal("force", "N", *WIDE), np.float64)], "nothing gives its input 'force'"),
        ([("odd", 1.0, "coil", Signal("gap", "A", *WIDE), np.float64)], "wire like to like"),
        ([("odd", 1.0, "coil", CURRENT, np.float32)], "in one scalar type"),
    ],
)
def test_what_does_not_fit_is_refused(mass: Plant, level: Level, blocks: list, message: str) -> None:
    with pytest.raises(WiringError, match=message):
        run(mass, level("float64"), *(drive(*of) for of in blocks))
